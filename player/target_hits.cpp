#include "player/target_hits.h"

#include <fmt/format.h>

#include <numeric>

namespace lorica {
namespace {

int sumOf(const HitCounter::Hits& hits) {
  return std::accumulate(hits.begin(), hits.end(), 0);
}

}  // namespace

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
