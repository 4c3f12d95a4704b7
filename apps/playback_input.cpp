#include "apps/playback_input.h"

#include "apps/spring_options.h"
#include "capture/retarget/proxy_skeleton.h"
#include "capture/retarget/skeletal_retarget.h"
#include "geometry/errors.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

namespace lorica {
namespace {

constexpr std::size_t kMaxClipsNamed = 6;

/// The names of the character's own clips: "Survey, Walk, Run".
std::string clipsOf(const CharacterFile& file) {
  std::vector<std::string> names;
  names.reserve(file.clips.size());
  for (const Clip& clip : file.clips) {
    if (!clip.name.empty()) names.push_back(clip.name);
  }
  const std::size_t more = names.size() - std::min(names.size(), kMaxClipsNamed);
  names.resize(names.size() - more);
  std::string text = fmt::format("{}", fmt::join(names, ", "));
  return more == 0 ? text : fmt::format("{} and {} more", text, more);
}

/// Rejects a motion that the character cannot perform. If it is not a humanoid but has its own clips, the error lists
/// them.
Result<void> checkPerformer(const Motion& motion, const CharacterFile& file, const std::string& asGiven,
                            const JointSettings& settings) {
  const Result<void> able = checkPerformed(file.character, motion, settings);
  if (able || file.clips.empty() || canPerform(file.character)) return able;
  const std::string clips = clipsOf(file);
  return invalidArgument(
      "{} on {}: found a motion of {}, expected one of the character's own clips{}, because its {} joints were not "
      "recognised as a humanoid: lorica play {}{}. If it is a humanoid, write a bone map with `lorica info {} "
      "--write-map FILE`, edit it and pass it with --map",
      motion.name, file.character.name, motion.fromCharacterFile ? "another character" : "a human",
      clips.empty() ? "" : ", " + clips, file.character.skeleton.jointCount(), asGiven,
      clips.empty() ? "" : " --clip " + file.clips.front().name, asGiven);
}

/// Notes if the hulls grew for expressions or clips.
void tellReached(const Subject& subject, Motion& motion) {
  if (subject.body && subject.body->reachedVertices > 0) motion.notes.push_back(subject.body->notes.back());
}

}  // namespace

void addPlaybackInputOptions(CommandLine& app, PlaybackInputOptions& options) {
  app.addOption("MOTION", options.motion,
                "Recorded joints, .bvh, depth (.oni), a character file with clips, or the name of a shipped "
                "recording [default: a clip of --character]")
      ->typeName("");
  app.addOption("--character", options.character,
                "Character: .glb, .gltf, .vrm, .fbx, .dae or mannequin [default: mannequin]")
      ->typeName("FILE");
  addReadingOptions(app, options.performing);
  addPlayingOptions(app, options.performing);
  addCharacterOptions(app, options.reading);
  addSpringOption(app, options.springs);
}

Result<PlaybackInput> readPlaybackInput(const PlaybackInputOptions& options) {
  const std::string& own = options.motion.empty() ? options.character : options.motion;
  if (own.empty()) {
    return invalidArgument(
        "expected a motion, such as `lorica play walk`, or a character with clips: --character hero.glb --clip Run");
  }
  if (isCharacterFile(own) &&
      (options.character.empty() || options.motion.empty() || options.motion == options.character)) {
    CharacterOptions reading = options.reading;
    reading.ownClip = options.performing.clip;
    reading.suits = [&](const CharacterFile& file) -> Result<void> {
      LORICA_TRY_DO(findClip(file.clips, options.performing.clip, own));
      return {};
    };
    Result<Subject> subject = readSubject(own, reading);
    if (subject && subject->character) {
      LORICA_TRY(const Clip* clip, findClip(subject->file->clips, options.performing.clip, own));
      Motion motion;
      motion.name = subject->name + (clip->name.empty() ? "" : ": " + clip->name);
      motion.bones = framesOf(subject->character->skeleton, *clip);
      motion.fromCharacterFile = true;
      motion.format = subject->file->format;
      motion.notes = subject->file->notes;
      tellReached(*subject, motion);
      return PlaybackInput{std::move(*subject), std::move(motion), options.performing.clip};
    }
    // A file without a surface holds a motion for another character.
    if (!subject && (options.motion.empty() || subject.error().code != ErrorCode::kBadMesh)) return subject.error();
  }
  LORICA_TRY(Motion motion, readMotion(own, options.performing));
  return readPlaybackInput(options, std::move(motion));
}

Result<PlaybackInput> readPlaybackInput(const PlaybackInputOptions& options, Motion motion) {
  CharacterOptions reading = options.reading;
  reading.suits = [&](const CharacterFile& file) {
    return checkPerformer(motion, file, options.character, options.performing.joints());
  };
  LORICA_TRY(Subject subject, readCharacter(options.character.empty() ? "mannequin" : options.character, reading));
  if (subject.file) {
    // Notes about the character are told from those about the motion.
    for (const std::string& note : subject.file->notes) motion.notes.push_back(subject.name + ": " + note);
    const std::vector<std::string> strays = leftBehind(*subject.character);
    motion.notes.insert(motion.notes.end(), strays.begin(), strays.end());
    tellReached(subject, motion);
  }
  return PlaybackInput{std::move(subject), std::move(motion)};
}

}  // namespace lorica
