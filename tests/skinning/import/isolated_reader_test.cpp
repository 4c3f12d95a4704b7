
#include "geometry/files.h"
#include "skinning/import/character_file.h"
#include "skinning/import/isolated_scene.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <sys/wait.h>
#include <random>
#include <string>

namespace lorica {
namespace {

namespace fs = std::filesystem;

const std::string kProgram = test::built("character_reader");
const IsolatedReader kReader{kProgram, {}};

std::span<const std::byte> bytesOf(std::string_view text) {
  return std::as_bytes(std::span(text));
}

constexpr const char* kFbxStart =
    "; FBX 7.3.0 project file\nFBXHeaderExtension:  {\n\tFBXHeaderVersion: 1003\n"
    "\tFBXVersion: 7300\n}\nDefinitions:  {\n}\n";

/// Null models, each connected as told.
std::string fbxOf(int models, const std::vector<std::pair<int, int>>& connections) {
  std::string text = std::string(kFbxStart) + "Objects:  {\n";
  for (int m = 1; m <= models; ++m) {
    text += "\tModel: " + std::to_string(m) + ", \"Model::m" + std::to_string(m) + "\", \"Null\" {\n\t}\n";
  }
  text += "}\nConnections:  {\n";
  for (const auto& [child, parent] : connections) {
    text += "\tC: \"OO\"," + std::to_string(child) + "," + std::to_string(parent) + "\n";
  }
  return text + "}\n";
}

std::string colladaOf(const std::string& libraries, const std::string& node) {
  return R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>)"
         R"(<up_axis>Y_UP</up_axis></asset>)" +
         libraries + R"(<library_visual_scenes><visual_scene id="s"><node id="r">)" + node +
         R"(</node></visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
}

/// A triangle with a material and a second node.
std::string goodCollada() {
  return colladaOf(
      R"(<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count="9">0 0 0 1 0 0 0 1 0)"
      R"(</float_array><technique_common><accessor source="#a" count="3" stride="3"><param name="X" type="float"/>)"
      R"(<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>)"
      R"(<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="1">)"
      R"(<input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry>)"
      R"(</library_geometries>)",
      R"(<instance_geometry url="#g"/><node id="second"/>)");
}

/// Files that make assimp crash, hang or take all memory.
using Attack = std::pair<const char*, std::string>;

std::vector<Attack> attacks() {
  std::vector<std::pair<int, int>> doubled = {{1, 0}};
  for (int m = 1; m < 200; ++m) {
    for (int copies = 0; copies < 2; ++copies) doubled.emplace_back(m + 1, m);
  }
  const auto repeated = [](const std::string& what, int count) {
    std::string all;
    for (int i = 0; i < count; ++i) all += what;
    return all;
  };
  std::string laughs = "<library_nodes>";
  for (int n = 0; n < 10; ++n) {
    const std::string next = "<instance_node url=\"#n" + std::to_string(n + 1) + "\"/>";
    laughs += "<node id=\"n" + std::to_string(n) + "\">" + repeated(next, n < 9 ? 10 : 0) + "</node>";
  }
  laughs += "</library_nodes>";
  return {
      {"fbx models that contain each other", fbxOf(2, {{1, 2}, {2, 1}, {1, 0}})},
      {"fbx models that contain the next one twice", fbxOf(200, doubled)},
      {"fbx scopes in scopes", std::string(kFbxStart) + "Objects:  {\n" + repeated("A: {\n", 200'000)},
      {"collada node that contains itself",
       colladaOf(R"(<library_nodes><node id="a"><instance_node url="#a"/></node></library_nodes>)",
                 R"(<instance_node url="#a"/>)")},
      {"collada skin of itself",
       colladaOf(
           R"(<library_controllers><controller id="c"><skin source="#c"></skin></controller></library_controllers>)",
           R"(<instance_controller url="#c"/>)")},
      {"collada nodes that contain ten of the next", colladaOf(laughs, R"(<instance_node url="#n0"/>)")},
      {"collada nodes in nodes", colladaOf("", repeated("<node>", 50'000) + repeated("</node>", 50'000))},
  };
}

void expectOneSentence(const std::string& text) {
  CharacterFileSettings settings;
  settings.isolated = kReader;
  const Result<CharacterFile> file = parseCharacterFile(bytesOf(text), "attack", settings);
  ASSERT_FALSE(file.ok());
  EXPECT_TRUE(file.error().message.starts_with("attack: broken ")) << file.error().message;
  EXPECT_EQ(file.error().message.find('\n'), std::string::npos);
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "a process was left behind";
  std::cout << "    " << file.error().message << '\n';
}

TEST(IsolatedAttack, IsOneSentence) {
  for (const auto& [name, text] : attacks()) {
    SCOPED_TRACE(name);
    expectOneSentence(text);
  }
}

/// Reads bytes in this process and in another one, and expects the same bits.
void expectSame(const std::string& content, AssimpFormat format, const fs::path& folder) {
  const NamedFiles files{folder};
  const Result<FileScene> here = readAssimpScene(bytesOf(content), "file", format, files);
  const Result<FileScene> there = readIsolatedScene(bytesOf(content), "file", format, files, kReader);
  ASSERT_EQ(here.ok(), there.ok()) << (there ? "" : there.error().message);
  if (here) {
    EXPECT_EQ(encodeScene(*here), encodeScene(*there));
  } else {
    EXPECT_EQ(here.error().message, there.error().message);
  }
}

TEST(IsolatedReader, ReadsTheSameBitsAsThisProcess) {
  expectSame(goodCollada(), AssimpFormat::kCollada, {});
  expectSame(fbxOf(3, {{1, 0}, {2, 1}, {3, 1}}), AssimpFormat::kFbx, {});
  expectSame("; FBX 7.3.0 project file\n", AssimpFormat::kFbx, {});
}

TEST(IsolatedReader, ReadsTheSameBitsOfRealFiles) {
  LORICA_REQUIRE_DATASET(folder, "characters/arnaud");
  int files = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".fbx") continue;
    SCOPED_TRACE(entry.path());
    expectSame(readFile(entry.path()).value(), AssimpFormat::kFbx, folder);
    ++files;
  }
  EXPECT_GT(files, 0);
}

TEST(IsolatedReader, EndsAtOnceWhenItIsCancelled) {
  int asked = 0;
  IsolatedReader reader{kProgram, {"hang"}, [&] { return ++asked > 3; }};
  const auto scene = readIsolatedScene(bytesOf(goodCollada()), "file", AssimpFormat::kCollada, {}, reader);
  ASSERT_FALSE(scene.ok());
  EXPECT_EQ(scene.error().code, ErrorCode::kCancelled);
  EXPECT_EQ(::waitpid(-1, nullptr, WNOHANG), -1) << "a process was left behind";
}

TEST(IsolatedReader, AProcessThatIsBrokenIsOneSentence) {
  const auto sentence = [](const IsolatedReader& reader) {
    const auto scene = readIsolatedScene(bytesOf(goodCollada()), "file", AssimpFormat::kCollada, {}, reader);
    return scene ? "none" : scene.error().message;
  };
  EXPECT_NE(sentence({kProgram, {"lie"}}).find("file: byte"), std::string::npos);
  EXPECT_NE(sentence({kProgram, {"silent"}}).find("the answer of its reader: byte 0"), std::string::npos);
  EXPECT_EQ(sentence({"/nowhere/reader", {}}),
            "file: cannot be read: its reader /nowhere/reader could not be started: No such file or directory");
}

/// A scene with everything that is handed over.
FileScene fullScene() {
  FileScene scene;
  scene.format = "FBX";
  scene.nodes = {{"root", -1, {}, std::nullopt}, {"bone", 0, {}, Quat(Eigen::AngleAxisd(0.3, Vec3::UnitX()))}};
  scene.skins = {{"skin", {0, 1}, {Affine3::Identity(), Affine3::Identity()}}};
  FileMesh mesh;
  mesh.name = "mesh";
  mesh.node = 0;
  mesh.skin = 0;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  mesh.weights = {{0, 1.0}, {1, 0.5}, {0, 0.5}};
  mesh.weightBegin = {0, 1, 3, 3};
  mesh.morphs = {{0, {{1, {0, 0, 1}, {0, 0, 0}}, {2, {1, 0, 0}, {0, 1, 0}}}}};
  mesh.normals.assign(3, Vec3f::UnitZ());
  mesh.tangents.assign(3, Eigen::Vector4f(1, 0, 0, 1));
  mesh.uv[0].assign(3, Eigen::Vector2f(0.5F, 0.25F));
  mesh.colors.assign(3, Eigen::Vector4f(1, 0, 0, 1));
  mesh.material = 0;
  scene.meshes = {mesh};
  FileTrack track;
  track.node = 1;
  track.rotation = KeyTrack<Quat>{KeyInterpolation::kLinear, {0.0, 1.0}, {Quat::Identity(), Quat::Identity()}};
  scene.clips = {{"clip", {track}, {}}};
  scene.morphTargets = {{"smile", 0, -1, 0, 0.0F}};
  scene.materials.resize(1);
  scene.materials[0].name = "skin";
  scene.materials[0].base.picture = 0;
  scene.pictures = {{"picture", {std::byte{1}, std::byte{2}}}};
  scene.metresPerUnit = 0.01;
  scene.notes = {"a note"};
  return scene;
}

TEST(SceneBytes, ComeBackAsTheyWere) {
  const std::string bytes = encodeScene(fullScene());
  const FileScene again = test::valueOf(decodeScene(bytes, "file"));
  EXPECT_EQ(encodeScene(again), bytes);
  EXPECT_EQ(again.meshes[0].weights[1].weight, 0.5);
  EXPECT_EQ(again.clips[0].tracks[0].rotation->times[1], 1.0);
  EXPECT_EQ(again.pictures[0].bytes[1], std::byte{2});
}

TEST(SceneBytes, EveryTruncatedPrefixIsRefused) {
  const std::string bytes = encodeScene(fullScene());
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    EXPECT_FALSE(decodeScene(bytes.substr(0, length), "file").ok()) << length;
  }
  EXPECT_FALSE(decodeScene(bytes + "x", "file").ok());
}

TEST(SceneBytes, WhatIsAcceptedAfterDamageCanBeBuilt) {
  const std::string bytes = encodeScene(fullScene());
  std::mt19937 random(7);
  int accepted = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::string damaged = bytes;
    damaged[random() % damaged.size()] = static_cast<char>(random());
    Result<FileScene> scene = decodeScene(damaged, "file");
    if (!scene) continue;
    ++accepted;
    (void)makeCharacterFile(std::move(*scene), "file");
  }
  EXPECT_GT(accepted, 100);
}

TEST(SceneBytes, BrokenPromisesAreRefused) {
  EXPECT_TRUE(decodeScene(encodeScene(fullScene()), "file").ok());
  const std::vector<void (*)(FileScene&)> changes = {
      [](FileScene& s) { s.nodes[0].parent = 1; },  // a cycle
      [](FileScene& s) { s.nodes[1].parent = 2; },
      [](FileScene& s) { s.nodes[1].local.translation.x() = NAN; },
      [](FileScene& s) { s.nodes[1].local.rotation.coeffs().setZero(); },
      [](FileScene& s) { s.skins[0].nodes[0] = 2; },
      [](FileScene& s) { s.skins[0].nodes.pop_back(); },
      [](FileScene& s) { s.meshes[0].node = -1; },
      [](FileScene& s) { s.meshes[0].skin = 1; },
      [](FileScene& s) { s.meshes[0].triangles[0][0] = 3; },
      [](FileScene& s) { s.meshes[0].triangles[0][0] = -1; },
      [](FileScene& s) { s.meshes[0].weightBegin[1] = 4; },
      [](FileScene& s) { s.meshes[0].weightBegin.pop_back(); },
      [](FileScene& s) { s.meshes[0].normals.pop_back(); },
      [](FileScene& s) { s.meshes[0].material = 1; },
      [](FileScene& s) { s.meshes[0].morphs[0].target = 1; },
      [](FileScene& s) { s.meshes[0].morphs[0].offsets[1].vertex = 1; },
      [](FileScene& s) { s.clips[0].tracks[0].node = 2; },
      [](FileScene& s) { s.clips[0].tracks[0].rotation->times[1] = 0.0; },
      [](FileScene& s) { s.clips[0].tracks[0].rotation->values.pop_back(); },
      [](FileScene& s) { s.materials[0].base.picture = 1; },
      [](FileScene& s) { s.materials[0].base.uvSet = 2; },
      [](FileScene& s) { s.metresPerUnit = 0.0; }};
  for (std::size_t i = 0; i < changes.size(); ++i) {
    FileScene scene = fullScene();
    changes[i](scene);
    EXPECT_FALSE(decodeScene(encodeScene(scene), "file").ok()) << "change " << i;
  }
}

}  // namespace
}  // namespace lorica
