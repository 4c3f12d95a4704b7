#include "capture/files/joint_stream_layouts.h"
#include "capture/files/joint_stream_text.h"
#include "geometry/counts.h"

#include <limits>
#include <utility>

/// Sensor joint names, and the mapping from sensor joints to the 15 body joints.
namespace lorica::joints {
namespace {

using enum SensorJoint;

/// Those of Kinect v2 in its order, then what Kinect v1 calls the first, second and 21st of them.
constexpr std::array<std::string_view, kSensorJointCount + 3> kNames = {
    "SpineBase",   "SpineMid",      "Neck",         "Head",       "ShoulderLeft", "ElbowLeft", "WristLeft",
    "HandLeft",    "ShoulderRight", "ElbowRight",   "WristRight", "HandRight",    "HipLeft",   "KneeLeft",
    "AnkleLeft",   "FootLeft",      "HipRight",     "KneeRight",  "AnkleRight",   "FootRight", "SpineShoulder",
    "HandTipLeft", "ThumbLeft",     "HandTipRight", "ThumbRight", "HipCenter",    "Spine",     "ShoulderCenter"};

using NamedJoint = std::pair<std::string_view, SensorJoint>;
/// What other sensors and programs call joints of the trunk.
constexpr std::array<NamedJoint, 11> kTrunkNames = {{{"pelvis", kSpineBase},
                                                     {"hips", kSpineBase},
                                                     {"midhip", kSpineBase},
                                                     {"hipscenter", kSpineBase},
                                                     {"torso", kSpineMid},
                                                     {"spinenavel", kSpineMid},
                                                     {"abdomen", kSpineMid},
                                                     {"chest", kSpineShoulder},
                                                     {"spinechest", kSpineShoulder},
                                                     {"shouldercentre", kSpineShoulder},
                                                     {"hipcentre", kSpineBase}}};

/// Source of each body joint.
constexpr std::array<SensorJoint, kBodyJointCount> kSources = {
    kHead,     kNeck,    kShoulderLeft, kShoulderRight, kElbowLeft, kElbowRight, kHandLeft,  kHandRight,
    kSpineMid, kHipLeft, kHipRight,     kKneeLeft,      kKneeRight, kAnkleLeft,  kAnkleRight};

/// What is used if a source is not seen.
SensorJoint substituteOf(SensorJoint joint) {
  if (joint == kNeck) return kSpineShoulder;
  if (joint == kHandLeft) return kWristLeft;
  return joint == kHandRight ? kWristRight : joint;
}

}  // namespace

std::optional<SensorJoint> sensorJointNamed(std::string_view name) {
  constexpr std::array<SensorJoint, 3> kOfKinect1 = {kSpineBase, kSpineMid, kSpineShoulder};
  for (int i = 0; i < countOf(kNames); ++i) {
    if (!sameWord(kNames[i], name)) continue;
    return i < kSensorJointCount ? static_cast<SensorJoint>(i) : kOfKinect1[i - kSensorJointCount];
  }
  return std::nullopt;
}

std::optional<SensorJoint> sensorJointCalled(std::string_view name) {
  if (const std::optional<SensorJoint> joint = sensorJointNamed(name)) return joint;
  for (const auto& [called, joint] : kTrunkNames) {
    if (name == called) return joint;
  }
  for (const auto& [word, side] : {std::pair("left", "Left"), {"right", "Right"}, {"l", "Left"}, {"r", "Right"}}) {
    const std::string_view sideWord = word;
    if (name.starts_with(sideWord)) {
      if (const auto joint = sensorJointNamed(std::string(name.substr(sideWord.size())) + side)) return joint;
    }
    if (name.ends_with(sideWord)) {
      if (const auto joint = sensorJointNamed(std::string(name.substr(0, name.size() - sideWord.size())) + side))
        return joint;
    }
  }
  return std::nullopt;
}

void SensorSkeleton::set(const SensedJoint& seen) {
  TrackedJoint& joint = (*this)[seen.joint];
  joint = {};
  if (!seen.position) return;
  joint = {*seen.position, seen.orientation, seen.confidence};
}

Observation observe(const SensorSkeleton& body, double time, int person) {
  Observation row;
  row.frame.time = time;
  row.frame.user = person;
  for (int j = 0; j < kBodyJointCount; ++j) {
    const SensorJoint from = body[kSources[j]].confidence > 0.0 ? kSources[j] : substituteOf(kSources[j]);
    if (body[from].confidence > 0.0) row.frame.joints[j] = body[from];
  }
  if (body[kFootLeft].confidence > 0.0) row.toes[0] = body[kFootLeft].position;
  if (body[kFootRight].confidence > 0.0) row.toes[1] = body[kFootRight].position;
  return row;
}

std::optional<Vec3> positionOf(const SkeletonFrame& frame) {
  for (const BodyJoint j : {BodyJoint::kTorso, BodyJoint::kNeck}) {
    if (frame[j].confidence > 0.0) return frame[j].position;
  }
  Vec3 sum = Vec3::Zero();
  double count = 0.0;
  for (const TrackedJoint& joint : frame.joints) {
    if (!(joint.confidence > 0.0)) continue;
    sum += joint.position;
    count += 1.0;
  }
  if (count == 0.0) return std::nullopt;
  return Vec3(sum / count);
}

int PersonTracks::personAt(double time, const SkeletonFrame& frame) {
  // Max distance between two readings of the same person's trunk [m].
  constexpr double kSamePosition = 0.4;
  // More people are never seen at once. The limit keeps a damaged file from creating a list that every row is compared
  // with.
  constexpr std::size_t kMaxPersons = 16;
  const std::optional<Vec3> position = positionOf(frame);
  if (tracks_.empty()) {
    tracks_.push_back({position.value_or(Vec3::Zero()), time});
    return 1;
  }
  std::size_t nearest = tracks_.size();
  double nearestDistance = std::numeric_limits<double>::infinity();
  bool someoneSeenNow = false;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const bool seenNow = tracks_[i].time == time;
    someoneSeenNow = someoneSeenNow || seenNow;
    const double distance = position ? (tracks_[i].position - *position).norm() : 0.0;
    if (seenNow && distance > kSamePosition) continue;
    if (distance < nearestDistance) {
      nearestDistance = distance;
      nearest = i;
    }
  }
  if (someoneSeenNow && nearestDistance > kSamePosition) {
    // Take the nearest person not yet seen in this frame; beyond kReach it is a new person.
    constexpr double kReach = 1.0;
    if (nearest == tracks_.size() || (nearestDistance > kReach && tracks_.size() < kMaxPersons)) {
      if (tracks_.size() < kMaxPersons) {
        tracks_.push_back({*position, time});
        return static_cast<int>(tracks_.size());
      }
      nearest = tracks_.size() - 1;
    }
  }
  tracks_[nearest] = {position.value_or(tracks_[nearest].position), time};
  return static_cast<int>(nearest + 1);
}

}  // namespace lorica::joints
