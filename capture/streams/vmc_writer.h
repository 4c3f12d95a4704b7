#pragma once

#include "capture/retarget/bone_pose.h"
#include "capture/streams/osc.h"
#include "geometry/math.h"

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

/// A contact of an avatar, as it is sent.
struct SentContact {
  std::string_view phase;     ///< begin, stay or end
  std::string_view bone;      ///< humanoid bone that touches, as VMC names it
  std::string_view other;     ///< the other bone; empty if it touches a prop
  int prop = 0;               ///< index of the prop if `other` is empty
  Vec3 point = Vec3::Zero();  ///< world, in our axes [m]
  double strength = 0.0;      ///< [N s]
};

/// Writes contacts as messages that the VMC protocol lets through (/VMC/Thru, https://protocol.vmc.info): a text and a
/// number. "/VMC/Thru/lorica/contact/begin" has the text "RightHand prop:2 0.210 1.340 0.520" (what touches, what is
/// touched, and where, in Unity's axes [m]) and the strength. Allocates nothing.
class ContactWriter {
 public:
  /// @return the packet, valid until the next call
  [[nodiscard]] std::span<const std::byte> write(const SentContact& contact);

 private:
  std::array<std::byte, 256> memory_{};
};

}  // namespace lorica
