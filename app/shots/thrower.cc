#include "app/shots/thrower.h"

#include <fmt/core.h>

#include <stdexcept>

#include "app/shots/rig_reach.h"
#include "app/text/text_file.h"
#include "touchdown/db/register.h"
#include "touchdown/vision/footage/clip_digest.h"

namespace touchdown::pipeline {

namespace {

// The description alone; as MakeThrower finds it.
Thrower ReadRig(const std::filesystem::path& rig_file,
                const std::filesystem::path& db) {
  Thrower out;
  out.file = rig_file.string();
  // A file of that name comes first; the register is asked only where there is
  // none. With neither, ReadDescription below says what it looked for.
  std::error_code ignored;
  if (!db.empty() && !std::filesystem::exists(rig_file, ignored)) {
    const auto store = db::Store::Open(db, db::OpenMode::kRead);
    if (const auto entry =
            db::FindEntry(store, db::RegisterKind::kRig, out.file)) {
      out.document = entry->texts.at("document");
      out.entry = {entry->name, entry->id};
      out.rig = rig::ParseDescription(
          out.document, fmt::format("rig '{}' of the register", out.file));
      return out;
    }
  }
  // The text is kept beside the parsed rig, because KeepRig compares texts:
  // comments and notes in a rig.toml are part of its version.
  out.rig = rig::ReadDescription(rig_file);
  out.document = report::ReadTextFile(rig_file);
  return out;
}

}  // namespace

core::Registered KeepRig(db::Store& store, const Thrower& thrower,
                         const std::string& author) {
  // It was taken from the register: nothing to keep.
  if (!thrower.entry.name.empty()) return thrower.entry;
  // The file's name stands in where the description has none.
  const std::string name =
      thrower.rig.name.empty()
          ? std::filesystem::path(thrower.file).stem().string()
          : thrower.rig.name;
  auto entry = db::FindEntry(store, db::RegisterKind::kRig, name);
  if (entry && entry->texts.at("document") == thrower.document) {
    return {entry->name, entry->id};
  }
  // A text that differs makes a further version; earlier trials keep theirs.
  const bool is_new = !entry;
  if (is_new) entry = db::NewEntry(db::RegisterKind::kRig, name);
  entry->texts["document"] = thrower.document;
  entry->texts["sha256"] = vision::Sha256(thrower.file);
  entry->author = author;
  entry->reason = fmt::format("{} as it was used", thrower.file);
  const db::Entry kept =
      is_new ? db::AddEntry(store, *entry) : db::ChangeEntry(store, *entry);
  return {kept.name, kept.id};
}

Thrower MakeThrower(const std::filesystem::path& rig_file,
                    const core::Campaign& campaign, double speed_mps,
                    std::optional<core::Corner> corner,
                    const std::filesystem::path& db) {
  Thrower out = ReadRig(rig_file, db);
  // Only the kind is compared, not the sizes.
  if (out.rig.body && out.rig.body->kind != campaign.body.kind) {
    throw std::invalid_argument(fmt::format(
        "--rig: the body of {} is a {}, the trials are of a {}", out.file,
        core::Name(out.rig.body->kind), core::Name(campaign.body.kind)));
  }
  out.wish.kind = campaign.angle_kind;
  out.wish.corner = corner;
  out.wish.speed_mps =
      speed_mps > 0.0 ? speed_mps
                      : (campaign.speed_min_mps + campaign.speed_max_mps) / 2;
  if (!(out.wish.speed_mps > 0.0)) {
    throw std::invalid_argument(
        "--rig: needs --speed-mps, the speed at touchdown: the campaign "
        "declares no speed band");
  }
  return out;
}

core::Interval RequireReach(const Thrower& thrower) {
  const auto reach = ReachableAngles(thrower.rig, thrower.wish);
  if (reach) return *reach;
  throw std::invalid_argument(
      fmt::format("--rig: {} cannot throw any {} angle at {:g} m/s: {}",
                  thrower.file, core::Name(thrower.wish.kind),
                  thrower.wish.speed_mps, reach.error().reason));
}

report::Reach ReachOfThrower(const Thrower& thrower) {
  return {RequireReach(thrower),
          fmt::format("what {} throws at {:g} m/s",
                      thrower.rig.name.empty() ? "the rig" : thrower.rig.name,
                      thrower.wish.speed_mps)};
}

report::ReachOf ReachOfRig(const std::filesystem::path& rig_file,
                           double speed_mps, std::optional<core::Corner> corner,
                           const std::filesystem::path& db) {
  ReadRig(rig_file, db);  // throws now, not for each campaign
  // Reads the rig anew for each campaign. A campaign that this rig cannot serve
  // has no reach, and the report says why; a file that went away in between
  // still throws.
  return [=](const core::Campaign& campaign) -> core::Expected<report::Reach> {
    try {
      return ReachOfThrower(
          MakeThrower(rig_file, campaign, speed_mps, corner, db));
    } catch (const std::invalid_argument& mismatch) {
      return core::AbsentBecause(mismatch.what());
    }
  };
}

}  // namespace touchdown::pipeline
