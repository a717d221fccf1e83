// A planted breach: includes.cmake must refuse this tree.
#include <sqlite3.h>
