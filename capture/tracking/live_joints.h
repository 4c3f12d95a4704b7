#pragma once

#include "capture/tracking/depth_joints.h"

#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

namespace lorica {

/// DepthJoints on a thread of its own: every image of a live camera is followed, however long whoever asks takes to
/// draw. Asking gives the latest joints; those that nobody asked for in time are passed over.
class LiveJoints final : public SkeletonSource {
 public:
  /// Begins to follow.
  explicit LiveJoints(DepthJoints joints);
  ~LiveJoints() override;
  LiveJoints(const LiveJoints&) = delete;
  LiveJoints& operator=(const LiveJoints&) = delete;

  /// Waits for joints later than those of the last call.
  [[nodiscard]] Result<std::optional<SkeletonFrame>> next() override;

  /// Whether next() would not wait.
  [[nodiscard]] bool ready() const;

  [[nodiscard]] const DepthSource& source() const { return joints_.source(); }
  /// Of the last next().
  [[nodiscard]] const DepthSight& sight() const { return sight_; }
  /// How many images were followed up to the last next(), and in how many of them there was a person.
  [[nodiscard]] int frameCount() const { return frameCount_; }
  [[nodiscard]] int followedCount() const { return followedCount_; }

 private:
  void run();

  DepthJoints joints_;  ///< the thread's

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Result<std::optional<SkeletonFrame>>> latest_;  ///< nothing while it was given already
  DepthSight latestSight_;
  int latestFrameCount_ = 0, latestFollowedCount_ = 0;
  bool stop_ = false;

  DepthSight sight_;  ///< the asker's
  int frameCount_ = 0, followedCount_ = 0;
  std::thread thread_;
};

}  // namespace lorica
