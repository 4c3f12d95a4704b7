#include "viewer/window/quality_choice.h"
#include "viewer/window/time_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <vector>

namespace lorica {
namespace {

TEST(TimeGraph, KeepsTheLastFramesInOrder) {
  TimeGraph graph;
  EXPECT_EQ(graph.frameCount(), 0);
  EXPECT_EQ(graph.mean(0), 0.0);
  EXPECT_EQ(graph.longest(), 0.0);
  const int count = 3 * TimeGraph::kFrames + 7;
  for (int f = 0; f < count; ++f) {
    const std::array stages = {TimedStage{"hulls", 1.0 * f}, TimedStage{"physics", 0.5}};
    graph.add(stages);
    ASSERT_EQ(graph.frameCount(), std::min(f + 1, TimeGraph::kFrames));
    ASSERT_EQ(graph.milliseconds(graph.frameCount() - 1, 0), f) << "the newest frame is the last one";
  }
  ASSERT_EQ(graph.stageCount(), 2);
  EXPECT_STREQ(graph.name(1), "physics");
  for (int f = 0; f < TimeGraph::kFrames; ++f) {
    ASSERT_EQ(graph.milliseconds(f, 0), count - TimeGraph::kFrames + f);
    ASSERT_EQ(graph.total(f), graph.milliseconds(f, 0) + 0.5);
  }
  EXPECT_EQ(graph.longest(), count - 0.5);
  EXPECT_EQ(graph.mean(0), count - 15.5) << "of the last 30";
}

/// Draws for some time at a speed that depends on the level. @return number of changes of the level
int run(QualityChoice& choice, double& now, double seconds, const std::array<double, 3>& secondsAPicture) {
  int changes = 0;
  for (const double end = now + seconds; now < end;) {
    const double took = secondsAPicture[choice.level()];
    now += std::max(took, 1.0 / 60.0);
    changes += choice.add(took, now) ? 1 : 0;
  }
  return changes;
}

TEST(QualityChoice, FastMachinesKeepTheBest) {
  QualityChoice choice(3);
  double now = 0.0;
  EXPECT_EQ(run(choice, now, 60.0, {0.001, 0.002, 0.004}), 0);
  EXPECT_EQ(choice.level(), 2);
}

TEST(QualityChoice, SlowMachinesEndAtTheLowest) {
  QualityChoice choice(3);
  double now = 0.0;
  EXPECT_EQ(run(choice, now, 60.0, {0.05, 0.1, 0.3}), 2);
  EXPECT_EQ(choice.level(), 0);
}

TEST(QualityChoice, InBetweenItIsCalm) {
  QualityChoice choice(3);
  double now = 0.0;
  EXPECT_EQ(run(choice, now, 120.0, {0.008, 0.02, 0.1}), 1) << "medium is fast enough, high is not";
  EXPECT_EQ(choice.level(), 1);
  // Low is fast enough, medium is not: it is tried again, but less and less often.
  EXPECT_LE(run(choice, now, 300.0, {0.005, 0.06, 0.1}), 16);
  EXPECT_GE(run(choice, now, 60.0, {0.001, 0.002, 0.004}), 1) << "and is raised again when drawing is fast";
}

TEST(QualityChoice, OneSlowPictureChangesNothing) {
  QualityChoice choice(3);
  double now = 0.0;
  run(choice, now, 2.0, {0.005, 0.005, 0.005});
  choice.add(0.3, now += 0.3);
  EXPECT_EQ(run(choice, now, 2.0, {0.005, 0.005, 0.005}), 0);
  EXPECT_EQ(choice.level(), 2);
}

}  // namespace
}  // namespace lorica
