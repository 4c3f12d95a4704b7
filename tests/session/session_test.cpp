#include "session/session.h"

#include "acd/decompose.h"
#include "capture/files/joint_csv.h"
#include "capture/synthetic/synthetic_motion.h"
#include "collision/live/choose_cover.h"
#include "prepare/keyframes.h"
#include "session/pose_source.h"
#include "session/scenes/demo_scene.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <set>

namespace lorica {
namespace {

std::vector<SkeletonFrame> punches() {
  return synthesizeMotion(SyntheticMotion::kPunchAndKick);
}

/// Eight parts of the mannequin from its bind pose, quick to make.
const Decomposition& eightParts() {
  static const Decomposition result = [] {
    const Character character = makeMannequin();
    DecomposeSettings settings;
    settings.maxParts = 8;
    const PoseView bindPose{character.mesh.vertices, static_cast<int>(character.mesh.vertices.size())};
    Result<Decomposition> made = decompose(character.mesh, bindPose, settings);
    EXPECT_TRUE(made.ok()) << made.error().message;
    return std::move(made).value();
  }();
  return result;
}

std::unique_ptr<PoseSource> performed(std::vector<SkeletonFrame> frames) {
  return makeJointPoseSource(makeMannequin().skeleton, makeRecordedSource(std::move(frames))).value();
}

Session makeSession(std::vector<SkeletonFrame> frames, World world = makeDemoWorld(7)) {
  Result<Session> session =
      Session::create(makeMannequin(), eightParts(), performed(std::move(frames)), std::move(world));
  LORICA_CHECK(session.ok(), "the mannequin fits its own decomposition");
  return std::move(session).value();
}

TEST(Session, RunsARecordingToItsEndAndThePersonTouchesProps) {
  const std::vector<SkeletonFrame> frames = punches();
  Session session = makeSession(frames);
  std::size_t contactCount = 0;
  std::set<int> propsTouched;
  while (true) {
    const bool more = test::valueOf(session.step());
    if (!more) break;
    contactCount += session.world().contacts().size();
    for (const Contact& contact : session.world().contacts()) propsTouched.insert(contact.prop);
    for (const LivePart& part : session.body().parts()) {
      EXPECT_FALSE(part.shape.degenerate());
      EXPECT_LT(boundsOf(part.shape.vertices).center().norm(), 0.6);
    }
    for (const Prop& prop : session.world().props()) ASSERT_TRUE(prop.worldFromProp.matrix().allFinite());
    EXPECT_GE(session.times().total(), 0.0);
  }
  EXPECT_EQ(session.frameCount(), static_cast<int>(frames.size()));
  EXPECT_GE(propsTouched.size(), 5u);
  EXPECT_GE(contactCount, propsTouched.size());
}

TEST(Session, HullsContainThePosedMesh) {
  std::vector<SkeletonFrame> frames = punches();
  frames.resize(40);
  Session session = makeSession(frames);
  while (*session.step()) {
    for (std::size_t i = 0; i < session.body().parts().size(); ++i) {
      std::vector<Vec3> points;
      for (PointIndex p : session.body().decomposition().parts[i].points) {
        points.push_back(session.points()[p]);
      }
      EXPECT_LT(largestViolation(worldHull(session.body().parts()[i]), points), 1e-6 * session.character().height);
    }
  }
}

TEST(Session, TwoRunsGiveTheSameHashAndTheSamePropsBitForBit) {
  std::vector<SkeletonFrame> frames = punches();
  frames.resize(90);
  Session first = makeSession(frames);
  Session second = makeSession(frames);
  std::uint64_t before = first.hash();
  while (*first.step()) {
    ASSERT_TRUE(*second.step());
    EXPECT_NE(first.hash(), before) << "the hash changes with every frame";
    before = first.hash();
    EXPECT_EQ(first.hash(), second.hash());
    for (std::size_t i = 0; i < first.world().props().size(); ++i) {
      ASSERT_EQ(first.world().props()[i].worldFromProp.matrix(), second.world().props()[i].worldFromProp.matrix());
    }
  }
  frames.back()[BodyJoint::kLeftHand].position.y() += 0.01;
  Session other = makeSession(frames);
  while (*other.step()) continue;
  EXPECT_NE(other.hash(), first.hash()) << "a hand one centimetre higher in the last frame changes the hash";
}

TEST(Session, PropsDoNotChangeTheHulls) {
  std::vector<SkeletonFrame> frames = punches();
  frames.resize(30);
  Session manyProps = makeSession(frames);
  Session alone = makeSession(frames, World());
  while (*manyProps.step()) ASSERT_TRUE(*alone.step());
  EXPECT_EQ(manyProps.hashes().hulls, alone.hashes().hulls);
}

TEST(Session, FrameTimesMoveThePropsBoundedly) {
  // A pause of ten seconds and a repeated time: physics advances by 0.1 s and 0.001 s.
  std::vector<SkeletonFrame> frames(3, punches().front());
  frames[1].time = frames[0].time + 10.0;
  frames[2].time = frames[1].time;
  World world;
  Prop prop;
  prop.worldFromProp.translation() = Vec3(20.0, 30.0, 0.0);
  world.addProp(prop);
  Session session = makeSession(frames, std::move(world));
  double seconds = 0.0;
  for (double expected : {1.0 / 30.0, 0.1, 0.001}) {
    ASSERT_TRUE(*session.step());
    seconds += expected;
    EXPECT_NEAR(session.world().props()[0].velocity.y(), -9.81 * seconds, 1e-4);
  }
}

TEST(Session, ADecompositionOfAnotherMeshIsRefusedWithASentence) {
  Decomposition other = eightParts();
  other.vertexCount += 1;
  const Result<Session> session = Session::create(makeMannequin(), other, performed(punches()), World());
  ASSERT_FALSE(session.ok());
  EXPECT_EQ(session.error().code, ErrorCode::kInvalidArgument);
  EXPECT_NE(session.error().message.find(std::to_string(other.vertexCount)), std::string::npos)
      << session.error().message;
  other = eightParts();
  other.triangleCount -= 2;
  EXPECT_FALSE(Session::create(makeMannequin(), other, performed(punches()), World()).ok());
}

/// The bone transforms of a session in each of these frames.
std::vector<Affine3> bonesOf(const std::vector<SkeletonFrame>& frames) {
  Session session = makeSession(frames, World());
  std::vector<Affine3> bones;
  while (*session.step()) {
    for (std::size_t j = 0; j < session.worldFromJoint().size(); ++j) {
      bones.push_back(session.worldFromJoint()[j] * session.character().jointFromModel[j]);
    }
  }
  return bones;
}

TEST(Session, HullsOfAFewPointsHoldThePosedMeshInTheFramesThatTheyWereChosenIn) {
  std::vector<SkeletonFrame> frames = punches();
  frames.resize(200);
  for (std::size_t i = 0; i < 20; ++i) frames[i] = frames[10 * i];
  frames.resize(20);
  const Character character = makeMannequin();
  const std::vector<Affine3> bones = bonesOf(frames);
  CoverSettings settings;
  settings.maxHullVertices = 40;
  const HullCover cover = test::valueOf(chooseCover(eightParts(), liftPoints(character, eightParts()),
                                                    {bones, character.skeleton.jointCount()}, {}, settings));
  Session session = test::valueOf(Session::create(character, eightParts(), performed(frames), World(), cover));
  EXPECT_EQ(session.body().coverage().maxHullVertices, 40);
  EXPECT_EQ(session.body().coverage().growth, cover.growth);
  int looked = 0;
  while (*session.step()) {
    for (std::size_t i = 0; i < session.body().parts().size(); ++i) {
      const LivePart& part = session.body().parts()[i];
      EXPECT_LE(part.shape.vertices.size(), 40u);
      std::vector<Vec3> points;
      for (PointIndex p : eightParts().parts[i].points) {
        points.push_back(session.points()[p]);
      }
      EXPECT_LT(largestViolation(worldHull(part), points), 1e-5 * character.height) << "part " << i;
      ++looked;
    }
  }
  EXPECT_EQ(looked, 20 * 8);
}

TEST(Session, TrainingDistanceIsThatOfTheSkinnedMesh) {
  std::vector<SkeletonFrame> frames = punches();
  const Character character = makeMannequin();
  const std::vector<SkeletalMotion> motions = {perform(character.skeleton, frames).value()};
  const std::vector<Vec3> keyframes = test::valueOf(sampleKeyframes(character, motions, 2));
  TrainingRange range =
      trainingRange(eightParts(), PoseView{keyframes, static_cast<int>(character.mesh.vertices.size())});
  range.knownDistance = 0.05;
  Session session =
      test::valueOf(Session::create(character, eightParts(), performed(frames), World(), std::nullopt, range));
  EXPECT_FALSE(session.trainingDistance().has_value()) << "there is no pose yet";
  EXPECT_FALSE(session.outsideKnownRange());
  std::vector<Vec3> probes(range.probes.size());
  int outside = 0;
  while (*session.step()) {
    gatherProbes(range, session.points(), probes);
    const double expected = trainingDistance(range, probes);
    ASSERT_TRUE(session.trainingDistance().has_value());
    EXPECT_NEAR(*session.trainingDistance(), expected, 1.1e-6);  // computed in steps of a micrometre
    if (std::abs(expected - 0.05) > 1e-5) {
      EXPECT_EQ(session.outsideKnownRange(), expected > 0.05);
    }
    outside += session.outsideKnownRange() ? 1 : 0;
    // The first and the last frame are the keyframes.
    if (session.frameCount() == 1 || session.frameCount() == static_cast<int>(frames.size())) {
      EXPECT_LT(*session.trainingDistance(), 2e-6);
    }
  }
  EXPECT_GT(outside, 10) << "kicks are distant from standing";
  EXPECT_LT(outside, session.frameCount());
  Session without = makeSession(frames);
  ASSERT_TRUE(*without.step());
  EXPECT_FALSE(without.trainingDistance().has_value());
}

TEST(Session, CoverAndTrainingOfAnotherDecompositionAreRefusedWithASentence) {
  const Character character = makeMannequin();
  const HullCover fine = coverExactly(eightParts(), liftPoints(character, eightParts()));
  const auto sentence = [&](std::optional<HullCover> cover, std::optional<TrainingRange> training) {
    const Result<Session> session =
        Session::create(character, eightParts(), performed(punches()), World(), std::move(cover), std::move(training));
    return session.ok() ? std::string() : session.error().message;
  };
  EXPECT_EQ(sentence(fine, std::nullopt), "");
  HullCover other = fine;
  other.points.pop_back();
  EXPECT_EQ(sentence(other, std::nullopt), "the hull cover lists the points of 7 parts, expected 8");
  other = fine;
  other.points[3].clear();
  EXPECT_EQ(sentence(other, std::nullopt), "the hull cover has no points of part 3");
  other = fine;
  other.points[2][0].point = eightParts().pointCount();
  EXPECT_NE(sentence(other, std::nullopt).find("part 2"), std::string::npos) << sentence(other, std::nullopt);

  const PoseView bindPose{character.mesh.vertices, static_cast<int>(character.mesh.vertices.size())};
  TrainingRange range = trainingRange(eightParts(), bindPose);
  EXPECT_EQ(sentence(std::nullopt, range), "");
  range.probes[1] = -1;
  EXPECT_NE(sentence(std::nullopt, range).find("point -1"), std::string::npos) << sentence(std::nullopt, range);
  range.probes.pop_back();
  EXPECT_NE(sentence(std::nullopt, range).find("probes"), std::string::npos) << sentence(std::nullopt, range);
}

TEST(Session, WhatTheSourceComplainsAboutIsHandedOn) {
  class BadSource : public SkeletonSource {
   public:
    Result<std::optional<SkeletonFrame>> next() override { return Error{ErrorCode::kBadFormat, "line 7 is damaged"}; }
  };
  Session session = test::valueOf(
      Session::create(makeMannequin(), eightParts(),
                      makeJointPoseSource(makeMannequin().skeleton, std::make_unique<BadSource>()).value(), World()));
  const Result<bool> more = session.step();
  ASSERT_FALSE(more.ok());
  EXPECT_EQ(more.error().message, "line 7 is damaged");
  EXPECT_EQ(session.frameCount(), 0);
}

}  // namespace
}  // namespace lorica
