#pragma once

#include "viewer/scene.h"

namespace lorica {

/// A camera that turns about a point: what the mouse moves.
class OrbitCamera {
 public:
  explicit OrbitCamera(const Camera& start = {});

  /// Turns by angles [rad]: to the right around Y, and upward, which stops short of the poles.
  void turn(double right, double up);
  /// Moves target and eye sideways and up in the picture, in shares of the picture's height.
  void pan(double right, double up);
  /// Multiplies the distance; it stays between 0.2 m and 60 m.
  void zoom(double factor);
  void reset();

  [[nodiscard]] Camera camera() const;

 private:
  Camera start_;
  Vec3 target_;
  double azimuth_ = 0.0;    ///< around Y, 0 at +Z [rad]
  double elevation_ = 0.0;  ///< above the horizon [rad]
  double distance_ = 1.0;   ///< [m]
};

}  // namespace lorica
