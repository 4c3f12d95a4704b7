#include "skinning/look/avatar.h"

#include <fmt/format.h>

#include <utility>

namespace lorica {

std::shared_ptr<const Avatar> makePlainAvatar(const Character& character, const Material& material) {
  auto avatar = std::make_shared<Avatar>();
  avatar->character = character;
  avatar->plain = true;
  const TriMesh& mesh = character.mesh;
  avatar->look.materials = {material};
  avatar->look.groups.push_back({character.name, 0, 0, mesh.triangles.size(), false});
  avatar->look.normals.assign(mesh.vertices.size(), Vec3f::Zero());
  for (const Triangle& t : mesh.triangles) {
    const Vec3f area = areaNormal(mesh.vertices, t).cast<float>();
    for (const VertexIndex v : t) avatar->look.normals[v] += area;
  }
  for (Vec3f& normal : avatar->look.normals) normal.normalize();
  return avatar;
}

std::shared_ptr<const Avatar> tinted(const Avatar& avatar, const Vec3f& color) {
  auto colored = std::make_shared<Avatar>(avatar);
  colored->plain = false;
  for (Material& material : colored->look.materials) {
    material.baseColor.head<3>().array() *= color.array();
    material.toon.shadeColor.array() *= color.array();
  }
  return colored;
}

Result<MadeAvatar> makeAvatar(Character character, Look look, const DecodeSettings& settings, AvatarFace face) {
  auto avatar = std::make_shared<Avatar>();
  avatar->character = std::move(character);
  avatar->face = std::move(face);
  avatar->face.chosen.resize(avatar->face.expressions.list.size(), 0.0F);
  std::vector<EncodedPicture> encoded;
  encoded.reserve(look.pictures.size());
  for (const StoredPicture& picture : look.pictures) encoded.push_back({picture.bytes, picture.name});
  MadeAvatar made;
  for (Result<Picture>& picture : decodePictures(encoded, settings)) {
    if (!picture && picture.error().code == ErrorCode::kCancelled) return picture.error();
    if (!picture) made.notes.push_back(fmt::format("{}: its materials stay plain", picture.error().message));
    avatar->pictures.push_back(picture ? std::move(*picture) : Picture());
  }
  for (StoredPicture& picture : look.pictures) std::vector<std::byte>().swap(picture.bytes);
  avatar->look = std::move(look);
  made.avatar = std::move(avatar);
  return made;
}

}  // namespace lorica
