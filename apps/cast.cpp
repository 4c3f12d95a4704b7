#include "apps/cast.h"

#include <utility>

namespace lorica {

void addCastOptions(CLI::App& app, CastOptions& options) {
  app.add_option("MOTION", options.motion,
                 "Recorded joints, .bvh, depth (.oni), a character file with clips, or the name of a shipped "
                 "recording [default: a clip of --character]")
      ->type_name("");
  app.add_option("--character", options.character,
                 "Who performs it: .glb, .gltf, .vrm, .fbx, .dae or mannequin [default: mannequin]")
      ->type_name("FILE");
  addReadingOptions(app, options.performing);
  addPlayingOptions(app, options.performing);
  addCharacterOptions(app, options.reading);
}

Result<Cast> readCast(const CastOptions& options) {
  const std::string& own = options.motion.empty() ? options.character : options.motion;
  if (own.empty()) {
    return Error{ErrorCode::kInvalidArgument,
                 "no motion given, expected one, such as `lorica play walk`, or a character with clips: --character "
                 "hero.glb --clip Run"};
  }
  if (isCharacterFile(own) &&
      (options.character.empty() || options.motion.empty() || options.motion == options.character)) {
    Result<Subject> subject = readSubject(own, options.reading);
    if (subject && subject->character) {
      const Result<const Clip*> clip = findClip(subject->file->clips, options.performing.clip, own);
      if (!clip) return clip.error();
      Motion motion;
      motion.name = subject->name + ((*clip)->name.empty() ? "" : ": " + (*clip)->name);
      motion.bones = framesOf(subject->character->skeleton, **clip);
      motion.fromCharacterFile = true;
      motion.format = subject->file->format;
      motion.notes = subject->file->notes;
      return Cast{std::move(*subject), std::move(motion)};
    }
    // A file of motion alone is performed by another character.
    if (!subject && (options.motion.empty() || subject.error().code != ErrorCode::kBadMesh)) return subject.error();
  }
  Result<Motion> motion = readMotion(own, options.performing);
  if (!motion) return motion.error();
  Result<Subject> subject = readCharacter(options.character.empty() ? "mannequin" : options.character, options.reading);
  if (!subject) return subject.error();
  if (subject->file) {
    motion->notes.insert(motion->notes.end(), subject->file->notes.begin(), subject->file->notes.end());
  }
  return Cast{std::move(*subject), std::move(*motion)};
}

}  // namespace lorica
