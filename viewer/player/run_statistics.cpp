#include "viewer/player/run_statistics.h"

#include "capture/streams/depth_stream.h"

#include <fmt/format.h>

#include <chrono>
#include <numeric>

namespace lorica {
namespace {

constexpr const char* kStepOut = "person and furniture are connected: step out of the picture for a second";

int sumOf(const HitCounter::Hits& hits) {
  return std::accumulate(hits.begin(), hits.end(), 0);
}

}  // namespace

long long RunStatistics::countNew(std::vector<Pair>& now, std::vector<Pair>& last) {
  // A pair has up to four contact points but is counted once.
  std::sort(now.begin(), now.end());
  now.erase(std::unique(now.begin(), now.end()), now.end());
  const auto isNew = [&](const Pair& pair) { return !std::binary_search(last.begin(), last.end(), pair); };
  const auto count = std::count_if(now.begin(), now.end(), isNew);
  std::swap(last, now);
  return count;
}

void RunStatistics::add(const Session& session, bool selfContacts) {
  stages_.push_back(session.times());
  if (!start_) start_ = session.time();
  touched_.resize(session.world().props().size(), 0);
  contactsOf_.resize(session.avatars().size(), 0);
  now_.clear();
  for (const Contact& contact : session.world().contacts()) {
    ++contacts_;
    ++contactsOf_[contact.avatar];
    now_.push_back({contact.avatar, contact.part, contact.prop, 0});
    touched_[contact.prop] = 1;
  }
  touches_ += countNew(now_, touching_);
  now_.clear();
  for (const BodyContact& contact : session.avatarContacts()) {
    now_.push_back({contact.firstBody, contact.firstPart, contact.secondBody, contact.secondPart});
  }
  avatarTouches_ += countNew(now_, meeting_);

  if (selfContacts) addSelfContacts(session);
  bool outside = false;
  for (const SessionAvatar& avatar : session.avatars()) outside = addTraining(avatar) || outside;
  if (!outside) return;
  if (training_->framesOutside++ > 0) return;
  training_->firstOutside = frames() - 1;
  training_->firstTime = session.time() - *start_;
}

/// @return whether its pose is outside the training range
bool RunStatistics::addTraining(const SessionAvatar& avatar) {
  const std::optional<double> distance = avatar.trainingDistance();
  if (!distance) return false;
  const double known = avatar.training()->knownDistance;
  if (!training_) training_ = Training{known};
  if (*distance * training_->knownDistance > training_->largest * known) {
    training_->largest = *distance;
    training_->knownDistance = known;
  }
  return *distance > known;
}

void RunStatistics::addSelfContacts(const Session& session) {
  selfContacts_.resize(session.avatars().size());
  for (std::size_t a = 0; a < selfContacts_.size(); ++a) {
    SelfContacts& its = selfContacts_[a];
    const std::span<const SelfContact> contacts = session.avatars()[a].selfContacts();
    its.frames += contacts.empty() ? 0 : 1;
    for (const SelfContact& contact : contacts) {
      const std::pair pair(contact.first, contact.second);
      const auto at = std::lower_bound(its.pairs.begin(), its.pairs.end(), pair);
      if (at == its.pairs.end() || *at != pair) its.pairs.insert(at, pair);
      if (contact.depth <= its.deepest.depth) continue;
      its.deepest = contact;
      its.deepestTime = session.time() - *start_;
    }
  }
}

int RunStatistics::propsTouched() const {
  return std::count(touched_.begin(), touched_.end(), 1);
}

void LiveLog::add(const LiveJoints& joints, double seconds, Host& host) {
  const DepthSight& sight = joints.sight();
  figures_.frames = joints.frameCount();
  figures_.followed = joints.followedCount();
  if (sight.read == DepthRead::kFrame) {
    const std::chrono::duration<double, std::micro> latency = std::chrono::steady_clock::now() - sight.arrived;
    figures_.latency.push_back(latency.count());
    figures_.track.push_back(1e6 * sight.trackSeconds);
    if (sight.followed && !figures_.firstPose) figures_.firstPose = seconds;
    figures_.maxPeople = std::max(figures_.maxPeople, sight.people);
  }
  sent_ = dynamic_cast<const DepthStream*>(&joints.source()) != nullptr;
  const bool unplugged = sight.read == DepthRead::kUnplugged;
  if (unplugged && !unplugged_) ++figures_.unplugs;
  const char* news = nullptr;
  if (unplugged != unplugged_) {
    news = sent_ ? (unplugged ? "no program sends depth; waiting for one" : "a program sends depth again")
                 : (unplugged ? "the sensor is unplugged; waiting for it" : "the sensor is back");
  } else if (sight.read == DepthRead::kFrame && sight.followed != wasFollowed_) {
    news = sight.followed ? "a person is tracked" : "no person is visible";
  } else if (sight.roomUncertain && !wasUncertain_) {
    news = kStepOut;
  }
  if (news != nullptr) host.tell(fmt::format("{:6.1f} s  {}", seconds, news));
  unplugged_ = unplugged;
  if (sight.read == DepthRead::kFrame) {
    wasFollowed_ = sight.followed;
    wasUncertain_ = sight.roomUncertain;
  }
}

std::string LiveLog::state() const {
  if (unplugged_) return sent_ ? "no program sends depth" : "the sensor is unplugged";
  if (wasUncertain_) return kStepOut;
  return wasFollowed_ ? "" : "no person is visible";
}

TargetHits::TargetHits(std::vector<HitTarget> targets) : counter_(std::move(targets)) {
  for (const HitTarget& target : counter_.targets()) scores_.push_back({target.name, 0});
}

void TargetHits::add(const Session& session) {
  if (counter_.targets().empty()) return;
  if (!events_) events_.emplace(session);
  counter_.add(events_->update(session), session);
  for (std::size_t i = 0; i < scores_.size(); ++i) scores_[i].hits = sumOf(counter_.hitsOf(i));
}

std::string TargetHits::caption() const {
  std::string text;
  for (std::size_t i = 0; i < counter_.targets().size(); ++i) {
    text += fmt::format("{}{} {}", i == 0 ? "   hits: " : ", ", counter_.targets()[i].name, sumOf(counter_.hitsOf(i)));
  }
  return text;
}

}  // namespace lorica
