#include "session/session_springs.h"

#include "acd/decompose.h"
#include "capture/files/joint_csv.h"
#include "session/recording/session_file.h"
#include "session/recording/session_recorder.h"
#include "session/recording/session_replay.h"
#include "session/session.h"
#include "session/stream_pose_source.h"
#include "session/treated_source.h"
#include "skinning/body/closed_body.h"
#include "skinning/import/character_file.h"
#include "skinning/linear_blend.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/session/haired_box.h"
#include "tests/session/small_session.h"
#include "tests/support/allocations.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace lorica {
namespace {

using Weights = std::vector<NamedWeight>;

const SpringJoint kLoose{.stiffness = 0.05, .gravityPower = 0.3, .dragForce = 0.1, .hitRadius = 0.02};

/// Sways to the side and back, faster and faster.
JointTransform swaying(double time) {
  JointTransform place;
  place.translation.x() = 0.4 * std::sin(3.0 * time * (1.0 + 0.5 * time));
  return place;
}

/// Leans over, so that gravity pulls the hair through the box.
JointTransform leaning(double time) {
  JointTransform place;
  place.rotation = Quat(Eigen::AngleAxisd(std::min(1.2 * time, 1.5), Vec3::UnitZ()));
  return place;
}

Session sessionOf(SkeletalMotion motion, World world = World()) {
  return Session::create(test::hairedBox(), test::hairedBoxParts(), makeMotionPoseSource(std::move(motion)),
                         std::move(world))
      .value();
}

void runToEnd(Session& session) {
  while (*session.step()) continue;
}

/// Signed distance of a tail from the box of the body as it stands: below 0 inside.
double distanceFromBody(const Session& session, const Vec3& tail) {
  const Vec3 local = session.worldFromJoint()[0].inverse() * tail - Vec3(0.0, 1.0, 0.0);
  return (local.cwiseAbs() - Vec3(0.2, 0.5, 0.2)).maxCoeff();
}

TEST(SessionSprings, TheUsualModeDependsOnTheFilesColliders) {
  SpringBones springs = test::hairedBoxSprings(kLoose);
  EXPECT_EQ(usualSpringMode(springs), SpringMode::kBody);
  springs.colliders.push_back({.joint = 0, .radius = 0.1});
  EXPECT_EQ(usualSpringMode(springs), SpringMode::kFile);
  for (const SpringMode mode : {SpringMode::kNone, SpringMode::kFile, SpringMode::kBody}) {
    EXPECT_EQ(springModeNamed(nameOf(mode)), mode);
  }
  EXPECT_FALSE(springModeNamed("all"));
}

TEST(SessionSprings, BadOnesAreRefused) {
  Session session = sessionOf(test::hairedBoxMotion(1, swaying));
  SpringBones springs = test::hairedBoxSprings(kLoose);
  springs.chains[0].joints[0].joint = 9;
  EXPECT_FALSE(session.setSprings(springs, SpringMode::kFile).ok());
  EXPECT_EQ(session.springs(), nullptr);
}

TEST(SessionSprings, ModeNoneChangesNothing) {
  Session without = sessionOf(test::hairedBoxMotion(60, swaying));
  Session with = sessionOf(test::hairedBoxMotion(60, swaying));
  ASSERT_TRUE(with.setSprings(test::hairedBoxSprings(kLoose), SpringMode::kNone).ok());
  runToEnd(without);
  runToEnd(with);
  EXPECT_EQ(without.hash(), with.hash());
}

TEST(SessionSprings, SwingingHairPushesProps) {
  // A light ball hangs in the air where only hair that swings out gets.
  const auto pushed = [](SpringMode mode) {
    World::Settings settings;
    settings.gravity.setZero();
    World world(settings);
    Prop ball;
    ball.shape = PropShape::kSphere;
    ball.halfExtents.setConstant(0.05);
    ball.mass = 0.1;
    ball.worldFromProp.translation() = Vec3(0.74, 0.85, 0.0);
    world.addProp(ball);
    Session session = sessionOf(test::hairedBoxMotion(240, swaying), std::move(world));
    EXPECT_TRUE(session.setSprings(test::hairedBoxSprings(kLoose), mode).ok());
    double farthest = 0.0;
    int hairTouches = 0;
    while (*session.step()) {
      for (const Contact& contact : session.world().contacts()) hairTouches += contact.part == 1 ? 1 : 0;
      const Vec3 moved = session.world().props()[0].worldFromProp.translation() - Vec3(0.74, 0.85, 0.0);
      farthest = std::max(farthest, moved.norm());
    }
    EXPECT_EQ(hairTouches > 0, farthest > 1e-6);
    return farthest;
  };
  EXPECT_LT(pushed(SpringMode::kNone), 1e-6);  // single precision
  EXPECT_GT(pushed(SpringMode::kFile), 0.2);
}

TEST(SessionSprings, HairLiesOnTheHullsOfTheBody) {
  const auto deepest = [](SpringMode mode) {
    Session session = sessionOf(test::hairedBoxMotion(300, leaning));
    EXPECT_TRUE(session.setSprings(test::hairedBoxSprings(kLoose), mode).ok());
    double least = kInfinity;
    while (*session.step()) {
      for (const Vec3& tail : session.springs()->simulation().tails()) {
        least = std::min(least, distanceFromBody(session, tail));
      }
    }
    return least;
  };
  EXPECT_LT(deepest(SpringMode::kFile), -0.1) << "without colliders it falls through";
  EXPECT_GE(deepest(SpringMode::kBody), 0.02 - 1e-6) << "the hit radius is kept from the hulls";
}

TEST(SessionSprings, HairDoesNotCollideWithItself) {
  // At rest nothing pushes it, although every tail lies in the hull of the hair.
  Session session = sessionOf(test::hairedBoxMotion(120, [](double) { return JointTransform(); }));
  ASSERT_TRUE(
      session.setSprings(test::hairedBoxSprings({.stiffness = 1.0, .hitRadius = 0.02}), SpringMode::kBody).ok());
  while (*session.step()) {
    for (int j = 1; j < 4; ++j) {
      EXPECT_LT((session.worldFromJoint()[j].translation() - Vec3(0.25, 1.4 - 0.2 * (j - 1), 0.0)).norm(), 1e-9);
    }
  }
}

TEST(SessionSprings, TailsAtRestInTheBodyStayWhereTheyAre) {
  // Hit radii so large that all tails lie within them: they keep their distance at rest.
  Session session = sessionOf(test::hairedBoxMotion(60, [](double) { return JointTransform(); }));
  ASSERT_TRUE(session.setSprings(test::hairedBoxSprings({.stiffness = 1.0, .hitRadius = 0.2}), SpringMode::kBody).ok());
  runToEnd(session);
  EXPECT_LT((session.springs()->simulation().tails()[2] - Vec3(0.25, 0.8, 0.0)).norm(), 1e-9);
}

TEST(SessionSprings, RestartAndJumpsStartAtRest) {
  SkeletalMotion motion = test::hairedBoxMotion(90, swaying);
  Session session = sessionOf(motion);
  ASSERT_TRUE(session.setSprings(test::hairedBoxSprings(kLoose), SpringMode::kBody).ok());
  runToEnd(session);
  const std::uint64_t hash = session.hash();
  session.restart(makeMotionPoseSource(motion), World());
  runToEnd(session);
  EXPECT_EQ(session.hash(), hash);

  for (std::size_t f = 60; f < motion.times.size(); ++f) motion.times[f] += 5.0;
  session.restart(makeMotionPoseSource(motion), World());
  for (int f = 0; f < 60; ++f) ASSERT_TRUE(*session.step());
  const Quat upright = Quat::Identity();
  EXPECT_GT(Quat(session.worldFromJoint()[1].rotation()).angularDistance(upright), 0.01);
  ASSERT_TRUE(*session.step());
  EXPECT_LT(Quat(session.worldFromJoint()[1].rotation()).angularDistance(upright), 1e-7);
}

TEST(SessionSprings, AnotherBodyIsTakenOver) {
  Session session = sessionOf(test::hairedBoxMotion(300, leaning));
  ASSERT_TRUE(session.setSprings(test::hairedBoxSprings(kLoose), SpringMode::kBody).ok());
  for (int f = 0; f < 10; ++f) ASSERT_TRUE(*session.step());
  session.setBody(BodyPlan::create(test::hairedBoxParts(), test::hairedBox()).value());
  while (*session.step()) {
    EXPECT_GE(distanceFromBody(session, session.springs()->simulation().tails()[2]), 0.02 - 1e-6);
  }
}

TEST(SessionSprings, AStepAllocatesNothing) {
  World world;
  world.addProp({});
  Session session = sessionOf(test::hairedBoxMotion(200, swaying), std::move(world));
  ASSERT_TRUE(session.setSprings(test::hairedBoxSprings(kLoose), SpringMode::kBody).ok());
  for (int f = 0; f < 100; ++f) ASSERT_TRUE(*session.step());
  const long before = test::allocationCount();
  for (int f = 0; f < 90; ++f) ASSERT_TRUE(*session.step());
  EXPECT_EQ(test::allocationCount() - before, 0);
}

/// How far the hair of a session gets into the hulls of its body.
struct Inside {
  int samples = 0;
  int inside = 0;           ///< deeper than at rest
  int beyondHitRadius = 0;  ///< deeper than the hit radius
  double deepest = 0.0;     ///< of a tail [m]
};

/// Tails against the hulls of the same frame. Pairs that ignore each other, see LiveObstacles, do not count.
Inside insideOf(Session& session) {
  const Character& character = session.character();
  LiveObstacles hulls(session.body(), character, session.springs()->simulation());
  const auto partCount = static_cast<PartIndex>(session.body().parts().size());
  const auto depth = [&](std::size_t spring, PartIndex part, const Vec3& tail) {
    return std::max(0.0, -hulls.distance(spring, part, tail).value_or(0.0));
  };
  std::vector<Affine3> worldFromJoint(character.jointFromModel.size());
  std::vector<Affine3> worldFromModel(worldFromJoint.size());
  computeWorldFromJoint(character.skeleton, restPose(character.skeleton), worldFromJoint);
  computeWorldFromModel(character, worldFromJoint, worldFromModel);
  LiveBody atRest(session.body().plan());
  atRest.update(worldFromModel);
  hulls.prepare(atRest.parts(), worldFromModel, worldFromModel, {}, 0.0);
  hulls.moveTo(1.0);
  const std::span<const SpringJoint> joints = session.springs()->simulation().joints();
  std::vector<double> restDepths;
  for (std::size_t s = 0; s < joints.size(); ++s) {
    for (PartIndex p = 0; p < partCount; ++p) {
      restDepths.push_back(depth(s, p, worldFromJoint[joints[s].joint] * joints[s].tail));
    }
  }

  Inside result;
  while (*session.step()) {
    computeWorldFromModel(character, session.worldFromJoint(), worldFromModel);
    hulls.prepare(session.body().parts(), worldFromModel, worldFromModel, {}, 0.0);
    hulls.moveTo(1.0);
    for (std::size_t s = 0; s < joints.size(); ++s) {
      bool inside = false;
      double deepest = 0.0;
      for (PartIndex p = 0; p < partCount; ++p) {
        const double now = depth(s, p, session.springs()->simulation().tails()[s]);
        inside =
            inside || now > restDepths[s * static_cast<std::size_t>(partCount) + static_cast<std::size_t>(p)] + 1e-4;
        deepest = std::max(deepest, now);
      }
      ++result.samples;
      result.inside += inside ? 1 : 0;
      result.beyondHitRadius += deepest > joints[s].hitRadius ? 1 : 0;
      result.deepest = std::max(result.deepest, deepest);
    }
  }
  return result;
}

TEST(SessionSprings, GodettesHairStaysOutOfHerBody) {
  LORICA_REQUIRE_DATASET(path, "characters/godette/Godette_vrm_v4.vrm");
  const CharacterFile file = test::valueOf(readCharacterFile(path));
  const Character character = makeBody(file.character).value().character;
  DecomposeSettings settings;
  settings.maxParts = 16;
  const PoseView bindPose{character.mesh.vertices, static_cast<int>(character.mesh.vertices.size())};
  const Decomposition parts = decompose(character.mesh, bindPose, settings).value();
  for (const char* recording : {"walk", "punch_and_kick", "jumping_jacks", "turn_around"}) {
    for (const SpringMode mode : {SpringMode::kFile, SpringMode::kBody}) {
      auto frames = makeRecordedSource(test::shippedFrames(recording, 100'000));
      Session session =
          Session::create(character, parts, makeJointPoseSource(character, std::move(frames)).value(), World()).value();
      ASSERT_TRUE(session.setSprings(file.springs, mode).ok());
      const Inside inside = insideOf(session);
      std::printf("%s, %s: of %d samples %.2f %% deeper than at rest, %d deeper than the hit radius, deepest %.1f mm\n",
                  recording, nameOf(mode).data(), inside.samples, 100.0 * inside.inside / inside.samples,
                  inside.beyondHitRadius, 1e3 * inside.deepest);
      EXPECT_GT(inside.samples, 1000);
      if (mode != SpringMode::kBody) continue;
      // In two frames of the jumping jacks an arm passes through the side of the head and squeezes a lock.
      EXPECT_EQ(inside.beyondHitRadius, 0) << recording;
      EXPECT_LT(inside.deepest, 0.02) << recording;
    }
  }
}

/// Records the haired box to a file. @return its header
SessionHeader recordTo(const std::filesystem::path& file, SpringMode mode) {
  const SpringBones springs = test::hairedBoxSprings(kLoose);
  const SkeletalMotion motion = test::hairedBoxMotion(90, swaying);
  SessionHeader header = test::headerOf(sessionOf(motion));
  header.avatar().poseJoints = motion.skeleton.jointCount();
  header.avatar().springs = mode;
  header.avatar().springsHash = hashOf(springs);
  const auto recorder = SessionRecorder::start(file, header, "").value();
  Session session =
      Session::create(test::hairedBox(), test::hairedBoxParts(),
                      makeTreatedSource(makeMotionPoseSource(motion), {recorder->log(), {}, {}}).value(), World())
          .value();
  EXPECT_TRUE(session.setSprings(springs, mode).ok());
  session.watch(recorder);
  runToEnd(session);
  EXPECT_EQ(*recorder->finish(), 90);
  return header;
}

TEST(SessionSprings, AReplayGivesTheSameHashes) {
  const test::TemporaryFolder folder;
  for (const SpringMode mode : {SpringMode::kNone, SpringMode::kFile, SpringMode::kBody}) {
    const std::filesystem::path file = folder.path() / "sway.lsession";
    const SessionHeader header = recordTo(file, mode);
    SessionFile read = test::valueOf(readSession(file));
    EXPECT_EQ(read.header.avatar().springs, mode);
    EXPECT_EQ(read.header.avatar().springsHash, header.avatar().springsHash);
    const auto recorded = std::make_shared<const SessionFile>(std::move(read));
    Session session = Session::create(test::hairedBox(), test::hairedBoxParts(),
                                      SessionReplay::source(*recorded, test::hairedBox()).value(), World())
                          .value();
    EXPECT_FALSE(checkReplay(recorded->header, "sway", session).ok()) << "the springs are missing";
    SpringBones other = test::hairedBoxSprings(kLoose);
    other.chains[0].joints[1].stiffness += 1e-9;
    ASSERT_TRUE(session.setSprings(other, mode).ok());
    EXPECT_FALSE(checkReplay(recorded->header, "sway", session).ok()) << "they differ";
    ASSERT_TRUE(session.setSprings(test::hairedBoxSprings(kLoose), mode).ok());
    ASSERT_TRUE(checkReplay(recorded->header, "sway", session).ok());
    const auto replay = std::make_shared<SessionReplay>(recorded);
    session.watch(replay);
    runToEnd(session);
    EXPECT_TRUE(replay->over());
    EXPECT_FALSE(replay->difference()) << replay->difference()->what;
  }
}

TEST(SessionSprings, AHeaderWithAnUnknownModeIsRefused) {
  SessionHeader header;
  header.avatar().springs = SpringMode::kBody;
  std::string text = textOf(header);
  ASSERT_TRUE(parseSessionHeader(text, "s").ok());
  text.replace(text.find("\"body\""), 6, "\"both\"");
  EXPECT_TRUE(test::has(test::errorOf(parseSessionHeader(text, "s")).message, "none, file or body"));
}

/// A character at rest whose face and trust change from frame to frame; frame 3 has another sender's names.
class TalkingSource final : public PoseSource {
 public:
  explicit TalkingSource(int frames) : frames_(frames), trust_(makeMannequin().skeleton.joints().size()) {}

  Result<std::optional<double>> next(std::span<JointTransform> /*pose*/) override {
    if (frame_ + 1 == frames_) return std::optional<double>();
    ++frame_;
    expressions_ = of(frame_);
    trust_.assign(trust_.size(), trustOf(frame_));
    return std::optional<double>(frame_ / 30.0);
  }
  [[nodiscard]] std::span<const double> trust() const override { return trust_; }
  [[nodiscard]] std::span<const NamedWeight> expressions() const override { return expressions_; }

  static Weights of(int frame) {
    if (frame == 0) return {};
    if (frame == 3) return {{"Sorrow", 1.0f}};
    return {{"Joy", 0.1f * static_cast<float>(frame)}, {std::string(100, 'x'), 1.0f / 3.0f}};
  }
  static double trustOf(int frame) { return 0.1 * frame; }

 private:
  int frames_;
  int frame_ = -1;
  Weights expressions_;
  std::vector<double> trust_;
};

Weights copyOf(std::span<const NamedWeight> expressions) {
  return {expressions.begin(), expressions.end()};
}

TEST(SessionExpressions, AreReplayedBitForBit) {
  constexpr int kFrames = 6;
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "face.lsession";
  SessionHeader header = test::headerOf(test::demoSession(makeMotionPoseSource({})));
  header.avatar().poseJoints = makeMannequin().skeleton.jointCount();
  header.avatar().poseTrust = header.avatar().poseExpressions = true;
  {
    const auto recorder = SessionRecorder::start(file, header, "").value();
    Session session =
        test::demoSession(makeLoggedSource(std::unique_ptr<PoseSource>(new TalkingSource(kFrames)), recorder->log()));
    session.watch(recorder);
    while (*session.step())
      EXPECT_EQ(copyOf(session.source().expressions()), TalkingSource::of(session.frameCount() - 1));
    ASSERT_EQ(recorder->finish().value(), kFrames);
  }
  const Result<SessionFile> read = readSession(file);
  ASSERT_TRUE(read) << read.error().message;
  const auto recorded = std::make_shared<const SessionFile>(*read);
  Session session = test::demoSession(SessionReplay::source(*recorded, makeMannequin()).value());
  const auto replay = std::make_shared<SessionReplay>(recorded);
  session.watch(replay);
  for (int frame = 0; frame < kFrames; ++frame) {
    ASSERT_TRUE(*session.step());
    EXPECT_EQ(copyOf(session.source().expressions()), TalkingSource::of(frame)) << frame;
  }
  EXPECT_FALSE(replay->difference());
}

/// A sender who winks ever more.
class WinkingStream final : public BoneStream {
 public:
  bool wait(double /*seconds*/, BoneFrame& frame) override {
    if (ended()) return false;
    ++frames_;
    frame.time = now();
    frame.expressions = {{"Blink_L", 0.1f * static_cast<float>(frames_)}, {"Joy", 0.5f}};
    if (frames_ > 2) frame.expressions.push_back({"mouthSmileRight", 0.25f});
    return true;
  }
  [[nodiscard]] bool ready() const override { return !ended(); }
  [[nodiscard]] bool ended() const override { return frames_ == 4; }
  [[nodiscard]] double now() const override { return frames_ / 30.0; }

 private:
  int frames_ = 0;
};

TEST(SessionExpressions, OfAMirroredStreamAreThoseOfTheOtherSide) {
  for (const bool mirror : {false, true}) {
    StreamSettings settings;
    settings.mirror = mirror;
    const auto source = makeStreamPoseSource(makeMannequin(), std::make_unique<WinkingStream>(), settings).value();
    Pose pose = restPose(makeMannequin().skeleton);
    for (int frame = 1; frame <= 4; ++frame) {
      ASSERT_TRUE(*source->next(pose));
      Weights expected = {{mirror ? "Blink_R" : "Blink_L", 0.1f * static_cast<float>(frame)}, {"Joy", 0.5f}};
      if (frame > 2) expected.push_back({mirror ? "mouthSmileLeft" : "mouthSmileRight", 0.25f});
      EXPECT_EQ(copyOf(source->expressions()), expected) << frame;
    }
    EXPECT_FALSE(*source->next(pose));
  }
}

TEST(SessionExpressions, HaveASideThatTheirNamesEndIn) {
  for (const auto& [left, right] : {std::pair("blinkLeft", "blinkRight"),
                                    {"eyeLookOutLeft", "eyeLookOutRight"},
                                    {"blink_l", "blink_r"},
                                    {"BLINKLEFT", "BLINKRIGHT"}}) {
    EXPECT_EQ(mirroredExpression(left), right);
    EXPECT_EQ(mirroredExpression(right), left);
  }
  for (const char* both : {"Joy", "", "L", "LeftBehind", "smile_Left_2"}) EXPECT_EQ(mirroredExpression(both), both);
}

/// A frozen pose has the trust and the face that it had.
TEST(SessionExpressions, FaultsOfPosesKeepTrustAndExpressionsTogether) {
  Pose pose = restPose(makeMannequin().skeleton);
  for (const char* text : {"freeze=0.3,seed=2", "late=0.3,seed=2"}) {
    const auto source =
        makePoseFaults(std::unique_ptr<PoseSource>(new TalkingSource(60)), parseFaults(text).value()).value();
    int frames = 0;
    for (Result<std::optional<double>> time = source->next(pose); *time; time = source->next(pose)) {
      ++frames;
      const int shown = static_cast<int>(std::lround(10.0 * source->trust()[0]));
      EXPECT_EQ(source->trust()[0], TalkingSource::trustOf(shown));
      EXPECT_EQ(copyOf(source->expressions()), TalkingSource::of(shown)) << text << ", frame " << frames;
    }
    EXPECT_GT(frames, 20);
  }
}

TEST(SessionExpressions, WrongOnesAreASentence) {
  const auto sentence = [](const std::string& expressions) {
    SessionHeader header;
    header.avatar().poseJoints = 1;
    header.avatar().poseExpressions = true;
    std::string bytes(kSessionMagic);
    std::uint64_t chain = 0;
    appendBlock(BlockKind::kHeader, textOf(header), chain, bytes);
    appendBlock(BlockKind::kScene, "", chain, bytes);
    ByteWriter step;
    step.put(0.0);
    for (int i = 0; i < 3; ++i) step.put(std::uint64_t{0});
    for (const std::uint32_t count : {0u, 1u}) step.put(count);
    for (const double number : {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0}) step.put(number);
    step.put(std::string_view(expressions));
    appendBlock(BlockKind::kStep, step.bytes(), chain, bytes);
    appendBlock(BlockKind::kEnd, "", chain, bytes);
    const Result<SessionFile> read = parseSession(bytes, "s");
    return read ? std::string("none") : read.error().message;
  };
  ByteWriter good;
  putExpressions(Weights{{"Joy", 0.5f}}, good);
  const std::string one(good.bytes());
  EXPECT_EQ(sentence(one), "none");
  const auto has = [&](const std::string& bytes, const std::string& text) {
    EXPECT_TRUE(test::has(sentence(bytes), text));
  };
  has(one.substr(0, one.size() - 1), "step 0 is truncated");
  has(one + "x", "step 0 holds 1 byte too many");
  has("\xff\xff" + one.substr(2), "found 65535 expressions, expected at most 256");
  has(one.substr(0, 2) + "\x81" + one.substr(3), "found a name of 129 bytes, expected at most 128");
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const float weight : {nan, -0.5f, 1.5f}) {
    ByteWriter bad;
    putExpressions(Weights{{"Joy", weight}}, bad);
    has(std::string(bad.bytes()), "found an expression of weight");
  }
}

TEST(SessionExpressions, TooManyAndTooLongNamesAreLeftOut) {
  Weights many(300, {"Joy", 0.5f});
  many[0].name = std::string(200, 'x');
  ByteWriter bytes;
  putExpressions(many, bytes);
  EXPECT_EQ(bytes.bytes().size(), 2u + 256u * (1u + 3u + 4u));
}

}  // namespace
}  // namespace lorica
