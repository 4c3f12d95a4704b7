#pragma once

#include "skinning/character.h"
#include "skinning/look/look.h"
#include "skinning/look/picture.h"
#include "skinning/morphs/expressions.h"
#include "skinning/morphs/look_at.h"
#include "skinning/morphs/morphs.h"

#include <memory>
#include <string>
#include <vector>

namespace lorica {

/// What moves an avatar's face, see skinning/morphs/face.h.
struct AvatarFace {
  Morphs morphs;              ///< of the avatar's mesh
  Expressions expressions;    ///< of the morph targets
  LookAt lookAt;              ///< how its eyes move
  std::vector<float> chosen;  ///< weight of each expression to begin with
  int clip = -1;              ///< index into morphs.clips of the clip that the character plays; -1 = none
};

/// What is drawn of a character: its surface as its maker drew it, and how that looks. The body that is decomposed and
/// touched may have another surface, see skinning/body/closed_body.h, but moves with the same skeleton.
struct Avatar {
  Character character;            ///< as read from its file
  Look look;                      ///< of character.mesh
  std::vector<Picture> pictures;  ///< look.pictures decoded; 0 x 0 pixels = not available, its materials stay plain
  AvatarFace face;                ///< `chosen` has an element for each expression
  bool plain = false;             ///< nobody made its look: the parts' colours say more
};

/// An avatar of one material with smooth normals, for a character that has none.
[[nodiscard]] std::shared_ptr<const Avatar> makePlainAvatar(const Character& character, const Material& material);

/// An avatar whose materials have their colours multiplied by another one, linear RGB.
[[nodiscard]] std::shared_ptr<const Avatar> tinted(const Avatar& avatar, const Vec3f& color);

/// What makeAvatar() returns.
struct MadeAvatar {
  std::shared_ptr<const Avatar> avatar;  ///< to be drawn; shared by all that show it
  std::vector<std::string> notes;        ///< a sentence for each picture that could not be decoded
};

/// Decodes a look's pictures. Move the look in if nothing else needs it, so that its pictures are not copied.
/// @param character  the look's own
/// @return the avatar; or kCancelled
[[nodiscard]] Result<MadeAvatar> makeAvatar(Character character, Look look, const DecodeSettings& settings = {},
                                            AvatarFace face = {});

}  // namespace lorica
