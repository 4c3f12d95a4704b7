#include "capture/skeleton_frame.h"
