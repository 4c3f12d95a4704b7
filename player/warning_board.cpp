#include "player/warning_board.h"

#include <algorithm>
#include <cstddef>

namespace lorica {

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

}  // namespace lorica
