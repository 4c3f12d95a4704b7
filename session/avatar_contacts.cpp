#include "session/avatar_contacts.h"

#include "session/part_masses.h"

#include <algorithm>

namespace lorica {

std::span<const BodyContact> AvatarContacts::find(std::span<const SessionAvatar> avatars, double seconds) {
  weigh(avatars);
  bodies_.clear();
  for (std::size_t a = 0; a < avatars.size(); ++a) {
    const std::span<const LivePart> parts = avatars[a].partsInWorld();
    bodies_.push_back({parts, std::span(*masses_[a].values).first(parts.size())});
  }
  return query_.find(bodies_, seconds);
}

/// Computes the masses of avatars that are new or have a new body.
void AvatarContacts::weigh(std::span<const SessionAvatar> avatars) {
  masses_.resize(avatars.size());
  for (std::size_t a = 0; a < avatars.size(); ++a) {
    const std::shared_ptr<const BodyPlan>& plan = avatars[a].body().plan();
    if (masses_[a].plan == plan) continue;
    const auto known = std::find_if(masses_.begin(), masses_.end(), [&](const Masses& m) { return m.plan == plan; });
    if (known != masses_.end()) {
      masses_[a] = *known;
    } else {
      masses_[a] = {
          plan, std::make_shared<const std::vector<double>>(partMasses(plan->decomposition(), avatars[a].character()))};
    }
  }
}

}  // namespace lorica
