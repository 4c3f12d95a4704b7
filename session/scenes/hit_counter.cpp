#include "session/scenes/hit_counter.h"

#include "session/session.h"

#include <algorithm>
#include <utility>

namespace lorica {
namespace {

constexpr int kNoTarget = -1;

}  // namespace

HitLimb limbOf(const Skeleton& skeleton, JointIndex joint) {
  for (; joint != kNoJoint; joint = skeleton.joint(joint).parent) {
    const std::optional<HumanBone> bone = skeleton.joint(joint).bone;
    if (bone == HumanBone::kLeftHand) return HitLimb::kLeftHand;
    if (bone == HumanBone::kRightHand) return HitLimb::kRightHand;
    if (bone == HumanBone::kLeftFoot) return HitLimb::kLeftFoot;
    if (bone == HumanBone::kRightFoot) return HitLimb::kRightFoot;
  }
  return HitLimb::kRest;
}

HitCounter::HitCounter(std::vector<HitTarget> targets) : targets_(std::move(targets)), hits_(targets_.size(), Hits{}) {
  for (std::size_t target = 0; target < targets_.size(); ++target) {
    for (const int prop : targets_[target].props) {
      const std::size_t p = prop;
      if (targetOfProp_.size() <= p) targetOfProp_.resize(p + 1, kNoTarget);
      targetOfProp_[p] = target;
    }
  }
}

void HitCounter::add(std::span<const ContactEvent> events, const Session& session) {
  for (const ContactEvent& event : events) {
    if (event.phase != ContactPhase::kEnd) continue;
    std::erase_if(open_, [&](const Open& open) { return open.pair == event.touch.pair; });
  }
  for (const ContactEvent& event : events) {
    if (event.phase == ContactPhase::kBegin) begin(event.touch, session);
  }
}

void HitCounter::begin(const Touch& touch, const Session& session) {
  const std::size_t prop = touch.pair.other;
  if (touch.pair.kind != TouchKind::kProp || prop >= targetOfProp_.size()) return;
  if (targetOfProp_[prop] == kNoTarget) return;
  const Open opened{touch.pair, static_cast<std::size_t>(targetOfProp_[prop]),
                    limbOf(session.avatar(touch.pair.avatar).character().skeleton, touch.bone)};
  const bool goesOn = std::any_of(open_.begin(), open_.end(), [&](const Open& open) {
    return open.pair.avatar == opened.pair.avatar && open.target == opened.target && open.limb == opened.limb;
  });
  if (!goesOn) ++hits_[opened.target][static_cast<std::size_t>(opened.limb)];
  open_.push_back(opened);
}

}  // namespace lorica
