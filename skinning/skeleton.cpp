#include "skinning/skeleton.h"
