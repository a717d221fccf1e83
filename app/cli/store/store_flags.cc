#include "app/cli/store/store_flags.h"

#include <fmt/format.h>

#include <stdexcept>

#include "app/cli/options.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"

namespace touchdown::cli {

// The flag is required; touchdown.toml may supply it (defaults.h).
void AddDbFlag(CLI::App& command, std::string& db) {
  AddOption(command, "--db", db, "the trial store, e.g. lab.db")
      .Require()
      .NameType("FILE");
}

// The kind may be left out: the size that is given tells it.
void AddBodyFlags(CLI::App& command, pipeline::BodyEntry& flags) {
  AddOption(command, "--body", flags.kind, "sphere or rectangle")
      .NameType("KIND");
  AddOption(command, "--diameter-mm", flags.diameter_mm,
            "of a sphere; 40 or 40+-0.02 (u; 0.02 mm where not given)")
      .NameType("D");
  AddOption(command, "--sides-mm", flags.sides_mm,
            "of a rectangle; 60x20 or 60+-0.02x20+-0.02")
      .NameType("AxB");
}

void RequireDb(const std::string& db) {
  if (!db.empty()) return;
  throw std::invalid_argument(
      "--db is missing, must be a trial store, e.g. lab.db; give it, or name "
      "one for this folder with `touchdown use`");
}

std::optional<core::Corner> ReadCorner(const std::string& corner) {
  if (corner.empty()) return std::nullopt;
  return ParseWord<core::Corner>("--corner", corner, core::ParseCorner,
                                 "leading, trailing or flush");
}

core::Trial RequireTrial(const db::Store& store, const std::string& id) {
  if (auto trial = store.Find(id)) return *std::move(trial);
  throw core::StoreError(
      fmt::format("{}: there is no trial '{}'; see `touchdown list --db {}`",
                  store.path().string(), id, store.path().string()));
}

std::string BodyText(const core::Body& body) {
  // A size has four digits and no u; "?" stands for one that is not known.
  const auto mm = [](const core::Measured& size) {
    return size ? fmt::format("{:.4g}", size->value / core::kMillimetre)
                : std::string("?");
  };
  if (body.kind == core::BodyKind::kSphere) {
    return fmt::format("sphere {} mm", mm(body.diameter_m));
  }
  return fmt::format("rectangle {} x {} mm", mm(body.long_m), mm(body.short_m));
}

}  // namespace touchdown::cli
