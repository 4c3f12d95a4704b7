#include "session/pose_faults.h"
#include "session/recording/session_blocks.h"
#include "session/recording/session_replay.h"
#include "session/stream_pose_source.h"
#include "session/treated_source.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/session/small_session.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace lorica {
namespace {

using Weights = std::vector<NamedWeight>;

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
    EXPECT_NE(sentence(bytes).find(text), std::string::npos) << sentence(bytes);
  };
  has(one.substr(0, one.size() - 1), "step 0 is truncated");
  has(one + "x", "step 0 holds 1 bytes too many");
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
