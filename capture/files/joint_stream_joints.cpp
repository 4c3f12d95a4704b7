#include "capture/files/joint_stream_layouts.h"
#include "capture/files/joint_stream_text.h"
#include "geometry/counts.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <limits>
#include <string>

/// Sensor joint names, and the mapping from sensor joints to the 15 body joints.
namespace lorica::joints {
namespace {

using enum SensorJoint;

struct Names {
  std::string_view words;
  SensorJoint left, right;  ///< of the trunk the same
};
constexpr std::array<Names, 22> kStreamNames = {{
    {"spinebase hipcenter hipcentre hipscenter midhip pelvis hips hip root", kSpineBase, kSpineBase},
    {"spinemid spine spinenavel torso abdomen", kSpineMid, kSpineMid},
    {"spineshoulder shouldercenter shouldercentre midshoulder spinechest chest thorax", kSpineShoulder, kSpineShoulder},
    {"neck", kNeck, kNeck},
    {"head", kHead, kHead},
    {"nose", kNose, kNose},
    {"headtop jaw", kOther, kOther},
    {"shoulder upperarm", kShoulderLeft, kShoulderRight},
    {"elbow forearm lowerarm", kElbowLeft, kElbowRight},
    {"wrist", kWristLeft, kWristRight},
    {"hand", kHandLeft, kHandRight},
    {"handtip", kHandTipLeft, kHandTipRight},
    {"thumb", kThumbLeft, kThumbRight},
    {"index", kIndexLeft, kIndexRight},
    {"pinky", kPinkyLeft, kPinkyRight},
    {"hip thigh upperleg upleg", kHipLeft, kHipRight},
    {"knee lowerleg calf shin", kKneeLeft, kKneeRight},
    {"ankle", kAnkleLeft, kAnkleRight},
    {"foot footindex toe toes bigtoe", kFootLeft, kFootRight},
    {"ear", kEarLeft, kEarRight},
    {"eye eyeinner eyeouter mouth", kOther, kOther},
    {"heel clavicle", kOther, kOther},
}};
constexpr int kTrunkNames = 7;  ///< of them, the first

/// What is used if a source is not seen.
SensorJoint substituteOf(SensorJoint joint) {
  if (joint == kNeck) return kSpineShoulder;
  if (joint == kHandLeft) return kWristLeft;
  return joint == kHandRight ? kWristRight : joint;
}

}  // namespace

std::optional<SensorJoint> sensorJointCalled(std::string_view name) {
  const std::string plain = plainName(name);
  for (int n = 0; n < kTrunkNames; ++n) {
    if (!firstWord(kStreamNames[n].words, [&](std::string_view word) { return plain == word; }).empty())
      return kStreamNames[n].left;
  }
  for (const std::string_view side : {"left", "right", "l", "r"}) {
    // The side comes first or last.
    for (int n = kTrunkNames; n < countOf(kStreamNames); ++n) {
      const auto fits = [&](std::string_view word) {
        return plain.size() == side.size() + word.size() && ((plain.starts_with(side) && plain.ends_with(word)) ||
                                                             (plain.ends_with(side) && plain.starts_with(word)));
      };
      if (!firstWord(kStreamNames[n].words, fits).empty())
        return side[0] == 'l' ? kStreamNames[n].left : kStreamNames[n].right;
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

void SensorSkeleton::complete() {
  // The middle of joints that are all seen.
  const auto derive = [&](SensorJoint to, std::initializer_list<SensorJoint> from) {
    if ((*this)[to].confidence > 0.0) return;
    TrackedJoint sum;
    double count = 0.0;
    for (const SensorJoint j : from) {
      const TrackedJoint& joint = (*this)[j];
      if (!(joint.confidence > 0.0)) return;
      sum.confidence = count == 0.0 ? joint.confidence : std::min(sum.confidence, joint.confidence);
      sum.position += joint.position;
      count += 1.0;
    }
    sum.position /= count;
    (*this)[to] = sum;
  };
  derive(kHead, {kEarLeft, kEarRight});
  derive(kHead, {kNose});
  if (!((*this)[kSpineShoulder].confidence > 0.0)) derive(kNeck, {kShoulderLeft, kShoulderRight});
  derive(kSpineBase, {kHipLeft, kHipRight});
  derive(kSpineMid, {(*this)[kNeck].confidence > 0.0 ? kNeck : kSpineShoulder, kSpineBase});
  // Fingers that are not at the wrist were filled in by a program.
  constexpr double kFingersByForearm = 0.7;
  for (const auto& [elbow, wrist, hand, index, pinky] :
       {std::array{kElbowLeft, kWristLeft, kHandLeft, kIndexLeft, kPinkyLeft},
        std::array{kElbowRight, kWristRight, kHandRight, kIndexRight, kPinkyRight}}) {
    const auto length = [&, from = wrist](SensorJoint to) {
      return ((*this)[to].position - (*this)[from].position).norm();
    };
    const bool attached = std::max(length(index), length(pinky)) < kFingersByForearm * length(elbow);
    if (attached) derive(hand, {wrist, index, pinky});
  }
}

Observation observe(const SensorSkeleton& body, double time, int person) {
  Observation row;
  row.frame.time = time;
  row.frame.user = person;
  for (int j = 0; j < kBodyJointCount; ++j) {
    const SensorJoint usual = kBodyOrder[j];
    const SensorJoint from = body[usual].confidence > 0.0 ? usual : substituteOf(usual);
    if (body[from].confidence > 0.0) row.frame.joints[j] = body[from];
  }
  if (body[kFootLeft].confidence > 0.0) row.toes[0] = body[kFootLeft].position;
  if (body[kFootRight].confidence > 0.0) row.toes[1] = body[kFootRight].position;
  return row;
}

std::optional<Vec3> seen(const SkeletonFrame& frame, BodyJoint joint) {
  return frame[joint].confidence > 0.0 ? std::optional(frame[joint].position) : std::nullopt;
}

std::optional<Vec3> between(const SkeletonFrame& frame, BodyJoint from, BodyJoint to) {
  const std::optional<Vec3> a = seen(frame, from), b = seen(frame, to);
  return a && b ? std::optional<Vec3>(*b - *a) : std::nullopt;
}

std::optional<Vec3> middleOf(const SkeletonFrame& frame, std::initializer_list<BodyJoint> joints, bool all) {
  Vec3 sum = Vec3::Zero();
  double count = 0.0;
  for (const BodyJoint joint : joints) {
    const std::optional<Vec3> position = seen(frame, joint);
    if (!position && all) return std::nullopt;
    if (!position) continue;
    sum += *position;
    count += 1.0;
  }
  return count > 0.0 ? std::optional<Vec3>(sum / count) : std::nullopt;
}

std::optional<Vec3> positionOf(const SkeletonFrame& frame) {
  using enum BodyJoint;
  if (const std::optional<Vec3> torso = seen(frame, kTorso)) return torso;
  if (const std::optional<Vec3> neck = seen(frame, kNeck)) return neck;
  return middleOf(frame, {BodyJoint::kHead, kLeftShoulder, kRightShoulder, kLeftElbow, kRightElbow, kLeftHand,
                          kRightHand, kLeftHip, kRightHip, kLeftKnee, kRightKnee, kLeftFoot, kRightFoot});
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
