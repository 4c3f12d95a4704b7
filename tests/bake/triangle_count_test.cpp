#include "bake/bake_job.h"

#include <gtest/gtest.h>

#include <cstring>

namespace lorica::test {
namespace {

TEST(TriangleCount, IsExactButForPlysTwoAFace) {
  std::string binaryStl(84 + 3 * 50, '\0');
  const std::uint32_t count = 3;
  std::memcpy(binaryStl.data() + 80, &count, sizeof(count));
  std::string stl = "solid x\n";
  for (int i = 0; i < 4; ++i) stl += "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nendloop\nendfacet\n";
  const std::string gltf =
      R"({"accessors": [{"count": 30}, {"count": 9}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0},
          "indices": 1}, {"attributes": {"POSITION": 0}}, 7]}]})";
  const std::uint32_t length = static_cast<std::uint32_t>(gltf.size());
  std::string glb = "glTF" + std::string(16, '\0') + gltf + "BIN";
  std::memcpy(glb.data() + 12, &length, sizeof(length));
  struct Row {
    const char* ending;
    std::string content;
    std::size_t triangles;
  };
  for (const auto& [ending, content, triangles] : std::vector<Row>{
           {".off", "OFF\n# by hand\n5 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n3 0 2 1\n4 0 1 3 4\n3 0 3 2\n", 4},
           {".obj", "v 0 0 0\nf 1 2 3\nf 1//1 2//2 3//3 4//4\nvn 0 0 1\nf 1/1 2/2 3/3 4/4 5/5", 6},
           {".stl", binaryStl, 3},
           {".stl", stl + "endsolid x\n", 4},
           {".ply", "ply\nformat ascii 1.0\nelement vertex 8\nelement face 6\nend_header\n", 12},
           {".gltf", gltf, 13},
           {".glb", glb, 13}}) {
    EXPECT_EQ(trianglesIn(content, ending), triangles) << ending << ": " << content;
  }
}

TEST(TriangleCount, AnyPrefixHasSomeNumber) {
  const std::string json = R"({"accessors": [{"count": 30}], "meshes": [{"primitives": [{"indices": 0}]}]})";
  for (const char* ending : {".off", ".obj", ".stl", ".ply", ".glb", ".gltf", ".fbx", ""}) {
    for (std::size_t length = 0; length < json.size(); ++length) {
      EXPECT_LE(trianglesIn("glTF" + json.substr(0, length), ending), 1000u);
    }
  }
}

}  // namespace
}  // namespace lorica::test
