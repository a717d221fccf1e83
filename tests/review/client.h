// HTTP as a client asks.
#pragma once

#include <httplib.h>

// A macro of <resolv.h>, which httplib brings along; Eigen has parameters of
// that name.
#undef _res
