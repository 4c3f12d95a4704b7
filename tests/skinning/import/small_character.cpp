#include "tests/skinning/import/small_character.h"

#include "tests/support/meshes.h"

#include <algorithm>
#include <cmath>

namespace lorica::test {

GlbWriter smallCharacter() {
  GlbWriter writer;
  const TriMesh box = makeBox(Vec3(-0.2, 0.0, -0.2), Vec3(0.2, 2.0, 0.2));
  const int positions = writer.positions(box.vertices);
  const int indices = writer.triangles(box.triangles);
  std::vector<std::uint8_t> joints;
  std::vector<float> weights;
  for (const Vec3& p : box.vertices) {
    joints.insert(joints.end(), {static_cast<std::uint8_t>(p.y() > 1.0 ? 1 : 0), 0, 0, 0});
    weights.insert(weights.end(), {1.0F, 0.0F, 0.0F, 0.0F});
  }
  const int jointAccessor = writer.accessor(joints, "VEC4");
  const int weightAccessor = writer.accessor(weights, "VEC4");
  const std::vector<Affine3> inverseBinds = {Affine3::Identity(), Affine3(Eigen::Translation3d(0.0, -1.0, 0.0))};
  const int inverseBindAccessor = writer.matrices(inverseBinds);
  const auto half = static_cast<float>(std::sqrt(0.5));
  const int times = writer.accessor(std::vector<float>{0.0F, 2.0F}, "SCALAR");
  const int rotations = writer.accessor(std::vector<float>{0, 0, 0, 1, 0, 0, half, half}, "VEC4");

  writer.add("nodes", {{"name", "lower"}, {"children", {1}}});
  writer.add("nodes", {{"name", "upper"}, {"translation", {0.0, 1.0, 0.0}}});
  writer.add("nodes", {{"name", "box"}, {"mesh", 0}, {"skin", 0}});
  writer.add("skins", {{"joints", {0, 1}}, {"inverseBindMatrices", inverseBindAccessor}});
  writer.add(
      "meshes",
      {{"name", "Body"},
       {"primitives",
        {{{"indices", indices},
          {"attributes", {{"POSITION", positions}, {"JOINTS_0", jointAccessor}, {"WEIGHTS_0", weightAccessor}}}}}}});
  writer.add("animations", {{"name", "bend"},
                            {"samplers", {{{"input", times}, {"output", rotations}}}},
                            {"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "rotation"}}}}}}});
  writer.add("scenes", {{"nodes", {0, 2}}});
  return writer;
}

Result<CharacterFile> parsed(const GlbWriter& writer) {
  const std::string glb = writer.glb();
  return parseCharacterFile(std::as_bytes(std::span(glb)), "hero.glb");
}

int notesWith(const CharacterFile& file, const std::string& part) {
  return static_cast<int>(std::count_if(file.notes.begin(), file.notes.end(),
                                        [&](const std::string& note) { return note.find(part) != std::string::npos; }));
}

bool hasNote(const CharacterFile& file, const std::string& part) {
  return notesWith(file, part) > 0;
}

}  // namespace lorica::test
