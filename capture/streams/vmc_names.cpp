#include "capture/streams/vmc_names.h"

#include "geometry/counts.h"

#include <array>

namespace lorica {
namespace {

/// Unity and VRM 0.x call the three bones of a thumb proximal, intermediate and distal; VRM 1.0 metacarpal, proximal
/// and distal.
constexpr std::string_view kThumb = "Thumb";

using Names = std::array<std::string, kHumanBoneCount>;

Names unityNames() {
  Names names;
  for (std::size_t b = 0; b < names.size(); ++b) {
    std::string name(nameOf(static_cast<HumanBone>(b)));
    name.front() = name.front() - 'a' + 'A';
    const std::size_t thumb = name.find(kThumb);
    if (thumb != std::string::npos) {
      const std::string part = name.substr(thumb + kThumb.size());
      name.resize(thumb + kThumb.size());
      name += part == "Metacarpal" ? "Proximal" : part == "Proximal" ? "Intermediate" : "Distal";
    }
    names[b] = std::move(name);
  }
  return names;
}

const Names& names() {
  static const Names table = unityNames();
  return table;
}

/// Whether they differ in nothing but the case of their first letter.
bool sameButFirstCase(std::string_view unity, std::string_view vrm) {
  return unity.size() == vrm.size() && unity.substr(1) == vrm.substr(1) && unity.front() - 'A' + 'a' == vrm.front();
}

}  // namespace

std::string_view vmcNameOf(HumanBone bone) {
  return names()[ordinalOf(bone)];
}

std::optional<HumanBone> vmcBoneNamed(std::string_view name) {
  if (name.empty()) return std::nullopt;
  // With a small letter, "leftThumbProximal" is VRM 1.0's.
  if (const std::optional<HumanBone> bone = humanBoneNamed(name)) return bone;
  for (std::size_t b = 0; b < names().size(); ++b) {
    if (names()[b] == name || sameButFirstCase(names()[b], name)) return static_cast<HumanBone>(b);
  }
  return std::nullopt;
}

}  // namespace lorica
