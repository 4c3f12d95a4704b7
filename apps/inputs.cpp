#include "apps/inputs.h"

#include "apps/body_choice.h"
#include "apps/expression_options.h"
#include "apps/file_trust.h"
#include "apps/mesh_subject.h"
#include "apps/options.h"
#include "apps/progress_bar.h"
#include "geometry/errors.h"
#include "geometry/mesh_files.h"
#include "session/prepare/body_cache.h"
#include "skinning/import/bone_map.h"
#include "skinning/look/avatar.h"
#include "skinning/mannequin/mannequin.h"

#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMannequin = "mannequin";

/// cachedBody() with a progress bar; Ctrl-C cancels.
Result<ClosedBody> makeBodyWithProgress(const Character& character, const CharacterOptions& options) {
  ProgressBar bar("Making a closed body for " + character.name, "steps");
  BodySettings settings;
  settings.resolution = options.bodyResolution;
  settings.keepClosed = options.body != BodyChoice::kAlways;
  settings.progress = progressOf(bar);
  return prefixed(character.name, cachedBody(character, settings, userCache()));
}

/// The mannequin's material.
Material clay() {
  Material material;
  material.name = "clay";
  material.baseColor = {0.68f, 0.60f, 0.52f, 1.0f};
  material.metallic = 0.0f;
  material.roughness = 0.6f;
  return material;
}

/// Rejects options that would have no effect on a mesh or a built-in character.
Result<void> refuseFileOptions(const std::string& input, const CharacterOptions& options) {
  for (const auto& [given, option] :
       {std::pair(!options.map.empty(), "--map"), std::pair(!options.expressions.empty(), "--expression"),
        std::pair(!options.hidden.empty(), "--hide")}) {
    if (!given) continue;
    return invalidArgument("{}: {} is for character files (.glb, .gltf, .vrm, .fbx, .dae)", input, option);
  }
  return {};
}

/// Decodes the pictures of a character's materials with a progress bar; Ctrl-C cancels.
Result<MadeAvatar> makeAvatarWithProgress(CharacterFile& file, std::vector<float> expressions,
                                          const CharacterOptions& options) {
  ProgressBar bar("Decoding textures of " + file.character.name, "textures");
  DecodeSettings settings;
  settings.largestSide = options.textureSize;
  settings.progress = progressOf(bar);
  AvatarFace face{file.morphs, file.expressions, file.lookAt, std::move(expressions)};
  if (options.ownClip) {
    // Without such a clip the command fails later.
    const Result<const Clip*> clip = findClip(file.clips, *options.ownClip, file.character.name);
    if (clip) face.clip = *clip - file.clips.data();
  }
  return makeAvatar(file.character, std::move(file.look), settings, std::move(face));
}

Result<Subject> readCharacterSubject(const fs::path& file, const CharacterOptions& options) {
  LORICA_TRY(CharacterFile read, readCharacterFile(file, characterFileSettings(options.hidden)));
  if (read.character.mesh.triangles.empty()) {
    return badMesh("{}: no triangles, only {}; expected a character with a surface", file.string(),
                   read.clips.empty() ? "joints" : "motion");
  }
  if (!options.map.empty()) {
    LORICA_TRY(const BoneMap map, readBoneMap(options.map));
    LORICA_TRY(read.character.skeleton, applyBoneMap(read.character.skeleton, map, options.map));
  }
  LORICA_TRY(std::vector<float> expressions, chosenExpressions(read.expressions, options.expressions, file.string()));
  if (options.suits) {
    LORICA_TRY_DO(options.suits(read));
  }
  if (read.isMesh()) {
    // A mesh: in the units and coordinates of the file, from which the first joint converts.
    TriMesh mesh = read.character.mesh;
    for (Vec3& p : mesh.vertices) p = read.character.jointFromModel.front() * p;
    Result<Subject> subject = meshSubject(read.character.name, std::move(mesh), options);
    if (subject) subject->file = std::move(read);
    return subject;
  }
  LORICA_TRY(ClosedBody body, makeBodyWithProgress(read.character, options));
  const std::vector<float> used = usedWeightSets(read.morphs, read.expressions, expressions);
  (void)coverReached(body, read.character,
                     reachedPositions(read.morphs, used, read.character.mesh.vertices, kReachTolerance));
  Subject subject{read.character.name, body.character.mesh, std::nullopt, "", std::move(read), std::move(body)};
  subject.character = subject.body->character;
  if (options.drawn && subject.file->look.given()) {
    LORICA_TRY(MadeAvatar made, makeAvatarWithProgress(*subject.file, std::move(expressions), options));
    subject.character->avatar = std::move(made.avatar);
    std::vector<std::string>& notes = subject.file->notes;
    notes.insert(notes.end(), made.notes.begin(), made.notes.end());
  }
  return subject;
}

}  // namespace

void addCharacterOptions(CommandLine& app, CharacterOptions& options) {
  app.addOption(
         "--map", options.map,
         "Bone map: the joint for each humanoid bone, if names and shape are not enough; `lorica info --write-map` "
         "creates one")
      ->typeName("FILE.json");
  addLength(app, "--body-resolution", options.bodyResolution,
            "Voxel size for the closed body that is made if the surface is open [default: from its thickness]");
  addExpressionOption(app, options.expressions);
  addHideOption(app, options.hidden);
}

void addHideOption(CommandLine& app, std::vector<std::string>& hidden) {
  app.addOption(
         "--hide", hidden,
         "Leave out a mesh of the character, such as a weapon, from pictures and hulls; may be repeated; `lorica "
         "info` lists the names")
      ->repeatable()
      ->typeName("NAME");
}

void addTextureOption(CommandLine& app, int& textureSize) {
  addCount(app, "--texture-size", textureSize, 16,
           "Reduce textures whose width or height is larger than this [pixels; default: as stored]");
}

Result<Subject> readSubject(const std::string& input, const CharacterOptions& options) {
  if (input == kMannequin) {
    LORICA_TRY_DO(refuseFileOptions(input, options));
    if (options.body == BodyChoice::kAlways || options.bodyResolution > 0.0) {
      return invalidArgument(
          "{}: {} is for character files (.glb, .gltf, .vrm, .fbx, .dae) and meshes (.off, .obj, .ply, .stl)", input,
          options.bodyResolution > 0.0 ? "--body-resolution" : "--body always");
    }
    Character character = makeMannequin();
    TriMesh mesh = character.mesh;
    if (options.drawn) character.avatar = makePlainAvatar(character, clay());
    return Subject{input, std::move(mesh), std::move(character), "", std::nullopt, std::nullopt};
  }
  if (isBareName(input)) {
    return notFound(
        "{}: no such file and no character with that name, expected a mesh (.off, .obj, .ply, .stl), a character "
        "(.glb, .gltf, .vrm, .fbx, .dae) or {}",
        input, kMannequin);
  }
  if (isCharacterFile(input)) return readCharacterSubject(input, options);
  LORICA_TRY_DO(refuseFileOptions(input, options));
  LORICA_TRY(TriMesh mesh, readMesh(input));
  return meshSubject(fs::path(input).filename().string(), std::move(mesh), options);
}

Result<void> followsPerson(const CharacterFile& file) {
  Motion person;
  person.name = "a person";
  person.joints = {SkeletonFrame()};
  return checkPerformed(file.character, person);
}

Result<Subject> readCharacter(const std::string& nameOrFile, const CharacterOptions& options) {
  if (nameOrFile != kMannequin && !isCharacterFile(nameOrFile)) {
    return notFound("{}: no character with that name, expected {} or a character file (.glb, .gltf, .vrm, .fbx, .dae)",
                    nameOrFile, kMannequin);
  }
  CharacterOptions reading = options;
  reading.suits = [&](const CharacterFile& file) -> Result<void> {
    if (!file.isMesh()) return options.suits ? options.suits(file) : Result<void>();
    return invalidArgument("{}: found a mesh without skin and clips, expected a character", nameOrFile);
  };
  return readSubject(nameOrFile, reading);
}

}  // namespace lorica
