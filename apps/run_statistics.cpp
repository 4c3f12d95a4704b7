#include "apps/run_statistics.h"

#include "apps/percentiles.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <string_view>
#include <utility>

namespace lorica {
namespace {

struct Stage {
  const char* name;
  const char* what;
  double (*of)(const StageTimes&);
};

constexpr Stage kStages[] = {
    {"retarget", "joints to pose", [](const StageTimes& t) { return t.retarget; }},
    {"springs", "hair and clothes", [](const StageTimes& t) { return t.springs; }},
    {"motion", "pose to rigid motions of the parts", [](const StageTimes& t) { return t.motion; }},
    {"points", "pose to hull candidates", [](const StageTimes& t) { return t.points; }},
    {"hulls", "candidates to hulls", [](const StageTimes& t) { return t.hulls; }},
    {"physics", "props", [](const StageTimes& t) { return t.physics; }},
    {"particles", "sand or water", [](const StageTimes& t) { return t.particles; }},
    {"total", "everything except drawing", [](const StageTimes& t) { return t.total(); }},
};

Percentiles spreadOfStage(const std::vector<StageTimes>& frames, const Stage& stage) {
  std::vector<double> times;
  times.reserve(frames.size());
  for (const StageTimes& frame : frames) times.push_back(stage.of(frame));
  return percentilesOf(std::move(times));
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

nlohmann::ordered_json RunStatistics::selfContactsOf(std::size_t avatar) const {
  if (avatar >= selfContacts_.size()) return nullptr;
  const SelfContacts& its = selfContacts_[avatar];
  nlohmann::ordered_json json{{"frames", its.frames}, {"pairs", its.pairs}, {"deepest", nullptr}};
  if (its.frames > 0) {
    json["deepest"] = {
        {"parts", {its.deepest.first, its.deepest.second}}, {"depth", its.deepest.depth}, {"time", its.deepestTime}};
  }
  return json;
}

int RunStatistics::propsTouched() const {
  return std::count(touched_.begin(), touched_.end(), 1);
}

void RunStatistics::addTo(nlohmann::ordered_json& json) const {
  json["frames"] = frames();
  json["contacts"] = contacts_;
  json["touches"] = touches_;
  json["propsTouched"] = propsTouched();
  json["avatarTouches"] = avatarTouches_;
  json["selfContacts"] = selfContactsOf(0);
  json["training"] = nullptr;
  if (training_) {
    json["training"] = {{"knownDistance", training_->knownDistance},
                        {"largestDistance", training_->largest},
                        {"framesOutside", training_->framesOutside},
                        {"firstOutside", nullptr}};
    if (training_->framesOutside > 0) {
      json["training"]["firstOutside"] = {{"frame", training_->firstOutside}, {"time", training_->firstTime}};
    }
  }
  for (const Stage& stage : kStages) {
    const Percentiles spread = spreadOfStage(stages_, stage);
    json["stages"][stage.name] = {{"median", spread.median}, {"p95", spread.p95}};
  }
}

void RunStatistics::addSelfContactsTo(Report& report) const {
  for (std::size_t a = 0; a < selfContacts_.size(); ++a) {
    const SelfContacts& its = selfContacts_[a];
    const std::string what =
        its.frames == 0
            ? "none, except between neighbours"
            : fmt::format("{} of parts in {}; deepest overlap {:.1f} cm, parts {} and {} at {:.2f} s",
                          counted(std::ssize(its.pairs), "pair"), counted(its.frames, "frame"),
                          100.0 * its.deepest.depth, its.deepest.first, its.deepest.second, its.deepestTime);
    report.line("self-contacts", selfContacts_.size() == 1 ? what : fmt::format("avatar {}: {}", a + 1, what));
  }
}

void RunStatistics::addTrainingTo(Report& report) const {
  if (!training_) {
    report.line("training", "unknown: the decomposition does not store its training range");
    return;
  }
  const std::string range = fmt::format("({:.2f} m of {:.2f} m)", training_->largest, training_->knownDistance);
  if (training_->framesOutside == 0) {
    report.line("training", "all poses are within the training range " + range);
    return;
  }
  report.line("training", fmt::format("{} of {} outside the training range, first at {:.2f} s (frame {})",
                                      grouped(training_->framesOutside), counted(frames(), "frame"),
                                      training_->firstTime, training_->firstOutside));
  report.line("", "largest distance from a training keyframe " + range);
}

void RunStatistics::addTo(Report& report) const {
  for (const Stage& stage : kStages) {
    const Percentiles spread = spreadOfStage(stages_, stage);
    const std::string_view name = stage.name;
    if ((name == "springs" || name == "particles") && spread.p95 == 0.0) continue;  // there are none
    report.line(stage.name, fmt::format("{:>8}  (95 % below {:>8})  {}", duration(spread.median), duration(spread.p95),
                                        stage.what));
  }
}

}  // namespace lorica
