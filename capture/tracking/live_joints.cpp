#include "capture/tracking/live_joints.h"

#include <utility>

namespace lorica {

LiveJoints::LiveJoints(DepthJoints joints) : joints_(std::move(joints)), thread_([this] { run(); }) {}

LiveJoints::~LiveJoints() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  thread_.join();
}

void LiveJoints::run() {
  while (true) {
    Result<std::optional<SkeletonFrame>> got = joints_.next();
    const bool last = !got || !got->has_value();
    {
      const std::lock_guard lock(mutex_);
      if (stop_) return;
      latest_ = std::move(got);
      latestSight_ = joints_.sight();
      if (latestSight_.read == DepthRead::kFrame) ++latestFrameCount_;
      if (latestSight_.followed) ++latestFollowedCount_;
    }
    changed_.notify_one();
    if (last) return;
  }
}

Result<std::optional<SkeletonFrame>> LiveJoints::next() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return latest_.has_value(); });
  Result<std::optional<SkeletonFrame>> given = *latest_;
  // The end and errors stay: later calls return them again.
  if (given && given->has_value()) {
    latest_.reset();
    std::swap(sight_, latestSight_);  // the other's storage is reused for the next image
  }
  ended_ = !given || !given->has_value();
  frameCount_ = latestFrameCount_;
  followedCount_ = latestFollowedCount_;
  return given;
}

namespace {

class PlaceJoints final : public SkeletonSource {
 public:
  PlaceJoints(const LiveJoints& joints, std::size_t place) : joints_(joints), place_(place) {}

  Result<std::optional<SkeletonFrame>> next() override {
    const std::vector<SkeletonFrame>& places = joints_.sight().places;
    if (joints_.ended() || place_ >= places.size()) return std::optional<SkeletonFrame>();
    return std::optional(places[place_]);
  }

 private:
  const LiveJoints& joints_;
  std::size_t place_;
};

}  // namespace

std::unique_ptr<SkeletonSource> makePlaceSource(const LiveJoints& joints, std::size_t place) {
  return std::make_unique<PlaceJoints>(joints, place);
}

bool LiveJoints::ready() const {
  const std::lock_guard lock(mutex_);
  return latest_.has_value();
}

}  // namespace lorica
