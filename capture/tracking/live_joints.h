#pragma once

#include "capture/tracking/depth_joints.h"

#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

namespace lorica {

/// Runs DepthJoints on its own thread: every image of a live camera is tracked, however long the caller takes to draw.
/// next() returns the latest joints; joints not fetched in time are skipped.
class LiveJoints final : public SkeletonSource {
 public:
  /// Starts tracking.
  explicit LiveJoints(DepthJoints joints);
  ~LiveJoints() override;
  LiveJoints(const LiveJoints&) = delete;
  LiveJoints& operator=(const LiveJoints&) = delete;

  /// Waits for joints newer than those of the last call.
  [[nodiscard]] Result<std::optional<SkeletonFrame>> next() override;

  /// Whether the last next() was the end.
  [[nodiscard]] bool ended() const { return ended_; }
  /// Whether next() would return without waiting.
  [[nodiscard]] bool ready() const;

  [[nodiscard]] const DepthSource& source() const { return joints_.source(); }
  /// Of the last next().
  [[nodiscard]] const DepthSight& sight() const { return sight_; }
  /// Number of images tracked up to the last next(), and of those that showed a person.
  [[nodiscard]] int frameCount() const { return frameCount_; }
  [[nodiscard]] int followedCount() const { return followedCount_; }

 private:
  void run();

  DepthJoints joints_;  ///< used by the thread only

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<Result<std::optional<SkeletonFrame>>> latest_;  ///< empty once it was returned
  DepthSight latestSight_;
  int latestFrameCount_ = 0, latestFollowedCount_ = 0;
  bool stop_ = false;

  DepthSight sight_;  ///< used by the caller only
  int frameCount_ = 0, followedCount_ = 0;
  bool ended_ = false;
  std::thread thread_;
};

/// The joints of a further place, see DepthSight::places: those of the last next() of the first place's source.
/// @param joints  of several people; outlives the source
/// @param place   from 1
[[nodiscard]] std::unique_ptr<SkeletonSource> makePlaceSource(const LiveJoints& joints, std::size_t place);

}  // namespace lorica
