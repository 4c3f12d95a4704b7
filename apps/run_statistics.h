#pragma once

#include "apps/report.h"
#include "collision/world/self_contact.h"
#include "session/session.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace lorica {

/// What is counted and timed while a session runs.
class Tally {
 public:
  /// Takes the session's last frame into account.
  /// @param selfContacts  also ask the body which of its parts overlap, which takes some 50 us
  void add(const Session& session, bool selfContacts = false);
  /// A new session of the same recording follows: its contacts start afresh.
  void restart() {
    touching_.clear();
    start_.reset();
  }

  [[nodiscard]] int frames() const { return static_cast<int>(stages_.size()); }
  /// Contact points between body and props, summed over the frames.
  [[nodiscard]] long long contacts() const { return contacts_; }
  /// How often a part and a prop came together that were apart in the frame before.
  [[nodiscard]] long long touches() const { return touches_; }
  [[nodiscard]] int propCount() const { return static_cast<int>(touched_.size()); }
  /// How many different props were touched.
  [[nodiscard]] int propsTouched() const;

  /// How far the body was from the poses that trained its decomposition.
  struct Training {
    double knownDistance = 0.0;  ///< farther is outside the known range [m]
    double largest = 0.0;        ///< [m]
    int framesOutside = 0;
    int firstOutside = -1;   ///< frame, from 0; -1 = none
    double firstTime = 0.0;  ///< of that frame, since the first [s]
  };
  /// None where the training is not known, or nothing was played.
  [[nodiscard]] const std::optional<Training>& training() const { return training_; }

  /// Parts of the body that overlapped though they are not neighbours.
  struct SelfContacts {
    std::vector<std::pair<PartIndex, PartIndex>> pairs;  ///< ascending
    int frames = 0;                                      ///< with one or more
    SelfContact deepest;
    double deepestTime = 0.0;  ///< since the first frame [s]
  };
  /// None where nobody asked.
  [[nodiscard]] const std::optional<SelfContacts>& selfContacts() const { return selfContacts_; }

  /// "frames", "contacts", "touches", "propsTouched", "selfContacts", "training" and "stages": each stage's median and
  /// p95 [us].
  void addTo(nlohmann::ordered_json& json) const;
  /// One line a stage.
  void addTo(Report& report) const;
  /// One line on self-contacts, where asked for.
  void addSelfContactsTo(Report& report) const;
  /// One line on how far from training the body was; two where it left the known range.
  void addTrainingTo(Report& report) const;

 private:
  void addSelfContacts(const Session& session);

  std::vector<StageTimes> stages_;
  std::vector<std::pair<PartIndex, int>> touching_;  // sorted pairs of the last frame
  std::vector<std::pair<PartIndex, int>> now_;
  std::vector<std::uint8_t> touched_;  // one flag a prop
  long long contacts_ = 0;
  long long touches_ = 0;
  std::optional<Training> training_;
  std::optional<SelfContacts> selfContacts_;
  std::optional<double> start_;  // time of the session's first frame [s]
};

}  // namespace lorica
