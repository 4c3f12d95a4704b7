#include "skinning/mannequin_sculpt.h"

namespace lorica {

namespace {

/// Pushes what lies within an ellipsoid, most at its centre, smoothly to nothing at its border. [m]
struct Stroke {
  double centre[3];
  double radii[3];
  double push[3];
};

constexpr Stroke kStrokes[] = {
    // Face: nose, eye socket, brow, cheekbone, lips, chin, ear.
    {{0.0, 1.618, 0.104}, {0.020, 0.034, 0.040}, {0.0, -0.004, 0.017}},
    {{0.031, 1.644, 0.088}, {0.024, 0.018, 0.040}, {0.0, 0.0, -0.011}},
    {{0.0, 1.588, 0.098}, {0.022, 0.008, 0.030}, {0.0, 0.0, -0.003}},
    {{0.0, 1.577, 0.098}, {0.030, 0.012, 0.030}, {0.0, 0.0, 0.005}},
    {{0.078, 1.635, -0.006}, {0.030, 0.034, 0.020}, {0.014, 0.0, -0.006}},
};

}  // namespace

void sculptMannequin(std::span<Vec3> points) {
  for (Vec3& p : points) {
    const bool inPlane = p.x() == 0.0;
    Vec3 moved = p;
    for (const Stroke& stroke : kStrokes) {
      const Eigen::Map<const Vec3> centre(stroke.centre);
      const Eigen::Map<const Vec3> radii(stroke.radii);
      const Eigen::Map<const Vec3> push(stroke.push);
      const double distanceSq = (p - centre).cwiseQuotient(radii).squaredNorm();
      if (distanceSq >= 1.0) continue;
      const double rest = 1.0 - distanceSq;
      moved += rest * rest * push;
    }
    p = moved;
    if (inPlane) p.x() = 0.0;
  }
}

}  // namespace lorica
