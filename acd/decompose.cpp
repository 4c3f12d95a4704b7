#include "acd/decompose.h"
