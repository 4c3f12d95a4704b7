#pragma once

#include "capture/files/joint_stream.h"

#include <array>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Internal to the joint stream readers: the table of layouts, the common form that every layout is read into, and its
/// conversion to a JointStream.
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
  kOther,  ///< of other skeletons; not used
};
inline constexpr int kSensorJointCount = 25;
inline constexpr int kKinect1JointCount = 20;

/// Looks up a joint by its Kinect v1 or v2 name, case-insensitive: "SpineBase", "HipCenter".
[[nodiscard]] std::optional<SensorJoint> sensorJointNamed(std::string_view name);
/// Looks up a joint by any usual name, in lower case without separators: "leftshoulder", "lshoulder", "pelvis".
[[nodiscard]] std::optional<SensorJoint> sensorJointCalled(std::string_view name);

/// One joint as the file holds it.
struct SensedJoint {
  SensorJoint joint = SensorJoint::kOther;
  std::optional<Vec3> position;  ///< [m]; none: unknown
  double confidence = 0.0;       ///< if it is known
  std::optional<Quat> orientation;
};

/// One body as the sensor reported it; a joint with confidence 0 is unknown.
struct SensorSkeleton {
  std::array<TrackedJoint, kSensorJointCount + 1> joints;

  [[nodiscard]] TrackedJoint& operator[](SensorJoint j) { return joints[static_cast<int>(j)]; }
  [[nodiscard]] const TrackedJoint& operator[](SensorJoint j) const { return joints[static_cast<int>(j)]; }
  void set(const SensedJoint& seen);
};

/// One person at one time, in the sensor's axes, with the toes as a cue for the facing direction.
struct Observation {
  SkeletonFrame frame;                      ///< time in stream ticks, user = person
  std::array<std::optional<Vec3>, 2> toes;  ///< left, right [m]
};

/// The 15 joints of a body. The hand, else the wrist; the neck, else the sensor's shoulder centre.
[[nodiscard]] Observation observe(const SensorSkeleton& body, double time, int person);

/// Output of a reader.
struct RawStream {
  std::vector<Observation> rows;         ///< of all people, in file order
  std::optional<double> secondsPerTick;  ///< none = guess from the time steps
  bool worldAxes = false;                ///< those of Lorica's world, else x to the sensor's left, z away from it
  bool yDown = false;                    ///< as it was in the file
  std::string unit;                      ///< "centimetres, since people measure 172"; empty: as the layout says
  std::vector<std::string> notes;
};

/// A column that a header names.
struct NamedColumn {
  std::string_view ending;  ///< of the name in lower case without separators; what stands in front names the joint
  char field;               ///< as in Layout
  std::string_view called;  ///< in errors
};

/// What the file of a layout holds, and how to read it: a row of the table. Fields are letters: x, y, z of a position;
/// s its state (0, 1, 2 or words); c its confidence; q each of a quaternion's x y z w; j the joint's name; before the
/// joints t the time, n the number of the frame, u the person.
struct Layout {
  JointFormat format;
  std::string_view name;                     ///< of --format
  std::string_view before = {};              ///< fields before the joints
  std::string_view fields = {};              ///< of each joint
  std::string_view more = {};                ///< of each joint, in all rows or in none
  std::span<const SensorJoint> order = {};   ///< of the joints
  std::span<const NamedColumn> header = {};  ///< names columns instead
  int rowsPerFrame = 1;                      ///< the joints are divided among
  bool jointPerRow = false;                  ///< of those with a header: rows of one time are a frame
  double unit = 1.0;                         ///< of positions [m]
  std::optional<double> tick = {};           ///< of times, or of rows without times [s]; none: guessed from the steps
  std::string_view note = {};                ///< to the user
  std::string_view states = {};              ///< in errors: what s may be
  std::string_view expectedRow = {};         ///< in errors: the number of fields and what they are
  std::string_view expectedRowWithMore = {};
  std::string_view expectedFile = {};          ///< in errors: what the rows are
  std::string (*called)(int joint) = nullptr;  ///< in errors
  Result<RawStream> (*read)(const Layout& layout, std::string_view text, std::string_view file) = nullptr;
  void (*repair)(RawStream& raw) = nullptr;  ///< of what only the whole file tells

  /// Number of fields in a row.
  [[nodiscard]] int count(bool withMore = false) const;
};
[[nodiscard]] const Layout& layoutOf(JointFormat format);

/// A column's name in a header.
struct ColumnName {
  std::string plain;           ///< in lower case, without separators and without its unit
  std::optional<double> unit;  ///< [m], [s], if the name holds one: "head_x[mm]", "time_us"
};
[[nodiscard]] ColumnName columnNameOf(std::string_view name);

/// Named columns of fewer joints are taken for something else; it also bounds the frames that a small file holds.
inline constexpr int kFewestNamedJoints = 6;

/// Detects the layout from the content; if ambiguous, an error lists the candidates and refers to --format.
[[nodiscard]] Result<JointFormat> detectFormat(std::string_view text, std::string_view file);

// The readers in the table. Errors name file, line, column, found and expected.
[[nodiscard]] Result<RawStream> readFixedRows(const Layout& layout, std::string_view text, std::string_view file);
[[nodiscard]] Result<RawStream> readBodies(const Layout& layout, std::string_view text, std::string_view file);
[[nodiscard]] Result<RawStream> readUnderHeader(const Layout& layout, std::string_view text, std::string_view file);
[[nodiscard]] Result<RawStream> readNamedColumns(const Layout& layout, std::string_view text, std::string_view file);
/// @param angles  text of the angles file, without which the positions do not define a pose
[[nodiscard]] Result<RawStream> readUiPrmd(std::string_view positions, std::string_view file, std::string_view angles,
                                           std::string_view anglesFile);

/// Position of a person: the torso, else the neck, else the mean of the seen joints; nullopt if none is seen.
[[nodiscard]] std::optional<Vec3> positionOf(const SkeletonFrame& frame);

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

/// Distance that a person moves [m]. Only steps of several centimetres count, so that jitter adds nothing.
class WayMeter {
 public:
  void add(const SkeletonFrame& frame);
  [[nodiscard]] double way() const { return way_; }
  [[nodiscard]] int frames() const { return frames_; }

 private:
  std::optional<Vec3> from_;
  double way_ = 0.0;
  int frames_ = 0;
};

/// Lists the people in a stream and selects the one requested in the settings, else the one that moves most.
/// @param ways  distance of each person, by number; at least one
/// @return the number; or an error that lists the people in the file
[[nodiscard]] Result<int> choosePerson(const std::map<int, WayMeter>& ways, std::string_view file,
                                       const JointStreamSettings& settings, JointStream& stream);

/// Multiplies the axes of positions by signs.
void flip(std::vector<Observation>& rows, const Vec3& signs);

/// Selects the person, converts times to seconds and the sensor's axes to Lorica's, and places the person on the floor.
[[nodiscard]] Result<JointStream> finish(RawStream raw, JointFormat format, std::string_view file,
                                         const JointStreamSettings& settings);

}  // namespace lorica::joints
