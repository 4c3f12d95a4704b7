#include "capture/confidence_hold.h"
