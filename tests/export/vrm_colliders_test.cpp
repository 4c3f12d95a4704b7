#include "export/glb_colliders.h"

#include "skinning/springs/spring_collider.h"
#include "tests/export/stick_figure.h"
#include "tests/support/has.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace lorica {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kVrm1 = R"({"VRMC_vrm": {}, "VRMC_springBone": {"specVersion": "1.0",
    "colliders": [{"node": 0, "shape": {"sphere": {"offset": [0, 0, 0], "radius": 0.1}}}],
    "colliderGroups": [{"colliders": [0]}],
    "springs": [{"joints": [], "colliderGroups": [0]}, {"joints": []}]}})";
constexpr const char* kVrm0 = R"({"VRM": {"secondaryAnimation": {"colliderGroups": [],
    "boneGroups": [{"bones": [7], "colliderGroups": []}]}}})";

struct Made {
  Character figure = test::stickFigure();
  std::vector<RigidCollider> colliders = test::collidersIn(figure, {0.0});
  CharacterDocument document = characterDocument(figure);
  SpringBones springs;

  explicit Made(const char* extensions) {
    document.writer.document["extensions"] = Json::parse(extensions);
    springs.chains.resize(1);
  }
  Result<int> add() { return addSpringColliders(document, colliders, figure.skeleton, springs, "hero.vrm"); }
  [[nodiscard]] const Json& extensions() const { return document.writer.document["extensions"]; }
};

TEST(VrmColliders, OfVrm1AreAGroupThatEverySpringUses) {
  Made made(kVrm1);
  ASSERT_EQ(made.add().value(), 2);
  const Json& springBone = made.extensions()["VRMC_springBone"];
  EXPECT_EQ(springBone["colliders"].size(), 3U);
  EXPECT_EQ(springBone["colliderGroups"][1]["colliders"], Json::array({1, 2}));
  EXPECT_EQ(springBone["springs"][0]["colliderGroups"], Json::array({0, 1}));
  EXPECT_EQ(springBone["springs"][1]["colliderGroups"], Json::array({1}));
  const Json& capsule = springBone["colliders"][2]["shape"]["capsule"];
  EXPECT_EQ(springBone["colliders"][2]["node"], 1);
  EXPECT_NEAR(0.5 * (capsule["offset"][1].get<double>() + capsule["tail"][1].get<double>()), 0.5, 1e-6);
  const double r = capsule["radius"];
  const double length = std::abs(capsule["offset"][1].get<double>() - capsule["tail"][1].get<double>());
  EXPECT_NEAR((Capsule{Vec3::Zero(), Vec3(0, length, 0), r}.volume()), 0.04, 1e-6);  // that of the hull
}

TEST(VrmColliders, ChangeNothingElse) {
  Made made(kVrm1);
  Json before = made.document.writer.document;
  const std::string binary = made.document.writer.binary;
  ASSERT_TRUE(made.add());
  Json after = made.document.writer.document;
  before["extensions"].erase("VRMC_springBone");
  after["extensions"].erase("VRMC_springBone");
  EXPECT_EQ(before, after);
  EXPECT_EQ(made.document.writer.binary, binary);
}

TEST(VrmColliders, OfVrm0AreLeftHandedBalls) {
  Made made(kVrm0);
  for (RigidCollider& collider : made.colliders) {
    collider.capsule.from.z() += 0.05;
    collider.capsule.to.z() += 0.05;
  }
  const int added = made.add().value();
  const Json& animation = made.extensions()["VRM"]["secondaryAnimation"];
  ASSERT_EQ(animation["colliderGroups"].size(), 2U);
  EXPECT_EQ(animation["boneGroups"][0]["colliderGroups"], Json::array({0, 1}));
  int balls = 0;
  for (const Json& group : animation["colliderGroups"]) {
    for (const Json& ball : group["colliders"]) {
      EXPECT_NEAR(ball["offset"]["z"].get<double>(), -0.05, 1e-6);
      ++balls;
    }
  }
  EXPECT_EQ(balls, added);
  EXPECT_GT(balls, 2);
}

TEST(VrmColliders, BonesThatSwingGetNone) {
  Made made(kVrm1);
  made.springs.chains[0].joints.push_back({1});
  EXPECT_EQ(made.add().value(), 1);
}

TEST(VrmColliders, WhatHasNoSpringsIsRefused) {
  Made made(kVrm1);
  made.springs.chains.clear();
  EXPECT_TRUE(test::has(made.add().error().message, "no springs"));
  EXPECT_TRUE(test::has(Made("{}").add().error().message, "no VRM"));
}

}  // namespace
}  // namespace lorica
