#include "touchdown/db/store.h"
