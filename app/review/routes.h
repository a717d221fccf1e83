// What the page asks for, and the answers.
//
//   GET  /                        the page; /page/NAME its files
//   GET  /api/stamp               {"stamp", "store"}: the stamp differs when
//                                 the store changed
//   GET  /api/trials              touchdown.review.trials/1
//   GET  /api/statistics          touchdown.review.statistics/1
//   GET  /api/plots/N             SVG of the N-th group of it
//   GET  /api/trials/ID           touchdown.review.trial/1; ?revision=N
//   GET  /api/trials/ID/frames/N  a picture
//   GET  /api/trials/ID/thumbnail a small picture of the contact
//   GET  /api/trials/ID/trajectory.csv  ?revision=N
//   POST /api/trials/ID/preview   a correction, judged and not stored
//   POST /api/trials/ID/revisions stored (corrections.h)
//   POST /api/log                 a trial by hand (logging.h)
//   POST /api/relink              looks for moved recordings (relinking.h)
//   POST /api/report              builds it; GET /report/NAME its files
// and recordings and analyses: recording_routes.h.
#pragma once

#include "app/review/desk.h"
#include "app/review/message.h"

namespace touchdown::review {

// Never throws: trouble becomes an answer with a status and {"error": ...} in
// one line. 400 wrong argument (with "field" where it is one's), 404 nothing
// there, 409 revised by somebody else, 422 a file that cannot be read, 503
// trouble with the store, 507 a file that cannot be written.
Reply Route(Desk& desk, const Request& request);

}  // namespace touchdown::review
