#pragma once

#include "acd/decompose.h"

#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace lorica::test {

/// The same numbers on every machine, unlike the distributions of the standard library.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }  ///< 0 to 1, without 1
  double between(double low, double high) { return low + (high - low) * unit(); }
  int whole(int low, int high) {
    return low + static_cast<int>(engine_() % static_cast<std::uint64_t>(high - low + 1));
  }
  bool oneIn(int n) { return whole(1, n) == 1; }
  Vec3 inBox(double halfSide);
  Quat rotation();

 private:
  std::mt19937_64 engine_;
};

/// A mesh made to break things, and what may be asked of its decomposition.
struct HardMesh {
  TriMesh mesh;
  std::vector<Vec3> keyframes;  ///< keyframe-major; the first is the mesh's own pose
  /// Nowhere does the surface wind round a point the wrong way in its own pose: neither inside out nor folded over.
  /// Only then is a part's volume the integral of something that is never negative.
  bool solid = true;
};

/// Kinds of hard meshes; every call rolls a new one.
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
