#include "apps/file_summary.h"
#include "apps/option_groups.h"
#include "apps/options.h"
#include "capture/retarget/skeletal_retarget.h"
#include "capture/sensor/oni_file.h"
#include "capture/sensor/openni.h"
#include "capture/sensor/openni_usb.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "session/prepare/depth_motion.h"
#include "session/prepare/file_kinds.h"
#include "session/prepare/read_motion.h"
#include "session/prepare/scenes.h"
#include "session/prepare/subject.h"
#include "skinning/humanoid/humanoid.h"
#include "skinning/import/bone_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <set>

namespace lorica {
namespace {

namespace fs = std::filesystem;

struct InfoOptions {
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
      "(.glb, .gltf, .vrm, .fbx, .dae), a motion (joints, .bvh, depth), a decomposition (.lorica), mannequin, or one "
      "of {}",
      name, shippedNames(folder, {".csv", ".oni"}, name));
}

Result<Report> describeScene(const fs::path& file, Host& host) {
  LORICA_TRY(const OpenedScene scene, openStage(file.string(), host));
  const std::size_t props = scene.world.props().size();
  Report report(file.filename().string() + ": a scene");
  report.add("kind", "scene");
  report.add("props", "props", props, fmt::format("{}, {} of them targets", props, scene.targets.size()));
  report.add("targets", scene.targets.size());
  Json avatars = Json::array();
  for (const AvatarSetting& avatar : scene.stage) {
    avatars.push_back({{"character", avatar.character}, {"motion", avatar.motion}});
    report.line("avatar", fmt::format("{} performs {}", avatar.character,
                                      avatar.motion.empty() ? "a clip of its own" : avatar.motion));
  }
  report.add("avatars", std::move(avatars));
  return report;
}

void addJoints(const Motion& motion, Report& report) {
  std::size_t seen = 0, guessed = 0, unknown = 0;
  for (const SkeletonFrame& frame : motion.joints) {
    for (const TrackedJoint& joint : frame.joints) {
      ++(joint.confidence >= 1.0 ? seen : joint.confidence > 0.0 ? guessed : unknown);
    }
  }
  const double all = motion.joints.size() * kBodyJointCount;
  report.add("user", "user", motion.joints.front().user, std::to_string(motion.joints.front().user));
  report.add("jointsSeen", "joints", seen / all,
             fmt::format("{}: {} seen, {} guessed, {} unknown", kBodyJointCount, percent(seen / all),
                         percent(guessed / all), percent(unknown / all)));
  report.add("jointsGuessed", guessed / all);
  report.add("jointsUnknown", unknown / all);
}

void addBones(const Skeleton& skeleton, Report& report) {
  const auto bones = std::count_if(skeleton.joints().begin(), skeleton.joints().end(),
                                   [](const Joint& joint) { return joint.bone.has_value(); });
  report.add("joints", "joints", skeleton.jointCount(),
             fmt::format("{}, {}", skeleton.jointCount(),
                         counted(std::int64_t(bones), "of them a humanoid bone", "of them humanoid bones")));
  report.add("humanoidBones", bones);
  const Result<std::vector<HumanBone>> atRest = bonesLeftAtRest(skeleton);
  std::string retargeting = "any humanoid can perform it";
  if (!atRest) {
    retargeting = "only for characters with the same joints: " + atRest.error().message;
  } else if (!atRest->empty()) {
    std::vector<std::string_view> names;
    names.reserve(atRest->size());
    for (const HumanBone bone : *atRest) names.push_back(nameOf(bone));
    retargeting += fmt::format("; missing bones stay at rest: {}", fmt::join(names, ", "));
  }
  report.add("retargetable", "retargeting", atRest.ok(), retargeting);
}

constexpr double kDegrees = 57.29577951308232;

std::string cameraInWords(const OpenNiCamera& camera) {
  std::string text = camera.vendor + " " + camera.name;
  if (camera.usbVendor != 0) text += fmt::format(" (USB {:04x}:{:04x})", camera.usbVendor, camera.usbProduct);
  if (!camera.driver.empty()) text += ", driver " + camera.driver;
  return text;
}

Result<Report> describeDepthRecording(const std::filesystem::path& file, const std::string& lens) {
  LORICA_TRY(const std::unique_ptr<DepthRecording> read, openDepthRecording(file, lens));
  const DepthRecordingInfo& info = read->about();
  const DepthCamera& camera = read->camera();
  const double rate = info.duration > 0.0 ? (info.frameCount - 1) / info.duration : 0.0;
  const auto* const oni = dynamic_cast<const OniFile*>(read.get());
  const bool mirrored = oni != nullptr && oni->info().mirrored;
  Report report(read->name() + ": a depth recording");
  report.add("kind", "depth recording");
  report.add("name", read->name());
  report.add("version", "format", oni != nullptr ? oni->info().version : info.format,
             fmt::format("{}{}", info.format, info.cutOff ? ", truncated: its complete frames are readable" : ""));
  report.add("device", "device", info.device);
  report.add("lens", "lens", info.lens);
  report.add("seconds", "length", info.duration, fmt::format("{:.2f} s", info.duration));
  report.add("frames", "depth frames", info.frameCount,
             fmt::format("{} at {:.1f} per second", grouped(info.frameCount), rate));
  report.add("framesPerSecond", rate);
  report.add("width", "image", camera.width,
             fmt::format("{} x {} pixels, {:.1f} x {:.1f} degrees{}", camera.width, camera.height,
                         kDegrees * camera.horizontalFov, kDegrees * camera.verticalFov,
                         mirrored ? "; stored mirrored, unmirrored when read" : ""));
  report.add("height", camera.height);
  report.add("mirrored", mirrored);
  report.add("cutOff", info.cutOff);
  const Result<std::string> guess = firstGuessOfDepth(file, lens);
  report.add("firstGuess", "first guess", guess ? Json(*guess) : Json());
  if (oni != nullptr && oni->info().colorFrameCount > 0) {
    report.line("colour", counted(oni->info().colorFrameCount, "frame") + ", ignored");
  }
  if (oni != nullptr && oni->info().infraredFrameCount > 0) {
    report.line("infrared", counted(oni->info().infraredFrameCount, "frame") + ", ignored");
  }
  return report;
}

/// The depth cameras that OpenNI2 finds and their drivers; if there are none, the reasons.
/// @param driver  file of an additional driver; empty = none
Result<Report> describeDevices(const std::string& driver) {
  OpenNiSettings settings;
  if (!driver.empty()) settings.drivers.emplace_back(driver);
  LORICA_TRY(const std::shared_ptr<OpenNi> openNi, OpenNi::start(settings));
  LORICA_TRY(const std::vector<OpenNiCamera> cameras, openNi->cameras());

  Report report(cameras.empty() ? "No depth camera found" : counted(std::ssize(cameras), "depth camera"));
  report.add("kind", "devices");
  Json found = Json::array();
  for (const OpenNiCamera& camera : cameras) {
    report.line(camera.uri, cameraInWords(camera));
    found.push_back({{"uri", camera.uri},
                     {"vendor", camera.vendor},
                     {"name", camera.name},
                     {"usb", fmt::format("{:04x}:{:04x}", camera.usbVendor, camera.usbProduct)},
                     {"driver", camera.driver}});
  }
  report.add("cameras", std::move(found));
  if (!cameras.empty()) report.gap();
  Json drivers = Json::array();
  for (const OpenNiDriver& known : openNi->drivers()) {
    const std::string origin = known.packaged ? "part of OpenNI2" : "added";
    report.line(known.file.filename().string(),
                known.problem.empty() ? origin : origin + ", not usable: " + known.problem);
    drivers.push_back(
        {{"file", known.file.string()}, {"packaged", known.packaged}, {"problem", orNull(known.problem)}});
  }
  report.add("drivers", std::move(drivers));
  std::vector<std::string> why;
  if (cameras.empty()) {
    why = whyNoCamera(usbDepthCameras(), !driver.empty());
    for (const std::string& sentence : why) report.note(sentence);
    report.note(
        "RealSense, Orbbec, Azure Kinect, OAK-D, iPhone, ROS: a sender hands their depth to `lorica live --depth "
        "7000`.");
    report.note("What to install and type for each camera: docs/SENSORS.md. Without one, try `lorica live --virtual`.");
  }
  report.add("why", why);
  return report;
}

Report describeMotion(const Motion& motion) {
  const double seconds = motion.seconds();
  const double rate = seconds > 0.0 ? (motion.frameCount() - 1) / seconds : 0.0;
  Report report(fmt::format("{}: {}", motion.name, motion.bones ? "a motion of a skeleton" : "a recording of joints"));
  report.add("kind", motion.bones ? "motion" : "recording");
  report.add("name", motion.name);
  report.add("format", "format", motion.format);
  report.line("first guess", motion.firstGuess);
  report.add("seconds", "length", seconds, fmt::format("{:.2f} s", seconds));
  report.add("frames", "frames", motion.frameCount(),
             fmt::format("{} at {:.1f} per second", grouped(motion.frameCount()), rate));
  report.add("framesPerSecond", rate);
  if (motion.bones) {
    addBones(motion.bones->skeleton, report);
  } else {
    addJoints(motion, report);
  }
  for (const std::string& note : motion.notes) report.note(note);
  report.add("firstGuess", motion.firstGuess);
  report.add("notes", motion.notes);
  return report;
}

Result<Report> describeInput(const InfoOptions& options, Host& host) {
  if (options.devices) return describeDevices(options.driver);
  if (options.input.empty()) {
    return invalidArgument("expected a file or --devices");
  }
  const fs::path shipped = isBareName(options.input) ? shippedRecording(options.input) : fs::path();
  const fs::path file = shipped.empty() ? fs::path(options.input) : shipped;
  const FileKind kind = kindOf(file);
  if (kind == FileKind::kDecomposition) return describeDecomposition(file);
  if (kind == FileKind::kDepth) return describeDepthRecording(file, options.motion.lens);
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
Result<std::size_t> writeMap(const InfoOptions& options, const CommonOptions& common, const Host& host) {
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

Result<void> runInfo(const InfoOptions& options, const CommonOptions& common, Host& host) {
  LORICA_TRY_DO(checkJsonOutput(common, {options.input, options.character.map, options.writeMap}));
  std::size_t unsure = 0;
  if (!options.writeMap.empty()) {
    LORICA_TRY(unsure, writeMap(options, common, host));
  }
  LORICA_TRY(Report report, describeInput(options, host));
  if (!options.writeMap.empty()) {
    const std::string check = unsure == 0 ? "" : fmt::format(", {} unsure", counted(unsure, "bone is", "bones are"));
    report.add("map", "bone map", options.writeMap, options.writeMap + check + ": edit it and pass it with --map");
  }
  return publish(common, report);
}

}  // namespace

Command addInfo(CLI::App& parent, CommonOptions& common) {
  const auto options = std::make_shared<InfoOptions>();
  CLI::App* app = addSubcommand(
      parent, common, "info", "Say what a file is and whether it works: a mesh, character, motion or decomposition.",
      "  lorica info hero.glb           # joints and bones, clips, holes in the surface, the body made from it\n"
      "  lorica info hero.glb --write-map hero.json\n"
      "                                 # write the bone map, to correct it and pass it with --map\n"
      "  lorica info bunny.off          # a mesh: closed or not, convexity\n"
      "  lorica info body.lorica        # parts, error, levels of detail, bones of each part\n"
      "  lorica info dance.bvh          # a motion; recorded joints too\n"
      "  lorica info body.oni           # a depth recording; also .mkv, .bag, .npz, a folder of PNG\n"
      "  lorica info --devices          # connected depth cameras and their drivers\n"
      "  lorica info walk               # a shipped recording\n"
      "  lorica info mannequin          # the built-in character");
  CLI::Option* file = app->add_option(
      "FILE", options->input,
      "Mesh (.off, .obj, .ply, .stl), character (.glb, .gltf, .vrm, .fbx, .dae), motion (.bvh, recorded joints), depth "
      "(.oni, .mkv, .bag, .npz, a folder of PNG), decomposition (.lorica), or a shipped name");
  CLI::Option* devices =
      app->add_flag("--devices", options->devices, "List depth cameras instead of describing a file")->excludes(file);
  addOption(*app, "--driver", options->driver, "FILE", "Additional OpenNI2 driver: lib*.so")->needs(devices);
  addCharacterOptions(*app, options->character);
  addTextureOption(*app, options->character.textureSize);
  addOption(*app, "--write-map", options->writeMap, "FILE.json",
            "Write the character's bone map: its joint for each humanoid bone");
  addReadingOptions(*app, options->motion);
  return {app, [options](const CommonOptions& given, Host& host) { return runInfo(*options, given, host); }};
}

}  // namespace lorica
