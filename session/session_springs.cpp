#include "session/session_springs.h"

#include "session/session_hashes.h"
#include "skinning/linear_blend.h"

#include <algorithm>
#include <array>
#include <utility>

namespace lorica {

namespace {

constexpr std::array<std::string_view, 3> kModeNames = {"none", "file", "body"};

}  // namespace

std::string_view nameOf(SpringMode mode) {
  return kModeNames[static_cast<std::size_t>(mode)];
}

std::optional<SpringMode> springModeNamed(std::string_view name) {
  const auto found = std::find(kModeNames.begin(), kModeNames.end(), name);
  if (found == kModeNames.end()) return std::nullopt;
  return static_cast<SpringMode>(found - kModeNames.begin());
}

SpringMode usualSpringMode(const SpringBones& springs) {
  return springs.colliders.empty() ? SpringMode::kBody : SpringMode::kFile;
}

Result<SessionSprings> SessionSprings::create(const Character& character, SpringBones springs, SpringMode mode,
                                              const LiveBody& body) {
  const std::uint64_t hash = hashOf(springs);
  if (mode == SpringMode::kNone) springs.chains.clear();
  if (mode == SpringMode::kBody) {
    for (SpringChain& chain : springs.chains) chain.colliderGroups.clear();
  }
  LORICA_TRY(SpringSimulation simulation, SpringSimulation::create(character.skeleton, std::move(springs)));
  SessionSprings made(std::move(simulation), mode, hash);
  made.pose_ = restPose(character.skeleton);
  made.worldFromModel_.resize(made.pose_.size());
  made.setBody(character, body);
  return made;
}

SessionSprings::SessionSprings(SpringSimulation simulation, SpringMode mode, std::uint64_t hash)
    : simulation_(std::move(simulation)), mode_(mode), hash_(hash) {}

void SessionSprings::setBody(const Character& character, const LiveBody& body) {
  if (mode_ == SpringMode::kBody) obstacles_.emplace(body, character, simulation_);
}

std::span<const JointTransform> SessionSprings::advance(const Character& character,
                                                        std::span<const JointTransform> pose, double seconds,
                                                        std::span<const Affine3> last, std::span<const LivePart> parts,
                                                        std::span<const Prop> props) {
  std::copy(pose.begin(), pose.end(), pose_.begin());
  const bool collides = obstacles_ && !last.empty();
  if (collides) {
    computeWorldFromJoint(character.skeleton, pose, worldFromModel_);
    computeWorldFromModel(character, worldFromModel_, worldFromModel_);
    obstacles_->prepare(parts, last, worldFromModel_, props, seconds);
  }
  simulation_.advance(pose_, seconds, collides ? &*obstacles_ : nullptr);
  return pose_;
}

}  // namespace lorica
