#include "bench/virtual_furniture.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace lorica {
namespace {

/// All kinds with many seeds; seats last.
template <typename Act>
void eachPiece(const Act& act) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    for (int kind = 0; kind <= kFurnitureKindCount; ++kind) {
      RandomNumbers random(100 * seed + static_cast<std::uint64_t>(kind));
      const bool seat = kind == kFurnitureKindCount;
      act(seat ? makeSeat(0.45, random) : makeFurniture(static_cast<FurnitureKind>(kind), random), kind);
    }
  }
}

TEST(VirtualFurniture, StandsOnTheFloorWithinAHumanRoom) {
  eachPiece([](const Furniture& piece, int kind) {
    SCOPED_TRACE(kind);
    ASSERT_FALSE(piece.triangles.empty());
    double low = 1e9, high = -1e9;
    for (const Vec3& position : piece.positions) {
      ASSERT_TRUE(position.allFinite());
      low = std::min(low, position.y());
      high = std::max(high, position.y());
    }
    EXPECT_LT(low, 0.45);
    EXPECT_GT(low, -0.6);
    EXPECT_GT(high, 0.2);
    EXPECT_LT(high, 2.6);
    for (const Triangle& triangle : piece.triangles) {
      for (const int corner : triangle) {
        ASSERT_GE(corner, 0);
        ASSERT_LT(static_cast<std::size_t>(corner), piece.positions.size());
      }
    }
  });
}

TEST(VirtualFurniture, TheSameNumbersGiveTheSamePiece) {
  std::vector<std::vector<Vec3>> first, second;
  eachPiece([&](const Furniture& piece, int) { first.push_back(piece.positions); });
  eachPiece([&](const Furniture& piece, int) { second.push_back(piece.positions); });
  EXPECT_EQ(first, second);
}

TEST(VirtualFurniture, IsMovedRigidly) {
  eachPiece([](const Furniture& piece, int kind) {
    SCOPED_TRACE(kind);
    Furniture placed = piece;
    placed.place({1.0, 0.0, -2.0}, 0.7);
    for (std::size_t v = 1; v < piece.positions.size(); ++v) {
      const double before = (piece.positions[v] - piece.positions[0]).norm();
      EXPECT_NEAR((placed.positions[v] - placed.positions[0]).norm(), before, 1e-9);
      EXPECT_NEAR(placed.positions[v].y(), piece.positions[v].y(), 1e-9);
    }
  });
}

}  // namespace
}  // namespace lorica
