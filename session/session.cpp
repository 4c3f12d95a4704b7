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

// Steps outside are a stream that paused or repeats itself; physics then moves on by one of these instead.
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

/// Whether a cover is of this decomposition: points for each part, all of them there.
Result<void> checkCover(const CoverPromise& cover, const Decomposition& decomposition) {
  if (cover.points.size() != decomposition.parts.size()) {
    return Error{ErrorCode::kInvalidArgument, fmt::format("the cover is of {} parts, the decomposition has {}",
                                                          cover.points.size(), decomposition.parts.size())};
  }
  for (std::size_t i = 0; i < cover.points.size(); ++i) {
    if (cover.points[i].empty()) {
      return Error{ErrorCode::kInvalidArgument, fmt::format("the cover has no points of part {}, expected one", i)};
    }
    for (const CoverPoint& p : cover.points[i]) {
      if (p.point >= 0 && p.point < decomposition.pointCount() && p.outward.allFinite()) continue;
      return Error{
          ErrorCode::kInvalidArgument,
          fmt::format("the cover of part {} has point {}, displaced by ({}, {}, {}) m, expected points 0 to "
                      "{} and finite displacements",
                      i, p.point, p.outward.x(), p.outward.y(), p.outward.z(), decomposition.pointCount() - 1)};
    }
  }
  return {};
}

Result<void> checkTraining(const TrainingRange& training, const Decomposition& decomposition) {
  const std::size_t probes = training.probes.size();
  if (probes < 1 || probes > kMaxProbes || training.keyframeCount < 1 ||
      training.positions.size() != probes * static_cast<std::size_t>(training.keyframeCount)) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("the training has {} probes, {} keyframes and {} positions, expected 1 to {} probes, a "
                             "keyframe or more and a position for each probe in each",
                             probes, training.keyframeCount, training.positions.size(), kMaxProbes)};
  }
  for (const PointIndex p : training.probes) {
    if (p >= 0 && p < decomposition.pointCount()) continue;
    return Error{ErrorCode::kInvalidArgument, fmt::format("a probe of the training is point {}, expected 0 to {}", p,
                                                          decomposition.pointCount() - 1)};
  }
  return {};
}

}  // namespace

Result<Session> Session::create(Character character, Decomposition decomposition, std::unique_ptr<PoseSource> source,
                                World world, std::optional<CoverPromise> cover, std::optional<TrainingRange> training) {
  CHECK(source != nullptr, "a session needs a source");
  const std::size_t vertexCount = character.mesh.vertices.size();
  const std::size_t triangleCount = character.mesh.triangles.size();
  if (static_cast<std::size_t>(decomposition.vertexCount) != vertexCount ||
      static_cast<std::size_t>(decomposition.triangleCount) != triangleCount) {
    return Error{
        ErrorCode::kInvalidArgument,
        fmt::format("the decomposition was made from a mesh of {} vertices and {} triangles, '{}' has {} and {}",
                    decomposition.vertexCount, decomposition.triangleCount, character.name, vertexCount,
                    triangleCount)};
  }
  if (cover) {
    if (Result<void> fits = checkCover(*cover, decomposition); !fits) return fits.error();
  }
  if (training) {
    if (Result<void> fits = checkTraining(*training, decomposition); !fits) return fits.error();
  }
  LiveBody body = cover ? LiveBody(std::move(decomposition), character, std::move(*cover))
                        : LiveBody(std::move(decomposition), character);
  return Session(std::move(character), std::move(body), std::move(source), std::move(world), std::move(training));
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
  for (const PointIndex p : training_->probes) probes_.push_back(std::move(lifted[static_cast<std::size_t>(p)]));
  probePositions_.resize(probes_.size());
}

Result<bool> Session::step() {
  if (watcher_) watcher_->beforeStep(*this);
  const Clock::time_point begin = Clock::now();
  const Result<std::optional<double>> next = source_->next(pose_);
  if (!next) return next.error();
  if (!next->has_value()) return false;
  const double seconds = frameCount_ == 0 ? kFirstFrameSeconds : frameSeconds(**next, time_);
  time_ = **next;
  computeWorldFromJoint(character_.skeleton, pose_, worldFromJoint_);
  computeWorldFromModel(character_, worldFromJoint_, worldFromModel_);
  const Clock::time_point retargeted = Clock::now();
  body_.update(worldFromModel_);
  passTrustOn();
  doActions();
  const Clock::time_point updated = Clock::now();
  world_.step(body_.parts(), seconds);
  for (Contact& contact : world_.contacts()) {
    contact.bone = contactBones_.at(body_.parts()[static_cast<std::size_t>(contact.part)], contact.point);
  }
  const Clock::time_point end = Clock::now();

  times_.retarget = std::max(0.0, microsecondsBetween(begin, retargeted) - 1e6 * source_->waited());
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
    const std::span<const Vec3f> places = particles->places();
    hashes_.particles = XXH3_64bits_withSeed(places.data(), places.size_bytes(), hashes_.particles);
  }
}

std::uint64_t Session::hash() const {
  static_assert(sizeof(SessionHashes) == 3 * sizeof(std::uint64_t), "no padding may be hashed");
  return XXH3_64bits(&hashes_, sizeof(hashes_));
}

void Session::restart(std::unique_ptr<PoseSource> source, World world) {
  CHECK(source != nullptr, "a session needs a source");
  source_ = std::move(source);
  setWorld(std::move(world));
  body_ = LiveBody(body_.plan());
  pose_ = restPose(character_.skeleton);
  std::fill(worldFromJoint_.begin(), worldFromJoint_.end(), Affine3::Identity());
  time_ = 0.0;
  frameCount_ = 0;
  pointsFrame_ = -1;
  times_ = {};
  hashes_ = {};
}

void Session::setBody(std::shared_ptr<const BodyPlan> plan) {
  if (watcher_) watcher_->sessionChanged();
  CHECK(plan->decomposition().vertexCount == body_.decomposition().vertexCount, "a body of another character");
  body_ = LiveBody(std::move(plan));
  jointsOfPart_ = jointsOfParts(body_.decomposition(), character_);
  contactBones_ = ContactBones(body_.decomposition(), character_);
  selfContacts_.reset();
  points_.resize(static_cast<std::size_t>(body_.decomposition().pointCount()));
  pointsFrame_ = -1;
  if (frameCount_ == 0) return;
  body_.update(worldFromModel_);
  passTrustOn();
  world_.step({}, 0.0);  // the old parts leave, and with them what Bullet knows of their contacts
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

/// A part is believed as far as the joints that move it are.
void Session::passTrustOn() {
  const std::span<const double> trust = source_->trust();
  if (trust.empty()) return;
  for (std::size_t p = 0; p < jointsOfPart_.size(); ++p) {
    double distrust = 0.0;
    for (const JointShare& j : jointsOfPart_[p]) distrust += j.share * (1.0 - trust[static_cast<std::size_t>(j.joint)]);
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
