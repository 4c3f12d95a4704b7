#include "viewer/image.h"
