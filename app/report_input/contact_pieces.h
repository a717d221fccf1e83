// The pieces of a recording that show a contact: before, at and after it.
#pragma once

#include "app/measure/analyze.h"
#include "app/report/contact_strip.h"

namespace touchdown::pipeline {

// Reads three frames of the analysis's recording. The analysis has a track and
// a plane with samples. Throws core::InputError where the recording cannot be
// read.
report::ContactStrip TakeStrip(const Analysis& analysis);

}  // namespace touchdown::pipeline
