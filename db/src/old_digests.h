// The digests of versions 5 to 7 of the store, one for each trial, clip and
// plan, which the chain (chain.h) took the place of.
//
//   D(0) = ""
//   D(n) = SHA-256("touchdown.trial/1\n" D(n-1) "\n" rows of revision n)
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "statement.h"

namespace touchdown::db {

// What does not agree with its digest, one line each, in a store of `version`
// as it stands: an upgrade must not take what was altered for what was
// recorded. Nothing of a version that had no digests.
void CheckOldDigests(Connection& connection, std::int64_t version,
                     std::vector<std::string>& problems);

}  // namespace touchdown::db
