#include "session/session.h"

#include "acd/transfer.h"
#include "skinning/linear_blend.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace lorica {
namespace {

using Clock = std::chrono::steady_clock;

// Frame times are clamped to these limits: longer ones come from a paused stream, shorter ones from repeated frames.
constexpr double kFirstFrameSeconds = 1.0 / 30.0;
constexpr double kShortestFrameSeconds = 0.001;
constexpr double kLongestFrameSeconds = 0.1;

double microsecondsBetween(Clock::time_point begin, Clock::time_point end) {
  return std::chrono::duration<double, std::micro>(end - begin).count();
}

double frameSeconds(double time, double previousTime) {
  const double seconds = time - previousTime;
  if (!(seconds > kShortestFrameSeconds)) return kShortestFrameSeconds;
  return std::min(seconds, kLongestFrameSeconds);
}

std::uint64_t chainHash(std::uint64_t hash, const LivePart& part) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double), "no padding may be hashed");
  const ConvexHull& shape = part.shape;
  hash = XXH3_64bits_withSeed(part.worldFromPart.data(), 16 * sizeof(double), hash);
  hash = XXH3_64bits_withSeed(shape.vertices.data(), shape.vertices.size() * sizeof(Vec3), hash);
  return XXH3_64bits_withSeed(shape.triangles.data(), shape.triangles.size() * sizeof(Triangle), hash);
}

std::uint64_t chainHash(std::uint64_t hash, const Prop& prop) {
  hash = XXH3_64bits_withSeed(prop.worldFromProp.data(), 16 * sizeof(double), hash);
  hash = XXH3_64bits_withSeed(prop.velocity.data(), sizeof(Vec3), hash);
  return XXH3_64bits_withSeed(prop.angularVelocity.data(), sizeof(Vec3), hash);
}

Result<void> checkTraining(const TrainingRange& training, const Decomposition& decomposition) {
  const std::size_t probes = training.probes.size();
  if (probes < 1 || probes > kMaxProbes || training.keyframeCount < 1 ||
      training.positions.size() != probes * static_cast<std::size_t>(training.keyframeCount)) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("the training range has {} probes, {} keyframes and {} positions, expected 1 to {} "
                             "probes, at least one keyframe and a position for each probe in each keyframe",
                             probes, training.keyframeCount, training.positions.size(), kMaxProbes)};
  }
  for (const PointIndex p : training.probes) {
    if (p >= 0 && p < decomposition.pointCount()) continue;
    return Error{ErrorCode::kInvalidArgument, fmt::format("a probe of the training range is point {}, expected 0 to {}",
                                                          p, decomposition.pointCount() - 1)};
  }
  return {};
}

}  // namespace

Result<Session> Session::create(Character character, Decomposition decomposition, std::unique_ptr<PoseSource> source,
                                World world, std::optional<HullCover> cover, std::optional<TrainingRange> training) {
  LORICA_CHECK(source != nullptr, "a session needs a source");
  Result<LiveBody> body = LiveBody::create(std::move(decomposition), character, std::move(cover));
  if (!body) return body.error();
  if (training) {
    if (Result<void> fits = checkTraining(*training, body->decomposition()); !fits) return fits.error();
  }
  return Session(std::move(character), std::move(*body), std::move(source), std::move(world), std::move(training));
}

Session::Session(Character character, LiveBody body, std::unique_ptr<PoseSource> source, World world,
                 std::optional<TrainingRange> training)
    : character_(std::move(character)),
      source_(std::move(source)),
      body_(std::move(body)),
      world_(std::move(world)),
      jointsOfPart_(jointsOfParts(body_.decomposition(), character_)),
      contactBones_(body_.decomposition(), character_),
      training_(std::move(training)),
      pose_(restPose(character_.skeleton)),
      worldFromJoint_(static_cast<std::size_t>(character_.skeleton.jointCount()), Affine3::Identity()),
      worldFromModel_(worldFromJoint_.size()),
      points_(static_cast<std::size_t>(body_.decomposition().pointCount())) {
  if (!training_) return;
  std::vector<LiftedPoint> lifted = liftPoints(character_, body_.decomposition());
  probes_.reserve(training_->probes.size());
  for (const PointIndex p : training_->probes) probes_.push_back(std::move(lifted[p]));
  probePositions_.resize(probes_.size());
}

Result<bool> Session::step() {
  if (watcher_) watcher_->beforeStep(*this);
  const Clock::time_point begin = Clock::now();
  const Result<std::optional<double>> next = source_->next(pose_);
  if (!next) return next.error();
  if (!next->has_value()) return false;
  const double seconds = frameCount_ == 0 ? kFirstFrameSeconds : frameSeconds(**next, time_);
  const double sourceSeconds = **next - time_;
  time_ = **next;
  const Clock::time_point posed = Clock::now();
  std::span<const JointTransform> pose = pose_;
  if (springs_) {
    const std::span<const Affine3> last = std::span(worldFromModel_).first(frameCount_ == 0 ? 0 : pose_.size());
    pose = springs_->advance(character_, pose_, sourceSeconds, last, body_.parts(), world_.props());
  }
  const Clock::time_point sprung = Clock::now();
  computeWorldFromJoint(character_.skeleton, pose, worldFromJoint_);
  computeWorldFromModel(character_, worldFromJoint_, worldFromModel_);
  const Clock::time_point retargeted = Clock::now();
  body_.update(worldFromModel_);
  passTrustOn();
  doActions();
  const Clock::time_point updated = Clock::now();
  world_.step(body_.parts(), seconds);
  for (Contact& contact : world_.contacts()) {
    contact.bone = contactBones_.at(body_.parts()[contact.part], contact.point);
  }
  const Clock::time_point end = Clock::now();

  times_.springs = springs_ ? microsecondsBetween(posed, sprung) : 0.0;
  times_.retarget = std::max(0.0, microsecondsBetween(begin, retargeted) - times_.springs - 1e6 * source_->waited());
  times_.motion = body_.timing().motion;
  times_.points = body_.timing().points;
  times_.hulls = body_.timing().hulls;
  times_.particles = 1e6 * world_.particleSeconds();
  times_.physics = microsecondsBetween(updated, end) - times_.particles;

  addToHashes();
  ++frameCount_;
  if (watcher_) {
    if (Result<void> watched = watcher_->afterStep(*this, actions_); !watched) return watched.error();
  }
  actions_.clear();
  return true;
}

void Session::addToHashes() {
  for (const LivePart& part : body_.parts()) hashes_.hulls = chainHash(hashes_.hulls, part);
  for (const Prop& prop : world_.props()) hashes_.props = chainHash(hashes_.props, prop);
  if (const Particles* particles = world_.particles()) {
    const std::span<const Vec3f> positions = particles->positions();
    hashes_.particles = XXH3_64bits_withSeed(positions.data(), positions.size_bytes(), hashes_.particles);
  }
}

std::uint64_t Session::hash() const {
  static_assert(sizeof(SessionHashes) == 3 * sizeof(std::uint64_t), "no padding may be hashed");
  return XXH3_64bits(&hashes_, sizeof(hashes_));
}

void Session::restart(std::unique_ptr<PoseSource> source, World world) {
  LORICA_CHECK(source != nullptr, "a session needs a source");
  source_ = std::move(source);
  setWorld(std::move(world));
  body_ = LiveBody(body_.plan());
  pose_ = restPose(character_.skeleton);
  if (springs_) springs_->reset();
  std::fill(worldFromJoint_.begin(), worldFromJoint_.end(), Affine3::Identity());
  time_ = 0.0;
  frameCount_ = 0;
  pointsFrame_ = -1;
  times_ = {};
  hashes_ = {};
}

void Session::setBody(std::shared_ptr<const BodyPlan> plan) {
  if (watcher_) watcher_->sessionChanged();
  LORICA_CHECK(plan->decomposition().vertexCount == body_.decomposition().vertexCount,
               "the body belongs to another character");
  body_ = LiveBody(std::move(plan));
  jointsOfPart_ = jointsOfParts(body_.decomposition(), character_);
  contactBones_ = ContactBones(body_.decomposition(), character_);
  if (springs_) springs_->setBody(character_, body_);
  selfContacts_.reset();
  points_.resize(static_cast<std::size_t>(body_.decomposition().pointCount()));
  pointsFrame_ = -1;
  if (frameCount_ == 0) return;
  body_.update(worldFromModel_);
  passTrustOn();
  world_.step({}, 0.0);  // removes the old parts and their contacts from Bullet
}

Result<void> Session::setSprings(const SpringBones& springs, SpringMode mode) {
  Result<SessionSprings> made = SessionSprings::create(character_, springs, mode, body_);
  if (!made) return made.error();
  if (watcher_) watcher_->sessionChanged();
  springs_ = std::move(*made);
  return {};
}

void Session::setWorld(World world) {
  if (watcher_) watcher_->sessionChanged();
  world_ = std::move(world);
  actions_.clear();
}

void Session::doActions() {
  std::size_t done = 0;
  for (const WorldAction& action : actions_) {
    if (!canBeDone(action, world_)) continue;
    apply(action, world_);
    actions_[done++] = action;
  }
  actions_.resize(done);
}

/// Sets the trust of each part: the mean trust of the joints that move it, weighted with their shares.
void Session::passTrustOn() {
  const std::span<const double> trust = source_->trust();
  if (trust.empty()) return;
  for (std::size_t p = 0; p < jointsOfPart_.size(); ++p) {
    double distrust = 0.0;
    for (const JointShare& j : jointsOfPart_[p]) distrust += j.share * (1.0 - trust[j.joint]);
    body_.setTrust(static_cast<PartIndex>(p), 1.0 - std::min(distrust, 1.0));
  }
}

std::optional<double> Session::trainingDistance() const {
  if (!training_ || frameCount_ == 0) return std::nullopt;
  for (std::size_t i = 0; i < probes_.size(); ++i) probePositions_[i] = positionOf(probes_[i], worldFromModel_);
  return lorica::trainingDistance(*training_, probePositions_);
}

std::span<const SelfContact> Session::selfContacts() const {
  if (frameCount_ == 0) return {};
  if (!selfContacts_) selfContacts_.emplace(body_, character_.mesh.vertices);
  return selfContacts_->find(body_.parts());
}

bool Session::outsideKnownRange() const {
  const std::optional<double> distance = trainingDistance();
  return distance && *distance > training_->knownDistance;
}

std::span<const Vec3> Session::points() const {
  if (pointsFrame_ == frameCount_) return points_;
  const auto posed = std::span(points_).first(character_.mesh.vertices.size());
  if (frameCount_ == 0) {
    std::copy(character_.mesh.vertices.begin(), character_.mesh.vertices.end(), posed.begin());
  } else {
    skinLinearBlend(character_, worldFromModel_, posed);
  }
  transfer(body_.decomposition(), posed, points_);
  pointsFrame_ = frameCount_;
  return points_;
}

}  // namespace lorica
