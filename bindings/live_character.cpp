#include "bindings/live_character.h"

#include "skinning/linear_blend.h"

#include <algorithm>
#include <utility>

namespace lorica {

LiveCharacter::LiveCharacter(std::shared_ptr<const CharacterBody> body)
    : body_(std::move(body)),
      live_(body_->plan),
      worldFromJoint_(static_cast<std::size_t>(body_->character().skeleton.jointCount()), Affine3::Identity()),
      worldFromModel_(worldFromJoint_.size(), Affine3::Identity()),
      hulls_(live_.parts().size()) {
  for (std::size_t p = 0; p < hulls_.size(); ++p) {
    const std::size_t most = live_.candidateCount(static_cast<PartIndex>(p));
    hulls_[p].vertices.reserve(most);
    hulls_[p].pointOfVertex.reserve(most);
    hulls_[p].triangles.reserve(2 * most);
  }
}

void LiveCharacter::pose(std::span<const JointTransform> pose) {
  computeWorldFromJoint(body_->character().skeleton, pose, worldFromJoint_);
  move();
}

void LiveCharacter::place(std::span<const Affine3> worldFromJoint) {
  std::ranges::copy(worldFromJoint, worldFromJoint_.begin());
  move();
}

void LiveCharacter::move() {
  computeWorldFromModel(body_->character(), worldFromJoint_, worldFromModel_);
  live_.update(worldFromModel_);
  for (std::size_t p = 0; p < hulls_.size(); ++p) worldHull(live_.parts()[p], hulls_[p]);
  posed_ = true;
}

std::span<const SelfContact> LiveCharacter::selfContacts() {
  if (!posed_) return {};
  if (!contacts_) contacts_.emplace(live_, body_->character().mesh.vertices);
  return contacts_->find(live_.parts());
}

}  // namespace lorica
