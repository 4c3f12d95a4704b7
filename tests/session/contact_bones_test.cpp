#include "session/contact_bones.h"

#include "acd/decompose.h"
#include "capture/files/joint_csv.h"
#include "capture/synthetic/synthetic_motion.h"
#include "collision/live/live_body.h"
#include "session/pose_source.h"
#include "session/session.h"
#include "skinning/mannequin/mannequin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>

namespace lorica {
namespace {

struct Body {
  Character character = makeMannequin();
  Decomposition parts;
  LiveBody live;

  Body() : parts(cut(character)), live(LiveBody::create(parts, character).value()) {
    const std::vector<Affine3> bindPose(static_cast<std::size_t>(character.skeleton.jointCount()), Affine3::Identity());
    live.update(bindPose);
  }
  static Decomposition cut(const Character& character) {
    DecomposeSettings settings;
    settings.maxParts = 8;
    return decompose(character.mesh, {character.mesh.vertices, static_cast<int>(character.mesh.vertices.size())},
                     settings)
        .value();
  }
  /// Blend weight of a joint at a point.
  [[nodiscard]] double weight(VertexIndex vertex, JointIndex joint) const {
    double sum = 0.0;
    const auto v = static_cast<std::size_t>(vertex);
    for (std::uint32_t i = character.influenceBegin[v]; i < character.influenceBegin[v + 1]; ++i) {
      if (character.influences[i].joint == static_cast<decltype(character.influences[i].joint)>(joint)) {
        sum += character.influences[i].weight;
      }
    }
    return sum;
  }
};

const Body& body() {
  static const Body made;
  return made;
}

TEST(ContactBones, ACornerOfAHullIsMovedByTheJointWithItsLargestWeight) {
  ContactBones bones(body().parts, body().character);
  int corners = 0;
  for (const LivePart& part : body().live.parts()) {
    for (std::size_t i = 0; i < part.shape.vertices.size(); ++i) {
      const VertexIndex point = part.shape.pointOfVertex[i];
      if (point >= body().parts.vertexCount) continue;
      const JointIndex found = bones.at(part, part.worldFromPart * part.shape.vertices[i]);
      double largest = 0.0;
      for (JointIndex j = 0; j < body().character.skeleton.jointCount(); ++j) {
        largest = std::max(largest, body().weight(point, j));
      }
      EXPECT_NEAR(body().weight(point, found), largest, 1e-6) << "vertex " << point;
      ++corners;
    }
  }
  EXPECT_GT(corners, 300);
}

TEST(ContactBones, InsideAFaceTheWeightsOfItsCornersAreBlended) {
  ContactBones bones(body().parts, body().character);
  int blended = 0;
  for (const LivePart& part : body().live.parts()) {
    for (const Triangle& t : part.shape.triangles) {
      const Vec3 shares(0.5, 0.3, 0.2);
      Vec3 position = Vec3::Zero();
      std::vector<double> weights(static_cast<std::size_t>(body().character.skeleton.jointCount()), 0.0);
      bool vertices = true;
      for (int i = 0; i < 3; ++i) {
        const auto corner = static_cast<std::size_t>(t[i]);
        const VertexIndex point = part.shape.pointOfVertex[corner];
        vertices = vertices && point < body().parts.vertexCount;
        position += shares[i] * part.shape.vertices[corner];
        for (std::size_t j = 0; vertices && j < weights.size(); ++j) {
          weights[j] += shares[i] * body().weight(point, static_cast<JointIndex>(j));
        }
      }
      if (!vertices) continue;
      // Slightly outside, like contacts.
      const JointIndex found = bones.at(part, part.worldFromPart * Vec3(1.0001 * position));
      EXPECT_NEAR(weights[found], *std::max_element(weights.begin(), weights.end()), 0.02);
      ++blended;
    }
  }
  EXPECT_GT(blended, 300);
}

TEST(ContactBones, AKickIsTheRightFoots) {
  const Character& character = body().character;
  World world;
  Prop ball;
  ball.shape = PropShape::kSphere;
  ball.halfExtents = Vec3::Constant(0.15);
  ball.mass = 0.3;
  ball.worldFromProp = Eigen::Translation3d(0.0, 1.0, 1.1);
  world.addProp(ball);
  Prop post = ball;
  post.halfExtents = Vec3(0.05, 0.425, 0.05);
  post.shape = PropShape::kCylinder;
  post.mass = 0.0;
  post.worldFromProp = Eigen::Translation3d(0.0, 0.425, 1.1);
  world.addProp(post);
  std::unique_ptr<PoseSource> source =
      makeJointPoseSource(character.skeleton, makeRecordedSource(synthesizeMotion(SyntheticMotion::kPunchAndKick)))
          .value();
  Session session = Session::create(character, body().parts, std::move(source), std::move(world)).value();
  int contacts = 0;
  while (contacts == 0) {
    const Result<bool> more = session.step();
    ASSERT_TRUE(more.ok() && *more) << "nobody kicked the ball";
    for (const Contact& contact : session.world().contacts()) {
      ASSERT_NE(contact.bone, kNoJoint);
      const std::string& name = character.skeleton.joint(contact.bone).name;
      EXPECT_TRUE(name == "rightFoot" || name == "rightToes" || name == "rightLowerLeg") << name;
      ++contacts;
    }
  }
  EXPECT_TRUE(session.selfContacts().empty()) << "a kick has no self-contacts";
}

TEST(ContactBones, APartWithoutFacesHasNone) {
  ContactBones bones(body().parts, body().character);
  EXPECT_EQ(bones.at(LivePart(), Vec3::Zero()), kNoJoint);
}

}  // namespace
}  // namespace lorica
