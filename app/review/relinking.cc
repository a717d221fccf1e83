#include "app/review/relinking.h"

#include <nlohmann/json.hpp>

#include "app/review/fields.h"
#include "app/trials/relink.h"

namespace touchdown::review {

nlohmann::ordered_json RelinkedJson(const std::filesystem::path& store,
                                    const nlohmann::json& asked) {
  const std::string folder =
      RequiredText(asked, "folder", "where recordings are");
  // The folder is one of this machine and need not be among those of
  // --recordings: it is searched for known recordings alone, and none of its
  // names is told but those that were found.
  auto opened = db::Store::Open(store, db::OpenMode::kWrite);
  const pipeline::Relinked relinked = pipeline::Relink(opened, folder);
  auto found = nlohmann::ordered_json::array();
  for (const auto& move : relinked.found) {
    found.push_back({{"from", move.from}, {"to", move.to}});
  }
  return {{"found", std::move(found)},
          {"missing", relinked.missing},
          {"in_place", relinked.in_place},
          {"looked_at", relinked.looked_at}};
}

}  // namespace touchdown::review
