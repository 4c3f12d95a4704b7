#include "acd/decomposition.h"
