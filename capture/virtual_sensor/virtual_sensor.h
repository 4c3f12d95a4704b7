#pragma once

#include "capture/sensor/depth_source.h"
#include "capture/virtual_sensor/depth_noise.h"
#include "capture/virtual_sensor/virtual_performer.h"
#include "capture/virtual_sensor/virtual_room.h"
#include "geometry/result.h"

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// From a time to another, the end not included; by the sensor's clock [s].
struct TimeSpan {
  double from = 0.0, to = 0.0;
  [[nodiscard]] bool holds(double time) const { return from <= time && time < to; }
};

/// Someone before the virtual sensor.
struct VirtualPerson {
  VirtualPerformer performer;
  /// Where the motion's world lies in the room: moved over the floor and turned about the vertical, or more.
  Isometry3 worldFromMotion = Isometry3::Identity();
  double start = 0.0;                 ///< where in the motion the sensor's time 0 is [s]
  std::vector<TimeSpan> absent = {};  ///< when the person is away
  /// 0 = the person vanishes for the whole span and is back at its end; else slides out to the camera's right at its
  /// begin and back so as to stand in place at its end [m/s].
  double leaveSpeed = 0.0;
};

/// A box that stands in the room for a while, such as a screen that hides people.
struct VirtualScreen {
  Aabb box;  ///< world [m]
  TimeSpan when;
};

struct VirtualSensorSettings {
  DepthCamera camera;
  VirtualRoom room;
  DepthNoiseSettings noise;
  double framesPerSecond = 30.0;
  /// Frames come by the wall clock, and those that nobody fetched in time are lost; else as fast as they are asked for.
  bool live = false;
  /// Each person begins anew after the motion's end; else the source ends when the last one has.
  bool loop = false;
  std::vector<TimeSpan> unplugged;  ///< when frames are lost and next() says kUnplugged
  std::vector<VirtualScreen> screens;
};

/// What is true of a person in a frame.
struct VirtualTruth {
  bool present = false;
  SkeletonFrame joints;  ///< camera frame; `user` is the person's place in the list, from 1; time of the frame
  int pixelCount = 0;    ///< of the clean image that show the person
};

/// A depth camera before people who perform recorded motions: what Lorica is tried and tested with where there is no
/// camera. Depth is rendered, then spoilt as a Kinect v1 spoils it; and the truth is known.
///
///     std::vector<VirtualPerson> people;
///     people.push_back({VirtualPerformer::create(makeMannequin(), synthesizeMotion(SyntheticMotion::kWave)).value()});
///     VirtualSensorSettings settings;
///     settings.noise.seed = 3;
///     VirtualSensor sensor = VirtualSensor::create(std::move(people), settings).value();
///     DepthFrame frame;
///     while (sensor.next(frame).value() == DepthRead::kFrame) {
///       tracker.track(frame);  // compare with:
///       const SkeletonFrame truth = moved(sensor.truth()[0].joints, sensor.floorFromCamera());
///     }
///
/// Other bodies: withProportions(makeMannequin(), {.height = 1.1}), {.girth = 1.25}. Clean depth:
/// settings.noise = DepthNoiseSettings::clean(). Same settings, same frames. Where nothing is live, next() allocates
/// nothing after the first frame.
class VirtualSensor final : public DepthSource {
 public:
  /// @param people  up to 6; may be none
  /// @return the sensor, or which setting is out of range
  static Result<VirtualSensor> create(std::vector<VirtualPerson> people, const VirtualSensorSettings& settings = {});

  [[nodiscard]] const DepthCamera& camera() const override { return settings_.camera; }
  [[nodiscard]] std::string name() const override { return "virtual sensor"; }
  [[nodiscard]] Result<DepthRead> next(DepthFrame& frame) override;

  /// Any frame, out of order. @param number  from 0; its time is number / framesPerSecond
  void render(std::uint64_t number, DepthFrame& frame);
  /// Frames until the end where nothing is looped; by the longest motion.
  [[nodiscard]] std::uint64_t frameCount() const { return frameCount_; }

  /// Of the last frame: one a person, as given to create().
  [[nodiscard]] std::span<const VirtualTruth> truth() const { return truth_; }
  /// Of the last frame before noise: 0 the room, else the person's place in the list, from 1.
  [[nodiscard]] std::span<const std::uint8_t> labels() const { return renderer_.labels(); }
  /// The true floor frame as Tracker defines it.
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

/// Joints in another frame: positions and orientations. @param otherFromThis  of the frame that they are in
[[nodiscard]] SkeletonFrame moved(SkeletonFrame joints, const Isometry3& otherFromThis);

}  // namespace lorica
