#include "capture/synthetic_motion.h"
