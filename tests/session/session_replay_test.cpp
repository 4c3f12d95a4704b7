#include "session/recording/session_replay.h"

#include "capture/files/joint_csv.h"
#include "collision/particles/particles.h"
#include "geometry/files.h"
#include "session/recording/session_file.h"
#include "session/treated_source.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/session/small_session.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <csignal>
#include <memory>
#include <ostream>
#include <string>

namespace lorica {
namespace {

namespace fs = std::filesystem;

/// Replays a recorded session to its end.
std::optional<SessionReplay::Difference> replayed(const SessionFile& file, int* steps = nullptr) {
  const auto recorded = std::make_shared<const SessionFile>(file);
  std::unique_ptr<PoseSource> source = test::valueOf(SessionReplay::source(*recorded, makeMannequin()));
  Session session = test::demoSession(std::move(source));
  EXPECT_TRUE(checkReplay(recorded->header, "s", session).ok());
  const auto replay = std::make_shared<SessionReplay>(recorded);
  session.watch(replay);
  while (!replay->over()) {
    const Result<bool> more = session.step();
    EXPECT_TRUE(more.ok());
    if (!more || !*more) break;
  }
  EXPECT_TRUE(replay->over());
  if (steps != nullptr) *steps = replay->steps();
  return replay->difference();
}

SessionFile recorded(const FaultSettings& faults, const JointSettings& joints = {}) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "s.lsession";
  EXPECT_GT(test::recordJoints(file, test::shippedFrames("punch_and_kick", 60, 5.0), faults, joints), 20);
  EXPECT_FALSE(fs::exists(folder.path() / "s.part.lsession"));
  Result<SessionFile> read = readSession(file);
  EXPECT_TRUE(read.ok()) << read.error().message;
  return std::move(read).value();
}

TEST(SessionReplay, GivesTheSameAgainWithBallsGrabsFaultsAndSmoothing) {
  FaultSettings faults = parseFaults("dropout=0.1,jitter=0.02,swap=0.1,late=0.1,freeze=0.1,seed=7").value();
  int steps = 0;
  const SessionFile plain = recorded({});
  EXPECT_FALSE(replayed(plain, &steps).has_value());
  EXPECT_EQ(steps, 60);
  EXPECT_EQ(plain.actions.size(), 4u);
  JointSettings joints;
  joints.mirror = true;
  joints.smoothing = OneEuroSettings();
  const SessionFile faulty = recorded(faults, joints);
  EXPECT_FALSE(replayed(faulty).has_value());
  EXPECT_NE(faulty.steps.back().hashes, plain.steps.back().hashes);
}

/// Two hands hold a prop each, then both hold one of them; `other` hand does what the second one is told.
SessionFile ofTwoHands(int other) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "hands.lsession";
  SessionHeader header = test::headerOf(test::demoSession(makeMotionPoseSource({})));
  const auto recorder = SessionRecorder::start(file, header, "").value();
  Session session = test::demoSession(
      makeTreatedSource(makeMannequin(), makeRecordedSource(test::shippedFrames("walk", 60)), {recorder->log(), {}, {}})
          .value());
  session.watch(recorder);
  const auto at = [&](int prop) { return Vec3(session.world().props()[prop].worldFromProp.translation()); };
  for (int frame = 0; session.step().value(); ++frame) {
    if (frame == 5) session.act(WorldAction::grab(0, at(0), 0));
    if (frame == 6) session.act(WorldAction::grab(1, at(1), other));
    if (frame == 30) session.act(WorldAction::grab(0, at(0), other));
    for (const int hand : {0, other}) {
      if (frame > 6 && frame < 45) session.act(WorldAction::moveGrab({0.02 * frame - hand, 1.0, 0.8}, hand));
    }
    if (frame == 45) session.act(WorldAction::release({1.0, 2.0, 0.0}, 0));
    if (frame == 50) session.act(WorldAction::release({0.0, 3.0, 1.0}, other));
  }
  EXPECT_GT(recorder->finish().value(), 50);
  return readSession(file).value();
}

TEST(SessionReplay, GivesTheSameAgainWithAPropInEachHandAndOneInBoth) {
  const SessionFile two = ofTwoHands(1);
  EXPECT_EQ(std::ranges::count_if(two.actions, [](const WorldAction& action) { return action.hand == 1; }), 41);
  EXPECT_FALSE(replayed(two).has_value());
  EXPECT_NE(ofTwoHands(0).steps.back().hashes, two.steps.back().hashes) << "one hand does something else";
}

TEST(SessionReplay, SaysTheFirstStepThatDiffersAndWhatOfIt) {
  const SessionFile plain = recorded({});
  SessionFile bent = plain;
  TrackedJoint& hand = bent.motions[0].joints[31][BodyJoint::kRightHand];
  hand.orientation.reset();
  hand.position.x() += 0.05;
  const auto moved = replayed(bent);
  ASSERT_TRUE(moved.has_value());
  EXPECT_EQ(moved->step, 31);
  EXPECT_EQ(moved->time, plain.steps[31].time);
  EXPECT_TRUE(test::has(moved->what, "hulls"));

  // A slightly slower ball does not change the hulls.
  SessionFile slower = plain;
  slower.actions[0].velocity.z() += 1e-6;
  const auto props = replayed(slower);
  ASSERT_TRUE(props.has_value());
  EXPECT_EQ(props->step, 5);
  EXPECT_EQ(props->what, "props");
}

TEST(SessionReplay, OtherFaultsDiffer) {
  SessionFile file = recorded(parseFaults("dropout=0.2,seed=7").value());
  file.header.avatar().faults.seed = 8;
  const auto difference = replayed(file);
  ASSERT_TRUE(difference.has_value());
  EXPECT_LT(difference->step, 10);
}

TEST(SessionReplay, OtherCharactersBodiesAndScenesAreRefusedInASentence) {
  const Session session = test::demoSession(makeMotionPoseSource({}));
  const SessionHeader header = test::headerOf(session);
  EXPECT_TRUE(checkReplay(header, "s", session).ok());
  const auto sentence = [&](auto change) {
    SessionHeader other = header;
    change(other);
    const Result<void> checked = checkReplay(other, "s.lsession", session);
    return checked ? std::string("none") : checked.error().message;
  };
  EXPECT_TRUE(test::has(sentence([](SessionHeader& h) { ++h.avatar().characterHash; }), "specify it with --character"));
  EXPECT_TRUE(test::has(sentence([](SessionHeader& h) { ++h.avatar().decompositionHash; }), "another decomposition"));
  EXPECT_TRUE(test::has(sentence([](SessionHeader& h) { ++h.avatar().trainingHash; }), "trained on other poses"));
  EXPECT_TRUE(test::has(sentence([](SessionHeader& h) { ++h.worldHash; }), "the scene differs from the recording"));
}

/// Poses of the mannequin, as in an animation clip.
SkeletalMotion poses() {
  return perform(makeMannequin().skeleton, test::shippedFrames("wave", 40, 2.0)).value();
}

TEST(SessionReplay, PosesAreRecordedWhereThereAreNoJoints) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "s.lsession";
  const FaultSettings faults = parseFaults("late=0.2,freeze=0.3,seed=3").value();
  SessionHeader header = test::headerOf(test::demoSession(makeMotionPoseSource({})));
  header.avatar().poseJoints = makeMannequin().skeleton.jointCount();
  header.avatar().faults = faults;
  const auto recorder = SessionRecorder::start(file, header, "").value();
  Session session =
      test::demoSession(makeTreatedSource(makeMotionPoseSource(poses()), {recorder->log(), faults, {}}).value());
  session.watch(recorder);
  while (session.step().value()) continue;
  EXPECT_LT(session.frameCount(), 40);
  ASSERT_EQ(recorder->finish().value(), session.frameCount());
  const SessionFile read = readSession(file).value();
  EXPECT_EQ(read.motions[0].poseTimes.size(), 40u);
  EXPECT_TRUE(read.motions[0].joints.empty());
  EXPECT_FALSE(replayed(read).has_value());
}

TEST(SessionRecorder, WhatIsOnDiskAfterEachStepIsAllOfTheStepsSoFar) {
  const test::TemporaryFolder folder;
  const fs::path part = folder.path() / "s.part.lsession";
  const auto recorder = SessionRecorder::start(folder.path() / "s.lsession",
                                               test::headerOf(test::demoSession(makeMotionPoseSource({}))), "")
                            .value();
  Session session = test::demoSession(
      makeTreatedSource(makeMannequin(), makeRecordedSource(test::shippedFrames("walk", 12)), {recorder->log(), {}, {}})
          .value());
  session.watch(recorder);
  for (std::size_t step = 1; session.step().value(); ++step) {
    const SessionFile sofar = test::valueOf(readSession(part));
    EXPECT_EQ(sofar.steps.size(), step);
    EXPECT_FALSE(sofar.finished);
    EXPECT_EQ(sofar.notes.size(), 1u);
    EXPECT_EQ(sofar.steps.back().hashes, session.hashes());
  }
}

TEST(SessionRecorder, WithoutAStepThereIsNoFile) {
  const test::TemporaryFolder folder;
  const auto recorder = SessionRecorder::start(folder.path() / "s.lsession",
                                               test::headerOf(test::demoSession(makeMotionPoseSource({}))), "")
                            .value();
  EXPECT_EQ(recorder->finish().value(), 0);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(SessionRecorder, AMissingFolderAndAFullDiskAreReported) {
  const SessionHeader header = test::headerOf(test::demoSession(makeMotionPoseSource({})));
  const auto nowhere = SessionRecorder::start("nowhere/s.lsession", header, "");
  ASSERT_FALSE(nowhere.ok());
  EXPECT_EQ(nowhere.error().message, "nowhere/s.part.lsession: cannot be written: No such file or directory");
  const test::TemporaryFolder folder;
  // As on a full disk: no file of this process may be longer than 16 bytes.
  rlimit usual{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &usual), 0);
  const rlimit tiny{16, usual.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &tiny), 0);
  const auto full = SessionRecorder::start(folder.path() / "s.lsession", header, "");
  setrlimit(RLIMIT_FSIZE, &usual);
  std::signal(SIGXFSZ, handler);
  ASSERT_FALSE(full.ok());
  EXPECT_TRUE(test::has(full.error().message, "File too large"));
}

TEST(SessionRecorder, EndsWhereTheFileIsFull) {
  constexpr std::uint64_t kMaxBytes = 20'000;
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "s.lsession";
  const auto recorder =
      SessionRecorder::start(file, test::headerOf(test::demoSession(makeMotionPoseSource({}))), "", kMaxBytes).value();
  Session session = test::demoSession(
      makeTreatedSource(makeMannequin(), makeRecordedSource(test::shippedFrames("walk", 60)), {recorder->log(), {}, {}})
          .value());
  session.watch(recorder);
  while (session.step().value()) continue;
  EXPECT_TRUE(recorder->full());
  const int steps = recorder->finish().value();
  EXPECT_GT(steps, 0);
  EXPECT_LT(steps, 60);
  EXPECT_LE(fs::file_size(file), kMaxBytes);
  EXPECT_GT(fs::file_size(file), kMaxBytes * 3 / 4);
  const SessionFile read = readSession(file).value();
  EXPECT_TRUE(read.finished);
  EXPECT_FALSE(replayed(read).has_value());
}

TEST(SessionRecorder, EndsWhereTheSessionIsChanged) {
  const test::TemporaryFolder folder;
  const auto recorder = SessionRecorder::start(folder.path() / "s.lsession",
                                               test::headerOf(test::demoSession(makeMotionPoseSource({}))), "")
                            .value();
  Session session = test::demoSession(
      makeTreatedSource(makeMannequin(), makeRecordedSource(test::shippedFrames("walk", 12)), {recorder->log(), {}, {}})
          .value());
  session.watch(recorder);
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(session.step().value());
  session.setWorld(World());
  EXPECT_TRUE(recorder->cutShort());
  while (session.step().value()) continue;
  EXPECT_EQ(recorder->finish().value(), 4);
  EXPECT_FALSE(replayed(readSession(folder.path() / "s.lsession").value()).has_value());
}

TEST(PoseFaults, PosesFreezeAndComeLateAndHaveNoFaultsOfJoints) {
  const SkeletalMotion motion = poses();
  const std::unique_ptr<PoseSource> source =
      makePoseFaults(makeMotionPoseSource(motion), parseFaults("freeze=0.5,late=0.2,seed=2").value()).value();
  Pose pose = restPose(motion.skeleton), before = pose;
  int frozen = 0, late = 0, count = 0;
  double last = -1.0;
  while (const std::optional<double> time = source->next(pose).value()) {
    EXPECT_GT(*time, last);
    last = *time;
    late += std::find(motion.times.begin(), motion.times.end(), *time) == motion.times.end() ? 1 : 0;
    frozen += count > 0 && pose[3].rotation.coeffs() == before[3].rotation.coeffs() ? 1 : 0;
    before = pose;
    ++count;
  }
  EXPECT_LT(count, motion.frameCount());
  EXPECT_GT(frozen, count / 5);
  EXPECT_GT(late, 0);
  EXPECT_TRUE(
      test::has(test::errorOf(makePoseFaults(makeMotionPoseSource(motion), parseFaults("swap").value())).message,
                "expected late or freeze"));
  EXPECT_FALSE(makePoseFaults(makeMotionPoseSource(motion), FaultSettings()).value()->next(pose).value() ==
               std::nullopt);
}

TEST(Faults, AnAvatarStaysFiniteAndIsBelievedLess) {
  for (const char* text : {"dropout=0.5", "jitter=1", "swap=0.5", "late=0.5", "freeze=0.5", "dropout=1",
                           "dropout=0.3,jitter=0.2,swap=0.3,late=0.3,freeze=0.3,seed=4"}) {
    const FaultSettings faults = parseFaults(text).value();
    Session session = test::demoSession(makeTreatedSource(makeMannequin(),
                                                          makeRecordedSource(test::shippedFrames("punch_and_kick", 60)),
                                                          {nullptr, faults, {}})
                                            .value());
    double trust = 0.0;
    while (session.step().value()) {
      for (const LivePart& part : session.body().parts()) {
        ASSERT_TRUE(part.worldFromPart.matrix().allFinite()) << text;
        for (const Vec3& v : part.shape.vertices) ASSERT_TRUE(v.allFinite()) << text;
        trust += part.trust;
      }
      for (const Prop& prop : session.world().props()) ASSERT_TRUE(prop.worldFromProp.matrix().allFinite()) << text;
    }
    const double mean = trust / (8.0 * session.frameCount());
    if (faults.dropout > 0.0) {
      EXPECT_LT(mean, 1.0 - 0.5 * faults.dropout) << text;
    } else if (faults.freeze > 0.0) {
      EXPECT_GT(mean, 0.9) << text;
    }
  }
}

/// Expected hashes of a recording's session: the same for every build, compiler and number of threads. After an
/// intended change of poses, hulls or physics, copy the numbers that the test prints.
struct Known {
  const char* recording;
  double from;  ///< [s]
  std::uint64_t hulls, props;
};
void PrintTo(const Known& known, std::ostream* out) {
  *out << known.recording;
}

class ShippedSession : public testing::TestWithParam<Known> {};

constexpr std::size_t kFrames = 60;

TEST_P(ShippedSession, ComesOutTheSameOnOneThreadAndTwoAndAsItAlwaysDid) {
  const test::TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "s.lsession";
  const Known& known = GetParam();
  ASSERT_EQ(test::recordJoints(file, test::shippedFrames(known.recording, kFrames, known.from)),
            static_cast<int>(kFrames));
  const auto recorded = std::make_shared<const SessionFile>(readSession(file).value());
  for (const std::size_t threads : {std::size_t{1}, std::size_t{2}}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    Session session = test::demoSession(SessionReplay::source(*recorded, makeMannequin()).value());
    const auto replay = std::make_shared<SessionReplay>(recorded);
    session.watch(replay);
    while (!replay->over()) ASSERT_TRUE(session.step().value());
    EXPECT_FALSE(replay->difference().has_value())
        << threads << " threads, step " << replay->difference()->step << ": " << replay->difference()->what;
  }
  const SessionHashes& last = recorded->steps.back().hashes;
  EXPECT_TRUE(last.hulls == known.hulls && last.props == known.props)
      << std::hex << "{\"" << known.recording << "\", " << known.from << ", 0x" << last.hulls << "u, 0x" << last.props
      << "u},";
}

INSTANTIATE_TEST_SUITE_P(Recordings, ShippedSession,
                         testing::Values(Known{"jumping_jacks", 2.0, 0x7bdd095a7bff4158u, 0x51225b7a3633844au},
                                         Known{"punch_and_kick", 5.5, 0x5a89cf76bb5a6073u, 0x63d32af8fbad6548u},
                                         Known{"punch_and_kick_noisy", 5.5, 0xfc25369640325631u, 0x5a05ec79feb8a49eu},
                                         Known{"squat_and_reach", 2.0, 0x6004f3f40c419f12u, 0xe187c34d1ab963e0u},
                                         Known{"turn_around", 2.0, 0xed56417b00d47f4au, 0x5348e8e2d5ad342du},
                                         Known{"walk", 3.0, 0x733c4ed235d2db11u, 0xa5aef2a0da67fe7fu},
                                         Known{"walk_noisy", 3.0, 0x8b2044c1493cae45u, 0x7d8a05a41628aec8u},
                                         Known{"wave", 2.0, 0x2af4ccc9a839bfcu, 0x57b36fd63f7bb435u}),
                         [](const auto& param) { return std::string(param.param.recording); });

struct KnownParticles {
  ParticleSettings::Kind kind;
  std::uint64_t particles;
};

class KnownParticlesTest : public testing::TestWithParam<KnownParticles> {};

TEST_P(KnownParticlesTest, AroundAWalkerComeOutAsTheyAlwaysDid) {
  ParticleSettings settings;
  settings.kind = GetParam().kind;
  settings.walls = Aabb{Vec3(-0.3, 0.0, -0.5), Vec3(0.3, 2.0, 0.5)};
  settings.fills.push_back({Vec3(0.0, 0.15, 0.0), Vec3(0.6, 0.3, 1.0), 8000});
  Session session = test::demoSession(
      makeTreatedSource(makeMannequin(), makeRecordedSource(test::shippedFrames("walk", 20, 3.0)), {}).value());
  World world;
  EXPECT_TRUE(world.setParticles(settings));
  session.setWorld(std::move(world));
  while (session.step().value()) {
  }
  EXPECT_EQ(session.hashes().particles, GetParam().particles) << std::hex << session.hashes().particles;
}

INSTANTIATE_TEST_SUITE_P(Kinds, KnownParticlesTest,
                         testing::Values(KnownParticles{ParticleSettings::Kind::kSand, 0x2f356800a61ce4ddu},
                                         KnownParticles{ParticleSettings::Kind::kWater, 0x553d865e9c1c57a7u}),
                         [](const auto& param) {
                           return param.param.kind == ParticleSettings::Kind::kSand ? "sand" : "water";
                         });

}  // namespace
}  // namespace lorica
