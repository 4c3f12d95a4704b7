#include "tests/bench/generators/virtual_clothes.h"

#include "capture/files/joint_csv.h"
#include "capture/virtual_sensor/virtual_performer.h"
#include "capture/virtual_sensor/virtual_sensor.h"
#include "geometry/tri_mesh.h"
#include "skinning/mannequin/mannequin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

namespace lorica {
namespace {

constexpr std::array kAll = {Clothes::kTrousers, Clothes::kSkirt, Clothes::kCoat, Clothes::kHair};

TEST(VirtualClothes, EveryPieceHasANameAndNothingElseHas) {
  static_assert(kAll.size() == kClothesNames.size());
  for (std::size_t i = 0; i < kAll.size(); ++i) EXPECT_EQ(clothesNamed(kClothesNames[i]), kAll[i]);
  for (const char* name : {"", "hat", "Coat"}) EXPECT_FALSE(clothesNamed(name)) << name;
}

TEST(VirtualClothes, NothingWornChangesNothing) {
  const Character body = makeMannequin();
  const Character same = withClothes(body, {});
  EXPECT_EQ(same.mesh.vertices, body.mesh.vertices);
  EXPECT_EQ(same.mesh.triangles, body.mesh.triangles);
}

TEST(VirtualClothes, PiecesAreClosedAndSkinnedAndTheBodyStays) {
  const Character body = withProportions(makeMannequin(), {.height = 1.1, .girth = 1.25});
  for (std::size_t count = 1; count <= kAll.size(); ++count) {
    // Each by itself, then all.
    const std::span<const Clothes> pieces =
        count < kAll.size() ? std::span(kAll).subspan(count - 1, 1) : std::span<const Clothes>(kAll);
    const Character dressed = withClothes(body, pieces);
    ASSERT_TRUE(checkCharacter(dressed).ok());
    EXPECT_TRUE(checkClosedTwoManifold(dressed.mesh).ok());
    EXPECT_GT(dressed.mesh.vertices.size(), body.mesh.vertices.size());
    EXPECT_TRUE(std::equal(body.mesh.vertices.begin(), body.mesh.vertices.end(), dressed.mesh.vertices.begin()));
    EXPECT_GT(signedVolume(dressed.mesh.vertices, dressed.mesh.triangles),
              signedVolume(body.mesh.vertices, body.mesh.triangles) + 0.002);
    EXPECT_EQ(dressed.height, body.height);
    EXPECT_EQ(dressed.mesh.vertices, withClothes(body, pieces).mesh.vertices);
    for (const Vec3& v : dressed.mesh.vertices) {
      ASSERT_TRUE(v.allFinite());
      ASSERT_GT(v.y(), -0.001);
      ASSERT_LT(v.y(), 1.05 * body.height);
    }
  }
}

TEST(VirtualClothes, TrueJointsAreThoseOfTheBareBody) {
  const Character body = makeMannequin();
  const std::vector<SkeletonFrame> motion = shippedFrames("squat_and_reach");
  VirtualPerformer bare = VirtualPerformer::create(body, motion).value();
  VirtualPerformer dressed = VirtualPerformer::create(withClothes(body, kAll), motion).value();
  EXPECT_EQ(dressed.sides(), SurfaceSides::kOuter);
  for (double time = 0.0; time < bare.seconds(); time += 0.37) {
    bare.pose(time, Isometry3::Identity());
    dressed.pose(time, Isometry3::Identity());
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      ASSERT_EQ(bare.joints().joints[j].position, dressed.joints().joints[j].position) << j;
      ASSERT_EQ(bare.joints().joints[j].confidence, dressed.joints().joints[j].confidence);
    }
    const Aabb bounds = boundsOf(dressed.positions());
    const Aabb bodyBounds = boundsOf(bare.positions());
    // Cloth follows the body: it is nowhere farther than a hem is wide.
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_LT(bounds.max[axis], bodyBounds.max[axis] + 0.35) << time;
      ASSERT_GT(bounds.min[axis], bodyBounds.min[axis] - 0.35) << time;
    }
  }
}

TEST(VirtualClothes, TheSensorSeesThem) {
  const auto pixels = [](std::span<const Clothes> pieces) {
    std::vector<VirtualPerson> people;
    people.push_back({VirtualPerformer::create(withClothes(makeMannequin(), pieces), shippedFrames("wave")).value()});
    VirtualSensorSettings settings;
    settings.noise = DepthNoiseSettings::clean();
    VirtualSensor sensor = VirtualSensor::create(std::move(people), settings).value();
    DepthFrame frame;
    sensor.render(0, frame);
    return sensor.truth()[0].pixelCount;
  };
  EXPECT_GT(pixels(std::array{Clothes::kSkirt, Clothes::kHair}), 1.15 * pixels({}));
}

TEST(VirtualClothes, TheFaceStaysFree) {
  const Character body = makeMannequin();
  const std::vector<Clothes> hair = {Clothes::kHair};
  const Character dressed = withClothes(body, hair);
  const Vec3 head = body.jointFromModel[body.skeleton.jointOf(HumanBone::kHead)].inverse().translation();
  double nose = -1.0, front = -1.0;
  for (std::size_t v = 0; v < dressed.mesh.vertices.size(); ++v) {
    const Vec3& p = dressed.mesh.vertices[v];
    if (p.y() < head.y() + 0.02 || std::abs(p.x()) > 0.05) continue;
    double& most = v < body.mesh.vertices.size() ? nose : front;
    most = std::max(most, p.z());
  }
  EXPECT_GT(nose, front + 0.01);
}

TEST(VirtualClothes, WithoutTheBonesAPieceIsLeftOut) {
  Character body = makeMannequin();
  std::vector<Joint> joints(body.skeleton.joints().begin(), body.skeleton.joints().end());
  for (Joint& joint : joints) joint.bone.reset();
  body.skeleton = Skeleton::create(joints).value();
  EXPECT_EQ(withClothes(body, kAll).mesh.vertices, body.mesh.vertices);
}

}  // namespace
}  // namespace lorica
