#include "body/limbs.h"

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

// In the largest side of the character's box, which a human's height or span of arms is.
constexpr double kFarAlong =
    0.2;  // joints that far from each other never share a place: forearm and belly, hand and thigh
constexpr double kFarRound = 0.3;  // from the place up one branch and down another: the calves, not the crotch

}  // namespace

Limbs::Limbs(const Character& character) {
  const auto count = static_cast<std::size_t>(character.skeleton.jointCount());
  at_.reserve(count);
  for (const Affine3& m : character.jointFromModel) {
    // A joint without a bind matrix that can be undone moves nothing in a sound file: any place will do.
    const bool sound = std::abs(m.linear().determinant()) > 1e-12;
    const Vec3 at = sound ? Vec3(m.inverse().translation()) : Vec3::Zero();
    at_.push_back(at.allFinite() ? at : Vec3::Zero());
  }
  const Aabb box = surfaceBounds(character.mesh);
  size_ = (box.max - box.min).maxCoeff();

  way_.assign(count * count, 0.0f);
  onOneBranch_.assign(count * count, 0);
  for (std::size_t j = 0; j < count; ++j) {
    onOneBranch_[j * count + j] = 1;
    const JointIndex parent = character.skeleton.joint(static_cast<JointIndex>(j)).parent;
    for (std::size_t k = 0; k < j; ++k) {
      // Parents precede children: the way to k is known from the parent.
      float way = 0.0f;
      bool one = false;
      if (parent != kNoJoint) {
        const auto up = static_cast<std::size_t>(parent);
        way = way_[up * count + k] + static_cast<float>((at_[j] - at_[up]).norm());
        // On the branch above j, and not beside it: k does not hang on the parent, the parent hangs on k.
        one = k == up || (k < up && onOneBranch_[up * count + k] != 0);
      } else {
        way = static_cast<float>((at_[j] - at_[k]).norm());
      }
      way_[j * count + k] = way_[k * count + j] = way;
      onOneBranch_[j * count + k] = onOneBranch_[k * count + j] = one ? 1 : 0;
    }
  }
}

bool Limbs::onOneBranch(JointIndex a, JointIndex b) const {
  return onOneBranch_[pair(a, b)] != 0;
}

bool Limbs::apart(JointIndex a, JointIndex b, const Vec3& at) const {
  if (a == b) return false;
  const auto way = static_cast<double>(way_[pair(a, b)]);
  if (way > kFarAlong * size_) return true;
  if (onOneBranch(a, b)) return false;
  return way + (at - positionOf(a)).norm() + (at - positionOf(b)).norm() > kFarRound * size_;
}

JointIndex strongest(std::span<const Influence> influences) {
  const Influence* best = nullptr;
  for (const Influence& i : influences) {
    if (best == nullptr || i.weight > best->weight) best = &i;
  }
  return best == nullptr ? 0 : best->joint;
}

}  // namespace lorica
