#pragma once

#include "skinning/character.h"
#include "skinning/look/look.h"
#include "skinning/look/picture.h"

#include <memory>
#include <string>
#include <vector>

namespace lorica {

/// What is drawn of a character: its surface as its maker drew it, and how that looks. The body that is decomposed and
/// touched may have another surface, see skinning/body/closed_body.h, but moves with the same skeleton.
struct Avatar {
  Character character;            ///< as read from its file
  Look look;                      ///< of character.mesh
  std::vector<Picture> pictures;  ///< look.pictures decoded; 0 x 0 pixels = not available, its materials stay plain

  /// Memory that a renderer needs for the textures, with their smaller copies [bytes].
  [[nodiscard]] std::size_t textureBytes() const;
};

struct MadeAvatar {
  std::shared_ptr<const Avatar> avatar;
  std::vector<std::string> notes;  ///< a sentence for each picture that could not be decoded
};

/// Decodes a look's pictures.
/// @param character  the look's own
/// @return the avatar; or kCancelled
[[nodiscard]] Result<MadeAvatar> makeAvatar(const Character& character, const Look& look,
                                            const DecodeSettings& settings = {});

}  // namespace lorica
