#include "capture/retarget.h"
