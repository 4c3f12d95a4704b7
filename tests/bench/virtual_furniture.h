#pragma once

#include "capture/virtual_sensor/depth_render.h"
#include "geometry/random_numbers.h"

#include <cstdint>
#include <vector>

namespace lorica {

/// What stands in a furnished room.
enum class FurnitureKind : std::uint8_t {
  kTable,
  kChair,
  kArmchair,
  kSofa,
  kShelf,
  kCupboard,
  kPlant,
  kCoatStand,
  kBed,
  kCurtain,
  kDoorFrame,
  kHeap,  ///< of bags, a ball, a stool or a column
  kDesk,  ///< with a computer
};
inline constexpr int kFurnitureKindCount = 13;

/// The surface of a piece of furniture: both sides are visible. It stands on the floor y = 0 and faces +Z [m].
struct Furniture {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
  Vec3 half = Vec3::Zero();  ///< half the width, the height, half the depth

  /// Turns it about +Y and moves it.
  void place(const Vec3& at, double yaw);
  /// Draws it with label 0.
  void draw(const Isometry3& cameraFromWorld, DepthRenderer& renderer) const;
};

/// A piece with random measures, usual in rooms; the same numbers give the same piece.
[[nodiscard]] Furniture makeFurniture(FurnitureKind kind, RandomNumbers& random);

/// A chair, bench, sofa or wheelchair for a person whose hips are above the origin.
/// @param height  of the seat [m]
[[nodiscard]] Furniture makeSeat(double height, RandomNumbers& random);

}  // namespace lorica
