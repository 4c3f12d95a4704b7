#pragma once

#include "skinning/import/character_file.h"
#include "tests/skinning/import/glb_writer.h"

#include <string>

namespace lorica::test {

/// The small character with two sets of texture coordinates and this material. Texture i has picture i, for i below 16,
/// whose bytes are "picture i".
[[nodiscard]] GlbWriter dressedCharacter(const nlohmann::json& material);

/// The bytes of a texture's picture as text; empty if it has none.
[[nodiscard]] std::string pictureOf(const CharacterFile& file, const TextureUse& use);

/// Whether a look fits its mesh: lists as long as the vertices or empty, finite, groups one after another over all
/// triangles, indices in range, normals and tangents of unit length where given.
void expectSound(const CharacterFile& file);

}  // namespace lorica::test
