// Memory for one short command.
#pragma once

namespace touchdown::cli {

// What is freed from now on is kept and used again, and it lies on large pages
// where the system has them. A page that is used for the first time costs about
// a microsecond: of 1000 raw frames a twentieth of `analyze`. Not for what runs
// for hours.
void KeepMemory();

}  // namespace touchdown::cli
