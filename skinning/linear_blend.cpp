#include "skinning/linear_blend.h"
