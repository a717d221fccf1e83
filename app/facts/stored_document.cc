#include "app/facts/stored_document.h"

namespace touchdown::report {

nlohmann::json StoredDocument(const core::Trial& trial) {
  // The parser does not throw: a damaged document is the same as none to a
  // report, which then says that the facts are not known.
  auto document = nlohmann::json::parse(trial.document_json, nullptr, false);
  if (!document.is_object()) return nullptr;
  return document;
}

const nlohmann::json& FindValue(const nlohmann::json& document,
                                std::initializer_list<const char*> path) {
  // The references that are returned must outlive the call.
  static const nlohmann::json none;
  const nlohmann::json* at = &document;
  for (const char* name : path) {
    // find() finds nothing in what is no object, so that a path through a
    // number or a text ends here, too.
    const auto found = at->find(name);
    if (found == at->end()) return none;
    at = &*found;
  }
  return *at;
}

}  // namespace touchdown::report
