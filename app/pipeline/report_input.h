// Selected trials as the report takes them.
#pragma once

#include "app/pipeline/trial_selection.h"
#include "app/report/report.h"

namespace touchdown::pipeline {

// With this program's version; theories and study are the defaults.
report::ReportInput InputOf(Selection selection);

}  // namespace touchdown::pipeline
