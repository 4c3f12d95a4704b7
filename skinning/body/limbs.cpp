#include "skinning/body/limbs.h"

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

// Relative to the largest side of the character's box, which is a human's height or arm span.
constexpr double kDownBoth = 0.15;  // from where two limbs branch: thighs half way to the knees, not the crotch
constexpr double kDownOne = 0.2;    // from the bone that carries a limb: the elbow at the chest, not the armpit

}  // namespace

Limbs::Limbs(const Character& character) {
  const std::size_t count = character.skeleton.jointCount();
  at_.reserve(count);
  for (const Affine3& m : character.jointFromModel) {
    // A joint with a singular bind matrix moves nothing in a valid file, so its position does not matter.
    const bool sound = std::abs(m.linear().determinant()) > 1e-12;
    const Vec3 at = sound ? Vec3(m.inverse().translation()) : Vec3::Zero();
    at_.push_back(at.allFinite() ? at : Vec3::Zero());
  }
  const Aabb box = surfaceBounds(character.mesh);
  size_ = (box.max - box.min).maxCoeff();

  direction_.assign(count, Vec3::Zero());
  for (std::size_t j = 0; j < count; ++j) {
    const JointIndex parent = character.skeleton.joint(j).parent;
    if (parent != kNoJoint) direction_[parent] += at_[j] - positionOf(parent);
  }
  for (std::size_t j = 0; j < count; ++j) {
    const JointIndex parent = character.skeleton.joint(j).parent;
    if (direction_[j].isZero() && parent != kNoJoint) direction_[j] = at_[j] - positionOf(parent);
    direction_[j].stableNormalize();
  }

  way_.assign(count * count, 0.0f);
  meeting_.assign(count * count, kNoJoint);
  onOneBranch_.assign(count * count, 0);
  for (std::size_t j = 0; j < count; ++j) {
    const JointIndex own = j;
    const JointIndex parent = character.skeleton.joint(own).parent;
    onOneBranch_[pair(own, own)] = 1;
    if (parent == kNoJoint) continue;
    for (std::size_t k = 0; k < j; ++k) {
      // Parents precede children: the parent's entries are complete.
      const JointIndex other = k;
      const bool above = onOneBranch_[pair(parent, other)] != 0 && other <= parent;
      onOneBranch_[pair(own, other)] = onOneBranch_[pair(other, own)] = above ? 1 : 0;
      way_[pair(own, other)] = way_[pair(other, own)] =
          way_[pair(parent, other)] + static_cast<float>((positionOf(own) - positionOf(parent)).norm());
      JointIndex meeting = own;
      if (other != parent)
        meeting = other > parent && onOneBranch(parent, other) ? parent : meeting_[pair(parent, other)];
      meeting_[pair(own, other)] = meeting_[pair(other, own)] = meeting;
    }
  }
}

bool Limbs::onOneBranch(JointIndex a, JointIndex b) const {
  return onOneBranch_[pair(a, b)] != 0;
}

double Limbs::along(JointIndex joint, const Vec3& at) const {
  return std::max(0.0, (at - positionOf(joint)).dot(direction_[joint]));
}

bool Limbs::apart(JointIndex a, JointIndex b, const Vec3& at) const {
  if (a == b) return false;
  const JointIndex meeting = meeting_[pair(a, b)];
  const auto down = [&](JointIndex joint) {
    const double way = meeting == kNoJoint ? 0.0 : way_[pair(meeting, joint)];
    return way + along(joint, at);
  };
  if (onOneBranch(a, b)) return down(std::max(a, b)) > kDownOne * size_;
  return std::min(down(a), down(b)) > kDownBoth * size_;
}

JointIndex strongest(std::span<const Influence> influences) {
  const Influence* best = nullptr;
  for (const Influence& i : influences) {
    if (best == nullptr || i.weight > best->weight) best = &i;
  }
  return best == nullptr ? 0 : best->joint;
}

}  // namespace lorica
