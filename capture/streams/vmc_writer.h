#pragma once

#include "capture/retarget/bone_pose.h"
#include "capture/streams/osc.h"

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace lorica {

/// The largest packet that UDP over IPv4 can carry [bytes].
inline constexpr std::size_t kLargestPacket = 65507;

/// An expression as it is sent.
struct VmcWeight {
  std::string_view name;
  float weight = 0.0f;
};

/// Which bones are sent; all at first.
using VmcBones = std::array<bool, kHumanBoneCount>;
[[nodiscard]] VmcBones allVmcBones();

/// Writes poses as packets of the VMC protocol (https://protocol.vmc.info, version 3.1): one bundle a frame with state,
/// time, root, bones with their own offsets, and expressions. Allocates nothing after construction.
class VmcWriter {
 public:
  explicit VmcWriter(const VmcBones& bones = allVmcBones());

  /// @param pose      in our axes
  /// @param seconds   since the sender began
  /// @param tracking  whether the pose is certain
  /// @return the packet, valid until the next call; empty if it would be larger than kLargestPacket
  [[nodiscard]] std::span<const std::byte> write(const BonePose& pose, std::span<const VmcWeight> expressions,
                                                 double seconds, bool tracking);

 private:
  VmcBones bones_;
  std::vector<std::byte> memory_;
};

}  // namespace lorica
