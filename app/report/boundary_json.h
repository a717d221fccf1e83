// The document touchdown.boundary/1. Scripts depend on its names: fields are
// added, never renamed.
#pragma once

#include <span>

#include "app/report/group.h"
#include "app/report/report.h"
#include "app/text/json.h"
#include "touchdown/core/trial.h"

namespace touchdown::report {

// One group of trials: counts, bracket, posterior, likelihood, status, theory,
// next. Degrees everywhere; what is absent is null.
Json BoundaryJson(const Group& group);

// The whole answer of `touchdown boundary`: the fields of BoundaryJson() beside
// `schema` where there is one group, else under `groups`.
Json BoundaryDocument(std::span<const Group> groups);

// touchdown.report/1: every group with every trial.
Json ReportDocument(const ReportInput& input, std::span<const Group> groups,
                    std::span<const core::Trial> trials);

}  // namespace touchdown::report
