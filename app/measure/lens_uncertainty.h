// What a calibration's own uncertainty does to a contact. A lens's error is
// common to all frames, so it is in no pose's u; it comes in once, at the end.
#pragma once

#include <functional>

#include "touchdown/calib/lens.h"
#include "touchdown/vision/contact/contact.h"

namespace touchdown::pipeline {

// The contacts again, from the same track seen through another lens.
using ContactsThrough =
    std::function<vision::ContactResult(const calib::Lens& lens)>;

// Adds the lens to every uncertainty and to the budgets (JCGM 100, 5.1.2, with
// correlation): along each principal direction of the covariance the lens is
// moved by one standard deviation, the contacts are found again, and the
// changes of a quantity, squared, add up.
void AddLensUncertainty(vision::ContactResult& contacts,
                        const calib::Lens& lens,
                        const calib::LensCovariance& covariance,
                        const ContactsThrough& again);

}  // namespace touchdown::pipeline
