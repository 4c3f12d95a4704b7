#include "capture/files/bvh_file.h"
#include "capture/files/joint_csv.h"
#include "capture/retarget/bone_pose.h"
#include "capture/streams/packet_file.h"
#include "capture/streams/udp.h"
#include "capture/streams/vmc_receiver.h"
#include "capture/streams/vmc_writer.h"
#include "geometry/files.h"
#include "skinning/import/character_file.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/apps/mannequin_glb.h"
#include "tests/apps/refusals.h"
#include "tests/apps/run_command.h"
#include "tests/skinning/import/small_character.h"
#include "tests/support/background_process.h"
#include "tests/support/datasets.h"
#include "tests/support/has.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <map>
#include <string>
#include <thread>
#include <vector>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;
using Positions = std::map<std::string, Vec3>;

/// The mannequin with a material and one target, "happy".
std::string joyfulGlb() {
  GlbWriter writer = mannequinWriter(false);
  std::vector<float> offsets;
  const std::size_t vertices = makeMannequin().mesh.vertices.size();
  for (std::size_t v = 0; v < vertices; ++v) offsets.insert(offsets.end(), {0.0F, 0.001F, 0.0F});
  const int target = writer.accessor(offsets, "VEC3");
  nlohmann::json& mesh = writer.document["meshes"][0];
  mesh["primitives"][0]["targets"] = nlohmann::json::array({{{"POSITION", target}}});
  mesh["primitives"][0]["material"] = writer.add("materials", {{"name", "skin"}});
  mesh["extras"] = {{"targetNames", nlohmann::json::array({"happy"})}};
  return writer.glb();
}

/// Two seconds in which the left arm swings and a smile grows, at 30 frames a second.
std::string swing() {
  const Skeleton skeleton = makeMannequin().skeleton;
  BonePoseReader reader = BonePoseReader::create(skeleton).value();
  BonePose pose = reader.read(restPose(skeleton));
  VmcWriter writer;
  std::string bytes = packetFileHeader();
  for (int i = 0; i < 60; ++i) {
    const double angle = 0.5 * std::sin(0.2 * i);
    pose.rotation[static_cast<std::size_t>(HumanBone::kLeftUpperArm)] = Quat(Eigen::AngleAxisd(angle, Vec3::UnitZ()));
    const std::vector<VmcWeight> face = {{"Joy", static_cast<float>(i) / 59.0f}};
    bytes += packetRecord(writer.write(pose, face, i / 30.0, true), 1000000u + static_cast<unsigned>(i) * 33333u, 5000,
                          39539);
  }
  return bytes;
}

/// The files of these tests, made once.
struct Studio {
  TemporaryFolder folder;
  fs::path swinging = folder.write("swing.pcap", swing());
  fs::path joyful = folder.write("joyful.glb", joyfulGlb());
  fs::path body = folder.path() / "body.lorica";
  CommandSurroundings surroundings{folder.path()};

  Studio() { EXPECT_EQ(run({"decompose", joyful, "--parts", "3", "--keyframes", "1", "-o", body}).exitCode, 0); }
  [[nodiscard]] CommandResult run(const std::vector<std::string>& arguments) const {
    return runLorica(arguments, surroundings);
  }
};
const Studio& studio() {
  static const Studio made;
  return made;
}

/// Hears what a command sends.
class Listener {
 public:
  Listener()
      : socket_(UdpSocket::listen({"127.0.0.1", 0}).value()), port_(socket_.port()), thread_([this] { hear(); }) {}
  ~Listener() { stop(); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  [[nodiscard]] std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  /// The weights of an expression, as they came.
  std::vector<float> stop() {
    over_ = true;
    if (thread_.joinable()) thread_.join();
    return weights_;
  }

 private:
  void hear() {
    std::vector<std::byte> memory(kLargestPacket);
    VmcReceiver receiver;
    while (!over_) {
      const std::optional<UdpSocket::Packet> packet = socket_.receive(memory, 0.1);
      if (!packet || !receiver.take(std::span(memory).first(packet->size), ++packets_)) continue;
      for (const NamedWeight& one : receiver.frame().expressions) {
        if (one.name == "Joy") weights_.push_back(one.weight);
      }
    }
  }

  UdpSocket socket_;
  std::uint16_t port_;
  std::atomic<bool> over_ = false;
  int packets_ = 0;
  std::vector<float> weights_;
  std::thread thread_;
};

TEST(StreamFiles, ARecordingOfPacketsGivesTheSameFramesEachTime) {
  const std::vector<std::string> play = {
      "play", studio().swinging, "--character", studio().joyful, "--decomposition", studio().body, "--json", "-"};
  const CommandResult first = studio().run(play);
  const CommandResult second = studio().run(play);
  ASSERT_EQ(first.exitCode, 0) << first.err;
  EXPECT_EQ(first.json()["format"], "VMC packets");
  EXPECT_GE(first.json()["frames"].get<int>(), 60);
  EXPECT_EQ(first.json()["hash"], second.json()["hash"]);
}

/// In, recorded, replayed and out again: the smile grows by the same steps, under its old name.
TEST(StreamFiles, ExpressionsAreRecordedAndSentOn) {
  const fs::path session = studio().folder.path() / "smile.lsession";
  const CommandResult recorded = studio().run(
      {"record", session, studio().swinging, "--character", studio().joyful, "--decomposition", studio().body});
  ASSERT_EQ(recorded.exitCode, 0) << recorded.err;
  Listener listener;
  const CommandResult replayed = studio().run({"replay", session, "--vmc-out", listener.address(), "--json", "-"});
  ASSERT_EQ(replayed.exitCode, 0) << replayed.err;
  EXPECT_TRUE(replayed.json()["same"].get<bool>());
  const std::vector<float> weights = listener.stop();
  ASSERT_GT(weights.size(), 30u);
  for (const float weight : weights) EXPECT_NEAR(59.0 * weight, std::round(59.0 * weight), 1e-4);
  EXPECT_TRUE(std::is_sorted(weights.begin(), weights.end()));
  EXPECT_GT(weights.back(), 0.9f);
}

TEST(StreamFiles, WhatWasReceivedIsConverted) {
  const fs::path bvh = studio().folder.path() / "swing.bvh";
  const fs::path csv = studio().folder.path() / "swing.csv";
  ASSERT_EQ(studio().run({"convert", studio().swinging, bvh}).exitCode, 0);
  ASSERT_EQ(studio().run({"convert", studio().swinging, csv}).exitCode, 0);
  const Result<BvhFile> motion = readBvh(bvh);
  const Result<std::vector<SkeletonFrame>> joints = readJointCsv(csv);
  ASSERT_TRUE(motion && joints);
  EXPECT_EQ(motion->motion.frameCount(), 60);
  ASSERT_EQ(joints->size(), 60u);
  // Both are the sender's own: its hands are where the mannequin's are at rest.
  const Skeleton skeleton = makeMannequin().skeleton;
  std::vector<Affine3> world(static_cast<std::size_t>(skeleton.jointCount()));
  computeWorldFromJoint(skeleton, restPose(skeleton), world);
  const Vec3 wanted = world[skeleton.jointOf(HumanBone::kRightHand)].translation();
  const Skeleton& own = motion->motion.skeleton;
  std::vector<Affine3> got(static_cast<std::size_t>(own.jointCount()));
  computeWorldFromJoint(own, motion->motion.pose(10), got);
  EXPECT_LT((got[own.jointOf(HumanBone::kRightHand)].translation() - wanted).norm(), 1e-4);
  EXPECT_LT(((*joints)[10].joints[static_cast<std::size_t>(BodyJoint::kRightHand)].position - wanted).norm(), 1e-4);
}

TEST(StreamFiles, ASessionIsConverted) {
  const fs::path session = studio().folder.path() / "converted.lsession";
  ASSERT_EQ(
      studio()
          .run({"record", session, studio().swinging, "--character", studio().joyful, "--decomposition", studio().body})
          .exitCode,
      0);
  const fs::path bvh = studio().folder.path() / "converted.bvh";
  const CommandResult converted = studio().run({"convert", session, bvh, "--json", "-"});
  ASSERT_EQ(converted.exitCode, 0) << converted.err;
  const Result<BvhFile> motion = readBvh(bvh);
  ASSERT_TRUE(motion) << motion.error().message;
  EXPECT_EQ(motion->motion.frameCount(), converted.json()["frames"].get<int>());
}

/// Packets are kept until the motion is written; a killed program leaves them.
TEST(StreamFiles, WhatIsSentIsRecordedAndSurvivesAKill) {
  const TemporaryFolder takes;
  const fs::path bvh = takes.path() / "take.bvh", part = takes.path() / "take.bvh.part.pcap";
  const std::string port = std::to_string(UdpSocket::listen({"127.0.0.1", 0})->port());  // is free again
  UdpSocket sender = UdpSocket::connect({"127.0.0.1", static_cast<std::uint16_t>(std::stoi(port))}).value();
  const PacketFile packets = PacketFile::parse(swing(), "swing").value();
  std::size_t sent = 0;
  const auto isRecorded = [&](const RunningCommand& = {}) {
    sender.send(packets.payload(packets.packets()[sent++ % packets.packets().size()]));
    std::error_code none;
    return fs::file_size(part, none) > 40'000 && !none;
  };
  const CommandResult ended = runLorica({"record", bvh, "--vmc", port, "--json", "-"}, {takes.path(), {}, isRecorded});
  ASSERT_EQ(ended.exitCode, 0) << ended.err;
  EXPECT_EQ(ended.json()["recording"], bvh.string());
  EXPECT_GT(ended.json()["packets"].get<int>(), 5);
  EXPECT_TRUE(readBvh(bvh));
  EXPECT_EQ(filesIn(takes.path()), std::vector<std::string>{"take.bvh"});
  fs::remove(bvh);
  {
    const BackgroundProcess killed(
        [&] { execl(built("lorica").c_str(), "lorica", "record", bvh.c_str(), "--vmc", port.c_str(), nullptr); });
    while (!isRecorded()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_EQ(filesIn(takes.path()), std::vector<std::string>{"take.bvh.part.pcap"});
  EXPECT_EQ(studio().run({"convert", part, bvh}).exitCode, 0);
  EXPECT_TRUE(readBvh(bvh));
}

/// The character is in another folder than the take, as it usually is.
TEST(StreamFiles, AMotionIsRecordedAsBvhAndLeavesNothingElse) {
  const TemporaryFolder takes;
  const fs::path bvh = takes.path() / "live.bvh";
  const CommandResult recorded = studio().run(
      {"record", bvh, studio().swinging, "--character", studio().joyful, "--decomposition", studio().body});
  ASSERT_EQ(recorded.exitCode, 0) << recorded.err;
  EXPECT_TRUE(readBvh(bvh));
  EXPECT_EQ(filesIn(takes.path()), std::vector<std::string>{"live.bvh"});
}

TEST(StreamFiles, ASessionWhoseCharacterIsElsewhereIsConvertedWithIt) {
  const TemporaryFolder takes;
  const fs::path session = takes.path() / "take.lsession";
  const CommandResult recorded = studio().run(
      {"record", session, studio().swinging, "--character", studio().joyful, "--decomposition", studio().body});
  ASSERT_EQ(recorded.exitCode, 0) << recorded.err;
  for (const char* name : {"take.bvh", "take.csv"}) {
    expectRefused(studio().run({"convert", session, takes.path() / name}), {"--character gives its file"});
    const CommandResult made = studio().run({"convert", session, takes.path() / name, "--character", studio().joyful});
    EXPECT_EQ(made.exitCode, 0) << made.err;
  }
  EXPECT_TRUE(readBvh(takes.path() / "take.bvh"));
  EXPECT_TRUE(readJointCsv(takes.path() / "take.csv"));
}

TEST(StreamFiles, WrongUsesAreASentence) {
  const auto refused = [](const std::vector<std::string>& arguments, const std::string& found) {
    expectRefused(studio().run(arguments), {found});
  };
  refused({"record", "x.pcap", "--vmc", "39539"}, "OUT: found x.pcap, expected a name that ends in .oni (depth)");
  refused({"record", "x.bvh", "--vmc", "39539,39540"}, "x.bvh: found 2 avatars, expected one");
  refused({"record", "x.oni", "--vmc", "39539"}, "x.oni: --vmc sends no depth images");
  refused({"record", "x.lsession", "walk", "--vmc", "39539"}, "found a motion and --vmc, expected only one");
  refused({"live", "--headless", "--delay", "10"}, "--delay requires --vmc");
  refused({"live", "--headless", "--vmc", "39539", "--delay", "5000"}, "--delay: found 5000 ms, expected at most 1000");
  refused({"live", "--headless", "--vmc", "39539", "--sender", studio().joyful}, "expected VRM 1.0");
  refused({"play", "walk", "--sender", studio().joyful}, "--sender is for VMC packets");
  refused({"play", "walk", "--vrchat", "1:2:3"}, "--vrchat: found '1:2:3', expected HOST or HOST:PORT");
  refused({"play", "walk", "--vmt", "1:2:3"}, "--vmt: found '1:2:3', expected HOST or HOST:PORT");
  refused({"play", "walk", "--vmt", "127.0.0.1", "--trackers", "head"}, "--trackers: found the head alone");
  refused({"play", "walk", "--trackers", "feet"}, "--trackers: found neither --vrchat nor --vmt");
  studio().folder.write("bad.pcap", "no packets at all, only text");
  refused({"play", "bad.pcap"}, "bad.pcap: found ");
}

// `lorica convert MOTION OUT --character HERO`: the motion on the user's own joints.

std::string at(const TemporaryFolder& folder, const char* name) {
  return folder.path() / name;
}

Positions positionsOf(const Skeleton& skeleton, std::span<const JointTransform> pose) {
  std::vector<Affine3> worldFromJoint(pose.size());
  computeWorldFromJoint(skeleton, pose, worldFromJoint);
  Positions positions;
  for (JointIndex j = 0; j < skeleton.jointCount(); ++j) {
    std::string name = skeleton.joint(j).name;
    std::replace(name.begin(), name.end(), ' ', '_');  // as in BVH
    positions[name] = worldFromJoint[j].translation();
  }
  return positions;
}

/// Converts a motion to a .glb and a .bvh of a character: both have its joints at the same places.
void expectSameJoints(const std::string& motion, bool torn, bool named, const std::vector<std::string>& options = {}) {
  const TemporaryFolder folder;
  const std::string hero = folder.write("hero.glb", mannequinGlb(torn, named));
  for (const char* out : {"walk.glb", "walk.bvh"}) {
    std::vector<std::string> arguments = {"convert", "--force", motion, at(folder, out), "--character", hero};
    arguments.insert(arguments.end(), options.begin(), options.end());
    arguments.insert(arguments.end(), {"--json", "-"});
    const CommandResult result = runLorica(arguments);
    ASSERT_EQ(result.exitCode, 0) << result.err;
    EXPECT_EQ(result.json()["character"], hero);
    EXPECT_GE(result.json()["joints"].get<int>(), 52);
  }
  const CharacterFile before = readCharacterFile(hero).value();
  const CharacterFile glb = readCharacterFile(at(folder, "walk.glb")).value();
  const SkeletalMotion bvh = readBvh(at(folder, "walk.bvh")).value().motion;
  ASSERT_EQ(glb.clips.size(), before.clips.size() + 1);
  EXPECT_EQ(glb.character.mesh.vertices, before.character.mesh.vertices);
  EXPECT_NEAR(glb.clips.front().seconds, bvh.times.back() - bvh.times.front(), 1e-3);
  double moved = 0.0;
  for (int f = 0; f < bvh.frameCount(); f += 11) {
    Pose pose = restPose(glb.character.skeleton);
    const Positions atRest = positionsOf(glb.character.skeleton, pose);
    sampleClip(glb.clips.front(), bvh.times[f] - bvh.times.front(), pose);
    const Positions inGlb = positionsOf(glb.character.skeleton, pose);
    for (const auto& [name, position] : positionsOf(bvh.skeleton, bvh.pose(f))) {
      ASSERT_TRUE(inGlb.contains(name)) << name;
      EXPECT_LT((inGlb.at(name) - position).norm(), 1e-5) << name << ", frame " << f;
      moved = std::max(moved, (position - atRest.at(name)).norm());
    }
  }
  EXPECT_GT(moved, 0.3);
}

TEST(ConvertCharacter, JointsAreAtTheSamePlacesInGlbAndBvh) {
  expectSameJoints("walk", false, true);
}

TEST(ConvertCharacter, TornCharactersInCentimetresToo) {
  expectSameJoints("wave", true, false, {"--mirror"});
}

TEST(ConvertCharacter, DepthRecordingsAreASourceToo) {
  expectSameJoints("wave_depth", false, true, {"--smooth", "one-euro"});
}

TEST(ConvertCharacter, TheMannequinIsACharacter) {
  const TemporaryFolder folder;
  ASSERT_EQ(runLorica({"convert", "walk", at(folder, "walk.glb"), "--character", "mannequin"}).exitCode, 0);
  const CharacterFile made = readCharacterFile(at(folder, "walk.glb")).value();
  EXPECT_EQ(made.clips.size(), 1U);
  EXPECT_EQ(made.clips.front().name, "walk");
}

}  // namespace
}  // namespace lorica::test
