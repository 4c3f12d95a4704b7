#pragma once

#include "capture/files/joint_stream.h"

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Files of every layout, written from a known performance.
namespace lorica::test {

/// The 25 joints of Kinect v2 in its order, in the axes of a sensor 1.1 m above the floor and 3.2 m in front of the
/// origin that looks at it: x to the sensor's left, y up, z away from it [m].
using KinectBody = std::array<Vec3, 25>;
[[nodiscard]] KinectBody kinectBodyOf(const SkeletonFrame& frame);

/// Converts Lorica's point to the sensor's axes.
[[nodiscard]] Vec3 sensorFromWorld(const Vec3& position);

/// The joint names of Kinect v2, in their order.
[[nodiscard]] std::span<const std::string_view> kinect2Names();
/// The 20 joints of v1 in its order; its shoulder centre is the neck.
[[nodiscard]] std::vector<Vec3> kinect1BodyOf(const SkeletonFrame& frame);

/// MediaPipe's landmarks in its order.
inline constexpr std::array<std::string_view, 33> kLandmarks = {
    "nose",        "left_eye_inner",  "left_eye",        "left_eye_outer", "right_eye_inner",
    "right_eye",   "right_eye_outer", "left_ear",        "right_ear",      "mouth_left",
    "mouth_right", "left_shoulder",   "right_shoulder",  "left_elbow",     "right_elbow",
    "left_wrist",  "right_wrist",     "left_pinky",      "right_pinky",    "left_index",
    "right_index", "left_thumb",      "right_thumb",     "left_hip",       "right_hip",
    "left_knee",   "right_knee",      "left_ankle",      "right_ankle",    "left_heel",
    "right_heel",  "left_foot_index", "right_foot_index"};
/// One of them, from the middle of the hips, in a camera's axes: x to its right, y down, z away from it [m]. Those that
/// stand for no joint of a recording are where others are.
[[nodiscard]] Vec3 landmarkOf(const SkeletonFrame& frame, int landmark);

[[nodiscard]] std::string msrFile(std::span<const SkeletonFrame> frames);
/// @param numbers  one frame number per frame
[[nodiscard]] std::string utKinectFile(std::span<const SkeletonFrame> frames, std::span<const int> numbers);

/// Six body slots; an empty one is absent.
struct BodiesRow {
  std::int64_t ticks;  ///< [100 ns]
  std::array<const SkeletonFrame*, 6> bodies{};
  std::array<std::string_view, 6> ids = {"72057594037935056", "72057594037935057", "72057594037935058",
                                         "72057594037935059", "72057594037935060", "72057594037935061"};
  int stateOfHands = 2;  ///< 2 tracked, 1 inferred, 0 none
};
[[nodiscard]] std::string bodiesFile(std::span<const BodiesRow> rows);

struct WideSettings {
  bool decimalCommas = false;
  bool shuffled = false;  ///< the columns of each joint in another order, time and person at the end
  char delimiter = ',';
};
[[nodiscard]] std::string wideFile(std::span<const SkeletonFrame> frames, const WideSettings& settings = {});
/// @param leaveOut  omit every n-th row of a joint; 0 for none
[[nodiscard]] std::string longFile(std::span<const SkeletonFrame> frames, int leaveOut = 0, bool decimalCommas = false);
[[nodiscard]] std::string plainFile(std::span<const SkeletonFrame> frames, bool decimalCommas = false);
[[nodiscard]] std::string upperBodyFile(std::span<const SkeletonFrame> frames, bool leftFirst = true);
/// @param ticksPerSecond  1 for seconds
[[nodiscard]] std::string niteFile(std::span<const SkeletonFrame> frames, bool orientations, double ticksPerSecond);

/// One file of each layout except UI-PRMD, which has two files.
struct JointFile {
  JointFormat format;
  std::string text;
};
[[nodiscard]] std::vector<JointFile> oneOfEach(std::span<const SkeletonFrame> frames);

/// With CRLF, a byte order mark and blank lines.
[[nodiscard]] std::string inWindowsDress(const std::string& text);

}  // namespace lorica::test
