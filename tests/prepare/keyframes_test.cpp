#include "prepare/keyframes.h"
#include "session/pose_source.h"

#include "capture/synthetic/synthetic_motion.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lorica {
namespace {

std::vector<SkeletonFrame> firstFrames(SyntheticMotion motion, std::size_t count) {
  std::vector<SkeletonFrame> frames = synthesizeMotion(motion);
  frames.resize(std::min(frames.size(), count));
  return frames;
}

class Keyframes : public testing::Test {
 protected:
  Character character_ = makeMannequin();
  std::size_t vertexCount_ = character_.mesh.vertices.size();
  std::vector<std::vector<SkeletonFrame>> recordings_ = {firstFrames(SyntheticMotion::kWalk, 17),
                                                         firstFrames(SyntheticMotion::kPunchAndKick, 30)};
  std::vector<SkeletalMotion> motions_ = performAll(character_.skeleton, recordings_).value();

  /// Index of each keyframe in the concatenated recordings.
  std::vector<int> framesOf(const std::vector<Vec3>& keyframes) {
    std::vector<Vec3> all;
    for (const SkeletalMotion& motion : motions_) {
      const std::vector<Vec3> posed = poseAllFrames(character_, motion);
      all.insert(all.end(), posed.begin(), posed.end());
    }
    std::vector<int> found;
    for (std::size_t k = 0; k * vertexCount_ < keyframes.size(); ++k) {
      for (std::size_t f = 0; f * vertexCount_ < all.size(); ++f) {
        if (std::equal(all.begin() + static_cast<std::ptrdiff_t>(f * vertexCount_),
                       all.begin() + static_cast<std::ptrdiff_t>((f + 1) * vertexCount_),
                       keyframes.begin() + static_cast<std::ptrdiff_t>(k * vertexCount_))) {
          found.push_back(static_cast<int>(f));
          break;
        }
      }
    }
    return found;
  }
};

TEST_F(Keyframes, AreUniformOverTheRecordingsLaidEndToEnd) {
  for (int count : {1, 2, 5, 12, 47}) {
    const std::vector<Vec3> keyframes = test::valueOf(sampleKeyframes(character_, motions_, count));
    ASSERT_EQ(keyframes.size(), static_cast<std::size_t>(count) * vertexCount_);
    std::vector<int> expected;
    for (int k = 0; k < count; ++k) {
      expected.push_back(count == 1 ? 0 : static_cast<int>(std::floor(k * 46.0 / (count - 1) + 0.5)));
    }
    EXPECT_EQ(framesOf(keyframes), expected) << count;
  }
}

TEST_F(Keyframes, MoreThanThereAreFramesIsRefused) {
  const Result<std::vector<Vec3>> keyframes = sampleKeyframes(character_, motions_, 48);
  ASSERT_FALSE(keyframes.ok());
  EXPECT_EQ(keyframes.error().code, ErrorCode::kInvalidArgument);
  EXPECT_NE(keyframes.error().message.find("48"), std::string::npos) << keyframes.error().message;
  EXPECT_NE(keyframes.error().message.find("47"), std::string::npos) << keyframes.error().message;
  EXPECT_FALSE(sampleKeyframes(character_, motions_, 0).ok());
  EXPECT_FALSE(sampleKeyframes(character_, {}, 1).ok());
}

TEST_F(Keyframes, ACharacterWithoutHumanBonesIsRefused) {
  Joint root;
  root.name = "root";
  const Result<std::vector<SkeletalMotion>> motions = performAll(*Skeleton::create({root}), recordings_);
  ASSERT_FALSE(motions.ok());
  EXPECT_NE(motions.error().message.find("hips"), std::string::npos) << motions.error().message;
}

TEST_F(Keyframes, ChosenOnesAreFramesOfTheRecordingsAndSayWhich) {
  const ChosenKeyframes chosen = test::valueOf(chooseKeyframes(character_, motions_, 6, 0.0));
  ASSERT_EQ(chosen.sources.size(), 6u);
  const std::vector<int> frames = framesOf(chosen.positions);
  ASSERT_EQ(frames.size(), 6u);
  for (std::size_t k = 0; k < 6; ++k) {
    const KeyframeSource& source = chosen.sources[k];
    ASSERT_LT(source.motion, 2u);
    ASSERT_LT(source.frame, recordings_[source.motion].size());
    EXPECT_EQ(source.time, recordings_[source.motion][source.frame].time);
    EXPECT_EQ(static_cast<std::size_t>(frames[k]), source.frame + (source.motion == 1 ? 17 : 0));
  }
  EXPECT_EQ(frames.front(), 0) << "the first frame is always a keyframe";
  EXPECT_TRUE(std::is_sorted(frames.begin(), frames.end()));
  EXPECT_EQ(std::adjacent_find(frames.begin(), frames.end()), frames.end());
  EXPECT_GT(chosen.farthest, 0.0);
}

TEST_F(Keyframes, MoreOfThemLeaveNoFrameFartherAway) {
  double before = std::numeric_limits<double>::infinity();
  for (const int count : {1, 2, 4, 8, 16}) {
    const ChosenKeyframes chosen = test::valueOf(chooseKeyframes(character_, motions_, count, 0.0));
    EXPECT_LE(chosen.farthest, before);
    before = chosen.farthest;
  }
  // It stops by itself if all frames are keyframes or no frame is more distant than the limit.
  const ChosenKeyframes all = test::valueOf(chooseKeyframes(character_, motions_, 1000, 0.0));
  EXPECT_LE(all.sources.size(), 47u);
  EXPECT_EQ(all.farthest, 0.0);
  const ChosenKeyframes enough = test::valueOf(chooseKeyframes(character_, motions_, 1000, 0.05));
  EXPECT_LE(enough.farthest, 0.05);
  EXPECT_LT(enough.sources.size(), all.sources.size());
}

TEST_F(Keyframes, WhereTheBodyStandsAndTurnsDoesNotCount) {
  // The same pose at another position, then a different pose at the old position: only the latter is a new keyframe.
  const std::vector<SkeletonFrame> walk = synthesizeMotion(SyntheticMotion::kWalk);
  const auto moved = [](SkeletonFrame frame, const Quat& rotation, const Vec3& shift) {
    for (TrackedJoint& joint : frame.joints) {
      joint.position = rotation * joint.position + shift;
      if (joint.orientation) joint.orientation = rotation * *joint.orientation;
    }
    return frame;
  };
  std::vector<SkeletonFrame> frames;
  for (int i = 0; i < 9; ++i) {
    const Quat rotation(Eigen::AngleAxisd(0.1 * i, Vec3::UnitY()));
    SkeletonFrame frame = moved(walk.front(), rotation, Vec3(0.2 * i, 0.0, 0.0));
    frame.time = i / 30.0;
    frames.push_back(frame);
  }
  const std::vector<SkeletalMotion> standing = {perform(character_.skeleton, frames).value()};
  Result<ChosenKeyframes> chosen = chooseKeyframes(character_, standing, 5, 1e-3);
  ASSERT_TRUE(chosen.ok());
  EXPECT_EQ(chosen->sources.size(), 1u);
  EXPECT_LT(chosen->farthest, 1e-3);

  SkeletonFrame step = walk[10];
  step.time = 9 / 30.0;
  frames.push_back(step);
  const std::vector<SkeletalMotion> stepping = {perform(character_.skeleton, frames).value()};
  chosen = chooseKeyframes(character_, stepping, 5, 1e-3);
  ASSERT_TRUE(chosen.ok());
  ASSERT_EQ(chosen->sources.size(), 2u);
  EXPECT_EQ(chosen->sources[1].frame, 9u);
}

TEST_F(Keyframes, NothingToChooseFromIsRefused) {
  EXPECT_FALSE(chooseKeyframes(character_, {}, 5, 0.0).ok());
  EXPECT_FALSE(chooseKeyframes(character_, motions_, 0, 0.0).ok());
  const std::vector<SkeletalMotion> empty(2, SkeletalMotion{"", character_.skeleton, {}, {}});
  EXPECT_FALSE(chooseKeyframes(character_, empty, 5, 0.0).ok());
}

}  // namespace
}  // namespace lorica
