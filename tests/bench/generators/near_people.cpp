#include "tests/bench/generators/near_people.h"

#include "skinning/mannequin/mannequin.h"
#include "tests/bench/generators/motion_clips.h"
#include "tests/bench/generators/other_cameras.h"
#include "tests/support/chair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace lorica {
namespace {

using motion::minimumJerk;

constexpr double kPi = std::numbers::pi;
constexpr double kSeatedPelvis = 0.53, kStandingPelvis = 0.917;  // height [m]
constexpr double kCrownOverPelvis = 0.83;                        // [m]
constexpr double kAbove = 0.12;                                  // share of the image's height over the head
constexpr double kWideFov = 1.22, kNarrowFov = 0.75;             // of a 16:9 image [rad]

constexpr std::array<NearScene, 12> kScenes = {{
    {"turning_06", NearMotion::kTurning, 0.65, true, false, 0.0, "realsense"},
    {"turning_08", NearMotion::kTurning, 0.8, false, false, 0.0, "kinect", 1.05},
    {"turning_12", NearMotion::kTurning, 1.2, false, false, 0.2, "kinect", 1.0, 1.2},
    {"waving_06", NearMotion::kWaving, 0.65, true, true, -0.2, "realsense"},
    {"waving_08", NearMotion::kWaving, 0.8, false, true, 0.0, "kinect", 1.05},
    {"waving_12", NearMotion::kWaving, 1.2, false, true, 0.1, "tof", 1.0, 1.2},
    {"leaning_06", NearMotion::kLeaning, 0.65, true, true, 0.0, "realsense", 0.95},
    {"leaning_08", NearMotion::kLeaning, 0.8, false, true, -0.15, "kinect"},
    {"leaning_12", NearMotion::kLeaning, 1.2, false, false, 0.2, "kinect", 1.05},
    {"face_06", NearMotion::kHandsAtFace, 0.65, true, true, 0.0, "realsense"},
    {"face_08", NearMotion::kHandsAtFace, 0.8, false, true, 0.0, "kinect", 0.95},
    {"face_12", NearMotion::kHandsAtFace, 1.2, false, true, 0.1, "kinect", 1.0, 1.2},
}};

/// Half of a movement there and back.
double during(double time, double from, double to, double ramp) {
  return minimumJerk((time - from) / ramp) * (1.0 - minimumJerk((time - to) / ramp));
}

motion::FigurePose poseAt(const NearScene& scene, double t) {
  motion::FigurePose figure;
  const double yaw = scene.motion == NearMotion::kTurning ? kPi * during(t, 0.7, 3.0, 1.4) : 0.1 * std::sin(1.3 * t);
  const bool leans = scene.motion == NearMotion::kLeaning;
  const double forward = leans ? 0.3 * scene.distance * during(t, 0.6, 1.7, 0.7) : 0.03 * std::sin(0.9 * t);
  const double aside = leans ? 0.3 * std::sin(2.2 * std::max(0.0, t - 2.2)) * minimumJerk((t - 2.2) / 0.4) : 0.0;
  const Quat turn = motion::turned(yaw, 0.0, 0.0);
  figure.pelvis.y() = scene.seated ? kSeatedPelvis : kStandingPelvis;
  figure.worldFromPelvis = motion::turned(yaw, forward, aside);
  figure.worldFromHead = motion::turned(yaw, 0.3 * forward, 0.3 * aside);
  const Vec3 atFace(-0.13, 0.10, 0.17), pole(0.6, -1.0, 0.1), raised(0.22, 0.22, 0.2);
  for (const motion::Side side : {motion::kLeft, motion::kRight}) {
    const double mirror = side == motion::kLeft ? 1.0 : -1.0;
    motion::FootPose& foot = figure.feet[side];
    foot.ankle = turn * Vec3(0.1 * mirror, motion::kAnkle, scene.seated ? 0.38 : 0.0);
    foot.rotation = motion::turned(yaw + 0.15 * mirror, 0.0, 0.0);
    const motion::ArmPose rests = scene.seated ? motion::swungArm(0.35, 0.12, 0.9) : motion::swungArm(0.05, 0.12, 0.25);
    const double from = side == motion::kLeft ? 0.6 : 1.8;
    double way = 0.0;
    Vec3 hand = atFace;
    if (scene.motion == NearMotion::kHandsAtFace) way = during(t, from, from + 1.8, 0.6);
    if (scene.motion == NearMotion::kWaving && side == motion::kRight) {
      way = during(t, 0.4, 4.0, 0.6);
      hand = raised + Vec3(0.1 * std::sin(7.0 * t), 0.0, 0.0);
    }
    const motion::ArmPose there = motion::reach(hand, pole);
    motion::ArmPose& arm = figure.arms[side];
    arm = rests;
    arm.swing += way * (there.swing - rests.swing);
    arm.elbow += way * (there.elbow - rests.elbow);
  }
  return figure;
}

bool isOfLegs(std::size_t joint) {
  return joint >= static_cast<std::size_t>(BodyJoint::kLeftHip);
}

/// Level, from the right to the left shoulder.
Vec3 acrossOf(const SkeletonFrame& joints) {
  Vec3 across = joints[BodyJoint::kLeftShoulder].position - joints[BodyJoint::kRightShoulder].position;
  across.y() = 0.0;
  return across.normalized();
}

}  // namespace

std::span<const NearScene> nearScenes() {
  return kScenes;
}

VirtualSensor nearSensor(const NearScene& scene, std::uint64_t seed) {
  std::vector<SkeletonFrame> frames;
  for (int f = 0; f <= kNearFrames; ++f) frames.push_back(motion::solve(poseAt(scene, f / 30.0), f / 30.0));
  std::vector<VirtualPerson> people;
  people.push_back({VirtualPerformer::create(
                        withProportions(makeMannequin(), {.height = scene.height, .girth = scene.girth}), frames)
                        .value()});
  VirtualSensorSettings settings;
  settings.noise = noiseNamed(scene.noise);
  settings.noise.seed = seed;
  settings.camera =
      scene.portrait ? DepthCamera{360, 640, kNarrowFov, kWideFov} : DepthCamera{640, 360, kWideFov, kNarrowFov};
  const double half = std::tan(0.5 * settings.camera.verticalFov);
  const double crown =
      (scene.seated ? kSeatedPelvis : kStandingPelvis) * scene.height + kCrownOverPelvis * scene.height;
  // The ray to the crown is at the same place in the image, however the camera is tilted.
  const double up = std::atan((1.0 - 2.0 * kAbove) * half) - scene.tiltDown;
  const double eye = crown - scene.distance * std::tan(up);
  settings.room.worldFromCamera = worldFromCameraAt({0.0, eye, scene.distance}, scene.tiltDown);
  if (scene.seated) settings.room.boxes = test::chairAt(Vec3::Zero());
  return VirtualSensor::create(std::move(people), settings).value();
}

void NearFigures::add(const VirtualTruth& truth, std::span<const SkeletonFrame> tracked) {
  constexpr double kSame = 0.25, kOff = 0.15;
  constexpr std::array kTrunk = {BodyJoint::kHead, BodyJoint::kNeck, BodyJoint::kLeftShoulder,
                                 BodyJoint::kRightShoulder};
  const auto away = [&](const SkeletonFrame& one, BodyJoint joint) {
    return (one[joint].position - truth.joints[joint].position).norm();
  };
  const auto it =
      std::ranges::find_if(tracked, [&](const SkeletonFrame& one) { return away(one, BodyJoint::kHead) < kSame; });
  const bool found = it != tracked.end();
  others += static_cast<int>(tracked.size() > std::size_t{found});
  ++frames;
  if (!found) return;
  if (first < 0) first = frames - 1;
  headingOff += static_cast<int>(acrossOf(*it).dot(acrossOf(truth.joints)) < std::numbers::sqrt2 / 2.0);
  for (std::size_t j = 0; j < kBodyJointCount; ++j) {
    const bool isSure = it->joints[j].confidence >= 0.5;
    sure += static_cast<int>(isSure);
    sureOff += static_cast<int>(isSure && away(*it, static_cast<BodyJoint>(j)) > kOff);
    legsKnown += static_cast<int>(isOfLegs(j) && it->joints[j].confidence > 0.0);
  }
  double mean = 0.0;
  for (const BodyJoint joint : kTrunk) mean += 1e3 * away(*it, joint) / kTrunk.size();
  trunkMm += (mean - trunkMm) / ++followed;
}

}  // namespace lorica
