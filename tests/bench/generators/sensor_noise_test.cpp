#include "tests/bench/generators/sensor_noise.h"
#include "capture/files/joint_csv.h"
#include "tests/bench/generators/synthetic_motion.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>
#include <cmath>
#include <string>

namespace lorica {
namespace {

class SensorNoise : public testing::TestWithParam<std::string_view> {
 protected:
  const std::vector<SkeletonFrame> clean = synthesizeMotion(GetParam());
  const std::vector<SkeletonFrame> noisy = addSensorNoise(clean, kSensorNoiseSeed);
};

INSTANTIATE_TEST_SUITE_P(Motions, SensorNoise, testing::Values("walk", "punch_and_kick"),
                         [](const auto& param) { return std::string(param.param); });

TEST_P(SensorNoise, SomeJointsAreGuessedOrLost) {
  ASSERT_EQ(noisy.size(), clean.size());
  int samples = 0;
  int guessed = 0;
  int lost = 0;
  for (std::size_t i = 0; i < noisy.size(); ++i) {
    ASSERT_EQ(noisy[i].time, clean[i].time);
    for (const TrackedJoint& joint : noisy[i].joints) {
      ++samples;
      ASSERT_TRUE(joint.confidence == 0.0 || joint.confidence == 0.5 || joint.confidence == 1.0);
      ASSERT_EQ(joint.orientation.has_value(), joint.confidence > 0.0);
      ASSERT_TRUE(joint.position.allFinite());
      if (joint.orientation) {
        ASSERT_NEAR(joint.orientation->norm(), 1.0, 1e-9);
      }
      guessed += joint.confidence == 0.5 ? 1 : 0;
      lost += joint.confidence == 0.0 ? 1 : 0;
    }
  }
  const double share = static_cast<double>(guessed + lost) / samples;
  EXPECT_GE(share, 0.05);
  EXPECT_LE(share, 0.30);
  EXPECT_GT(lost, samples / 50);
  EXPECT_GT(guessed, samples / 100);
}

TEST_P(SensorNoise, DropOutsLastATenthToOneAndAHalfSeconds) {
  int runs = 0;
  for (std::size_t j = 0; j < kBodyJointCount; ++j) {
    for (std::size_t i = 0; i < noisy.size();) {
      if (noisy[i].joints[j].confidence > 0.0) {
        ++i;
        continue;
      }
      std::size_t end = i;
      while (end < noisy.size() && noisy[end].joints[j].confidence == 0.0) ++end;
      const double seconds = static_cast<double>(end - i) / 30.0;
      EXPECT_GE(seconds, 0.1);
      EXPECT_LE(seconds, 1.5);
      // The joint is guessed before and after the loss.
      ASSERT_GT(i, 0u);
      EXPECT_EQ(noisy[i - 1].joints[j].confidence, 0.5);
      ASSERT_LT(end, noisy.size());
      EXPECT_EQ(noisy[end].joints[j].confidence, 0.5);
      ++runs;
      i = end;
    }
  }
  EXPECT_GE(runs, 8);
}

TEST_P(SensorNoise, SeenJointsJitterByMillimetres) {
  double sumSq = 0.0;
  int seen = 0;
  for (std::size_t i = 0; i < noisy.size(); ++i) {
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      const TrackedJoint& joint = noisy[i].joints[j];
      if (joint.confidence == 0.0) continue;
      const double off = (joint.position - clean[i].joints[j].position).norm();
      const double turn = joint.orientation->angularDistance(*clean[i].joints[j].orientation);
      EXPECT_LT(turn, 0.3);
      if (joint.confidence == 0.5) {
        EXPECT_LT(off, 0.15);
        continue;
      }
      EXPECT_LT(off, 0.06) << "frame " << i << ", joint " << j;
      sumSq += off * off;
      ++seen;
    }
  }
  const double deviation = std::sqrt(sumSq / seen);
  EXPECT_GT(deviation, 0.003);
  EXPECT_LT(deviation, 0.02);
}

TEST_P(SensorNoise, SameSeedSameNoise) {
  const std::vector<SkeletonFrame> again = addSensorNoise(clean, kSensorNoiseSeed);
  const std::vector<SkeletonFrame> other = addSensorNoise(clean, kSensorNoiseSeed + 1);
  bool differs = false;
  for (std::size_t i = 0; i < noisy.size(); ++i) {
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      ASSERT_EQ(again[i].joints[j].position, noisy[i].joints[j].position);
      ASSERT_EQ(again[i].joints[j].confidence, noisy[i].joints[j].confidence);
      differs = differs || other[i].joints[j].position != noisy[i].joints[j].position;
    }
  }
  EXPECT_TRUE(differs);
}

TEST_P(SensorNoise, TheShippedFileHoldsThisNoise) {
  const auto file = test::recordingsFolder() / (std::string(GetParam()) + "_noisy.csv");
  const auto shipped = readJointCsv(file);
  ASSERT_TRUE(shipped.ok()) << shipped.error().message;
  ASSERT_EQ(shipped->size(), noisy.size());
  for (std::size_t i = 0; i < noisy.size(); ++i) {
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      const TrackedJoint& inFile = (*shipped)[i].joints[j];
      const TrackedJoint& made = noisy[i].joints[j];
      ASSERT_LT((inFile.position - made.position).cwiseAbs().maxCoeff(), 0.6e-5) << "frame " << i << ", joint " << j;
      ASSERT_EQ(inFile.confidence, made.confidence);
      ASSERT_EQ(inFile.orientation.has_value(), made.orientation.has_value());
    }
  }
}

TEST(SensorNoiseEdges, NothingStaysNothingAndShortStaysWhole) {
  EXPECT_TRUE(addSensorNoise({}, 1).empty());
  std::vector<SkeletonFrame> one(1);
  for (TrackedJoint& joint : one[0].joints) joint.confidence = 1.0;
  const auto noisy = addSensorNoise(one, 1);
  ASSERT_EQ(noisy.size(), 1u);
  for (const TrackedJoint& joint : noisy[0].joints) EXPECT_EQ(joint.confidence, 1.0);
}

}  // namespace
}  // namespace lorica
