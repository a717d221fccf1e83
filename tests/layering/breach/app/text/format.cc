// An arrow that goes back: a planted breach.
#include "app/report/report.h"
