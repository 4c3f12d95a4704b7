#include "geometry/mesh_files.h"
