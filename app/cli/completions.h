// What a shell needs to complete commands, their flags and, elsewhere, names of
// files.
#pragma once

#include <string>
#include <vector>

#include "app/cli/command_tree.h"

namespace touchdown::cli {

std::string BashCompletion(const std::vector<CommandText>& tree);
std::string ZshCompletion(const std::vector<CommandText>& tree);
std::string FishCompletion(const std::vector<CommandText>& tree);

}  // namespace touchdown::cli
