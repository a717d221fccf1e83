#include "app/pipeline/version.h"

namespace touchdown::pipeline {

std::string_view Version() { return TOUCHDOWN_VERSION; }

}  // namespace touchdown::pipeline
