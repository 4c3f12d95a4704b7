#include "tests/skinning/import/material_samples.h"

#include "geometry/counts.h"
#include "tests/skinning/import/small_character.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace lorica::test {

GlbWriter dressedCharacter(const nlohmann::json& material) {
  GlbWriter writer = smallCharacter();
  nlohmann::json& primitive = writer.document["meshes"][0]["primitives"][0];
  for (int set = 0; set < 2; ++set) {
    std::vector<float> uvs;
    for (int v = 0; v < 8; ++v) {
      uvs.push_back(0.125F * static_cast<float>(v));
      uvs.push_back(0.5F * static_cast<float>(set) + 0.0625F * static_cast<float>(v));
    }
    primitive["attributes"]["TEXCOORD_" + std::to_string(set)] = writer.accessor(uvs, "VEC2");
  }
  primitive["material"] = 0;
  for (int i = 0; i < 16; ++i) {
    const std::string text = "picture " + std::to_string(i);
    writer.add("images", {{"bufferView", writer.view(std::vector<char>(text.begin(), text.end()))}});
    writer.add("textures", {{"source", i}});
  }
  writer.document["materials"] = nlohmann::json::array({material});
  return writer;
}

std::string pictureOf(const CharacterFile& file, const TextureUse& use) {
  if (!use.given()) return "";
  const std::vector<std::byte>& bytes = file.look.pictures.at(static_cast<std::size_t>(use.picture)).bytes;
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void expectSound(const CharacterFile& file) {
  const Look& look = file.look;
  const TriMesh& mesh = file.character.mesh;
  const std::size_t count = mesh.vertices.size();
  const auto fits = [&](const auto& list, const char* name) {
    EXPECT_TRUE(list.empty() || list.size() == count) << name << ": " << list.size() << " of " << count;
    EXPECT_TRUE(std::all_of(list.begin(), list.end(), [](const auto& v) { return v.allFinite(); })) << name;
  };
  fits(look.normals, "normals");
  fits(look.tangents, "tangents");
  fits(look.uv[0], "first coordinates");
  fits(look.uv[1], "second coordinates");
  fits(look.colors, "colours");
  std::size_t next = 0;
  for (const LookGroup& group : look.groups) {
    EXPECT_EQ(group.firstTriangle, next) << group.mesh;
    next += group.triangleCount;
    ASSERT_GE(group.material, 0);
    ASSERT_LT(static_cast<std::size_t>(group.material), look.materials.size());
    for (std::size_t t = group.firstTriangle; t < std::min(next, mesh.triangles.size()) && !group.flat; ++t) {
      for (const VertexIndex v : mesh.triangles[t]) {
        const Vec3f& normal = look.normals.at(static_cast<std::size_t>(v));
        EXPECT_TRUE(normal.isZero() || std::abs(normal.norm() - 1.0F) < 1e-5F) << group.mesh << " " << v;
      }
    }
  }
  EXPECT_EQ(next, look.given() ? mesh.triangles.size() : 0);
  for (const Material& material : look.materials) {
    EXPECT_TRUE(material.baseColor.allFinite()) << material.name;
    for (const TextureUse* use : material.textures()) {
      EXPECT_LT(use->picture, countOf(look.pictures)) << material.name;
      EXPECT_TRUE(use->uvSet == 0 || use->uvSet == 1) << material.name;
    }
  }
}

}  // namespace lorica::test
