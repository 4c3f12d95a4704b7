#include "session/prepare/recorded_cast.h"

#include "collision/hulls/cover_choice.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "session/recording/session_replay.h"
#include "skinning/look/avatar.h"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

namespace lorica {
namespace {

class RecordedSources final : public CastSources {
 public:
  RecordedSources(std::string file, std::shared_ptr<const SessionFile> session)
      : file_(std::move(file)), session_(std::move(session)) {}
  Result<std::unique_ptr<PoseSource>> open(const PreparedAvatar& avatar, std::size_t index,
                                           const MotionOptions& /*performing*/,
                                           std::shared_ptr<SourceLog> /*log*/) override {
    return prefixed(file_, SessionReplay::source(*session_, avatar.character(), index));
  }

 private:
  std::string file_;
  std::shared_ptr<const SessionFile> session_;
};

/// The recorded character, or the one of the request.
Result<Subject> findCharacter(const RecordedRequest& request, const AvatarRecord& record, const SessionInputs& inputs,
                              Host& host) {
  LORICA_TRY(CharacterOptions reading, readingOf(inputs, record));
  reading.drawn = request.drawn;
  reading.textureSize = request.textureSize;
  reading.expressions = record.expressions;
  reading.ownClip = record.clip;
  Result<Subject> subject = readCharacter(inputs.character, reading, host);
  if (!subject && request.character.empty()) {
    return Error{subject.error().code,
                 fmt::format("{}: the recorded character {} cannot be read ({}): give its file with --character",
                             request.file, record.character, subject.error().message)};
  }
  if (subject && hashOf(*subject->character) != record.characterHash) {
    return invalidArgument(
        "{}: recorded with the character {}, but {} has a different mesh, skeleton or weights: give the recorded "
        "character with --character",
        request.file, record.character, subject->name);
  }
  return subject;
}

/// The recorded decomposition and cover: the file of the request, the recorded file, or the default one.
Result<DecompositionFile> findBody(const RecordedRequest& request, const AvatarRecord& record,
                                   const SessionInputs& inputs, const Subject& subject, Host& host) {
  BodyOptions body;
  body.decomposition = inputs.decomposition;
  body.cover.tolerance = record.coverTolerance;
  body.cover.hullVertices = record.hullVertices;
  LORICA_TRY_DO(prefixed(request.file, checkCover(body.cover, *subject.character)));
  Result<DecompositionFile> file = chooseBody(body, subject, host);
  if (!file && request.decomposition.empty() && !record.decomposition.empty()) {
    return Error{file.error().code,
                 fmt::format("{}: the recorded decomposition {} cannot be read ({}): give its file with "
                             "--decomposition",
                             request.file, record.decomposition, file.error().message)};
  }
  if (file && hashOf(file->cover) != record.coverHash) {
    return invalidArgument("{}: the hull cover differs from the recording", request.file);
  }
  return file;
}

/// @param inputs  gets the files that the avatar needs
Result<PreparedAvatar> findAvatar(RecordedRequest request, const SessionFile& session, std::size_t index,
                                  SessionInputs& inputs, Host& host) {
  const AvatarRecord& record = session.header.avatar(index);
  if (index > 0) request.character = request.decomposition = "";
  LORICA_TRY(inputs, inputsOf(session, request.file, index, request.character, request.decomposition, host));
  PreparedAvatar avatar;
  avatar.source = record.source;
  avatar.poses = record.poseJoints > 0;
  avatar.stream = record.poseTrust;
  avatar.setting.character = record.character;
  avatar.setting.place = record.place;
  avatar.setting.heading = record.heading;
  avatar.setting.color = record.color;
  LORICA_TRY(avatar.subject, findCharacter(request, record, inputs, host));
  std::shared_ptr<const Avatar>& look = avatar.subject.character->avatar;
  if (record.color && look != nullptr) look = tinted(*look, *record.color);
  LORICA_TRY(avatar.body, findBody(request, record, inputs, avatar.subject, host));
  if (record.springs) {
    avatar.springs = {avatar.subject.file ? avatar.subject.file->springs : SpringBones(), *record.springs};
  }
  return avatar;
}

}  // namespace

namespace fs = std::filesystem;

bool isShippedName(const std::string& name) {
  return name.find('/') == std::string::npos && !fs::path(name).has_extension();
}

std::string nameFrom(const std::string& session, const std::string& file) {
  if (file.empty()) return file;
  std::error_code error;
  const fs::path folder = fs::path(session).has_parent_path() ? fs::path(session).parent_path() : fs::path(".");
  const fs::path relative = fs::relative(file, folder, error);
  return error || relative.empty() ? file : relative.string();
}

Result<CharacterOptions> readingOf(const SessionInputs& inputs, const AvatarRecord& record) {
  CharacterOptions reading{inputs.boneMap, record.bodyResolution};
  reading.walls = wallChoiceNamed(record.walls);
  if (!reading.walls && !record.walls.empty()) {
    return invalidArgument("walls of the character: found {}, expected auto, solid or shell",
                           firstBytes(record.walls, 40));
  }
  reading.thickness = record.thickness;
  reading.hidden = record.hidden;
  return reading;
}

Result<SessionInputs> inputsOf(const SessionFile& recorded, const std::string& session, std::size_t avatar,
                               const std::string& character, const std::string& decomposition, const Host& host) {
  const AvatarRecord& header = recorded.header.avatar(avatar);
  const SessionHeader& whole = recorded.header;
  const NamedFiles nearby{fs::path(session).parent_path(), host.paths};
  Result<void> done;
  const auto find = [&](const std::string& name, const char* what, const char* instead) -> std::string {
    if (!done || name.empty()) return name;
    const Result<fs::path> file = nearby.find(name);
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
  inputs.scene = {recorded.sceneText, {}, host.paths};
  if (isShippedName(whole.scene) && !whole.scene.empty()) {
    LORICA_TRY(inputs.scene.folder, scenesFolder());
  } else if (!whole.scene.empty()) {
    inputs.scene.folder = find(whole.sceneFolder.empty() ? "." : whole.sceneFolder, "folder of the scene", "");
  }
  if (!done) return done.error();
  return inputs;
}

Result<RecordedCast> prepareRecordedCast(const RecordedRequest& request, Host& host) {
  LORICA_TRY(SessionFile read, readSession(request.file));
  auto session = std::make_shared<const SessionFile>(std::move(read));
  const std::vector<AvatarRecord>& records = session->header.avatars;
  std::vector<PreparedAvatar> avatars;
  std::vector<std::string> names;
  SceneText scene;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const Stage stage(host, double(i) / double(records.size()), double(i + 1) / double(records.size()));
    SessionInputs inputs;
    LORICA_TRY(PreparedAvatar avatar, findAvatar(request, *session, i, inputs, host));
    if (i == 0) scene = std::move(inputs.scene);
    avatars.push_back(std::move(avatar));
    names.push_back(records[i].source);
  }
  LORICA_TRY(World world, worldOf(scene, session->header.scene, host));
  Cast cast{CastRequest(), std::move(world), targetsOf(scene, session->header.scene, host), std::move(avatars)};
  cast.request.reading.expressions = records.front().expressions;
  cast.sources = std::make_shared<RecordedSources>(request.file, session);
  cast.name = records.front().source.empty() ? request.file : listed(names);
  cast.seconds = session->steps.back().time - session->steps.front().time;
  return RecordedCast{std::move(cast), std::move(session), std::move(scene)};
}

}  // namespace lorica
