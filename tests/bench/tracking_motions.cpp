#include "tests/bench/tracking_motions.h"

#include "capture/files/bvh_file.h"
#include "capture/files/joint_csv.h"
#include "capture/virtual_sensor/virtual_performer.h"
#include "skinning/import/character_file.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/bench/generators/motion_clips.h"
#include "tests/support/chair.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <system_error>
#include <utility>

namespace lorica::bench {
namespace {

using motion::ArmCurve;
using motion::FigurePose;
using motion::minimumJerk;

constexpr double kFramesPerSecond = 30.0;
constexpr double kRoom = 2.15;  ///< length of the path along which such a camera sees the whole body well [m]
constexpr double kPi = std::numbers::pi;

std::vector<SkeletonFrame> figureMotion(double seconds, const std::function<void(double, FigurePose&)>& pose) {
  const int count = static_cast<int>(std::lround(seconds * kFramesPerSecond)) + 1;
  std::vector<SkeletonFrame> frames;
  frames.reserve(count);
  for (int i = 0; i < count; ++i) {
    const double time = i / kFramesPerSecond;
    FigurePose figure;
    for (const motion::Side side : {motion::kLeft, motion::kRight}) {
      const double mirror = side == motion::kLeft ? 1.0 : -1.0;
      motion::FootPose& foot = figure.feet[side];
      foot.ankle = Vec3(0.1 * mirror, motion::kAnkle, 0.0);
      foot.rotation = motion::turned(0.15 * mirror, 0.0, 0.0);
      figure.arms[side] = motion::reach(motion::kHang, motion::kHangPole);
    }
    figure.pelvis.y() = 0.917;
    pose(time, figure);
    frames.push_back(motion::solve(figure, time));
  }
  return frames;
}

/// Folds the arms over the chest, holds them there, opens them, and folds them again with the other arm on top.
std::vector<SkeletonFrame> crossedArms() {
  const Vec3 over(-0.27, -0.24, 0.25), under(-0.25, -0.27, 0.19), pole(0.5, -1.0, 0.3);
  const auto arm = [&](const Vec3& first, const Vec3& second) {
    return motion::armThrough({{0.7, motion::kHang, motion::kHangPole},
                               {1.0, {0.05, -0.40, 0.30}, pole},
                               {1.7, first, pole},
                               {4.0, first + Vec3(0.0, 0.015, 0.01), pole},
                               {4.6, {0.05, -0.40, 0.32}, pole},
                               {5.3, second, pole},
                               {7.2, second + Vec3(0.0, 0.01, 0.01), pole},
                               {7.9, motion::kHang, motion::kHangPole}});
  };
  const ArmCurve left = arm(over, under), right = arm(under, over);
  return figureMotion(8.0, [=](double t, FigurePose& figure) {
    figure.worldFromPelvis = motion::turned(0.12 * std::sin(0.9 * t), 0.0, 0.0);
    figure.arms = {left(t), right(t)};
  });
}

/// Turns once around on the spot with forearms held forward, then half a turn back.
std::vector<SkeletonFrame> turnOnTheSpot() {
  return figureMotion(9.0, [](double t, FigurePose& figure) {
    const double yaw = 2.0 * kPi * minimumJerk((t - 1.2) / 4.5) - kPi * minimumJerk((t - 6.5) / 2.2);
    const double step = std::abs(std::sin(4.0 * t));
    const Quat turn = motion::turned(yaw, 0.0, 0.0);
    figure.worldFromPelvis = turn;
    figure.worldFromHead = turn;
    for (std::size_t side = 0; side < 2; ++side) {
      motion::FootPose& foot = figure.feet[side];
      foot.ankle = turn * foot.ankle;
      foot.rotation = turn * foot.rotation;
      const bool lifted = (std::fmod(4.0 * t, 2.0 * kPi) < kPi) == (side == 0);
      if (lifted && t > 1.2 && t < 8.5) foot.ankle.y() += 0.05 * step;
      figure.arms[side] = motion::swungArm(0.15 + 0.1 * std::sin(2.0 * t), 0.2, 0.9 + 0.3 * std::sin(1.7 * t));
    }
  });
}

/// Sits down on a chair, puts the hands on the knees, lifts one arm after the other, and stands up.
std::vector<SkeletonFrame> sitOnChair() {
  return figureMotion(9.0, [](double t, FigurePose& figure) {
    const double down = minimumJerk((t - 0.8) / 1.4) * (1.0 - minimumJerk((t - 7.2) / 1.4));
    const double lean = 4.0 * down * (1.0 - down);
    figure.pelvis = Vec3(0.0, 0.917 - 0.385 * down, -0.36 * down);
    figure.worldFromPelvis = motion::turned(0.0, 0.45 * lean, 0.0);
    for (std::size_t side = 0; side < 2; ++side) {
      const double from = side == 0 ? 3.0 : 4.6;
      const double lift = minimumJerk((t - from) / 0.6) * (1.0 - minimumJerk((t - from - 1.0) / 0.6));
      figure.feet[side].ankle.x() *= 1.3;
      figure.arms[side] =
          motion::swungArm(0.1 + 0.62 * down + 1.7 * lift, 0.12 + 0.3 * lift, 0.2 + 0.7 * down - 0.5 * lift);
    }
  });
}

/// The midpoint of the hips.
Vec3 middleOf(const SkeletonFrame& frame) {
  return 0.5 * (frame[BodyJoint::kLeftHip].position + frame[BodyJoint::kRightHip].position);
}

/// The same motion over a shorter path: body and limbs move as before, so the feet slide.
/// @param max  maximum length of the path along Z [m]
std::vector<SkeletonFrame> shortened(std::vector<SkeletonFrame> frames, double max) {
  double min = 1e9, largest = -1e9;
  for (const SkeletonFrame& frame : frames) {
    min = std::min(min, middleOf(frame).z());
    largest = std::max(largest, middleOf(frame).z());
  }
  const double away = 1.0 - std::min(1.0, max / std::max(largest - min, 1e-6));
  for (SkeletonFrame& frame : frames) {
    const Vec3 middle = middleOf(frame);
    const Vec3 back(away * middle.x(), 0.0, away * middle.z());
    for (TrackedJoint& joint : frame.joints) joint.position -= back;
  }
  return frames;
}

TrackedMotion made(std::string name, MotionKind kind, std::vector<SkeletonFrame> joints) {
  TrackedMotion result;
  result.name = std::move(name);
  result.kind = kind;
  result.seconds = std::min(8.0, joints.back().time - joints.front().time);
  result.joints = std::move(joints);
  return result;
}

/// Plays from `start` to `end` and back repeatedly until the motion is long enough.
SkeletalMotion backAndForth(const SkeletalMotion& motion, double start, double end, double seconds) {
  const auto frameAt = [&](double time) {
    int frame = 0;
    while (frame + 1 < motion.frameCount() && motion.times[frame] < motion.times.front() + time) {
      ++frame;
    }
    return frame;
  };
  const int first = frameAt(start), count = frameAt(end) + 1;
  SkeletalMotion result{motion.name, motion.skeleton, {}, {}};
  double time = 0.0;
  for (int frame = first, step = 1; time <= seconds && first + 1 < count; frame += step) {
    const std::span<const JointTransform> pose = motion.pose(frame);
    result.times.push_back(time);
    result.poses.insert(result.poses.end(), pose.begin(), pose.end());
    if (frame + step < first || frame + step >= count) step = -step;
    time += std::abs(motion.times[frame + step] - motion.times[frame]);
  }
  return result;
}

Result<TrackedMotion> fromBvh(const std::filesystem::path& file, const std::string& name, double start, double end) {
  Result<BvhFile> bvh = readBvh(file);
  if (!bvh) return bvh.error();
  TrackedMotion result;
  result.name = name;
  result.skeletal = backAndForth(bvh->motion, start, end, result.seconds);
  return result;
}

Isometry3 placed(const Vec3& position, double turn) {
  Isometry3 result = Isometry3::Identity();
  result.linear() = Eigen::AngleAxisd(turn, Vec3::UnitY()).toRotationMatrix();
  result.translation() = position;
  return result;
}

bool isThere(const std::filesystem::path& file) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(file, ignored);
}

}  // namespace

std::vector<TrackedMotion> formulaMotions() {
  std::vector<TrackedMotion> all;
  all.reserve(14);
  for (const std::string_view which : kShippedMotions) {
    const bool boxing = which == "punch_and_kick";
    all.push_back(made(std::string(which), boxing ? MotionKind::kBoxing : MotionKind::kOrdinary,
                       which == "walk" ? shortened(shippedFrames(which), kRoom) : shippedFrames(which)));
  }
  all.push_back(made("walk_far", MotionKind::kFar, shippedFrames("walk")));
  const std::vector<SkeletonFrame> wave = shippedFrames("wave");
  all.push_back(made("crossed_arms", MotionKind::kCrossedArms, crossedArms()));
  all.push_back(made("turn_on_the_spot", MotionKind::kTurn, turnOnTheSpot()));
  all.push_back(made("back_turned", MotionKind::kBackTurned, wave));
  all.back().turn = kPi;
  all.push_back(made("sit_on_chair", MotionKind::kSitting, sitOnChair()));
  all.back().furniture = test::chairAt({0.0, 0.0, -0.36});
  all.push_back(made("occlusion", MotionKind::kOcclusion, shippedFrames("jumping_jacks")));
  all.back().screens.push_back({{Vec3(-1.6, 0.0, 1.3), Vec3(1.6, 2.2, 1.35)}, {2.0, 3.0}});
  all.back().seconds = 5.0;
  all.push_back(made("entering", MotionKind::kEntering, wave));
  all.back().absent.push_back({0.0, 2.5});
  all.back().seconds = 5.0;
  all.push_back(made("two_people", MotionKind::kTwo, wave));
  all.back().companion = shippedFrames("jumping_jacks");
  return all;
}

Result<std::vector<TrackedMotion>> dataMotions(const std::filesystem::path& folder) {
  struct File {
    const char* path;
    const char* name;
    double start, end;  // of the used section [s]
  };
  std::vector<TrackedMotion> all;
  all.reserve(4);
  for (const File& one : {File{"bvh/animated_drawings/zombie.bvh", "bvh_zombie", 1.0, 4.0},
                          File{"bvh/animated_drawings/jumping_jacks.bvh", "bvh_jumping_jacks", 0.5, 60.0},
                          File{"bvh/makehuman/walk1.bvh", "bvh_walk", 0.0, 60.0}}) {
    if (!isThere(folder / one.path)) continue;
    Result<TrackedMotion> read = fromBvh(folder / one.path, one.name, one.start, one.end);
    if (!read) return read.error();
    all.push_back(std::move(*read));
  }
  if (const std::filesystem::path file = folder / "characters/arnaud/crossarms.fbx"; isThere(file)) {
    Result<CharacterFile> read = readCharacterFile(file);
    if (!read) return read.error();
    if (!read->clips.empty()) {
      TrackedMotion crossed;
      crossed.name = "clip_crossed_arms";
      crossed.kind = MotionKind::kCrossedArms;
      crossed.skeletal = backAndForth(sampleWhole(read->character.skeleton, read->clips.front(), kFramesPerSecond), 0.0,
                                      60.0, crossed.seconds);
      all.push_back(std::move(crossed));
    }
  }
  return all;
}

Result<std::vector<TestPerson>> trackedBodies(const std::filesystem::path& folder) {
  struct File {
    const char* path;
    const char* name;
    bool odd;
  };
  std::vector<TestPerson> all;
  all.reserve(8);
  const Character mannequin = makeMannequin();
  all.push_back({"mannequin", mannequin, true, false});
  all.push_back({"tall", withProportions(mannequin, {.height = 1.1}), false, false});
  all.push_back({"heavy", withProportions(mannequin, {.girth = 1.25}), false, false});
  for (const File& one : {File{"characters/arnaud/arnaud.fbx", "arnaud", false},
                          File{"characters/godette/Godette_vrm_v4.vrm", "godette", true},
                          File{"characters/cesiumman/CesiumMan.glb", "cesiumman", true},
                          File{"characters/kaykit/Barbarian.glb", "barbarian", true}}) {
    if (!isThere(folder / one.path)) continue;
    Result<CharacterFile> read = readCharacterFile(folder / one.path);
    if (!read) return read.error();
    all.push_back({one.name, std::move(read->character), false, one.odd});
  }
  return all;
}

Result<VirtualSensor> sensorBefore(const TestPerson& body, const TrackedMotion& motion, const DepthCamera& camera,
                                   const DepthNoiseSettings& noise) {
  Result<VirtualPerformer> performer = motion.skeletal ? VirtualPerformer::create(body.character, *motion.skeletal)
                                                       : VirtualPerformer::create(body.character, motion.joints);
  if (!performer) return performer.error();

  // Extent of the motion, and the direction that the person initially faces.
  Vec3 min = Vec3::Constant(1e9), max = Vec3::Constant(-1e9);
  double facing = 0.0;
  for (int i = 0; i <= 20; ++i) {
    performer->pose(motion.seconds * i / 20.0, Isometry3::Identity());
    const SkeletonFrame& joints = performer->joints();
    const Vec3 left = joints[BodyJoint::kLeftHip].position, right = joints[BodyJoint::kRightHip].position;
    min = min.cwiseMin(0.5 * (left + right));
    max = max.cwiseMax(0.5 * (left + right));
    const Vec3 ahead = (left - right).cross(Vec3::UnitY());
    if (i == 0) facing = std::atan2(ahead.x(), ahead.z());
  }
  // Motions made for this room keep their position, unless their path is long; then the camera is farther away.
  const Vec3 way = max - min;
  const bool foreign = motion.skeletal.has_value(), far = std::hypot(way.x(), way.z()) > 0.8;
  const double turn = motion.turn - (foreign ? facing : 0.0);
  Vec3 middle = foreign || far ? Vec3(0.5 * (min + max)) : Vec3::Zero();
  middle.y() = 0.0;

  VirtualSensorSettings settings;
  settings.noise = noise;
  settings.camera = camera;
  const double distance = 2.7 + (far ? 0.5 * std::hypot(way.x(), way.z()) - 0.4 : 0.0);
  settings.room.worldFromCamera = worldFromCameraAt({0.0, 1.1, distance}, 0.05);
  settings.room.wall = -std::max(1.6, 0.5 * way.norm() + 1.0);
  settings.room.boxes = motion.furniture;
  settings.screens = motion.screens;
  std::vector<VirtualPerson> people;
  people.reserve(2);
  const Vec3 aside(motion.companion.empty() ? 0.0 : -0.6, 0.0, 0.0);
  people.push_back({std::move(*performer), placed(aside, turn) * placed(-middle, 0.0), 0.0, motion.absent, 1.5});
  if (!motion.companion.empty()) {
    Result<VirtualPerformer> companion = VirtualPerformer::create(makeMannequin(), motion.companion);
    if (!companion) return companion.error();
    people.push_back({std::move(*companion), placed(Vec3(0.75, 0.0, -0.3), 0.0), 0.0, {}, 0.0});
  }
  return VirtualSensor::create(std::move(people), settings);
}

}  // namespace lorica::bench
