#include "capture/streams/vrchat_writer.h"

#include "capture/streams/osc.h"
#include "capture/streams/vmc_axes.h"
#include "geometry/result.h"

#include <array>
#include <cmath>
#include <numbers>
#include <string_view>

namespace lorica {
namespace {

/// VRChat's own example scales its trackers to this height of the user [m].
constexpr double kUserHeight = 1.7;
/// A packet of all trackers has less than this many bytes.
constexpr std::size_t kPacketBytes = 2048;

struct Tracker {
  std::size_t group;                    ///< of kVrchatTrackers
  std::string_view position, rotation;  ///< addresses
  HumanBone place, turn;                ///< whose joint, and whose rotation
};

constexpr std::array<Tracker, 9> kTrackers = {{
    {0, "/tracking/trackers/head/position", "/tracking/trackers/head/rotation", HumanBone::kHead, HumanBone::kHead},
    {1, "/tracking/trackers/1/position", "/tracking/trackers/1/rotation", HumanBone::kHips, HumanBone::kHips},
    {2, "/tracking/trackers/2/position", "/tracking/trackers/2/rotation", HumanBone::kChest, HumanBone::kChest},
    {3, "/tracking/trackers/3/position", "/tracking/trackers/3/rotation", HumanBone::kLeftFoot, HumanBone::kLeftFoot},
    {3, "/tracking/trackers/4/position", "/tracking/trackers/4/rotation", HumanBone::kRightFoot, HumanBone::kRightFoot},
    {4, "/tracking/trackers/5/position", "/tracking/trackers/5/rotation", HumanBone::kLeftLowerLeg,
     HumanBone::kLeftUpperLeg},
    {4, "/tracking/trackers/6/position", "/tracking/trackers/6/rotation", HumanBone::kRightLowerLeg,
     HumanBone::kRightUpperLeg},
    {5, "/tracking/trackers/7/position", "/tracking/trackers/7/rotation", HumanBone::kLeftLowerArm,
     HumanBone::kLeftUpperArm},
    {5, "/tracking/trackers/8/position", "/tracking/trackers/8/rotation", HumanBone::kRightLowerArm,
     HumanBone::kRightUpperArm},
}};

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

VrchatWriter::VrchatWriter(double height, VrchatTrackers sent)
    : scale_(kUserHeight / height), sent_(sent), memory_(kPacketBytes) {
  LORICA_CHECK(height > 0.0, "a character has a height");
}

std::span<const std::byte> VrchatWriter::write(const BonePose& pose) {
  const WorldBones world = worldOf(pose);
  OscWriter writer(memory_);
  writer.beginBundle();
  for (const Tracker& tracker : kTrackers) {
    const auto place = static_cast<std::size_t>(tracker.place);
    const auto turn = static_cast<std::size_t>(tracker.turn);
    if (!sent_[tracker.group] || !pose.rotation[place]) continue;  // or the character lacks it
    addVector(writer, tracker.position, scale_ * mirrorX(world.position[place]));
    addVector(writer, tracker.rotation, unityAngles(mirrorX(world.turn[turn])));
  }
  LORICA_CHECK(writer.fits(), "the packet is too small");
  return writer.packet();
}

}  // namespace lorica
