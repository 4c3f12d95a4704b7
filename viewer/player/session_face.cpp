#include "viewer/player/session_face.h"

#include "geometry/counts.h"
#include "skinning/look/expressed_materials.h"

#include <algorithm>
#include <utility>

namespace lorica {

void ExpressionFollower::apply(std::span<const NamedWeight> sent, const Expressions& expressions,
                               std::span<const float> given, Face& face) {
  const bool same = std::equal(sent.begin(), sent.end(), known_.begin(), known_.end(),
                               [](const NamedWeight& a, const Known& b) { return a.name == b.name; });
  if (!same) learn(sent, expressions, given, face);
  for (std::size_t i = 0; i < sent.size(); ++i) {
    if (known_[i].expression) face.set(*known_[i].expression, sent[i].weight);
  }
}

void ExpressionFollower::learn(std::span<const NamedWeight> sent, const Expressions& expressions,
                               std::span<const float> given, Face& face) {
  for (const Known& known : known_) {
    if (!known.expression) continue;
    face.set(*known.expression, *known.expression < given.size() ? given[*known.expression] : 0.0f);
  }
  known_.clear();
  bool blinks = false;
  for (const NamedWeight& one : sent) {
    known_.push_back({one.name, findExpression(expressions, one.name)});
    const std::optional<std::size_t> expression = known_.back().expression;
    blinks = blinks || (expression && expressions.list[*expression].kind == ProceduralKind::kBlink);
  }
  face.setBlinking(!blinks);
}

std::optional<SessionFace> SessionFace::of(const std::shared_ptr<const Avatar>& avatar) {
  const AvatarFace& face = avatar->face;
  if (face.morphs.targets.empty() && face.lookAt.kind == LookAtKind::kNone && !changesMaterials(face.expressions)) {
    return std::nullopt;
  }
  return SessionFace(avatar);
}

SessionFace::SessionFace(std::shared_ptr<const Avatar> avatar)
    : avatar_(std::move(avatar)),
      face_(avatar_->face.morphs, avatar_->face.expressions, avatar_->face.lookAt),
      bindNormals_(avatar_->look.normals) {
  given_ = avatar_->face.chosen;
  for (std::size_t e = 0; e < given_.size(); ++e) face_.set(e, given_[e]);
  bindNormals_.resize(avatar_->character.mesh.vertices.size(), Vec3f::Zero());
  positions_ = avatar_->character.mesh.vertices;
  normals_ = bindNormals_;
  // Without VRM data: a clip then moves what the expressions stand for.
  const AvatarFace& own = avatar_->face;
  const auto isTarget = [&](const Expression& e) {
    return !e.morphs.empty() && e.name == own.morphs.targets[e.morphs[0].target].name;
  };
  if (std::ranges::all_of(own.expressions.list, isTarget)) named_.resize(own.expressions.list.size());
  if (changesMaterials(avatar_->face.expressions)) materials_ = avatar_->look.materials;
}

void SessionFace::choose(int expression) {
  given_.clear();
  for (std::size_t e = 0; e < avatar_->face.expressions.list.size(); ++e) face_.set(e, 0.0f);
  chosen_ = expression;
  if (chosen_ >= 0) face_.set(chosen_, 1.0f);
}

void SessionFace::update(const SessionAvatar& performer, double time, const Vec3& watcher,
                         std::span<Affine3> worldFromModel, SceneFigure& figure) {
  const AvatarFace& own = avatar_->face;
  follower_.apply(performer.source().expressions(), own.expressions, given_, face_);
  if (chosen_ >= 0) face_.set(chosen_, 1.0f);
  FaceInput input;
  input.time = time;
  if (own.lookAt.head != kNoJoint) {
    input.gaze = followed(gazeTowards(own.lookAt, performer.worldFromJoint()[own.lookAt.head], watcher));
  }
  if (own.clip >= 0 && own.clip < countOf(own.morphs.clips)) {
    input.clip = own.morphs.clips[own.clip];
    input.clipTime = time;
  }
  face_.update(input);
  for (std::size_t e = 0; e < named_.size(); ++e) {
    named_[e] = face_.targetWeights()[own.expressions.list[e].morphs[0].target];
  }
  figure.expressions = named_.empty() ? face_.expressionWeights() : std::span<const float>(named_);
  turnEyes(avatar_->character, own.lookAt, input.gaze, worldFromModel);

  if (!materials_.empty()) {
    expressMaterials(own.expressions, face_.expressionWeights(), avatar_->look.materials, materials_);
    figure.avatarMaterials = materials_;
  }
  const std::span<const float> weights = face_.targetWeights();
  const bool still = std::equal(weights.begin(), weights.end(), own.morphs.targets.begin(),
                                [](float w, const MorphTarget& target) { return w == target.defaultWeight; });
  if (still) return;
  applyMorphs(own.morphs, weights, avatar_->character.mesh.vertices, bindNormals_, positions_, normals_);
  figure.avatarPositions = positions_;
  figure.avatarNormals = normals_;
}

}  // namespace lorica
