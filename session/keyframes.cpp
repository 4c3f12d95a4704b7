#include "session/keyframes.h"
