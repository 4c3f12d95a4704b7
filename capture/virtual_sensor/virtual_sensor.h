#pragma once

#include "capture/sensor/depth_frame.h"
#include "capture/virtual_sensor/depth_noise.h"
#include "capture/virtual_sensor/depth_render.h"
#include "capture/virtual_sensor/virtual_performer.h"
#include "geometry/result.h"

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// Pose of a camera at a position in the world, without roll.
/// @param tiltDown  angle of its axis below the horizon [rad]
/// @param heading   0 looks along -Z; positive turns it to its left, about +Y [rad]
[[nodiscard]] Isometry3 worldFromCameraAt(const Vec3& position, double tiltDown, double heading = 0.0);

/// The surroundings of the people seen by a depth camera: world frame, Y up, floor y = 0 [m]. Motions start near the
/// origin and face +Z, towards the camera.
struct VirtualRoom {
  Isometry3 worldFromCamera = worldFromCameraAt({0.0, 1.1, 3.0}, 0.05);
  bool floor = true;
  std::optional<double> wall = -1.6;  ///< a wall at this z, across the view [m]
  std::vector<Aabb> boxes;            ///< furniture
};

/// Draws floor, wall and boxes, all with label 0.
void drawRoom(const VirtualRoom& room, DepthRenderer& renderer);

/// Interval from one time to another, end excluded; in the sensor's clock [s].
struct TimeSpan {
  double from = 0.0, to = 0.0;
  [[nodiscard]] bool holds(double time) const { return from <= time && time < to; }
};

/// A person in front of the virtual sensor.
struct VirtualPerson {
  VirtualPerformer performer;
  /// Pose of the motion's world in the room: usually moved on the floor and rotated about the vertical.
  Isometry3 worldFromMotion = Isometry3::Identity();
  double start = 0.0;                 ///< time in the motion at the sensor's time 0 [s]
  std::vector<TimeSpan> absent = {};  ///< when the person is away
  /// 0 = the person vanishes for the whole span and is back at its end; else moves out to the camera's right at its
  /// start and back so as to be in position at its end [m/s].
  double leaveSpeed = 0.0;
};

/// A box that is in the room temporarily, for example a screen that hides people.
struct VirtualScreen {
  Aabb box;  ///< world [m]
  TimeSpan when;
};

struct VirtualSensorSettings {
  DepthCamera camera;
  VirtualRoom room;
  DepthNoiseSettings noise;
  double framesPerSecond = 30.0;
  /// Frames arrive in real time, and frames that are not fetched in time are dropped; else as fast as they are
  /// requested.
  bool live = false;
  /// Each person repeats the motion after its end; else the source ends when the last motion ends.
  bool loop = false;
  std::vector<TimeSpan> unplugged;  ///< when frames are lost and next() returns kUnplugged
  std::vector<VirtualScreen> screens;
};

/// Ground truth of a person in a frame.
struct VirtualTruth {
  bool present = false;
  SkeletonFrame joints;  ///< camera frame; `user` is the person's number in the list, from 1; time of the frame
  int pixelCount = 0;    ///< number of pixels of the clean image that show the person
};

/// A depth camera in front of people who perform recorded motions, for trying and testing Lorica without a camera.
/// Depth is rendered, then degraded like that of a real camera, by default a Kinect v1; the ground truth is known.
///
///     std::vector<VirtualPerson> people;
///     people.push_back({VirtualPerformer::create(makeMannequin(), shippedFrames("wave")).value()});
///     VirtualSensorSettings settings;
///     settings.noise.seed = 3;
///     VirtualSensor sensor = VirtualSensor::create(std::move(people), settings).value();
///     DepthFrame frame;
///     while (sensor.next(frame).value() == DepthRead::kFrame) {
///       tracker.track(frame);  // compare with:
///       const SkeletonFrame truth = moved(sensor.truth()[0].joints, sensor.floorFromCamera());
///     }
///
/// Other bodies: withProportions(makeMannequin(), {.height = 1.1}), {.girth = 1.25}. Clean depth: settings.noise =
/// DepthNoiseSettings::clean(). The same settings give the same frames. If not live, next() allocates nothing after the
/// first frame.
class VirtualSensor final : public DepthSource {
 public:
  /// @param people  up to 6; may be empty
  /// @return the sensor, or an error with the setting that is out of range
  static Result<VirtualSensor> create(std::vector<VirtualPerson> people, const VirtualSensorSettings& settings = {});

  [[nodiscard]] const DepthCamera& camera() const override { return settings_.camera; }
  [[nodiscard]] std::string name() const override { return "virtual sensor"; }
  [[nodiscard]] Result<DepthRead> next(DepthFrame& frame) override;

  /// Renders any frame, in any order. @param number  from 0; its time is number / framesPerSecond
  void render(std::uint64_t number, DepthFrame& frame);
  /// Number of frames if not looped, determined by the longest motion.
  [[nodiscard]] std::uint64_t frameCount() const { return frameCount_; }

  /// Of the last frame: one per person, in the order given to create().
  [[nodiscard]] std::span<const VirtualTruth> truth() const { return truth_; }
  /// Of the last frame before noise: 0 the room, else the person's number in the list, from 1.
  [[nodiscard]] std::span<const std::uint8_t> labels() const { return renderer_.labels(); }
  /// The true floor frame as defined by Tracker.
  [[nodiscard]] const Isometry3& floorFromCamera() const { return floorFromCamera_; }

 private:
  VirtualSensor(std::vector<VirtualPerson> people, const VirtualSensorSettings& settings);

  VirtualSensorSettings settings_;
  std::vector<VirtualPerson> people_;
  Isometry3 floorFromCamera_;
  std::uint64_t frameCount_ = 0;
  std::uint64_t nextFrame_ = 0;
  std::optional<std::chrono::steady_clock::time_point> begin_;
  DepthRenderer renderer_;
  DepthNoise noise_;
  VirtualRoom roomNow_;
  std::vector<VirtualTruth> truth_;
};

/// Transforms joints to another frame: positions and orientations. @param otherFromThis  from their current frame
[[nodiscard]] SkeletonFrame moved(SkeletonFrame joints, const Isometry3& otherFromThis);

}  // namespace lorica
