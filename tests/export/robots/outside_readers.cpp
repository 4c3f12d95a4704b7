#include "tests/export/robots/outside_readers.h"

#include "acd/decomposition_file.h"
#include "capture/files/bvh_file.h"
#include "capture/files/joint_csv.h"
#include "capture/files/joint_stream.h"
#include "capture/sensor/oni_file.h"
#include "capture/streams/vmc_receiver.h"
#include "export/robots/robot.h"
#include "geometry/arrays/array_file.h"
#include "geometry/files.h"
#include "geometry/little_endian.h"
#include "geometry/mesh_files.h"
#include "session/recording/session_file.h"
#include "session/scenes/scene_file.h"
#include "skinning/import/bone_map.h"
#include "skinning/import/character_file.h"
#include "skinning/import/isolated_scene.h"
#include "skinning/look/picture.h"
#include "tests/support/meshes.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>
#include <utility>

namespace lorica::test {
namespace {

namespace fs = std::filesystem;

template <typename T>
Result<void> without(const Result<T>& read) {
  if (!read) return read.error();
  return {};
}

/// The fuzzers' files of one kind, by name. @param skipped  bytes in front that only the fuzzer needs
std::vector<std::string> corpus(const std::string& kind, std::size_t skipped = 0, std::string_view ending = {}) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(sourceFile("tests/fuzz/corpus") / kind)) {
    if (entry.path().filename().string().ends_with(ending)) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<std::string> all;
  for (const fs::path& file : files) all.push_back(readFile(file).value().substr(skipped));
  return all;
}

/// A GLB: its JSON, a zero, its binary chunk.
std::string glbOf(std::string_view content) {
  const std::size_t zero = std::min(content.find('\0'), content.size());
  const std::string_view json = content.substr(0, zero), binary = content.substr(std::min(zero + 1, content.size()));
  std::string file = "glTF";
  for (const std::size_t number : {std::size_t{2}, 28 + json.size() + binary.size(), json.size()}) {
    appendLittleEndian(static_cast<std::uint32_t>(number), file);
  }
  file += "JSON" + std::string(json);
  appendLittleEndian(static_cast<std::uint32_t>(binary.size()), file);
  return file + std::string("BIN\0", 4) + std::string(binary);
}

/// A session: its blocks divided by zero bytes of two and 255.
std::string sessionOf(std::string_view content) {
  constexpr std::string_view kMark("\0\0\xff", 3);
  std::string file(kSessionMagic);
  std::uint64_t chain = 0;
  for (int block = 0; block < 2 || !content.empty(); ++block) {
    const std::size_t end = std::min(content.find(kMark), content.size());
    const BlockKind kind = block == 0 ? BlockKind::kHeader : block == 1 ? BlockKind::kScene : BlockKind::kStep;
    appendBlock(kind, content.substr(0, end), chain, file);
    content.remove_prefix(std::min(end + kMark.size(), content.size()));
  }
  appendBlock(BlockKind::kEnd, {}, chain, file);
  return file;
}

constexpr const char* kNamedColumns =
    "time_s,head_x,head_y,head_z,neck_x,neck_y,neck_z,l_hip_x,l_hip_y,l_hip_z,RHip_x,RHip_y,RHip_z,LeftFoot_x,"
    "LeftFoot_y,LeftFoot_z,foot r x,foot r y,foot r z\n"
    "1,0,1.6,2,0,1.4,2,0.1,0.9,2,-0.1,0.9,2,0.1,0.1,2,-0.1,0.1,2\n"
    "2,0,1.6,2,0,1.4,2,0.1,0.9,2,-0.1,0.9,2,0.1,0.1,2,-0.1,0.1,2\n";

/// Two frames of fifteen joints as Azure Kinect's offline_processor writes them.
std::string azureJson() {
  std::string text = R"({"joint_names": ["HEAD", "NECK", "SHOULDER_LEFT", "SHOULDER_RIGHT", "ELBOW_LEFT", "ELBOW_RIGHT",
    "HAND_LEFT", "HAND_RIGHT", "SPINE_NAVEL", "HIP_LEFT", "HIP_RIGHT", "KNEE_LEFT", "KNEE_RIGHT", "ANKLE_LEFT",
    "ANKLE_RIGHT"], "frames": [)";
  const std::vector<SkeletonFrame> walk = shippedFrames("walk");
  for (std::size_t f = 0; f < 2; ++f) {
    text += fmt::format("{}{{\"timestamp_usec\": {:.0f}, \"bodies\": [{{\"body_id\": 4, \"joint_positions\": [",
                        f == 0 ? "" : ", ", 1e6 * walk[f].time);
    for (const TrackedJoint& joint : walk[f].joints) {
      const Vec3& p = joint.position;
      text += fmt::format("{}[{:.3f}, {:.3f}, {:.3f}]", text.back() == '[' ? "" : ", ", 1000 * p.x(),
                          1000 * (1 - p.y()), 1000 * (3 - p.z()));
    }
    text += "]}]}";
  }
  return text + "]}";
}

/// A .lorica file with this content, and the right checksum.
std::string loricaOf(std::string_view content) {
  constexpr std::uint32_t kVersion = 1;
  std::string file = "LORICA\r\n";
  appendLittleEndian(kVersion, file);
  appendLittleEndian(std::uint64_t{content.size()}, file);
  appendLittleEndian(contentHash(content, kVersion), file);
  return file + std::string(content);
}

constexpr const char* kMjcf = R"(<mujoco model='a'><compiler angle="degree" inertiafromgeom="auto"/>
  <default><default class="c"><geom type="mesh" contype="1" group="3"/></default></default>
  <asset><mesh name="t" file="l.obj" refpos="0 0 1"/>
    <mesh name="v" vertex="0 0 0 1 0 0 0 1 0 0 0 1" face="0 2 1 0 1 3 0 3 2 1 2 3"/></asset>
  <worldbody>
    <body name="b" childclass="c" pos="0 0 1" euler="0 90 0"><freejoint/>
      <geom name="g" mesh="t" quat="1 0 0 1"/><geom name="h" type="mesh" mesh="v" axisangle="0 0 1 30"/>
      <body><joint type="hinge"/><geom type="mesh" mesh="v" zaxis="0 1 0"/></body>
    </body>
  </worldbody>
  <contact><pair name="p" geom1="g" geom2="h"/><exclude body1="b" body2="world"/></contact>
</mujoco>
)";
constexpr const char* kUrdf = R"(<robot name="r">
  <link name="a"><collision name="c"><origin xyz="0 0 1" rpy="0 1 0"/>
    <geometry><mesh filename="package://p/l.obj" scale="1 -1 1"/></geometry></collision></link>
  <link name="b"><collision><geometry><mesh filename="l.obj"/></geometry></collision></link>
  <joint name="j" type="revolute"><parent link="a"/><child link="b"/><origin xyz="1 0 0" rpy="0 0 1"/></joint>
</robot>
)";

Result<void> playPackets(const std::string& bytes) {
  Result<PacketFile> file = PacketFile::parse(bytes, "made");
  if (!file) return file.error();
  RecordedStream stream(std::make_shared<const PacketFile>(std::move(*file)));
  BoneFrame frame;
  while (!stream.ended()) (void)stream.wait(1.0 / 30.0, frame);
  return {};
}

Result<void> playDepth(const std::string& bytes) {
  LORICA_TRY(OniFile file, OniFile::parse(bytes, "made"));
  DepthFrame frame;
  for (int f = 0; f < std::min(file.info().frameCount, 20); ++f) LORICA_TRY_DO(file.read(f, frame));
  return {};
}

}  // namespace

std::vector<OutsideReader> outsideReaders(const TemporaryFolder& folder) {
  LORICA_CHECK(writeObjObjects(folder.path() / "l.obj", {{"l", makeLShape()}}).ok(), "the folder is our own");
  std::vector<OutsideReader> all;
  const std::vector<std::pair<std::string, std::vector<std::string>>> meshes = {
      {"off", corpus("mesh", 1, "off.bin")},
      {"obj", corpus("mesh", 1, "obj.bin")},
      {"ply", {corpus("mesh", 1, "ply.bin")[0], corpus("mesh", 1, "ply_binary.bin")[0]}},
      {"stl", {corpus("mesh", 1, "stl.bin")[0], corpus("mesh", 1, "stl_binary.bin")[0]}}};
  for (const auto& [ending, seeds] : meshes) {
    const auto read = [&folder, name = "mesh." + ending](const std::string& bytes) {
      return without(readMesh(folder.write(name, bytes)));
    };
    all.push_back({ending, read, seeds});
  }
  std::vector<std::string> joints = corpus("joints", 0, ".txt");
  joints.emplace_back(kNamedColumns);
  joints.push_back(azureJson());
  all.push_back({"joints", [](const std::string& bytes) { return without(parseJointStream(bytes, "made")); }, joints});
  all.push_back({"bvh", [](const std::string& bytes) { return without(parseBvh(bytes, "made")); }, corpus("bvh")});
  const auto character = [](const std::string& bytes) {
    const std::string file = glbOf(bytes);
    return without(parseCharacterFile(std::as_bytes(std::span(file)), "made"));
  };
  std::vector<std::string> glb;
  for (const char* name : {"datauri", "small", "small_materials", "random13", "vrm0_springs", "vrm1_mtoon"}) {
    glb.push_back(corpus("glb", 0, name + std::string(".split"))[0]);
  }
  all.push_back({"glb", character, glb});
  const auto answer = [](const std::string& bytes) -> Result<void> {
    LORICA_TRY(FileScene scene, isolated::decodeAnswer(bytes, "made"));
    return without(makeCharacterFile(std::move(scene), "made"));
  };
  all.push_back({"answer", answer, corpus("answer")});
  all.push_back(
      {"bone map", [](const std::string& bytes) { return without(parseBoneMap(bytes, "made")); }, corpus("bone_map")});
  std::vector<std::string> scenes;  // without meshes, which are decomposed
  for (const char* name : {"curtain", "sand"}) {
    scenes.push_back(corpus("scene", 0, name + std::string(".json"))[0]);
  }
  all.push_back({"scene", [](const std::string& bytes) { return without(parseScene(bytes, "made")); }, scenes});
  all.push_back({"session", [](const std::string& bytes) { return without(parseSession(sessionOf(bytes), "made")); },
                 corpus("session")});
  const auto lorica = [&folder](const std::string& bytes) {
    return without(readDecomposition(folder.write("made.lorica", loricaOf(bytes))));
  };
  all.push_back({"lorica", lorica, corpus("lorica_file", 1, "payload.bin")});
  all.push_back({"packets", playPackets, corpus("packets")});
  all.push_back({"depth", playDepth, corpus("oni")});
  all.push_back({"arrays", [](const std::string& bytes) { return without(parseArrays(bytes, "made", 1U << 20)); },
                 corpus("arrays")});
  for (const bool urdf : {false, true}) {
    const auto robot = [&folder, urdf](const std::string& bytes) -> Result<void> {
      const fs::path file = folder.write("robot.xml", bytes);
      const RobotReading reading{PathTrust::kBeneath, {{"p", folder.path()}}};
      return without(urdf ? readUrdf(file, reading) : readMjcf(file, reading));
    };
    all.push_back({urdf ? "urdf" : "mjcf", robot, {urdf ? kUrdf : kMjcf}});
  }
  const auto picture = [](const std::string& bytes) {
    return without(decodePicture(std::as_bytes(std::span(bytes)), "made"));
  };
  all.push_back({"picture", picture, corpus("picture", 0, "8.png")});
  return all;
}

}  // namespace lorica::test
