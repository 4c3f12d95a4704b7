#include "session/prepare/read_motion.h"

#include "capture/files/bvh_file.h"
#include "capture/files/joint_csv.h"
#include "capture/retarget/skeletal_retarget.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "session/prepare/depth_motion.h"
#include "session/prepare/file_kinds.h"
#include "session/prepare/first_guess.h"
#include "session/prepare/smpl.h"
#include "session/prepare/stream_motion.h"
#include "session/prepare/subject.h"
#include "skinning/import/character_file.h"

#include <fmt/format.h>

#include <algorithm>

namespace lorica {
namespace {

namespace fs = std::filesystem;

bool isBvh(const fs::path& file) {
  return kindOf(file) == FileKind::kBvh;
}

/// An option that would have no effect on a kind of file.
struct Refused {
  bool given;
  const char* option;
  const char* what;  ///< that it is for
};

Result<void> refuse(const std::string& file, std::initializer_list<Refused> options) {
  for (const Refused& each : options) {
    if (!each.given) continue;
    return invalidArgument("{}: {} is for {}, which this file does not contain", file, each.option, each.what);
  }
  return {};
}

constexpr const char* kJointsOnly = "recorded joints";
constexpr const char* kClipsOnly = "character files with several clips";

Motion motionOf(JointStream stream, std::string name) {
  Motion motion;
  motion.name = std::move(name);
  motion.joints = std::move(stream.frames);
  motion.format = fmt::format("joints ({})", nameOf(stream.format));
  motion.notes = std::move(stream.notes);
  motion.people = std::move(stream.people);
  motion.firstGuess = firstGuessOf(std::move(stream.firstGuess), motion);
  return motion;
}

Result<Motion> readJoints(const fs::path& file, const MotionOptions& options) {
  LORICA_TRY_DO(refuse(file.string(), {{!options.clip.empty(), "--clip", "clips of skeletons"}}));
  JointStreamSettings settings;
  settings.format = options.format;
  if (options.person > 0) settings.person = options.person;
  Result<JointStream> read = readJointStream(file, settings);
  if (!read) return read.error().code == ErrorCode::kUnsupported ? withWhatOpens(read.error()) : read.error();
  return motionOf(*std::move(read), file.stem().string());
}

Result<Motion> readBones(const fs::path& file, const MotionOptions& options, Host& host) {
  LORICA_TRY_DO(refuse(file.string(), {{options.format.has_value(), "--format", kJointsOnly},
                                       {options.person != 0, "--person", kJointsOnly},
                                       {options.smooth != MotionOptions::Smoothing::kOff, "--smooth", kJointsOnly},
                                       {isBvh(file) && !options.clip.empty(), "--clip", kClipsOnly}}));
  Motion motion;
  motion.name = file.stem().string();
  if (isBvh(file)) {
    LORICA_TRY(const BvhRest rest, prefixed("--rest", parseBvhRest(options.rest)));
    LORICA_TRY(BvhFile read, readBvh(file, rest));
    motion.bones = std::move(read.motion);
    motion.format = "BVH";
    motion.notes = std::move(read.notes);
    motion.firstGuess = firstGuessOf(std::move(read.firstGuess), motion);
    return motion;
  }
  if (kindOf(file) == FileKind::kBodyModel) {
    LORICA_TRY_DO(refuse(file.string(), {{!options.clip.empty(), "--clip", kClipsOnly}}));
    return readSmplMotion(file);
  }
  LORICA_TRY(CharacterFile read, readPlayed(file.string(), host));
  LORICA_TRY(const Clip* clip, findClip(read.clips, options.clip, file.string()));
  if (!clip->name.empty()) motion.name += ": " + clip->name;
  LORICA_TRY(motion.bones, prefixed(file.string(), framesOf(read.character.skeleton, *clip)));
  motion.fromCharacterFile = read.format != "VRM animation 1.0";  // which is for any humanoid
  motion.format = read.format;
  motion.notes = std::move(read.notes);
  for (const Clip& found : read.clips) motion.clips.push_back(found.name);
  motion.firstGuess =
      firstGuessOf({"rest pose: the file's", fmt::format("{:g} m per unit", read.metresPerUnit), "Y is up"}, motion);
  return motion;
}

Result<Motion> readMotionFile(const fs::path& file, const MotionOptions& options, Host& host) {
  const FileKind kind = kindOf(file);
  const bool packets = kind == FileKind::kPackets;
  LORICA_TRY_DO(refuse(file.string(),
                       {{!options.sender.empty() && !packets, "--sender", "VMC packets"},
                        {!options.lens.empty() && kind != FileKind::kDepth, "--lens", "depth recordings"},
                        {!options.rest.empty() && kind != FileKind::kBvh, "--rest", "the rotations of a BVH file"}}));
  if (packets || kind == FileKind::kSession) {
    LORICA_TRY_DO(refuse(file.string(), {{options.format.has_value(), "--format", kJointsOnly},
                                         {options.person > 0 && packets, "--person", "recorded joints or sessions"},
                                         {!options.clip.empty(), "--clip", kClipsOnly}}));
    if (!packets) return readSessionMotion(file, options, host);
    LORICA_TRY(Motion motion, readPacketMotion(file, options, host));
    motion.firstGuess = firstGuessOf(
        {options.sender.empty() ? "rest pose: a T-pose, as the protocol says" : "rest pose: that of --sender", "metres",
         "Y is up"},
        motion);
    return motion;
  }
  if (kind == FileKind::kDepth) {
    LORICA_TRY_DO(refuse(file.string(), {{options.format.has_value(), "--format", kJointsOnly},
                                         {!options.clip.empty(), "--clip", kClipsOnly}}));
    return readDepthMotion(file, options, host);
  }
  const bool bones = kind == FileKind::kBvh || kind == FileKind::kCharacter || kind == FileKind::kBodyModel;
  return bones ? readBones(file, options, host) : readJoints(file, options);
}

/// The file of a shipped recording; empty if there is none.
fs::path shippedRecording(const fs::path& folder, const std::string& name) {
  std::error_code ignored;
  for (const char* extension : {".csv", ".oni"}) {
    fs::path file = folder / (name + extension);
    if (fs::exists(file, ignored)) return file;
  }
  return {};
}

}  // namespace

JointSettings MotionOptions::joints() const {
  JointSettings settings;
  settings.mirror = mirror;
  settings.upperBody = upperBody;
  if (smooth == Smoothing::kOneEuro) settings.smoothing = oneEuro;
  return settings;
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
    return notFound("LORICA_RECORDINGS={}: no such folder", chosen);
  }
  const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path();
  // build/lorica, build/PRESET/lorica, and PREFIX/bin/lorica.
  for (const char* relative : {"../recordings", "../../recordings", "../share/lorica/recordings"}) {
    const fs::path folder = (program / relative).lexically_normal();
    if (fs::is_directory(folder, error)) return folder;
  }
  return notFound(
      "the shipped recordings were not found next to {} or in ../share/lorica/recordings: set LORICA_RECORDINGS to "
      "their folder",
      program.string());
}

std::vector<std::string> shippedNames(const fs::path& folder, std::initializer_list<const char*> extensions) {
  std::vector<std::string> all;
  for (const char* extension : extensions) {
    const auto first = static_cast<std::ptrdiff_t>(all.size());
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
      if (entry.path().extension() == extension) all.push_back(entry.path().stem().string());
    }
    std::sort(all.begin() + first, all.end());
  }
  return all;
}

std::string shippedNames(const fs::path& folder, std::initializer_list<const char*> extensions,
                         const std::string& asked) {
  const std::vector<std::string> all = shippedNames(folder, extensions);
  return fmt::format("{}{}", fmt::join(all, ", "), didYouMean(asked, all));
}

namespace {

/// A path as it is, or the file of a shipped recording.
Result<fs::path> motionFile(const std::string& pathOrName) {
  if (!isBareName(pathOrName)) {
    LORICA_TRY_DO(refuseOtherKinds(pathOrName));
    const FileKind kind = kindOf(pathOrName);
    const bool shape = kind == FileKind::kMesh || kind == FileKind::kDecomposition;
    if (!shape && kind != FileKind::kScene) return fs::path(pathOrName);
    return invalidArgument("{}: found a {}, expected a motion", pathOrName,
                           kind == FileKind::kMesh    ? "mesh"
                           : kind == FileKind::kScene ? "scene"
                                                      : "decomposition");
  }
  LORICA_TRY(const fs::path folder, recordingsFolder());
  const fs::path file = shippedRecording(folder, pathOrName);
  if (file.empty()) {
    return notFound(
        "{}: no such file and no shipped recording with that name, expected a motion (joints, .bvh, .oni, .glb, .vrm, "
        ".fbx, .dae) or one of {}",
        pathOrName, shippedNames(folder, {".csv", ".oni"}, pathOrName));
  }
  return file;
}

}  // namespace

Result<Motion> readMotion(const std::string& pathOrName, const MotionOptions& options, Host& host) {
  const Result<fs::path> found = motionFile(pathOrName);
  if (!found && environment("LORICA_RECORDINGS").empty()) {
    // A program that uses the library may have no recordings.
    if (std::optional<Motion> shipped = shippedMotion(pathOrName)) return *std::move(shipped);
  }
  LORICA_TRY(const fs::path file, found);
  if (options.person == kEveryone) {
    return invalidArgument(
        "{}: found --person all, expected the number of one person; `lorica play` and `lorica record` show all",
        pathOrName);
  }
  return readMotionFile(file, options, host);
}

Result<std::vector<Motion>> readEveryone(const std::string& pathOrName, const MotionOptions& options, Host& host) {
  LORICA_TRY(const fs::path file, motionFile(pathOrName));
  const FileKind kind = kindOf(file);
  if (kind != FileKind::kDepth && kind != FileKind::kJoints && kind != FileKind::kUnknown) {
    return refuse(file.string(), {{true, "--person", kJointsOnly}}).error();
  }
  LORICA_TRY_DO(refuse(file.string(), {{!options.clip.empty(), "--clip", "clips of skeletons"}}));
  if (kind == FileKind::kDepth) return readDepthMotionOfAll(file, options.lens, host);
  JointStreamSettings settings;
  settings.format = options.format;
  LORICA_TRY(std::vector<JointStream> streams, readJointStreamOfAll(file, settings));
  std::vector<Motion> motions;
  for (std::size_t i = 0; i < streams.size(); ++i) {
    std::string name = file.stem().string();
    if (streams.size() > 1) name += fmt::format(": person {}", streams[i].people[i]);
    motions.push_back(motionOf(std::move(streams[i]), std::move(name)));
  }
  return motions;
}

std::optional<Motion> shippedMotion(const std::string& name) {
  const std::string_view text = shippedText(name);
  if (text.empty()) return std::nullopt;
  return motionOf(parseJointStream(text, name).value(), name);
}

std::vector<Motion> shippedMotions() {
  std::vector<Motion> motions;
  motions.reserve(std::size(kShippedMotions));
  for (const std::string_view name : kShippedMotions) motions.push_back(*shippedMotion(std::string(name)));
  return motions;
}

Result<const Clip*> findClip(std::span<const Clip> clips, const std::string& name, const std::string& source) {
  if (clips.empty()) {
    return notFound("{0}: found no animation, expected at least one clip; `lorica info {0}` says what it holds",
                    source);
  }
  if (name.empty()) return &clips.front();
  std::vector<std::string> names;
  names.reserve(clips.size());
  for (const Clip& clip : clips) {
    if (lowerCase(clip.name) == lowerCase(name)) return &clip;
    names.push_back(clip.name);
  }
  return notFound("{}: no clip named {}, expected one of {}", source, name, fmt::join(names, ", "));
}

Result<std::unique_ptr<PoseSource>> poseSourceOf(const Character& character, const Motion& motion,
                                                 const MotionOptions& options, std::shared_ptr<SourceLog> log) {
  Result<std::unique_ptr<PoseSource>> source =
      poseSourceOf(character, motion, {std::move(log), options.inject, options.joints()});
  return motion.bones && options.inject.any() ? prefixed("--inject", std::move(source)) : std::move(source);
}

}  // namespace lorica
