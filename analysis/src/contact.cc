#include "touchdown/analysis/contact.h"
