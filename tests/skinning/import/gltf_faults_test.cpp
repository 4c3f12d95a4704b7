#include "tests/skinning/import/small_character.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <draco/compression/encode.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <cstring>
#include <functional>
#include <limits>

namespace lorica {
namespace {

using nlohmann::json;
using test::GlbWriter;
using test::parsed;
using test::smallCharacter;

TEST(GltfFaults, AreToldInOneSentence) {
  const auto set = [](const char* pointer, const json& value) {
    return [=](GlbWriter& w) { w.document[json::json_pointer(pointer)] = value; };
  };
  const auto floatAt = [](std::size_t byte, float value) {
    return [=](GlbWriter& w) { std::memcpy(w.binary.data() + byte, &value, 4); };
  };
  constexpr float infinity = std::numeric_limits<float>::infinity();
  struct Fault {
    std::function<void(GlbWriter&)> make;
    std::string message;  ///< after "hero.glb: "
    ErrorCode code = ErrorCode::kBadFormat;
  };
  const std::vector<Fault> faults = {
      {set("/accessors/0/count", 4000),
       "accessor 0: 4,000 elements of 12 bytes end at byte 48,000, but buffer view 0 has 96"},
      {set("/accessors/0/byteOffset", 4),
       "accessor 0: 8 elements of 12 bytes end at byte 100, but buffer view 0 has 96"},
      {set("/accessors/0/count", 4611686018427387904u),
       "accessor 0: 4,611,686,018,427,387,904 elements of 12 bytes end at byte 5.53e+19, but buffer view 0 has "
       "96"},
      {set("/accessors/0/byteOffset", 18446744073709551615u),
       "accessor 0: 8 elements of 12 bytes end at byte 1.84e+19, but buffer view 0 has 96"},
      {set("/accessors/0/count", 0),
       "accessor 0: has no elements, expected at least one for mesh 0 'Body', primitive 0: POSITION"},
      {[](GlbWriter& w) {
         w.document["accessors"][0].erase("bufferView");
         w.document["accessors"][0]["count"] = 1000000000;
       },
       "accessor 0: 1,000,000,000 elements, too many for a file of 1,808 bytes"},
      {set("/accessors/0/type", "VEC4"),
       "accessor 0: has 4 numbers per element, expected VEC3 for mesh 0 'Body', primitive 0: POSITION"},
      {set("/accessors/0/componentType", 5124),
       "accessor 0: component type 5124, expected 5120 to 5123, 5125 or 5126 for mesh 0 'Body', primitive 0: "
       "POSITION"},
      {set("/accessors/2/componentType", 5126),
       "accessor 2: component type 5126, expected unsigned integers (5121, 5123 or 5125) for mesh 0 'Body', "
       "primitive 0: JOINTS_0"},
      {set("/accessors/0/bufferView", 99), "accessor 0: refers to buffer view 99, expected 0 to 6"},
      {set("/accessors/0/bufferView", -7), "accessor 0: refers to buffer view -7, expected 0 to 6"},
      {set("/bufferViews/0/buffer", 3), "buffer view 0: refers to buffer 3, expected 0 to 0"},
      {set("/bufferViews/0/byteLength", 1000000), "buffer view 0: 1,000,000 bytes from byte 0, but buffer 0 has 496"},
      {set("/bufferViews/0/byteOffset", 18446744073709551615u),
       "buffer view 0: 96 bytes from byte 18,446,744,073,709,551,615, but buffer 0 has 496"},
      {set("/bufferViews/0/byteStride", 4), "accessor 0: elements of 12 bytes, but the stride of buffer view 0 is 4"},
      {set("/meshes/0/primitives/0/attributes/POSITION", 77),
       "mesh 0 'Body', primitive 0: POSITION: refers to accessor 77, expected 0 to 6"},
      {[](GlbWriter& w) { w.binary[96 + 4] = 8; },
       "mesh 0 'Body', primitive 0: index 2 refers to vertex 8, but it has 8"},
      {set("/meshes/0/primitives/0/mode", 9), "mesh 0 'Body', primitive 0: mode 9, expected 0 to 6"},
      {set("/accessors/2/count", 7),
       "mesh 0 'Body', primitive 0: JOINTS_0 has 7 elements, expected 8, one for each position"},
      {set("/accessors/3/count", 2),
       "mesh 0 'Body', primitive 0: WEIGHTS_0 has 2 elements, expected 8, one for each position"},
      {floatAt(16, std::numeric_limits<float>::quiet_NaN()),
       "accessor 0: element 1 has nan, expected finite numbers for mesh 0 'Body', primitive 0: POSITION"},
      {floatAt(96 + 72 + 32 + 128 + 64, -infinity),
       "accessor 4: element 1 has -inf, expected finite numbers for skin 0: inverse bind matrices"},
      {floatAt(496 - 32 - 4, infinity),
       "accessor 5: element 1 has inf, expected finite numbers for animation 0 'bend', channel 0: times"},
      {set("/accessors/4/count", 1), "skin 0: 1 inverse bind matrices for 2 joints"},
      {set("/skins/0/joints", json::array()), "skin 0: has no joints, expected at least one"},
      {set("/skins/0/joints/1", 5), "skin 0: refers to joint node 5, expected 0 to 2"},
      {set("/nodes/2/skin", 1), "node 2: refers to skin 1, expected 0 to 0"},
      {set("/nodes/2/mesh", 1), "node 2: refers to mesh 1, expected 0 to 0"},
      {set("/nodes/0/children", {1, 44}), "node 0: refers to child node 44, expected 0 to 2"},
      {set("/nodes/2/children", {1}), "node 1 'upper': is a child of node 0 and of node 2, expected one parent"},
      {set("/nodes/1/children", {0}), "node 0 'lower': is its own ancestor"},
      {set("/nodes/2/children", {2}), "node 2 'box': is its own ancestor"},
      {set("/nodes/1/rotation", {0, 0, 1}), "node 1: rotation has 3 numbers, expected 4"},
      {set("/nodes/1/matrix", std::vector<int>(15, 1)), "node 1: matrix has 15 numbers, expected 16"},
      {set("/scene", 2), "the file: refers to scene 2, expected 0 to 0"},
      {set("/scenes/0/nodes/0", 9), "scene 0: refers to node 9, expected 0 to 2"},
      {set("/animations/0/channels/0/target/node", 9),
       "animation 0 'bend', channel 0: refers to node 9, expected 0 to 2"},
      {set("/animations/0/channels/0/sampler", 1),
       "animation 0 'bend', channel 0: refers to sampler 1, expected 0 to 0"},
      {set("/animations/0/samplers/0/interpolation", "QUINTIC"),
       "animation 0 'bend', channel 0: interpolation 'QUINTIC', expected STEP, LINEAR or CUBICSPLINE"},
      {set("/accessors/6/count", 1), "animation 0 'bend', channel 0: 1 value for 2 keys, expected 2"},
      {set("/animations/0/samplers/0/interpolation", "CUBICSPLINE"),
       "animation 0 'bend', channel 0: 2 values for 2 keys, expected 6"},
      {[](GlbWriter& w) {
         const int rows = w.view(std::vector<std::uint8_t>{2, 8});
         const int values = w.view(std::vector<float>(6, 0.0F));
         w.document["accessors"][0]["sparse"] = test::sparse(2, rows, 5121, values);
       },
       "accessor 0: sparse index 1 is 8, expected 0 to 7"},
      {set("/accessors/0/sparse", test::sparse(9, 0, 5121, 0)),
       "accessor 0: its sparse part has 9 elements at bytes 0 and 0 with indices of type 5121, expected 1 to 8 "
       "elements, offsets of 0 or more and unsigned indices"},
      {set("/accessors/0/sparse", test::sparse(4, 1, 5121, 2)),
       "accessor 0, sparse values: 4 elements of 12 bytes end at byte 48, but buffer view 2 has 32"},
      {set("/buffers", json::array({{{"byteLength", 5000}}})),
       "buffer 0: byteLength is 5,000, but there are 496 bytes"},
      {set("/buffers", json::array({{{"uri", "x.bin"}}})), "buffer 0: has no byteLength, expected a whole number"},
      {set("/buffers", json::array({{{"byteLength", 5}, {"uri", "x.bin"}}})),
       "buffer 0: is in another file, 'x.bin', which is not available here"},
      {set("/buffers", json::array({{{"byteLength", 5}, {"uri", "data:application/octet-stream;base64,AA!A"}}})),
       "buffer 0: its data URI has byte 33 at 2, expected base64"},
      {[](GlbWriter& w) {
         w.document["buffers"] = {{{"byteLength", 496}}, {{"byteLength", 96}}};
         w.document["bufferViews"][0]["buffer"] = 1;
       },
       "buffer view 0: buffer 1 has no data, neither embedded nor in another file"},
      {set("/asset/version", "1.0"), "glTF version '1.0', expected 2.0", ErrorCode::kUnsupported},
      {[](GlbWriter& w) { w.document.erase("asset"); }, "glTF version '', expected 2.0"},
      {[](GlbWriter& w) { w.document["nodes"] = std::vector<json>(100001, json::object()); },
       "100,001 nodes, expected at most 100,000", ErrorCode::kUnsupported},
      {set("", {{"asset", {{"version", "2.0"}}}}), "no triangles, no bones and no motion, expected a character"},
      {set("/nodes/0/scale", {1e300, 1e300, 1e300}), "joint 1 'lower': its inverse bind matrix is not finite"},
      {[](GlbWriter& w) {
         w.document["nodes"][0]["scale"] = {1e300, 1e300, 1e300};
         w.document["nodes"][0]["name"] = "lo\n\x1b[2Jwer";
       },
       "joint 1 'lo\\x0a\\x1b[2Jwer': its inverse bind matrix is not finite"}};
  for (const Fault& fault : faults) {
    SCOPED_TRACE(fault.message);
    GlbWriter writer = smallCharacter();
    fault.make(writer);
    const Result<CharacterFile> file = parsed(writer);
    ASSERT_FALSE(file.ok());
    EXPECT_EQ(file.error().message, "hero.glb: " + fault.message);
    EXPECT_EQ(file.error().code, fault.code);
  }
}

[[nodiscard]] std::string complaint(const std::string& bytes) {
  const Result<CharacterFile> file = parseCharacterFile(std::as_bytes(std::span(bytes)), "hero.glb");
  return file.ok() ? "" : file.error().message;
}

TEST(GltfFile, LongNamesAreShortenedInMessages) {
  GlbWriter writer = smallCharacter();
  writer.document["nodes"][0]["scale"] = {1e300, 1e300, 1e300};
  writer.document["nodes"][0]["name"] = std::string(100'000, 'n');
  const std::string message = complaint(writer.glb());
  EXPECT_TRUE(message.starts_with("hero.glb: joint 1 'nnn")) << message;
  EXPECT_TRUE(message.ends_with("nnn': its inverse bind matrix is not finite")) << message;
  EXPECT_NE(message.find(" bytes) ... "), std::string::npos) << message;
  EXPECT_LT(message.size(), 1100u);
}

TEST(GltfFile, ContainersAreCheckedBeforeTheirContent) {
  const std::string sound = smallCharacter().glb();
  const auto changed = [&](std::size_t at, char byte) { return std::string(sound).replace(at, 1, 1, byte); };
  for (const auto& [bytes, message] : std::initializer_list<std::pair<std::string, std::string>>{
           {"", "is empty, expected a character"},
           {"glTF", "4 bytes, expected at least 12 for a GLB header: the file is truncated"},
           {changed(4, 1), "GLB version 1, expected 2"},
           {changed(0, 'h'), "unknown format, expected glTF, VRM, FBX or COLLADA"},
           {changed(16, 'X'), "chunk 0 has type 0x4e4f5358, expected JSON"},
           {sound.substr(0, 100), "its header declares 1,812 bytes, the file has 100: it is truncated"},
           {test::glbOf("[]", ""), "its JSON is not an object, expected a glTF object"}}) {
    EXPECT_EQ(complaint(bytes), "hero.glb: " + message);
  }
  EXPECT_EQ(complaint(changed(15, 1)).substr(0, 25), "hero.glb: chunk 0 of 16,7");
  EXPECT_EQ(complaint(test::glbOf("{\"asset\":", "")).substr(0, 29), "hero.glb: its JSON is broken:");
}

TEST(GltfFile, DeepJsonIsRefusedNotFollowed) {
  for (const char* key : {"extras", "extensions", "nodes"}) {
    std::string text = R"({"asset":{"version":"2.0"},")" + std::string(key) + "\":";
    text += std::string(200000, '[') + std::string(200000, ']') + "}";
    EXPECT_EQ(complaint(test::glbOf(text, "")), "hero.glb: its JSON nests deeper than 64 levels") << key;
  }
}

TEST(GltfFile, TheSameBytesUnderManyNamesAreReadOnlySoOften) {
  GlbWriter writer = smallCharacter();
  const int many = writer.accessor(std::vector<float>(30000, 0.5F), "VEC3");
  nlohmann::json primitive = {{"attributes", {{"POSITION", many}}}};
  writer.document["meshes"][0]["primitives"] = std::vector<nlohmann::json>(2000, primitive);
  writer.document["nodes"][2].erase("skin");
  EXPECT_NE(complaint(writer.glb()).find("too many for a file of"), std::string::npos) << complaint(writer.glb());
}

TEST(GltfFile, BuffersBesideTheFileAndInDataUrisAreRead) {
  const test::TemporaryFolder folder;
  const GlbWriter writer = smallCharacter();
  std::filesystem::create_directory(folder.path() / "sub");
  folder.write("sub/the body.bin", writer.binary);
  const auto read = [&](const std::string& uri) {
    return readCharacterFile(folder.write("hero.gltf", writer.gltf(uri)));
  };
  for (const std::string& uri :
       std::initializer_list<std::string>{"sub/the%20body.bin", "./sub/the body.bin", "sub\\the body.bin",
                                          "data:application/octet-stream;base64," + test::base64(writer.binary),
                                          "data:;base64," + test::base64(writer.binary)}) {
    const Result<CharacterFile> file = read(uri);
    ASSERT_TRUE(file.ok()) << uri << ": " << file.error().message;
    EXPECT_EQ(file->character.mesh.triangles.size(), 12u);
  }
  const Result<CharacterFile> missing = read("nowhere.bin");
  ASSERT_FALSE(missing.ok());
  EXPECT_NE(missing.error().message.find("nowhere.bin"), std::string::npos);
}

TEST(GltfFile, NothingOutsideTheFolderIsRead) {
  const test::TemporaryFolder folder;
  const GlbWriter writer = smallCharacter();
  std::filesystem::create_directory(folder.path() / "inside");
  const std::filesystem::path outside = folder.write("secret.bin", writer.binary);
  for (const std::string& uri : std::initializer_list<std::string>{
           "../secret.bin", "%2e%2e/secret.bin", "..\\secret.bin", "x/../../secret.bin", outside.string(),
           "file://" + outside.string(), "~/secret.bin", "C:/secret.bin"}) {
    const Result<CharacterFile> file = readCharacterFile(folder.write("inside/hero.gltf", writer.gltf(uri)));
    ASSERT_FALSE(file.ok()) << uri;
    EXPECT_NE(file.error().message.find("is outside the file's folder"), std::string::npos) << file.error().message;
  }
}

/// The numbers of an accessor that fills its buffer view.
template <typename Number>
std::vector<Number> numbersOf(const test::GlbWriter& writer, int accessor) {
  const nlohmann::json& view =
      writer.document["bufferViews"][writer.document["accessors"][accessor]["bufferView"].get<std::size_t>()];
  std::vector<Number> numbers(view["byteLength"].get<std::size_t>() / sizeof(Number));
  std::memcpy(numbers.data(), writer.binary.data() + view["byteOffset"].get<std::size_t>(),
              numbers.size() * sizeof(Number));
  return numbers;
}

/// Replaces the content of an accessor's view by compressed bytes.
void pack(test::GlbWriter& writer, int accessor, std::vector<unsigned char> bytes, std::size_t size, const char* mode,
          std::size_t stride, std::size_t count, const char* filter = nullptr) {
  bytes.resize(size);
  const int packed = writer.view(bytes);
  nlohmann::json extension = writer.document["bufferViews"][packed];
  extension.update({{"mode", mode}, {"byteStride", stride}, {"count", count}});
  if (filter != nullptr) extension["filter"] = filter;
  nlohmann::json& view =
      writer.document["bufferViews"][writer.document["accessors"][accessor]["bufferView"].get<std::size_t>()];
  view = {{"buffer", 1},
          {"byteOffset", 0},
          {"byteLength", count * stride},
          {"extensions", {{"EXT_meshopt_compression", extension}}}};
}

/// The small character with positions and indices as meshopt data.
test::GlbWriter meshoptCharacter() {
  test::GlbWriter writer = test::smallCharacter();
  const std::vector<float> positions = numbersOf<float>(writer, 0);
  const std::size_t vertices = positions.size() / 3;
  std::vector<unsigned char> bytes(meshopt_encodeVertexBufferBound(vertices, 12));
  const std::size_t size = meshopt_encodeVertexBuffer(bytes.data(), bytes.size(), positions.data(), vertices, 12);
  pack(writer, 0, bytes, size, "ATTRIBUTES", 12, vertices);
  std::vector<std::uint32_t> indices;
  const bool wide = writer.document["accessors"][1]["componentType"] == 5125;
  if (wide) indices = numbersOf<std::uint32_t>(writer, 1);
  if (!wide) {
    for (const std::uint16_t i : numbersOf<std::uint16_t>(writer, 1)) indices.push_back(i);
  }
  std::vector<unsigned char> packed(meshopt_encodeIndexBufferBound(indices.size(), vertices));
  const std::size_t length = meshopt_encodeIndexBuffer(packed.data(), packed.size(), indices.data(), indices.size());
  pack(writer, 1, packed, length, "TRIANGLES", wide ? 4 : 2, indices.size());
  writer.document["extensionsUsed"] = {"EXT_meshopt_compression"};
  writer.document["extensionsRequired"] = {"EXT_meshopt_compression"};
  return writer;
}

/// A GLB whose second buffer exists only for programs that do not know meshopt, and has no content.
Result<CharacterFile> parsedWithFallback(test::GlbWriter writer) {
  nlohmann::json buffers = {
      {{"byteLength", writer.binary.size()}},
      {{"byteLength", 100'000}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
  nlohmann::json document = writer.document;
  document["buffers"] = buffers;
  const std::string glb = test::glbOf(document.dump(), writer.binary);
  return parseCharacterFile(std::as_bytes(std::span(glb)), "hero.glb");
}

void expectSameSurface(const CharacterFile& a, const CharacterFile& b, double tolerance) {
  const Character& x = a.character;
  const Character& y = b.character;
  ASSERT_EQ(x.mesh.triangles.size(), y.mesh.triangles.size());
  EXPECT_NEAR(signedVolume(x.mesh.vertices, x.mesh.triangles), signedVolume(y.mesh.vertices, y.mesh.triangles),
              tolerance);
  EXPECT_LE((boundsOf(x.mesh.vertices).max - boundsOf(y.mesh.vertices).max).norm(), tolerance);
  // Each vertex follows the joint of its half.
  for (std::size_t v = 0; v < y.mesh.vertices.size(); ++v) {
    const Influence& influence = y.influences[y.influenceBegin[v]];
    EXPECT_EQ(y.skeleton.joint(influence.joint).name, y.mesh.vertices[v].y() > 1.0 ? "upper" : "lower");
  }
}

TEST(GltfCompression, MeshoptIsTheSameMesh) {
  const CharacterFile plain = test::valueOf(test::parsed(test::smallCharacter()));
  expectSameSurface(plain, test::valueOf(parsedWithFallback(meshoptCharacter())), 0.0);
}

TEST(GltfCompression, MeshoptThatIsBrokenIsRefused) {
  const auto why = [](const auto& change) {
    test::GlbWriter writer = meshoptCharacter();
    change(writer.document["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]);
    const Result<CharacterFile> file = parsedWithFallback(writer);
    return file.ok() ? std::string() : file.error().message;
  };
  EXPECT_NE(why([](auto& e) { e["byteStride"] = 3; }).find("elements of 3 bytes does not fit the mode ATTRIBUTES"),
            std::string::npos);
  EXPECT_NE(why([](auto& e) { e["count"] = 100'000'000; }).find("too many for a file of"), std::string::npos);
  EXPECT_NE(why([](auto& e) { e["byteLength"] = 3; }).find("its meshopt data is broken or of a newer version"),
            std::string::npos);
  EXPECT_NE(why([](auto& e) { e["byteLength"] = 1'000'000; }).find("but buffer 0 has"), std::string::npos);
  EXPECT_NE(why([](auto& e) { e["mode"] = 7; }).find("does not fit the mode (none)"), std::string::npos);
  EXPECT_NE(why([](auto& e) { e["filter"] = "COLOR"; }).find("filter COLOR"), std::string::npos);
}

/// The small character's mesh as Draco data.
std::string dracoOf(const test::GlbWriter& writer, int method) {
  const std::vector<float> positions = numbersOf<float>(writer, 0);
  const std::vector<std::uint8_t> joints = numbersOf<std::uint8_t>(writer, 2);
  const std::vector<float> weights = numbersOf<float>(writer, 3);
  const std::uint32_t points = static_cast<std::uint32_t>(positions.size() / 3);
  draco::Mesh mesh;
  mesh.set_num_points(points);
  const auto add = [&](draco::GeometryAttribute::Type kind, draco::DataType type, int components, const auto& numbers) {
    using Number = typename std::decay_t<decltype(numbers)>::value_type;
    draco::GeometryAttribute attribute;
    attribute.Init(kind, nullptr, static_cast<std::int8_t>(components), type, false,
                   static_cast<std::int64_t>(components * sizeof(Number)), 0);
    const int id = mesh.AddAttribute(attribute, true, points);
    for (std::uint32_t p = 0; p < points; ++p) {
      mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(p), &numbers[p * components]);
    }
  };
  add(draco::GeometryAttribute::POSITION, draco::DT_FLOAT32, 3, positions);
  add(draco::GeometryAttribute::GENERIC, draco::DT_UINT8, 4, joints);
  add(draco::GeometryAttribute::GENERIC, draco::DT_FLOAT32, 4, weights);
  const bool wide = writer.document["accessors"][1]["componentType"] == 5125;
  std::vector<std::uint32_t> indices;
  if (wide) indices = numbersOf<std::uint32_t>(writer, 1);
  if (!wide) {
    for (const std::uint16_t i : numbersOf<std::uint16_t>(writer, 1)) indices.push_back(i);
  }
  for (std::size_t i = 0; i < indices.size(); i += 3) {
    mesh.AddFace({draco::PointIndex(indices[i]), draco::PointIndex(indices[i + 1]), draco::PointIndex(indices[i + 2])});
  }
  draco::Encoder encoder;
  encoder.SetEncodingMethod(method);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 16);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(mesh, &buffer).ok());
  return {buffer.data(), buffer.size()};
}

test::GlbWriter dracoCharacter(const std::string& data) {
  test::GlbWriter writer = test::smallCharacter();
  for (const int accessor : {0, 1, 2, 3}) writer.document["accessors"][accessor].erase("bufferView");
  const int view = writer.view(std::vector<char>(data.begin(), data.end()));
  writer.document["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", view}, {"attributes", {{"POSITION", 0}, {"JOINTS_0", 1}, {"WEIGHTS_0", 2}}}};
  writer.document["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  return writer;
}

TEST(GltfCompression, DracoIsTheSameMesh) {
  const CharacterFile plain = test::valueOf(test::parsed(test::smallCharacter()));
  const std::string data = dracoOf(test::smallCharacter(), draco::MESH_SEQUENTIAL_ENCODING);
  expectSameSurface(plain, test::valueOf(test::parsed(dracoCharacter(data))), 1e-3);
}

TEST(GltfCompression, DracoThatIsBrokenIsRefused) {
  const std::string data = dracoOf(test::smallCharacter(), draco::MESH_SEQUENTIAL_ENCODING);
  const auto why = [](const std::string& bytes) {
    const Result<CharacterFile> file = test::parsed(dracoCharacter(bytes));
    return file.ok() ? std::string() : file.error().message;
  };
  EXPECT_NE(why("no data").find("is no Draco data"), std::string::npos);
  for (std::size_t length = 12; length < data.size(); ++length) {
    EXPECT_NE(why(data.substr(0, length)), "") << length;
  }
  std::string huge = data.substr(0, 11) + "\xff\xff\xff\xff\x0f\xff\xff\xff\xff\x0f";
  EXPECT_NE(why(huge).find("triangles of"), std::string::npos) << why(huge);
  std::string old = data;
  old[6] = 1;
  EXPECT_NE(why(old).find("expected a plain mesh of version 2.2: export it without mesh compression"),
            std::string::npos);
}

}  // namespace
}  // namespace lorica
