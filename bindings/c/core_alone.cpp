// What the C interface of the core alone (LORICA_CORE) does without: files of characters and motions, meshes in several
// frames, contacts and the tracker.
#include "bindings/c/guard.h"
#include "bindings/character_body.h"
#include "bindings/mesh_parts.h"

namespace lorica {
namespace {

Error without(const char* what) {
  return unsupported("{} is not in this build of Lorica, which has its core alone", what);
}

lorica_status refused(const char* what) {
  return guarded([&]() -> Result<void> { return without(what); });
}

}  // namespace

std::optional<IsolatedReader> characterReader() {
  return std::nullopt;
}

Result<CharacterPointer> openCharacter(const std::string& /*nameOrFile*/, const CharacterOptions& /*reading*/,
                                       Host& /*host*/) {
  return without("reading characters");
}

Result<std::shared_ptr<const CharacterBody>> makeCharacterBody(CharacterPointer /*owner*/,
                                                               const CharacterBodySettings& /*settings*/,
                                                               Host& /*host*/) {
  return without("training on recorded motions");
}

Result<Performance> performanceOf(const Character& /*character*/, const std::string& /*nameOrFile*/,
                                  const std::string& /*clip*/, bool /*mirror*/, Host& /*host*/) {
  return without("reading motions");
}

std::string guessAbout(const Subject& /*character*/) {
  return {};
}

Result<MeshParts> partsOfFrames(MeshSequence /*mesh*/, const MeshPartsSettings& /*settings*/,
                                const CharacterOptions& /*reading*/, const EarlierParts* /*earlier*/, Host& /*host*/) {
  return without("a mesh in several frames");
}

}  // namespace lorica

using namespace lorica;

lorica_status lorica_live_find_contacts(lorica_live* /*live*/, size_t* /*count*/) {
  return refused("lorica_live_find_contacts");
}

lorica_status lorica_live_contact(const lorica_live* /*live*/, size_t /*index*/, lorica_contact* /*out*/) {
  return refused("lorica_live_contact");
}

lorica_status lorica_live_find_touches(lorica_live* /*live*/, const lorica_shape* /*shape*/, size_t* /*count*/) {
  return refused("lorica_live_find_touches");
}

lorica_status lorica_live_touch(const lorica_live* /*live*/, size_t /*index*/, lorica_touch* /*out*/) {
  return refused("lorica_live_touch");
}

lorica_status lorica_tracker_make(const lorica_tracker_options* /*options*/, lorica_tracker** /*out*/) {
  return refused("the tracker");
}

void lorica_tracker_free(lorica_tracker* /*tracker*/) {}

lorica_status lorica_tracker_track(lorica_tracker* /*tracker*/, double /*seconds*/, const uint16_t* /*depth_mm*/,
                                   size_t /*pixel_count*/, size_t* /*people*/) {
  return refused("the tracker");
}

lorica_status lorica_tracker_person(const lorica_tracker* /*tracker*/, size_t /*index*/, lorica_person* /*out*/) {
  return refused("the tracker");
}
