#include "capture/tracking/live_joints.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <thread>

namespace lorica {
namespace {

/// A given number of images of an empty room, one every 5 ms.
class Clockwork final : public DepthSource {
 public:
  Clockwork(int frames, bool breaks, std::shared_ptr<std::atomic<int>> reads)
      : frames_(frames), breaks_(breaks), reads_(std::move(reads)) {
    camera_.width = 320, camera_.height = 240;
  }
  const DepthCamera& camera() const override { return camera_; }
  std::string name() const override { return "clockwork"; }
  Result<DepthRead> next(DepthFrame& frame) override {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (reads_ != nullptr) ++*reads_;
    if (frame_ == frames_ && breaks_) return Error{ErrorCode::kUnreadable, "broken"};
    if (frame_ == frames_) return DepthRead::kEnd;
    frame.time = 0.005 * ++frame_;
    frame.depthMm.assign(320 * 240, 0);
    return DepthRead::kFrame;
  }

 private:
  DepthCamera camera_;
  int frames_, frame_ = 0;
  bool breaks_;
  std::shared_ptr<std::atomic<int>> reads_;  // may be null
};

DepthJoints following(int frames, bool breaks = false, std::shared_ptr<std::atomic<int>> reads = nullptr) {
  auto source = std::make_unique<Clockwork>(frames, breaks, std::move(reads));
  Tracker tracker = Tracker::create(source->camera()).value();
  return {std::move(source), std::move(tracker)};
}

TEST(LiveJoints, ASlowCallerGetsTheLatestAndEveryImageIsTracked) {
  const auto reads = std::make_shared<std::atomic<int>>(0);
  LiveJoints joints(following(60, false, reads));
  double last = 0.0;
  int asked = 0;
  while (true) {
    const int slow = std::min(*reads + 8, 61);  // images later; the last read is the end
    while (*reads < slow) std::this_thread::yield();
    const Result<std::optional<SkeletonFrame>> frame = joints.next();
    ASSERT_TRUE(frame.ok());
    if (!frame->has_value()) break;
    EXPECT_GT((*frame)->time, last);
    EXPECT_EQ((*frame)->time, joints.sight().image.time) << "joints and image are of the same frame";
    last = (*frame)->time;
    ++asked;
  }
  EXPECT_EQ(joints.frameCount(), 60);
  EXPECT_LT(asked, 60);
  EXPECT_FALSE(joints.next()->has_value()) << "the end is returned again";
}

TEST(LiveJoints, ErrorsReachTheCaller) {
  LiveJoints joints(following(3, true));
  Result<std::optional<SkeletonFrame>> frame = joints.next();
  while (frame.ok()) frame = joints.next();
  EXPECT_EQ(frame.error().message, "broken");
}

TEST(LiveJoints, MayBeLeftAtAnyTime) {
  for (const int images : {0, 1, 3}) {
    const auto reads = std::make_shared<std::atomic<int>>(0);
    {
      LiveJoints joints(following(1'000'000, false, reads));
      while (*reads < images) std::this_thread::yield();
    }
    // The thread has ended: no image is read after the destructor.
    const int before = reads->load();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_EQ(reads->load(), before);
    EXPECT_LT(before, 1'000'000);
  }
}

}  // namespace
}  // namespace lorica
