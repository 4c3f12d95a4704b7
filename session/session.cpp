#include "session/session.h"

#include "collision/particles/particles.h"
#include "geometry/clock.h"
#include "geometry/counts.h"
#include "geometry/threads.h"
#include "session/contact_events.h"

#include <tbb/task_group.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <utility>

namespace lorica {
namespace {

using Clock = std::chrono::steady_clock;

// Frame times are clamped to these limits: longer ones come from a paused stream, shorter ones from repeated frames.
constexpr double kFirstFrameSeconds = 1.0 / 30.0;
constexpr double kShortestFrameSeconds = 0.001;
constexpr double kLongestFrameSeconds = 0.1;

double frameSeconds(double seconds) {
  if (!(seconds > kShortestFrameSeconds)) return kShortestFrameSeconds;
  return std::min(seconds, kLongestFrameSeconds);
}

std::uint64_t chainHash(std::uint64_t hash, const Prop& prop) {
  hash = XXH3_64bits_withSeed(prop.worldFromProp.data(), 16 * sizeof(double), hash);
  hash = XXH3_64bits_withSeed(prop.velocity.data(), sizeof(Vec3), hash);
  return XXH3_64bits_withSeed(prop.angularVelocity.data(), sizeof(Vec3), hash);
}

}  // namespace

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

Result<Session> Session::create(Character character, Decomposition decomposition, std::unique_ptr<PoseSource> source,
                                World world, std::optional<HullCover> cover, std::optional<TrainingRange> training) {
  LORICA_TRY(SessionAvatar avatar, SessionAvatar::create(std::move(character), std::move(decomposition),
                                                         std::move(source), std::move(cover), std::move(training)));
  Session session(std::move(world));
  session.addAvatar(std::move(avatar));
  return session;
}

int Session::addAvatar(SessionAvatar avatar) {
  if (watcher_) watcher_->sessionChanged();
  if (frameCount_ > 0) avatar.source_.joinAt(time_ + kFirstFrameSeconds);
  avatars_.push_back(std::move(avatar));
  return countOf(avatars_) - 1;
}

Result<bool> Session::step() {
  if (watcher_) watcher_->beforeStep(*this);
  const Clock::time_point begin = Clock::now();
  LORICA_TRY(const std::optional<double> next, readPoses());
  if (!next.has_value()) return false;
  const double sourceSeconds = *next - time_;
  const double seconds = frameCount_ == 0 ? kFirstFrameSeconds : frameSeconds(sourceSeconds);
  seconds_ = frameCount_ == 0 ? kFirstFrameSeconds : std::max(sourceSeconds, kShortestFrameSeconds);
  time_ = *next;
  times_ = {};
  for (const SessionAvatar& avatar : avatars_) times_.retarget -= 1e6 * avatar.source().waited();
  times_.retarget = std::max(0.0, times_.retarget + microsecondsBetween(begin, Clock::now()));
  moveAvatars(sourceSeconds);
  doActions();
  const Clock::time_point moved = Clock::now();
  partsOfAvatars_.clear();
  for (const SessionAvatar& avatar : avatars_) partsOfAvatars_.push_back(avatar.partsInWorld());
  if (avatarContacts_ && contactsFrame_ == frameCount_) {
    // What was asked of the last frame will be asked of this one. Contacts between avatars need only the hulls, so they
    // are found while physics runs, of which one core does some alone.
    tbb::task_group finding;
    finding.run([&] { findAvatarContacts(frameCount_ + 1); });
    world_.stepAvatars(partsOfAvatars_, seconds);
    finding.wait();
  } else {
    world_.stepAvatars(partsOfAvatars_, seconds);
  }
  for (Contact& contact : world_.contacts()) {
    contact.bone = avatars_[contact.avatar].boneAt(contact.part, contact.point);
  }
  const Clock::time_point end = Clock::now();
  times_.particles = 1e6 * world_.particleSeconds();
  times_.physics = microsecondsBetween(moved, end) - times_.particles;

  addToHashes();
  ++frameCount_;
  if (watcher_) {
    LORICA_TRY_DO(watcher_->afterStep(*this, actions_));
  }
  actions_.clear();
  return true;
}

/// Reads the poses of a frame from all sources. @return its time; nothing at the end of all
Result<std::optional<double>> Session::readPoses() {
  auto leader = avatars_.begin();
  std::optional<double> time;
  for (; leader != avatars_.end() && !time; ++leader) {
    if (leader->source_.ended()) continue;
    LORICA_TRY(time, leader->source_.lead());
  }
  if (!time) return time;
  for (; leader != avatars_.end(); ++leader) {
    LORICA_TRY_DO(leader->source_.follow(*time));
  }
  return time;
}

void Session::moveAvatars(double seconds) {
  const auto move = [&](std::size_t a) {
    avatars_[a].update(seconds, world_.props());
    avatars_[a].addToHash();  // while its parts are in the cache
  };
  if (avatars_.size() == 1) {
    move(0);
  } else {
    parallelFor(avatars_.size(), move);
  }
  for (const SessionAvatar& avatar : avatars_) {
    const AvatarTimes& its = avatar.times();
    times_.retarget += its.retarget;
    times_.springs += its.springs;
    times_.motion += its.motion;
    times_.points += its.points;
    times_.hulls += its.hulls;
  }
}

void Session::addToHashes() {
  hashes_.hulls = 0;
  for (const SessionAvatar& avatar : avatars_) hashes_.hulls = std::rotl(hashes_.hulls, 1) ^ avatar.hash();
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
  std::vector<std::unique_ptr<PoseSource>> sources;
  sources.push_back(std::move(source));
  restart(std::move(sources), std::move(world));
}

void Session::restart(std::vector<std::unique_ptr<PoseSource>> sources, World world) {
  LORICA_CHECK(sources.size() == avatars_.size(), "each avatar needs a source");
  setWorld(std::move(world));
  for (std::size_t a = 0; a < avatars_.size(); ++a) avatars_[a].restart(std::move(sources[a]));
  time_ = 0.0;
  frameCount_ = contactsFrame_ = 0;
  times_ = {};
  hashes_ = {};
}

void Session::setBody(std::shared_ptr<const BodyPlan> plan, int avatar) {
  if (watcher_) watcher_->sessionChanged();
  avatars_[avatar].setBody(std::move(plan));
  contactsFrame_ = 0;
  if (frameCount_ > 0) world_.stepAvatars({}, 0.0);  // removes the old parts and their contacts from Bullet
}

Result<void> Session::setSprings(const SpringBones& springs, SpringMode mode, int avatar) {
  LORICA_TRY_DO(avatars_[avatar].setSprings(springs, mode));
  if (watcher_) watcher_->sessionChanged();
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

std::span<const BodyContact> Session::avatarContacts() const {
  if (frameCount_ == 0 || avatars_.size() < 2) return {};
  if (!avatarContacts_) avatarContacts_.emplace();
  if (contactsFrame_ != frameCount_) findAvatarContacts(frameCount_);
  return found_;
}

/// @param frame  for which they are
void Session::findAvatarContacts(int frame) const {
  found_ = avatarContacts_->find(avatars_, seconds_);
  contactsFrame_ = frame;
}

}  // namespace lorica
