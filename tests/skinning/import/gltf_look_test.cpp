// Normals, tangents, texture coordinates and colours of vertices, and the groups of triangles.

#include "skinning/import/gltf_parts.h"

#include "tests/skinning/import/material_samples.h"
#include "tests/skinning/import/small_character.h"
#include "tests/support/meshes.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <limits>

namespace lorica {
namespace {

using test::dressedCharacter;
using test::GlbWriter;
using test::notesWith;
using test::parsed;
using Json = nlohmann::json;

/// A smooth triangle with a normal map on one node. Its normals are those of the triangle, its tangents along u, which
/// grows from vertex 0 to 1.
struct TriangleFile {
  std::vector<Vec3> points = {Vec3(0, 0, 0), Vec3(1, 0.25, 0), Vec3(0.125, 2, 0.5)};
  std::vector<float> tangents;
  GlbWriter writer;

  explicit TriangleFile(float side = 1.0F) {
    const Vec3 u = (points[1] - points[0]).normalized();
    const Vec3 normal = (points[1] - points[0]).cross(points[2] - points[0]).normalized();
    std::vector<float> normals;
    for (int v = 0; v < 3; ++v) {
      for (int c = 0; c < 3; ++c) normals.push_back(static_cast<float>(normal[c]));
      for (int c = 0; c < 3; ++c) tangents.push_back(static_cast<float>(u[c]));
      tangents.push_back(side);
    }
    const int position = writer.positions(points);
    const int normalAccessor = writer.accessor(normals, "VEC3");
    const int tangent = writer.accessor(tangents, "VEC4");
    const int uv = writer.accessor(std::vector<float>{0, 0, 1, 0, 0, 1}, "VEC2");
    writer.add(
        "meshes",
        {{"primitives",
          {{{"material", 0},
            {"attributes",
             {{"POSITION", position}, {"NORMAL", normalAccessor}, {"TANGENT", tangent}, {"TEXCOORD_0", uv}}}}}}});
    writer.add("images", {{"bufferView", 0}});
    writer.add("textures", {{"source", 0}});
    writer.add("materials", {{"normalTexture", {{"index", 0}}}});
    writer.add("nodes", {{"mesh", 0}});
  }

  /// A node's matrix, column by column as in glTF.
  void place(const Eigen::Matrix3d& linear) {
    std::vector<double> numbers;
    for (int column = 0; column < 3; ++column) {
      for (int row = 0; row < 3; ++row) numbers.push_back(linear(row, column));
      numbers.push_back(0.0);
    }
    numbers.insert(numbers.end(), {0.5, 1.5, -0.25, 1.0});
    writer.document["nodes"][0]["matrix"] = numbers;
  }
};

/// Normals must be those of the placed triangle, tangents its placed edge, and normal, tangent and bitangent have the
/// handedness of the coordinates: computed from positions alone.
void expectRight(const CharacterFile& file, double side) {
  test::expectSound(file);
  const TriMesh& mesh = file.character.mesh;
  ASSERT_EQ(mesh.triangles.size(), 1u);
  ASSERT_EQ(file.look.tangents.size(), 3u);
  const Triangle t = mesh.triangles[0];
  const Vec3 outward = (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]);
  const Vec3 u = mesh.vertices[1] - mesh.vertices[0];
  const Vec3 v = mesh.vertices[2] - mesh.vertices[0];
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 normal = file.look.normals[i].cast<double>();
    const Vec3 tangent = file.look.tangents[i].head<3>().cast<double>();
    EXPECT_NEAR(normal.dot(outward.normalized()), 1.0, 1e-6);
    EXPECT_NEAR(tangent.dot(u.normalized()), 1.0, 1e-6);
    // The bitangent of the file points along v if side is +1.
    EXPECT_GT(side * v.dot(normal.cross(tangent)) * static_cast<double>(file.look.tangents[i].w()), 0.0);
  }
}

TEST(GltfLook, DirectionsFollowScaledMirroredTurnedAndShearedNodes) {
  const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, -0.5).normalized()).toRotationMatrix();
  Mat3 shear = Mat3::Identity();
  shear(0, 1) = 0.75;
  const auto scale = [](double x, double y, double z) { return Mat3(Vec3(x, y, z).asDiagonal()); };
  const std::vector<Mat3> placements = {Mat3::Identity(),
                                        turn,
                                        scale(0.125, 3, 1),
                                        scale(-1, 1, 1),
                                        turn * scale(2, -0.5, 1),
                                        turn * scale(-2, -0.5, -1) * turn.transpose(),
                                        turn * shear};
  for (std::size_t p = 0; p < placements.size(); ++p) {
    for (const float side : {1.0F, -1.0F}) {
      SCOPED_TRACE(testing::Message() << "placement " << p << ", side " << side);
      TriangleFile file(side);
      file.place(placements[p]);
      const CharacterFile read = test::valueOf(parsed(file.writer));
      expectRight(read, side);
    }
  }
}

TEST(GltfLook, DirectionsTurnWithVrm0) {
  TriangleFile file;
  file.writer.document["extensions"]["VRM"] = {{"specVersion", "0.0"}, {"humanoid", {{"humanBones", Json::array()}}}};
  const CharacterFile read = test::valueOf(parsed(file.writer));
  const CharacterFile plain = test::valueOf(parsed(TriangleFile().writer));
  ASSERT_EQ(read.format, "VRM 0.x");
  for (std::size_t v = 0; v < 3; ++v) {
    const Vec3f& n = plain.look.normals[v];
    EXPECT_NEAR((read.look.normals[v] - Vec3f(-n.x(), n.y(), -n.z())).norm(), 0.0F, 1e-6F);
  }
  expectRight(read, 1.0);
}

TEST(GltfLook, SkinnedNormalsAreThoseOfTheBindPose) {
  // The skin's own space is turned and scaled by its inverse bind matrices; the node's is ignored, as glTF asks.
  GlbWriter writer = dressedCharacter({{"name", "m"}});
  const Affine3 placed =
      Affine3(Eigen::AngleAxisd(0.7, Vec3::UnitY()).toRotationMatrix() * Mat3(Vec3(1, 2, 0.5).asDiagonal()));
  const std::vector<Affine3> inverseBinds = {placed, Eigen::Translation3d(0.0, -1.0, 0.0) * placed};
  writer.document["skins"][0]["inverseBindMatrices"] = writer.matrices(inverseBinds);
  std::vector<float> normals;
  std::vector<Vec3> outwards;
  for (const Vec3& p : test::makeBox(Vec3(-0.2, 0.0, -0.2), Vec3(0.2, 2.0, 0.2)).vertices) {
    outwards.emplace_back(p.x() < 0.0 ? -0.6 : 0.6, p.y() < 1.0 ? -0.64 : 0.64, p.z() < 0.0 ? -0.48 : 0.48);
    for (const double x : outwards.back()) normals.push_back(static_cast<float>(x));
  }
  writer.document["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = writer.accessor(normals, "VEC3");
  writer.document["nodes"][2]["scale"] = {7, 1, 1};
  const CharacterFile file = test::valueOf(parsed(writer));
  test::expectSound(file);
  ASSERT_EQ(file.look.normals.size(), outwards.size());
  for (std::size_t v = 0; v < outwards.size(); ++v) {
    // Bind poses are placed by the inverse of these matrices, and normals by its inverse transpose.
    const Vec3 expected = (placed.linear().inverse().transpose() * outwards[v]).normalized();
    EXPECT_NEAR((file.look.normals[v].cast<double>() - expected).norm(), 0.0, 1e-6);
  }
}

TEST(GltfLook, ColorsOfAllKindsAreTheSame) {
  const auto colorOf = [](const auto& addColors) {
    GlbWriter writer = dressedCharacter({{"name", "m"}});
    writer.document["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = addColors(writer);
    const Result<CharacterFile> file = parsed(writer);
    EXPECT_TRUE(file.ok());
    EXPECT_EQ(file->look.colors.size(), 8u);
    return file->look.colors.empty() ? Eigen::Vector4f(Eigen::Vector4f::Zero()) : file->look.colors[5];
  };
  const auto repeated = [](const auto& one) {
    std::remove_cvref_t<decltype(one)> all;
    for (int v = 0; v < 8; ++v) all.insert(all.end(), one.begin(), one.end());
    return all;
  };
  const Eigen::Vector4f wanted(0.2F, 0.4F, 0.6F, 0.8F);
  Eigen::Vector4f opaque = wanted;
  opaque.w() = 1.0F;
  const std::vector<float> f4 = {0.2F, 0.4F, 0.6F, 0.8F}, f3 = {0.2F, 0.4F, 0.6F};
  const std::vector<std::uint8_t> b4 = {51, 102, 153, 204}, b3 = {51, 102, 153};
  const std::vector<std::uint16_t> s4 = {13107, 26214, 39321, 52428}, s3 = {13107, 26214, 39321};
  EXPECT_TRUE(colorOf([&](GlbWriter& w) { return w.accessor(repeated(f4), "VEC4"); }).isApprox(wanted));
  EXPECT_TRUE(colorOf([&](GlbWriter& w) { return w.accessor(repeated(f3), "VEC3"); }).isApprox(opaque));
  EXPECT_TRUE(colorOf([&](GlbWriter& w) { return w.accessor(repeated(b4), "VEC4", true); }).isApprox(wanted));
  EXPECT_TRUE(colorOf([&](GlbWriter& w) { return w.accessor(repeated(b3), "VEC3", true, 4); }).isApprox(opaque));
  EXPECT_TRUE(colorOf([&](GlbWriter& w) { return w.accessor(repeated(s4), "VEC4", true); }).isApprox(wanted));
  EXPECT_TRUE(colorOf([&](GlbWriter& w) { return w.accessor(repeated(s3), "VEC3", true, 8); }).isApprox(opaque));
}

TEST(GltfLook, NormalisedCoordinatesAreSharesOfTheirWhole) {
  GlbWriter writer = dressedCharacter({{"emissiveTexture", {{"index", 0}}}});
  std::vector<std::uint16_t> uvs;
  for (int v = 0; v < 8; ++v) uvs.insert(uvs.end(), {13107, 65535});
  writer.document["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = writer.accessor(uvs, "VEC2", true);
  const CharacterFile file = test::valueOf(parsed(writer));
  for (const Eigen::Vector2f& uv : file.look.uv[0]) EXPECT_TRUE(uv.isApprox(Eigen::Vector2f(0.2F, 1.0F)));
}

TEST(GltfLook, GroupsCountTheTrianglesThatAreLeft) {
  GlbWriter writer = dressedCharacter({{"name", "a"}});
  writer.document["materials"].push_back({{"name", "b"}});
  // Three primitives of 2, 0 and 1 triangles, each with one or two that use a vertex twice; only the last has normals.
  const std::vector<Triangle> first = {{0, 1, 1}, {0, 1, 2}, {3, 3, 3}, {4, 5, 6}}, none = {{0, 0, 1}},
                              last = {{7, 6, 5}, {2, 2, 1}};
  Json& primitives = writer.document["meshes"][0]["primitives"];
  const Json like = primitives[0];
  primitives = Json::array();
  for (const std::vector<Triangle>* triangles : {&first, &none, &last}) {
    Json primitive = like;
    primitive["indices"] = writer.triangles(*triangles);
    primitive["material"] = triangles == &last ? 1 : 0;
    primitives.push_back(primitive);
  }
  primitives[2]["attributes"]["NORMAL"] = 0;  // the positions, which are not of unit length
  const CharacterFile file = test::valueOf(parsed(writer));
  test::expectSound(file);
  ASSERT_EQ(file.look.groups.size(), 2u);
  EXPECT_EQ(file.look.groups[0].mesh, "Body");
  EXPECT_EQ(file.look.groups[0].material, 0);
  EXPECT_EQ(file.look.groups[0].triangleCount, 2u);
  EXPECT_TRUE(file.look.groups[0].flat);
  EXPECT_EQ(file.look.groups[1].material, 1);
  EXPECT_EQ(file.look.groups[1].firstTriangle, 2u);
  EXPECT_EQ(file.look.groups[1].triangleCount, 1u);
  EXPECT_FALSE(file.look.groups[1].flat);
  EXPECT_EQ(notesWith(file, "4 triangles use a vertex twice"), 1);
  // Vertices of the flat group have no normal.
  for (std::size_t v = 0; v < 6; ++v) EXPECT_TRUE(file.look.normals[v].isZero());
}

TEST(GltfLook, NumbersThatAreNotFiniteAreReplacedAndCounted) {
  TriangleFile file;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  Json& attributes = file.writer.document["meshes"][0]["primitives"][0]["attributes"];
  attributes["NORMAL"] = file.writer.accessor(std::vector<float>{nan, nan, nan, 0, 0, 0, infinity, 0, 0}, "VEC3");
  attributes["TEXCOORD_0"] = file.writer.accessor(std::vector<float>{0, nan, 1, 0, -infinity, 1e38F}, "VEC2");
  attributes["TANGENT"] = file.writer.accessor(std::vector<float>(12, nan), "VEC4");
  const CharacterFile read = test::valueOf(parsed(file.writer));
  test::expectSound(read);
  EXPECT_EQ(notesWith(read, "18 numbers of normals"), 1);
  EXPECT_EQ(read.look.uv[0][0], Eigen::Vector2f(0, 0));
  EXPECT_EQ(read.look.uv[0][2], Eigen::Vector2f(0, 1e38F));
  // Normals without a direction become that of the triangles around them.
  const Vec3f normal =
      (file.points[1] - file.points[0]).cross(file.points[2] - file.points[0]).normalized().cast<float>();
  for (const Vec3f& n : read.look.normals) EXPECT_NEAR((n - normal).norm(), 0.0F, 1e-6F);
  for (const Eigen::Vector4f& t : read.look.tangents) EXPECT_TRUE(t.isZero());
}

TEST(GltfLook, BrokenListsAreLeftOutAndTheShapeIsKept) {
  for (const auto& [attribute, accessor] :
       {std::pair("NORMAL", 4711), {"NORMAL", 2}, {"TANGENT", 5}, {"TEXCOORD_0", 0}, {"COLOR_0", 1}}) {
    SCOPED_TRACE(testing::Message() << attribute << " " << accessor);
    GlbWriter writer = dressedCharacter({{"normalTexture", {{"index", 0}}}});
    writer.document["meshes"][0]["primitives"][0]["attributes"][attribute] = accessor;
    const CharacterFile file = test::valueOf(parsed(writer));
    test::expectSound(file);
    EXPECT_EQ(file.character.mesh.triangles.size(), 12u);
    EXPECT_EQ(notesWith(file, std::string(attribute) + " is not used: "), 1);
  }
}

TEST(GltfLook, TheSameBytesInManyMeshesAreReadOnlySoOften) {
  // 200 meshes of three vertices that share one list of 3,000 normals: 1.8 million numbers.
  GlbWriter writer = dressedCharacter({{"name", "m"}});
  const int positions = writer.accessor(std::vector<float>(9000, 0.5F), "VEC3");
  const int normals = writer.accessor(std::vector<float>(9000, 0.5F), "VEC3");
  const std::vector<Triangle> one = {{0, 1, 2}};
  const int indices = writer.triangles(one);
  const Json primitive = {
      {"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}, {"indices", indices}, {"material", 0}};
  writer.document["meshes"][0]["primitives"] = std::vector<Json>(200, primitive);
  writer.document["nodes"][2].erase("skin");
  const CharacterFile file = test::valueOf(parsed(writer));
  test::expectSound(file);
  EXPECT_EQ(notesWith(file, "lists of normals, tangents, texture coordinates or colours are broken"), 1);
  EXPECT_EQ(notesWith(file, "colours of 600 vertices are too many for a file of"), 1);
  EXPECT_TRUE(file.look.normals.empty());
}

}  // namespace
}  // namespace lorica
