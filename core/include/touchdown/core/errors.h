// The third error lane: the outside world failed. Thrown, caught once in main,
// printed as one line: what, where, what was expected, what to do.
//
// (The first lane, an impossible argument, is std::invalid_argument, which
// names the field, its value and its allowed range. The second, "science says
// no", is a value: expected.h.)
#pragma once

#include <stdexcept>
#include <string>

namespace touchdown::core {

// A file that cannot be read, is damaged or is of an unsupported kind. The
// message names file and frame, byte or row. Exit status 3.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// An output that cannot be written: the disk is full, the name is a device. The
// message names it. Exit status 6. Never caught as if one input of many had
// failed.
class OutputError : public InputError {
 public:
  using InputError::InputError;
};

// Trouble with the trial store. Exit status 4.
class StoreError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace touchdown::core
