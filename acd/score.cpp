#include "acd/score.h"
