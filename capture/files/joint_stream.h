#pragma once

#include "capture/skeleton_frame.h"
#include "geometry/result.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// Layouts of files with recorded joints.
enum class JointFormat : std::uint8_t {
  kLorica,         ///< recordings/FORMAT.md
  kMsrAction3d,    ///< 20 rows per frame: x y z confidence
  kUtKinect,       ///< per row: frame number and 20 x (x y z)
  kKinect2Bodies,  ///< sec|kb,time,...: six bodies per row
  kKinect2Wide,    ///< a header of 232 names, one body per row
  kKinect1Long,    ///< Time(ms),JointType,X,Y,Z
  kKinect2Plain,   ///< 75 values per row, no header
  kUiPrmd,         ///< 22 x 3 relative positions [cm]; orientations come from the angles file beside it, if present
  kUpperBody,      ///< 18 values per row: shoulder, elbow, hand of both arms
  kNite2,          ///< time, user, then 15 x (x y z confidence [qx qy qz qw])
  kNamedColumns,   ///< a header that names the joints: time, head_x, head_y, head_z, ...
  kAzureJson,      ///< frames of bodies as Azure Kinect's offline_processor writes them
  kMediaPipeJson,  ///< frames of MediaPipe's 33 landmarks, or of points that are named as joints
  kTrc,            ///< OpenSim's table of markers, named as joints
};
/// Layouts that JointFormat names
inline constexpr int kJointFormatCount = static_cast<int>(JointFormat::kTrc) + 1;

/// Option value for `--format`: "lorica", "msr-action3d", "utkinect", "kinect2-bodies", ...
[[nodiscard]] std::string_view nameOf(JointFormat format);
/// The inverse of nameOf(); nothing for other names.
[[nodiscard]] std::optional<JointFormat> jointFormatNamed(std::string_view name);

/// How a file of recorded joints is read.
struct JointStreamSettings {
  std::optional<JointFormat> format = {};  ///< none = detected from the content
  std::optional<int> person = {};          ///< which of several people in one stream; none = the one that moves most
};

/// One person's joints from a file, in Lorica's units and axes.
struct JointStream {
  std::vector<SkeletonFrame> frames;          ///< at least one, times increasing
  JointFormat format = JointFormat::kLorica;  ///< found or given
  std::vector<int> people;                    ///< numbers of all people in the file, ascending
  std::vector<std::string> firstGuess = {};   ///< unit, axes and floor, and what they were taken from
  std::vector<std::string> notes;             ///< what was repaired or omitted, or is odd: one sentence each
  Vec3 origin = Vec3::Zero();                 ///< of the frames, in the axes of the file's world [m]
  double start = 0.0;                         ///< time 0 of the frames, in the clock of the file [s]
};

/// Reads recorded joints in any of the known layouts. Handles decimal commas, repeated or out-of-order frames, gaps,
/// and times in seconds, milliseconds or 100 ns. Joints that a sensor only inferred have confidence 0.5. The person is
/// placed on the floor y = 0 and faces +Z if they looked at the sensor.
/// @return the joints; or an error with file, line, found and expected
[[nodiscard]] Result<JointStream> readJointStream(const std::filesystem::path& file,
                                                  const JointStreamSettings& settings = {});

/// Reads everybody in a file, by increasing number, as they stood to each other and in one time. Who comes later,
/// leaves earlier or is lost for more than half a second has frames of kNobody meanwhile.
/// @return the streams; or an error as of readJointStream(), or if there are more than 64 people
[[nodiscard]] Result<std::vector<JointStream>> readJointStreamOfAll(const std::filesystem::path& file,
                                                                    const JointStreamSettings& settings = {});

/// Reads joint text in memory. @param name  name of the text in error messages
[[nodiscard]] Result<JointStream> parseJointStream(std::string_view text, std::string_view name,
                                                   const JointStreamSettings& settings = {});

}  // namespace lorica
