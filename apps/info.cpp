#include "apps/file_summary.h"
#include "apps/option_groups.h"
#include "apps/options.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "prepare/file_kinds.h"
#include "prepare/read_motion.h"
#include "prepare/scenes.h"
#include "prepare/subject.h"
#include "skinning/humanoid/humanoid.h"
#include "skinning/import/bone_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <set>

namespace lorica {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string input;
  CharacterOptions character;
  MotionOptions motion;
  std::string writeMap;
  bool devices = false;
  std::string driver;
};

Error nothingNamed(const std::string& name) {
  LORICA_TRY(const fs::path folder, recordingsFolder());
  return notFound(
      "{}: no such file and no shipped recording with that name, expected a mesh (.off, .obj, .ply, .stl), a character "
      "(.glb, .gltf, .vrm, .fbx, .dae), a motion (joints, .bvh, .oni), a decomposition (.lorica), mannequin, or one of "
      "{}",
      name, shippedNames(folder, {".csv", ".oni"}, name));
}

Result<FileSummary> describeScene(const fs::path& file, Host& host) {
  LORICA_TRY(const OpenedScene scene, openStage(file.string(), host));
  FileSummary summary{Report(file.filename().string() + ": a scene"), {}};
  nlohmann::ordered_json& json = summary.json;
  json["kind"] = "scene";
  json["props"] = scene.world.props().size();
  json["targets"] = scene.targets.size();
  json["avatars"] = nlohmann::ordered_json::array();
  summary.report.line("props", fmt::format("{}, {} of them targets", scene.world.props().size(), scene.targets.size()));
  for (const AvatarSetting& avatar : scene.stage) {
    json["avatars"].push_back({{"character", avatar.character}, {"motion", avatar.motion}});
    summary.report.line("avatar", fmt::format("{} performs {}", avatar.character,
                                              avatar.motion.empty() ? "a clip of its own" : avatar.motion));
  }
  return summary;
}

Result<FileSummary> describe(const Options& options, Host& host) {
  if (options.devices) return describeDevices(options.driver);
  if (options.input.empty()) {
    return invalidArgument("expected a file or --devices");
  }
  const fs::path shipped = isBareName(options.input) ? shippedRecording(options.input) : fs::path();
  const fs::path file = shipped.empty() ? fs::path(options.input) : shipped;
  const FileKind kind = kindOf(file);
  if (kind == FileKind::kDecomposition) return describeDecomposition(file);
  if (kind == FileKind::kDepth) return describeDepthRecording(file);
  if (kind == FileKind::kScene) return describeScene(file, host);
  const bool shape = options.input == "mannequin" || kind == FileKind::kMesh || kind == FileKind::kCharacter;
  if (!shape && isBareName(options.input) && shipped.empty()) return nothingNamed(options.input);
  if (!shape) {
    LORICA_TRY(const Motion motion, readMotion(options.input, options.motion, host));
    return describeMotion(motion);
  }
  CharacterOptions reading = options.character;
  reading.body = BodyChoice::kNever;  // a mesh is described as it is
  const Result<Subject> subject = readSubject(options.input, reading, host);
  // A character file without a surface may still hold a motion.
  if (!subject && kind == FileKind::kCharacter && subject.error().code == ErrorCode::kBadMesh) {
    const Result<Motion> motion = readMotion(options.input, options.motion, host);
    if (motion) return describeMotion(*motion);
  }
  if (!subject) return subject.error();
  return subject->character ? describeCharacter(*subject, options.character.textureSize) : describeMesh(*subject);
}

/// @return how many of its bones may be wrong
Result<std::size_t> writeMap(const Options& options, const CommonOptions& common, const Host& host) {
  if (!isCharacterFile(options.input)) {
    return invalidArgument("--write-map is for character files, but {} is not one", options.input);
  }
  LORICA_TRY_DO(checkOutput(common, "--write-map", options.writeMap, ".json"));
  LORICA_TRY(const CharacterFile file, readCharacterFile(options.input, host.characterFiles()));
  const Skeleton& own = file.character.skeleton;
  HumanoidGuess none;
  none.jointOf.fill(kNoJoint);
  HumanoidGuess guess = suggestHumanoid(withBones(own, none));
  Skeleton bones = withBones(own, guess);
  // A VRM file's own bones are not in doubt.
  const auto sameBone = [](const Joint& a, const Joint& b) { return a.bone == b.bone; };
  const bool guessed = std::equal(own.joints().begin(), own.joints().end(), bones.joints().begin(), sameBone);
  if (!guessed && own.jointOf(HumanBone::kHips) != kNoJoint) {
    bones = own;
    guess.doubts.clear();
  }
  LORICA_TRY_DO(writeBoneMap(options.writeMap, bones, file.character.name, guess.doubts));
  std::set<HumanBone> unsure;
  for (const BoneDoubt& doubt : guess.doubts) unsure.insert(doubt.bones.begin(), doubt.bones.end());
  return unsure.size();
}

Result<void> run(const Options& options, const CommonOptions& common, Host& host) {
  LORICA_TRY_DO(checkJsonOutput(common, {options.input, options.character.map, options.writeMap}));
  std::size_t unsure = 0;
  if (!options.writeMap.empty()) {
    LORICA_TRY(unsure, writeMap(options, common, host));
  }
  LORICA_TRY(FileSummary summary, describe(options, host));
  if (!options.writeMap.empty()) {
    const std::string check = unsure == 0 ? "" : fmt::format(", {} unsure", counted(unsure, "bone is", "bones are"));
    summary.report.line("bone map", options.writeMap + check + ": edit it and pass it with --map");
    summary.json["map"] = options.writeMap;
  }
  return publish(common, summary.report, summary.json);
}

}  // namespace

Command addInfo(CommandLine& parent, CommonOptions& common) {
  const auto options = std::make_shared<Options>();
  CommandLine* app = addSubcommand(
      parent, common, "info", "Describe a mesh, character, motion or decomposition.",
      "  lorica info hero.glb           # joints and bones, clips, holes in the surface, the body made from it\n"
      "  lorica info hero.glb --write-map hero.json\n"
      "                                 # write the bone map, to correct it and pass it with --map\n"
      "  lorica info bunny.off          # a mesh: closed or not, convexity\n"
      "  lorica info body.lorica        # parts, error, levels of detail, bones of each part\n"
      "  lorica info dance.bvh          # a motion; recorded joints too\n"
      "  lorica info body.oni           # a depth recording\n"
      "  lorica info --devices          # connected depth cameras and their drivers\n"
      "  lorica info walk               # a shipped recording\n"
      "  lorica info mannequin          # the built-in character");
  Option* file =
      app->addOption("FILE", options->input,
                     "Mesh (.off, .obj, .ply, .stl), character (.glb, .gltf, .vrm, .fbx, .dae), motion (.bvh, recorded "
                     "joints), depth (.oni), decomposition (.lorica), or a shipped name");
  Option* devices =
      app->addFlag("--devices", options->devices, "List depth cameras instead of describing a file")->excludes(file);
  app->addOption("--driver", options->driver, "Additional OpenNI2 driver: lib*.so", "FILE")->needs(devices);
  addCharacterOptions(*app, options->character);
  addTextureOption(*app, options->character.textureSize);
  app->addOption("--write-map", options->writeMap, "Write the character's bone map: its joint for each humanoid bone",
                 "FILE.json");
  addReadingOptions(*app, options->motion);
  return {app, [options](const CommonOptions& given, Host& host) { return run(*options, given, host); }};
}

}  // namespace lorica
