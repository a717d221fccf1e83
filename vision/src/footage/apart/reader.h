// The reader's side: it opens the clip it is told to, and answers.
#pragma once

namespace touchdown::vision {

// How a reader is started: this, and nothing else, behind the program's name,
// and these two descriptors.
inline constexpr char kReaderArgument[] = "--read-a-recording";
inline constexpr int kLifeLine = 3;   // its end is the reader's end
inline constexpr int kFirstLine = 4;  // questions about the clip

// Serves until the life line ends; the exit status.
int ServeReader();

}  // namespace touchdown::vision
