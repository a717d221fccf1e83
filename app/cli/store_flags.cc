#include "app/cli/store_flags.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <stdexcept>

#include "app/cli/values.h"
#include "touchdown/core/errors.h"
#include "touchdown/core/units.h"

namespace touchdown::cli {

void AddDbFlag(CLI::App& command, std::string& db) {
  command.add_option("--db", db, "the trial store, e.g. lab.db")
      ->required()
      ->type_name("FILE");
}

void AddBodyFlags(CLI::App& command, BodyFlags& flags) {
  command.add_option("--body", flags.kind, "sphere or rectangle")
      ->type_name("KIND");
  command
      .add_option("--diameter-mm", flags.diameter_mm,
                  "of a sphere; 40 or 40+-0.02 (u; 0.02 mm where not given)")
      ->type_name("D");
  command
      .add_option("--sides-mm", flags.sides_mm,
                  "of a rectangle; 60x20 or 60+-0.02x20+-0.02")
      ->type_name("AxB");
}

std::optional<core::Body> ParseBody(const BodyFlags& flags) {
  if (flags.kind.empty() && flags.diameter_mm.empty() &&
      flags.sides_mm.empty()) {
    return std::nullopt;
  }
  core::BodyKind kind = flags.sides_mm.empty() ? core::BodyKind::kSphere
                                               : core::BodyKind::kRectangle;
  if (!flags.kind.empty()) {
    kind = ParseWord<core::BodyKind>("--body", flags.kind, core::ParseBodyKind,
                                     "sphere or rectangle");
  }
  if (kind == core::BodyKind::kSphere) {
    if (!flags.sides_mm.empty()) {
      throw std::invalid_argument(
          "--sides-mm is given, but a sphere has a --diameter-mm");
    }
    if (flags.diameter_mm.empty()) {
      core::Body body;
      body.diameter_m = core::AbsentBecause("not recorded");
      return body;
    }
    return core::Sphere(ParseEstimate("--diameter-mm", flags.diameter_mm,
                                      core::kMillimetre, kPlainSize));
  }
  if (!flags.diameter_mm.empty()) {
    throw std::invalid_argument(
        "--diameter-mm is given, but a rectangle has --sides-mm");
  }
  if (flags.sides_mm.empty()) {
    core::Body body;
    body.kind = core::BodyKind::kRectangle;
    body.diameter_m = core::AbsentBecause("not a sphere");
    body.long_m = core::AbsentBecause("not recorded");
    body.short_m = core::AbsentBecause("not recorded");
    return body;
  }
  const auto [a, b] =
      ParseSides("--sides-mm", flags.sides_mm, core::kMillimetre, kPlainSize);
  return core::Rectangle(a, b);
}

core::Trial RequireTrial(const db::Store& store, const std::string& id) {
  if (auto trial = store.Find(id)) return *std::move(trial);
  throw core::StoreError(
      fmt::format("{}: there is no trial '{}'; see `touchdown list --db {}`",
                  store.path().string(), id, store.path().string()));
}

std::string BodyText(const core::Body& body) {
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
