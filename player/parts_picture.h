#pragma once

#include "geometry/mesh_files.h"
#include "player/snapshots.h"

#include <span>

namespace lorica {

/// Draws convex parts, each in its colour, on the floor and as large as the picture allows, whatever their unit.
/// @param parts  Y up
[[nodiscard]] Image drawParts(std::span<const NamedMesh> parts, SnapshotCamera& camera);

}  // namespace lorica
