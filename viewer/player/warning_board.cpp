#include "viewer/player/warning_board.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstddef>

namespace lorica {
namespace {

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
