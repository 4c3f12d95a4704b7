#include "capture/streams/frame_pace.h"

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

constexpr double kMeanShare = 1.0 / 16.0;
constexpr double kPause = 0.5;  ///< [s]

}  // namespace

double FramePace::due(double arrival) {
  if (!last_ || arrival - *last_ > kPause) {
    expected_ = arrival;
  } else {
    const double step = arrival - *last_;
    meanStep_ += meanStep_ == 0.0 ? step : kMeanShare * (step - meanStep_);
    jitter_ += kMeanShare * (std::abs(step - meanStep_) - jitter_);
    expected_ += meanStep_;
    expected_ += kMeanShare * (arrival - expected_);
  }
  last_ = arrival;
  if (delay_ > 0.0 && expected_ + delay_ < arrival) ++late_;
  due_ = std::max({due_, arrival, delay_ > 0.0 ? expected_ + delay_ : arrival});
  return due_;
}

}  // namespace lorica
