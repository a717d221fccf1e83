// Planted: a contact that looks at pixels.
#include "touchdown/vision/footage/clip.h"
