#pragma once

#include "acd/decomposition.h"
#include "geometry/mesh_files.h"
#include "skinning/character.h"
#include "viewer/player/snapshots.h"

#include <span>
#include <vector>

namespace lorica {

/// The number of each part's colour, see partColor(): that of the bone that moves most of it, so that left and right
/// tell apart and a body looks the same however it was decomposed. No two parts have the same number.
[[nodiscard]] std::vector<PartIndex> colorsOfParts(const Decomposition& decomposition, const Character& character);

/// The axis of a mesh that points up.
enum class UpAxis {
  kY,
  kZ,
};

/// Z if the parts stand far broader on their lowest Z than on their lowest Y, as what many programs for CAD write; else
/// Y.
[[nodiscard]] UpAxis likelyUp(std::span<const NamedMesh> parts);

/// Draws convex parts, each in its colour, on the floor and as large as the picture allows, whatever their unit.
[[nodiscard]] Image drawParts(std::span<const NamedMesh> parts, UpAxis up, SnapshotCamera& camera);

}  // namespace lorica
