#pragma once

#include "capture/virtual_sensor/virtual_performer.h"
#include "geometry/random_numbers.h"

#include <vector>

namespace lorica::bench {

/// Bodies of many proportions in clothes, and a library of poses for all of them.
class RandomPeople {
 public:
  RandomPeople(int bodies, int poses, RandomNumbers& random);

  /// A body in a pose: on the floor, hips above the origin, facing +Z.
  struct Person {
    std::vector<Vec3> positions;
    std::span<const Triangle> triangles;
    SurfaceSides sides = SurfaceSides::kBoth;
    double hips = 0.0;  ///< height [m]
    bool sits = false;
  };
  [[nodiscard]] Person draw(RandomNumbers& random);

 private:
  std::vector<VirtualPerformer> bodies_;
  std::vector<bool> sits_;  ///< of each pose
};

/// Normal deviate.
[[nodiscard]] double normal(RandomNumbers& random, double spread);

}  // namespace lorica::bench
