#include "capture/retarget/foot_contacts.h"

#include "geometry/result.h"

#include <algorithm>
#include <limits>

namespace lorica {
namespace {

constexpr double kUsualLeg = 0.85;
/// Speed limits of ankle or ball to start and to continue standing [m/s].
constexpr double kSlow = 0.30;
constexpr double kStillSlow = 0.45;
/// Limits for the height of the sole's lowest point above the floor, likewise [m].
constexpr double kLow = 0.06;
constexpr double kStillLow = 0.09;
/// A foot at rest in the air: max speed [m/s], min duration [s].
constexpr double kResting = 0.08;
constexpr double kRestSeconds = 0.25;
/// Shorter contacts are no stance, shorter gaps no step [s].
constexpr double kShortestStance = 0.06;
constexpr double kShortestStep = 0.06;

}  // namespace

double floorUnder(std::span<const FootPosition> left, std::span<const FootPosition> right) {
  LORICA_CHECK(left.size() == right.size() && !left.empty(), "one position per frame and foot is required");
  std::vector<double> lowest;
  lowest.reserve(left.size());
  for (std::size_t f = 0; f < left.size(); ++f) lowest.push_back(std::min(left[f].lowest, right[f].lowest));
  constexpr double kSeldom = 0.05;
  const auto at = lowest.begin() + static_cast<std::ptrdiff_t>(kSeldom * static_cast<double>(lowest.size() - 1));
  std::nth_element(lowest.begin(), at, lowest.end());
  return *at;
}

std::vector<FootContact> contactsOf(std::span<const FootPosition> positions, std::span<const double> times,
                                    double floor, double legLength) {
  LORICA_CHECK(positions.size() == times.size(), "one position per frame is required");
  const double scale = legLength / kUsualLeg;
  const auto count = static_cast<int>(positions.size());
  const auto at = [](int i) { return static_cast<std::size_t>(i); };
  // For each frame, the lower speed of the two adjacent steps.
  std::vector<double> slower(positions.size(), std::numeric_limits<double>::infinity());   // of ankle or ball
  std::vector<double> resting(positions.size(), std::numeric_limits<double>::infinity());  // of both
  if (count == 1) slower[0] = resting[0] = 0.0;
  for (int f = 1; f < count; ++f) {
    const double step = std::max(times[at(f)] - times[at(f - 1)], 1e-4) * scale;
    const double ankle = (positions[at(f)].ankle - positions[at(f - 1)].ankle).norm() / step;
    const double ball = (positions[at(f)].ball - positions[at(f - 1)].ball).norm() / step;
    for (const int frame : {f - 1, f}) {
      slower[at(frame)] = std::min(slower[at(frame)], std::min(ankle, ball));
      resting[at(frame)] = std::min(resting[at(frame)], std::max(ankle, ball));
    }
  }

  const auto secondsOf = [&](int first, int last) { return times[at(last)] - times[at(first)]; };
  std::vector<bool> stands(positions.size(), false);
  bool standing = false;
  for (int f = 0; f < count; ++f) {
    const double height = (positions[at(f)].lowest - floor) / scale;
    standing = standing ? slower[at(f)] < kStillSlow && height < kStillLow : slower[at(f)] < kSlow && height < kLow;
    stands[at(f)] = standing;
  }
  // Backward pass: frames before a stance that meet the limits for continuing also belong to it.
  standing = false;
  for (int f = count - 1; f >= 0; --f) {
    const double height = (positions[at(f)].lowest - floor) / scale;
    standing = (stands[at(f)] || standing) && slower[at(f)] < kStillSlow && height < kStillLow;
    stands[at(f)] = stands[at(f)] || standing;
  }
  for (int f = 0; f < count; ++f) {
    int last = f;
    while (last + 1 < count && resting[at(last + 1)] < kResting) ++last;
    if (resting[at(f)] < kResting && secondsOf(f, last) >= kRestSeconds) {
      std::fill(stands.begin() + f, stands.begin() + last + 1, true);
    }
    f = last;
  }

  std::vector<FootContact> contacts;
  for (int f = 0; f < count; ++f) {
    if (!stands[at(f)]) continue;
    int last = f;
    while (last + 1 < count && stands[at(last + 1)]) ++last;
    if (!contacts.empty() && secondsOf(contacts.back().last, f) < kShortestStep &&
        (positions[at(f)].ankle - positions[at(contacts.back().last)].ankle).norm() < 0.02 * scale) {
      contacts.back().last = last;
    } else {
      contacts.push_back({f, last});
    }
    f = last;
  }
  std::erase_if(contacts,
                [&](const FootContact& c) { return secondsOf(c.first, c.last) < kShortestStance && count > 1; });
  return contacts;
}

}  // namespace lorica
