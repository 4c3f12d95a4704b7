#include "tests/bench/generators/motion_measures.h"

#include <algorithm>
#include <cmath>

namespace lorica::measures {

using enum BodyJoint;

double angleBetween(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

double segmentDistance(const Vec3& a0, const Vec3& a1, const Vec3& b0, const Vec3& b1) {
  // Distance to a segment is convex along the other, so a ternary search finds the minimum.
  const auto toB = [&](const Vec3& p) {
    const Vec3 d = b1 - b0;
    const double t = d.squaredNorm() > 0.0 ? std::clamp((p - b0).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0.0;
    return (p - b0 - t * d).norm();
  };
  double low = 0.0;
  double high = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double l = low + (high - low) / 3.0;
    const double h = high - (high - low) / 3.0;
    if (toB(a0 + l * (a1 - a0)) < toB(a0 + h * (a1 - a0))) {
      high = h;
    } else {
      low = l;
    }
  }
  return toB(a0 + low * (a1 - a0));
}

std::array<Vec3, 3> soleOf(const SkeletonFrame& frame, BodyJoint foot) {
  const TrackedJoint& joint = frame[foot];
  const auto at = [&](double ahead) -> Vec3 { return joint.position + *joint.orientation * Vec3(0.0, -0.085, ahead); };
  return {at(-0.05), at(0.145), at(0.185)};
}

std::vector<Capsule> bodyOf(const SkeletonFrame& f) {
  const auto at = [&](BodyJoint j) { return f[j].position; };
  const Vec3 hips = 0.5 * (at(kLeftHip) + at(kRightHip));
  // The trunk ends below the shoulders; the head is a ball.
  const Vec3 chest = at(kTorso) + 0.65 * (at(kNeck) - at(kTorso));
  std::vector<Capsule> body{{"trunk", hips, chest, 0.12}, {"head", at(kHead), at(kHead), 0.10}};
  const auto side = [&](const std::string& name, BodyJoint shoulder, BodyJoint elbow, BodyJoint hand, BodyJoint hip,
                        BodyJoint knee, BodyJoint foot) {
    body.push_back({name + " upper arm", at(shoulder), at(elbow), 0.045});
    body.push_back({name + " forearm", at(elbow), at(hand), 0.04});
    body.push_back({name + " thigh", at(hip), at(knee), 0.07});
    body.push_back({name + " shin", at(knee), at(foot), 0.05});
    const auto sole = soleOf(f, foot);
    const Vec3 up = *f[foot].orientation * Vec3(0.0, 0.03, 0.0);
    body.push_back({name + " foot", sole[0] + up, sole[1] + up, 0.03});
  };
  side("left", kLeftShoulder, kLeftElbow, kLeftHand, kLeftHip, kLeftKnee, kLeftFoot);
  side("right", kRightShoulder, kRightElbow, kRightHand, kRightHip, kRightKnee, kRightFoot);
  return body;
}

bool adjacent(const std::string& a, const std::string& b) {
  const auto is = [&](const std::string& x, const std::string& y) { return (a == x && b == y) || (a == y && b == x); };
  if (is("trunk", "head")) return true;
  for (const std::string side : {"left ", "right "}) {
    if (is("trunk", side + "upper arm") || is("trunk", side + "thigh") || is(side + "upper arm", side + "forearm") ||
        is(side + "thigh", side + "shin") || is(side + "shin", side + "foot")) {
      return true;
    }
  }
  return false;
}

Vec3 massCentre(const SkeletonFrame& f) {
  const auto along = [&](BodyJoint a, BodyJoint b, double share) -> Vec3 {
    return f[a].position + share * (f[b].position - f[a].position);
  };
  const Vec3 hips = along(kLeftHip, kRightHip, 0.5);
  const Vec3 trunk = 0.284 * along(kTorso, kNeck, 0.5) + 0.213 * 0.5 * (hips + f[kTorso].position);
  const Vec3 arms = 0.028 * (along(kLeftShoulder, kLeftElbow, 0.44) + along(kRightShoulder, kRightElbow, 0.44)) +
                    0.022 * (along(kLeftElbow, kLeftHand, 0.68) + along(kRightElbow, kRightHand, 0.68));
  const Vec3 legs = 0.100 * (along(kLeftHip, kLeftKnee, 0.43) + along(kRightHip, kRightKnee, 0.43)) +
                    0.0465 * (along(kLeftKnee, kLeftFoot, 0.43) + along(kRightKnee, kRightFoot, 0.43)) +
                    0.0145 * (f[kLeftFoot].position + f[kRightFoot].position);
  return 0.081 * f[kHead].position + trunk + arms + legs;
}

Mat3 pelvisAxes(const SkeletonFrame& f) {
  const Vec3 hips = 0.5 * (f[kLeftHip].position + f[kRightHip].position);
  Mat3 axes;
  axes.col(1) = (f[kTorso].position - hips).normalized();
  axes.col(0) = f[kLeftHip].position - f[kRightHip].position;
  axes.col(0) = (axes.col(0) - axes.col(0).dot(axes.col(1)) * axes.col(1)).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

}  // namespace lorica::measures
