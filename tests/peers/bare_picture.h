#pragma once

#include "skinning/import/character_file.h"
#include "skinning/look/avatar.h"
#include "tests/peers/likeness.h"
#include "tests/viewer/renderer/pictures.h"

#include <nlohmann/json_fwd.hpp>

#include <memory>

namespace lorica::test {

/// Who is drawn.
struct Sitter {
  CharacterFile file;
  std::shared_ptr<const Avatar> avatar;
};

/// Draws one shot of a character by Lorica: nothing but the character, from the camera and in the lights of the shot.
/// @param shot  as in tests/peers/shots, with all options of the file in it: width, eye, rotations, expressions, ...
[[nodiscard]] MaskedPicture drawBare(Studio& studio, const Sitter& sitter, const nlohmann::json& shot);

}  // namespace lorica::test
