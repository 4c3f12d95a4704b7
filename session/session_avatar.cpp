#include "session/session_avatar.h"

#include "acd/transfer.h"
#include "geometry/clock.h"
#include "geometry/errors.h"
#include "session/session_springs.h"
#include "skinning/linear_blend.h"

#include <xxhash.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace lorica {
namespace {

using Clock = std::chrono::steady_clock;

std::uint64_t chainHash(std::uint64_t hash, const LivePart& part) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double), "no padding may be hashed");
  const ConvexHull& shape = part.shape;
  hash = XXH3_64bits_withSeed(part.worldFromPart.data(), 16 * sizeof(double), hash);
  hash = XXH3_64bits_withSeed(shape.vertices.data(), shape.vertices.size() * sizeof(Vec3), hash);
  return XXH3_64bits_withSeed(shape.triangles.data(), shape.triangles.size() * sizeof(Triangle), hash);
}

Result<void> checkTraining(const TrainingRange& training, const Decomposition& decomposition) {
  const std::size_t probes = training.probes.size();
  if (probes < 1 || probes > kMaxProbes || training.keyframeCount < 1 ||
      training.positions.size() != probes * training.keyframeCount) {
    return invalidArgument(
        "the training range has {} probes, {} keyframes and {} positions, expected 1 to {} probes, at least one "
        "keyframe and a position for each probe in each keyframe",
        probes, training.keyframeCount, training.positions.size(), kMaxProbes);
  }
  for (const PointIndex p : training.probes) {
    if (p >= 0 && p < decomposition.pointCount()) continue;
    return invalidArgument("a probe of the training range is point {}, expected 0 to {}", p,
                           decomposition.pointCount() - 1);
  }
  return {};
}

}  // namespace

Result<SessionAvatar> SessionAvatar::create(Character character, Decomposition decomposition,
                                            std::unique_ptr<PoseSource> source, std::optional<HullCover> cover,
                                            std::optional<TrainingRange> training) {
  LORICA_CHECK(source != nullptr, "an avatar needs a source");
  LORICA_TRY(LiveBody body, LiveBody::create(std::move(decomposition), character, std::move(cover)));
  std::vector<LiftedPoint> probes;
  if (training) {
    LORICA_TRY_DO(checkTraining(*training, body.decomposition()));
    std::vector<LiftedPoint> lifted = liftPoints(character, body.decomposition());
    probes.reserve(training->probes.size());
    for (const PointIndex p : training->probes) probes.push_back(std::move(lifted[p]));
  }
  ContactBones bones(body.decomposition(), character);
  JointsOfParts joints = jointsOfParts(body.decomposition(), character);
  auto kind = std::make_shared<const Kind>(Kind{std::move(character), std::move(training), std::move(probes)});
  return SessionAvatar(std::move(kind), std::move(body), std::move(joints), std::move(bones), std::move(source));
}

SessionAvatar SessionAvatar::another(std::unique_ptr<PoseSource> source) const {
  return {kind_, LiveBody(body_.plan()), jointsOfPart_, contactBones_, std::move(source)};
}

SessionAvatar::SessionAvatar(std::shared_ptr<const Kind> kind, LiveBody body, JointsOfParts joints, ContactBones bones,
                             std::unique_ptr<PoseSource> source)
    : kind_(std::move(kind)),
      source_(std::move(source), kind_->character.skeleton),
      body_(std::move(body)),
      jointsOfPart_(std::move(joints)),
      contactBones_(std::move(bones)),
      probePositions_(kind_->probes.size()),
      worldFromJoint_(kind_->character.skeleton.jointCount(), Affine3::Identity()),
      worldFromModel_(worldFromJoint_.size()) {}

SessionAvatar::~SessionAvatar() = default;
SessionAvatar::SessionAvatar(SessionAvatar&&) noexcept = default;
SessionAvatar& SessionAvatar::operator=(SessionAvatar&&) noexcept = default;

void SessionAvatar::setPlace(const Isometry3& worldFromMotion) {
  place_ = worldFromMotion;
  source_.setPlace(worldFromMotion);
}

void SessionAvatar::update(double seconds, std::span<const Prop> props) {
  times_ = {};
  const bool returns = !std::exchange(wasPresent_, present());
  if (!present()) return;
  if (returns && frameCount_ > 0) {
    body_ = LiveBody(body_.plan());  // it comes from nowhere: without velocity
    if (springs_) springs_->reset();
  }
  const Clock::time_point begin = Clock::now();
  std::span<const JointTransform> posed = pose();
  if (springs_) {
    const std::span<const Affine3> last = std::span(worldFromModel_).first(returns ? 0 : worldFromModel_.size());
    posed = springs_->advance(character(), posed, seconds, last, body_.parts(), props);
  }
  const Clock::time_point sprung = Clock::now();
  computeWorldFromJoint(character().skeleton, posed, worldFromJoint_);
  computeWorldFromModel(character(), worldFromJoint_, worldFromModel_);
  const Clock::time_point placed = Clock::now();
  body_.update(worldFromModel_);
  passTrustOn();
  ++frameCount_;
  times_ = {microsecondsBetween(sprung, placed), springs_ ? microsecondsBetween(begin, sprung) : 0.0,
            body_.timing().motion, body_.timing().points, body_.timing().hulls};
}

void SessionAvatar::addToHash() {
  for (const LivePart& part : partsInWorld()) hash_ = chainHash(hash_, part);
}

std::span<const LivePart> SessionAvatar::partsInWorld() const {
  if (!wasPresent_) return {};
  return body_.parts();
}

void SessionAvatar::restart(std::unique_ptr<PoseSource> source) {
  source_ = AlignedSource(std::move(source), character().skeleton);
  if (place_) source_.setPlace(*place_);
  body_ = LiveBody(body_.plan());
  if (springs_) springs_->reset();
  std::fill(worldFromJoint_.begin(), worldFromJoint_.end(), Affine3::Identity());
  frameCount_ = 0;
  wasPresent_ = false;
  pointsFrame_ = -1;
  times_ = {};
  hash_ = 0;
}

void SessionAvatar::setBody(std::shared_ptr<const BodyPlan> plan) {
  LORICA_CHECK(plan->decomposition().vertexCount == body_.decomposition().vertexCount,
               "the body belongs to another character");
  body_ = LiveBody(std::move(plan));
  jointsOfPart_ = jointsOfParts(body_.decomposition(), character());
  contactBones_ = ContactBones(body_.decomposition(), character());
  if (springs_) springs_->setBody(character(), body_);
  selfContacts_.reset();
  pointsFrame_ = -1;
  if (!wasPresent_) return;
  body_.update(worldFromModel_);
  passTrustOn();
}

Result<void> SessionAvatar::setSprings(const SpringBones& springs, SpringMode mode) {
  LORICA_TRY(SessionSprings made, SessionSprings::create(character(), springs, mode, body_));
  springs_ = std::make_unique<SessionSprings>(std::move(made));
  return {};
}

/// Sets the trust of each part: the mean trust of the joints that move it, weighted with their shares.
void SessionAvatar::passTrustOn() {
  const std::span<const double> trust = source().trust();
  if (trust.empty()) return;
  for (std::size_t p = 0; p < jointsOfPart_.size(); ++p) {
    double distrust = 0.0;
    for (const JointShare& j : jointsOfPart_[p]) distrust += j.share * (1.0 - trust[j.joint]);
    body_.setTrust(p, 1.0 - std::min(distrust, 1.0));
  }
}

std::optional<double> SessionAvatar::trainingDistance() const {
  if (!training() || frameCount_ == 0) return std::nullopt;
  for (std::size_t i = 0; i < probePositions_.size(); ++i) {
    probePositions_[i] = positionOf(kind_->probes[i], worldFromModel_);
  }
  return lorica::trainingDistance(*training(), probePositions_);
}

bool SessionAvatar::outsideKnownRange() const {
  const std::optional<double> distance = trainingDistance();
  return distance && *distance > training()->knownDistance;
}

std::span<const SelfContact> SessionAvatar::selfContacts() const {
  return wasPresent_ ? contactQuery().find(body_.parts()) : std::span<const SelfContact>();
}

SelfContactQuery& SessionAvatar::contactQuery() const {
  if (!selfContacts_) selfContacts_.emplace(body_, character().mesh.vertices);
  return *selfContacts_;
}

JointIndex SessionAvatar::boneAt(PartIndex part, const Vec3& position) const {
  return contactBones_.at(body_.parts()[part], position);
}

std::span<const Vec3> SessionAvatar::points() const {
  if (pointsFrame_ == frameCount_) return points_;
  const std::vector<Vec3>& bind = character().mesh.vertices;
  points_.resize(body_.decomposition().pointCount());
  const auto posed = std::span(points_).first(bind.size());
  if (frameCount_ == 0) {
    std::copy(bind.begin(), bind.end(), posed.begin());
  } else {
    skinLinearBlend(character(), worldFromModel_, posed);
  }
  transfer(body_.decomposition(), posed, points_);
  pointsFrame_ = frameCount_;
  return points_;
}

}  // namespace lorica
