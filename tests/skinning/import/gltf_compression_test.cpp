#include "tests/skinning/import/small_character.h"
#include "tests/support/value_of.h"

#include <draco/compression/encode.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <cstring>

namespace lorica {
namespace {

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
