// db seal, and what `db check --against` does with a seal.
#pragma once

#include <string>

#include "app/cli/command.h"
#include "touchdown/db/store.h"

namespace touchdown::cli {

void AddSeal(CLI::App& db, Action& action);

// `seal`: a seal's file, or its head. Says on stdout what agrees; throws
// core::StoreError naming the first row that does not.
void CheckSeal(const db::Store& store, const std::string& seal);

}  // namespace touchdown::cli
