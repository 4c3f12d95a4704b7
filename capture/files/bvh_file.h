#pragma once

#include "geometry/result.h"
#include "skinning/clip.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// A motion read from a BVH file, converted to Lorica's units and axes: metres, Y up.
struct BvhFile {
  /// Joints keep the file's names and, if recognised, humanoid bones. End sites are not joints, unless a forearm or
  /// shin ends in one and has no hand or foot.
  SkeletalMotion motion;
  double metresPerUnit = 1.0;           ///< guessed from the skeleton's height
  std::string unit;                     ///< "centimetres", "metres", "inches", ...
  std::vector<std::string> firstGuess;  ///< the rest pose, the unit and the axes, and what they were taken from
  std::vector<std::string> notes;       ///< what was repaired, or is odd: one sentence each
};

/// The pose that the motion's rotations are understood from.
struct BvhRest {
  /// Guessed from the file, all rotations zero, a frame of this file, or of another one.
  enum class Kind : std::uint8_t { kFound, kZero, kFrame, kFile };
  Kind kind = Kind::kFound;    ///< which of the members below count
  int frame = 0;               ///< of this file, counted from 0
  std::filesystem::path file;  ///< a BVH file of the same joints: its first frame
};

/// Reads "zero", "frame:N" or the name of a BVH file; empty is kFound.
[[nodiscard]] Result<BvhRest> parseBvhRest(std::string_view text);

/// Reads a BVH file (Biovision hierarchy). Accepts any channel order, mixed orders, position channels on any joint,
/// several roots, a wrong frame count, a truncated last row, decimal commas and any line endings.
///
/// A joint's rotations apply in channel order, each about the axes rotated by the previous ones: channels Z, X, Y give
/// Rz * Rx * Ry.
///
/// BVH specifies neither rest pose, unit nor axes, so they are guessed:
/// - Rest pose: every rotation is zero, if the body then stands. Else the file stores bones along the axes of their
///   joints, and the rest pose is the straightest of the frames, see findRestPose().
/// - Unit: the skeleton's size is the longest side of the bounding box of its rest pose, including end sites. This is
///   the height of a standing person and the arm span of a person in T-pose. The unit (metres, decimetres, centimetres,
///   millimetres, inches, or the unit of the CMU database, 5.644 cm) is the one that makes this size nearest to 1.7 m
///   by ratio. If a rare unit (not metres, centimetres or millimetres) makes it less than 1.3 m or more than 2.2 m, the
///   file has a unit of its own, and 1.7 m are assumed. A note reports if no unit gives 0.5 to 2.5 m.
/// - Up: the file axis along which the head is above the feet in the mean over all frames; if that is unclear, in the
///   rest pose; Y if there is no head or foot. Files with another up axis are rotated so that Y is up.
/// - Positions of a root replace its offset, unless all of them are zero. Positions of other joints replace the offset
///   too, unless they are nearer to zero than to the offset: then they are added to it.
///
/// Memory use is at most proportional to the file size.
/// @return the motion; or an error with file, line, found and expected, or about the rest pose that was asked for
[[nodiscard]] Result<BvhFile> readBvh(const std::filesystem::path& file, const BvhRest& rest = {});

/// Reads BVH text in memory. @param name  name of the text in error messages
[[nodiscard]] Result<BvhFile> parseBvh(std::string_view text, std::string_view name, const BvhRest& rest = {});

/// Writes a BVH file, completely or not at all. Centimetres, Y up; channels Xposition Yposition Zposition Zrotation
/// Xrotation Yrotation on roots and on joints that translate relative to their parent, rotations only elsewhere. Frames
/// are sampled evenly at the motion's mean frame rate. Blanks and braces in names become '_', and names that repeat get
/// numbers: "Hand", "Hand_2". Scales of joints are contained in the positions. The file's joint axes are aligned with
/// the world at rest, as BVH requires, so the rotation values differ from the motion's; positions are the same.
/// @return an error if there is no frame, a number is not finite or the file cannot be written
[[nodiscard]] Result<void> writeBvh(const std::filesystem::path& file, const SkeletalMotion& motion);

}  // namespace lorica
