#include "tests/peers/bare_picture.h"

#include "skinning/linear_blend.h"
#include "skinning/look/expressed_materials.h"
#include "skinning/morphs/face.h"
#include "tests/peers/avatar_poses.h"
#include "tests/peers/peer.h"

#include <algorithm>
#include <numbers>

namespace lorica::test {
namespace {

/// The avatar's vertices in the bind pose, and its materials, with a shot's expressions.
struct FaceShape {
  std::vector<Vec3> positions;
  std::vector<Vec3f> normals;
  std::vector<Material> materials;
};

FaceShape faceShape(const Sitter& sitter, const nlohmann::json& expressions) {
  const CharacterFile& file = sitter.file;
  Face face(file.morphs, file.expressions, file.lookAt);
  face.setBlinking(false);
  for (const auto& [name, weight] : expressions.items()) {
    face.set(findExpression(file.expressions, name).value(), weight.get<float>());
  }
  face.update({});
  const std::vector<Vec3>& bind = file.character.mesh.vertices;
  FaceShape shape = {std::vector<Vec3>(bind.size()), std::vector<Vec3f>(file.look.normals.size()), file.look.materials};
  expressMaterials(file.expressions, face.expressionWeights(), file.look.materials, shape.materials);
  applyMorphs(file.morphs, face.targetWeights(), bind, file.look.normals, shape.positions, shape.normals);
  return shape;
}

}  // namespace

MaskedPicture drawBare(Studio& studio, const Sitter& sitter, const nlohmann::json& shot) {
  const Character& character = sitter.file.character;
  const Pose pose = poseOf(character, shot);
  std::vector<Affine3> worldFromModel(pose.size());
  computeWorldFromJoint(character.skeleton, pose, worldFromModel);
  computeWorldFromModel(character, worldFromModel, worldFromModel);
  Scene scene;
  scene.avatar = sitter.avatar;
  scene.worldFromModel = worldFromModel;
  const std::vector<Vec3> posed = posedVertices(character, pose);
  scene.vertices = posed;  // shadows are drawn within their bounds
  FaceShape face;
  if (shot.contains("expressions")) {
    face = faceShape(sitter, shot["expressions"]);
    scene.avatarPositions = face.positions;
    scene.avatarNormals = face.normals;
    scene.avatarMaterials = face.materials;
  }

  Camera camera;
  camera.eye = vectorOf(shot.at("eye"));
  camera.target = vectorOf(shot.at("target"));
  camera.verticalFov = shot.at("fov").get<double>() * std::numbers::pi / 180.0;
  const int width = shot.at("width"), height = shot.at("height");
  SceneOptions options;
  options.colorSkinByPart = options.hulls = options.ground = false;
  const nlohmann::json& lights = shot.at("lights");
  options.light.key = vectorOf(lights.at("key")).cast<float>();
  options.light.sky = vectorOf(lights.at("sky")).cast<float>();
  options.light.ground = vectorOf(lights.at("ground")).cast<float>();

  // What is behind the character shows by as much as its colour matters.
  MaskedPicture made;
  options.background = Vec3f(0.0F, 0.0F, 0.0F);
  made.mask = studio.draw(scene, options, camera, width, height);
  options.background = Vec3f(1.0F, 1.0F, 1.0F);
  made.picture = studio.draw(scene, options, camera, width, height);
  for (std::size_t i = 0; i < made.mask.rgba.size(); i += 4) {
    const int uncovered = made.picture.rgba[i] - made.mask.rgba[i];
    std::fill_n(&made.mask.rgba[i], 3, static_cast<std::uint8_t>(255 - std::clamp(uncovered, 0, 255)));
  }
  return made;
}

}  // namespace lorica::test
