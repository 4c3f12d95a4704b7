#include "capture/virtual_sensor/virtual_sensor.h"

#include "geometry/errors.h"
#include "geometry/work_budgets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <thread>
#include <utility>

namespace lorica {
namespace {

/// Corner i of a box: bit 0 is x, bit 1 y, bit 2 z. Counter-clockwise from outside.
constexpr std::array<Triangle, 12> kBoxTriangles = {{{0, 4, 6},
                                                     {0, 6, 2},
                                                     {1, 3, 7},
                                                     {1, 7, 5},
                                                     {0, 1, 5},
                                                     {0, 5, 4},
                                                     {2, 6, 7},
                                                     {2, 7, 3},
                                                     {0, 2, 3},
                                                     {0, 3, 1},
                                                     {4, 5, 7},
                                                     {4, 7, 6}}};

constexpr int kMaxPixels = 4096;  ///< per side
/// next() waits at most this long per call.
constexpr std::chrono::milliseconds kPatience{100};

/// See Tracker: origin below the camera, looking along -Z.
Isometry3 floorFromWorld(const Isometry3& worldFromCamera) {
  const Vec3 looks = worldFromCamera.linear() * -Vec3::UnitZ();
  const double heading = std::atan2(-looks.x(), -looks.z());
  const Vec3 position = worldFromCamera.translation();
  Isometry3 floorFromWorld(Eigen::AngleAxisd(-heading, Vec3::UnitY()));
  floorFromWorld.translate(-Vec3(position.x(), 0.0, position.z()));
  return floorFromWorld;
}

Result<void> check(std::size_t people, const VirtualSensorSettings& settings) {
  if (people > kMaxPeople) {
    return invalidArgument("{} people in front of the virtual sensor, expected at most {}", people, kMaxPeople);
  }
  const DepthCamera& camera = settings.camera;
  if (std::min(camera.width, camera.height) < 2 || std::max(camera.width, camera.height) > kMaxPixels) {
    return invalidArgument("the virtual sensor's image has {} x {} pixels, expected 2 to {} per side", camera.width,
                           camera.height, kMaxPixels);
  }
  for (const double view : {camera.horizontalFov, camera.verticalFov}) {
    if (!(view > 0.01 && view < 3.0)) return invalidArgument("a field of view of {} rad, expected 0.01 to 3", view);
  }
  if (!(settings.framesPerSecond >= 1.0 && settings.framesPerSecond <= 1000.0)) {
    return invalidArgument("{} frames per second, expected 1 to 1000", settings.framesPerSecond);
  }
  const DepthNoiseSettings& noise = settings.noise;
  for (const double part : {noise.axial, noise.lateral, noise.smear, noise.baseline, noise.edgeLoss, noise.steps,
                            noise.dropout, noise.lasting, noise.shared}) {
    if (!(part >= 0.0 && part <= 100.0)) return invalidArgument("a noise setting of {}, expected 0 to 100", part);
  }
  if (noise.steps > 0.0 && noise.steps < 0.01) {
    return invalidArgument("a depth step factor of {}, expected 0 or at least 0.01", noise.steps);
  }
  if (noise.lasting + noise.shared > 1.0) {
    return invalidArgument("shares of {} and {} of the noise, expected at most 1 together", noise.lasting,
                           noise.shared);
  }
  if (!(noise.smoothness >= 1.0 && noise.smoothness <= 1000.0)) {
    return invalidArgument("a noise that is smooth over {} pixels, expected 1 to 1000", noise.smoothness);
  }
  if (noise.dropout > 0.5) return invalidArgument("a dropout of {}, expected 0 to 0.5", noise.dropout);
  if (!(noise.min >= 0.1 && noise.min < noise.max && noise.max <= 60.0)) {
    return invalidArgument("a range of {} to {} m, expected one within 0.1 to 60 m", noise.min, noise.max);
  }
  return {};
}

}  // namespace

Isometry3 worldFromCameraAt(const Vec3& position, double tiltDown, double heading) {
  Isometry3 worldFromCamera = Isometry3::Identity();
  worldFromCamera.translate(position);
  worldFromCamera.rotate(Eigen::AngleAxisd(heading, Vec3::UnitY()));
  worldFromCamera.rotate(Eigen::AngleAxisd(-tiltDown, Vec3::UnitX()));
  return worldFromCamera;
}

void drawRoom(const VirtualRoom& room, DepthRenderer& renderer) {
  const Isometry3 cameraFromWorld = room.worldFromCamera.inverse();
  const Vec3 position = room.worldFromCamera.translation();
  if (room.floor && position.y() != 0.0) {
    renderer.drawPlane(cameraFromWorld.linear() * Vec3::UnitY(), -position.y(), 0);
  }
  if (room.wall && position.z() != *room.wall) {
    renderer.drawPlane(cameraFromWorld.linear() * Vec3::UnitZ(), *room.wall - position.z(), 0);
  }
  for (const Aabb& box : room.boxes) {
    std::array<Vec3, 8> corners;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vec3 corner((i & 1) != 0 ? box.max.x() : box.min.x(), (i & 2) != 0 ? box.max.y() : box.min.y(),
                        (i & 4) != 0 ? box.max.z() : box.min.z());
      corners[i] = cameraFromWorld * corner;
    }
    renderer.draw(corners, kBoxTriangles, SurfaceSides::kOuter, 0);
  }
}

SkeletonFrame moved(SkeletonFrame joints, const Isometry3& otherFromThis) {
  const Quat turn(otherFromThis.linear());
  for (TrackedJoint& joint : joints.joints) {
    joint.position = otherFromThis * joint.position;
    if (joint.orientation) joint.orientation = turn * *joint.orientation;
  }
  return joints;
}

Result<VirtualSensor> VirtualSensor::create(std::vector<VirtualPerson> people, const VirtualSensorSettings& settings) {
  LORICA_TRY_DO(check(people.size(), settings));
  return VirtualSensor(std::move(people), settings);
}

VirtualSensor::VirtualSensor(std::vector<VirtualPerson> people, const VirtualSensorSettings& settings)
    : settings_(settings),
      people_(std::move(people)),
      floorFromCamera_(floorFromWorld(settings.room.worldFromCamera) * settings.room.worldFromCamera),
      renderer_(settings.camera),
      noise_(settings.camera, settings.noise),
      roomNow_(settings.room),
      truth_(people_.size()) {
  double seconds = 0.0;
  for (const VirtualPerson& person : people_) seconds = std::max(seconds, person.performer.seconds() - person.start);
  frameCount_ = static_cast<std::uint64_t>(std::floor(seconds * settings_.framesPerSecond + 1e-6)) + 1;
  roomNow_.boxes.reserve(settings_.room.boxes.size() + settings_.screens.size());
}

void VirtualSensor::render(std::uint64_t number, DepthFrame& frame) {
  const double time = number / settings_.framesPerSecond;
  const Isometry3 cameraFromWorld = settings_.room.worldFromCamera.inverse();
  renderer_.clear();
  roomNow_.boxes.assign(settings_.room.boxes.begin(), settings_.room.boxes.end());
  for (const VirtualScreen& screen : settings_.screens) {
    if (screen.when.holds(time)) roomNow_.boxes.push_back(screen.box);
  }
  drawRoom(roomNow_, renderer_);

  for (std::size_t i = 0; i < people_.size(); ++i) {
    VirtualPerson& person = people_[i];
    VirtualTruth& truth = truth_[i];
    truth.present = true;
    Isometry3 cameraFromMotion = cameraFromWorld * person.worldFromMotion;
    for (const TimeSpan& span : person.absent) {
      if (!span.holds(time)) continue;
      truth.present = person.leaveSpeed > 0.0;
      cameraFromMotion.pretranslate(person.leaveSpeed * std::min(time - span.from, span.to - time) * Vec3::UnitX());
    }
    double performed = person.start + time;
    if (settings_.loop && person.performer.seconds() > 0.0)
      performed = std::fmod(performed, person.performer.seconds());
    person.performer.pose(performed, cameraFromMotion);
    truth.joints = person.performer.joints();
    truth.joints.time = time;
    truth.joints.user = i + 1;
    if (!truth.present) continue;
    renderer_.draw(person.performer.positions(), person.performer.triangles(), person.performer.sides(),
                   static_cast<std::uint8_t>(i + 1));
  }
  for (VirtualTruth& truth : truth_) truth.pixelCount = 0;
  for (const std::uint8_t label : renderer_.labels()) {
    if (label > 0) ++truth_[label - 1U].pixelCount;
  }

  frame.time = time;
  frame.depthMm.resize(renderer_.inverseDepth().size());
  noise_.apply(renderer_.inverseDepth(), number, frame.depthMm);
}

Result<DepthRead> VirtualSensor::next(DepthFrame& frame) {
  using Clock = std::chrono::steady_clock;
  if (settings_.live) {
    const Clock::time_point now = Clock::now();
    if (!begin_) begin_ = now;
    const auto timeOf = [&](std::uint64_t number) {
      return *begin_ + std::chrono::duration_cast<Clock::duration>(
                           std::chrono::duration<double>(number / settings_.framesPerSecond));
    };
    const double passed = std::chrono::duration<double>(now - *begin_).count();
    nextFrame_ = std::max<std::uint64_t>(nextFrame_, passed * settings_.framesPerSecond);
    if (settings_.loop || nextFrame_ < frameCount_) {
      const Clock::time_point due = timeOf(nextFrame_);
      std::this_thread::sleep_until(std::min(due, now + kPatience));
      if (due > now + kPatience) return DepthRead::kWaiting;
    }
  }
  if (!settings_.loop && nextFrame_ >= frameCount_) return DepthRead::kEnd;
  const std::uint64_t number = nextFrame_++;
  const double time = number / settings_.framesPerSecond;
  for (const TimeSpan& span : settings_.unplugged) {
    if (span.holds(time)) return DepthRead::kUnplugged;
  }
  render(number, frame);
  return DepthRead::kFrame;
}

}  // namespace lorica
