#include "apps/playback_input.h"

#include "capture/retarget/proxy_skeleton.h"
#include "capture/retarget/skeletal_retarget.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

namespace lorica {
namespace {

constexpr std::size_t kMostClipsNamed = 6;

/// The character's own clips, for a sentence: "Survey, Walk and Run".
std::string clipsOf(const CharacterFile& file) {
  std::vector<std::string> names;
  names.reserve(file.clips.size());
  for (const Clip& clip : file.clips) {
    if (!clip.name.empty()) names.push_back(clip.name);
  }
  const std::size_t more = names.size() - std::min(names.size(), kMostClipsNamed);
  names.resize(names.size() - more);
  std::string text = fmt::format("{}", fmt::join(names, ", "));
  return more == 0 ? text : fmt::format("{} and {} more", text, more);
}

/// Refuses a human's motion for a character that is none but has clips of its own, and names these.
Result<void> checkPerformer(const Motion& motion, const Subject& subject, const std::string& asGiven) {
  if (!subject.file || subject.file->clips.empty() || canPerform(*subject.character)) return {};
  if (motion.fromCharacterFile && renameMotion(*motion.bones, subject.character->skeleton)) return {};
  const std::string clips = clipsOf(*subject.file);
  return Error{
      ErrorCode::kInvalidArgument,
      fmt::format("{} on {}: found a motion of {}, expected a clip of its own{}, since its {} joints are not "
                  "known for a human's: lorica play {}{}. If it is one, lorica info {} --write-map FILE starts "
                  "a file that says which joint is which",
                  motion.name, subject.name, motion.fromCharacterFile ? "another character" : "a human",
                  clips.empty() ? "" : ", " + clips, subject.character->skeleton.jointCount(), asGiven,
                  clips.empty() ? "" : " --clip " + subject.file->clips.front().name, asGiven)};
}

}  // namespace

void addCastOptions(CommandLine& app, CastOptions& options) {
  app.addOption("MOTION", options.motion,
                "Recorded joints, .bvh, depth (.oni), a character file with clips, or the name of a shipped "
                "recording [default: a clip of --character]")
      ->typeName("");
  app.addOption("--character", options.character,
                "Who performs it: .glb, .gltf, .vrm, .fbx, .dae or mannequin [default: mannequin]")
      ->typeName("FILE");
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
  if (Result<void> fine = checkPerformer(*motion, *subject, options.character); !fine) return fine.error();
  if (subject->file) {
    motion->notes.insert(motion->notes.end(), subject->file->notes.begin(), subject->file->notes.end());
  }
  return Cast{std::move(*subject), std::move(*motion)};
}

}  // namespace lorica
