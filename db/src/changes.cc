#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "rows.h"
#include "touchdown/core/quantities.h"
#include "touchdown/db/records.h"
#include "touchdown/db/register.h"

namespace touchdown::db {

std::string MeasuredText(const core::Measured& measured) {
  if (!measured) return fmt::format("absent: {}", measured.error().reason);
  std::string text = fmt::format("{} +- {}", measured->value, measured->u);
  if (measured->interval95) {
    text += fmt::format(" [{}, {}]", measured->interval95->low,
                        measured->interval95->high);
  }
  return text;
}

std::string RegisteredText(const core::Registered& entry) {
  if (entry.name.empty()) return "none";
  return entry.id.empty()
             ? entry.name
             : fmt::format("{} ({})", entry.name, entry.id.substr(0, 8));
}

namespace {

// Words of the column: stored revisions bear them, so that they are never
// changed.
constexpr std::array<std::pair<RevisionKind, std::string_view>, 6> kKinds{{
    {RevisionKind::kLogged, "logged"},
    {RevisionKind::kCorrected, "corrected"},
    {RevisionKind::kExcluded, "excluded"},
    {RevisionKind::kIncluded, "included"},
    {RevisionKind::kMerged, "merged"},
    {RevisionKind::kProposed, "proposed"},
}};

std::string Text(const std::optional<double>& value) {
  return value ? fmt::format("{}", *value) : "none";
}

std::string Text(const core::Budget& budget) {
  std::string text;
  for (const auto& line : budget) {
    text +=
        fmt::format("{}{} {}", text.empty() ? "" : ", ", line.source, line.u);
  }
  return text.empty() ? "none" : text;
}

std::string Text(const core::Measured& measured) {
  return MeasuredText(measured);
}
std::string Text(const core::Registered& entry) {
  return RegisteredText(entry);
}
std::string Text(bool value) { return value ? "yes" : "no"; }
std::string Text(const std::string& value) { return value; }

class Differences {
 public:
  template <class T>
  void Compare(std::string_view field, const T& before, const T& after) {
    if (before == after) return;
    changes_.push_back(
        {prefix_ + std::string(field), Text(before), Text(after)});
  }
  template <class T>
  void CompareWords(std::string_view field, const T& before, const T& after) {
    if (before == after) return;
    changes_.push_back({prefix_ + std::string(field),
                        std::string(core::Name(before)),
                        std::string(core::Name(after))});
  }
  void CompareContacts(const core::ContactRecord& before,
                       const core::ContactRecord& after) {
    const auto corner = [](const core::Contact& contact) {
      return contact.corner ? std::string(core::Name(*contact.corner)) : "none";
    };
    Compare("found", before.contact.found, after.contact.found);
    Compare("not_found_because", before.contact.reason, after.contact.reason);
    Compare("from_start", before.contact.from_start, after.contact.from_start);
    Compare("corner", corner(before.contact), corner(after.contact));
    CompareWords("state", before.state.label, after.state.label);
    Compare("p_bounce", before.state.p_bounce, after.state.p_bounce);
    Compare("state_because", before.state.reason, after.state.reason);
    Compare("micro_bounce", before.state.micro_bounce,
            after.state.micro_bounce);
    for (const auto& quantity : core::kContactQuantities) {
      Compare(quantity.name, At(before, quantity), At(after, quantity));
    }
    for (const auto& budget : core::kBudgets) {
      Compare(fmt::format("{}_budget", budget.name),
              before.contact.*budget.member, after.contact.*budget.member);
    }
  }
  void CompareConditions(const core::Conditions& before,
                         const core::Conditions& after) {
    for (const auto& entry : kConditionEntries) {
      Compare(Name(entry.kind), before.*entry.member, after.*entry.member);
    }
    for (const auto& quantity : kConditionQuantities) {
      Compare(quantity.name, before.*quantity.member, after.*quantity.member);
    }
    CompareWords("anomaly", before.anomaly, after.anomaly);
    Compare("anomaly_note", before.anomaly_note, after.anomaly_note);
    Compare("note", before.note, after.note);
  }
  void SetPrefix(std::string prefix) { prefix_ = std::move(prefix); }
  void Push(Change change) { changes_.push_back(std::move(change)); }
  std::vector<Change> Done() { return std::move(changes_); }

 private:
  std::string prefix_;
  std::vector<Change> changes_;
};

}  // namespace

std::string_view Name(RevisionKind kind) {
  for (const auto& [key, name] : kKinds) {
    if (key == kind) return name;
  }
  return "?";
}

std::optional<RevisionKind> ParseRevisionKind(std::string_view word) {
  for (const auto& [key, name] : kKinds) {
    if (name == word) return key;
  }
  return std::nullopt;
}

const Revision& RevisionInForce(std::span<const Revision> history) {
  std::size_t i = history.size() - 1;
  while (i > 0 && history[i].kind == RevisionKind::kProposed) --i;
  return history[i];
}

const Revision* OpenProposal(std::span<const Revision> history) {
  for (std::size_t i = history.size(); i-- > 0;) {
    const RevisionKind kind = history[i].kind;
    if (kind == RevisionKind::kProposed) return &history[i];
    // These state nothing of the trial itself.
    if (kind != RevisionKind::kExcluded && kind != RevisionKind::kIncluded) {
      break;
    }
  }
  return nullptr;
}

std::vector<Change> Changes(const core::Trial& before,
                            const core::Trial& after) {
  Differences differences;
  differences.Compare("clip_path", before.clip.path, after.clip.path);
  differences.CompareWords("angle_kind", before.angle_kind, after.angle_kind);
  differences.CompareWords("body_kind", before.body.kind, after.body.kind);
  for (const auto& quantity : core::kBodyQuantities) {
    differences.Compare(quantity.name, before.body.*quantity.member,
                        after.body.*quantity.member);
  }
  differences.Compare("set_angle_rad", before.set_angle_rad,
                      after.set_angle_rad);
  differences.Compare("set_speed_mps", before.set_speed_mps,
                      after.set_speed_mps);
  differences.SetPrefix("conditions: ");
  differences.CompareConditions(before.conditions.value_or(core::Conditions{}),
                                after.conditions.value_or(core::Conditions{}));
  differences.SetPrefix("");
  differences.CompareContacts(before.first, after.first);
  const std::size_t both = std::min(before.later.size(), after.later.size());
  for (std::size_t i = 0; i < both; ++i) {
    differences.SetPrefix(fmt::format("contact {}: ", i + 2));
    differences.CompareContacts(before.later[i], after.later[i]);
  }
  differences.SetPrefix("");
  if (before.later.size() != after.later.size()) {
    differences.Push({"contacts", fmt::format("{}", 1 + before.later.size()),
                      fmt::format("{}", 1 + after.later.size())});
  }
  if (before.document_json != after.document_json) {
    differences.Push({"document", "another", "the one of this revision"});
  }
  differences.Compare("excluded", before.excluded, after.excluded);
  differences.Compare("exclusion_reason", before.exclusion_reason,
                      after.exclusion_reason);
  return differences.Done();
}

}  // namespace touchdown::db
