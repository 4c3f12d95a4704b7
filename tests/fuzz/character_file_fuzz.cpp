#include "skinning/import/character_file.h"
#include "skinning/linear_blend.h"

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

/// Any bytes as a GLB: as they are where they begin like one, else JSON up to the first zero byte and the binary after
/// it, put into a GLB with the right lengths, since no fuzzer keeps those in step. What is read is posed too.
namespace {

std::string littleEndian(std::size_t value) {
  std::string bytes;
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> (8 * i));
  return bytes;
}

std::string glbOf(std::string_view json, std::string_view binary) {
  std::string file = "glTF" + littleEndian(2) + littleEndian(28 + json.size() + binary.size());
  file += littleEndian(json.size()) + "JSON";
  file += json;
  file += littleEndian(binary.size()) + std::string("BIN\0", 4);
  file += binary;
  return file;
}

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "broken guarantee: %s\n", what);
  std::abort();
}

void requireSoundLook(const lorica::CharacterFile& file) {
  const lorica::Look& look = file.look;
  const auto fits = [&](const auto& list) {
    return list.empty() || list.size() == file.character.mesh.vertices.size();
  };
  require(fits(look.normals) && fits(look.tangents) && fits(look.uv[0]) && fits(look.uv[1]) && fits(look.colors),
          "lists of a look are as long as the vertices");
  std::size_t next = 0;
  for (const lorica::LookGroup& group : look.groups) {
    require(group.firstTriangle == next, "groups follow each other");
    require(group.material >= 0 && static_cast<std::size_t>(group.material) < look.materials.size(),
            "groups have materials that exist");
    next += group.triangleCount;
  }
  require(!look.given() || next == file.character.mesh.triangles.size(), "groups have all triangles");
  for (const lorica::Material& material : look.materials) {
    for (const lorica::TextureUse* use : material.textures()) {
      require(use->picture < static_cast<int>(look.pictures.size()), "textures have pictures that exist");
      require(use->uvSet == 0 || use->uvSet == 1, "textures use one of two sets of coordinates");
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  std::string file(bytes);
  if (!bytes.starts_with("glTF")) {
    const std::size_t zero = bytes.find('\0');
    file = zero == std::string_view::npos ? glbOf(bytes, {}) : glbOf(bytes.substr(0, zero), bytes.substr(zero + 1));
  }
  const auto read = lorica::parseCharacterFile(std::as_bytes(std::span(file)), "fuzz.glb");
  if (!read) {
    require(read.error().message.find('\n') == std::string::npos, "one sentence on one line");
    return 0;
  }
  const lorica::Character& character = read->character;
  const auto jointCount = static_cast<std::size_t>(character.skeleton.jointCount());
  require(jointCount > 0, "a skeleton");
  if (!character.mesh.vertices.empty()) {
    require(lorica::checkCharacter(character).ok(), "what is read passes checkCharacter()");
  }
  requireSoundLook(*read);
  std::vector<lorica::Affine3> transforms(jointCount);
  std::vector<lorica::Vec3> posed(character.mesh.vertices.size());
  for (const lorica::Clip& clip : read->clips) {
    lorica::Pose pose = lorica::restPose(character.skeleton);
    lorica::sampleClip(clip, 0.4 * clip.seconds, pose);
    lorica::computeWorldFromJoint(character.skeleton, pose, transforms);
    if (posed.empty()) continue;
    lorica::computeWorldFromModel(character, transforms, transforms);
    lorica::skinLinearBlend(character, transforms, posed);
  }
  return 0;
}
