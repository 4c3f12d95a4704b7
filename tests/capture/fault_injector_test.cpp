#include "capture/fault_injector.h"

#include "capture/files/joint_csv.h"
#include "tests/support/allocations.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace lorica {
namespace {

using J = BodyJoint;
constexpr int kFrames = 20000;
constexpr double kStep = 1.0 / 30.0;

/// Frames marked with their number: in every joint position x is the frame, y the joint.
std::vector<SkeletonFrame> marked(int count) {
  std::vector<SkeletonFrame> frames(static_cast<std::size_t>(count));
  for (std::size_t f = 0; f < frames.size(); ++f) {
    frames[f].time = static_cast<double>(f) * kStep;
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      frames[f].joints[j] = {Vec3(static_cast<double>(f), static_cast<double>(j), 0.0), Quat::Identity(), 1.0};
    }
  }
  return frames;
}

std::vector<SkeletonFrame> withFaults(const std::string& text, std::vector<SkeletonFrame> frames) {
  const Result<FaultSettings> settings = parseFaults(text);
  EXPECT_TRUE(settings.ok()) << text;
  const std::unique_ptr<SkeletonSource> source = makeFaultInjector(makeRecordedSource(std::move(frames)), *settings);
  std::vector<SkeletonFrame> got;
  while (true) {
    Result<std::optional<SkeletonFrame>> frame = source->next();
    EXPECT_TRUE(frame.ok());
    if (!frame || !frame->has_value()) return got;
    got.push_back(**frame);
  }
}

bool sameFrame(const SkeletonFrame& a, const SkeletonFrame& b) {
  if (a.time != b.time) return false;
  for (std::size_t j = 0; j < kBodyJointCount; ++j) {
    const TrackedJoint &p = a.joints[j], &q = b.joints[j];
    if (p.position != q.position || p.confidence != q.confidence ||
        p.orientation.has_value() != q.orientation.has_value()) {
      return false;
    }
  }
  return true;
}

bool same(const std::vector<SkeletonFrame>& a, const std::vector<SkeletonFrame>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), sameFrame);
}

int frameShown(const SkeletonFrame& frame) {
  return static_cast<int>(std::lround(frame[J::kTorso].position.x()));
}

TEST(FaultInjector, NoFaultsPassEverythingOn) {
  const std::vector<SkeletonFrame> frames = marked(100);
  EXPECT_TRUE(same(withFaults("dropout=0,jitter=0,seed=3", frames), frames));
}

TEST(FaultInjector, AsManyJointsAreLostAsAskedForInRunsOfFiveFrames) {
  for (const double share : {0.02, 0.1, 0.5, 0.9}) {
    const std::vector<SkeletonFrame> got = withFaults("dropout=" + std::to_string(share) + ",seed=11", marked(kFrames));
    ASSERT_EQ(got.size(), static_cast<std::size_t>(kFrames));
    int lost = 0, runs = 0;
    for (std::size_t f = 0; f < got.size(); ++f) {
      for (std::size_t j = 0; j < kBodyJointCount; ++j) {
        const TrackedJoint& joint = got[f].joints[j];
        ASSERT_TRUE(joint.confidence == 0.0 || joint.confidence == 1.0);
        if (joint.confidence > 0.0) continue;
        ASSERT_FALSE(joint.orientation.has_value());
        ++lost;
        runs += f == 0 || got[f - 1].joints[j].confidence > 0.0 ? 1 : 0;
      }
    }
    const double samples = static_cast<double>(kFrames) * kBodyJointCount;
    // Samples of a run are not independent: the deviation of the fraction is about three times that of a coin.
    EXPECT_NEAR(lost / samples, share, 12.0 * std::sqrt(share * (1.0 - share) / samples)) << share;
    EXPECT_NEAR(static_cast<double>(lost) / runs, share <= 0.5 ? 5.0 : 9.0, 0.5) << share;
  }
}

TEST(FaultInjector, JitterHasTheDeviationThatWasAskedForAndNoBias) {
  std::vector<SkeletonFrame> frames = marked(kFrames);
  for (SkeletonFrame& frame : frames) frame[J::kHead].confidence = 0.0;
  const std::vector<SkeletonFrame> got = withFaults("jitter=0.02", frames);
  Vec3 sum = Vec3::Zero(), squares = Vec3::Zero();
  int count = 0;
  for (std::size_t f = 0; f < got.size(); ++f) {
    EXPECT_EQ(got[f][J::kHead].position, frames[f][J::kHead].position);  // unknown joints stay unknown
    for (std::size_t j = 1; j < kBodyJointCount; ++j) {
      const Vec3 moved = got[f].joints[j].position - frames[f].joints[j].position;
      sum += moved;
      squares += moved.cwiseAbs2();
      ++count;
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(sum[axis] / count, 0.0, 5.0 * 0.02 / std::sqrt(count));
    EXPECT_NEAR(std::sqrt(squares[axis] / count), 0.02, 0.0002);
  }
}

TEST(FaultInjector, SwappedFramesExchangeWholeLimbsAndNothingElse) {
  const std::vector<SkeletonFrame> got = withFaults("swap=0.2", marked(kFrames));
  int swapped = 0, arms = 0, legs = 0, runs = 0;
  bool before = false;
  for (const SkeletonFrame& frame : got) {
    const auto shows = [&](J position, J joint) { return frame[position].position.y() == static_cast<double>(joint); };
    const bool arm = shows(J::kLeftHand, J::kRightHand), leg = shows(J::kRightKnee, J::kLeftKnee);
    for (const auto& [left, right] :
         {std::pair(J::kLeftShoulder, J::kRightShoulder), std::pair(J::kLeftElbow, J::kRightElbow),
          std::pair(J::kLeftHand, J::kRightHand)}) {
      ASSERT_TRUE(shows(left, arm ? right : left) && shows(right, arm ? left : right));
    }
    for (const auto& [left, right] : {std::pair(J::kLeftHip, J::kRightHip), std::pair(J::kLeftKnee, J::kRightKnee),
                                      std::pair(J::kLeftFoot, J::kRightFoot)}) {
      ASSERT_TRUE(shows(left, leg ? right : left) && shows(right, leg ? left : right));
    }
    ASSERT_TRUE(shows(J::kHead, J::kHead) && shows(J::kNeck, J::kNeck) && shows(J::kTorso, J::kTorso));
    swapped += arm || leg ? 1 : 0;
    arms += arm ? 1 : 0;
    legs += leg ? 1 : 0;
    runs += (arm || leg) && !before ? 1 : 0;
    before = arm || leg;
  }
  EXPECT_NEAR(static_cast<double>(swapped) / kFrames, 0.2, 0.03);
  EXPECT_NEAR(static_cast<double>(swapped) / runs, 10.0, 1.5);
  EXPECT_NEAR(static_cast<double>(arms) / swapped, 2.0 / 3.0, 0.1);
  EXPECT_NEAR(static_cast<double>(legs) / swapped, 2.0 / 3.0, 0.1);
}

TEST(FaultInjector, LateFramesComeLateAndTheOnesTheyOvertakeAreLost) {
  const std::vector<SkeletonFrame> got = withFaults("late=0.1", marked(kFrames));
  int late = 0;
  for (std::size_t i = 0; i < got.size(); ++i) {
    const double lateness = got[i].time - frameShown(got[i]) * kStep;
    if (i > 0) {
      ASSERT_GT(got[i].time, got[i - 1].time);
      // The next frame is the first one that was not due by then.
      ASSERT_EQ(frameShown(got[i]), static_cast<int>(std::floor(got[i - 1].time / kStep + 1e-9)) + 1);
    }
    if (lateness == 0.0) continue;
    ++late;
    ASSERT_GE(lateness, 0.03 - 1e-9);
    ASSERT_LE(lateness, 0.15 + 1e-9);
  }
  const auto count = static_cast<double>(got.size());
  EXPECT_NEAR(late / count, 0.1, 5.0 * std::sqrt(0.09 / count));
  EXPECT_LT(got.size(), 0.9 * kFrames);
}

TEST(FaultInjector, FrozenFramesRepeatTheLastWhileTimeGoesOn) {
  const std::vector<SkeletonFrame> got = withFaults("freeze=0.25", marked(kFrames));
  ASSERT_EQ(got.size(), static_cast<std::size_t>(kFrames));
  int frozen = 0, runs = 0;
  for (std::size_t f = 0; f < got.size(); ++f) {
    ASSERT_EQ(got[f].time, static_cast<double>(f) * kStep);
    const bool still = frameShown(got[f]) != static_cast<int>(f);
    if (!still) continue;
    ASSERT_EQ(frameShown(got[f]), frameShown(got[f - 1]));
    ++frozen;
    runs += frameShown(got[f]) == static_cast<int>(f) - 1 ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(frozen) / kFrames, 0.25, 0.04);
  EXPECT_NEAR(static_cast<double>(frozen) / runs, 15.0, 2.5);
}

TEST(FaultInjector, TheSameSeedGivesTheSameFaultsAndAnotherOthers) {
  const std::vector<SkeletonFrame> frames = marked(500);
  const std::string all = "dropout=0.1,jitter=0.02,swap,late,freeze,seed=";
  EXPECT_TRUE(same(withFaults(all + "7", frames), withFaults(all + "7", frames)));
  EXPECT_FALSE(same(withFaults(all + "7", frames), withFaults(all + "8", frames)));
}

TEST(FaultInjector, OneMoreFaultLeavesTheOthersWhereTheyWere) {
  const std::vector<SkeletonFrame> few = withFaults("dropout,seed=5", marked(300));
  const std::vector<SkeletonFrame> more = withFaults("dropout,jitter,freeze=0.5,seed=5", marked(300));
  ASSERT_EQ(few.size(), more.size());
  for (std::size_t f = 0; f < few.size(); ++f) {
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      ASSERT_EQ(few[f].joints[j].confidence, more[f].joints[j].confidence);
    }
  }
}

/// Returns an error at its third frame.
class Failing final : public SkeletonSource {
 public:
  Result<std::optional<SkeletonFrame>> next() override {
    if (++count_ == 3) return Error{ErrorCode::kUnreadable, "the cable is out"};
    SkeletonFrame frame;
    frame.time = count_ * 1e-3;
    return std::optional<SkeletonFrame>(frame);
  }

 private:
  int count_ = 0;
};

/// Returns frames forever, none later than the previous one, as the source of a second person does within a step.
class Stuck final : public SkeletonSource {
 public:
  explicit Stuck(int& reads) : reads_(reads) {}
  Result<std::optional<SkeletonFrame>> next() override {
    ++reads_;
    return std::optional<SkeletonFrame>(SkeletonFrame());
  }

 private:
  int& reads_;
};

TEST(FaultInjector, AnErrorAfterALateFrameIsStillReported) {
  const Result<FaultSettings> always = parseFaults("late=1");
  const std::unique_ptr<SkeletonSource> source = makeFaultInjector(std::make_unique<Failing>(), *always);
  ASSERT_TRUE(source->next().ok());
  const Result<std::optional<SkeletonFrame>> second = source->next();
  ASSERT_FALSE(second.ok());
  EXPECT_EQ(second.error().message, "the cable is out");
}

TEST(FaultInjector, ASourceWhoseTimeStandsStillIsReadOnceMore) {
  const Result<FaultSettings> always = parseFaults("late=1");
  int reads = 0;
  const std::unique_ptr<SkeletonSource> source = makeFaultInjector(std::make_unique<Stuck>(reads), *always);
  EXPECT_TRUE(source->next().ok());
  EXPECT_EQ(reads, 2) << "each is recorded: 1,001 of them in a step filled 922 MB in 15 minutes";
}

TEST(FaultInjector, AFrameAllocatesNothing) {
  const Result<FaultSettings> all = parseFaults("dropout,jitter,swap,late,freeze");
  const std::unique_ptr<SkeletonSource> source = makeFaultInjector(makeRecordedSource(marked(200)), *all);
  ASSERT_TRUE(source->next().ok());
  const long before = test::allocationCount();
  for (int f = 0; f < 100; ++f) (void)source->next().ok();
  EXPECT_EQ(test::allocationCount(), before);
}

TEST(Faults, TextSaysDosesAndDefaults) {
  const FaultSettings some = test::valueOf(parseFaults("dropout=0.3,swap,seed=18446744073709551615"));
  EXPECT_EQ(some.dropout, 0.3);
  EXPECT_EQ(some.swap, 0.02);
  EXPECT_EQ(some.jitter, 0.0);
  EXPECT_EQ(some.seed, 18446744073709551615u);
  const FaultSettings defaults = test::valueOf(parseFaults("dropout,jitter,swap,late,freeze"));
  EXPECT_EQ(textOf(defaults), "dropout=0.1,jitter=0.02,swap=0.02,late=0.05,freeze=0.05,seed=1");
  EXPECT_EQ(textOf(FaultSettings()), "");
  FaultSettings odd;
  odd.jitter = 0.1 / 3.0;
  odd.seed = 12;
  const FaultSettings again = test::valueOf(parseFaults(textOf(odd)));
  EXPECT_EQ(again.jitter, odd.jitter);
  EXPECT_EQ(again.seed, odd.seed);
}

TEST(Faults, WrongTextGetsASentence) {
  const auto sentence = [](const char* text) {
    const Result<FaultSettings> settings = parseFaults(text);
    return settings ? std::string("none") : settings.error().message;
  };
  EXPECT_EQ(
      sentence("dropuot=0.1"),
      "found `dropuot=0.1`, expected dropout, jitter, swap, late, freeze or seed, for example dropout=0.1,swap,seed=7");
  EXPECT_EQ(sentence(""),
            "found ``, expected dropout, jitter, swap, late, freeze or seed, for example dropout=0.1,swap,seed=7");
  EXPECT_EQ(sentence("swap,"),
            "found ``, expected dropout, jitter, swap, late, freeze or seed, for example dropout=0.1,swap,seed=7");
  EXPECT_EQ(sentence("dropout=1.5"),
            "found `dropout=1.5`, expected a fraction of joints from 0 to 1, for example dropout=0.1");
  EXPECT_EQ(sentence("jitter=2cm"), "found `jitter=2cm`, expected metres from 0 to 1, for example jitter=0.02");
  EXPECT_EQ(sentence("jitter=nan"), "found `jitter=nan`, expected metres from 0 to 1, for example jitter=0.02");
  EXPECT_EQ(sentence("late=-0.1"),
            "found `late=-0.1`, expected a fraction of frames from 0 to 1, for example late=0.05");
  EXPECT_EQ(sentence("late=,swap"), "found `late=`, expected a fraction of frames from 0 to 1, for example late=0.05");
  EXPECT_EQ(sentence("swap,late,swap=0.1"), "found `swap=0.1`, expected swap only once");
  EXPECT_EQ(sentence("seed"), "found `seed`, expected a whole number of at least 0, for example seed=7");
  EXPECT_EQ(sentence("swap,seed=-1"), "found `seed=-1`, expected a whole number of at least 0, for example seed=7");
}

}  // namespace
}  // namespace lorica
