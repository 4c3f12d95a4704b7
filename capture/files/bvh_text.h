#pragma once

#include "geometry/math.h"
#include "geometry/result.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// What a column of the motion moves.
enum class BvhChannel : std::uint8_t { kXPosition, kYPosition, kZPosition, kXRotation, kYRotation, kZRotation };

/// A ROOT or JOINT as the file has it: in its own unit, axes and degrees.
struct BvhJoint {
  std::string name;
  int parent = -1;
  Vec3 offset = Vec3::Zero();
  std::vector<BvhChannel> channels;  ///< in the file's order
  std::size_t firstChannel = 0;      ///< column of the first one
};

/// The words and numbers of a BVH file, nothing guessed but what its writer must have meant.
/// Internal to the BVH reader.
struct BvhText {
  std::vector<BvhJoint> joints;                ///< parents first
  std::vector<std::pair<int, Vec3>> endSites;  ///< parent, offset
  std::size_t channelCount = 0;
  std::size_t frameCount = 0;  ///< as found, at least one
  double frameSeconds = 0.0;
  std::vector<double> values;  ///< frameCount x channelCount
  std::vector<std::string> notes;
};

/// Takes memory in proportion to the text: numbers that the header promises allocate nothing, and there are at most as
/// many joints times frames as the text has bytes.
/// @param name  what the sentences call the text
[[nodiscard]] Result<BvhText> parseBvhText(std::string_view text, std::string_view name);

}  // namespace lorica
