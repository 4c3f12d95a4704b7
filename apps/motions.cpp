#include "apps/motions.h"

#include "apps/depth_motion.h"
#include "apps/options.h"
#include "apps/report.h"
#include "capture/files/bvh_file.h"
#include "capture/files/joint_csv.h"
#include "capture/files/joint_stream.h"
#include "capture/retarget/proxy_skeleton.h"
#include "capture/retarget/skeletal_retarget.h"
#include "capture/synthetic/synthetic_motion.h"
#include "skinning/import/character_file.h"

#include <fmt/format.h>

#include <algorithm>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr double kClipRate = 60.0;  // [1/s]

bool isBvh(const fs::path& file) {
  return lowerCase(file.extension().string()) == ".bvh";
}

/// An option that says nothing about this kind of file would be passed over in silence.
Result<void> refuse(bool given, const std::string& option, const std::string& file, const char* what) {
  if (!given) return {};
  return Error{ErrorCode::kInvalidArgument,
               fmt::format("{}: {} is for {}, which this file does not hold", file, option, what)};
}

Result<Motion> readJoints(const fs::path& file, const MotionOptions& options) {
  if (Result<void> fine = refuse(!options.clip.empty(), "--clip", file.string(), "clips of skeletons"); !fine) {
    return fine.error();
  }
  JointStreamSettings settings;
  if (!options.format.empty()) settings.format = jointFormatNamed(options.format);
  if (options.person > 0) settings.person = options.person;
  Result<JointStream> stream = readJointStream(file, settings);
  if (!stream) return stream.error();
  Motion motion;
  motion.name = file.stem().string();
  motion.joints = std::move(stream->frames);
  motion.format = fmt::format("joints ({})", nameOf(stream->format));
  motion.notes = std::move(stream->notes);
  return motion;
}

Result<Motion> readBones(const fs::path& file, const MotionOptions& options) {
  for (const Result<void>& fine :
       {refuse(!options.format.empty(), "--format", file.string(), "recorded joints"),
        refuse(options.person > 0, "--person", file.string(), "recorded joints"),
        refuse(options.smooth != "off", "--smooth", file.string(), "recorded joints"),
        refuse(isBvh(file) && !options.clip.empty(), "--clip", file.string(), "character files, with several clips")}) {
    if (!fine) return fine.error();
  }
  Motion motion;
  motion.name = file.stem().string();
  if (isBvh(file)) {
    Result<BvhFile> read = readBvh(file);
    if (!read) return read.error();
    motion.bones = std::move(read->motion);
    motion.format = "BVH";
    motion.notes = std::move(read->notes);
    return motion;
  }
  Result<CharacterFile> read = readCharacterFile(file);
  if (!read) return read.error();
  const Result<const Clip*> clip = findClip(read->clips, options.clip, file.string());
  if (!clip) return clip.error();
  if (!(*clip)->name.empty()) motion.name += ": " + (*clip)->name;
  motion.bones = framesOf(read->character.skeleton, **clip);
  motion.fromCharacterFile = true;
  motion.format = read->format;
  motion.notes = std::move(read->notes);
  return motion;
}

Result<Motion> readMotionFile(const fs::path& file, const MotionOptions& options) {
  if (isDepthRecording(file)) {
    for (const Result<void>& fine :
         {refuse(!options.format.empty(), "--format", file.string(), "recorded joints"),
          refuse(!options.clip.empty(), "--clip", file.string(), "character files, with several clips")}) {
      if (!fine) return fine.error();
    }
    return readDepthMotion(file, options);
  }
  return isBvh(file) || isCharacterFile(file) ? readBones(file, options) : readJoints(file, options);
}

/// Its file; empty where there is none of that name.
fs::path shippedRecording(const fs::path& folder, const std::string& name) {
  std::error_code ignored;
  for (const char* extension : {".csv", ".oni"}) {
    fs::path file = folder / (name + extension);
    if (fs::exists(file, ignored)) return file;
  }
  return {};
}

Error onCharacter(const Motion& motion, const Character& character, const Error& error) {
  return {error.code, fmt::format("{} on {}: {}", motion.name, character.name, error.message)};
}

}  // namespace

JointSettings MotionOptions::joints() const {
  JointSettings settings;
  settings.mirror = mirror;
  if (smooth == "one-euro") settings.smoothing = oneEuro;
  return settings;
}

FaultSettings MotionOptions::faults() const {
  const Result<FaultSettings> faults = inject.empty() ? FaultSettings() : parseFaults(inject);
  CHECK(faults.ok(), "the option was checked when it was read");
  return *faults;
}

void addReadingOptions(CommandLine& app, MotionOptions& options) {
  std::vector<std::string> formats;
  formats.reserve(kJointFormatCount);
  for (int f = 0; f < kJointFormatCount; ++f) formats.emplace_back(nameOf(static_cast<JointFormat>(f)));
  const std::string names = fmt::format("{}", fmt::join(formats, ", "));
  app.addOption("--format", options.format,
                fmt::format("Layout of recorded joints, where the content does not tell: {}", names))
      ->typeName("NAME")
      ->check(oneOf(std::move(formats)));
  addCount(app, "--person", options.person, 1,
           "Of several in a stream of joints, or before a depth camera by the order of coming [default: the one that "
           "moves most; before a camera the nearest]");
  app.addOption("--clip", options.clip, "Of a file with several clips [default: the first]")->typeName("NAME");
}

void addPlayingOptions(CommandLine& app, MotionOptions& options) {
  app.addFlag("--mirror", options.mirror, "Left becomes right");
  app.addOption("--smooth", options.smooth,
                "Smooth joints as they come: off or one-euro; the delay is measured and printed [default: off]")
      ->typeName("NAME")
      ->check(oneOf({"off", "one-euro"}));
  addPositive(app, "--min-cutoff", options.oneEuro.minCutoff,
              fmt::format("One-euro's cutoff at rest [Hz]; lower is calmer [default: {:g}]", options.oneEuro.minCutoff),
              "HZ");
  addPositive(
      app, "--beta", options.oneEuro.beta,
      fmt::format("How much the cutoff rises with speed [1/m]; higher lags less [default: {:g}]", options.oneEuro.beta),
      "NUMBER");
}

void addFaultOption(CommandLine& app, MotionOptions& options) {
  const TextCheck check = [](std::string& text) -> std::string {
    const Result<FaultSettings> faults = parseFaults(text);
    return faults ? "" : faults.error().message;
  };
  app.addOption("--inject", options.inject,
                "Make faults in the joints as they come, each in a dose or its default: dropout=0.1 (share of joints "
                "lost), jitter=0.02 (metres), swap=0.02, late=0.05, freeze=0.05 (shares of frames); seed=1. A motion "
                "of bones knows late and freeze")
      ->typeName("FAULTS")
      ->check(check);
}

bool isBareName(const std::string& text) {
  std::error_code ignored;
  return text.find('/') == std::string::npos && !fs::path(text).has_extension() && !fs::exists(text, ignored);
}

fs::path shippedRecording(const std::string& name) {
  std::error_code ignored;
  const Result<fs::path> folder = recordingsFolder();
  return folder && !fs::exists(name, ignored) ? shippedRecording(*folder, name) : fs::path();
}

Result<fs::path> recordingsFolder() {
  std::error_code error;
  if (const std::string chosen = environment("LORICA_RECORDINGS"); !chosen.empty()) {
    if (fs::is_directory(chosen, error)) return fs::path(chosen);
    return Error{ErrorCode::kNotFound, fmt::format("LORICA_RECORDINGS={}: there is no such folder", chosen)};
  }
  const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path();
  // build/lorica, build/PRESET/lorica, and PREFIX/bin/lorica.
  for (const char* relative : {"../recordings", "../../recordings", "../share/lorica/recordings"}) {
    const fs::path folder = (program / relative).lexically_normal();
    if (fs::is_directory(folder, error)) return folder;
  }
  return Error{ErrorCode::kNotFound,
               fmt::format("the shipped recordings are not beside {} nor in ../share/lorica/recordings: set "
                           "LORICA_RECORDINGS to their folder",
                           program.string())};
}

std::string shippedNames(const fs::path& folder, const std::string& extension) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    if (entry.path().extension() == extension) names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return fmt::format("{}", fmt::join(names, ", "));
}

Result<Motion> readMotion(const std::string& pathOrName, const MotionOptions& options) {
  if (!isBareName(pathOrName)) return readMotionFile(pathOrName, options);
  const Result<fs::path> folder = recordingsFolder();
  if (!folder) return folder.error();
  const fs::path file = shippedRecording(*folder, pathOrName);
  if (file.empty()) {
    return Error{ErrorCode::kNotFound,
                 fmt::format("{}: no such file and no shipped recording of that name, expected a motion (joints, .bvh, "
                             ".oni, .glb, .vrm, .fbx, .dae) or one of {}, {}",
                             pathOrName, shippedNames(*folder, ".csv"), shippedNames(*folder, ".oni"))};
  }
  return readMotionFile(file, options);
}

Result<std::vector<Motion>> readShippedRecordings() {
  const Result<fs::path> folder = recordingsFolder();
  if (!folder) return folder.error();
  std::vector<Motion> motions;
  motions.reserve(kSyntheticMotionCount);
  for (int m = 0; m < kSyntheticMotionCount; ++m) {
    const std::string name(nameOf(static_cast<SyntheticMotion>(m)));
    Result<Motion> motion = readJoints(*folder / (name + ".csv"), {});
    if (!motion) return motion.error();
    motions.push_back(std::move(*motion));
  }
  return motions;
}

Result<const Clip*> findClip(std::span<const Clip> clips, const std::string& name, const std::string& source) {
  if (clips.empty()) {
    return Error{ErrorCode::kNotFound, source + ": no animation in it, expected at least one clip"};
  }
  if (name.empty()) return &clips.front();
  std::vector<std::string> names;
  names.reserve(clips.size());
  for (const Clip& clip : clips) {
    if (lowerCase(clip.name) == lowerCase(name)) return &clip;
    names.push_back(clip.name);
  }
  return Error{ErrorCode::kNotFound,
               fmt::format("{}: no clip named {}, expected one of {}", source, name, fmt::join(names, ", "))};
}

SkeletalMotion framesOf(const Skeleton& skeleton, const Clip& clip) {
  return sampleWhole(skeleton, clip, kClipRate);
}

Result<SkeletalMotion> performedBy(const Character& character, const Motion& motion, const MotionOptions& options) {
  const auto named = [&](Result<SkeletalMotion> performed) -> Result<SkeletalMotion> {
    if (!performed) return onCharacter(motion, character, performed.error());
    performed->name = motion.name;
    return performed;
  };
  if (!motion.bones) return named(perform(character, motion.joints, options.joints()));
  if (motion.fromCharacterFile && !options.mirror) {
    Result<SkeletalMotion> renamed = renameMotion(*motion.bones, character.skeleton);
    if (renamed) return named(std::move(renamed));
  }
  MotionRetargetSettings settings;
  settings.mirror = options.mirror;
  Result<StandInSkeleton> standIn = StandInSkeleton::create(character);
  if (!standIn) return named(standIn.error());
  Result<SkeletalMotion> performed = retargetMotion(*motion.bones, standIn->skeleton(), settings);
  if (!performed) return named(std::move(performed));
  return named(standIn->carryBack(std::move(*performed)));
}

Result<std::unique_ptr<PoseSource>> poseSourceOf(const Character& character, const Motion& motion,
                                                 const MotionOptions& options, std::shared_ptr<SourceLog> log) {
  const SourceTreatment treatment{std::move(log), options.faults(), options.joints()};
  if (!motion.bones) {
    Result<std::unique_ptr<PoseSource>> source =
        makeTreatedSource(character, makeRecordedSource(motion.joints), treatment);
    if (!source) return onCharacter(motion, character, source.error());
    return source;
  }
  Result<SkeletalMotion> performed = performedBy(character, motion, options);
  if (!performed) return performed.error();
  Result<std::unique_ptr<PoseSource>> source =
      makeTreatedSource(makeMotionPoseSource(std::move(*performed)), treatment);
  if (!source) return Error{source.error().code, "--inject: " + source.error().message};
  return source;
}

}  // namespace lorica
