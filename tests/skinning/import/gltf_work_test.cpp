#include "geometry/counts.h"
#include "geometry/files.h"
#include "geometry/random_numbers.h"
#include "geometry/work_budgets.h"
#include "skinning/import/character_file.h"
#include "skinning/import/file_scene.h"
#include "skinning/import/gltf_document.h"
#include "skinning/import/uri.h"
#include "tests/skinning/import/agreement.h"
#include "tests/skinning/import/glb_writer.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace lorica::test {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::json;
using nlohmann::json;
using test::GlbWriter;

using Json = nlohmann::json;

class Maker {
 public:
  explicit Maker(std::uint64_t seed) : random_(seed) {}

  std::string make() {
    addNodes();
    for (int skins = below(4); skins > 0; --skins) addSkin();
    for (int meshes = 1 + below(4); meshes > 0; --meshes) addMesh();
    for (int clips = below(3); clips > 0; --clips) addClip();
    return out_.glb();
  }

 private:
  int below(int count) { return static_cast<int>(random_.bits() % static_cast<std::uint64_t>(count)); }
  bool oneIn(int count) { return below(count) == 0; }
  float between(double low, double high) { return static_cast<float>(random_.between(low, high)); }
  std::vector<float> floats(int count, double size) {
    std::vector<float> numbers;
    for (int i = 0; i < count; ++i) numbers.push_back(between(-size, size));
    return numbers;
  }
  std::vector<float> rotation() {
    std::vector<float> q = floats(4, 1.0);
    float norm = 0.0F;
    for (const float x : q) norm += x * x;
    norm = std::sqrt(norm) + 1e-6F;
    for (float& x : q) x /= norm;
    return q;
  }

  void addNodes() {
    nodeCount_ = 3 + below(10);
    for (int i = 0; i < nodeCount_; ++i) {
      Json node = {{"name", std::to_string(i)}};
      if (oneIn(4)) {
        std::vector<float> m = floats(16, 1.0);
        for (const int c : {0, 5, 10}) m[c] += 1.5F;  // sheared, but not flat
        for (const int c : {3, 7, 11}) m[c] = 0.0F;
        m[15] = 1.0F;
        node["matrix"] = m;
        fixed_.push_back(true);
      } else {
        if (!oneIn(3)) node["translation"] = floats(3, 1.0);
        if (!oneIn(3)) node["rotation"] = rotation();
        if (oneIn(3)) node["scale"] = {between(0.5, 2.0), between(-2.0, -0.5), between(0.5, 2.0)};
        if (oneIn(4)) node["scale"] = {1.5, 1.5, 1.5};
        fixed_.push_back(false);
      }
      out_.add("nodes", node);
      // Parents at lower or higher indices: any tree is valid.
      if (i > 0 && !oneIn(5)) out_.document["nodes"][below(i)]["children"].push_back(i);
    }
  }

  void addSkin() {
    Json skin;
    std::vector<int> joints;
    for (int n = 0; n < nodeCount_; ++n) {
      if (!oneIn(3)) joints.push_back(n);
    }
    if (joints.empty()) joints.push_back(0);
    skin["joints"] = joints;
    if (!oneIn(4)) {
      std::vector<Affine3> inverseBinds;
      for (std::size_t j = 0; j < joints.size(); ++j) {
        Affine3 m = Affine3::Identity();
        for (int r = 0; r < 3; ++r) {
          for (int c = 0; c < 4; ++c) m.matrix()(r, c) += random_.between(-0.4, 0.4);
        }
        inverseBinds.push_back(m);
      }
      skin["inverseBindMatrices"] = out_.matrices(inverseBinds);
    }
    skinSizes_.push_back(countOf(joints));
    out_.add("skins", skin);
  }

  int addPositions(int vertices) {
    switch (below(4)) {
      case 0: {  // normalised shorts
        std::vector<std::int16_t> shorts;
        for (int i = 0; i < 3 * vertices; ++i) shorts.push_back(static_cast<std::int16_t>(random_.bits()));
        return out_.accessor(shorts, "VEC3", true, 8);
      }
      case 1: {  // zeros, with some replaced
        std::vector<std::uint16_t> rows;
        for (int v = 0; v < vertices; v += 2) rows.push_back(static_cast<std::uint16_t>(v));
        const int rowView = out_.view(rows);
        const int valueView = out_.view(floats(3 * countOf(rows), 1.0));
        return out_.add("accessors", {{"componentType", 5126},
                                      {"count", vertices},
                                      {"type", "VEC3"},
                                      {"sparse", sparse(rows.size(), rowView, 5123, valueView)}});
      }
      case 2: {  // floats with a stride, some replaced
        const int base = out_.accessor(floats(3 * vertices, 1.0), "VEC3", false, 20);
        const std::vector<std::uint32_t> rows = {1, static_cast<std::uint32_t>(vertices - 1)};
        const int rowView = out_.view(rows);
        const int valueView = out_.view(floats(6, 1.0));
        out_.document["accessors"][base]["sparse"] = sparse(2, rowView, 5125, valueView);
        return base;
      }
      default:
        return out_.accessor(floats(3 * vertices, 1.0), "VEC3");
    }
  }

  void addInfluences(Json& attributes, int vertices, int bones) {
    const int sets = 1 + below(2);
    const int kind = below(3);
    for (int set = 0; set < sets; ++set) {
      std::vector<std::uint8_t> joints8;
      std::vector<std::uint16_t> joints16;
      std::vector<float> weights;
      std::vector<std::uint8_t> weights8;
      std::vector<std::uint16_t> weights16;
      for (int v = 0; v < vertices; ++v) {
        // Fractions of 1 that bytes and shorts can store: k / 255 and k / 65535 with sums of 255 and 65535.
        std::array<int, 4> shares{};
        const int whole = kind == 1 ? 255 : 65535;
        int left = set + 1 < sets ? whole / 2 : sets == 1 ? whole : whole - whole / 2;
        for (std::size_t i = 0; i < 4; ++i) {
          shares[i] = i == 3 ? left : below(left + 1);
          left -= shares[i];
          const int bone = below(bones);
          joints8.push_back(static_cast<std::uint8_t>(bone));
          joints16.push_back(static_cast<std::uint16_t>(bone));
          weights8.push_back(static_cast<std::uint8_t>(shares[i]));
          weights16.push_back(static_cast<std::uint16_t>(shares[i]));
          weights.push_back(static_cast<float>(shares[i]) / static_cast<float>(whole));
        }
      }
      const std::string name = std::to_string(set);
      attributes["JOINTS_" + name] = oneIn(2) ? out_.accessor(joints8, "VEC4") : out_.accessor(joints16, "VEC4");
      attributes["WEIGHTS_" + name] = kind == 0   ? out_.accessor(weights, "VEC4")
                                      : kind == 1 ? out_.accessor(weights8, "VEC4", true)
                                                  : out_.accessor(weights16, "VEC4", true);
    }
  }

  void addMesh() {
    const int node = below(nodeCount_);
    Json& drawn = out_.document["nodes"][node];
    if (drawn.contains("mesh")) return;
    const int skin = skinSizes_.empty() || oneIn(3) ? -1 : below(countOf(skinSizes_));
    const int targets = oneIn(3) ? 2 : 0;
    Json mesh;
    const int primitives = 1 + below(2);
    for (int p = 0; p < primitives; ++p) {
      const int vertices = 4 + below(9);
      Json primitive;
      primitive["attributes"]["POSITION"] = addPositions(vertices);
      for (int t = 0; t < targets; ++t) primitive["targets"].push_back({{"POSITION", addPositions(vertices)}});
      if (skin != -1) addInfluences(primitive["attributes"], vertices, skinSizes_[skin]);
      if (!oneIn(3)) primitive["mode"] = 4 + below(3);
      if (!oneIn(3)) {
        std::vector<std::uint8_t> indices;
        for (int i = 0; i < 3 + 3 * below(8); ++i) indices.push_back(static_cast<std::uint8_t>(below(vertices)));
        primitive["indices"] = out_.accessor(indices, "SCALAR");
      }
      mesh["primitives"].push_back(primitive);
    }
    if (targets > 0) mesh["weights"] = {0.5, -0.25};
    Json& position = out_.document["nodes"][node];
    if (targets > 0 && oneIn(2)) position["weights"] = {0.0, 1.0};
    position["mesh"] = out_.add("meshes", mesh);
    if (skin != -1) position["skin"] = skin;
  }

  void addClip() {
    Json clip;
    for (int n = 0; n < nodeCount_; ++n) {
      if (fixed_[n] || oneIn(3)) continue;
      for (const std::string path : {"translation", "rotation", "scale"}) {
        if (oneIn(2)) continue;
        const std::array<const char*, 3> kinds = {"STEP", "LINEAR", "CUBICSPLINE"};
        const int kind = below(3);
        const int keys = 1 + below(4);
        std::vector<float> times = {between(0.0, 0.5)};
        for (int k = 1; k < keys; ++k) times.push_back(times.back() + between(0.1, 1.0));
        std::vector<float> values;
        for (int k = 0; k < keys * (kind == 2 ? 3 : 1); ++k) {
          std::vector<float> value = path == "rotation" ? rotation() : floats(3, 1.0);
          if (path == "scale") value = {between(0.5, 2.0), between(0.5, 2.0), between(0.5, 2.0)};
          values.insert(values.end(), value.begin(), value.end());
        }
        const int input = out_.accessor(times, "SCALAR");
        int output = 0;
        if (path == "rotation" && kind != 2 && oneIn(2)) {  // normalised shorts
          std::vector<std::int16_t> shorts;
          for (const float x : values) shorts.push_back(static_cast<std::int16_t>(std::lround(32767.0F * x)));
          output = out_.accessor(shorts, "VEC4", true);
        } else {
          output = out_.accessor(values, path == "rotation" ? "VEC4" : "VEC3");
        }
        const std::size_t sampler = clip.contains("samplers") ? clip["samplers"].size() : 0;
        clip["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", kinds[kind]}});
        clip["channels"].push_back({{"sampler", sampler}, {"target", {{"node", n}, {"path", path}}}});
      }
    }
    if (!clip.is_null()) out_.add("animations", clip);
  }

  RandomNumbers random_;
  GlbWriter out_;
  int nodeCount_ = 0;
  std::vector<bool> fixed_;
  std::vector<int> skinSizes_;
};

/// A character that conforms to glTF 2.0 and uses many of its features: nodes by matrix (sheared ones too) and by
/// translation, rotation and scale (mirrored and uneven ones too); skins with different inverse bind matrices over the
/// same bones, some without any; 4 to 8 influences in bytes, shorts or floats; rigid meshes; strips, fans, indices and
/// none; strides, sparse and normalised positions; morph targets; clips of all three interpolations.
std::string randomGlb(std::uint64_t seed) {
  return Maker(seed).make();
}

std::string errorOf(const GlbWriter& writer) {
  const std::string glb = writer.glb();
  const Result<CharacterFile> file = parseCharacterFile(std::as_bytes(std::span(glb)), "hero.glb");
  return file ? "none" : file.error().message;
}

/// Nodes that all draw one mesh of primitives that share one triangle.
GlbWriter repeated(int nodes, int primitives, int mode) {
  GlbWriter writer;
  const int triangle = writer.accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  Json mesh = {{"primitives", Json::array()}};
  for (int p = 0; p < primitives; ++p) {
    mesh["primitives"].push_back({{"attributes", {{"POSITION", triangle}}}, {"mode", mode}});
  }
  writer.add("meshes", mesh);
  for (int n = 0; n < nodes; ++n) writer.add("nodes", {{"mesh", 0}});
  return writer;
}

TEST(GltfWork, NodesTimesPrimitivesAreBounded) {
  for (const int mode : {0, 4}) {  // points are skipped, but that takes time, too
    const Clock::time_point start = Clock::now();
    EXPECT_EQ(errorOf(repeated(99'000, 10'000, mode)),
              "hero.glb: its nodes draw 990,000,000 primitives, expected at most 200,000");
    EXPECT_LT(Clock::now() - start, std::chrono::seconds(60)) << "990 million steps take minutes";
  }
  EXPECT_EQ(errorOf(repeated(200, 100, 4)), "none");
}

/// A skin of joints in a chain or in a fan.
GlbWriter skinned(int joints, bool chain) {
  GlbWriter writer;
  const int triangle = writer.accessor(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  const int bones = writer.accessor(std::vector<std::uint16_t>(12, 0), "VEC4");
  const int weights = writer.accessor(std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4");
  Json list = Json::array();
  for (int j = 0; j < joints; ++j) {
    Json node = Json::object();
    if (chain && j + 1 < joints) node["children"] = Json::array({j + 1});
    if (!chain && j == 0) {
      for (int child = 1; child < joints; ++child) node["children"].push_back(child);
    }
    writer.add("nodes", node);
    list.push_back(j);
  }
  writer.add("skins", {{"joints", list}});
  writer.add(
      "meshes",
      {{"primitives",
        Json::array({{{"attributes", {{"POSITION", triangle}, {"JOINTS_0", bones}, {"WEIGHTS_0", weights}}}}})}});
  writer.add("nodes", {{"mesh", 0}, {"skin", 0}});
  return writer;
}

TEST(GltfWork, TrianglesAreBounded) {
  FileScene scene;
  for (FileMesh& mesh : scene.meshes = std::vector<FileMesh>(2)) mesh.triangles.resize(kMaxTriangles / 2);
  EXPECT_TRUE(checkWork(scene, "hero.glb").ok());
  scene.meshes[0].triangles.emplace_back();
  EXPECT_EQ(checkWork(scene, "hero.glb").error().message,
            "hero.glb: 10,000,001 triangles, expected at most 10,000,000");
}

TEST(GltfWork, JointsAreBounded) {
  for (const bool chain : {false, true}) {
    EXPECT_EQ(errorOf(skinned(kMaxJoints + 1, chain)), "hero.glb: 2,049 joints, expected at most 2,048") << chain;
    EXPECT_EQ(errorOf(skinned(kMaxJoints, chain)), "none");
  }
}

/// A triangle on a node, and a strand of joints that swing below it.
GlbWriter stranded(std::size_t joints) {
  GlbWriter writer = repeated(1, 1, 4);
  Json strand = Json::array();
  for (std::size_t j = 1; j <= joints; ++j) {
    writer.document["nodes"][j - 1]["children"] = Json::array({j});
    writer.add("nodes", {{"translation", {0.0, -0.01, 0.0}}});
    strand.push_back({{"node", j}});
  }
  writer.document["extensions"]["VRMC_vrm"] = {{"specVersion", "1.0"}};
  writer.document["extensions"]["VRMC_springBone"] = {{"specVersion", "1.0"},
                                                      {"springs", Json::array({{{"joints", strand}}})}};
  return writer;
}

TEST(GltfWork, JointsThatSwingAreBoundedWithoutASkin) {
  // The end of a strand is no joint; the node above it is one.
  EXPECT_EQ(errorOf(stranded(kMaxJoints + 1)), "hero.glb: 2,049 joints, expected at most 2,048");
  EXPECT_EQ(errorOf(stranded(kMaxJoints)), "none");
}

TEST(GltfWork, ClipsAreBounded) {
  const auto withClips = [](std::size_t clips) {
    GlbWriter writer = repeated(1, 1, 4);
    const int times = writer.accessor(std::vector<float>{0, 1}, "SCALAR");
    const int moves = writer.accessor(std::vector<float>{0, 0, 0, 1, 0, 0}, "VEC3");
    const Json clip = {
        {"samplers", Json::array({{{"input", times}, {"output", moves}}})},
        {"channels", Json::array({{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}})}};
    for (std::size_t c = 0; c < clips; ++c) writer.add("animations", clip);
    return writer;
  };
  EXPECT_EQ(errorOf(withClips(kMaxClips + 1)), "hero.glb: 10,001 clips, expected at most 10,000");
  EXPECT_EQ(errorOf(withClips(kMaxClips)), "none");
}

TEST(GltfWork, BuffersInNamedPipesAreRefused) {
  const test::TemporaryFolder folder;
  ASSERT_EQ(::mkfifo((folder.path() / "fifo.bin").c_str(), 0600), 0);
  const Result<CharacterFile> file = readCharacterFile(folder.write(
      "fifo.gltf", R"({"asset": {"version": "2.0"}, "buffers": [{"uri": "fifo.bin", "byteLength": 10}]})"));
  ASSERT_FALSE(file.ok());
  EXPECT_NE(file.error().message.find("found a named pipe, expected a file"), std::string::npos);
}

TEST(DataUri, BytesAbove127AreNotNegative) {
  const Result<std::string> bytes = decodeDataUri("data:;base64,AA\xe4");
  ASSERT_FALSE(bytes.ok());
  EXPECT_EQ(bytes.error().message, "its data URI has byte 228 at 2, expected base64");
}

TEST(GltfTypes, AnEmptyDocumentHasNoFault) {
  EXPECT_TRUE(checkGltfTypes(json::object(), "a.gltf"));
  EXPECT_TRUE(checkGltfTypes({{"nodes", json::array()}, {"scenes", {{{"nodes", json::array()}}}}}, "a.gltf"));
}

TEST(GltfTypes, WhatIsNotReadMayBeAnything) {
  EXPECT_TRUE(checkGltfTypes({{"materials", 5}, {"nodes", {{{"name", 7}, {"camera", "x"}}}}}, "a.gltf"));
}

TEST(GltfTypes, TheFirstFaultIsToldWithItsPlace) {
  const std::vector<std::pair<json, const char*>> faults = {
      {{{"scene", 0.5}}, "a.gltf: /scene: 0.5, expected a whole number from 0 on"},
      {{{"accessors", {{{"bufferView", "0"}}}}},
       "a.gltf: /accessors/0/bufferView: a text, expected a whole number from 0 on"},
      {{{"accessors", {{{"bufferView", -1}}}}},
       "a.gltf: /accessors/0/bufferView: -1, expected a whole number from 0 on"},
      {{{"accessors", "none"}}, "a.gltf: /accessors: a text, expected a list or object"},
      {{{"bufferViews", {1}}}, "a.gltf: /bufferViews/0: 1, expected an object"},
      {{{"accessors", {{{"normalized", 1}}}}}, "a.gltf: /accessors/0/normalized: 1, expected true or false"},
      {{{"nodes", {json::object(), {{"children", {3, nullptr}}}}}},
       "a.gltf: /nodes/1/children/1: null, expected a whole number from 0 on"},
      {{{"nodes", {{{"scale", {1, "1", 1}}}}}}, "a.gltf: /nodes/0/scale/1: a text, expected a number"},
      {{{"meshes", {{{"primitives", {{{"attributes", {{"POSITION", true}}}}}}}}}},
       "a.gltf: /meshes/0/primitives/0/attributes/POSITION: true, expected a whole number from 0 on"},
      {{{"animations", {{{"channels", {{{"sampler", 0}, {"target", {{"path", json::array()}}}}}}}}}},
       "a.gltf: /animations/0/channels/0/target/path: a list or object, expected a text"},
      {{{"animations", {{{"channels", {{{"target", {{"path", "scale"}}}}}}}}}},
       "a.gltf: /animations/0/channels/0: has no sampler, expected a whole number from 0 on"},
  };
  for (const auto& [document, sentence] : faults) {
    const Result<void> checked = checkGltfTypes(document, "a.gltf");
    ASSERT_FALSE(checked) << document;
    EXPECT_EQ(checked.error().message, sentence);
    EXPECT_EQ(checked.error().code, ErrorCode::kBadFormat);
  }
}

/// Every shared character, at rest and in every clip.
class GltfSpecification : public testing::TestWithParam<const char*> {};

TEST_P(GltfSpecification, SkinnedPositionsAgreeWithAnIndependentEvaluation) {
  LORICA_REQUIRE_DATASET(path, GetParam());
  const CharacterFile file = test::valueOf(readCharacterFile(path));
  const test::GltfTruth truth = test::GltfTruth::ofFile(path);
  ASSERT_EQ(countOf(file.clips), truth.animationCount());
  const double tolerance = 1e-5 * file.character.height;
  ASSERT_GT(tolerance, 0.0);

  EXPECT_LE(test::farthestFromTruth(file, truth, -1, 0.0), tolerance);
  double worst = 0.0;
  for (int clip = 0; clip < truth.animationCount(); ++clip) {
    const double seconds = truth.seconds(clip);
    EXPECT_NEAR(file.clips[clip].seconds, seconds, 1e-12);
    for (const double part : {0.0, 0.3819, 1.0}) {
      const double far = test::farthestFromTruth(file, truth, clip, part * seconds);
      EXPECT_LE(far, tolerance) << "clip " << clip << " at " << part * seconds << " s";
      worst = std::max(worst, far);
    }
  }
  RecordProperty("farthestOfHeight", std::to_string(worst / file.character.height));
}

INSTANTIATE_TEST_SUITE_P(Shared, GltfSpecification,
                         testing::Values("characters/cesiumman/CesiumMan.glb", "characters/fox/Fox.glb",
                                         "characters/greenman/greenman.glb", "characters/kaykit/Barbarian.glb",
                                         "characters/kaykit/Mage.glb", "characters/raylib_robot/robot.glb",
                                         "characters/godette/Godette_vrm_v4.vrm"));

TEST(GltfFile, EveryShortenedFileIsRefusedInASentence) {
  LORICA_REQUIRE_DATASET(path, "characters/cesiumman/CesiumMan.glb");
  std::ifstream in(path, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  for (std::size_t length = 0; length < whole.size(); length += length < 200 ? 1 : 997) {
    const std::string part = whole.substr(0, length);
    const Result<CharacterFile> file = parseCharacterFile(std::as_bytes(std::span(part)), "man.glb");
    ASSERT_FALSE(file.ok()) << length;
    EXPECT_EQ(file.error().message.substr(0, 9), "man.glb: ") << length;
  }
}

/// The fuzzer's seeds and the crashes it once found: read or rejected, with the same result each time.
TEST(GltfCorpus, IsReadOrRefusedAndNothingElse) {
  const std::filesystem::path folder = test::recordingsFolder().parent_path() / "tests" / "fuzz" / "corpus" / "glb";
  int read = 0;
  int refused = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    SCOPED_TRACE(entry.path().string());
    const std::string content = test::valueOf(readFile(entry.path()));
    std::string glb = content;
    if (!glb.starts_with("glTF")) {  // JSON, a zero byte, binary
      const std::size_t zero = std::min(glb.find('\0'), glb.size());
      glb = test::glbOf(glb.substr(0, zero), zero < glb.size() ? glb.substr(zero + 1) : "");
    }
    const Result<CharacterFile> file = parseCharacterFile(std::as_bytes(std::span(glb)), "corpus.glb");
    (file.ok() ? read : refused) += 1;
    if (file.ok() && !file->character.mesh.vertices.empty()) {
      EXPECT_TRUE(checkCharacter(file->character).ok());
    }
    // A file named as valid must stay valid.
    const std::string name = entry.path().filename().string();
    for (const char* sound : {"small", "random", "vrm", "datauri"}) {
      EXPECT_TRUE(file.ok() || !name.starts_with(sound)) << file.error().message;
    }
  }
  EXPECT_GT(read, 10);
}

TEST(GltfRandom, EveryMixOfFeaturesAgreesWithTheSpecification) {
  int compared = 0;
  int clipsSeen = 0;
  std::set<int> influences;
  int withCopies = 0;
  int withShear = 0;
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    SCOPED_TRACE(seed);
    const std::string glb = test::randomGlb(seed);
    const Result<CharacterFile> file = parseCharacterFile(std::as_bytes(std::span(glb)), "random.glb");
    const test::GltfTruth truth(glb);
    if (truth.triangles(-1, 0.0).empty()) continue;
    ASSERT_TRUE(file.ok()) << file.error().message;
    EXPECT_EQ(file->repairedVertices, 0);
    const double tolerance = 1e-5 * boundsOf(file->character.mesh.vertices).diagonal();
    EXPECT_LE(test::farthestFromTruth(*file, truth, -1, 0.0), tolerance);
    ++compared;
    influences.insert(file->maxInfluences);
    for (const std::string& note : file->notes) {
      withCopies += note.find("more than one bind matrix") != std::string::npos ? 1 : 0;
      withShear += note.find("sheared") != std::string::npos ? 1 : 0;
    }
    // A clip of nodes that move nothing is skipped; only then do the lists differ.
    if (countOf(file->clips) != truth.animationCount()) continue;
    for (int clip = 0; clip < truth.animationCount(); ++clip) {
      ++clipsSeen;
      for (const double time : {-1.0, 0.3, 0.71, 1.4, 2.0, 9.0}) {
        EXPECT_LE(test::farthestFromTruth(*file, truth, clip, time), tolerance) << "clip " << clip << " at " << time;
      }
    }
  }
  EXPECT_GT(compared, 300);
  EXPECT_GT(clipsSeen, 200);
  EXPECT_GT(withCopies, 20);
  EXPECT_GT(withShear, 100);
  EXPECT_EQ(*influences.rbegin(), 8);
}

}  // namespace
}  // namespace lorica::test
