#include "campaigns.h"

#include <fmt/format.h>

#include "register_rows.h"
#include "rows.h"
#include "touchdown/core/errors.h"
#include "touchdown/db/store.h"

namespace touchdown::db {
namespace {

using core::Campaign;
using core::StoreError;

std::string CampaignQuery() {
  return fmt::format(
      "SELECT c.name, {}, ifnull(f.name, ''), c.angle_kind, c.bounce_height_m, "
      "c.speed_min_mps, c.speed_max_mps, c.theory_name, "
      "c.theory_boundary_rad, c.theory_u_rad, c.margin_rad "
      "FROM campaigns c LEFT JOIN surfaces f ON f.id = c.surface_id ",
      BodyNames("c."));
}

Campaign TakeCampaign(Statement& row) {
  Campaign campaign;
  campaign.name = row.TakeText();
  campaign.body = TakeBody(row);
  campaign.surface = row.TakeText();
  // The column's CHECK allows the three words only.
  campaign.angle_kind =
      core::ParseAngleKind(row.TakeText()).value_or(core::AngleKind::kApproach);
  campaign.bounce_height_m = row.TakeReal();
  campaign.speed_min_mps = row.TakeReal();
  campaign.speed_max_mps = row.TakeReal();
  campaign.theory_name = row.TakeText();
  campaign.theory_boundary_rad = row.TakeOptionalReal();
  campaign.theory_u_rad = row.TakeReal();
  campaign.margin_rad = row.TakeReal();
  return campaign;
}

void AddConventions(Statement& statement, const Campaign& campaign,
                    std::optional<std::int64_t> surface_row) {
  AddBody(statement, campaign.body);
  statement.Add(surface_row)
      .Add(core::Name(campaign.angle_kind))
      .Add(campaign.bounce_height_m)
      .Add(campaign.speed_min_mps)
      .Add(campaign.speed_max_mps)
      .Add(campaign.theory_name)
      .Add(campaign.theory_boundary_rad)
      .Add(campaign.theory_u_rad)
      .Add(campaign.margin_rad);
}

std::string ConventionNames() {
  return BodyNames("") +
         ", surface_id, angle_kind, bounce_height_m, speed_min_mps, "
         "speed_max_mps, theory_name, theory_boundary_rad, theory_u_rad, "
         "margin_rad";
}

std::string PlaceholdersFor(std::string_view names) {
  std::string text = "?";
  for (const char c : names) {
    if (c == ',') text += ", ?";
  }
  return text;
}

}  // namespace

std::optional<std::int64_t> KeepSurface(Connection& connection,
                                        std::string_view name,
                                        std::string_view uuid,
                                        std::string_view now_utc) {
  if (name.empty()) return std::nullopt;
  Statement find(connection,
                 fmt::format("SELECT id FROM surfaces WHERE name = ? ORDER BY "
                             "{} LIMIT 1",
                             kInForceFirst));
  find.Add(name);
  if (find.Step()) return find.TakeInteger();
  Entry surface = NewEntry(RegisterKind::kSurface, name);
  surface.id = uuid;
  surface.version = 1;
  surface.author = "touchdown";
  surface.reason = "named by a campaign";
  surface.recorded_at_utc = now_utc;
  return InsertEntry(connection, surface);
}

void InsertCampaign(Connection& connection, const Campaign& campaign,
                    std::string_view uuid, std::string_view now_utc) {
  // The surface takes its UUID from the campaign that first names it.
  const auto surface = KeepSurface(connection, campaign.surface, uuid, now_utc);
  const std::string names = ConventionNames();
  Statement insert(
      connection,
      fmt::format("INSERT INTO campaigns (uuid, name, created_at_utc, {}) "
                  "VALUES (?, ?, ?, {})",
                  names, PlaceholdersFor(names)));
  insert.Add(uuid).Add(campaign.name).Add(now_utc);
  AddConventions(insert, campaign, surface);
  insert.Run();
}

std::optional<Campaign> SelectCampaign(Connection& connection,
                                       std::string_view name) {
  Statement row(connection, CampaignQuery() + "WHERE c.name = ?");
  row.Add(name);
  if (!row.Step()) return std::nullopt;
  return TakeCampaign(row);
}

bool SameConventions(const Campaign& a, const Campaign& b) {
  return a.body == b.body && a.surface == b.surface &&
         a.angle_kind == b.angle_kind &&
         a.bounce_height_m == b.bounce_height_m &&
         a.speed_min_mps == b.speed_min_mps &&
         a.speed_max_mps == b.speed_max_mps && a.theory_name == b.theory_name &&
         a.theory_boundary_rad == b.theory_boundary_rad &&
         a.theory_u_rad == b.theory_u_rad && a.margin_rad == b.margin_rad;
}

void Store::AddCampaign(const Campaign& campaign) {
  RequireStorable(campaign);
  Connection& c = connection();
  Transaction transaction(c, Transaction::Kind::kWrite);
  if (SelectCampaign(c, campaign.name)) {
    throw StoreError(fmt::format(
        "{}: there is a campaign '{}' already; choose another name, or see "
        "`touchdown campaign show`",
        path().string(), campaign.name));
  }
  InsertCampaign(c, campaign, sources().new_uuid(), sources().now_utc());
  transaction.Commit();
}

void Store::ChangeCampaign(const Campaign& campaign) {
  RequireStorable(campaign);
  Connection& c = connection();
  Transaction transaction(c, Transaction::Kind::kWrite);
  Statement find(c,
                 "SELECT id, (SELECT count(*) FROM trials t "
                 "WHERE ifnull(t.campaign_id, 0) = c.id) "
                 "FROM campaigns c WHERE name = ?");
  find.Add(campaign.name);
  if (!find.Step()) {
    throw NoCampaign(c, campaign.name);
  }
  const std::int64_t row = find.TakeInteger();
  const std::int64_t trials = find.TakeInteger();
  if (trials != 0) {
    throw StoreError(fmt::format(
        "{}: campaign '{}' has {} trials, and conventions are fixed before the "
        "first; make a new campaign",
        path().string(), campaign.name, trials));
  }
  const auto surface = KeepSurface(c, campaign.surface, sources().new_uuid(),
                                   sources().now_utc());
  const std::string names = ConventionNames();
  Statement update(
      c, fmt::format("UPDATE campaigns SET ({}) = ({}) WHERE id = ?", names,
                     PlaceholdersFor(names)));
  AddConventions(update, campaign, surface);
  update.Add(row).Run();
  transaction.Commit();
}

std::optional<Campaign> Store::FindCampaign(std::string_view name) const {
  return SelectCampaign(connection(), name);
}

std::vector<Campaign> Store::Campaigns() const {
  Statement row(connection(), CampaignQuery() + "ORDER BY c.name");
  std::vector<Campaign> campaigns;
  while (row.Step()) campaigns.push_back(TakeCampaign(row));
  return campaigns;
}

}  // namespace touchdown::db
