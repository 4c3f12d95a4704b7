#include "session/prepare/subject.h"

#include "collision/hulls/character_walls.h"
#include "collision/hulls/mesh_subject.h"
#include "geometry/arrays/mesh_sequence.h"
#include "geometry/errors.h"
#include "geometry/mesh_files.h"
#include "session/prepare/body.h"
#include "session/prepare/file_kinds.h"
#include "session/prepare/read_motion.h"
#include "session/prepare/smpl.h"
#include "skinning/import/bone_map.h"
#include "skinning/look/avatar.h"
#include "skinning/mannequin/mannequin.h"
#include "skinning/morphs/shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMannequin = "mannequin";

/// cachedBody(), with thin walls if the options ask for them, as a task of the host.
Result<ClosedBody> makeBodyWithProgress(const CharacterFile& file, const CharacterOptions& options, Host& host) {
  const std::string& name = file.character.name;
  Task task(host, "Making a closed body for " + name, "steps");
  BodySettings settings;
  settings.resolution = options.bodyResolution;
  settings.keepClosed = options.body != BodyChoice::kAlways;
  settings.progress = task.progress();
  return bodyWithWalls(file, options, [&](const Character& rest) {
    return prefixed(name, cachedBody(rest, settings, userCache(host)));
  });
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

/// Decodes the pictures of a character's materials as a task of the host.
Result<MadeAvatar> makeAvatarWithProgress(CharacterFile& file, std::vector<float> expressions,
                                          const CharacterOptions& options, Host& host) {
  Task task(host, "Decoding textures of " + file.character.name, "textures");
  DecodeSettings settings;
  settings.largestSide = options.textureSize;
  settings.progress = task.progress();
  AvatarFace face{file.morphs, file.expressions, file.lookAt, std::move(expressions)};
  if (options.ownClip) {
    // Without such a clip the command fails later.
    const Result<const Clip*> clip = findClip(file.clips, *options.ownClip, file.character.name);
    if (clip) face.clip = *clip - file.clips.data();
  }
  return makeAvatar(file.character, std::move(file.look), settings, std::move(face));
}

Result<Subject> characterSubject(const std::string& file, CharacterFile read, const CharacterOptions& options,
                                 Host& host) {
  if (read.character.mesh.triangles.empty()) {
    return badMesh("{}: no triangles, only {}; expected a character with a surface", file,
                   read.clips.empty() ? "joints" : "motion");
  }
  if (!options.map.empty()) {
    LORICA_TRY(const BoneMap map, readBoneMap(options.map));
    LORICA_TRY(read.character.skeleton, applyBoneMap(read.character.skeleton, map, options.map));
  }
  LORICA_TRY(std::vector<float> expressions, chosenExpressions(read.expressions, options.expressions, file));
  if (options.suits) {
    LORICA_TRY_DO(options.suits(read));
  }
  if (read.isMesh()) {
    // A mesh: in the units and coordinates of the file, from which the first joint converts.
    TriMesh mesh = read.character.mesh;
    for (Vec3& p : mesh.vertices) p = read.character.jointFromModel.front() * p;
    Result<Subject> subject = meshSubject(read.character.name, std::move(mesh), options, host);
    if (subject) subject->file = std::move(read);
    return subject;
  }
  LORICA_TRY(ClosedBody body, makeBodyWithProgress(read, options, host));
  // The hulls follow what the joints' scales deform; what is set beside that is held at once.
  carryShapes(read.character, body.bodyVertices, body.character);
  const Morphs still;
  const std::vector<float> used =
      usedWeightSets(read.character.shapes.empty() ? read.morphs : still, read.expressions, expressions);
  (void)coverReached(body, read.character,
                     reachedPositions(read.morphs, used, read.character.mesh.vertices, kReachTolerance));
  Subject subject{read.character.name, body.character.mesh, std::nullopt, "", std::move(read), std::move(body)};
  subject.character = subject.body->character;
  if (options.drawn && subject.file->look.given()) {
    LORICA_TRY(MadeAvatar made, makeAvatarWithProgress(*subject.file, std::move(expressions), options, host));
    subject.character->avatar = std::move(made.avatar);
    std::vector<std::string>& notes = subject.file->notes;
    notes.insert(notes.end(), made.notes.begin(), made.notes.end());
  }
  return subject;
}

/// A mesh in several poses as a character that plays them: in the unit and axes of its files. A single pose is a mesh,
/// see CharacterFile::isMesh().
Result<CharacterFile> playedFile(MeshSequence sequence) {
  const std::span<const Vec3> first = sequence.frame(0);
  TriMesh mesh{{first.begin(), first.end()}, std::move(sequence.triangles)};
  std::vector<double> times;
  for (int f = 0; f < sequence.frameCount(); ++f) times.push_back(f / sequence.framesPerSecond);
  LORICA_TRY(PlayedMesh played, playedMesh(sequence.name, std::move(mesh), sequence.positions, times));
  CharacterFile file;
  file.character = std::move(played.character);
  file.nodeOfJoint.assign(file.character.skeleton.jointCount(), -1);
  if (sequence.frameCount() > 1) {
    played.clip.framesPerSecond = sequence.framesPerSecond;
    file.clips.push_back(std::move(played.clip));
  }
  file.format = kSequence;
  file.meshes = file.primitives = file.maxInfluences = 1;
  file.notes = std::move(sequence.notes);
  return file;
}

}  // namespace

Result<Subject> readSubject(const std::string& input, const CharacterOptions& options, Host& host) {
  if (input == kMannequin) {
    LORICA_TRY_DO(refuseFileOptions(input, options));
    if (options.body == BodyChoice::kAlways || options.bodyResolution > 0.0) {
      return invalidArgument(
          "{}: {} is for character files (.glb, .gltf, .vrm, .fbx, .dae) and meshes (.off, .obj, .ply, .stl)", input,
          options.bodyResolution > 0.0 ? "--body-resolution" : "--body always");
    }
    if (options.walls == WallChoice::kShell || options.thickness > 0.0) {
      return invalidArgument("{}: is one closed piece, which stays solid: expected no {}", input,
                             options.thickness > 0.0 ? "--thickness" : "--walls shell");
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
  LORICA_TRY_DO(refuseOtherKinds(input));
  if (kindOf(input) == FileKind::kCharacter) {
    LORICA_TRY(CharacterFile read, readPlayed(input, host, options.hidden));
    return characterSubject(input, std::move(read), options, host);
  }
  LORICA_TRY_DO(refuseFileOptions(input, options));
  LORICA_TRY(TriMesh mesh, readMesh(input));
  return meshSubject(fs::path(input).filename().string(), std::move(mesh), options, host);
}

Result<Subject> sequenceSubject(MeshSequence sequence, const CharacterOptions& options, Host& host) {
  const std::string name = sequence.name;
  LORICA_TRY(CharacterFile read, playedFile(std::move(sequence)));
  return characterSubject(name, std::move(read), options, host);
}

Result<void> followsPerson(const CharacterFile& file) {
  Motion person;
  person.name = "a person";
  person.joints = {SkeletonFrame()};
  return checkPerformed(file.character, person);
}

Result<Subject> readCharacter(const std::string& nameOrFile, const CharacterOptions& options, Host& host) {
  if (nameOrFile != kMannequin && kindOf(nameOrFile) != FileKind::kCharacter) {
    LORICA_TRY_DO(refuseOtherKinds(nameOrFile));
    if (std::error_code ignored; fs::exists(nameOrFile, ignored)) {
      return invalidArgument("{}: is {}, expected {} or a character file (.glb, .gltf, .vrm, .fbx, .dae)", nameOrFile,
                             readMesh(nameOrFile).ok() ? "a mesh without bones" : "no character file", kMannequin);
    }
    return notFound("{}: no character with that name, expected {} or a character file (.glb, .gltf, .vrm, .fbx, .dae)",
                    nameOrFile, kMannequin);
  }
  CharacterOptions reading = options;
  reading.suits = [&](const CharacterFile& file) -> Result<void> {
    if (!file.isMesh()) return options.suits ? options.suits(file) : Result<void>();
    return invalidArgument("{}: found a mesh without skin and clips, expected a character", nameOrFile);
  };
  return readSubject(nameOrFile, reading, host);
}

Result<CharacterFile> readPlayed(const std::string& input, Host& host, std::vector<std::string> hidden) {
  if (!namesSequence(input)) return readCharacterFile(input, host.characterFiles(std::move(hidden)));
  if (archiveKindOf(input) == ArchiveKind::kSmplModel) return readSmplModel(input);
  if (!hidden.empty()) return invalidArgument("{}: is one mesh in several poses: expected no --hide", input);
  Task task(host, "Reading " + input, "files");
  LORICA_TRY(MeshSequence sequence, readMeshSequence(input, task.progress()));
  return prefixed(input, playedFile(std::move(sequence)));
}

Result<std::vector<float>> chosenExpressions(const Expressions& expressions, std::span<const std::string> given,
                                             const std::string& input) {
  std::vector<float> weights(expressions.list.size(), 0.0F);
  for (const std::string& one : given) {
    const auto bad = [&](const std::string& what) { return invalidArgument("--expression {}: {}", one, what); };
    const std::size_t equals = one.rfind('=');
    if (equals == std::string::npos) return bad("expected a name and a weight, such as Joy=1");
    float weight = 0.0F;
    const char* end = one.data() + one.size();
    const auto [stopped, problem] = std::from_chars(one.data() + equals + 1, end, weight);
    if (problem != std::errc() || stopped != end || !(weight >= 0.0F && weight <= 1.0F)) {
      return bad("expected a weight from 0 to 1");
    }
    const std::string name = one.substr(0, equals);
    const std::optional<std::size_t> index = findExpression(expressions, name);
    if (!index && expressions.list.empty()) return bad(fmt::format("{} has no expressions", input));
    if (!index)
      return bad(fmt::format("{} has no expression {}, expected one of {}", input, name, namesOf(expressions)));
    weights[*index] = weight;
  }
  return weights;
}

}  // namespace lorica
