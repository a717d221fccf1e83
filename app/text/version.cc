#include "app/text/version.h"

#include "commit.h"

namespace touchdown::pipeline {

// The build defines it from the version of the project in CMakeLists.txt.
std::string_view Version() { return TOUCHDOWN_VERSION; }

std::string_view Commit() { return TOUCHDOWN_COMMIT; }

}  // namespace touchdown::pipeline
