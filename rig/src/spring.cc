#include "touchdown/rig/spring.h"
