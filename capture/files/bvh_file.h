#pragma once

#include "geometry/result.h"
#include "skinning/clip.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// A motion read from a BVH file, in Lorica's units and axes: metres, Y up.
struct BvhFile {
  /// Joints carry the file's names and, where found, humanoid bones. End sites are no joints, but where a forearm or
  /// shin ends in one and has no hand or foot.
  SkeletalMotion motion;
  double metresPerUnit = 1.0;      ///< guessed from the skeleton's height
  std::string unit;                ///< "centimetres", "metres", "inches", ...
  std::vector<std::string> notes;  ///< what was guessed or mended: one sentence each
};

/// Reads a BVH file (Biovision hierarchy): any order of channels, mixed orders, position channels on any joint, several
/// roots, a frame count that is wrong, a last row cut short, decimal commas, any ends of lines.
///
/// The rest pose has every rotation at zero. A joint's rotations apply in the order of its channels, each about the
/// axes that the ones before it turned: channels Z, X, Y make Rz * Rx * Ry.
///
/// BVH says neither unit nor axes, so they are guessed:
/// - Unit: the skeleton's size is the longest side of the box around its rest pose, end sites included, which is the
///   height of one who stands and the span of one in T-pose. Of metres, decimetres, centimetres, millimetres, inches
///   and the units of the CMU database (5.644 cm), the one is taken that makes this size nearest to 1.7 m by ratio.
///   A note says so where no unit makes it 0.5 to 2.5 m.
/// - Up: the axis of the file along which the head is above the feet, in the mean of the frames; where that is not
///   clear, in the rest pose; Y where there is no head or foot. Other files are turned so that Y is up.
/// - Positions of a root replace its offset, unless all of them are zero. Those of other joints replace it too, unless
///   they are nearer to zero than to the offsets: then they add to it.
///
/// Memory is at most in proportion to the file.
/// @return the motion, or a sentence with file, line, found and expected
[[nodiscard]] Result<BvhFile> readBvh(const std::filesystem::path& file);

/// The same of text in memory. @param name  what the sentences call it
[[nodiscard]] Result<BvhFile> parseBvh(std::string_view text, std::string_view name);

/// Writes a motion, whole or not at all: centimetres, Y up, channels Xposition Yposition Zposition Zrotation Xrotation
/// Yrotation on roots and on joints that move in their parent, rotations elsewhere. Frames are taken evenly, as many a
/// second as the motion has in the mean. Blanks and braces in names become '_'. Joints of the file have the axes of the
/// world at rest, as BVH demands, so rotations are other numbers there; places are the same.
[[nodiscard]] Result<void> writeBvh(const std::filesystem::path& file, const SkeletalMotion& motion);

}  // namespace lorica
