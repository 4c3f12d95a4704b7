#pragma once

#include "capture/skeleton_frame.h"
#include "capture/virtual_sensor/virtual_clothes.h"
#include "capture/virtual_sensor/virtual_sensor.h"
#include "geometry/result.h"

#include <array>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace lorica::bench {

using Joints = std::array<Vec3, kBodyJointCount>;

/// A joint that somebody marked on the depth image.
struct MarkedJoint {
  BodyJoint joint{};
  Eigen::Vector2d fromMiddle;  ///< of the image [px]
  double depth = 0.0;          ///< measured there [m]; 0 = not
};

/// A depth recording of real people and what is true in it.
struct RealRecording {
  std::string name, kind;
  std::filesystem::path file;
  int firstFrame = 0;  ///< with a person
  int peopleVisible = 1;
  double frameSeconds = 1.0 / 30.0;
  double gap = 1.0;  ///< from the person's back to what is behind [m]
  Isometry3 floorFromCamera = Isometry3::Identity();
  std::vector<std::map<int, Joints>> people;  ///< by frame, camera frame
  /// Of some frames, those of each person who is marked.
  std::map<int, std::vector<std::vector<MarkedJoint>>> marks;
};

/// Reads what belongs to NAME.oni in a folder, but not its frames: NAME.json, NAME.joints.csv, NAME.joints2.csv,
/// and its rows of marks.csv.
/// @param names  only recordings whose name starts with one of these; empty = all
/// @return in the order of their names, at least one, or an error with the file that could not be read
[[nodiscard]] Result<std::vector<RealRecording>> readRealRecordings(const std::filesystem::path& folder,
                                                                    const std::vector<std::string>& names);

/// How the tracker's joints differ from the recorded ones by definition, floor frame.
[[nodiscard]] Result<Joints> readOffsets(const std::filesystem::path& file);

/// A rendered copy of a recording: bodies of the recorded people's sizes, 10 % wider than the tracker's model, repeat
/// their joints at the same places before the same camera. Behind them is a bare wall where the real room has
/// something, or nothing if they are cut out.
struct RenderedTwin {
  VirtualSensor sensor;
  RealRecording truth;  ///< joints of the rendered people; no file
  /// The recorded joints that they repeat, each person moved to the centre of the rendered one.
  std::vector<std::map<int, Joints>> repeated;
  /// How far the two are apart, which no body with bones of constant length can avoid [m].
  std::vector<double> apart;
  int frames = 0, limbApartFrames = 0;  ///< sum over the people; in which a limb joint is more than 0.15 m apart
};

/// @param offsets  see readOffsets()
/// @param camera   of the recording
/// @param noise    of any resolution
/// @return the twin, or an error if the recording has no joints
[[nodiscard]] Result<RenderedTwin> renderedTwin(const RealRecording& recording, const Joints& offsets,
                                                const DepthCamera& camera, const DepthNoiseSettings& noise,
                                                std::span<const Clothes> clothes);

}  // namespace lorica::bench
