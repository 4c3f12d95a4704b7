#include "viewer/scene.h"
