#include "capture/retarget/foot_contacts.h"

#include "geometry/result.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lorica {
namespace {

constexpr double kUsualLeg = 0.85;
/// Of ankle or ball, to begin and to go on standing [m/s].
constexpr double kSlow = 0.30;
constexpr double kStillSlow = 0.45;
/// Of the sole's lowest point above the floor, likewise [m].
constexpr double kLow = 0.06;
constexpr double kStillLow = 0.09;
/// A foot that rests in the air [m/s], [s].
constexpr double kResting = 0.08;
constexpr double kRestSeconds = 0.25;
/// Sightings shorter than this are no stance, gaps shorter than this no step [s].
constexpr double kShortestStance = 0.06;
constexpr double kShortestStep = 0.06;

}  // namespace

double floorUnder(std::span<const FootPlace> left, std::span<const FootPlace> right) {
  CHECK(left.size() == right.size() && !left.empty(), "one place a frame and foot");
  std::vector<double> lowest;
  lowest.reserve(left.size());
  for (std::size_t f = 0; f < left.size(); ++f) lowest.push_back(std::min(left[f].lowest, right[f].lowest));
  constexpr double kSeldom = 0.05;
  const auto at = lowest.begin() + static_cast<std::ptrdiff_t>(kSeldom * static_cast<double>(lowest.size() - 1));
  std::nth_element(lowest.begin(), at, lowest.end());
  return *at;
}

std::vector<FootContact> contactsOf(std::span<const FootPlace> places, std::span<const double> times, double floor,
                                    double legLength) {
  CHECK(places.size() == times.size(), "one place a frame");
  const double scale = legLength / kUsualLeg;
  const auto count = static_cast<int>(places.size());
  const auto at = [](int i) { return static_cast<std::size_t>(i); };
  // Speed over the slower of the two steps beside a frame.
  std::vector<double> slower(places.size(), std::numeric_limits<double>::infinity());   // of ankle or ball
  std::vector<double> resting(places.size(), std::numeric_limits<double>::infinity());  // of both
  if (count == 1) slower[0] = resting[0] = 0.0;
  for (int f = 1; f < count; ++f) {
    const double step = std::max(times[at(f)] - times[at(f - 1)], 1e-4) * scale;
    const double ankle = (places[at(f)].ankle - places[at(f - 1)].ankle).norm() / step;
    const double ball = (places[at(f)].ball - places[at(f - 1)].ball).norm() / step;
    for (const int frame : {f - 1, f}) {
      slower[at(frame)] = std::min(slower[at(frame)], std::min(ankle, ball));
      resting[at(frame)] = std::min(resting[at(frame)], std::max(ankle, ball));
    }
  }

  const auto secondsOf = [&](int first, int last) { return times[at(last)] - times[at(first)]; };
  std::vector<bool> stands(places.size(), false);
  bool standing = false;
  for (int f = 0; f < count; ++f) {
    const double height = (places[at(f)].lowest - floor) / scale;
    standing = standing ? slower[at(f)] < kStillSlow && height < kStillLow : slower[at(f)] < kSlow && height < kLow;
    stands[at(f)] = standing;
  }
  // What goes on standing also begins so: the same the other way round.
  standing = false;
  for (int f = count - 1; f >= 0; --f) {
    const double height = (places[at(f)].lowest - floor) / scale;
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
        (places[at(f)].ankle - places[at(contacts.back().last)].ankle).norm() < 0.02 * scale) {
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
