// touchdown describe writes manual pages and completions when the program is
// built. It is a tool of the build, and no --help shows it.
#include <filesystem>
#include <memory>
#include <string>

#include "app/cli/command.h"
#include "app/cli/command_tree.h"
#include "app/cli/completions.h"
#include "app/cli/manual_pages.h"
#include "app/cli/options.h"
#include "touchdown/core/output_file.h"

namespace touchdown::cli {
namespace {

// Writes a file that appears whole or not at all. Throws core::OutputError.
void Write(const std::filesystem::path& path, const std::string& text) {
  core::OutputFile file(path);
  file.Write(text);
  file.Commit();
}

// Writes man1/*.1 and the three completion scripts into `out`. Returns 0.
int WriteDescriptions(const CLI::App& app, const std::filesystem::path& out) {
  const auto tree = DescribeCommands(app);
  std::filesystem::create_directories(out / "man1");
  for (const CommandText& command : tree) {
    Write(out / "man1" / ManualPageName(command), ManualPage(command, tree));
  }
  Write(out / "touchdown.bash", BashCompletion(tree));
  Write(out / "_touchdown", ZshCompletion(tree));
  Write(out / "touchdown.fish", FishCompletion(tree));
  return 0;
}

}  // namespace

// The action needs the whole tree: main adds this command behind all others,
// since `describe` is none of their names.
void AddDescribe(CLI::App& app, Action& action) {
  auto out = std::make_shared<std::string>();
  CLI::App* command =
      AddCommand(app, "describe", "manual pages and completions");
  Hide(*command);
  AddOption(*command, "OUT", *out, "a folder").Require();
  SetAction(*command, action,
            [&app, out] { return WriteDescriptions(app, *out); });
}

}  // namespace touchdown::cli
