#include "apps/option_groups.h"
#include "apps/options.h"
#include "capture/sensor/depth_recording.h"
#include "export/motion_export.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "session/prepare/depth_motion.h"
#include "session/prepare/file_kinds.h"
#include "session/prepare/read_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

struct ConvertOptions {
  std::string input;
  std::string output;
  MotionOptions motion;
  ConvertCharacter character;
  bool cameraFrame = false;

  /// Whether the motion is put on a character. Of a session as joints it may be where its own character is.
  [[nodiscard]] bool onto() const {
    const bool joints = lowerCase(fs::path(output).extension().string()) == ".csv";
    return !character.name.empty() && !(joints && kindOf(input) == FileKind::kSession);
  }
};

/// room.cam.csv of room.csv.
std::string besideOf(const ConvertOptions& options, const char* ending) {
  return fs::path(options.output).replace_extension().string() + ending;
}

/// The file of the input.
fs::path inputOf(const ConvertOptions& options) {
  const fs::path shipped = shippedRecording(options.input);
  return shipped.empty() ? fs::path(options.input) : shipped;
}

/// Everyone in a depth recording, where they are in front of the camera, beside the output.
Result<void> writeCameraFrame(const ConvertOptions& options, Report& report, Host& host) {
  LORICA_TRY_DO(writeTrackLog(inputOf(options), options.motion.lens, besideOf(options, ""), host));
  const std::string joints = besideOf(options, ".cam.csv"), labels = besideOf(options, ".lab");
  report.add("cameraFrame", "camera frame", {{"joints", joints}, {"labels", labels}}, joints + ", " + labels);
  return {};
}

/// The joints of everyone as one, by time; each has a number.
Result<Motion> readAll(const ConvertOptions& options, Host& host) {
  if (options.motion.person != kEveryone) {
    MotionOptions reading = options.motion;
    reading.character = options.character.name;
    return readMotion(options.input, reading, host);
  }
  LORICA_TRY(std::vector<Motion> motions, readEveryone(options.input, options.motion, host));
  Motion all = motions.front();
  all.joints.clear();
  for (std::size_t i = 0; i < motions.size(); ++i) {
    for (SkeletonFrame frame : motions[i].joints) {
      if (std::exchange(frame.user, int(i) + 1) != kNobody) all.joints.push_back(frame);
    }
  }
  const auto earlier = [](const SkeletonFrame& a, const SkeletonFrame& b) { return a.time < b.time; };
  std::stable_sort(all.joints.begin(), all.joints.end(), earlier);
  all.name = fs::path(options.input).stem().string();
  if (all.joints.empty()) return invalidArgument("{}: found no person", options.input);
  return all;
}

/// Rejects outputs that nothing can be written to, and those that are an input.
Result<void> checkFiles(const ConvertOptions& options, const CommonOptions& common, const std::string& extension) {
  const bool onCharacter = options.onto();
  if (options.motion.person == kEveryone && (onCharacter || extension == ".bvh")) {
    return invalidArgument("{}: --person all writes the joints of everyone, expected OUT.csv", options.output);
  }
  if (options.cameraFrame && kindOf(inputOf(options)) != FileKind::kDepth) {
    return invalidArgument("{}: --camera-frame is for depth recordings (.oni and others)", options.input);
  }
  const bool known = extension == ".bvh" || extension == (onCharacter ? ".glb" : ".csv");
  if (!known && extension == ".glb") {
    return invalidArgument("{}: a .glb shows a character in motion, expected --character FILE", options.output);
  }
  if (!known) {
    const char* expected = onCharacter
                               ? ".glb or .bvh, which hold the motion of a character"
                               : ".csv (Lorica's joints), .bvh, .oni of a depth recording, or .glb with --character";
    return invalidArgument("{}: found the extension `{}`, expected {}", options.output, extension, expected);
  }
  if (!options.character.map.empty() && !onCharacter) {
    return invalidArgument("--map is for the bones of a character, expected --character FILE");
  }
  LORICA_TRY_DO(checkNotTaken("OUT", options.output, {options.input, options.character.name, options.character.map}));
  for (const char* ending : {".cam.csv", ".lab"}) {
    if (options.cameraFrame) LORICA_TRY_DO(checkOutput(common, "OUT", besideOf(options, ending)));
  }
  return checkOutput(common, "OUT", options.output);
}

/// A depth recording of another kind as .oni.
Result<void> convertDepth(const ConvertOptions& options, const CommonOptions& common, Host& host) {
  if (kindOf(inputOf(options)) != FileKind::kDepth) {
    return invalidArgument("{}: found no depth recording, expected one for .oni", options.input);
  }
  if (options.cameraFrame || options.onto() || options.motion.person != 0) {
    return invalidArgument("{}: --camera-frame, --character and --person are for motions, expected none for .oni",
                           options.output);
  }
  LORICA_TRY_DO(checkNotTaken("OUT", options.output, {options.input}));
  LORICA_TRY_DO(checkOutput(common, "OUT", options.output));
  LORICA_TRY(const std::unique_ptr<DepthRecording> depth, openDepthRecording(inputOf(options), options.motion.lens));
  const DepthRecordingInfo& about = depth->about();
  Task task(host, "Writing " + options.output, "frames");
  LORICA_TRY_DO(writeOni(*depth, options.output, [&](int done) {
    task.update(done, about.frameCount);
    return !task.cancelled();
  }));
  Report report(fmt::format("{}: {}, {:.2f} s", depth->name(), counted(about.frameCount, "frame"), about.duration));
  report.add("input", options.input);
  report.add("format", "input format", about.format);
  report.add("lens", "lens", about.lens);
  report.add("frames", about.frameCount);
  report.add("seconds", about.duration);
  report.add("output", "output", options.output);
  if (about.cutOff) report.note("The recording is truncated; what is whole of it was written.");
  return publish(common, report);
}

Result<void> runConvert(const ConvertOptions& options, const CommonOptions& common, Host& host) {
  LORICA_TRY_DO(checkJsonOutput(common, {options.input, options.output, options.character.name}));
  const std::string extension = lowerCase(fs::path(options.output).extension().string());
  if (extension == ".oni") return convertDepth(options, common, host);
  LORICA_TRY_DO(checkFiles(options, common, extension));
  LORICA_TRY(const Motion motion, readAll(options, host));
  LORICA_TRY(const ConvertedClip made,
             options.onto() ? convertOnto(options.character, motion, options.motion, options.output, host)
                            : writeMotion(options.output, motion, options.motion));

  Report report(fmt::format("{}: {}, {:.2f} s", motion.name, counted(motion.frameCount(), "frame"), motion.seconds()));
  if (options.cameraFrame) LORICA_TRY_DO(writeCameraFrame(options, report, host));
  report.add("input", options.input);
  report.add("format", "input format", motion.format);
  report.line("first guess", motion.firstGuess);
  report.add("frames", motion.frameCount());
  report.add("seconds", motion.seconds());
  report.add("smoothingDelay", orNull(made.delay));
  if (made.joints > 0) {
    report.add("character", "character", options.character.name,
               fmt::format("{}, {}, {}", options.character.name, counted(made.joints, "joint"), made.units));
    report.add("joints", made.joints);
  }
  if (made.delay) report.line("smoothing", fmt::format("joints lag by {:.0f} ms", 1e3 * *made.delay));
  report.add("output", "output", options.output);
  std::vector<std::string> notes = motion.notes;
  notes.insert(notes.end(), made.notes.begin(), made.notes.end());
  for (const std::string& note : notes) report.note(note);
  report.add("firstGuess", motion.firstGuess);
  report.add("notes", notes);
  return publish(common, report);
}

}  // namespace

Command addConvert(CLI::App& parent, CommonOptions& common) {
  const auto options = std::make_shared<ConvertOptions>();
  CLI::App* app =
      addSubcommand(parent, common, "convert",
                    "Convert a motion: to joints (.csv), to .bvh, or to an animation of your character (.glb).",
                    "  lorica convert kinect.csv joints.csv\n"
                    "      convert a sensor's joints to metres, Y up, standing on the floor\n"
                    "  lorica convert kinect.csv motion.bvh --person 2\n"
                    "      the second person, for use in an animation program\n"
                    "  lorica convert walk.csv walk.glb --character hero.glb\n"
                    "      your character in motion: its own file with one animation more\n"
                    "  lorica convert walk.csv walk.bvh --character hero.glb\n"
                    "      the motion of its joints\n"
                    "  lorica convert hero.glb joints.csv --clip Run\n"
                    "      a character's clip as joints\n"
                    "  lorica convert take.pcap take.bvh\n"
                    "      what a program sent, on its own skeleton; of take.lsession what the character did\n"
                    "  lorica convert room.oni room.csv --camera-frame\n"
                    "      and everyone as the camera saw them: room.cam.csv and room.lab\n"
                    "  lorica convert azure.mkv room.oni\n"
                    "      a depth recording of another kind: .mkv, .bag, .npz, .npy, a folder of PNG pictures\n"
                    "  lorica convert room.oni room.csv --person all\n"
                    "      everyone, each with a number");
  app->add_option("IN", options->input,
                  "Recorded joints, depth, .bvh, a character file with clips, VMC packets (.pcap), a session "
                  "(.lsession), or the name of a shipped recording")
      ->required();
  app->add_option("OUT", options->output,
                  "Output file: .csv, .bvh, .glb with --character, or .oni of a depth recording")
      ->required();
  addReadingOptions(*app, options->motion);
  addPlayingOptions(*app, options->motion);
  addOption(*app, "--character", options->character.name, "FILE",
            "Move this character: .glb, .gltf, .vrm, .fbx, .dae or mannequin. OUT.glb is its file with the motion as "
            "first animation, in its units (of FBX and COLLADA: what Lorica has read, in metres); OUT.bvh has its "
            "joints, in centimetres");
  addOption(*app, "--map", options->character.map, "FILE.json",
            "Bone map of the character; `lorica info --write-map` creates one");
  app->add_flag("--camera-frame", options->cameraFrame,
                "Of a depth recording, also write the joints of everyone in the camera's frame (OUT.cam.csv) and whose "
                "each pixel is (OUT.lab), to judge the tracker");
  return {app, [options](const CommonOptions& given, Host& host) { return runConvert(*options, given, host); }};
}

}  // namespace lorica
