#include "apps/option_groups.h"

#include "apps/options.h"
#include "capture/fault_injector.h"
#include "capture/files/joint_stream.h"
#include "capture/streams/vmc_names.h"
#include "export/engines.h"
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
constexpr const char *kVrchatPort = ":9000", *kVmtPort = ":39570";

void addPersonOption(CLI::App& app, int& person) {
  const auto read = [&person](const std::string& text) -> std::string {
    const bool whole = !text.empty() && text.size() < 9 && text.find_first_not_of("0123456789") == std::string::npos;
    person = text == "all" ? kEveryone : whole ? std::stoi(text) : 0;
    return person != 0 ? "" : fmt::format("found `{}`, expected a whole number from 1, or all", text);
  };
  addReader(app, "--person", read, "N|all",
            "Person to use, by number in a stream of joints or a recorded session, or by order of appearance before a "
            "depth camera; all: an avatar for each, with play and record [default: the one with the most motion; "
            "before a camera the nearest]");
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

CLI::Option* addPosition(CLI::App& app, const std::string& name, std::optional<Vec3>& position,
                         const std::string& description) {
  const auto read = [&position](const std::string& text) -> std::string {
    position = positionOf(text);
    return position ? "" : fmt::format("found `{}`, expected a position in metres, such as 1.5,1,-3", text);
  };
  return addReader(app, name, read, "X,Y,Z", description);
}

}  // namespace

void addCharacterOptions(CLI::App& app, CharacterOptions& options) {
  addOption(app, "--map", options.map, "FILE.json",
            "Bone map: the joint for each humanoid bone, if names and shape are not enough; `lorica info --write-map` "
            "creates one");
  addLength(app, "--body-resolution", options.bodyResolution,
            "Voxel size for the closed body that is made if the surface is open [default: from its thickness]");
  addWallOptions(app, options);
  addRepeated(app, "--expression", options.expressions, "NAME=WEIGHT",
              "Expression of the face and its weight from 0 to 1, such as Joy=1; may be repeated; `lorica info` lists "
              "a character's expressions");
  addHideOption(app, options.hidden);
}

void addHideOption(CLI::App& app, std::vector<std::string>& hidden) {
  addRepeated(app, "--hide", hidden, "NAME",
              "Leave out a mesh of the character, such as a weapon, from pictures and hulls; may be repeated; `lorica "
              "info` lists the names");
}

void addTextureOption(CLI::App& app, int& textureSize) {
  addCount(app, "--texture-size", textureSize, 16,
           "Reduce textures whose width or height is larger than this [pixels; default: as stored]");
}

void addReadingOptions(CLI::App& app, MotionOptions& options) {
  std::vector<std::string> formats;
  formats.reserve(kJointFormatCount);
  for (int f = 0; f < kJointFormatCount; ++f) formats.emplace_back(nameOf(static_cast<JointFormat>(f)));
  const std::string names = fmt::format("{}", fmt::join(formats, ", "));
  const auto read = [&options](const std::string& text) -> std::string {
    options.format = jointFormatNamed(text);
    return "";
  };
  addReader(app, "--format", read, "NAME",
            fmt::format("Layout of recorded joints, if it cannot be detected from the content: {}", names))
      ->transform(oneOf(std::move(formats)));
  addPersonOption(app, options.person);
  addOption(app, "--clip", options.clip, "NAME", "Clip of a file with several clips [default: the first]");
  addOption(app, "--rest", options.rest, "POSE",
            "Rest pose of a BVH file: zero (all rotations are zero), frame:N (counted from 0), or a BVH file of the "
            "same joints, whose first frame it is [default: zero if the body stands, else found]");
  addOption(app, "--lens", options.lens, "CAMERA",
            "Camera of a depth recording whose images do not say it: fov=75x65, or fx=525,cx=319.5,cy=239.5, also "
            "unit=0.0002 and d=k1/k2/p1/p2/k3 [default: a .json file beside it, or the usual one of its size]");
  addSenderOption(app, options.sender);
}

void addPlayingOptions(CLI::App& app, MotionOptions& options) {
  app.add_flag("--mirror", options.mirror, "Mirror the motion: swap left and right");
  app.add_flag("--upper-body", options.upperBody,
               "Do not use the person's legs: the character stands, for people who sit and for webcams; motions of "
               "bones keep theirs");
  const auto given = [&options](const std::string&) { options.smoothGiven = true; };
  const auto read = [&options](const std::string& text) -> std::string {
    options.smooth = text == "off" ? MotionOptions::Smoothing::kOff : MotionOptions::Smoothing::kOneEuro;
    return "";
  };
  addReader(app, "--smooth", read, "NAME",
            "Smoothing filter for joints: off or one-euro; the delay is measured and printed [default: off]")
      ->transform(oneOf({"off", "one-euro"}))
      ->each(given);
  addPositive(
      app, "--min-cutoff", options.oneEuro.minCutoff, "HZ",
      fmt::format("Cutoff of one-euro at rest [Hz]; lower is smoother [default: {:g}]", options.oneEuro.minCutoff))
      ->each(given);
  addPositive(
      app, "--beta", options.oneEuro.beta, "NUMBER",
      fmt::format("Increase of the cutoff with speed [1/m]; higher lags less [default: {:g}]", options.oneEuro.beta))
      ->each(given);
}

void addFaultOption(CLI::App& app, MotionOptions& options) {
  const auto read = [&options](const std::string& text) -> std::string {
    Result<FaultSettings> faults = parseFaults(text);
    if (!faults) return faults.error().message;
    options.inject = *faults;
    return "";
  };
  addReader(app, "--inject", read, "FAULTS",
            "Simulate tracking faults, each with a rate or its default: dropout=0.1 (fraction of joints lost), "
            "jitter=0.02 (metres), swap=0.02, late=0.05, freeze=0.05 (fractions of frames); seed=1. Only late and "
            "freeze apply to a motion of bones");
}

void addMotionOptions(CLI::App& app, CastRequest& options) {
  app.add_option("MOTION", options.motion,
                 "Recorded joints, .bvh, depth (.oni), a character file with clips, or the name of a shipped recording "
                 "[default: a clip of --character]");
  addOption(app, "--character", options.character, "FILE",
            "Character: .glb, .gltf, .vrm, .fbx, .dae or mannequin [default: mannequin]");
  addReadingOptions(app, options.performing);
  addPlayingOptions(app, options.performing);
  addCharacterOptions(app, options.reading);
  addSpringOption(app, options.springs);
}

void addSenderOption(CLI::App& app, std::string& file) {
  addOption(app, "--sender", file, "FILE.vrm",
            "The sender's model, if it is VRM 1.0 and sends its bones' own rotations: then zero is not the T-pose");
}

void addBodyOptions(CLI::App& app, BodyOptions& options) {
  addOption(app, "--decomposition", options.decomposition, "FILE.lorica",
            "Decomposition written by `lorica decompose -o`");
  addCover(
      app, options.cover.tolerance,
      "Hull cover: `exact` keeps the surface inside the hulls in every pose; a length keeps fewer points, so that the "
      "surface protrudes by at most this length before the hulls are enlarged [default: as decomposed, else exact]");
  addCount(app, "--hull-vertices", options.cover.hullVertices, 4,
           "Limit each hull to N vertices in every frame; hulls grow to contain the body");
}

void addHullPlanes(CLI::App& app, int& planes) {
  addCount(app, "--hull-planes", planes, 4,
           "Limit each hull to N planes, those of its flat faces; it is enlarged to contain the same. Not for hulls "
           "that bend with a character");
}

CLI::Option* addCover(CLI::App& app, std::optional<double>& tolerance, const std::string& description) {
  const auto read = [&tolerance](const std::string& text) -> std::string {
    double length = 0.0;
    const bool given = parseWhole(text, length) && std::isfinite(length) && length > 0.0;
    if (!given && text != "exact") {
      return fmt::format("found `{}`, expected exact, or a length above 0 in metres such as 0.002", text);
    }
    tolerance = given ? length : 0.0;
    return "";
  };
  return addReader(app, "--cover", read, "exact|METRES", description);
}

void addBodyOption(CLI::App& app, std::string& body) {
  addOption(app, "--body", body, "WHEN",
            "Replace the surface by a closed body: `auto` = if it cannot be repaired, `never` = refuse such a mesh, "
            "`always` = even a closed one [default: auto]")
      ->transform(oneOf({"auto", "never", "always"}));
}

CLI::Validator anEngine() {
  std::vector<std::string> names;
  for (const Engine& engine : kEngines) names.emplace_back(engine.name);
  return oneOf(std::move(names));
}

void addPresetOption(CLI::App& app, std::string& preset) {
  addOption(app, "--preset", preset, "NAME",
            "paper: the published algorithm; fast: better parts in similar time; quality: even better parts, slower "
            "[default: fast]")
      ->transform(oneOf({"paper", "fast", "quality"}));
}

DecomposePreset presetNamed(const std::string& name) {
  if (name == "paper") return DecomposePreset::kPaper;
  return name == "quality" ? DecomposePreset::kQuality : DecomposePreset::kFast;
}

void addWallOptions(CLI::App& app, CharacterOptions& options) {
  const auto read = [&options](const std::string& text) -> std::string {
    options.walls = wallChoiceNamed(text);
    return "";
  };
  addReader(app, "--walls", read, "WHAT",
            "What an open surface is: `auto` = a thin wall, unless nothing outside can reach what is behind it; "
            "`solid`, whatever its openings; `shell` = a thin wall, also where it is closed [default: auto; of a "
            "character solid, unless all of it is sheets]")
      ->transform(oneOf({"auto", "solid", "shell"}));
  addLength(app, "--thickness", options.thickness,
            "Thickness of thin walls, in the mesh's unit [default: 1 % of its longest side, of a character's walls of "
            "theirs, at most half of the narrowest gap]");
}

BodyChoice bodyChoice(const std::string& name) {
  return name == "never" ? BodyChoice::kNever : name == "always" ? BodyChoice::kAlways : BodyChoice::kIfNeeded;
}

CLI::Option* addSceneOption(CLI::App& app, std::string& scene, const std::string& usual) {
  const auto read = [&scene](const std::string& text) -> std::string {
    scene = text == "demo" ? "" : text;
    return "";
  };
  return addReader(
      app, "--scene", read, "SCENE",
      fmt::format("What stands around: `none`, `demo` (boxes and balls), a scene file (.json), or beach, boxes, "
                  "bowling, bridge, curtain, dominoes, duel, fountain, pool, sand or targets [default: {}]",
                  usual));
}

void addSpringOption(CLI::App& app, std::string& mode) {
  addOption(app, "--springs", mode, "MODE",
            "What the character's hair and clothes do, if its file (VRM) has springs: `file` = collide with the file's "
            "colliders, `body` = with the live hulls of the body and with props, `none` = stay at rest [default: file, "
            "or body if the file has no colliders]")
      ->transform(oneOf({"none", "file", "body"}));
}

void addRecordOptions(CLI::App& app, RunSetting& run) {
  addOption(app, "--record", run.record, "FILE.lsession", "Record the session, for `lorica replay`");
  addCount(app, "--frames", run.frames, 1, "Stop after N frames");
}

void addDepthOptions(CLI::App& app, DepthOptions& options) {
  CLI::Option* device = addOption(app, "--device", options.device, "URI",
                                  "URI of the camera, see `lorica info --devices` [default: the first]");
  CLI::Option* driver = addOption(app, "--driver", options.driver, "FILE", "Additional OpenNI2 driver: lib*.so");
  CLI::Option* virtualCamera = app.add_flag("--virtual", options.virtualCamera,
                                            "Instead of a camera a virtual one, with a virtual person before it");
  virtualCamera->excludes(device)->excludes(driver);
  CLI::Option* sent =
      addOption(app, "--depth", options.stream, "-|PATH|[HOST:]PORT",
                "Follow depth images that another program sends: - is standard input, a path is a named pipe or a "
                "socket, a port alone is open to this machine only; see docs/SENSORS.md")
          ->excludes(device)
          ->excludes(driver)
          ->excludes(virtualCamera);
  addOption(app, "--depth-format", options.format, "FORMAT",
            "Images without headers: gray16le,640x576,fov=75x65,unit=mm. Of a camera that has its usual size the field "
            "of view may be left out")
      ->needs(sent);
  addOption(app, "--motion", options.motion, "MOTION",
            "Motion of the virtual person, repeated: a shipped recording or a joint CSV; two of them, separated by a "
            "comma, for two people [default: from $LORICA_VIRTUAL, else wave]")
      ->needs(virtualCamera);
}

CLI::Option* addWearerOptions(CLI::App& app, LiveRequest& live) {
  CLI::Option* lower =
      app.add_flag("--lower-body", live.lowerBody,
                   "The camera sees only waist, legs and feet: arms hang, the head is that of a headset on the page");
  app.add_flag("--three-point", live.threePoint,
               "Follow head and hands of a headset instead of a camera; --vr without a camera does so, too")
      ->excludes(lower);
  return lower;
}

CLI::Option* addVmcInputOptions(CLI::App& app, VmcInputOptions& options) {
  CLI::Option* vmc = addOption(
      app, "--vmc", options.listenAt, "[HOST:]PORT",
      "Follow a program that sends the VMC protocol, such as a webcam's tracker: 39539 is their usual port, and open "
      "to this machine only; 0.0.0.0:39539 to all. `live` takes several, separated by commas: an avatar each");
  addCount(
      app, "--delay", options.delayMs, 0,
      "Show what is received so many milliseconds later, at an even pace, if the network is uneven [ms; default: 0]")
      ->needs(vmc);
  return vmc;
}

void addOutputOptions(CLI::App& app, RunSetting& run) {
  PoseOutputOptions& options = run.out;
  const auto readVmc = [&options](const std::string& text) -> std::string {
    const Result<NetworkAddress> address = parseNetworkAddress(text, true);
    if (!address) return address.error().message;
    options.vmc = *address;
    return "";
  };
  CLI::Option* vmc = addReader(app, "--vmc-out", readVmc, "HOST:PORT",
                               "Send the pose by the VMC protocol, for VSeeFace, Unity, Unreal and others, such as "
                               "127.0.0.1:39539; see docs/STREAMS.md");
  const auto readBone = [&options](const std::string& text) -> std::string {
    const std::optional<HumanBone> bone = vmcBoneNamed(text);
    if (!bone) {
      return fmt::format(
          "found '{}', expected names of humanoid bones such as Hips, Head, LeftUpperArm and LeftHand, separated by "
          "commas",
          firstBytes(text, 40));
    }
    if (!options.bones) options.bones.emplace().fill(false);
    (*options.bones)[ordinalOf(*bone)] = true;
    return "";
  };
  addReader(app, "--vmc-bones", readBone, "NAMES",
            "Send only these bones, separated by commas: Hips,Head,LeftHand [default: all]")
      ->delimiter(',')
      ->expected(1, CLI::detail::expected_max_vector_size)
      ->needs(vmc);
  const auto readHost = [](std::optional<NetworkAddress>& to, const char* port) {
    return [&to, port](const std::string& text) -> std::string {
      const bool hasPort = text.find(':') != std::string::npos && !text.ends_with(']');
      const Result<NetworkAddress> address = parseNetworkAddress(text + (hasPort ? "" : port), true);
      if (!address) {
        return fmt::format("found '{}', expected HOST or HOST:PORT, such as 127.0.0.1", firstBytes(text, 100));
      }
      to = *address;
      return "";
    };
  };
  addReader(app, "--vrchat", readHost(options.vrchat, kVrchatPort), "HOST[:PORT]",
            "Send the pose as VRChat's OSC trackers [default port: 9000]");
  addReader(app, "--vmt", readHost(options.vmt, kVmtPort), "HOST[:PORT]",
            "Send the pose as SteamVR's trackers, through Virtual Motion Tracker on that PC [default port: 39570]");
  const auto readTracker = [&options](const std::string& text) -> std::string {
    const auto found = std::ranges::find(kTrackerGroups, lowerCase(text));
    if (found == kTrackerGroups.end()) {
      const std::vector<std::string> names(kTrackerGroups.begin(), kTrackerGroups.end());
      return fmt::format("found '{}', expected some of {}, separated by commas{}", firstBytes(text, 40),
                         fmt::join(names, ", "), didYouMean(text, names));
    }
    options.trackers.set(found - kTrackerGroups.begin());
    return "";
  };
  addReader(app, "--trackers", readTracker, "NAMES",
            "Of --vrchat and --vmt send only these, separated by commas: head, waist, chest, feet, knees, elbows "
            "[default: all]")
      ->delimiter(',')
      ->expected(1, CLI::detail::expected_max_vector_size);
  addOption(app, "--events", run.events, "FILE",
            "Write begin, stay and end of each contact as lines of JSON; `-` is standard output, and the report goes "
            "to standard error; see docs/CONTACTS.md");
}

void addSnapshotOptions(CLI::App& app, SnapshotOptions& options, CLI::Option* window) {
  CLI::Option* snapshots = addOption(app, "--snapshots", options.folder, "DIR", "Write pictures to this folder");
  addCount(app, "--every", options.every, 1, "Write a picture every N frames [default: 30]")->needs(snapshots);
  CLI::Option* video =
      addOption(app, "--video", options.video, "FILE", "Write a video, as .mp4 (30 frames per second)");
  CLI::Option* headless =
      app.add_flag("--headless", options.headless, "Do not open a window, even if there is a display");
  for (CLI::Option* option : {snapshots, video, headless}) option->excludes(window);
  addCameraOptions(app, options.camera);
  addLookOptions(app, options);
}

void addLookOptions(CLI::App& app, SnapshotOptions& options) {
  const auto readSize = [&options](const std::string& text) -> std::string {
    const std::optional<CanvasSize> size = pictureSizeOf(text);
    options.size = size.value_or(CanvasSize());
    if (size) return "";
    return fmt::format(
        "found `{}`, expected width and height of {} to {} pixels, such as 640x360, or portrait or square", text,
        kSmallestSide, kLargestSide);
  };
  addReader(app, "--size", readSize, "WxH",
            "Width and height in pixels, or portrait (1080x1920), or square (1080x1080) [default: 1280x720]");
  const auto readBackground = [&options](const std::string& text) -> std::string {
    options.background = backgroundNamed(text);
    if (options.background || text.empty()) return "";
    static const std::vector<std::string> kNames = {"light", "dark",  "transparent", "green",
                                                    "blue",  "white", "black",       "gray"};
    return fmt::format("found `{}`, expected {} or a colour such as #00ff00{}", text, fmt::join(kNames, ", "),
                       didYouMean(text, kNames));
  };
  addReader(app, "--background", readBackground, "COLOR",
            "Sky and ground, `light` or `dark`; or instead of them green, blue, white, black, gray, a colour such as "
            "#00ff00, or transparent [default: light]");
}

void addCameraOptions(CLI::App& app, CameraOptions& options) {
  CLI::Option* camera = addOption(app, "--camera", options.preset, "VIEW",
                                  "View of the body, which the camera follows: front, side, back, top, three-quarter "
                                  "(35 degrees from where it faces), or face for a portrait [default: three-quarter]")
                            ->transform(oneOf({"front", "side", "back", "top", "face", "three-quarter"}));
  CLI::Option* eye =
      addPosition(app, "--eye", options.eye, "Fixed camera position instead, in metres: 2,1.5,3")->excludes(camera);
  CLI::Option* target =
      addPosition(app, "--target", options.target, "Point that the fixed camera looks at, in metres")->needs(eye);
  eye->needs(target);
}

}  // namespace lorica
