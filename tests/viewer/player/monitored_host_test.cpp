#include "viewer/player/monitored_host.h"

#include "geometry/clock.h"
#include "geometry/interrupt.h"
#include "viewer/player/window_texts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <random>
#include <thread>
#include <vector>

namespace lorica {
namespace {

TEST(MonitoredHost, AHalfDoneTaskIsHalfOfWhatItsStageHasForIt) {
  Host parent;
  MonitoredHost monitor(parent);
  EXPECT_EQ(monitor.progress().share, 0.0);
  EXPECT_EQ(monitor.progress().title(), "Loading");
  const Stage stage(monitor, 0.2, 0.6);
  EXPECT_DOUBLE_EQ(monitor.progress().share, 0.2);
  monitor.beginTask("Cutting", "");
  monitor.report(2, 2, -1.0);
  const double task = monitor.progress().share - 0.2;
  EXPECT_GT(task, 0.2);
  EXPECT_LT(task, 0.4);
  EXPECT_EQ(monitor.progress().title(), "Cutting");
  monitor.beginTask("Settling", "");
  monitor.report(1, 2, -1.0);
  const double rest = 0.4 - task;
  EXPECT_NEAR(monitor.progress().share, 0.2 + task + 0.5 * rest * task / 0.4, 1e-12) << "the same part of the rest";
}

TEST(WorkShare, WhatWasThereAlreadyIsNoWork) {
  WorkShare work;
  work.beginStage(0.0, 1.0);
  work.beginStage(0.0, 0.6);  // from a cache
  work.endStage();
  EXPECT_DOUBLE_EQ(work.share(), 0.6);
  EXPECT_EQ(work.worked(), 0.0);
  work.beginStage(0.6, 1.0);
  work.beginTask();
  work.report(1, 2);
  EXPECT_GT(work.worked(), 0.15);
  EXPECT_DOUBLE_EQ(work.worked(), work.share() - 0.6);
  work.report(7, 7, 0.25);
  EXPECT_DOUBLE_EQ(work.worked(), work.share() - 0.6) << "it never goes back";
  work.report(3, 7, 1.0);
  work.endStage();
  EXPECT_NEAR(work.worked(), 0.4, 1e-12) << "what the task did not report was work, too";
  work.endStage();
  EXPECT_DOUBLE_EQ(work.share(), 1.0);
}

/// Meshes whose work is what their size says, up to 40 %, each of one to three tasks; some are copies of others, which
/// cost nothing. Nobody's clock is asked.
TEST(WorkShare, TheTimeLeftIsRightWithinAFactorOfTwoAfterATenth) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int round = 0; round < 100; ++round) {
    std::vector<double> ends = {0.0};
    std::vector<double> seconds;  // of each
    for (int mesh = 0; mesh < 20; ++mesh) {
      const double size = std::exp(2.0 * unit(random));
      ends.push_back(ends.back() + size);
      seconds.push_back(mesh > 0 && unit(random) < 0.1 ? 0.0 : 3.0 * size * (0.8 + 0.4 * unit(random)));
    }
    const double all = std::accumulate(seconds.begin(), seconds.end(), 0.0);
    WorkShare work;
    double now = 0.0;
    work.beginStage(0.0, 1.0);
    const auto look = [&] {
      const std::optional<double> left = timeLeft(work.worked(), 1.0 - work.share(), now);
      if (now < 0.1 * all || now > 0.8 * all) return;
      ASSERT_TRUE(left.has_value()) << round;
      EXPECT_LT(*left, 2.0 * (all - now)) << round << " after " << now / all;
      EXPECT_GT(*left, 0.5 * (all - now)) << round << " after " << now / all;
    };
    for (std::size_t mesh = 0; mesh < seconds.size(); ++mesh) {
      work.beginStage(ends[mesh] / ends.back(), ends[mesh + 1] / ends.back());
      const int tasks = seconds[mesh] > 0.0 ? 1 + static_cast<int>(random() % 3) : 0;
      for (int task = 0; task < tasks; ++task) {
        // The first takes most of it, as cutting does.
        const double own = seconds[mesh] * (tasks == 1 ? 1.0 : task == 0 ? 0.8 : 0.2 / (tasks - 1));
        work.beginTask();
        for (int step = 1; step <= 10; ++step) {
          now += 0.1 * own;
          work.report(step, 10);
          look();
        }
      }
      work.endStage();
    }
  }
}

/// Works for a while: stages within stages, and tasks that report what they like.
void work(MonitoredHost& monitor, std::mt19937& random, int depth, const std::function<void()>& look) {
  const int pieces = 1 + static_cast<int>(random() % 3);
  for (int piece = 0; piece < pieces; ++piece) {
    if (depth > 0 && random() % 2 == 0) {
      const Stage stage(monitor, static_cast<double>(piece) / pieces, (piece + 1.0) / pieces);
      look();
      work(monitor, random, depth - 1, look);
    } else {
      monitor.beginTask("Task", "");
      for (int report = 0; report < 5; ++report) {
        const int done = static_cast<int>(random() % 14), total = static_cast<int>(random() % 12) - 1;
        monitor.report(done, total, -1.0);
        look();
      }
    }
  }
}

TEST(MonitoredHost, TheShareNeverGoesBackAndIsWholeAtTheEnd) {
  std::mt19937 random(5);
  for (int round = 0; round < 200; ++round) {
    Host parent;
    MonitoredHost monitor(parent);
    double before = 0.0;
    const auto look = [&] {
      const double share = monitor.progress().share;
      ASSERT_GE(share, before) << round;
      ASSERT_LE(share, 1.0) << round;
      before = share;
    };
    {
      const Stage all(monitor, 0.0, 1.0);
      work(monitor, random, 3, look);
    }
    EXPECT_NEAR(monitor.progress().share, 1.0, 1e-12) << round;
  }
}

TEST(WarningBoard, HoldsWhatComesAndGoesForASecond) {
  WarningBoard board;
  board.raise("limbs", "left hand lost", 10.0);
  board.update(10.0);
  ASSERT_EQ(board.sentences().size(), 1u);
  board.update(10.9);
  EXPECT_EQ(board.sentences().size(), 1u);
  // Raised in every other frame: it is shown all the time.
  for (int frame = 0; frame < 90; ++frame) {
    const double now = 10.0 + frame / 30.0;
    if (frame % 2 == 0) board.raise("limbs", "left hand lost", now);
    board.update(now);
    ASSERT_EQ(board.sentences().size(), 1u);
  }
  board.update(14.1);
  EXPECT_TRUE(board.sentences().empty());
}

TEST(WarningBoard, WhatComesBackIsHeldLonger) {
  WarningBoard board;
  // Every 3 s for a moment: after a few times it stays, instead of coming and going.
  std::vector<bool> shown;
  for (int tick = 0; tick < 600; ++tick) {
    const double now = 0.1 * tick;
    if (tick % 30 == 0) board.raise("limbs", "left hand lost", now);
    board.update(now);
    shown.push_back(!board.sentences().empty());
  }
  const auto changes = std::adjacent_find(shown.begin() + 80, shown.end(), std::not_equal_to<>());
  EXPECT_EQ(changes, shown.end());
  EXPECT_TRUE(shown.back());
  board.update(59.7 - 2.7 + WarningBoard::kLongestHold);
  EXPECT_TRUE(board.sentences().empty());
  // Later it is new.
  board.raise("limbs", "left hand lost", 100.0);
  board.update(100.0 + WarningBoard::kHoldSeconds);
  EXPECT_TRUE(board.sentences().empty());
}

TEST(WarningBoard, WordsChangeOncePerSecondAtMostAndKindsKeepTheirOrder) {
  WarningBoard board;
  board.raise("limbs", "a", 0.0);
  board.raise("training", "t", 0.1);
  board.raise("limbs", "b", 0.5);
  ASSERT_EQ(board.sentences().size(), 2u);
  EXPECT_EQ(board.sentences()[0], "a") << "too soon to be read";
  board.raise("limbs", "b", 1.0);
  EXPECT_EQ(board.sentences()[0], "b");
  EXPECT_EQ(board.sentences()[1], "t");
  board.update(1.2);
  ASSERT_EQ(board.sentences().size(), 1u);
  EXPECT_EQ(board.sentences()[0], "b");
}

TEST(BackgroundWork, WhatAsksWhetherToStopEndsWhenItIsCancelled) {
  Host parent;
  std::atomic<bool> began = false, ended = false;
  const std::function<Result<int>(Host&)> reading = [&](Host& host) -> Result<int> {
    while (!workStopped()) {
      began = true;
      std::this_thread::yield();
    }
    EXPECT_TRUE(host.cancelled());
    ended = true;
    return 7;
  };
  BackgroundWork<int> work(parent, reading);
  while (!began) std::this_thread::yield();
  EXPECT_FALSE(ended);
  work.cancel();
  std::optional<Result<int>> result;
  while (!result) result = work.take();
  EXPECT_TRUE(ended);
  ASSERT_FALSE(*result);
  EXPECT_EQ(result->error().code, ErrorCode::kCancelled);
  EXPECT_FALSE(workStopped()) << "of another thread";
}

TEST(InterruptScope, TheInnermostIsAsked) {
  const Interrupt yes = [] { return true; }, no = [] { return false; };
  EXPECT_FALSE(workStopped());
  const InterruptScope outer(&yes);
  EXPECT_TRUE(workStopped());
  EXPECT_FALSE(unlessStopped<int>(1));
  {
    const InterruptScope inner(&no);
    EXPECT_FALSE(workStopped());
    EXPECT_EQ(unlessStopped<int>(1).value(), 1);
    const InterruptScope none(nullptr);
    EXPECT_FALSE(workStopped());
  }
  EXPECT_TRUE(workStopped());
}

}  // namespace
}  // namespace lorica
