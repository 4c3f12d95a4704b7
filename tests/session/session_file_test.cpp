#include "session/recording/session_file.h"

#include "geometry/files.h"
#include "geometry/random_numbers.h"
#include "geometry/work_budgets.h"
#include "tests/session/small_session.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <string>

namespace lorica {
namespace {

/// The bytes of a short session with everything that can be recorded.
const std::string& sessionBytes() {
  static const std::string bytes = [] {
    const test::TemporaryFolder folder;
    FaultSettings faults;
    faults.dropout = 0.1;
    faults.late = 0.2;
    test::recordJoints(folder.path() / "short.lsession", test::shippedFrames("punch_and_kick", 24, 3.0), faults);
    return readFile(folder.path() / "short.lsession").value();
  }();
  return bytes;
}

std::string sentenceFor(const std::string& bytes) {
  const Result<SessionFile> read = parseSession(bytes, "s.lsession");
  return read ? "none" : read.error().message;
}

TEST(SessionFile, HoldsWhatWasTakenBitForBit) {
  const std::vector<SkeletonFrame> frames = test::shippedFrames("punch_and_kick", 24, 3.0);
  const SessionFile read = test::valueOf(parseSession(sessionBytes(), "s.lsession"));
  EXPECT_TRUE(read.finished);
  EXPECT_TRUE(read.notes.empty());
  // Frames that a late one overtook are recorded too; frames after the last step were never shown.
  ASSERT_EQ(read.motions[0].joints.size(), frames.size());
  EXPECT_LT(read.steps.size(), frames.size());
  std::size_t taken = 0;
  for (const SessionStep& step : read.steps) taken += step.frames;
  EXPECT_EQ(taken, frames.size());
  for (std::size_t f = 0; f < frames.size(); ++f) {
    EXPECT_EQ(read.motions[0].joints[f].time, frames[f].time);
    EXPECT_EQ(read.motions[0].joints[f].user, frames[f].user);
    for (std::size_t j = 0; j < kBodyJointCount; ++j) {
      const TrackedJoint &a = read.motions[0].joints[f].joints[j], &b = frames[f].joints[j];
      EXPECT_EQ(a.position, b.position);
      EXPECT_EQ(a.confidence, b.confidence);
      ASSERT_EQ(a.orientation.has_value(), b.orientation.has_value());
      if (a.orientation) {
        EXPECT_EQ(a.orientation->coeffs(), b.orientation->coeffs());
      }
    }
  }
  ASSERT_EQ(read.actions.size(), 4u);
  EXPECT_EQ(read.actions[0].kind, WorldAction::Kind::kThrowBall);
  EXPECT_EQ(read.actions[0].velocity, Vec3(0.0, 1.0, -6.0));
  EXPECT_EQ(read.actions[1].kind, WorldAction::Kind::kGrab);
  EXPECT_EQ(read.actions[2].position, Vec3(0.3, 0.8, 0.8));
}

TEST(SessionFile, HeaderSaysEverythingAgain) {
  SessionHeader header;
  header.avatar().source = "a \"walk\"";
  header.avatar().poseJoints = 57;
  header.avatar().character = "my hero.glb";
  header.avatar().boneMap = "map.json";
  header.avatar().bodyResolution = 0.1 / 3.0;
  header.avatar().walls = "auto";
  header.avatar().thickness = 0.01;
  header.avatar().expressions = {"Joy=1", "A \"b\"=0.5"};
  header.avatar().hidden = {"1H_Axe", "A \"b\""};
  header.avatar().clip = "";
  header.avatar().characterHash = 0xffffffffffffffffu;
  header.avatar().decomposition = "b.lorica";
  header.avatar().decompositionHash = 1;
  header.avatar().coverTolerance = 0.002;
  header.avatar().hullVertices = 64;
  header.avatar().coverHash = 0x0123456789abcdefu;
  header.avatar().trainingHash = 3;
  header.avatar().joints.mirror = true;
  header.avatar().joints.smoothing = OneEuroSettings{1.0 / 7.0, 0.3};
  header.avatar().faults = parseFaults("dropout=0.1,swap,seed=9").value();
  header.scene = "bowling";
  header.sceneFolder = "scenes";
  header.sceneSeed = 5;
  header.worldHash = 77;
  const SessionHeader again = test::valueOf(parseSessionHeader(textOf(header), "s"));
  EXPECT_EQ(textOf(again), textOf(header));
  EXPECT_EQ(again.avatar().bodyResolution, header.avatar().bodyResolution);
  EXPECT_EQ(again.avatar().walls, header.avatar().walls);
  EXPECT_EQ(again.avatar().thickness, header.avatar().thickness);
  EXPECT_EQ(again.avatar().expressions, header.avatar().expressions);
  EXPECT_EQ(again.avatar().hidden, header.avatar().hidden);
  EXPECT_EQ(again.avatar().clip, header.avatar().clip);
  EXPECT_EQ(again.avatar().characterHash, header.avatar().characterHash);
  EXPECT_EQ(again.avatar().joints.smoothing->minCutoff, 1.0 / 7.0);
  EXPECT_EQ(again.avatar().faults.dropout, 0.1);
  EXPECT_EQ(again.avatar().faults.seed, 9u);
}

TEST(SessionFile, AvatarsAreReadUpToTheirLimit) {
  for (const std::size_t more : {0U, 1U}) {
    SessionHeader header;
    header.avatars.resize(kMaxRecordedAvatars + more);
    const Result<SessionHeader> read = parseSessionHeader(textOf(header), "s");
    EXPECT_EQ(read ? "" : read.error().message,
              more == 0 ? "" : "s: header: avatars: found 1001 avatars, expected at most 1000");
  }
}

TEST(SessionFile, WrongHeadersGetASentence) {
  const auto sentence = [](const std::string& text) {
    const Result<SessionHeader> read = parseSessionHeader(text, "s");
    return read ? std::string("none") : read.error().message;
  };
  const auto with = [](std::string_view from, const std::string& to) {
    std::string text = textOf(SessionHeader());
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  };
  EXPECT_EQ(sentence(with("lorica-session-3", "lorica-session-2")),
            "s: header: format: found \"lorica-session-2\", expected \"lorica-session-3\"");
  EXPECT_EQ(sentence(with("0000000000000000", "123")),
            "s: header: avatars[0].character.hash: found \"123\", expected 16 hexadecimal digits");
  EXPECT_EQ(
      sentence(with("\"faults\": \"\"", "\"faults\": \"swop\"")),
      "s: header: avatars[0].faults: found `swop`, expected dropout, jitter, swap, late, freeze or seed, for example "
      "dropout=0.1,swap,seed=7");
  for (const char* text : {"", "{", "[]", "{}", "null", R"({"format": 3})"}) EXPECT_NE(sentence(text), "none") << text;
}

TEST(SessionFile, EveryTruncationIsNotedOrReported) {
  const std::string& whole = sessionBytes();
  const std::size_t steps = parseSession(whole, "s").value().steps.size();
  std::size_t last = 0;
  // Each length around the ends of the first and of the last blocks, some in between.
  const auto next = [&](std::size_t size) { return size < 3000 || size + 2500 > whole.size() ? size + 1 : size + 13; };
  for (std::size_t size = 0; size < whole.size(); size = next(size)) {
    const Result<SessionFile> read = parseSession(std::string_view(whole).substr(0, size), "s");
    if (!read) {
      ASSERT_EQ(last, 0u) << "a shorter piece was valid, but not this one, at " << size;
      ASSERT_EQ(read.error().message.substr(0, 3), "s: ");
      continue;
    }
    ASSERT_FALSE(read->finished);
    ASSERT_FALSE(read->notes.empty());
    ASSERT_GE(read->steps.size(), last);
    last = read->steps.size();
  }
  EXPECT_EQ(last, steps);
}

TEST(SessionFile, EveryDamagedByteIsReported) {
  RandomNumbers random(1);
  std::string bytes = sessionBytes();
  for (int i = 0; i < 5000; ++i) {
    // Each of the first bytes, then random ones.
    const std::size_t at = i < 500 ? static_cast<std::size_t>(i) : random.bits() % bytes.size();
    const char before = bytes[at];
    bytes[at] = static_cast<char>(before ^ static_cast<char>(1u << (random.bits() % 8)));
    ASSERT_FALSE(parseSession(bytes, "s").ok()) << "byte " << at;
    bytes[at] = before;
  }
}

/// A whole file of blocks, with valid checksums.
std::string fileOf(const std::vector<std::pair<BlockKind, std::string>>& blocks) {
  std::string bytes(kSessionMagic);
  std::uint64_t chain = 0;
  for (const auto& [kind, payload] : blocks) appendBlock(kind, payload, chain, bytes);
  return bytes;
}

/// The blocks of the short session.
std::vector<std::pair<BlockKind, std::string>> blocksOf(const std::string& bytes) {
  std::vector<std::pair<BlockKind, std::string>> blocks;
  const Blocks read = readBlocks(bytes, "s").value();
  for (const Block& block : read.blocks) {
    blocks.emplace_back(block.kind, std::string(block.payload));
  }
  return blocks;
}

TEST(SessionFile, WrongDataWithValidChecksumsIsReportedOrHarmless) {
  const auto blocks = blocksOf(sessionBytes());
  RandomNumbers random(2);
  int refused = 0;
  for (int i = 0; i < 2000; ++i) {
    auto changed = blocks;
    std::string& payload = changed[random.bits() % changed.size()].second;
    if (payload.empty()) continue;
    for (int n = 0; n < 3; ++n) payload[random.bits() % payload.size()] = static_cast<char>(random.bits());
    if (i % 4 == 0) payload.resize(random.bits() % payload.size());
    const Result<SessionFile> read = parseSession(fileOf(changed), "s");
    refused += read ? 0 : 1;
    if (!read) continue;
    for (const SkeletonFrame& frame : read->motions[0].joints) {
      for (const TrackedJoint& joint : frame.joints) ASSERT_TRUE(joint.position.allFinite());
    }
  }
  EXPECT_GT(refused, 500);
}

TEST(SessionFile, StepsBeyondTheLastFrameAreReported) {
  constexpr std::size_t kBeforeFrames = 36;  // time, hashes, number of actions
  auto blocks = blocksOf(sessionBytes());
  const std::size_t taken = parseSession(sessionBytes(), "s").value().steps[0].frames;
  auto empty = blocks[2];
  empty.second = std::string(kBeforeFrames + 4, '\0');
  const auto withEmpty = [&](std::size_t count) {
    std::vector<std::pair<BlockKind, std::string>> changed(blocks.begin(), blocks.begin() + 3);
    changed.insert(changed.end(), count, empty);
    changed.push_back(blocks.back());
    return sentenceFor(fileOf(changed));
  };
  EXPECT_EQ(withEmpty(taken - 1), "none");
  EXPECT_TRUE(test::has(withEmpty(taken), "comes after the last of " + std::to_string(taken) + " frame"));
}

TEST(SessionFile, AHandThatIsNotThereIsReported) {
  auto blocks = blocksOf(sessionBytes());
  std::string& step = blocks[2 + 5].second;  // where the ball is thrown
  constexpr std::size_t kActionBytes = 1 + 1 + 4 + 7 * 8;
  step[step.size() - kActionBytes + 1] = 16;
  EXPECT_TRUE(test::has(sentenceFor(fileOf(blocks)), "step 5 found hand 16, expected 0 to 15"));
}

TEST(SessionFile, BlocksThatDoNotFitAreReported) {
  const auto blocks = blocksOf(sessionBytes());
  const auto header = blocks[0], scene = blocks[1], step = blocks[2], end = blocks.back();
  EXPECT_EQ(sentenceFor(fileOf({header, scene, step, end})), "none");
  EXPECT_TRUE(test::has(sentenceFor(fileOf({})), "found 0 complete blocks"));
  EXPECT_TRUE(test::has(sentenceFor(fileOf({scene, header, step})), "expected a header"));
  EXPECT_EQ(sentenceFor(fileOf({header, scene, end})), "s.lsession: found no steps, expected at least one");
  EXPECT_TRUE(test::has(sentenceFor(fileOf({header, scene, step, header})), "second header"));
  EXPECT_TRUE(test::has(sentenceFor(fileOf({header, scene, step, end, step})), "a block after the end"));
  EXPECT_EQ(sentenceFor(fileOf({header, scene, step, end}) + "x"), "s.lsession: bytes after the end");
  EXPECT_TRUE(test::has(sentenceFor("not a session at all"), "not a session file"));
  // Counts that do not fit the number of bytes are rejected.
  std::string lying = step.second;
  const std::size_t counts = 4 * sizeof(double);
  for (std::size_t i = 0; i < 4; ++i) lying[counts + i] = static_cast<char>(0xff);
  EXPECT_TRUE(test::has(sentenceFor(fileOf({header, scene, {BlockKind::kStep, lying}})), "step 0 holds"));
}

TEST(SessionFile, StepsOfTwoFilesDoNotMix) {
  // Whole blocks, but of another file: their checksums are chained to other ones.
  const std::string& bytes = sessionBytes();
  const Blocks read = readBlocks(bytes, "s").value();
  const std::size_t second = read.blocks[3].offset, third = read.blocks[4].offset;
  EXPECT_NE(sentenceFor(bytes.substr(0, second) + bytes.substr(third)).find("checksum is wrong"), std::string::npos);
}

TEST(SessionFile, AMissingFileIsReported) {
  EXPECT_EQ(test::errorOf(readSession("nowhere/s.lsession")).code, ErrorCode::kNotFound);
}

TEST(SessionHashes, FollowEveryBitOfACharacter) {
  const Session session = test::demoSession(makeMotionPoseSource({}));
  Character character = session.character();
  const std::uint64_t before = hashOf(character);
  character.influences[5].weight = std::nextafter(character.influences[5].weight, 2.0);
  EXPECT_NE(hashOf(character), before);
  character = session.character();
  character.mesh.vertices[0].x() = std::nextafter(character.mesh.vertices[0].x(), 9.0);
  EXPECT_NE(hashOf(character), before);
  EXPECT_EQ(hashOf(session.character()), before);
}

}  // namespace
}  // namespace lorica
