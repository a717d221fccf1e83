// What the page asks for, and the answers.
//
//   GET  /                     the page; /page/NAME its files
//   GET  /api/stamp            {"stamp"}: differs when the store changed
//   GET  /api/trials           touchdown.review.trials/1
//   GET  /api/statistics       touchdown.review.statistics/1
//   GET  /api/plots/N          SVG of the N-th group of it
#pragma once

#include "app/review/desk.h"
#include "app/review/message.h"

namespace touchdown::review {

// Never throws: trouble becomes an answer with a status and {"error": ...} in
// one line. 400 wrong argument, 404 nothing there, 409 revised by somebody
// else, 422 a file that cannot be read, 503 trouble with the store.
Reply Route(Desk& desk, const Request& request);

}  // namespace touchdown::review
