#pragma once

#include "viewer/renderer/scene.h"

namespace lorica {

/// A camera that orbits around a target point, controlled by the mouse. The user cannot bring the eye or the target
/// below the floor (y = 0).
class OrbitCamera {
 public:
  explicit OrbitCamera(const Camera& start = {});

  /// Rotates by angles [rad]: to the right around Y, and upward, limited to just below the poles.
  void turn(double right, double up);
  /// Moves target and eye right and up in the picture, as fractions of the picture's height.
  void pan(double right, double up);
  /// Multiplies the distance by a factor, clamped to 0.2 m to 60 m.
  void zoom(double factor);
  void reset();
  /// Moves target and eye, also those of the start [m].
  void carry(const Vec3& by);
  /// Moves the target to a point; the direction of the view stays.
  void aimAt(const Vec3& point);
  /// Looks at the target from a direction. @param azimuth  around Y, 0 = from +Z [rad] @param elevation  [rad]
  void lookFrom(double azimuth, double elevation);

  [[nodiscard]] Camera camera() const;

 private:
  void stayAboveFloor();

  Camera start_;
  Vec3 target_;
  double azimuth_ = 0.0;    ///< around Y, 0 at +Z [rad]
  double elevation_ = 0.0;  ///< above the horizon [rad]
  double distance_ = 1.0;   ///< [m]
};

}  // namespace lorica
