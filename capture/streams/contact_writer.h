#pragma once

#include "geometry/math.h"

#include <array>
#include <cstddef>
#include <span>
#include <string_view>

namespace lorica {

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
