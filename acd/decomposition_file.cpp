#include "acd/decomposition_file.h"
