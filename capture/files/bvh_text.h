#pragma once

#include "geometry/math.h"
#include "geometry/result.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// The motion component that a column controls.
enum class BvhChannel : std::uint8_t { kXPosition, kYPosition, kZPosition, kXRotation, kYRotation, kZRotation };

/// A ROOT or JOINT as stored in the file: in its own unit and axes, angles in degrees.
struct BvhJoint {
  std::string name;
  int parent = -1;
  Vec3 offset = Vec3::Zero();
  std::vector<BvhChannel> channels;  ///< in the file's order
  std::size_t firstChannel = 0;      ///< column of the first one
};

/// The parsed content of a BVH file. Nothing is guessed except obvious errors of the writer. Internal to the BVH
/// reader.
struct BvhText {
  std::vector<BvhJoint> joints;                ///< parents first
  std::vector<std::pair<int, Vec3>> endSites;  ///< parent, offset
  std::size_t channelCount = 0;
  std::size_t frameCount = 0;  ///< as found, at least one
  double frameSeconds = 0.0;
  std::vector<double> values;  ///< frameCount x channelCount
  std::vector<std::string> notes;
};

/// Memory use is proportional to the text size: counts in the header allocate nothing, and joints times frames is at
/// most the number of bytes in the text.
/// @param name  name of the text in error messages
[[nodiscard]] Result<BvhText> parseBvhText(std::string_view text, std::string_view name);

}  // namespace lorica
