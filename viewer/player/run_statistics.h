#pragma once

#include "capture/tracking/depth_joints.h"
#include "collision/hulls/host.h"
#include "collision/world/self_contact.h"
#include "session/contact_events.h"
#include "session/scenes/hit_counter.h"
#include "session/session.h"
#include "viewer/renderer/window_values.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lorica {

/// Percentiles of a series of measurements.
struct Percentiles {
  double median = 0.0;
  double p95 = 0.0;
};

/// By the nearest-rank method, so that each figure is a measured value. Zeros if there are no values.
[[nodiscard]] inline Percentiles percentilesOf(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto quantile = [&](double share) {
    const std::size_t rank = std::ceil(share * values.size());
    return values[std::max<std::size_t>(rank, 1) - 1];
  };
  return {quantile(0.5), quantile(0.95)};
}

/// Counts and times of a running session.
class RunStatistics {
 public:
  /// Adds the session's last frame to the statistics.
  /// @param selfContacts  also compute which parts of the body overlap, which takes about 50 us
  void add(const Session& session, bool selfContacts = false);
  /// Call before the recording restarts: contacts are counted from scratch.
  void restart() {
    touching_.clear();
    meeting_.clear();
    start_.reset();
  }

  [[nodiscard]] int frames() const { return stages_.size(); }
  /// Contact points between avatars and props, summed over the frames.
  [[nodiscard]] long long contacts() const { return contacts_; }
  /// The same of one avatar.
  [[nodiscard]] long long contactsOf(std::size_t avatar) const {
    return avatar < contactsOf_.size() ? contactsOf_[avatar] : 0;
  }
  /// Number of contacts between parts of two avatars that started.
  [[nodiscard]] long long avatarTouches() const { return avatarTouches_; }
  /// Number of contacts between a part and a prop that started, i.e. were not present in the previous frame.
  [[nodiscard]] long long touches() const { return touches_; }
  [[nodiscard]] int propCount() const { return touched_.size(); }
  /// Number of different props touched.
  [[nodiscard]] int propsTouched() const;

  /// Distance of the poses from the training keyframes of the decomposition.
  struct Training {
    double knownDistance = 0.0;  ///< greater distances are outside the training range [m]
    double largest = 0.0;        ///< [m]
    int framesOutside = 0;
    int firstOutside = -1;   ///< frame, from 0; -1 = none
    double firstTime = 0.0;  ///< of that frame, relative to the first [s]
  };
  /// Of all avatars: the farthest in each frame. None if no training range is known, or nothing was played.
  [[nodiscard]] const std::optional<Training>& training() const { return training_; }

  /// Overlapping parts of the body that are not neighbours.
  struct SelfContacts {
    std::vector<std::pair<PartIndex, PartIndex>> pairs;  ///< ascending
    int frames = 0;                                      ///< frames with at least one pair
    SelfContact deepest;
    double deepestTime = 0.0;  ///< relative to the first frame [s]
  };
  /// Of each avatar; empty if not requested.
  [[nodiscard]] const std::vector<SelfContacts>& selfContacts() const { return selfContacts_; }
  /// Of each frame.
  [[nodiscard]] const std::vector<StageTimes>& times() const { return stages_; }

 private:
  /// An avatar, its part, and a prop; or an avatar, its part, another avatar, and its part.
  using Pair = std::array<int, 4>;
  /// Counts the pairs that were not there in the last frame. @param now  pairs of this frame, in any order
  static long long countNew(std::vector<Pair>& now, std::vector<Pair>& last);
  void addSelfContacts(const Session& session);
  bool addTraining(const SessionAvatar& avatar);

  std::vector<StageTimes> stages_;
  std::vector<Pair> touching_, meeting_;  // sorted pairs of the last frame: with props, of avatars
  std::vector<Pair> now_;
  std::vector<long long> contactsOf_;  // of each avatar
  long long avatarTouches_ = 0;
  std::vector<std::uint8_t> touched_;  // one flag per prop
  long long contacts_ = 0;
  long long touches_ = 0;
  std::optional<Training> training_;
  std::vector<SelfContacts> selfContacts_;  // of each avatar; empty if not requested
  std::optional<double> start_;             // time of the session's first frame [s]
};

/// Messages and statistics of a live performance.
class LiveLog {
 public:
  /// Adds a frame whose hulls have been posed; tells the host what changes in front of the camera.
  /// @param seconds  since the first frame [s]
  void add(const LiveJoints& joints, double seconds, Host& host);

  /// For the caption: "no person is visible", "the sensor is unplugged", what to do where person and room
  /// cannot be told apart, or empty.
  [[nodiscard]] std::string state() const;

  struct Figures {
    std::vector<double> track, latency;  ///< [us], of the images whose joints were used
    int frames = 0;                      ///< tracked images
    int followed = 0;                    ///< images with a person
    int maxPeople = 0;
    int unplugs = 0;
    std::optional<double> firstPose;  ///< since the first frame [s]
  };
  [[nodiscard]] const Figures& figures() const { return figures_; }

 private:
  Figures figures_;
  bool unplugged_ = false, sent_ = false;
  bool wasFollowed_ = false;
  bool wasUncertain_ = false;
};

/// The hits of a run's targets, counted frame by frame. Without targets it does nothing.
class TargetHits {
 public:
  explicit TargetHits(std::vector<HitTarget> targets);

  /// Adds the session's last frame.
  void add(const Session& session);

  /// Of each target.
  [[nodiscard]] std::span<const TargetScore> scores() const { return scores_; }
  /// For the caption of a picture: "   hits: bag 5, board 0"; empty without targets.
  [[nodiscard]] std::string caption() const;
  [[nodiscard]] const HitCounter& counter() const { return counter_; }

 private:
  HitCounter counter_;
  std::vector<TargetScore> scores_;
  std::optional<ContactEvents> events_;
};

}  // namespace lorica
