#pragma once

#include "capture/skeleton_frame.h"
#include "geometry/result.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// How files of recorded joints are laid out.
enum class JointFormat : std::uint8_t {
  kLorica,         ///< recordings/FORMAT.md
  kMsrAction3d,    ///< 20 rows a frame: x y z confidence
  kUtKinect,       ///< frame number and 20 x (x y z) on a row
  kKinect2Bodies,  ///< sec|kb,time,...: six bodies a row
  kKinect2Wide,    ///< a header of 232 names, a body a row
  kKinect1Long,    ///< Time(ms),JointType,X,Y,Z
  kKinect2Plain,   ///< 75 values a row, no header
  kUiPrmd,         ///< 22 x 3 relative positions [cm]; the file of angles beside it, if there, gives orientations
  kUpperBody,      ///< 18 values a row: shoulder, elbow, hand of both arms
  kNite2,          ///< time, user, then 15 x (x y z confidence [qx qy qz qw])
};
inline constexpr int kJointFormatCount = static_cast<int>(JointFormat::kNite2) + 1;

/// The word for `--format`: "lorica", "msr-action3d", "utkinect", "kinect2-bodies", ...
[[nodiscard]] std::string_view nameOf(JointFormat format);
[[nodiscard]] std::optional<JointFormat> jointFormatNamed(std::string_view name);

struct JointStreamSettings {
  std::optional<JointFormat> format = {};  ///< none = told by the content
  std::optional<int> person = {};          ///< of several in one stream; none = the one that moves most
};

/// What a file of joints holds of one person, in Lorica's units and axes.
struct JointStream {
  std::vector<SkeletonFrame> frames;  ///< at least one, times rising
  JointFormat format = JointFormat::kLorica;
  std::vector<int> people;         ///< the numbers of all in the file, ascending
  std::vector<std::string> notes;  ///< what was guessed, mended or left out: one sentence each
};

/// Reads recorded joints of any of the known layouts. Decimal commas, frames that repeat or go back, gaps, and times in
/// seconds, milliseconds or 100 ns are understood; joints that a sensor only inferred have confidence 0.5. The person
/// is set upon the floor y = 0 and, where the sensor looked at them, faces +Z.
/// @return the joints; or a sentence with file, line, found and expected
[[nodiscard]] Result<JointStream> readJointStream(const std::filesystem::path& file,
                                                  const JointStreamSettings& settings = {});

/// The same of text in memory. @param name  what the sentences call it
[[nodiscard]] Result<JointStream> parseJointStream(std::string_view text, std::string_view name,
                                                   const JointStreamSettings& settings = {});

}  // namespace lorica
