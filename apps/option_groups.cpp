#include "apps/option_groups.h"

#include "apps/options.h"
#include "capture/fault_injector.h"
#include "capture/files/joint_stream.h"
#include "capture/streams/vmc_names.h"
#include "geometry/counts.h"
#include "geometry/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace lorica {

namespace {

constexpr double kFarthest = 1e4;  // maximum distance of a position from the origin [m]
constexpr const char* kVrchatPort = ":9000";

void addPersonOption(CommandLine& app, int& person) {
  const TextReader read = [&person](const std::string& text) -> std::string {
    const bool whole = !text.empty() && text.size() < 9 && text.find_first_not_of("0123456789") == std::string::npos;
    person = text == "all" ? kEveryone : whole ? std::stoi(text) : 0;
    return person != 0 ? "" : fmt::format("found `{}`, expected a whole number from 1, or all", text);
  };
  app.addOption("--person", read,
                "Person to use, by number in a stream of joints or a recorded session, or by order of appearance "
                "before a depth camera; "
                "all: an avatar for each, with play and record [default: the one with the most motion; before a "
                "camera the nearest]",
                "N|all");
}

/// "1.5,1,-3"; none for any other text.
std::optional<Vec3> positionOf(const std::string& text) {
  Vec3 position;
  const char* at = text.data();
  const char* end = at + text.size();
  for (int i = 0; i < 3; ++i) {
    if (i > 0 && (at == end || *at++ != ',')) return std::nullopt;
    const auto [stopped, error] = std::from_chars(at, end, position[i]);
    if (error != std::errc() || !(std::abs(position[i]) <= kFarthest)) return std::nullopt;
    at = stopped;
  }
  if (at != end) return std::nullopt;
  return position;
}

Option* addPosition(CommandLine& app, const std::string& name, std::optional<Vec3>& position,
                    const std::string& description) {
  const TextReader read = [&position](const std::string& text) -> std::string {
    position = positionOf(text);
    return position ? "" : fmt::format("found `{}`, expected a position in metres, such as 1.5,1,-3", text);
  };
  return app.addOption(name, read, description, "X,Y,Z");
}

}  // namespace

void addCharacterOptions(CommandLine& app, CharacterOptions& options) {
  app.addOption(
      "--map", options.map,
      "Bone map: the joint for each humanoid bone, if names and shape are not enough; `lorica info --write-map` "
      "creates one",
      "FILE.json");
  addLength(app, "--body-resolution", options.bodyResolution,
            "Voxel size for the closed body that is made if the surface is open [default: from its thickness]");
  addWallOptions(app, options);
  addExpressionOption(app, options.expressions);
  addHideOption(app, options.hidden);
}

void addHideOption(CommandLine& app, std::vector<std::string>& hidden) {
  app.addOption(
         "--hide", hidden,
         "Leave out a mesh of the character, such as a weapon, from pictures and hulls; may be repeated; `lorica "
         "info` lists the names",
         "NAME")
      ->repeatable();
}

void addTextureOption(CommandLine& app, int& textureSize) {
  addCount(app, "--texture-size", textureSize, 16,
           "Reduce textures whose width or height is larger than this [pixels; default: as stored]");
}

void addReadingOptions(CommandLine& app, MotionOptions& options) {
  std::vector<std::string> formats;
  formats.reserve(kJointFormatCount);
  for (int f = 0; f < kJointFormatCount; ++f) formats.emplace_back(nameOf(static_cast<JointFormat>(f)));
  const std::string names = fmt::format("{}", fmt::join(formats, ", "));
  app.addOption("--format", options.format,
                fmt::format("Layout of recorded joints, if it cannot be detected from the content: {}", names), "NAME")
      ->check(oneOf(std::move(formats)));
  addPersonOption(app, options.person);
  app.addOption("--clip", options.clip, "Clip of a file with several clips [default: the first]", "NAME");
  app.addOption(
      "--rest", options.rest,
      "Rest pose of a BVH file: zero (all rotations are zero), frame:N (counted from 0), or a BVH file of the "
      "same joints, whose first frame it is [default: zero if the body stands, else found]",
      "POSE");
  addSenderOption(app, options.sender);
}

void addPlayingOptions(CommandLine& app, MotionOptions& options) {
  app.addFlag("--mirror", options.mirror, "Mirror the motion: swap left and right");
  app.addFlag(
      "--upper-body", options.upperBody,
      "Do not use the person's legs: the character stands, for people who sit and for webcams; motions of bones "
      "keep theirs");
  app.addOption("--smooth", options.smooth,
                "Smoothing filter for joints: off or one-euro; the delay is measured and printed [default: off]",
                "NAME")
      ->check(oneOf({"off", "one-euro"}));
  addPositive(
      app, "--min-cutoff", options.oneEuro.minCutoff,
      fmt::format("Cutoff of one-euro at rest [Hz]; lower is smoother [default: {:g}]", options.oneEuro.minCutoff),
      "HZ");
  addPositive(
      app, "--beta", options.oneEuro.beta,
      fmt::format("Increase of the cutoff with speed [1/m]; higher lags less [default: {:g}]", options.oneEuro.beta),
      "NUMBER");
}

bool smoothingGiven(const CommandLine& app) {
  return app.given("--smooth") || app.given("--min-cutoff") || app.given("--beta");
}

void addFaultOption(CommandLine& app, MotionOptions& options) {
  const TextCheck check = [](std::string& text) -> std::string {
    const Result<FaultSettings> faults = parseFaults(text);
    return faults ? "" : faults.error().message;
  };
  app.addOption("--inject", options.inject,
                "Simulate tracking faults, each with a rate or its default: dropout=0.1 (fraction of joints lost), "
                "jitter=0.02 (metres), swap=0.02, late=0.05, freeze=0.05 (fractions of frames); seed=1. Only late and "
                "freeze apply to a motion of bones",
                "FAULTS")
      ->check(check);
}

void addMotionOptions(CommandLine& app, CastRequest& options) {
  app.addOption("MOTION", options.motion,
                "Recorded joints, .bvh, depth (.oni), a character file with clips, or the name of a shipped "
                "recording [default: a clip of --character]");
  app.addOption("--character", options.character,
                "Character: .glb, .gltf, .vrm, .fbx, .dae or mannequin [default: mannequin]", "FILE");
  addReadingOptions(app, options.performing);
  addPlayingOptions(app, options.performing);
  addCharacterOptions(app, options.reading);
  addSpringOption(app, options.springs);
}

void addSenderOption(CommandLine& app, std::string& file) {
  app.addOption("--sender", file,
                "The sender's model, if it is VRM 1.0 and sends its bones' own rotations: then zero is not the T-pose",
                "FILE.vrm");
}

void addBodyOptions(CommandLine& app, BodyOptions& options) {
  app.addOption("--decomposition", options.decomposition, "Decomposition written by `lorica decompose -o`",
                "FILE.lorica");
  addCover(
      app, options.cover.tolerance,
      "Hull cover: `exact` keeps the surface inside the hulls in every pose; a length keeps fewer points, so that the "
      "surface protrudes by at most this length before the hulls are enlarged [default: as decomposed, else exact]");
  addCount(app, "--hull-vertices", options.cover.hullVertices, 4,
           "Limit each hull to N vertices in every frame; hulls are enlarged to contain the body");
}

Option* addCover(CommandLine& app, std::optional<double>& tolerance, const std::string& description) {
  const TextReader read = [&tolerance](const std::string& text) -> std::string {
    double length = 0.0;
    const char* end = text.data() + text.size();
    const auto [stopped, error] = std::from_chars(text.data(), end, length);
    const bool given = error == std::errc() && stopped == end && std::isfinite(length) && length > 0.0;
    if (!given && text != "exact") {
      return fmt::format("found `{}`, expected exact, or a length above 0 in metres such as 0.002", text);
    }
    tolerance = given ? length : 0.0;
    return "";
  };
  return app.addOption("--cover", read, description, "exact|METRES");
}

void addBodyOption(CommandLine& app, std::string& body) {
  app.addOption(
         "--body", body,
         "Replace the surface by a closed body: `auto` = if it cannot be repaired, `never` = refuse such a mesh, "
         "`always` = even a closed one [default: auto]",
         "WHEN")
      ->check(oneOf({"auto", "never", "always"}));
}

void addPresetOption(CommandLine& app, std::string& preset) {
  app.addOption(
         "--preset", preset,
         "paper: the published algorithm; fast: better parts in similar time; quality: even better parts, slower "
         "[default: fast]",
         "NAME")
      ->check(oneOf({"paper", "fast", "quality"}));
}

DecomposePreset presetNamed(const std::string& name) {
  if (name == "paper") return DecomposePreset::kPaper;
  return name == "quality" ? DecomposePreset::kQuality : DecomposePreset::kFast;
}

void addWallOptions(CommandLine& app, CharacterOptions& options) {
  const TextReader read = [&options](const std::string& text) -> std::string {
    options.walls = wallChoiceNamed(text);
    return options.walls ? "" : fmt::format("found `{}`, expected auto, solid or shell", text);
  };
  app.addOption(
      "--walls", read,
      "What an open surface is: `auto` = a thin wall, unless nothing outside can reach what is behind it; `solid`, "
      "whatever its openings; `shell` = a thin wall, also where it is closed [default: auto; of a character solid]",
      "WHAT");
  addLength(app, "--thickness", options.thickness,
            "Thickness of thin walls, in the mesh's unit [default: 1 % of its longest side, of a character's walls "
            "of theirs, at most half of the narrowest gap]");
}

BodyChoice bodyChoice(const std::string& name) {
  return name == "never" ? BodyChoice::kNever : name == "always" ? BodyChoice::kAlways : BodyChoice::kIfNeeded;
}

void addSceneOption(CommandLine& app, std::string& scene) {
  app.addOption(
      "--scene", scene,
      "Scene: a scene file (.json), or beach, boxes, bowling, bridge, curtain, dominoes, duel, fountain, pool, "
      "sand or targets [default: boxes and balls of the demo]",
      "SCENE");
}

void addSpringOption(CommandLine& app, std::string& mode) {
  app.addOption("--springs", mode,
                "What the character's hair and clothes do, if its file (VRM) has springs: `file` = collide with the "
                "file's colliders, `body` = with the live hulls of the body and with props, `none` = stay at rest "
                "[default: file, or body if the file has no colliders]",
                "MODE")
      ->check(oneOf({"none", "file", "body"}));
}

void addExpressionOption(CommandLine& app, std::vector<std::string>& expressions) {
  app.addOption(
         "--expression", expressions,
         "Expression of the face and its weight from 0 to 1, such as Joy=1; may be repeated; `lorica info` lists "
         "a character's expressions",
         "NAME=WEIGHT")
      ->repeatable();
}

void addRecordOption(CommandLine& app, std::string& file) {
  app.addOption("--record", file, "Record the session, for `lorica replay`", "FILE.lsession");
}

void addDepthOptions(CommandLine& app, DepthOptions& options) {
  Option* device = app.addOption("--device", options.device,
                                 "URI of the camera, see `lorica info --devices` [default: the first]", "URI");
  Option* driver = app.addOption("--driver", options.driver, "Additional OpenNI2 driver: lib*.so", "FILE");
  Option* virtualCamera = app.addFlag("--virtual", options.virtualCamera, "Use a virtual camera with a virtual person");
  virtualCamera->excludes(device)->excludes(driver);
  app.addOption("--motion", options.motion,
                "Motion of the virtual person, repeated: a shipped recording or a joint CSV; two of them, separated by "
                "a comma, "
                "for two people [default: from $LORICA_VIRTUAL, else wave]",
                "MOTION")
      ->needs(virtualCamera);
}

Option* addWearerOptions(CommandLine& app, LiveRequest& live) {
  Option* lower =
      app.addFlag("--lower-body", live.lowerBody,
                  "The camera sees only waist, legs and feet: arms hang, the head is that of a headset on the page");
  app.addFlag("--three-point", live.threePoint,
              "Follow head and hands of a headset instead of a camera; --vr without a camera does so, too")
      ->excludes(lower);
  return lower;
}

Option* addVmcInputOptions(CommandLine& app, VmcInputOptions& options) {
  Option* vmc = app.addOption("--vmc", options.listenAt,
                              "Follow a program that sends the VMC protocol, instead of a camera. A port alone is open "
                              "to this machine only; see docs/STREAMS.md. `live` takes several, separated by commas: "
                              "an avatar for each",
                              "[HOST:]PORT");
  addCount(
      app, "--delay", options.delayMs, 0,
      "Show what is received so many milliseconds later, at an even pace, if the network is uneven [ms; default: 0]")
      ->needs(vmc);
  return vmc;
}

void addPoseOutputOptions(CommandLine& app, PoseOutputOptions& options) {
  const TextReader readVmc = [&options](const std::string& text) -> std::string {
    const Result<NetworkAddress> address = parseNetworkAddress(text, true);
    if (!address) return address.error().message;
    options.vmc = *address;
    return "";
  };
  Option* vmc = app.addOption("--vmc-out", readVmc,
                              "Send the pose by the VMC protocol, for VSeeFace, Unity, Unreal and others, such as "
                              "127.0.0.1:39539; see docs/STREAMS.md",
                              "HOST:PORT");
  const TextReader readBone = [&options](const std::string& text) -> std::string {
    const std::optional<HumanBone> bone = vmcBoneNamed(text);
    if (!bone) {
      return fmt::format(
          "found '{}', expected names of humanoid bones such as Hips, Head, LeftUpperArm and LeftHand, separated by "
          "commas",
          text.substr(0, 40));
    }
    if (!options.bones) options.bones.emplace().fill(false);
    (*options.bones)[ordinalOf(*bone)] = true;
    return "";
  };
  app.addOption("--vmc-bones", readBone, "Send only these bones: Hips,Head,LeftHand [default: all]", "NAME,...")
      ->separatedBy(',')
      ->needs(vmc);
  const TextReader readVrchat = [&options](const std::string& text) -> std::string {
    const bool hasPort = text.find(':') != std::string::npos && !text.ends_with(']');
    const Result<NetworkAddress> address = parseNetworkAddress(text + (hasPort ? "" : kVrchatPort), true);
    if (!address) {
      return fmt::format("found '{}', expected HOST or HOST:PORT, such as 127.0.0.1", text.substr(0, 100));
    }
    options.vrchat = *address;
    return "";
  };
  Option* vrchat = app.addOption("--vrchat", readVrchat, "Send the pose as VRChat's OSC trackers [default port: 9000]",
                                 "HOST[:PORT]");
  const TextReader readTracker = [&options](const std::string& text) -> std::string {
    const auto found = std::ranges::find(kVrchatTrackers, lowerCase(text));
    if (found == kVrchatTrackers.end()) {
      return fmt::format("found '{}', expected some of {}, separated by commas", text.substr(0, 40),
                         fmt::join(kVrchatTrackers, ", "));
    }
    options.trackers.set(found - kVrchatTrackers.begin());
    return "";
  };
  app.addOption("--vrchat-trackers", readTracker, "Send only these: head,waist,chest,feet,knees,elbows [default: all]",
                "NAME,...")
      ->separatedBy(',')
      ->needs(vrchat);
}

void addEventsOption(CommandLine& app, std::string& to) {
  app.addOption("--events", to,
                "Write begin, stay and end of each contact as lines of JSON; `-` is standard output, and the report "
                "goes to standard error; see docs/CONTACTS.md",
                "FILE");
}

void addSnapshotOptions(CommandLine& app, SnapshotOptions& options, Option* window) {
  Option* snapshots = app.addOption("--snapshots", options.folder, "Write pictures to this folder", "DIR");
  addCount(app, "--every", options.every, 1, "Write a picture every N frames [default: 30]")->needs(snapshots);
  Option* video = app.addOption("--video", options.video, "Write a video, as .mp4 (30 frames per second)", "FILE");
  Option* headless = app.addFlag("--headless", options.headless, "Do not open a window, even if there is a display");
  for (Option* option : {snapshots, video, headless}) option->excludes(window);
  addCameraOptions(app, options.camera);
  addLookOptions(app, options);
}

void addLookOptions(CommandLine& app, SnapshotOptions& options) {
  const TextReader readSize = [&options](const std::string& text) -> std::string {
    const std::optional<CanvasSize> size = pictureSizeOf(text);
    options.size = size.value_or(CanvasSize());
    if (size) return "";
    return fmt::format(
        "found `{}`, expected width and height of {} to {} pixels, such as 640x360, or portrait or square", text,
        kSmallestSide, kLargestSide);
  };
  app.addOption("--size", readSize,
                "Width and height in pixels, or portrait (1080x1920), or square (1080x1080) [default: 1280x720]",
                "WxH");
  const TextReader readBackground = [&options](const std::string& text) -> std::string {
    options.background = backgroundNamed(text);
    if (options.background || text.empty()) return "";
    return fmt::format("found `{}`, expected transparent, green, blue, white, black, gray or a colour such as #00ff00",
                       text);
  };
  app.addOption("--background", readBackground,
                "Instead of the sky and the ground: a colour such as #00ff00, or transparent [default: the sky]",
                "COLOR");
}

void addCameraOptions(CommandLine& app, CameraOptions& options) {
  Option* camera =
      app.addOption(
             "--camera", options.preset,
             "View of the body, which the camera follows: front, side, back, top, three-quarter (35 degrees from "
             "where it faces), or face for a portrait [default: three-quarter]",
             "VIEW")
          ->check(oneOf({"front", "side", "back", "top", "face", "three-quarter"}));
  Option* eye =
      addPosition(app, "--eye", options.eye, "Fixed camera position instead, in metres: 2,1.5,3")->excludes(camera);
  Option* target =
      addPosition(app, "--target", options.target, "Point that the fixed camera looks at, in metres")->needs(eye);
  eye->needs(target);
}

}  // namespace lorica
