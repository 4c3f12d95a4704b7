#include "skinning/body/limbs.h"

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

// Relative to the largest side of the character's box, which is a human's height or arm span.
constexpr double kDownBoth = 0.15;  // from where two limbs branch: thighs half way to the knees, not the crotch
constexpr double kDownOne = 0.2;    // from the bone that carries a limb: the elbow at the chest, not the armpit

constexpr float kApart = -1.0f;  // of joints that do not meet

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

  down_.assign(count * count, kApart);
  onOneBranch_.assign(count * count, 0);
  const auto bone = [&](JointIndex joint, JointIndex parent) {
    return static_cast<float>((positionOf(joint) - positionOf(parent)).norm());
  };
  std::vector<float> below(count);  // of the joints below one, how far down they are
  for (std::size_t j = 0; j < count; ++j) {
    const JointIndex own = j;
    const JointIndex parent = character.skeleton.joint(own).parent;
    onOneBranch_[pair(own, own)] = 1;
    down_[pair(own, own)] = 0.0f;
    if (parent == kNoJoint) continue;
    below[parent] = 0.0f;
    for (std::size_t k = 0; k < j; ++k) {
      // Parents precede children: the parent's entries are complete.
      const JointIndex other = k;
      const bool above = onOneBranch_[pair(parent, other)] != 0 && other <= parent;
      onOneBranch_[pair(own, other)] = onOneBranch_[pair(other, own)] = above ? 1 : 0;
      float& toOwn = down_[pair(other, own)];
      float& toOther = down_[pair(own, other)];
      if (other == parent) {
        toOwn = 0.0f;
        toOther = bone(own, parent);
      } else if (other > parent && onOneBranch(parent, other)) {
        const JointIndex up = character.skeleton.joint(other).parent;
        below[other] = below[up] + bone(other, up);
        toOwn = bone(own, parent);
        toOther = below[other];
      } else if (const float toParent = down_[pair(other, parent)]; toParent != kApart) {
        toOwn = toParent + bone(own, parent);
        toOther = down_[pair(parent, other)];
      }
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
  const auto down = [&](JointIndex from, JointIndex joint) {
    return std::max(0.0, double{down_[pair(from, joint)]}) + along(joint, at);
  };
  if (onOneBranch(a, b)) return down(std::min(a, b), std::max(a, b)) > kDownOne * size_;
  return std::min(down(b, a), down(a, b)) > kDownBoth * size_;
}

JointIndex strongest(std::span<const Influence> influences) {
  const Influence* best = nullptr;
  for (const Influence& i : influences) {
    if (best == nullptr || i.weight > best->weight) best = &i;
  }
  return best == nullptr ? 0 : best->joint;
}

}  // namespace lorica
