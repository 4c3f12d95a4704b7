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

/// Internal to the joint streams: what every format is read into, and where that is made a JointStream.
namespace lorica::joints {

/// The 25 joints of Kinect v2 in its own order. Those of v1 are among them under other names.
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

/// By the name that Kinect v1 or v2 has for it, in any case: "SpineBase", "HipCenter".
[[nodiscard]] std::optional<SensorJoint> sensorJointNamed(std::string_view name);
/// Kinect v1 and UTKinect: place in the row to joint.
[[nodiscard]] const std::array<SensorJoint, kKinect1JointCount>& kinect1Order();
/// MSR Action3D: place in the frame to joint.
[[nodiscard]] const std::array<SensorJoint, kKinect1JointCount>& msrOrder();

/// One body as a sensor saw it: places [m]; a joint of confidence 0 is unknown.
struct SensorBody {
  std::array<Vec3, kSensorJointCount> place;
  std::array<double, kSensorJointCount> confidence{};

  [[nodiscard]] bool has(SensorJoint j) const { return confidence[static_cast<std::size_t>(j)] > 0.0; }
  [[nodiscard]] const Vec3& at(SensorJoint j) const { return place[static_cast<std::size_t>(j)]; }
  void set(SensorJoint j, const std::optional<Vec3>& where, double confidenceIfSeen);
};

/// One person at one time, in the sensor's axes, and what else the sensor saw that tells where the front is.
struct Observation {
  SkeletonFrame frame;                      ///< time in ticks of the stream, user = person
  std::array<std::optional<Vec3>, 2> toes;  ///< left, right [m]
};

/// The 15 joints of a body: the hand, else the wrist; the neck, else the middle of the shoulders as the sensor has it.
[[nodiscard]] Observation observe(const SensorBody& body, double time, int person);

/// Where positions live: x to the sensor's left and z away from it, or as in Lorica's world, but for the floor.
enum class Axes : std::uint8_t { kSensor, kWorld };

/// What a parser makes of a file.
struct RawStream {
  std::vector<Observation> rows;         ///< of all persons, in the file's order
  std::optional<double> secondsPerTick;  ///< none = guess from the steps
  Axes axes = Axes::kSensor;
  std::vector<std::string> notes;
};

/// Tells apart two persons whom the file does not name: at one time there is one row of each.
class PersonTracks {
 public:
  /// @return the person's number from 1: of the last row at this time the same one if it stands where that one does
  ///         (the sensor was read twice), else one who was not yet seen at this time, the nearest one
  [[nodiscard]] int personAt(double time, const SkeletonFrame& frame);

 private:
  struct Track {
    Vec3 place;
    double time;
  };
  std::vector<Track> tracks_;
};

/// Where a person is: the torso, else the neck, else the middle of what is seen; nothing when nothing is.
[[nodiscard]] std::optional<Vec3> placeOf(const SkeletonFrame& frame);

/// Chooses the person, gives times in seconds, turns the sensor's axes into Lorica's and sets the person on the floor.
[[nodiscard]] Result<JointStream> finish(RawStream raw, JointFormat format, std::string_view file,
                                         const JointStreamSettings& settings);
/// How far a person goes [m]. Steps of some centimetres are counted as one, so that jitter is no way.
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

/// The person that the settings name, else the one that moves most; or the sentence that says who is there.
/// @param ways  of each person, by number; at least one
[[nodiscard]] Result<int> choosePerson(const std::map<int, WayMeter>& ways, std::string_view file,
                                       const JointStreamSettings& settings);

// One for each layout. The sentences of failure name file, line, column, found and expected.
[[nodiscard]] Result<RawStream> parseMsrAction3d(std::string_view text, std::string_view file);
[[nodiscard]] Result<RawStream> parseUtKinect(std::string_view text, std::string_view file);
[[nodiscard]] Result<RawStream> parseKinect2Bodies(std::string_view text, std::string_view file);
[[nodiscard]] Result<RawStream> parseKinect2Wide(std::string_view text, std::string_view file);
[[nodiscard]] Result<RawStream> parseKinect1Long(std::string_view text, std::string_view file);
[[nodiscard]] Result<RawStream> parseKinect2Plain(std::string_view text, std::string_view file);
[[nodiscard]] Result<RawStream> parseUpperBody(std::string_view text, std::string_view file);
[[nodiscard]] Result<RawStream> parseNite2(std::string_view text, std::string_view file);
/// @param angles  text of the file of angles, without which the positions are no pose
[[nodiscard]] Result<RawStream> parseUiPrmd(std::string_view positions, std::string_view file, std::string_view angles,
                                            std::string_view anglesFile);

/// The layout that the content shows; or which ones it might be, and that --format says.
[[nodiscard]] Result<JointFormat> detectFormat(std::string_view text, std::string_view file);

}  // namespace lorica::joints
