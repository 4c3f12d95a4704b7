#include "skinning/mannequin/mannequin_sculpt.h"

namespace lorica {

namespace {

/// Displaces points within an ellipsoid, most at its centre, falling smoothly to zero at its border. [m]
struct Stroke {
  double centre[3];
  double radii[3];
  double push[3];
};

constexpr Stroke kStrokes[] = {
    // Face: nose, eye socket, brow, cheekbone, groove under the nose, lips, chin, ear.
    {{0.0, 1.618, 0.104}, {0.021, 0.036, 0.040}, {0.0, -0.004, 0.018}},
    {{0.031, 1.645, 0.088}, {0.024, 0.018, 0.040}, {0.0, 0.0, -0.011}},
    {{0.028, 1.668, 0.092}, {0.036, 0.013, 0.030}, {0.0, 0.0, 0.004}},
    {{0.055, 1.622, 0.070}, {0.036, 0.034, 0.036}, {0.002, 0.0, 0.003}},
    {{0.0, 1.589, 0.098}, {0.022, 0.008, 0.030}, {0.0, 0.0, -0.003}},
    {{0.0, 1.576, 0.098}, {0.030, 0.013, 0.030}, {0.0, 0.0, 0.005}},
    {{0.0, 1.543, 0.094}, {0.032, 0.018, 0.030}, {0.0, 0.0, 0.005}},
    {{0.078, 1.634, -0.010}, {0.030, 0.038, 0.024}, {0.011, 0.002, -0.007}},
    // Chest: its muscle and the groove over the breastbone; the hollow above the collarbone.
    {{0.082, 1.335, 0.090}, {0.095, 0.085, 0.075}, {0.0, 0.0, 0.011}},
    {{0.0, 1.320, 0.110}, {0.024, 0.090, 0.050}, {0.0, 0.0, -0.005}},
    {{0.080, 1.460, 0.022}, {0.050, 0.022, 0.040}, {0.0, -0.005, -0.004}},
    // Belly: the arch of the ribs, the line down the middle.
    {{0.0, 1.200, 0.105}, {0.055, 0.055, 0.050}, {0.0, 0.0, -0.005}},
    {{0.0, 1.090, 0.095}, {0.016, 0.120, 0.040}, {0.0, 0.0, -0.003}},
    // The end of the belly between the thighs.
    {{0.0, 0.850, 0.070}, {0.080, 0.070, 0.060}, {0.0, -0.004, 0.008}},
    {{0.034, 0.812, 0.030}, {0.034, 0.040, 0.050}, {0.0, -0.003, 0.012}},
    // Back: the furrow of the spine, shoulder blade, buttock.
    {{0.0, 1.200, -0.100}, {0.032, 0.270, 0.060}, {0.0, 0.0, 0.009}},
    {{0.088, 1.365, -0.110}, {0.060, 0.085, 0.050}, {0.0, 0.0, -0.009}},
    {{0.078, 0.872, -0.100}, {0.092, 0.115, 0.085}, {0.0, 0.0, -0.030}},
    // Elbow, kneecap, inner calf, both ankle bones, big toe.
    {{0.458, 1.409, -0.060}, {0.030, 0.024, 0.026}, {0.0, 0.0, -0.004}},
    {{0.097, 0.500, 0.052}, {0.048, 0.060, 0.050}, {0.0, 0.0, 0.005}},
    {{0.070, 0.355, -0.065}, {0.045, 0.095, 0.050}, {-0.004, 0.0, -0.005}},
    {{0.130, 0.090, -0.038}, {0.022, 0.024, 0.026}, {0.006, 0.0, 0.0}},
    {{0.068, 0.096, -0.032}, {0.022, 0.024, 0.026}, {-0.006, 0.0, 0.0}},
    {{0.086, 0.014, 0.155}, {0.028, 0.024, 0.030}, {-0.002, 0.001, 0.008}},
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
