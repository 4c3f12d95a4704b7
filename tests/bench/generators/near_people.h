#pragma once

#include "capture/skeleton_frame.h"
#include "capture/virtual_sensor/virtual_sensor.h"

#include <span>
#include <string>
#include <string_view>

namespace lorica {

/// What somebody before a screen does.
enum class NearMotion { kTurning, kWaving, kLeaning, kHandsAtFace };

/// Somebody near a camera that shows them from the waist up.
struct NearScene {
  std::string_view name;
  NearMotion motion = NearMotion::kWaving;
  double distance = 0.8;              ///< from the camera to the trunk's axis, level [m]
  bool portrait = false;              ///< 9:16 instead of 16:9
  bool seated = true;                 ///< on a chair
  double tiltDown = 0.0;              ///< of the camera, which has the head at the same place in the image [rad]
  std::string_view noise = "kinect";  ///< one of kCameraNames
  double height = 1.0, girth = 1.0;   ///< times the mannequin's
};

/// Four motions at 0.6 m upright, 0.8 m and 1.2 m wide; bodies, cameras and seats differ.
[[nodiscard]] std::span<const NearScene> nearScenes();
inline constexpr int kNearFrames = 150;  ///< of each scene

/// The scene's camera before its person; 30 frames a second.
[[nodiscard]] VirtualSensor nearSensor(const NearScene& scene, std::uint64_t seed);

/// How well somebody near the camera is followed.
struct NearFigures {
  int frames = 0, first = -1;  ///< shown; the first in which they are followed
  int followed = 0;            ///< frames with a head within 0.25 m of theirs
  int others = 0;              ///< frames with somebody who is not there
  int headingOff = 0;          ///< followed with shoulders that point more than 45 degrees elsewhere
  int sure = 0, sureOff = 0;   ///< joints of confidence 0.5 or more; those more than 0.15 m off
  int legsKnown = 0;           ///< joints from the hips down with a confidence above 0
  double trunkMm = 0.0;        ///< mean error of head, neck and shoulders while followed [mm]

  /// @param tracked  everyone found in the frame, camera frame
  void add(const VirtualTruth& truth, std::span<const SkeletonFrame> tracked);
};

}  // namespace lorica
