#include "session/prepare/cast.h"

#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "session/prepare/recorded_cast.h"
#include "session/prepare/scenes.h"
#include "session/scenes/demo_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace lorica {
namespace {

void addClips(const std::vector<std::string>& clips, const std::string& played, CastChoices& choices) {
  if (clips.size() < 2) return;
  choices.clips = clips;
  const auto same = [&](const std::string& clip) { return lowerCase(clip) == lowerCase(played); };
  const auto found = std::find_if(clips.begin(), clips.end(), same);
  if (found != clips.end()) choices.clip = found - clips.begin();
}

void addPeople(const std::vector<int>& people, int followed, CastChoices& choices) {
  if (people.size() < 2) return;
  for (const int person : people) {
    if (person == followed) choices.person = countOf(choices.people);
    choices.people.push_back(std::to_string(person));
  }
  if (followed == kEveryone) choices.person = -1;
}

/// Who is followed in a recording of several people.
int followedIn(const Motion& motion, bool session, int given) {
  if (given != 0) return given;
  return session ? 1 : motion.joints.front().user;
}

}  // namespace

std::vector<std::filesystem::path> CastRequest::files() const {
  std::vector<std::filesystem::path> files{body.decomposition};
  for (const std::string* names : {&motion, &character}) {
    for (const std::string& name : namesIn(*names)) files.emplace_back(name);
  }
  return files;
}

std::vector<std::string> namesIn(const std::string& text) {
  std::error_code ignored;
  std::vector<std::string> names;
  if (std::filesystem::exists(text, ignored)) return {text};
  std::size_t begin = 0;
  while (true) {
    const std::size_t end = text.find(',', begin);
    names.push_back(text.substr(begin, end == std::string::npos ? end : end - begin));
    if (end == std::string::npos) return names;
    begin = end + 1;
  }
}

std::optional<SpringChoice> chooseSprings(const Subject& subject, const std::string& mode) {
  if (!subject.file || subject.file->springs.empty()) return std::nullopt;
  const SpringBones& springs = subject.file->springs;
  SpringChoice choice{springs, springModeNamed(mode).value_or(usualSpringMode(springs))};
  if (choice.mode == SpringMode::kNone && springs.constraints.empty()) return std::nullopt;
  return choice;
}

Result<void> addAvatar(Session& session, const PreparedAvatar& avatar, std::unique_ptr<PoseSource> source) {
  const DecompositionFile& body = avatar.body;
  LORICA_TRY(SessionAvatar made, SessionAvatar::create(avatar.character(), body.decomposition, std::move(source),
                                                       body.cover, body.training));
  if (const auto place = placeOf(avatar.setting.place, avatar.setting.heading)) made.setPlace(*place);
  const int index = session.addAvatar(std::move(made));
  return avatar.springs ? session.setSprings(avatar.springs->springs, avatar.springs->mode, index) : Result<void>();
}

Result<std::vector<std::unique_ptr<PoseSource>>> openSources(const Cast& cast, const MotionOptions& performing,
                                                             const SessionRecorder* recorder) {
  std::vector<std::unique_ptr<PoseSource>> sources;
  for (std::size_t i = 0; i < cast.avatars.size(); ++i) {
    LORICA_TRY(auto source,
               cast.sources->open(cast.avatars[i], i, performing, recorder != nullptr ? recorder->log(i) : nullptr));
    sources.push_back(std::move(source));
  }
  return sources;
}

Result<Session> startSession(Cast& cast, const SessionRecorder* recorder) {
  LORICA_TRY(auto sources, openSources(cast, cast.request.performing, recorder));
  Session session(std::move(cast.world));
  for (std::size_t i = 0; i < sources.size(); ++i) {
    LORICA_TRY_DO(addAvatar(session, cast.avatars[i], std::move(sources[i])));
  }
  return session;
}

namespace {

AvatarRecord recordOf(const std::string& file, const CastRequest& request, const PreparedAvatar& avatar) {
  AvatarRecord record;
  record.source = avatar.source;
  record.poseJoints = avatar.poses ? avatar.character().skeleton.jointCount() : 0;
  record.poseTrust = record.poseExpressions = avatar.stream;
  const std::string& character = avatar.setting.character;
  record.character = character.empty() ? "mannequin" : isShippedName(character) ? character : nameFrom(file, character);
  record.boneMap = nameFrom(file, request.reading.map);
  record.bodyResolution = request.reading.bodyResolution;
  if (request.reading.walls) record.walls = nameOf(*request.reading.walls);
  record.thickness = request.reading.thickness;
  record.expressions = request.reading.expressions;
  record.hidden = request.reading.hidden;
  record.clip = avatar.ownClip;
  record.characterHash = hashOf(avatar.character());
  record.decomposition = nameFrom(file, request.body.decomposition);
  record.decompositionHash = hashOf(avatar.body.decomposition);
  record.coverTolerance = request.body.cover.tolerance;
  record.hullVertices = request.body.cover.hullVertices;
  record.coverHash = hashOf(avatar.body.cover);
  record.trainingHash = hashOf(avatar.body.training);
  // A motion of bones is recorded after retargeting: it is already mirrored, and never smoothed.
  if (!avatar.poses) record.joints = request.performing.joints();
  record.faults = request.performing.inject;
  record.place = avatar.setting.place;
  record.heading = avatar.setting.heading;
  record.color = avatar.setting.color;
  if (avatar.springs) {
    record.springs = avatar.springs->mode;
    record.springsHash = hashOf(avatar.springs->springs);
  }
  return record;
}

}  // namespace

Result<std::shared_ptr<SessionRecorder>> startRecorder(const std::string& file, const Cast& cast, Host& host) {
  if (file.empty()) return std::shared_ptr<SessionRecorder>();
  if (const std::vector<std::string>& meshes = cast.request.meshes; !meshes.empty()) {
    return invalidArgument("{}: a session holds no props that were dropped; expected {} in a scene", file,
                           meshes.front());
  }
  const std::string& scene = cast.request.scene;
  LORICA_TRY(const SceneText text, readSceneText(scene, host));
  SessionHeader header;
  header.avatars.clear();
  for (const PreparedAvatar& avatar : cast.avatars) header.avatars.push_back(recordOf(file, cast.request, avatar));
  header.scene = scene;
  if (!isBareName(scene)) header.sceneFolder = nameFrom(file, text.folder.empty() ? "." : text.folder.string());
  header.sceneSeed = scene.empty() ? kDemoSeed : 0;
  header.worldHash = hashOf(cast.world);
  LORICA_TRY(std::shared_ptr<SessionRecorder> recorder, SessionRecorder::start(file, header, text.text));
  warnOfFound(recorder->found(), host);
  return recorder;
}

void warnOfFound(const std::optional<std::filesystem::path>& found, Host& host) {
  if (!found) return;
  host.warn(fmt::format("found the recording of a program that was killed; it is kept as {}", found->string()));
}

void addProps(std::span<const Prop> props, World& world) {
  for (const Prop& prop : props) {
    if (countOf(world.props()) < World::kMaxProps) world.addProp(prop);
  }
}

CastChoices choicesOf(const CastRequest& request, std::span<const PreparedAvatar> avatars) {
  CastChoices choices;
  const int person = request.performing.person;
  const bool named = !request.motion.empty() || !request.character.empty();
  if (!named || avatars.empty() || (avatars.size() > 1 && person != kEveryone)) return choices;
  const PreparedAvatar& first = avatars.front();
  std::vector<std::string> clips = first.motion->clips;
  if (first.ownClip && first.subject.file) {
    for (const Clip& clip : first.subject.file->clips) clips.push_back(clip.name);
  }
  addClips(clips, request.performing.clip, choices);
  if (first.motion->people.empty()) return choices;
  const bool session = lowerCase(std::filesystem::path(request.motion).extension().string()) == ".lsession";
  addPeople(first.motion->people, followedIn(*first.motion, session, person), choices);
  choices.everyone = !session;
  return choices;
}

}  // namespace lorica
