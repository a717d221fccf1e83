// Memory for one short command.
#pragma once

namespace touchdown::cli {

// What is freed from now on is kept and used again, and it lies on large pages
// where the system has them: a page costs most when it is used for the first
// time. Not for what runs for hours.
void KeepMemory();

}  // namespace touchdown::cli
