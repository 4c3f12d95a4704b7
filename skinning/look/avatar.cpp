#include "skinning/look/avatar.h"

#include <fmt/format.h>

namespace lorica {

std::size_t Avatar::textureBytes() const {
  std::size_t bytes = 0;
  for (const Picture& picture : pictures) bytes += picture.rgba.size() / 3 * 4;  // the smaller copies add a third
  return bytes;
}

Result<MadeAvatar> makeAvatar(const Character& character, const Look& look, const DecodeSettings& settings) {
  auto avatar = std::make_shared<Avatar>();
  avatar->character = character;
  avatar->look = look;
  std::vector<EncodedPicture> encoded;
  encoded.reserve(look.pictures.size());
  for (const StoredPicture& picture : look.pictures) encoded.push_back({picture.bytes, picture.name});
  MadeAvatar made;
  for (Result<Picture>& picture : decodePictures(encoded, settings)) {
    if (!picture && picture.error().code == ErrorCode::kCancelled) return picture.error();
    if (!picture) made.notes.push_back(fmt::format("{}: its materials stay plain", picture.error().message));
    avatar->pictures.push_back(picture ? std::move(*picture) : Picture());
  }
  for (StoredPicture& picture : avatar->look.pictures) std::vector<std::byte>().swap(picture.bytes);
  made.avatar = std::move(avatar);
  return made;
}

}  // namespace lorica
