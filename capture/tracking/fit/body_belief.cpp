#include "capture/tracking/fit/body_belief.h"

#include <algorithm>

namespace lorica::fit {
namespace {

constexpr float kMinSeen = 0.3F;      // share of a capsule that counts as seen
constexpr float kMaxHeight = 2.15F;   // of a person [m]
constexpr int kEnough = 3;            // views in favour until a person is believed
constexpr int kFull = 24;             // limit of the trust: so many views against a person end it
constexpr float kCertainCost = 1100;  // one view with this cost is enough
constexpr int kCertainSeen = 16;

/// The largest cost, and the number of capsules that must be seen, for a view to be in favour.
struct Limits {
  float cost;
  int seen;
};
constexpr Limits kStill = {1220.0F, 15};
constexpr Limits kMoved = {1800.0F, 9};
constexpr Limits kMovedAttached = {2300.0F, 15};
constexpr Limits kPart = {1800.0F, 6};
constexpr float kAgainst = 1.15F;  // multiple of that cost from which a view is against a person believed before

int seenOf(const CapsuleSupport& support) {
  return std::ranges::count_if(support.seen, [](float share) { return share > kMinSeen; });
}

}  // namespace

void BodyBelief::update(const Evidence& evidence) {
  const Limits& limits = evidence.part ? kPart : !evidence.moved ? kStill : evidence.attached ? kMovedAttached : kMoved;
  // How far limbs are from rest says nothing: people sit, chairs stand.
  const float cost = evidence.cost.image() + evidence.cost.body;
  const int seen = seenOf(evidence.support);
  const bool possible = evidence.height < kMaxHeight;
  if (believed_) {
    const bool against = !possible || cost > kAgainst * limits.cost;
    trust_ = std::min(kFull, trust_ + (against ? -1 : 1));
    believed_ = trust_ > 0;
    return;
  }
  const bool inFavour = possible && cost < limits.cost && seen >= limits.seen;
  trust_ = inFavour ? trust_ + 1 : 0;
  believed_ = trust_ >= kEnough || (inFavour && cost < kCertainCost && seen >= kCertainSeen);
  if (believed_) trust_ = kFull;
}

}  // namespace lorica::fit
