#include "geometry/files.h"
