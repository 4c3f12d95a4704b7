#include "collision/world.h"
