// A controller of touchdown-rig version 2 (../README.md) for an Arduino Uno,
// Nano or Mega: the line protocol, the heartbeat and the emergency stop. Build
// it with the Arduino IDE or arduino-cli; it needs no library.
//
// To be fitted to a rig: the pins, and the two functions that move its motors
// (MoveBarrel, MoveSpring). The latch is a solenoid that must be held to keep
// the springs latched: power off is unlatched into the catch, never a shot.
#include <stdlib.h>
#include <string.h>

const uint8_t kLatchPin = 7;      // high: the springs are held
const uint8_t kTriggerPin = 8;    // high for kTrigger_ms: fires
const uint8_t kInterlockPin = 2;  // low: the guard is closed (pull-up)
const uint8_t kButtonPin = 3;     // low: the emergency button is pressed

// The heartbeat. The program may be gone 2 s after its last line; 0.2 s are left
// for the latch to open.
const unsigned long kLongestSilence_ms = 1800;
// Nobody keeps springs latched for longer, whatever the program says.
const unsigned long kLongestArmed_ms = 60000;
const unsigned long kTrigger_ms = 50;

const char kStopByte = 0x18;
const unsigned kLongestLine = 200;

char line[kLongestLine + 1];
unsigned length = 0;
bool too_long = false;

long angle_mdeg = 0;
long compress_um = 0;
bool armed = false;
bool stopped = false;
long shots = 0;
long token = 0;
unsigned long heard_ms = 0;
unsigned long armed_ms = 0;

// The last answer, for a request that comes again.
unsigned long last_number = 0;
char last_answer[kLongestLine + 1] = "";

uint16_t Crc16(const char* bytes, unsigned n) {
  uint16_t crc = 0xFFFF;
  for (unsigned i = 0; i < n; ++i) {
    crc ^= static_cast<uint16_t>(static_cast<uint8_t>(bytes[i])) << 8;
    for (uint8_t bit = 0; bit < 8; ++bit) {
      crc = (crc & 0x8000) ? (crc << 1) ^ 0x1021 : crc << 1;
    }
  }
  return crc;
}

// --- the rig's own ------------------------------------------------------------

void MoveBarrel(long mdeg) { angle_mdeg = mdeg; }
void MoveSpring(long um) { compress_um = um; }
bool IsMoving() { return false; }

bool GuardIsClosed() { return digitalRead(kInterlockPin) == LOW; }

// Unlatches, and lets the load off the springs.
void Disarm() {
  digitalWrite(kTriggerPin, LOW);
  digitalWrite(kLatchPin, LOW);
  if (armed) MoveSpring(0);
  armed = false;
}

void Stop() {
  stopped = true;
  Disarm();
}

// --- lines --------------------------------------------------------------------

void Send(const char* text) {
  char seal[7];
  snprintf(seal, sizeof seal, "*%04X", Crc16(text, strlen(text)));
  Serial.print('\n');
  Serial.print(text);
  Serial.print(seal);
  Serial.print('\n');
}

// "7 ok angle 12500", kept for a repetition.
void Answer(unsigned long number, bool ok, const char* verb,
            const char* text) {
  snprintf(last_answer, sizeof last_answer, "%lu %s %s%s%s", number,
           ok ? "ok" : "no", verb, *text ? " " : "", text);
  last_number = number;
  Send(last_answer);
}

void Do(unsigned long number, const char* verb, const char* argument) {
  char text[80] = "";
  const bool moves = !strcmp(verb, "angle") || !strcmp(verb, "compress") ||
                     !strcmp(verb, "arm") || !strcmp(verb, "fire");
  if (moves && stopped) return Answer(number, false, verb, "stopped");
  if (!strcmp(verb, "hello")) {
    return Answer(number, true, verb, "touchdown-rig/2 sketch");
  }
  if (!strcmp(verb, "angle")) {
    Disarm();
    MoveBarrel(atol(argument));
    return Answer(number, true, verb, argument);
  }
  if (!strcmp(verb, "compress")) {
    Disarm();
    MoveSpring(atol(argument));
    return Answer(number, true, verb, argument);
  }
  if (!strcmp(verb, "interlock")) {
    return Answer(number, true, verb, GuardIsClosed() ? "closed" : "open");
  }
  if (!strcmp(verb, "status")) {
    snprintf(text, sizeof text,
             "angle=%ld compress=%ld moving=%d armed=%d stopped=%d shots=%ld",
             angle_mdeg, compress_um, IsMoving() ? 1 : 0, armed ? 1 : 0,
             stopped ? 1 : 0, shots);
    return Answer(number, true, verb, text);
  }
  if (!strcmp(verb, "arm")) {
    if (!GuardIsClosed()) return Answer(number, false, verb, "interlock open");
    if (IsMoving()) return Answer(number, false, verb, "it moves");
    digitalWrite(kLatchPin, HIGH);
    armed = true;
    armed_ms = millis();
    snprintf(text, sizeof text, "T%ld", ++token);
    return Answer(number, true, verb, text);
  }
  if (!strcmp(verb, "disarm")) {
    Disarm();
    return Answer(number, true, verb, "");
  }
  if (!strcmp(verb, "fire")) {
    snprintf(text, sizeof text, "T%ld", token);
    if (!armed) return Answer(number, false, verb, "not armed");
    if (!GuardIsClosed()) return Answer(number, false, verb, "interlock open");
    if (strcmp(argument, text)) {
      return Answer(number, false, verb, "another token");
    }
    digitalWrite(kTriggerPin, HIGH);
    delay(kTrigger_ms);
    digitalWrite(kTriggerPin, LOW);
    digitalWrite(kLatchPin, LOW);
    armed = false;
    compress_um = 0;
    snprintf(text, sizeof text, "shots=%ld", ++shots);
    return Answer(number, true, verb, text);
  }
  if (!strcmp(verb, "reset")) {
    if (digitalRead(kButtonPin) == LOW) {
      return Answer(number, false, verb, "the button is pressed");
    }
    stopped = false;
    return Answer(number, true, verb, "");
  }
  Answer(number, false, verb, "unknown");
}

// A line without its line feed; one that is damaged is passed over.
void Handle() {
  if (length < 8 || line[length - 5] != '*') return;
  char* end = nullptr;
  const unsigned long crc = strtoul(line + length - 4, &end, 16);
  if (*end || crc != Crc16(line, length - 5)) return;
  line[length - 5] = 0;
  heard_ms = millis();
  const unsigned long number = strtoul(line, &end, 10);
  if (end == line || *end != ' ') return;
  char* const verb = end + 1;
  char* argument = strchr(verb, ' ');
  if (argument) {
    *argument++ = 0;
  } else {
    argument = verb + strlen(verb);
  }
  // 0 is carried out each time; any other only once.
  if (number != 0 && number == last_number && *last_answer) {
    return Send(last_answer);
  }
  Do(number, verb, argument);
}

void setup() {
  pinMode(kLatchPin, OUTPUT);
  pinMode(kTriggerPin, OUTPUT);
  digitalWrite(kLatchPin, LOW);
  digitalWrite(kTriggerPin, LOW);
  pinMode(kInterlockPin, INPUT_PULLUP);
  pinMode(kButtonPin, INPUT_PULLUP);
  Serial.begin(115200);
  heard_ms = millis();
}

void loop() {
  // What must not wait for a line comes first.
  if (digitalRead(kButtonPin) == LOW) Stop();
  if (armed && !GuardIsClosed()) Disarm();
  if (armed && millis() - heard_ms >= kLongestSilence_ms) Disarm();
  if (armed && millis() - armed_ms >= kLongestArmed_ms) Disarm();
  while (Serial.available() > 0) {
    const char c = static_cast<char>(Serial.read());
    if (c == kStopByte) {
      length = 0;
      too_long = false;
      Stop();
    } else if (c == '\n') {
      line[length] = 0;
      if (!too_long) Handle();
      length = 0;
      too_long = false;
    } else if (length < kLongestLine) {
      line[length++] = c;
    } else {
      too_long = true;
    }
  }
}
