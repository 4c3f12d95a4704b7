#pragma once

#include "capture/files/joint_stream.h"

#include <array>
#include <functional>
#include <initializer_list>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Internal to the joint stream readers: the table of layouts, the common form that every layout is read into, and its
/// conversion to a JointStream.
namespace lorica::joints {

class RowReader;

/// The 25 joints of Kinect v2 in its order, of which v1 has a subset under other names, and what cameras with landmarks
/// see.
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
  kNose,
  kEarLeft,
  kEarRight,
  kIndexLeft,
  kIndexRight,
  kPinkyLeft,
  kPinkyRight,
  kOther,  ///< known, but not used
};
inline constexpr int kSensorJointCount = static_cast<int>(SensorJoint::kOther) + 1;
inline constexpr int kKinect1JointCount = 20;

/// Looks up a joint by any usual name: "SpineBase", "HipCenter", "LEFT_SHOULDER", "l. shoulder", "pelvis".
[[nodiscard]] std::optional<SensorJoint> sensorJointCalled(std::string_view name);

/// The joints that a sensor numbers, by their count: 20 of Kinect v1, 25 of v2, 32 of Azure Kinect, 33 of MediaPipe.
/// Empty for other counts.
struct JointOrder {
  std::span<const SensorJoint> joints = {};
  std::string_view sensor = {};
};
[[nodiscard]] JointOrder orderOf(int count);

/// In which order a file numbers joints, and the number of the order's first joint: 0 or 1.
struct Numbering {
  JointOrder order = {};  ///< empty: no sensor numbers its joints so
  int first = 0;

  [[nodiscard]] std::optional<SensorJoint> jointOf(int number) const;
};
/// That of the sensor with as many joints, of which a few may never be seen.
/// @param landmarks  whether the file calls them landmarks: then they are MediaPipe's, however few
[[nodiscard]] Numbering numberingOf(const std::set<int>& numbers, bool landmarks);

/// The sensor's joints that are the 15 of a body, in their order.
inline constexpr std::array<SensorJoint, kBodyJointCount> kBodyOrder = {
    SensorJoint::kHead,      SensorJoint::kNeck,       SensorJoint::kShoulderLeft, SensorJoint::kShoulderRight,
    SensorJoint::kElbowLeft, SensorJoint::kElbowRight, SensorJoint::kHandLeft,     SensorJoint::kHandRight,
    SensorJoint::kSpineMid,  SensorJoint::kHipLeft,    SensorJoint::kHipRight,     SensorJoint::kKneeLeft,
    SensorJoint::kKneeRight, SensorJoint::kAnkleLeft,  SensorJoint::kAnkleRight};

/// One joint as the file holds it.
struct SensedJoint {
  SensorJoint joint = SensorJoint::kOther;
  std::optional<Vec3> position;  ///< [m]; none: unknown
  double confidence = 0.0;       ///< if it is known
  std::optional<Quat> orientation;
};

/// One body as the sensor reported it; a joint with confidence 0 is unknown.
struct SensorSkeleton {
  std::array<TrackedJoint, kSensorJointCount> joints;

  [[nodiscard]] TrackedJoint& operator[](SensorJoint j) { return joints[static_cast<int>(j)]; }
  [[nodiscard]] const TrackedJoint& operator[](SensorJoint j) const { return joints[static_cast<int>(j)]; }
  void set(const SensedJoint& seen);
  /// Derives head, neck, torso and hands that are not seen from what stands around them.
  void complete();
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
  bool towardsFront = false;             ///< people are turned by quarter turns to where most face +Z
  bool centred = false;                  ///< the hips are at the origin in every frame
  std::string unit;                      ///< "centimetres, since ..."; empty: as the layout says
  std::string axes;                      ///< "Y is down, since ..."; empty: Y is up
  std::vector<std::string> notes;
};

/// What the file of a layout holds, and how to read it: a row of the table. Fields are letters: x, y, z of a position;
/// s its state (0, 1, 2 or words); c its confidence; q each of a quaternion's x y z w; j the joint's name; before the
/// joints t the time, n the number of the frame, u the person. Without fields, a header names the columns.
struct Layout {
  JointFormat format;
  std::string_view name;                    ///< of --format
  std::string_view before = {};             ///< fields before the joints
  std::string_view fields = {};             ///< of each joint
  std::string_view more = {};               ///< of each joint, in all rows or in none
  std::span<const SensorJoint> order = {};  ///< of the joints
  int rowsPerFrame = 1;                     ///< the joints are divided among
  double unit = 1.0;                        ///< of positions [m]
  std::optional<double> tick = {};          ///< of times, or of rows without times [s]; none: guessed from the steps
  std::string_view note = {};               ///< to the user
  std::string_view states = {};             ///< in errors: what s may be
  std::string_view expectedRow = {};        ///< in errors: the number of fields and what they are
  std::string_view expectedRowWithMore = {};
  std::string_view expectedFile = {};          ///< in errors: what the rows are
  bool world = false;                          ///< positions are in a world whatever they are, not before a sensor
  std::string (*called)(int joint) = nullptr;  ///< in errors
  Result<RawStream> (*read)(const Layout& layout, std::string_view text, std::string_view file) = nullptr;
  void (*repair)(RawStream& raw) = nullptr;  ///< of what only the whole file tells

  /// Number of fields in a row.
  [[nodiscard]] int count(bool withMore = false) const;
};
[[nodiscard]] const Layout& layoutOf(JointFormat format);

/// A column of a row, and what errors call it.
struct Column {
  int at = -1;
  std::string called = {};

  explicit operator bool() const { return at >= 0; }
};

/// The columns of one joint.
struct JointColumns {
  std::optional<SensorJoint> joint = {};  ///< none: the row names it
  int number = -1;                        ///< in the names of a header that numbers joints
  Numbering numbering = {};               ///< of rows that number the joint
  Column name = {}, state = {}, confidence = {}, turn = {};
  std::array<Column, 3> position = {};

  /// The first axis without a column, or -1.
  [[nodiscard]] int lacks() const;
};

/// Where the fields of a row are: from the table, or from the file's header.
struct Columns {
  JointFormat kind = JointFormat::kNamedColumns;  ///< of a header: named, long (a row for each joint), or wide
  int count = 0;
  Column time, frame, person;
  std::optional<double> tick;  ///< of times [s], if a name says so
  std::optional<double> unit;  ///< of positions [m], if their names say so
  std::vector<JointColumns> joints;
  std::vector<bool> torn;  ///< of each column: whether it may be torn at a decimal comma
  std::vector<std::string> notes;
};

/// Those of a layout with fixed columns. Rows that are parts of a frame start from column 0 each.
[[nodiscard]] Columns columnsOf(const Layout& layout, bool withMore = false);

/// Those that a header names, in any order. A name is a joint with an axis or another word before or behind it; names
/// without a joint ("PositionX") belong to the joint that the row names, the n-th of them to the n-th joint.
/// @param kind  what the header must be: named, long or wide
[[nodiscard]] Result<Columns> columnsOf(const RowReader& header, JointFormat kind);
/// What a header is; nullopt: none that is known.
[[nodiscard]] std::optional<JointFormat> kindOfHeader(const RowReader& row);

/// A header that names fewer joints is taken for something else; it also bounds the frames that a small file holds.
inline constexpr int kFewestNamedJoints = 6;
/// Smaller frames carry no information; they would also let a small file expand into many frames.
inline constexpr int kFewestSeenJoints = 3;

/// Kinect v2 gives every tracked body a new 17-digit number: people are renumbered from 1 in order of appearance.
class PersonNumbers {
 public:
  int of(std::string_view id);

 private:
  std::map<std::string, int> numbers_;
};

/// The unit of a time [s] by the plain name of a column or member; 0: a time without a unit; nullopt: no time.
[[nodiscard]] std::optional<double> unitOfTime(std::string_view plain);

/// Whether a text begins as JSON, or as OpenSim's table of markers. They have no header of columns in one line.
[[nodiscard]] bool isJson(std::string_view text);
[[nodiscard]] bool isMarkerTable(std::string_view text);

/// Detects the layout from the content; if ambiguous, an error lists the candidates and refers to --format.
[[nodiscard]] Result<JointFormat> detectFormat(std::string_view text, std::string_view file);

// The readers in the table. Errors name file, line, column, found and expected.
[[nodiscard]] Result<RawStream> readRows(const Layout& layout, std::string_view text, std::string_view file);
[[nodiscard]] Result<RawStream> readBodies(const Layout& layout, std::string_view text, std::string_view file);
[[nodiscard]] Result<RawStream> readNamed(const Layout& layout, std::string_view text, std::string_view file);
[[nodiscard]] Result<RawStream> readAzureJson(const Layout& layout, std::string_view text, std::string_view file);
[[nodiscard]] Result<RawStream> readMediaPipeJson(const Layout& layout, std::string_view text, std::string_view file);
[[nodiscard]] Result<RawStream> readMarkers(const Layout& layout, std::string_view text, std::string_view file);
/// @param angles  text of the angles file, without which the positions do not define a pose
[[nodiscard]] Result<RawStream> readUiPrmd(std::string_view positions, std::string_view file, std::string_view angles,
                                           std::string_view anglesFile);

/// Judges unit and axes by the body: people are 1 to 2.3 m tall and stand upright. Turns them to the sensor's axes.
/// @param unit  of positions if the file says so [m]
/// @param read  reads the file with a unit
/// @param world  positions are not before a sensor, wherever people stand
[[nodiscard]] Result<RawStream> judged(std::string_view file, std::optional<double> unit,
                                       const std::function<Result<RawStream>(double unit)>& read, bool world = false);
/// Makes confidences 0, 0.5 or 1: of states up to 3, of probabilities, or of percents.
void judgeConfidences(std::vector<Observation>& rows);

/// The position of a joint, or what leads from one to another; nullopt if one is not seen.
[[nodiscard]] std::optional<Vec3> seen(const SkeletonFrame& frame, BodyJoint joint);
[[nodiscard]] std::optional<Vec3> between(const SkeletonFrame& frame, BodyJoint from, BodyJoint to);
/// The mean of those of some joints that are seen; nullopt if none is. @param all  they must all be seen
[[nodiscard]] std::optional<Vec3> middleOf(const SkeletonFrame& frame, std::initializer_list<BodyJoint> joints,
                                           bool all = false);

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

/// Changes the positions of all joints and toes.
template <typename Change>
void changePositions(std::vector<Observation>& rows, const Change& change) {
  for (Observation& row : rows) {
    for (TrackedJoint& joint : row.frame.joints) joint.position = change(joint.position);
    for (std::optional<Vec3>& toe : row.toes) {
      if (toe) toe = change(*toe);
    }
  }
}
/// Multiplies the axes of positions by signs.
void flip(std::vector<Observation>& rows, const Vec3& signs);

/// Selects the person, converts times to seconds and the sensor's axes to Lorica's, and places the person on the floor.
[[nodiscard]] Result<JointStream> finish(RawStream raw, JointFormat format, std::string_view file,
                                         const JointStreamSettings& settings);

}  // namespace lorica::joints
