#pragma once

#include "session/contact_events.h"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lorica {

/// Props whose hits are counted together.
struct HitTarget {
  std::string name;
  std::vector<int> props;  ///< indices of the world
};

/// What of an avatar hits.
enum class HitLimb : std::uint8_t { kLeftHand, kRightHand, kLeftFoot, kRightFoot, kRest };
inline constexpr std::size_t kHittingLimbs = 5;

/// The limb of a joint: fingers are of the hand, toes of the foot, and so are all other joints below them.
[[nodiscard]] HitLimb limbOf(const Skeleton& skeleton, JointIndex joint);

/// Counts how often the limbs of a session's avatars hit targets.
///
/// A hit is the begin of a contact (see ContactEvents) of a limb with a target, unless another contact of this limb of
/// this avatar with this target lasts: a fist of two parts hits once. The bone where the contact began says which
/// limb it is.
class HitCounter {
 public:
  /// Hits of each limb, in the order of HitLimb.
  using Hits = std::array<int, kHittingLimbs>;

  explicit HitCounter(std::vector<HitTarget> targets);

  [[nodiscard]] std::span<const HitTarget> targets() const { return targets_; }
  [[nodiscard]] const Hits& hitsOf(std::size_t target) const { return hits_[target]; }

  /// Adds the events of a frame, all of it at once.
  void add(std::span<const ContactEvent> events, const Session& session);

 private:
  struct Open {
    TouchPair pair;
    std::size_t target = 0;
    HitLimb limb = HitLimb::kRest;
  };
  void begin(const Touch& touch, const Session& session);

  std::vector<HitTarget> targets_;
  std::vector<Hits> hits_;         // of each target
  std::vector<int> targetOfProp_;  // -1 = none
  std::vector<Open> open_;         // contacts with targets that last
};

}  // namespace lorica
