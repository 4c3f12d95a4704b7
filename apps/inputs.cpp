#include "apps/inputs.h"

#include "apps/report.h"
#include "capture/joint_csv.h"
#include "capture/synthetic_motion.h"
#include "geometry/mesh_files.h"
#include "geometry/mesh_repair.h"
#include "session/keyframes.h"
#include "skinning/mannequin.h"

#include <fmt/format.h>

#include <algorithm>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMannequin = "mannequin";
constexpr double kLikeEnough = 0.02;  // of the character's height: poses that need no keyframe each

/// The names that `play NAME` understands: "jumping_jacks, walk, ...".
std::string shippedNames(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    if (entry.path().extension() == ".csv") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return fmt::format("{}", fmt::join(names, ", "));
}

Result<Recording> readRecordingFile(const fs::path& file) {
  Result<std::vector<SkeletonFrame>> frames = readJointCsv(file);
  if (!frames) return frames.error();
  return Recording{file.stem().string(), std::move(*frames)};
}

/// A word without folder or extension, that names no file here, can only mean a shipped recording.
bool isBareName(const std::string& text) {
  std::error_code ignored;
  return text.find('/') == std::string::npos && !fs::path(text).has_extension() && !fs::exists(text, ignored);
}

}  // namespace

Result<Subject> readSubject(const std::string& input) {
  if (input == kMannequin) {
    Result<Character> character = findCharacter(input);
    if (!character) return character.error();
    TriMesh mesh = character->mesh;
    return Subject{input, std::move(mesh), std::move(*character), ""};
  }
  std::error_code ignored;
  if (isBareName(input)) {
    return Error{ErrorCode::kNotFound,
                 fmt::format("{}: no such file and no character of that name, expected a mesh (.off, .obj, .ply, .stl) "
                             "or {}",
                             input, kMannequin)};
  }
  Result<TriMesh> mesh = readMesh(input);
  if (!mesh) return mesh.error();
  Subject subject{fs::path(input).filename().string(), std::move(*mesh), std::nullopt, ""};
  if (Result<MeshRepair> repair = repairClosedMesh(subject.mesh); repair && repair->changed()) {
    subject.mended = repair->summary();
    subject.mesh = std::move(repair->mesh);
  }
  return subject;
}

Result<Character> findCharacter(const std::string& name) {
  if (name == kMannequin) return makeMannequin();
  return Error{ErrorCode::kNotFound, fmt::format("{}: no character of that name, expected {}", name, kMannequin)};
}

Result<std::filesystem::path> recordingsFolder() {
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

Result<Recording> readRecording(const std::string& pathOrName) {
  if (!isBareName(pathOrName)) return readRecordingFile(pathOrName);
  const Result<fs::path> folder = recordingsFolder();
  if (!folder) return folder.error();
  const fs::path file = *folder / (pathOrName + ".csv");
  std::error_code ignored;
  if (!fs::exists(file, ignored)) {
    return Error{ErrorCode::kNotFound, fmt::format("{}: no such file and no shipped recording of that name, expected "
                                                   "a joint CSV or one of {}",
                                                   pathOrName, shippedNames(*folder))};
  }
  return readRecordingFile(file);
}

Result<std::vector<Recording>> readShippedRecordings() {
  const Result<fs::path> folder = recordingsFolder();
  if (!folder) return folder.error();
  std::vector<Recording> recordings;
  for (int motion = 0; motion < kSyntheticMotionCount; ++motion) {
    const std::string name(nameOf(static_cast<SyntheticMotion>(motion)));
    Result<Recording> recording = readRecordingFile(*folder / (name + ".csv"));
    if (!recording) return recording.error();
    recordings.push_back(std::move(*recording));
  }
  return recordings;
}

Result<std::vector<Recording>> readMotions(std::span<const std::string> motions) {
  if (motions.empty()) return readShippedRecordings();
  std::vector<Recording> recordings;
  recordings.reserve(motions.size());
  for (const std::string& motion : motions) {
    Result<Recording> recording = readRecording(motion);
    if (!recording) return recording.error();
    recordings.push_back(std::move(*recording));
  }
  return recordings;
}

Result<Keyframes> trainingKeyframes(const Character& character, std::span<const Recording> motions, int count) {
  std::vector<std::vector<SkeletonFrame>> frames;
  frames.reserve(motions.size());
  for (const Recording& recording : motions) frames.push_back(recording.frames);
  if (count == kChooseKeyframes) {
    Result<ChosenKeyframes> found =
        chooseKeyframes(character, frames, kDefaultKeyframes, kLikeEnough * character.height);
    if (!found) return found.error();
    Keyframes keyframes{std::move(found->positions), static_cast<int>(found->sources.size()), {}, found->farthest};
    keyframes.chosen.reserve(found->sources.size());
    for (const KeyframeSource& source : found->sources) {
      keyframes.chosen.push_back({motions[source.recording].name, source.frame, source.time});
    }
    return keyframes;
  }
  std::size_t frameCount = 0;
  for (const std::vector<SkeletonFrame>& recording : frames) frameCount += recording.size();
  if (static_cast<std::size_t>(count) > frameCount) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("--keyframes: found {}, expected at most {}, the number of frames to choose from", count,
                             frameCount)};
  }
  Result<std::vector<Vec3>> positions = sampleKeyframes(character, frames, count);
  if (!positions) return positions.error();
  return Keyframes{std::move(*positions), count, {}, 0.0};
}

}  // namespace lorica
