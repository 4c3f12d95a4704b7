#include "tests/bench/generators/sensor_noise.h"

#include "geometry/counts.h"
#include "geometry/random_numbers.h"

#include <array>
#include <cmath>
#include <initializer_list>

namespace lorica {

namespace {

/// Position of the depth sensor of the noisy recordings: in front of the person, at chest height.
const Vec3 kSensor(0.0, 1.1, 3.2);

/// Approximately normal, mean 0, standard deviation 1: a sum of twelve uniforms, so that the result does not depend on
/// library functions.
double normal(RandomNumbers& random) {
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) sum += random.unit();
  return sum;
}

/// Correlated noise, like noise after a tracker's smoothing: standard deviation 1, correlation `memory` from frame to
/// frame.
class Jitter {
 public:
  double next(RandomNumbers& random, double memory) {
    value_ = started_ ? memory * value_ + std::sqrt(1.0 - memory * memory) * normal(random) : normal(random);
    started_ = true;
    return value_;
  }

 private:
  double value_ = 0.0;
  bool started_ = false;
};

/// Tracking difficulty of a joint relative to others: hands and feet are small and fast, the trunk is large.
double difficulty(BodyJoint joint) {
  switch (joint) {
    case BodyJoint::kLeftHand:
    case BodyJoint::kRightHand:
    case BodyJoint::kLeftFoot:
    case BodyJoint::kRightFoot:
      return 1.4;
    case BodyJoint::kTorso:
    case BodyJoint::kNeck:
      return 0.7;
    default:
      return 1.0;
  }
}

void addJitter(std::vector<SkeletonFrame>& frames, RandomNumbers& random) {
  std::array<std::array<Jitter, 6>, kBodyJointCount> jitters;
  for (SkeletonFrame& frame : frames) {
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      TrackedJoint& joint = frame.joints[j];
      const double scale = difficulty(static_cast<BodyJoint>(j));
      const Vec3 view = joint.position - kSensor;
      const double distance = view.norm();
      // The depth error of a structured-light sensor grows with the square of distance (Khoshelham and Elberink 2012,
      // about 1.4 mm per pixel at 1 m); a joint averages many pixels.
      const double sigma = scale * (0.001 + 0.0006 * distance * distance);
      std::array<double, 6> n;
      for (std::size_t i = 0; i < 6; ++i) n[i] = jitters[j][i].next(random, i < 3 ? 0.55 : 0.75);
      joint.position += 0.5 * sigma * Vec3(n[0], n[1], n[2]) + 0.7 * sigma * n[2] * view / distance;
      const Vec3 turn = scale * 0.03 * Vec3(n[3], n[4], n[5]);
      if (joint.orientation && turn.norm() > 0.0) {
        *joint.orientation = Quat(Eigen::AngleAxisd(turn.norm(), turn.normalized())) * *joint.orientation;
      }
    }
  }
}

/// From `begin` on the tracker guesses, then has lost the joints, then guesses again until `end`.
void lose(std::vector<SkeletonFrame>& frames, std::initializer_list<BodyJoint> joints, int begin, int lostBegin,
          int lostEnd, int end, RandomNumbers& random) {
  for (const BodyJoint j : joints) {
    // Braces fix the order of evaluation; that of call arguments is unspecified.
    const std::array<double, 3> n{random.between(-1.0, 1.0), random.between(-1.0, 0.6), random.between(-1.0, 1.0)};
    const Vec3 drift(n[0], n[1], n[2]);
    Vec3 lastGuess = Vec3::Zero();
    for (int f = begin; f < end; ++f) {
      TrackedJoint& joint = frames[f][j];
      if (f < lostBegin || f >= lostEnd) {
        // A guess deviates by up to 4 cm, more the closer to the loss.
        const double closeness =
            f < lostBegin ? (f - begin + 1.0) / (lostBegin - begin) : (end - f + 0.0) / (end - lostEnd);
        joint.position += 0.04 * closeness * drift;
        joint.confidence = 0.5;
        lastGuess = joint.position;
      } else {
        // Trackers then report a stale position; a reader must not trust it.
        joint.position = lastGuess;
        joint.orientation.reset();
        joint.confidence = 0.0;
      }
    }
  }
}

}  // namespace

std::vector<SkeletonFrame> addSensorNoise(std::vector<SkeletonFrame> frames, std::uint64_t seed) {
  RandomNumbers random(seed);
  addJitter(frames, random);

  using enum BodyJoint;
  const std::array<std::array<BodyJoint, 2>, 4> limbs{
      {{kLeftElbow, kLeftHand}, {kRightElbow, kRightHand}, {kLeftKnee, kLeftFoot}, {kRightKnee, kRightFoot}}};
  const int count = countOf(frames);
  for (const auto& [middle, end] : limbs) {
    const auto between = [&](int low, int high) { return low + static_cast<int>(random.unit() * (high - low + 1)); };
    int frame = between(20, 90);
    while (true) {
      const int guess = between(2, 6);
      const int lost = between(5, 27);
      const int again = between(2, 5);
      if (frame + guess + lost + again >= count) break;
      const bool both = random.unit() < 0.6;
      const int lostBegin = frame + guess;
      const int lostEnd = lostBegin + lost;
      if (both) {
        lose(frames, {middle, end}, frame, lostBegin, lostEnd, lostEnd + again, random);
      } else {
        lose(frames, {end}, frame, lostBegin, lostEnd, lostEnd + again, random);
      }
      frame = lostEnd + again + between(20, 110);
    }
  }
  return frames;
}

}  // namespace lorica
