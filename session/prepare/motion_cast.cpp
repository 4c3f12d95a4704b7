#include "geometry/work_budgets.h"
#include "session/prepare/cast.h"

#include "capture/retarget/proxy_skeleton.h"
#include "capture/retarget/skeletal_retarget.h"
#include "collision/hulls/cover_choice.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "session/prepare/file_kinds.h"
#include "session/prepare/scenes.h"
#include "skinning/look/avatar.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

namespace lorica {
namespace {

constexpr double kReading = 0.4;  // of the work of preparing avatars; the rest decomposes them
constexpr double kSpacing = 1.2;  // between avatars that stand next to each other [m]
constexpr std::size_t kMaxClipsNamed = 6;
constexpr int kStandingFrames = 120;  // of a character without clips

/// What an avatar is to perform.
struct Role {
  AvatarSetting setting;
  std::optional<Motion> motion = {};  // none = the one that the setting names
  std::string where = {};             // begins its errors: "duel: avatars[1]: "
};

class MotionSources final : public CastSources {
 public:
  Result<std::unique_ptr<PoseSource>> open(const PreparedAvatar& avatar, std::size_t /*index*/,
                                           const MotionOptions& performing, std::shared_ptr<SourceLog> log) override {
    return poseSourceOf(avatar.character(), *avatar.motion, performing, std::move(log));
  }
};

/// Leaves out what a motion has before a time. @param start  [s], since its first frame, at most its duration
void startAt(double start, Motion& motion) {
  const double first = motion.firstTime() + start;
  if (!motion.bones) {
    std::erase_if(motion.joints, [&](const SkeletonFrame& frame) { return frame.time < first; });
    return;
  }
  SkeletalMotion& bones = *motion.bones;
  const auto skipped = std::lower_bound(bones.times.begin(), bones.times.end(), first) - bones.times.begin();
  bones.times.erase(bones.times.begin(), bones.times.begin() + skipped);
  bones.poses.erase(bones.poses.begin(), bones.poses.begin() + skipped * bones.skeleton.jointCount());
}

/// The names of the character's own clips: "Survey, Walk, Run".
std::string clipsOf(const CharacterFile& file) {
  std::vector<std::string> names;
  for (const Clip& clip : file.clips) {
    if (!clip.name.empty()) names.push_back(clip.name);
  }
  const std::size_t more = names.size() - std::min(names.size(), kMaxClipsNamed);
  names.resize(names.size() - more);
  std::string text = fmt::format("{}", fmt::join(names, ", "));
  return more == 0 ? text : fmt::format("{} and {} more", text, more);
}

/// Rejects a motion that the character cannot perform. If it is not a humanoid but has its own clips, the error lists
/// them.
Result<void> checkCharacter(const Motion& motion, const CharacterFile& file, const std::string& asGiven,
                            const JointSettings& settings) {
  const Result<void> able = checkPerformed(file.character, motion, settings);
  if (able || file.clips.empty() || canPerform(file.character)) return able;
  const std::string clips = clipsOf(file);
  return invalidArgument(
      "{} on {}: found a motion of {}, expected one of the character's own clips{}, because its {} joints were not "
      "recognised as a humanoid: lorica play {}{}. If it is a humanoid, write a bone map with `lorica info {} "
      "--write-map FILE`, edit it and pass it with --map",
      motion.name, file.character.name, motion.fromCharacterFile ? "another character" : "a human",
      clips.empty() ? "" : ", " + clips, file.character.skeleton.jointCount(), asGiven,
      clips.empty() ? "" : " --clip " + file.clips.front().name, asGiven);
}

/// Notes if the hulls grew for expressions or clips.
void tellReached(const Subject& subject, Motion& motion) {
  if (subject.body && subject.body->reachedVertices > 0) motion.notes.push_back(subject.body->notes.back());
}

/// A character that performs another's motion.
PreparedAvatar performerOf(const AvatarSetting& setting, Subject subject, Motion motion) {
  if (subject.file) {
    // Notes about the character are told from those about the motion.
    for (const std::string& note : subject.file->notes) motion.notes.push_back(subject.name + ": " + note);
    const std::vector<std::string> strays = leftBehind(*subject.character);
    motion.notes.insert(motion.notes.end(), strays.begin(), strays.end());
    tellReached(subject, motion);
  }
  PreparedAvatar avatar;
  avatar.setting = setting;
  avatar.subject = std::move(subject);
  avatar.motion = std::move(motion);
  return avatar;
}

/// A character for a motion that was read.
Result<PreparedAvatar> readCharacterFor(const CastRequest& request, const AvatarSetting& setting, Motion motion,
                                        Host& host) {
  CharacterOptions reading = request.reading;
  reading.suits = [&](const CharacterFile& file) {
    return checkCharacter(motion, file, setting.character, request.performing.joints());
  };
  LORICA_TRY(Subject subject,
             readCharacter(setting.character.empty() ? "mannequin" : setting.character, reading, host));
  if (!subject.file) {  // the mannequin
    LORICA_TRY_DO(checkPerformed(*subject.character, motion, request.performing.joints()));
  }
  return performerOf(setting, std::move(subject), std::move(motion));
}

/// Standing in the bind pose.
SkeletalMotion standing(const Skeleton& skeleton) {
  const Pose rest = restPose(skeleton);
  SkeletalMotion motion{"standing", skeleton, {}, {}};
  for (int f = 0; f < kStandingFrames; ++f) {
    motion.times.push_back(f / kClipRate);
    motion.poses.insert(motion.poses.end(), rest.begin(), rest.end());
  }
  return motion;
}

/// If the motion file is a character, or only a character is given, it performs its own clip; without clips a humanoid
/// walks and anything else stands.
Result<PreparedAvatar> readMotionAndCharacter(const CastRequest& request, const AvatarSetting& setting, Host& host) {
  const std::string& own = setting.motion.empty() ? setting.character : setting.motion;
  const std::string& clipName = request.performing.clip;
  if (own.empty()) {
    return invalidArgument(
        "expected a motion, such as walk, or a character with clips: --character hero.glb --clip Run");
  }
  if (kindOf(own) == FileKind::kCharacter &&
      (setting.character.empty() || setting.motion.empty() || setting.motion == setting.character)) {
    CharacterOptions reading = request.reading;
    reading.ownClip = clipName;
    bool walks = false;
    reading.suits = [&](const CharacterFile& file) -> Result<void> {
      walks = file.clips.empty() && canPerform(file.character);
      if (file.isMesh() || !file.clips.empty() || !clipName.empty()) {
        LORICA_TRY_DO(findClip(file.clips, clipName, own));
      }
      return {};
    };
    Result<Subject> subject = readSubject(own, reading, host);
    if (subject && subject->character && walks) {
      LORICA_TRY(Motion motion, readMotion("walk", request.performing, host));
      motion.notes.push_back(own + ": has no clips, so it performs `walk`");
      AvatarSetting walking = setting;
      walking.character = own;
      walking.motion = "walk";
      return performerOf(walking, std::move(*subject), std::move(motion));
    }
    if (subject && subject->character) {
      Motion motion;
      motion.name = subject->name;
      if (subject->file->clips.empty()) {
        motion.bones = standing(subject->character->skeleton);
      } else {
        LORICA_TRY(const Clip* clip, findClip(subject->file->clips, clipName, own));
        if (!clip->name.empty() && clip->name != motion.name) motion.name += ": " + clip->name;
        LORICA_TRY(motion.bones, prefixed(own, framesOf(subject->character->skeleton, *clip)));
      }
      motion.fromCharacterFile = true;
      motion.format = subject->file->format;
      motion.notes = subject->file->notes;
      if (subject->file->clips.empty()) motion.notes.push_back(own + ": has no clips and is no humanoid, so it stands");
      tellReached(*subject, motion);
      PreparedAvatar avatar;
      avatar.setting = setting;
      avatar.subject = std::move(*subject);
      avatar.motion = std::move(motion);
      avatar.ownClip = clipName;
      return avatar;
    }
    // A file without a surface holds a motion for another character.
    if (!subject && (setting.motion.empty() || subject.error().code != ErrorCode::kBadMesh)) return subject.error();
  }
  LORICA_TRY(Motion motion, readMotion(own, request.performing, host));
  return readCharacterFor(request, setting, std::move(motion), host);
}

/// Reads everything that may be refused before any body is decomposed.
/// @param request  `hulls` is set if springs touch them
Result<std::vector<PreparedAvatar>> readAvatars(CastRequest& request, std::vector<Role> roles, Host& host) {
  std::vector<PreparedAvatar> avatars;
  const auto part = [&](std::size_t i) { return double(i) / double(roles.size()); };
  for (Role& role : roles) {
    const Stage stage(host, kReading * part(avatars.size()), kReading * part(avatars.size() + 1));
    Result<PreparedAvatar> avatar = readAvatar(request, role.setting, std::move(role.motion), host);
    if (!avatar) return Error{avatar.error().code, role.where + avatar.error().message};
    avatar->springs = chooseSprings(avatar->subject, request.springs);
    request.hulls = request.hulls || (avatar->springs && avatar->springs->mode == SpringMode::kBody);
    avatars.push_back(std::move(*avatar));
  }
  if (request.check) LORICA_TRY_DO(request.check(avatars));
  for (std::size_t i = 0; i < roles.size(); ++i) {
    PreparedAvatar& avatar = avatars[i];
    if (!request.hulls) {
      avatar.body = wholeBody(avatar.subject);
      continue;
    }
    const Stage stage(host, kReading + (1.0 - kReading) * part(i), kReading + (1.0 - kReading) * part(i + 1),
                      roles.size() > 1 ? fmt::format("avatar {} of {}", i + 1, roles.size()) : "");
    Result<DecompositionFile> body = chooseBody(request.body, avatar.subject, host);
    if (!body) return Error{body.error().code, roles[i].where + body.error().message};
    avatar.body = std::move(*body);
  }
  return avatars;
}

Error charactersFor(const std::string& where, std::size_t characters, const std::string& what) {
  return invalidArgument("{}found {} and {}, expected one character for all of them or one for each", where,
                         counted(std::int64_t(characters), "character"), what);
}

/// Divides a request with several motions, "walk,wave", into what each avatar performs, next to each other.
Result<std::vector<Role>> rolesOfMotions(const CastRequest& request) {
  const std::vector<std::string> motions = namesIn(request.motion);
  const std::vector<std::string> characters = namesIn(request.character);
  if (characters.size() > 1 && characters.size() != motions.size()) {
    return charactersFor("", characters.size(), counted(countOf(motions), "motion"));
  }
  if (motions.size() > kMaxCast) {
    return invalidArgument("found {} motions, expected at most {}", motions.size(), kMaxCast);
  }
  std::vector<Role> roles;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    AvatarSetting& setting = roles.emplace_back().setting;
    setting.motion = motions[i];
    setting.character = characters.size() > 1 ? characters[i] : request.character;
    setting.place.x() = kSpacing * (double(i) - 0.5 * double(motions.size() - 1));
    if (motions.size() > 1 && motions[i].empty()) {
      return invalidArgument("found an empty name in `{}`, expected motions such as `walk,wave`", request.motion);
    }
  }
  return roles;
}

/// An avatar for each person of a recording, where they stood.
Result<std::vector<Role>> rolesOfPeople(const CastRequest& request, Host& host) {
  if (namesIn(request.motion).size() != 1 || request.motion.empty()) {
    return invalidArgument("--person all: found `{}`, expected one recording of several people", request.motion);
  }
  LORICA_TRY(std::vector<Motion> motions, readEveryone(request.motion, request.performing, host));
  const std::vector<std::string> characters = namesIn(request.character);
  if (characters.size() > 1 && characters.size() != motions.size()) {
    return charactersFor(request.motion + ": ", characters.size(), counted(countOf(motions), "person", "people"));
  }
  std::vector<Role> roles;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    Role& role = roles.emplace_back();
    role.setting.motion = request.motion;
    role.setting.character = characters.size() > 1 ? characters[i] : request.character;
    role.motion = std::move(motions[i]);
  }
  return roles;
}

std::vector<Role> rolesOfStage(std::span<const AvatarSetting> stage, const std::string& scene) {
  std::vector<Role> roles;
  for (const AvatarSetting& setting : stage) {
    roles.push_back({setting, {}, fmt::format("{}: avatars[{}]: ", scene, roles.size())});
  }
  return roles;
}

constexpr double kBetween = 0.7;  // of the first dropped thing from the avatar, and between them [m]
constexpr double kAhead = 0.4;    // [m]
constexpr double kAbove = 0.3;    // of its lowest point over the floor, from where it falls [m]
constexpr int kInRow = 3;

/// Where a dropped thing falls: in rows in front of the avatar.
Isometry3 poseOfDropped(int index, const Prop& prop) {
  const int column = index % kInRow - 1, row = index / kInRow;
  return Isometry3(
      Eigen::Translation3d(kBetween * column, kAbove + prop.halfExtents.y(), kAhead + kBetween * (row + 1)));
}

/// A scene in the place of a motion is the scene; a mesh there becomes a prop, and the mannequin walks.
/// @param remark  set to what was done; else it stays empty
CastRequest withPlaces(CastRequest request, std::string& remark) {
  const FileKind kind = kindOf(request.motion);
  if (kind == FileKind::kScene && request.scene.empty()) request.scene = std::exchange(request.motion, "");
  if (kind == FileKind::kMesh) {
    remark = request.motion + ": is a mesh, so it is a prop; `lorica decompose` has pictures of its parts";
    request.meshes.push_back(std::exchange(request.motion, ""));
    if (request.character.empty()) request.character = "mannequin";
  }
  if (request.motion == "mannequin" && request.character.empty()) request.character = std::exchange(request.motion, "");
  if (request.motion.empty() && request.character == "mannequin") request.motion = "walk";
  return request;
}

/// Lets sand and water settle around the avatars' first poses, as the first step of the session would.
Result<void> settle(Cast& cast, Host& host) {
  if (!mustSettle(cast.world)) return {};
  const Stage stage(host, kBeforeSettling, 1.0);
  // The poses come from a step in another world: of the same props, without particles.
  LORICA_TRY(World other, openScene(cast.request.scene, 1.0, host));
  addProps(cast.added, other);
  LORICA_TRY_DO(other.setParticles(ParticleSettings()));
  World world = std::exchange(cast.world, std::move(other));
  Result<Session> session = startSession(cast);
  cast.world = std::move(world);
  if (!session) return session.error();
  LORICA_TRY_DO(session->step());
  settleAround(partsOf(*session), cast.world, host);
  return {};
}

}  // namespace

Result<PreparedAvatar> readAvatar(const CastRequest& request, const AvatarSetting& setting, std::optional<Motion> given,
                                  Host& host) {
  LORICA_TRY(PreparedAvatar avatar, given ? readCharacterFor(request, setting, std::move(*given), host)
                                          : readMotionAndCharacter(request, setting, host));
  Motion& motion = *avatar.motion;
  const double start = setting.start, seconds = motion.seconds();
  if (start > seconds) {
    return invalidArgument("start: found {} s, expected at most {:.2f} s, the duration of {}", start, seconds,
                           motion.name);
  }
  if (start > 0.0) startAt(start, motion);
  LORICA_TRY_DO(checkCover(request.body.cover, avatar.character()));
  std::shared_ptr<const Avatar>& look = avatar.subject.character->avatar;
  if (setting.color && look != nullptr) look = tinted(*look, *setting.color);
  // Recorded sessions name the file that holds the character.
  if (avatar.setting.character.empty() && avatar.subject.file) avatar.setting.character = setting.motion;
  avatar.source = motion.name;
  avatar.poses = motion.bones.has_value();
  avatar.stream = motion.packets.has_value();
  return avatar;
}

std::shared_ptr<CastSources> motionSources() {
  return std::make_shared<MotionSources>();
}

Result<Cast> prepareCast(const CastRequest& asked, Host& host) {
  std::string remark;
  CastRequest request = withPlaces(asked, remark);
  request.hulls = request.hulls || !request.scene.empty() || !request.meshes.empty() ||
                  !request.body.decomposition.empty() || request.body.cover.given();
  LORICA_TRY(OpenedScene scene, openStage(request.scene, host));
  const bool staged = !scene.stage.empty() && request.motion.empty() && request.character.empty();
  LORICA_TRY(std::vector<Role> roles, staged ? rolesOfStage(scene.stage, request.scene)
                                      : request.performing.person == kEveryone ? rolesOfPeople(request, host)
                                                                               : rolesOfMotions(request));
  Cast cast{{}, std::move(scene.world), std::move(scene.targets)};
  {
    const Stage stage(host, 0.0, mustSettle(cast.world) ? kBeforeSettling : 1.0);
    LORICA_TRY(cast.avatars, readAvatars(request, std::move(roles), host));
  }
  cast.request = request;
  if (!request.hulls) cast.world = World();  // nothing of it is looked at
  for (const std::string& mesh : request.meshes) {
    LORICA_TRY(Prop prop, openMeshProp(mesh, host));
    prop.worldFromProp = poseOfDropped(countOf(cast.added), prop);
    cast.added.push_back(std::move(prop));
  }
  addProps(cast.added, cast.world);
  if (!remark.empty()) cast.avatars.front().motion->notes.push_back(remark);
  cast.sources = motionSources();
  std::vector<std::string> names;
  for (const PreparedAvatar& avatar : cast.avatars) {
    names.push_back(avatar.source);
    cast.seconds = std::max(cast.seconds, avatar.motion->seconds());
  }
  cast.name = listed(names);
  cast.choices = choicesOf(request, cast.avatars);
  return cast;
}

Result<Cast> prepareSettledCast(const std::vector<CastRequest>& attempts, Host& host) {
  std::optional<Error> first;
  for (const CastRequest& attempt : attempts) {
    Result<Cast> cast = prepareCast(attempt, host);
    if (cast) {
      LORICA_TRY_DO(settle(*cast, host));
      return cast;
    }
    if (!first) first = cast.error();
  }
  return *first;
}

}  // namespace lorica
