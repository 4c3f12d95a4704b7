// The VMC protocol against programs that nobody here wrote: liblo's oscsend and oscdump, npm's osc and osc-min, and
// three-vrm, which puts what Lorica sends onto a model.
#include "capture/files/joint_csv.h"
#include "capture/retarget/retarget.h"
#include "capture/streams/udp.h"
#include "capture/streams/vmc_receiver.h"
#include "capture/streams/vmc_writer.h"
#include "geometry/random_numbers.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/peers/avatar_poses.h"
#include "tests/peers/peer.h"
#include "tests/support/background_process.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"
#include "tests/support/virtual_display.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

namespace lorica {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using B = HumanBone;

std::string textOf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::span<const std::byte> bytesOf(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

#define LORICA_REQUIRE_LIBLO()                                                      \
  if (!test::installed("oscsend") || !test::installed("oscdump")) {                 \
    GTEST_SKIP() << "oscsend and oscdump are missing; scripts/peers installs them"; \
  }

TEST(PeerVmc, OscsendsMessagesAreUnderstood) {
  LORICA_REQUIRE_LIBLO();
  UdpSocket socket = test::valueOf(UdpSocket::listen({"127.0.0.1", 0}));
  const auto send = [&](const std::string& message) {
    EXPECT_EQ(std::system(fmt::format("oscsend 127.0.0.1 {} {}", socket.port(), message).c_str()), 0);
  };
  send("/VMC/Ext/Bone/Pos sfffffff LeftUpperArm 0.1 0.2 0.3 0 0 0.6 0.8");
  send("/VMC/Ext/Blend/Val sf Joy 0.75");
  send("/VMC/Ext/Blend/Apply");
  send("/VMC/Ext/OK iiii 1 3 0 1");
  VmcReceiver receiver;
  std::vector<std::byte> memory(2048);
  bool complete = false;
  for (int i = 0; i < 4; ++i) {
    const std::optional<UdpSocket::Packet> packet = socket.receive(memory, 5.0);
    ASSERT_TRUE(packet);
    complete = receiver.take(std::span(memory).first(packet->size), 0.0) || complete;
  }
  EXPECT_TRUE(complete);
  EXPECT_EQ(receiver.refusedCount(), 0);
  const auto arm = static_cast<std::size_t>(B::kLeftUpperArm);
  EXPECT_TRUE(receiver.frame().pose.offset[arm].isApprox(Vec3(-0.1, 0.2, 0.3), 1e-6));
  EXPECT_TRUE(receiver.frame().pose.rotation[arm]->isApprox(Quat(0.8, 0.0, 0.0, -0.6), 1e-6));
  ASSERT_EQ(receiver.expressions().size(), 1u);
  EXPECT_EQ(receiver.expressions()[0].weight, 0.75f);
}

/// Poses of a skeleton that performs a shipped recording, every so many frames.
std::vector<Pose> performed(const Skeleton& skeleton, const std::string& name, std::size_t every) {
  const Result<std::vector<SkeletonFrame>> frames = readJointCsv(test::recordingsFolder() / (name + ".csv"));
  Result<Retargeter> retargeter = Retargeter::create(skeleton);
  if (!frames || !retargeter) return {};
  std::vector<Pose> poses;
  Pose pose = restPose(skeleton);
  for (std::size_t f = 0; f < frames->size(); ++f) {
    retargeter->apply((*frames)[f], pose);
    if (f % every == 0) poses.push_back(pose);
  }
  return poses;
}

TEST(PeerVmc, OscdumpReadsWhatLoricaSends) {
  LORICA_REQUIRE_LIBLO();
  const Skeleton skeleton = makeMannequin().skeleton;
  const std::vector<Pose> poses = performed(skeleton, "walk", 40);
  Result<BonePoseReader> reader = BonePoseReader::create(skeleton);
  ASSERT_TRUE(reader && !poses.empty());
  std::uint16_t port = 0;
  {
    const UdpSocket free = test::valueOf(UdpSocket::listen({"127.0.0.1", 0}));
    port = free.port();
  }
  const test::TemporaryFolder folder;
  const fs::path log = folder.write("dump", "");
  const test::BackgroundProcess dump([&] { execlp("oscdump", "oscdump", "-L", std::to_string(port).c_str(), nullptr); },
                                     log);
  UdpSocket socket = test::valueOf(UdpSocket::connect({"127.0.0.1", port}));
  VmcWriter writer;
  const BonePose pose = reader->read(poses[1]);
  std::string text;
  const std::string end = "/VMC/Ext/T f ";
  for (; text.find(end) == text.rfind(end); text = textOf(log)) {  // until a whole packet is there
    socket.send(writer.write(pose, {}, 0.5, true));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  const Quat& arm = *pose.rotation[static_cast<std::size_t>(B::kLeftUpperArm)];
  const Vec3& at = pose.offset[static_cast<std::size_t>(B::kLeftUpperArm)];
  const std::string expected = fmt::format(
      "/VMC/Ext/Bone/Pos sfffffff \"LeftUpperArm\" {:f} {:f} {:f} {:f} {:f} {:f} {:f}", static_cast<float>(-at.x()),
      static_cast<float>(at.y()), static_cast<float>(at.z()), static_cast<float>(arm.x()), static_cast<float>(-arm.y()),
      static_cast<float>(-arm.z()), static_cast<float>(arm.w()));
  EXPECT_NE(text.find(expected), std::string::npos) << expected << "\n" << text.substr(0, 4000);
  EXPECT_NE(text.find("/VMC/Ext/OK iiii 1 3 0 1"), std::string::npos);
  EXPECT_NE(text.find("/VMC/Ext/T f 0.500000"), std::string::npos);
}

/// Packets by npm's osc, laid out as real senders do: they all mean the same pose.
TEST(PeerVmc, SendersLayoutsAreUnderstood) {
  LORICA_REQUIRE_PEERS();
  const test::TemporaryFolder folder;
  ASSERT_TRUE(test::runPeer("encode_osc.mjs", {folder.path().string()}));
  for (const char* sender :
       {"reference_sample", "single_messages", "slimevr", "vmagicmirror", "xr_animator", "no_root", "nested"}) {
    VmcReceiver receiver;
    bool complete = false;
    int packets = 0;
    for (; fs::exists(folder.path() / fmt::format("{}.{}.osc", sender, packets)); ++packets) {
      const std::string packet = textOf(folder.path() / fmt::format("{}.{}.osc", sender, packets));
      complete = receiver.take(bytesOf(packet), 0.001 * packets) || complete;
    }
    EXPECT_GT(packets, 0) << sender;
    EXPECT_TRUE(complete) << sender;
    EXPECT_EQ(receiver.refusedCount(), 0) << sender;
    EXPECT_TRUE(receiver.frame().tracking) << sender;
    const BonePose& pose = receiver.frame().pose;
    EXPECT_TRUE(pose.offset[0].isApprox(Vec3(-0.1, 0.9, 0.2), 1e-6)) << sender;
    const double half = std::sqrt(0.5);
    ASSERT_TRUE(pose.rotation[0]) << sender;
    EXPECT_LT(pose.rotation[0]->angularDistance(Quat(half, half, 0.0, 0.0)), 1e-6) << sender;
    const auto arm = static_cast<std::size_t>(B::kLeftUpperArm);
    ASSERT_TRUE(pose.rotation[arm]) << sender;
    EXPECT_LT(pose.rotation[arm]->angularDistance(Quat(half, 0.0, 0.0, -half)), 1e-6) << sender;
  }
}

/// A VRM 1.0 model with nothing but a skeleton: the mannequin's bones with other lengths and crooked axes.
struct MadeUpModel {
  Skeleton skeleton;
  std::string gltf;
};

MadeUpModel makeModel(std::uint64_t seed) {
  RandomNumbers random(seed);
  const Skeleton source = makeMannequin().skeleton;
  std::vector<Joint> joints(source.joints().begin(), source.joints().end());
  std::vector<Quat> world(joints.size(), Quat::Identity());
  std::vector<Quat> sourceWorld(joints.size(), Quat::Identity());
  json nodes = json::array();
  json bones;
  const double legs = random.between(0.7, 1.4);
  const double arms = random.between(0.7, 1.4);
  for (std::size_t j = 0; j < joints.size(); ++j) {
    Joint& joint = joints[j];
    const bool isRoot = joint.parent == kNoJoint;
    const auto parent = static_cast<std::size_t>(isRoot ? 0 : joint.parent);
    const Quat above = isRoot ? Quat::Identity() : world[parent];
    const Quat sourceAbove = isRoot ? Quat::Identity() : sourceWorld[parent];
    sourceWorld[j] = sourceAbove * joint.rest.rotation;
    Vec3 axis;
    for (double& component : axis) component = random.between(-1.0, 1.0);
    const double angle = joint.bone ? random.between(-1.0, 1.0) : 0.0;
    world[j] = (Quat(Eigen::AngleAxisd(angle, axis.normalized())) * sourceWorld[j]).normalized();
    const std::string name = joint.bone ? std::string(nameOf(*joint.bone)) : joint.name;
    const double size = name.find("Leg") != std::string::npos || name.find("Foot") != std::string::npos   ? legs
                        : name.find("Arm") != std::string::npos || name.find("Hand") != std::string::npos ? arms
                                                                                                          : 1.0;
    joint.rest.translation = above.conjugate() * (sourceAbove * joint.rest.translation) * size;
    joint.rest.rotation = (above.conjugate() * world[j]).normalized();
    const Vec3& t = joint.rest.translation;
    const Quat& q = joint.rest.rotation;
    nodes.push_back({{"name", fmt::format("joint {}", j)},
                     {"translation", json::array({t.x(), t.y(), t.z()})},
                     {"rotation", json::array({q.x(), q.y(), q.z(), q.w()})}});
    if (!isRoot) nodes[parent]["children"].push_back(j);
    if (joint.bone) bones[name] = {{"node", j}};
  }
  json roots = json::array();
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (joints[j].parent == kNoJoint) roots.push_back(j);
  }
  json file = {
      {"asset", {{"version", "2.0"}}}, {"scene", 0}, {"nodes", nodes}, {"extensionsUsed", json::array({"VRMC_vrm"})}};
  file["scenes"] = json::array({json{{"nodes", roots}}});
  file["extensions"]["VRMC_vrm"] = {
      {"specVersion", "1.0"},
      {"meta",
       {{"name", "made up"}, {"authors", json::array({"Lorica"})}, {"licenseUrl", "https://vrm.dev/licenses/1.0/"}}},
      {"humanoid", {{"humanBones", bones}}}};
  return {*Skeleton::create(std::move(joints)), file.dump()};
}

/// Sends the poses, lets osc-min decode them and three-vrm pose the model. @return the largest distance of a bone [m]
double farthestBone(const fs::path& model, const Skeleton& skeleton, const std::vector<Pose>& poses) {
  const test::TemporaryFolder folder;
  Result<BonePoseReader> reader = BonePoseReader::create(skeleton);
  if (!reader) {
    ADD_FAILURE() << reader.error().message;
    return 1e9;
  }
  VmcWriter writer;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const std::span<const std::byte> packet = writer.write(reader->read(poses[i]), {}, 0.0, true);
    folder.write(fmt::format("{}.osc", i), {reinterpret_cast<const char*>(packet.data()), packet.size()});
  }
  if (!test::runPeer("decode_osc.mjs", {folder.path().string()})) return 1e9;

  std::vector<Affine3> world(static_cast<std::size_t>(skeleton.jointCount()));
  computeWorldFromJoint(skeleton, restPose(skeleton), world);
  const Vec3 hipsAtRest = world[skeleton.jointOf(B::kHips)].translation();
  json shots = {{"picture", false}, {"shots", json::object()}};
  for (std::size_t i = 0; i < poses.size(); ++i) {
    json& shot = shots["shots"][std::to_string(i)];
    for (const json& message : json::parse(textOf(folder.path() / fmt::format("{}.json", i)))) {
      if (message["address"] != "/VMC/Ext/Bone/Pos") continue;
      const json& v = message["values"];
      std::string bone = v[0];
      bone[0] = static_cast<char>(std::tolower(bone[0]));
      if (bone.find("Thumb") != std::string::npos)
        continue;  // named otherwise by VRM 1.0; checked in vmc_receiver_test
      // From Unity's axes to those of glTF.
      shot["rotations"][bone] = json::array({v[4], -v[5].get<double>(), -v[6].get<double>(), v[7]});
      if (bone == "hips") {
        shot["hips"] = json::array({-v[1].get<double>() - hipsAtRest.x(), v[2].get<double>() - hipsAtRest.y(),
                                    v[3].get<double>() - hipsAtRest.z()});
      }
    }
  }
  double farthest = 0.0;
  std::size_t compared = 0;
  for (const auto& [name, shot] : test::shootWithPeer(model, shots)) {
    computeWorldFromJoint(skeleton, poses[std::stoul(name)], world);
    for (const auto& [bone, position] : shot.facts["joints"].items()) {
      const std::optional<B> known = humanBoneNamed(bone);
      if (!known || bone.find("Thumb") != std::string::npos || skeleton.jointOf(*known) == kNoJoint) continue;
      farthest = std::max(farthest, (world[skeleton.jointOf(*known)].translation() - test::vectorOf(position)).norm());
      ++compared;
    }
  }
  EXPECT_GE(compared, 15 * poses.size());
  return farthest;
}

TEST(PeerVmc, ThreeVrmPutsWhatLoricaSendsOnMadeUpModels) {
  LORICA_REQUIRE_PEERS();
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    const MadeUpModel model = makeModel(seed);
    const test::TemporaryFolder folder;
    const fs::path file = folder.write("model.gltf", model.gltf);
    for (const char* motion : {"walk", "punch_and_kick"}) {
      const double farthest = farthestBone(file, model.skeleton, performed(model.skeleton, motion, 16));
      std::printf("made up %d, %s: bones within %.2g m\n", static_cast<int>(seed), motion, farthest);
      EXPECT_LT(farthest, 1e-3) << motion;
    }
  }
}

TEST(PeerVmc, ThreeVrmPutsWhatLoricaSendsOnGodette) {
  LORICA_REQUIRE_DATASET(path, test::readShots("godette").at("character").get<std::string>());
  LORICA_REQUIRE_PEERS();
  const CharacterFile file = test::valueOf(readCharacterFile(path));
  const Skeleton& skeleton = file.character.skeleton;
  for (const char* motion : {"walk", "punch_and_kick"}) {
    const double farthest = farthestBone(path, skeleton, performed(skeleton, motion, 16));
    std::printf("godette, %s: bones within %.2g m\n", motion, farthest);
    EXPECT_LT(farthest, 1e-3) << motion;
  }
}

}  // namespace
}  // namespace lorica
