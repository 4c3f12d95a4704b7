#include "collision/live_body.h"
