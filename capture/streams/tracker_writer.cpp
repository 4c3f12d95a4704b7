#include "capture/streams/tracker_writer.h"

#include "capture/streams/osc.h"
#include "geometry/result.h"

#include <cmath>
#include <numbers>

namespace lorica {
namespace {

/// VRChat's own example scales its trackers to this height of the user [m].
constexpr double kUserHeight = 1.7;
/// A packet of all trackers has less than this many bytes.
constexpr std::size_t kPacketBytes = 2048;

struct Tracker {
  std::size_t group;                    ///< of kTrackerGroups
  std::string_view position, rotation;  ///< addresses
  HumanBone place, turn;                ///< whose joint, and whose rotation
  BodyJoint joint, other;               ///< of the person: in the middle of both
};

using B = HumanBone;
using J = BodyJoint;
constexpr std::array<Tracker, 9> kTrackers = {{
    {0, "/tracking/trackers/head/position", "/tracking/trackers/head/rotation", B::kHead, B::kHead, J::kHead, J::kHead},
    {1, "/tracking/trackers/1/position", "/tracking/trackers/1/rotation", B::kHips, B::kHips, J::kLeftHip,
     J::kRightHip},
    {2, "/tracking/trackers/2/position", "/tracking/trackers/2/rotation", B::kChest, B::kChest, J::kTorso, J::kNeck},
    {3, "/tracking/trackers/3/position", "/tracking/trackers/3/rotation", B::kLeftFoot, B::kLeftFoot, J::kLeftFoot,
     J::kLeftFoot},
    {3, "/tracking/trackers/4/position", "/tracking/trackers/4/rotation", B::kRightFoot, B::kRightFoot, J::kRightFoot,
     J::kRightFoot},
    {4, "/tracking/trackers/5/position", "/tracking/trackers/5/rotation", B::kLeftLowerLeg, B::kLeftUpperLeg,
     J::kLeftKnee, J::kLeftKnee},
    {4, "/tracking/trackers/6/position", "/tracking/trackers/6/rotation", B::kRightLowerLeg, B::kRightUpperLeg,
     J::kRightKnee, J::kRightKnee},
    {5, "/tracking/trackers/7/position", "/tracking/trackers/7/rotation", B::kLeftLowerArm, B::kLeftUpperArm,
     J::kLeftElbow, J::kLeftElbow},
    {5, "/tracking/trackers/8/position", "/tracking/trackers/8/rotation", B::kRightLowerArm, B::kRightUpperArm,
     J::kRightElbow, J::kRightElbow},
}};

// Virtual Motion Tracker's modes; the one of a tracker holds from SteamVR's start on.
constexpr std::int32_t kVmtOff = 0, kVmtTracker = 1;

void addVmt(OscWriter& writer, std::size_t tracker, std::int32_t mode, const Vec3& position, const Quat& rotation) {
  writer.beginMessage("/VMT/Room/Unity", "iiffffffff");
  writer.add(static_cast<std::int32_t>(tracker));
  writer.add(mode);
  writer.add(0.0F);  // the pose is of now
  for (const double value : position) writer.add(static_cast<float>(value));
  for (const double value : rotation.coeffs()) writer.add(static_cast<float>(value));  // x, y, z, w
  writer.endMessage();
}

void addVector(OscWriter& writer, std::string_view address, const Vec3& v) {
  writer.beginMessage(address, "fff");
  for (const double value : v) writer.add(static_cast<float>(value));
  writer.endMessage();
}

}  // namespace

Vec3 unityAngles(const Quat& rotation) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  constexpr double kUpright = 1e-6;
  const Mat3 m = rotation.toRotationMatrix();
  const double cosine = std::hypot(m(0, 2), m(2, 2));
  const double x = std::atan2(-m(1, 2), cosine);
  // Straight up or down, Z and Y turn about the same axis.
  if (cosine < kUpright) return kDegrees * Vec3(x, std::atan2(-m(2, 0), m(0, 0)), 0.0);
  return kDegrees * Vec3(x, std::atan2(m(0, 2), m(2, 2)), std::atan2(m(1, 0), m(1, 1)));
}

TrackerWriter::TrackerWriter(TrackerReceiver receiver, double height, TrackerGroups sent)
    : receiver_(receiver), scale_(kUserHeight / height), sent_(sent), memory_(kPacketBytes) {
  LORICA_CHECK(height > 0.0, "a character has a height");
  if (receiver == TrackerReceiver::kVmt) sent_.reset(0);
}

std::span<const std::byte> TrackerWriter::write(const BonePose& pose, const StagedPerson* person) {
  const WorldBones world = worldOf(pose);
  const Quat stageFromWorld = person != nullptr ? Quat(person->stageFromWorld.linear()) : Quat::Identity();
  OscWriter writer(memory_);
  writer.beginBundle();
  for (std::size_t t = 0; t < kTrackers.size(); ++t) {
    const Tracker& tracker = kTrackers[t];
    const auto place = static_cast<std::size_t>(tracker.place);
    const auto turn = static_cast<std::size_t>(tracker.turn);
    if (!sent_[tracker.group] || !pose.rotation[place]) continue;  // or the character lacks it
    Vec3 position = scale_ * world.position[place];
    if (person != nullptr) {
      const TrackedJoint &joint = person->joints[tracker.joint], &other = person->joints[tracker.other];
      if (joint.confidence <= 0.0 || other.confidence <= 0.0) continue;
      position = person->stageFromWorld * (0.5 * (joint.position + other.position));
    }
    const Quat rotation = mirrored(stageFromWorld * world.turn[turn]);
    if (receiver_ == TrackerReceiver::kVmt) {
      addVmt(writer, t, kVmtTracker, mirrored(position), rotation);
      on_.set(t);
      continue;
    }
    addVector(writer, tracker.position, mirrored(position));
    addVector(writer, tracker.rotation, unityAngles(rotation));
  }
  LORICA_CHECK(writer.fits(), "the packet is too small");
  return writer.packet();
}

std::span<const std::byte> TrackerWriter::writeEnd() {
  if (on_.none()) return {};
  OscWriter writer(memory_);
  writer.beginBundle();
  for (std::size_t t = 0; t < kTrackers.size(); ++t) {
    if (on_[t]) addVmt(writer, t, kVmtOff, Vec3::Zero(), Quat::Identity());
  }
  on_.reset();
  return writer.packet();
}

}  // namespace lorica
