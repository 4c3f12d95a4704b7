#include "player/target_hits.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <numeric>

namespace lorica {
namespace {

struct LimbName {
  const char* key;
  const char* words;
};

/// In the order of HitLimb.
constexpr std::array<LimbName, kHittingLimbs> kLimbs = {{{"leftHand", "left hand"},
                                                         {"rightHand", "right hand"},
                                                         {"leftFoot", "left foot"},
                                                         {"rightFoot", "right foot"},
                                                         {"rest", "the rest"}}};

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

void TargetHits::addTo(nlohmann::ordered_json& json) const {
  json["targets"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < counter_.targets().size(); ++i) {
    const HitCounter::Hits& hits = counter_.hitsOf(i);
    nlohmann::ordered_json target;
    target["name"] = counter_.targets()[i].name;
    target["hits"] = sumOf(hits);
    for (std::size_t limb = 0; limb < kHittingLimbs; ++limb) target[kLimbs[limb].key] = hits[limb];
    json["targets"].push_back(std::move(target));
  }
}

void TargetHits::addTo(Report& report) const {
  for (std::size_t i = 0; i < counter_.targets().size(); ++i) {
    const HitCounter::Hits& hits = counter_.hitsOf(i);
    std::string who;
    for (std::size_t limb = 0; limb < kHittingLimbs; ++limb) {
      if (hits[limb] > 0) who += fmt::format("{}{} {}", who.empty() ? ": " : ", ", kLimbs[limb].words, hits[limb]);
    }
    report.line(i == 0 ? "targets" : "",
                fmt::format("{}, {}{}", counter_.targets()[i].name, counted(sumOf(hits), "hit"), who));
  }
}

}  // namespace lorica
