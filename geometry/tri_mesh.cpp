#include "geometry/tri_mesh.h"
