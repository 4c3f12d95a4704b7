#include "apps/session_files.h"

#include "apps/file_trust.h"
#include "geometry/errors.h"
#include "session/demo_scene.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <system_error>

namespace lorica {

namespace fs = std::filesystem;

namespace {

/// Whether it is the name of what ships, such as "mannequin" or "bowling", and no file.
bool isShippedName(const std::string& name) {
  return name.find('/') == std::string::npos && !fs::path(name).has_extension();
}

/// A name for the header: relative to the folder of the session, so that both can be moved together.
std::string nameFor(const std::string& session, const std::string& file) {
  if (file.empty()) return file;
  std::error_code error;
  const fs::path folder = fs::path(session).has_parent_path() ? fs::path(session).parent_path() : fs::path(".");
  const fs::path relative = fs::relative(file, folder, error);
  return error || relative.empty() ? file : relative.string();
}

}  // namespace

void addRecordOption(CommandLine& app, std::string& file) {
  app.addOption("--record", file, "Record the session, for `lorica replay`")->typeName("FILE.lsession");
}

void sayFound(const std::optional<std::filesystem::path>& found) {
  if (!found) return;
  warn(fmt::format("found the recording of a program that was killed; it is kept as {}", found->string()));
}

Result<void> checkRecord(const std::string& option, const std::string& file) {
  return file.empty() ? Result<void>() : checkOutput(option, file, ".lsession");
}

Result<SessionInputs> inputsOf(const SessionFile& recorded, const std::string& session, std::size_t avatar,
                               const std::string& character, const std::string& decomposition) {
  const AvatarHeader& header = recorded.header.avatar(avatar);
  const SessionHeader& whole = recorded.header;
  const NamedFiles beside{fs::path(session).parent_path(), pathTrust()};
  Result<void> done;
  const auto find = [&](const std::string& name, const char* what, const char* instead) -> std::string {
    if (!done || name.empty()) return name;
    const Result<fs::path> file = beside.find(name);
    std::error_code ignored;
    const fs::file_type type = file ? fs::status(*file, ignored).type() : fs::file_type::none;
    const bool special = type == fs::file_type::fifo || type == fs::file_type::socket;  // opening one may wait
    if (file && !special) return file->string();
    const std::string why = file ? fmt::format("{} is no regular file", file->string()) : file.error().message;
    done = badFormat("{}: the recorded {}: {}{}", session, what, why, instead);
    return {};
  };
  SessionInputs inputs;
  inputs.character = !character.empty() ? character
                     : isShippedName(header.character)
                         ? header.character
                         : find(header.character, "character", "; --character gives its file");
  inputs.boneMap = find(header.boneMap, "bone map", "");
  inputs.decomposition = decomposition.empty()
                             ? find(header.decomposition, "decomposition", "; --decomposition gives its file")
                             : decomposition;
  inputs.scene = {recorded.sceneText, {}, pathTrust()};
  if (isShippedName(whole.scene) && !whole.scene.empty()) {
    LORICA_TRY(inputs.scene.folder, scenesFolder());
  } else if (!whole.scene.empty()) {
    inputs.scene.folder = find(whole.sceneFolder.empty() ? "." : whole.sceneFolder, "folder of the scene", "");
  }
  if (!done) return done.error();
  return inputs;
}

namespace {

AvatarHeader headerOf(const std::string& file, const RecordedAvatar& avatar) {
  const RecordedAs& as = avatar.as;
  AvatarHeader header;
  header.source = as.source;
  header.poseJoints = as.poses ? avatar.performer.skeleton.jointCount() : 0;
  header.poseTrust = as.stream;
  header.poseExpressions = as.stream;
  header.character = as.character.empty() ? "mannequin" : as.character;
  if (!isShippedName(header.character)) header.character = nameFor(file, header.character);
  header.boneMap = nameFor(file, as.reading.map);
  header.bodyResolution = as.reading.bodyResolution;
  header.expressions = as.reading.expressions;
  header.hidden = as.reading.hidden;
  header.clip = as.clip;
  header.characterHash = hashOf(avatar.performer);
  header.decomposition = nameFor(file, as.body.decomposition);
  header.decompositionHash = hashOf(avatar.body.decomposition);
  header.coverTolerance = as.body.cover.tolerance;
  header.hullVertices = as.body.cover.hullVertices;
  header.coverHash = hashOf(avatar.body.cover);
  header.trainingHash = hashOf(avatar.body.training);
  // A motion of bones is recorded after retargeting: it is already mirrored, and never smoothed.
  if (!as.poses) header.joints = as.performing.joints();
  header.faults = as.performing.faults();
  header.place = as.place;
  header.heading = as.heading;
  header.color = as.color;
  if (as.springs) {
    header.springs = as.springs->mode;
    header.springsHash = hashOf(as.springs->springs);
  }
  return header;
}

}  // namespace

Result<std::shared_ptr<SessionRecorder>> startRecorder(const std::string& file, std::span<const RecordedAvatar> avatars,
                                                       const std::string& scene, const World& world) {
  if (file.empty()) return std::shared_ptr<SessionRecorder>();
  LORICA_TRY(const SceneText text, readSceneText(scene));
  SessionHeader header;
  header.avatars.clear();
  for (const RecordedAvatar& avatar : avatars) header.avatars.push_back(headerOf(file, avatar));
  header.scene = scene;
  if (!isBareName(scene)) header.sceneFolder = nameFor(file, text.folder.empty() ? "." : text.folder.string());
  header.sceneSeed = scene.empty() ? kDemoSeed : 0;
  header.worldHash = hashOf(world);
  Result<std::shared_ptr<SessionRecorder>> recorder = SessionRecorder::start(file, header, text.text);
  if (recorder) sayFound((*recorder)->found());
  return recorder;
}

Result<void> finishRecorder(const std::shared_ptr<SessionRecorder>& recorder, const std::string& file, Report& report,
                            nlohmann::ordered_json& json) {
  if (!recorder) return {};
  LORICA_TRY(const int steps, recorder->finish());
  report.line("recorded", steps == 0 ? "no steps" : fmt::format("{} in {}", counted(steps, "step"), file));
  if (recorder->cutShort()) {
    report.note("The recording ends at the restart of the session, or at the change of its scene or number of parts.");
  }
  json["recorded"] = steps;
  return {};
}

}  // namespace lorica
