// Manual pages, in man(7), of what --help says.
#pragma once

#include <string>
#include <vector>

#include "app/cli/command_tree.h"

namespace touchdown::cli {

// "touchdown-rig-plan.1" of "touchdown rig plan".
std::string ManualPageName(const CommandText& command);

std::string ManualPage(const CommandText& command,
                       const std::vector<CommandText>& tree);

}  // namespace touchdown::cli
