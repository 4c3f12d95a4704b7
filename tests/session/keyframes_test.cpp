#include "session/keyframes.h"

#include "capture/synthetic_motion.h"
#include "skinning/mannequin.h"

#include <gtest/gtest.h>

#include <cmath>

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

  /// Which frame of the recordings laid end to end each keyframe is.
  std::vector<int> framesOf(const std::vector<Vec3>& keyframes) {
    std::vector<Vec3> all;
    for (const auto& recording : recordings_) {
      const Result<std::vector<Vec3>> posed = poseAllFrames(character_, recording);
      EXPECT_TRUE(posed.ok());
      all.insert(all.end(), posed->begin(), posed->end());
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
    const Result<std::vector<Vec3>> keyframes = sampleKeyframes(character_, recordings_, count);
    ASSERT_TRUE(keyframes.ok()) << keyframes.error().message;
    ASSERT_EQ(keyframes->size(), static_cast<std::size_t>(count) * vertexCount_);
    std::vector<int> expected;
    for (int k = 0; k < count; ++k) {
      expected.push_back(count == 1 ? 0 : static_cast<int>(std::floor(k * 46.0 / (count - 1) + 0.5)));
    }
    EXPECT_EQ(framesOf(*keyframes), expected) << count;
  }
}

TEST_F(Keyframes, MoreThanThereAreFramesIsRefused) {
  const Result<std::vector<Vec3>> keyframes = sampleKeyframes(character_, recordings_, 48);
  ASSERT_FALSE(keyframes.ok());
  EXPECT_EQ(keyframes.error().code, ErrorCode::kInvalidArgument);
  EXPECT_NE(keyframes.error().message.find("48"), std::string::npos) << keyframes.error().message;
  EXPECT_NE(keyframes.error().message.find("47"), std::string::npos) << keyframes.error().message;
  EXPECT_FALSE(sampleKeyframes(character_, recordings_, 0).ok());
  EXPECT_FALSE(sampleKeyframes(character_, {}, 1).ok());
}

TEST_F(Keyframes, ACharacterWithoutHumanBonesIsRefused) {
  Character character = character_;
  Joint root;
  root.name = "root";
  character.skeleton = *Skeleton::create({root});
  EXPECT_FALSE(sampleKeyframes(character, recordings_, 2).ok());
  EXPECT_FALSE(poseAllFrames(character, recordings_[0]).ok());
}

}  // namespace
}  // namespace lorica
