#pragma once

#include "capture/files/joint_stream.h"

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Internal to the joint stream readers: the common form that every format is parsed into, and its conversion to a
/// JointStream.
namespace lorica::joints {

/// The 25 joints of Kinect v2 in its order. The joints of v1 are a subset under other names.
enum class SensorJoint : std::uint8_t {
  kSpineBase,
  kSpineMid,
  kNeck,
  kHead,
  kShoulderLeft,
  kElbowLeft,
  kWristLeft,
  kHandLeft,
  kShoulderRight,
  kElbowRight,
  kWristRight,
  kHandRight,
  kHipLeft,
  kKneeLeft,
  kAnkleLeft,
  kFootLeft,
  kHipRight,
  kKneeRight,
  kAnkleRight,
  kFootRight,
  kSpineShoulder,
  kHandTipLeft,
  kThumbLeft,
  kHandTipRight,
  kThumbRight,
};
inline constexpr std::size_t kSensorJointCount = 25;
inline constexpr std::size_t kKinect1JointCount = 20;

/// Looks up a joint by its Kinect v1 or v2 name, case-insensitive: "SpineBase", "HipCenter".
[[nodiscard]] std::optional<SensorJoint> sensorJointNamed(std::string_view name);
/// Kinect v1 and UTKinect: index in the row to joint.
[[nodiscard]] const std::array<SensorJoint, kKinect1JointCount>& kinect1Order();
/// MSR Action3D: index in the frame to joint.
[[nodiscard]] const std::array<SensorJoint, kKinect1JointCount>& msrOrder();

/// One body as the sensor reported it: positions [m]; a joint with confidence 0 is unknown.
struct SensorSkeleton {
  std::array<Vec3, kSensorJointCount> position;
  std::array<double, kSensorJointCount> confidence{};

  [[nodiscard]] bool has(SensorJoint j) const { return confidence[static_cast<std::size_t>(j)] > 0.0; }
  [[nodiscard]] const Vec3& at(SensorJoint j) const { return position[static_cast<std::size_t>(j)]; }
  void set(SensorJoint j, const std::optional<Vec3>& where, double confidenceIfSeen);
};

/// One person at one time, in the sensor's axes, with the toes as a cue for the facing direction.
struct Observation {
  SkeletonFrame frame;                      ///< time in stream ticks, user = person
  std::array<std::optional<Vec3>, 2> toes;  ///< left, right [m]
};

/// The 15 joints of a body. The hand, else the wrist; the neck, else the sensor's shoulder centre.
[[nodiscard]] Observation observe(const SensorSkeleton& body, double time, int person);

/// Axes of the positions: x to the sensor's left and z away from it, or those of Lorica's world except for the floor
/// height.
enum class Axes : std::uint8_t { kSensor, kWorld };

/// Output of a parser.
struct RawStream {
  std::vector<Observation> rows;         ///< of all people, in file order
  std::optional<double> secondsPerTick;  ///< none = guess from the time steps
  Axes axes = Axes::kSensor;
  std::vector<std::string> notes;
};

/// Distinguishes people whom the file does not identify: each has one row per time.
class PersonTracks {
 public:
  /// @return the person's number from 1. If the row is at the position of the previous row of this time, the same
  /// person (the sensor was read twice); else the nearest person not yet seen at this time
  [[nodiscard]] int personAt(double time, const SkeletonFrame& frame);

 private:
  struct Track {
    Vec3 position;
    double time;
  };
  std::vector<Track> tracks_;
};

/// Position of a person: the torso, else the neck, else the mean of the seen joints; nullopt if none is seen.
[[nodiscard]] std::optional<Vec3> positionOf(const SkeletonFrame& frame);

/// Selects the person, converts times to seconds and the sensor's axes to Lorica's, and places the person on the floor.
[[nodiscard]] Result<JointStream> finish(RawStream raw, JointFormat format, std::string_view file,
                                         const JointStreamSettings& settings);
/// Distance that a person moves [m]. Only steps of several centimetres count, so that jitter adds nothing.
class WayMeter {
 public:
  void add(const SkeletonFrame& frame);
  [[nodiscard]] double way() const { return way_; }
  [[nodiscard]] std::size_t frames() const { return frames_; }

 private:
  std::optional<Vec3> from_;
  double way_ = 0.0;
  std::size_t frames_ = 0;
};

/// The person requested in the settings, else the one that moves most; or an error that lists the people in the file.
/// @param ways  distance of each person, by number; at least one
[[nodiscard]] Result<int> choosePerson(const std::map<int, WayMeter>& ways, std::string_view file,
                                       const JointStreamSettings& settings);

// One parser per layout. Errors name file, line, column, found and expected.
[[nodiscard]] Result<RawStream> parseMsrAction3d(std::string_view text, std::string_view file);
[[nodiscard]] Result<RawStream> parseUtKinect(std::string_view text, std::string_view file);
[[nodiscard]] Result<RawStream> parseKinect2Bodies(std::string_view text, std::string_view file);
[[nodiscard]] Result<RawStream> parseKinect2Wide(std::string_view text, std::string_view file);
[[nodiscard]] Result<RawStream> parseKinect1Long(std::string_view text, std::string_view file);
[[nodiscard]] Result<RawStream> parseKinect2Plain(std::string_view text, std::string_view file);
[[nodiscard]] Result<RawStream> parseUpperBody(std::string_view text, std::string_view file);
[[nodiscard]] Result<RawStream> parseNite2(std::string_view text, std::string_view file);
/// @param angles  text of the angles file, without which the positions do not define a pose
[[nodiscard]] Result<RawStream> parseUiPrmd(std::string_view positions, std::string_view file, std::string_view angles,
                                            std::string_view anglesFile);

/// Detects the layout from the content; if ambiguous, an error lists the candidates and refers to --format.
[[nodiscard]] Result<JointFormat> detectFormat(std::string_view text, std::string_view file);

}  // namespace lorica::joints
