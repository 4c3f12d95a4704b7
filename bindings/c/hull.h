#pragma once

#include "acd/decompose.h"
#include "bindings/c/lorica.h"
#include "geometry/convex_hull.h"

namespace lorica {

/// Lends a hull to a program.
[[nodiscard]] Result<void> handOut(const ConvexHull& hull, lorica_hull* out);

/// A function of the program as a callback of the library. @param progress  may be null
[[nodiscard]] DecomposeProgress progressFrom(lorica_progress progress, void* user);

}  // namespace lorica
