#include "viewer/player/window_texts.h"

#include "geometry/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <set>
#include <span>

namespace lorica {
namespace {

std::ptrdiff_t partCountOf(const Session& session) {
  std::ptrdiff_t parts = 0;
  for (const SessionAvatar& avatar : session.avatars()) {
    parts += avatar.present() ? std::ssize(avatar.body().parts()) : 0;
  }
  return parts;
}

std::ptrdiff_t touchedProps(const Session& session) {
  std::set<int> touched;
  for (const Contact& contact : session.world().contacts()) touched.insert(contact.prop);
  return std::ssize(touched);
}

constexpr double kBelieved = 0.5;
constexpr int kMaxNames = 3;

/// Converts leftUpperArm to "left upper arm".
std::string wordsOf(std::string_view name) {
  std::string words;
  for (const char c : name) {
    if (std::isupper(static_cast<unsigned char>(c)) != 0) words += ' ';
    words += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  return words;
}

}  // namespace

std::string titleOf(const Session& session, const std::string& source, bool live) {
  const std::size_t count = session.avatars().size();
  if (count == 0) return source;
  const std::string who = count == 1 ? session.character().name : fmt::format("{} avatars", count);
  const std::string does = fmt::format("{}{}", live ? "follow" : "perform", count == 1 ? "s" : "");
  // Its own clip is named after the character, too.
  const std::string own = who + ": ";
  return fmt::format("{} {} {}", who, does, source.starts_with(own) ? source.substr(own.size()) : source);
}

std::string statusOf(const Session& session, bool ended) {
  std::string status = counted(partCountOf(session), "part");
  if (const std::ptrdiff_t touched = touchedProps(session); touched > 0) {
    status += ", touching " + counted(touched, "prop");
  }
  if (ended) status += ", end of recording";
  return status;
}

void addStageTimes(const Session& session, std::optional<double> tracking, Screen& screen) {
  const StageTimes& t = session.times();
  std::array<TimedStage, 8> stages;
  std::size_t count = 0;
  const auto add = [&](const char* name, double microseconds) { stages[count++] = {name, 1e-3 * microseconds}; };
  if (tracking) add("joints", 1e6 * *tracking);
  add("pose", t.retarget);
  if (session.springs() != nullptr) add("springs", t.springs);
  add("motion", t.motion);
  add("points", t.points);
  add("hulls", t.hulls);
  add("physics", t.physics);
  if (session.world().particles() != nullptr) add("particles", t.particles);
  screen.addTimes(std::span(stages).first(count));
}

std::string captionOf(const std::string& name, const Session& session, double seconds) {
  std::string caption = fmt::format("{}   {:.1f} s   {}", name, seconds, counted(partCountOf(session), "convex part"));
  if (const std::ptrdiff_t touched = touchedProps(session); touched > 0) {
    caption += "   touching " + counted(touched, "prop");
  }
  return caption;
}

void WarningBoard::raise(std::string_view kind, std::string_view sentence, double now) {
  const auto isKind = [&](const Note& note) { return note.kind == kind; };
  const auto found = std::find_if(notes_.begin(), notes_.end(), isKind);
  if (found == notes_.end()) {
    const auto earlier = std::find_if(past_.begin(), past_.end(), isKind);
    double hold = kHoldSeconds;
    if (earlier != past_.end()) {
      if (now - earlier->raised < kForgotten) hold = std::min(2.0 * earlier->hold, kLongestHold);
      past_.erase(earlier);
    }
    notes_.push_back({std::string(kind), now, now, hold});
    sentences_.emplace_back(sentence);
    return;
  }
  found->raised = now;
  std::string& words = sentences_[found - notes_.begin()];
  if (words == sentence || now - found->worded < kHoldSeconds) return;
  words = sentence;
  found->worded = now;
}

void WarningBoard::update(double now) {
  for (std::size_t i = notes_.size(); i-- > 0;) {
    if (now - notes_[i].raised < notes_[i].hold) continue;
    past_.push_back(std::move(notes_[i]));
    notes_.erase(notes_.begin() + static_cast<std::ptrdiff_t>(i));
    sentences_.erase(sentences_.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

std::string lostLimbs(const Skeleton& skeleton, std::span<const double> trust, std::vector<bool>& known) {
  known.resize(trust.size());
  std::string names;
  int lost = 0, bones = 0;
  for (std::size_t j = 0; j < trust.size(); ++j) {
    const std::optional<HumanBone> bone = skeleton.joints()[j].bone;
    if (!bone || *bone > HumanBone::kRightHand) continue;  // the fingers follow their hand
    known[j] = known[j] || trust[j] >= kBelieved;
    bones += known[j] ? 1 : 0;
    if (!known[j] || trust[j] >= kBelieved) continue;
    if (++lost > kMaxNames) continue;
    if (!names.empty()) names += ", ";
    names += wordsOf(nameOf(*bone));
  }
  if (lost == 0) return {};
  if (lost == bones) return "the whole body is lost";
  if (lost > kMaxNames) return fmt::format("{} and {} more lost", names, lost - kMaxNames);
  return names + " lost";
}

void raiseWarnings(const Session& session, std::string_view trouble, double now, WarningBoard& board) {
  if (!trouble.empty()) {
    board.raise("source", trouble, now);
    board.known.clear();
    return;
  }
  const std::span<const SessionAvatar> avatars = session.avatars();
  board.known.resize(avatars.size());
  for (std::size_t a = 0; a < avatars.size(); ++a) {
    if (!avatars[a].present()) continue;
    const std::string lost = lostLimbs(avatars[a].character().skeleton, avatars[a].source().trust(), board.known[a]);
    if (lost.empty()) continue;
    const std::string number = std::to_string(a + 1);
    board.raise("limbs" + number, avatars.size() == 1 ? lost : fmt::format("avatar {}: {}", number, lost), now);
  }
}

}  // namespace lorica
