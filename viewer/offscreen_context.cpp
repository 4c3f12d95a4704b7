#include "viewer/renderer.h"
