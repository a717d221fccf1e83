#include "app/facts/stored_document.h"

namespace touchdown::report {

nlohmann::json StoredDocument(const core::Trial& trial) {
  auto document = nlohmann::json::parse(trial.document_json, nullptr, false);
  if (!document.is_object()) return nullptr;
  return document;
}

const nlohmann::json& FindValue(const nlohmann::json& document,
                                std::initializer_list<const char*> path) {
  static const nlohmann::json none;
  const nlohmann::json* at = &document;
  for (const char* name : path) {
    const auto found = at->find(name);
    if (found == at->end()) return none;
    at = &*found;
  }
  return *at;
}

}  // namespace touchdown::report
