#include "acd/decompose.h"
#include "acd/transfer.h"
#include "capture/files/joint_csv.h"
#include "collision/hulls/keyframes.h"
#include "collision/live/moving_hull.h"
#include "session/pose_source.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/collision/live/moving_hull_truth.h"

#include <gtest/gtest.h>

#include <random>

namespace lorica::test {
namespace {

constexpr double kTicksPerMetre = 2e6;
using Rows = std::vector<PointRow>;

/// The built-in character in parts, with its points in every frame of a recording.
class Recorded {
 public:
  explicit Recorded(std::string_view motion) {
    const Character character = makeMannequin();
    const std::vector<Vec3> posed = poseAllFrames(character, *perform(character.skeleton, shippedFrames(motion)));
    const PoseView poses{posed, static_cast<int>(character.mesh.vertices.size())};
    const std::vector<Vec3> points(static_cast<std::size_t>(parts().pointCount()));
    frames_.assign(static_cast<std::size_t>(poses.keyframeCount()), points);
    for (int f = 0; f < poses.keyframeCount(); ++f) {
      transfer(parts(), poses.keyframe(f), frames_[f]);
    }
  }

  [[nodiscard]] static const Decomposition& parts() {
    static const Decomposition made = [] {
      const Character character = makeMannequin();
      DecomposeSettings settings;
      settings.maxParts = 8;
      const PoseView bindPose{character.mesh.vertices, static_cast<int>(character.mesh.vertices.size())};
      Result<Decomposition> result = decompose(character.mesh, bindPose, settings);
      LORICA_CHECK(result.ok(), "decomposing the mannequin must succeed");
      return std::move(result).value();
    }();
    return made;
  }

  [[nodiscard]] std::size_t frameCount() const { return frames_.size(); }

  /// Every fifth point of a part: the brute force of the test would be slow with all of them.
  [[nodiscard]] Rows rows(std::size_t part, std::size_t frame) const {
    std::vector<Vec3> points;
    const std::vector<PointIndex>& own = parts().parts[part].points;
    points.reserve(own.size() / 5 + 1);
    for (std::size_t i = 0; i < own.size(); i += 5) points.push_back(frames_[frame][own[i]]);
    return aboutTheirMean(points, kTicksPerMetre);
  }

 private:
  std::vector<std::vector<Vec3>> frames_;
};

void expectFollows(std::string_view motion) {
  const Recorded recorded(motion);
  int frames = 0;
  int rebuilds = 0;
  for (std::size_t part = 0; part < Recorded::parts().parts.size(); ++part) {
    MovingHull hull(static_cast<int>(recorded.rows(part, 0).size()));
    for (std::size_t frame = 0; frame < recorded.frameCount(); ++frame) {
      const Rows rows = recorded.rows(part, frame);
      hull.update(rows);
      ASSERT_EQ(whatIsWrong(hull, rows), "") << "part " << part << ", frame " << frame;
      ASSERT_FALSE(hull.flat());
      rebuilds += frame > 0 ? hull.counts().rebuilds : 0;
      ++frames;
    }
    // From any frame to any other.
    std::mt19937_64 random(part);
    for (int jump = 0; jump < 20; ++jump) {
      const Rows rows = recorded.rows(part, random() % recorded.frameCount());
      hull.update(rows);
      ASSERT_EQ(whatIsWrong(hull, rows), "") << "part " << part << ", jump " << jump;
    }
  }
  EXPECT_LE(rebuilds * 100, frames) << "recorded motion is repaired, not rebuilt";
}

TEST(MovingHullRecordings, Walk) {
  expectFollows("walk");
}

TEST(MovingHullRecordings, JumpingJacks) {
  expectFollows("jumping_jacks");
}

}  // namespace
}  // namespace lorica::test
