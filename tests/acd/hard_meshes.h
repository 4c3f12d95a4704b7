#pragma once

#include "acd/decompose.h"
#include "geometry/counts.h"

#include <cstdint>
#include <random>
#include <vector>

namespace lorica::test {

/// Random numbers that are the same on every machine, unlike the distributions of the standard library.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }  ///< in [0, 1)
  double between(double low, double high) { return low + (high - low) * unit(); }
  int whole(int low, int high) {
    return low + static_cast<int>(engine_() % static_cast<std::uint64_t>(high - low + 1));
  }
  /// An element of a list.
  const auto& oneOf(const auto& list) { return list[whole(0, countOf(list) - 1)]; }
  bool oneIn(int n) { return whole(1, n) == 1; }
  Vec3 inBox(double halfSide);
  Quat rotation();

 private:
  std::mt19937_64 engine_;
};

/// A difficult mesh, and the properties that its decomposition must have.
struct HardMesh {
  TriMesh mesh;
  std::vector<Vec3> keyframes;  ///< keyframe-major; the first is the mesh's own pose
  /// In the mesh's own pose the winding number is negative nowhere: the surface is neither inside out nor folded over.
  /// Only then is a part's volume the integral of a non-negative function.
  bool solid = true;
};

/// Kinds of hard meshes; every call creates a new random one.
HardMesh cubesOnAGrid(Dice& dice);
HardMesh severalComponents(Dice& dice);
HardMesh nestedShells(Dice& dice);
HardMesh manyHandles(Dice& dice);
HardMesh slivers(Dice& dice);
HardMesh duplicateAndCollinearVertices(Dice& dice);
HardMesh spikes(Dice& dice);
HardMesh prisms(Dice& dice);
HardMesh overlappingShells(Dice& dice);
HardMesh crumpled(Dice& dice);
HardMesh extremeSizes(Dice& dice);
HardMesh farFromTheOrigin(Dice& dice);
HardMesh smoothMotion(Dice& dice);
HardMesh violentMotion(Dice& dice);
HardMesh partsThatBecomeFlat(Dice& dice);

}  // namespace lorica::test
