#include "capture/fault_injector.h"

#include "geometry/errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <span>
#include <utility>
#include <vector>

namespace lorica {
namespace {

constexpr double kDropoutFrames = 5.0, kSwapFrames = 10.0, kFreezeFrames = 15.0;
constexpr double kMinLate = 0.03, kMaxLate = 0.15;  ///< [s]

/// Each fault has its own random stream, so adding a fault leaves the others unchanged.
enum Stream : std::uint64_t { kLateStream, kFreezeStream, kSwapStream, kJitterStream, kDropoutStream };

std::uint64_t seedOf(std::uint64_t seed, std::uint64_t stream) {
  return RandomNumbers(RandomNumbers(seed).bits() + stream).bits();
}

/// A fault as named in the text.
struct Named {
  std::string_view name;
  double FaultSettings::*dose;
  double byDefault;
  const char* unit;
};
constexpr std::array<Named, 5> kFaults = {
    {{"dropout", &FaultSettings::dropout, 0.1, "a fraction of joints from 0 to 1"},
     {"jitter", &FaultSettings::jitter, 0.02, "metres from 0 to 1"},
     {"swap", &FaultSettings::swap, 0.02, "a fraction of frames from 0 to 1"},
     {"late", &FaultSettings::late, 0.05, "a fraction of frames from 0 to 1"},
     {"freeze", &FaultSettings::freeze, 0.05, "a fraction of frames from 0 to 1"}}};

template <typename Number>
bool parseWhole(std::string_view text, Number& number) {
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && stopped == end;
}

Error unexpected(std::string_view found, std::string_view expected) {
  return invalidArgument("found `{}`, expected {}", found, expected);
}

bool isDose(double dose) {
  return dose >= 0.0 && dose <= 1.0;
}

Error unexpectedDose(std::string_view found, const Named& fault) {
  return unexpected(found, fmt::format("{}, for example {}={:g}", fault.unit, fault.name, fault.byDefault));
}

/// Parses one comma-separated entry.
Result<void> takeFault(std::string_view word, FaultSettings& settings, std::vector<std::string_view>& seen) {
  const std::size_t equals = word.find('=');
  const std::string_view name = word.substr(0, equals);
  const bool hasValue = equals != std::string_view::npos;
  const std::string_view value = hasValue ? word.substr(equals + 1) : std::string_view();
  if (std::find(seen.begin(), seen.end(), name) != seen.end()) {
    return unexpected(word, fmt::format("{} only once", name));
  }
  seen.push_back(name);
  if (name == "seed") {
    if (hasValue && parseWhole(value, settings.seed)) return {};
    return unexpected(word, "a whole number of at least 0, for example seed=7");
  }
  const auto* const fault =
      std::find_if(kFaults.begin(), kFaults.end(), [&](const Named& f) { return f.name == name; });
  if (fault == kFaults.end()) {
    return unexpected(word, "dropout, jitter, swap, late, freeze or seed, for example dropout=0.1,swap,seed=7");
  }
  double dose = fault->byDefault;
  if (hasValue && !(parseWhole(value, dose) && isDose(dose))) return unexpectedDose(word, *fault);
  settings.*(fault->dose) = dose;
  return {};
}

/// Approximately normal, without functions whose last bit differs between platforms: mean 0, standard deviation 1,
/// within +-6.
double normalFrom(RandomNumbers& random) {
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) sum += random.unit();
  return sum;
}

/// Exchanges joints of the left side with those of the right.
void exchange(std::span<const BodyJoint> lefts, SkeletonFrame& frame) {
  for (const BodyJoint left : lefts) std::swap(frame[left], frame[rightOf(left)]);
}

class FaultInjector final : public SkeletonSource {
 public:
  FaultInjector(std::unique_ptr<SkeletonSource> source, const FaultSettings& settings)
      : source_(std::move(source)),
        settings_(settings),
        frames_(settings),
        swap_(settings.swap, kSwapFrames, seedOf(settings.seed, kSwapStream)),
        jitter_(seedOf(settings.seed, kJitterStream)) {
    dropout_.reserve(kBodyJointCount);
    for (std::uint64_t j = 0; j < kBodyJointCount; ++j) {
      dropout_.emplace_back(settings.dropout, kDropoutFrames, seedOf(settings.seed, kDropoutStream + j));
    }
  }

  Result<std::optional<SkeletonFrame>> next() override {
    Result<std::optional<SkeletonFrame>> taken = take();
    if (!taken || !taken->has_value()) return taken;
    SkeletonFrame& frame = **taken;
    overtake(frame);
    freeze(frame);
    swap(frame);
    shake(frame);
    drop(frame);
    return taken;
  }

 private:
  Result<std::optional<SkeletonFrame>> take() {
    if (!ahead_) return source_->next();
    Result<std::optional<SkeletonFrame>> taken = std::move(*ahead_);
    ahead_.reset();
    return taken;
  }

  void overtake(SkeletonFrame& frame) {
    const double lateness = frames_.lateness();
    if (lateness == 0.0) return;
    double last = frame.time;
    frame.time += lateness;
    for (int i = 0; i < kMaxOvertaken; ++i) {
      ahead_ = take();
      if (!*ahead_ || !(*ahead_)->has_value()) return;
      const double time = (**ahead_)->time;
      if (time > frame.time) return;
      ahead_.reset();
      if (time <= last) return;  // the same frame again: a second person's source has no newer one in this step
      last = time;
    }
  }

  void freeze(SkeletonFrame& frame) {
    if (frames_.frozen() && shown_) {
      frame.joints = shown_->joints;
    } else {
      shown_ = frame;
    }
  }

  void swap(SkeletonFrame& frame) {
    if (!swap_.next()) {
      swapping_ = false;
      return;
    }
    if (!swapping_) which_ = 3.0 * swap_.random().unit();  // arms, legs or both
    swapping_ = true;
    if (which_ != 1) exchange(std::span(kLeftJoints).first<3>(), frame);
    if (which_ != 0) exchange(std::span(kLeftJoints).last<3>(), frame);
  }

  void shake(SkeletonFrame& frame) {
    if (settings_.jitter == 0.0) return;
    for (TrackedJoint& joint : frame.joints) {
      const double x = normalFrom(jitter_), y = normalFrom(jitter_), z = normalFrom(jitter_);
      if (joint.confidence > 0.0) joint.position += settings_.jitter * Vec3(x, y, z);
    }
  }

  void drop(SkeletonFrame& frame) {
    for (std::size_t j = 0; j < dropout_.size(); ++j) {
      if (dropout_[j].next()) frame.joints[j] = TrackedJoint();
    }
  }

  std::unique_ptr<SkeletonSource> source_;
  FaultSettings settings_;
  FrameFaults frames_;
  FaultRuns swap_;
  RandomNumbers jitter_;
  std::vector<FaultRuns> dropout_;  ///< one per joint
  std::optional<Result<std::optional<SkeletonFrame>>> ahead_;
  std::optional<SkeletonFrame> shown_;  ///< the last frame that was not frozen
  bool swapping_ = false;
  int which_ = 0;
};

}  // namespace

Result<FaultSettings> parseFaults(std::string_view text) {
  FaultSettings settings;
  std::vector<std::string_view> seen;
  while (true) {
    const std::size_t comma = text.find(',');
    LORICA_TRY_DO(takeFault(text.substr(0, comma), settings, seen));
    if (comma == std::string_view::npos) return settings;
    text.remove_prefix(comma + 1);
  }
}

Result<void> checkFaults(const FaultSettings& settings) {
  for (const Named& fault : kFaults) {
    const double dose = settings.*(fault.dose);
    if (!isDose(dose)) return unexpectedDose(fmt::format("{}={}", fault.name, dose), fault);
  }
  return {};
}

std::string textOf(const FaultSettings& settings) {
  if (!settings.any()) return "";
  std::string text;
  for (const Named& fault : kFaults) {
    const double dose = settings.*(fault.dose);
    if (dose > 0.0) text += fmt::format("{}={},", fault.name, dose);
  }
  text += fmt::format("seed={}", settings.seed);
  return text;
}

FaultRuns::FaultRuns(double share, double length, std::uint64_t seed) : random_(seed), share_(share) {
  if (share <= 0.0) return;
  // At equilibrium share * end = (1 - share) * begin.
  end_ = std::min(1.0 / length, (1.0 - share) / share);
  begin_ = share < 1.0 ? std::min(1.0, end_ * share / (1.0 - share)) : 1.0;
}

bool FaultRuns::next() {
  if (share_ <= 0.0) return false;
  const double dice = random_.unit();
  on_ = !started_ ? dice < share_ : on_ ? dice >= end_ : dice < begin_;
  started_ = true;
  return on_;
}

FrameFaults::FrameFaults(const FaultSettings& settings)
    : late_(settings.late),
      random_(seedOf(settings.seed, kLateStream)),
      freeze_(settings.freeze, kFreezeFrames, seedOf(settings.seed, kFreezeStream)) {}

double FrameFaults::lateness() {
  const bool late = random_.unit() < late_;
  const double lateness = random_.between(kMinLate, kMaxLate);
  return late ? lateness : 0.0;
}

std::unique_ptr<SkeletonSource> makeFaultInjector(std::unique_ptr<SkeletonSource> source,
                                                  const FaultSettings& settings) {
  LORICA_CHECK(source != nullptr, "a fault injector needs a joint source");
  return std::make_unique<FaultInjector>(std::move(source), settings);
}

}  // namespace lorica
