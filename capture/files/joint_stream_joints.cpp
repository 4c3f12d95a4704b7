#include "capture/files/joint_stream_parts.h"
#include "capture/files/joint_stream_text.h"

#include <algorithm>
#include <limits>
#include <utility>

/// Sensor joint names and orders, and the mapping from sensor joints to the 15 body joints.
namespace lorica::joints {
namespace {

using S = SensorJoint;

struct NamedJoint {
  std::string_view name;
  S joint;
};
constexpr std::array<NamedJoint, 28> kNames = {{{"SpineBase", S::kSpineBase},
                                                {"SpineMid", S::kSpineMid},
                                                {"Neck", S::kNeck},
                                                {"Head", S::kHead},
                                                {"ShoulderLeft", S::kShoulderLeft},
                                                {"ElbowLeft", S::kElbowLeft},
                                                {"WristLeft", S::kWristLeft},
                                                {"HandLeft", S::kHandLeft},
                                                {"ShoulderRight", S::kShoulderRight},
                                                {"ElbowRight", S::kElbowRight},
                                                {"WristRight", S::kWristRight},
                                                {"HandRight", S::kHandRight},
                                                {"HipLeft", S::kHipLeft},
                                                {"KneeLeft", S::kKneeLeft},
                                                {"AnkleLeft", S::kAnkleLeft},
                                                {"FootLeft", S::kFootLeft},
                                                {"HipRight", S::kHipRight},
                                                {"KneeRight", S::kKneeRight},
                                                {"AnkleRight", S::kAnkleRight},
                                                {"FootRight", S::kFootRight},
                                                {"SpineShoulder", S::kSpineShoulder},
                                                {"HandTipLeft", S::kHandTipLeft},
                                                {"ThumbLeft", S::kThumbLeft},
                                                {"HandTipRight", S::kHandTipRight},
                                                {"ThumbRight", S::kThumbRight},
                                                {"HipCenter", S::kSpineBase},
                                                {"Spine", S::kSpineMid},
                                                {"ShoulderCenter", S::kSpineShoulder}}};

/// Source candidates of a body joint: the first one that is seen is used.
struct Source {
  BodyJoint joint;
  std::array<S, 2> from;
};
constexpr std::array<Source, kBodyJointCount> kSources = {{
    {BodyJoint::kHead, {S::kHead, S::kHead}},
    {BodyJoint::kNeck, {S::kNeck, S::kSpineShoulder}},
    {BodyJoint::kLeftShoulder, {S::kShoulderLeft, S::kShoulderLeft}},
    {BodyJoint::kRightShoulder, {S::kShoulderRight, S::kShoulderRight}},
    {BodyJoint::kLeftElbow, {S::kElbowLeft, S::kElbowLeft}},
    {BodyJoint::kRightElbow, {S::kElbowRight, S::kElbowRight}},
    {BodyJoint::kLeftHand, {S::kHandLeft, S::kWristLeft}},
    {BodyJoint::kRightHand, {S::kHandRight, S::kWristRight}},
    {BodyJoint::kTorso, {S::kSpineMid, S::kSpineMid}},
    {BodyJoint::kLeftHip, {S::kHipLeft, S::kHipLeft}},
    {BodyJoint::kRightHip, {S::kHipRight, S::kHipRight}},
    {BodyJoint::kLeftKnee, {S::kKneeLeft, S::kKneeLeft}},
    {BodyJoint::kRightKnee, {S::kKneeRight, S::kKneeRight}},
    {BodyJoint::kLeftFoot, {S::kAnkleLeft, S::kAnkleLeft}},
    {BodyJoint::kRightFoot, {S::kAnkleRight, S::kAnkleRight}},
}};

}  // namespace

std::optional<SensorJoint> sensorJointNamed(std::string_view name) {
  for (const NamedJoint& named : kNames) {
    if (sameWord(named.name, name)) return named.joint;
  }
  return std::nullopt;
}

const std::array<SensorJoint, kKinect1JointCount>& kinect1Order() {
  static constexpr std::array<S, kKinect1JointCount> kOrder = {
      S::kSpineBase,  S::kSpineMid,  S::kSpineShoulder, S::kHead,          S::kShoulderLeft,
      S::kElbowLeft,  S::kWristLeft, S::kHandLeft,      S::kShoulderRight, S::kElbowRight,
      S::kWristRight, S::kHandRight, S::kHipLeft,       S::kKneeLeft,      S::kAnkleLeft,
      S::kFootLeft,   S::kHipRight,  S::kKneeRight,     S::kAnkleRight,    S::kFootRight};
  return kOrder;
}

const std::array<SensorJoint, kKinect1JointCount>& msrOrder() {
  static constexpr std::array<S, kKinect1JointCount> kOrder = {
      S::kShoulderLeft, S::kShoulderRight, S::kSpineShoulder, S::kSpineMid,   S::kHipLeft,
      S::kHipRight,     S::kSpineBase,     S::kElbowLeft,     S::kElbowRight, S::kWristLeft,
      S::kWristRight,   S::kHandLeft,      S::kHandRight,     S::kKneeLeft,   S::kKneeRight,
      S::kAnkleLeft,    S::kAnkleRight,    S::kFootLeft,      S::kFootRight,  S::kHead};
  return kOrder;
}

void SensorSkeleton::set(SensorJoint j, const std::optional<Vec3>& where, double confidenceIfSeen) {
  position[static_cast<std::size_t>(j)] = where.value_or(Vec3::Zero());
  confidence[static_cast<std::size_t>(j)] = where ? confidenceIfSeen : 0.0;
}

Observation observe(const SensorSkeleton& body, double time, int person) {
  Observation row;
  row.frame.time = time;
  row.frame.user = person;
  for (const Source& source : kSources) {
    const SensorJoint from = body.has(source.from[0]) ? source.from[0] : source.from[1];
    if (!body.has(from)) continue;
    row.frame[source.joint] = {body.at(from), std::nullopt, body.confidence[static_cast<std::size_t>(from)]};
  }
  if (body.has(S::kFootLeft)) row.toes[0] = body.at(S::kFootLeft);
  if (body.has(S::kFootRight)) row.toes[1] = body.at(S::kFootRight);
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
