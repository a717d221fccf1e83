// A row of numbers as text, with blanks between: what tables inside documents
// are made of.
#pragma once

#include <cstdint>
#include <string>

namespace touchdown::report {

class NumberRow {
 public:
  NumberRow& AddWhole(std::int64_t value);
  // The shortest text that reads as this number again, as fmt's "{}".
  NumberRow& AddShortest(double value);
  // printf's "%.*f" and "%.*g".
  NumberRow& AddFixed(double value, int decimals);
  NumberRow& AddGeneral(double value, int digits);
  NumberRow& AddWord(const std::string& word);

  const std::string& text() const { return text_; }

 private:
  void Begin();

  std::string text_;
};

}  // namespace touchdown::report
