#include "bench/tracking_errors.h"

#include "bench/measure.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lorica::bench {
namespace {

using J = BodyJoint;

constexpr std::array kLimbs = {J::kLeftElbow, J::kRightElbow, J::kLeftHand, J::kRightHand,
                               J::kLeftKnee,  J::kRightKnee,  J::kLeftFoot, J::kRightFoot};
constexpr std::array<std::pair<J, J>, 6> kSides = {{{J::kLeftShoulder, J::kRightShoulder},
                                                    {J::kLeftElbow, J::kRightElbow},
                                                    {J::kLeftHand, J::kRightHand},
                                                    {J::kLeftHip, J::kRightHip},
                                                    {J::kLeftKnee, J::kRightKnee},
                                                    {J::kLeftFoot, J::kRightFoot}}};
constexpr std::size_t kSteadyFrames = 5;

double percent(double part, double whole) {
  return whole > 0.0 ? 100.0 * part / whole : 0.0;
}

}  // namespace

double JointErrors::mean() const {
  double sum = 0.0;
  for (const double d : distance) sum += d;
  return sum / kBodyJointCount;
}

bool JointErrors::limbWrong() const {
  return !tracked ||
         std::ranges::any_of(kLimbs, [&](J joint) { return distance[static_cast<std::size_t>(joint)] > kWrong; });
}

JointErrors errorsOf(const SkeletonFrame& truth, bool visible, const std::optional<SkeletonFrame>& tracked) {
  JointErrors result;
  result.time = truth.time;
  result.visible = visible;
  result.tracked = tracked.has_value();
  if (!tracked) return result;
  for (std::size_t j = 0; j < kBodyJointCount; ++j) {
    result.distance[j] = (tracked->joints[j].position - truth.joints[j].position).norm();
    result.sure[j] = tracked->joints[j].confidence >= 0.5;
  }
  double straight = 0.0, swapped = 0.0;
  for (const auto& [left, right] : kSides) {
    straight += ((*tracked)[left].position - truth[left].position).norm() +
                ((*tracked)[right].position - truth[right].position).norm();
    swapped += ((*tracked)[left].position - truth[right].position).norm() +
               ((*tracked)[right].position - truth[left].position).norm();
  }
  result.sidesSwapped = swapped < straight;
  return result;
}

ErrorSummary summaryOf(std::span<const std::vector<JointErrors>> runs, double from) {
  ErrorSummary result;
  std::vector<double> distances;
  double tracked = 0.0, limbWrong = 0.0, sure = 0.0, sureWrong = 0.0, swapped = 0.0;
  for (const std::vector<JointErrors>& run : runs) {
    for (const JointErrors& frame : run) {
      if (!frame.visible || frame.time < from) continue;
      ++result.frames;
      limbWrong += frame.limbWrong() ? 1.0 : 0.0;
      if (!frame.tracked) continue;
      tracked += 1.0;
      swapped += frame.sidesSwapped ? 1.0 : 0.0;
      for (std::size_t j = 0; j < kBodyJointCount; ++j) {
        distances.push_back(1000.0 * frame.distance[j]);
        if (!frame.sure[j]) continue;
        sure += 1.0;
        sureWrong += frame.distance[j] > kWrong ? 1.0 : 0.0;
      }
    }
  }
  result.trackedPercent = percent(tracked, result.frames);
  result.limbWrongPercent = percent(limbWrong, result.frames);
  result.sureWrongPercent = percent(sureWrong, sure);
  result.surePercent = percent(sure, tracked * kBodyJointCount);
  result.swappedPercent = percent(swapped, tracked);
  if (distances.empty()) return result;
  result.meanMm = meanOf(distances);
  result.medianMm = medianOf(distances);
  const auto p95 = static_cast<std::ptrdiff_t>(std::floor(0.95 * static_cast<double>(distances.size() - 1)));
  std::nth_element(distances.begin(), distances.begin() + p95, distances.end());
  result.p95Mm = distances[p95];
  return result;
}

std::optional<double> secondsToFollow(std::span<const JointErrors> frames, double from) {
  std::size_t steady = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (frames[i].time < from) continue;
    steady = frames[i].limbWrong() ? 0 : steady + 1;
    if (steady == kSteadyFrames) return std::max(0.0, frames[i + 1 - kSteadyFrames].time - from);
  }
  return std::nullopt;
}

}  // namespace lorica::bench
