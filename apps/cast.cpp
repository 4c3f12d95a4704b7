#include "apps/cast.h"

#include "apps/window_treatment.h"

#include "apps/playback.h"
#include "apps/scenes.h"
#include "apps/settling.h"
#include "apps/work_monitor.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "skinning/look/avatar.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <utility>

namespace lorica {
namespace {

constexpr double kReading = 0.4;  ///< of the work of opening avatars; the rest decomposes them
constexpr double kSpacing = 1.2;  ///< between avatars that stand side by side [m]

/// What an avatar is to perform.
struct Role {
  PlaybackInputOptions options;
  std::optional<Motion> motion = {};  ///< none = the one that the options name
  StageAvatar stage = {};             ///< start, place and heading
  std::string where = {};             ///< begins its errors: "duel: avatars[1]: "
};

Result<std::unique_ptr<PoseSource>> sourceOf(const CastMember& member, std::shared_ptr<SourceLog> log) {
  return poseSourceOf(member.character(), member.motion(), member.options.performing, std::move(log));
}

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

}  // namespace

std::vector<std::filesystem::path> filesOf(const PlaybackInputOptions& input, const BodyOptions& body) {
  std::vector<std::filesystem::path> files{body.decomposition};
  for (const std::string* names : {&input.motion, &input.character}) {
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

namespace {

/// Reads the motion and the character of a role, and checks that they go together.
Result<PlaybackInput> readInput(Role& role) {
  Result<PlaybackInput> input =
      role.motion ? readPlaybackInput(role.options, std::move(*role.motion)) : readPlaybackInput(role.options);
  if (!input) return Error{input.error().code, role.where + input.error().message};
  const double seconds = input->motion.seconds();
  if (role.stage.start > seconds) {
    return wrong(
        {ErrorCode::kInvalidArgument, fmt::format("start: found {} s, expected at most {:.2f} s, the duration of {}",
                                                  role.stage.start, seconds, input->motion.name)});
  }
  if (role.stage.start > 0.0) startAt(role.stage.start, input->motion);
  return input;
}

/// Reads everything that may be refused before any body is decomposed.
Result<std::vector<CastMember>> readCast(std::vector<Role> roles, const BodyOptions& body, int threads) {
  std::vector<PlaybackInput> inputs;
  const auto part = [&](std::size_t i) { return static_cast<double>(i) / roles.size(); };
  for (Role& role : roles) {
    const WorkMonitor::Stage stage(kReading * part(inputs.size()), kReading * part(inputs.size() + 1));
    LORICA_TRY(PlaybackInput input, readInput(role));
    LORICA_TRY_DO(checkCover(body.cover, *input.subject.character));
    std::shared_ptr<const Avatar>& look = input.subject.character->avatar;
    if (role.stage.color && look != nullptr) look = tinted(*look, *role.stage.color);
    inputs.push_back(std::move(input));
  }
  std::vector<CastMember> cast;
  for (std::size_t i = 0; i < roles.size(); ++i) {
    Role& role = roles[i];
    const WorkMonitor::Stage stage(kReading + (1.0 - kReading) * part(i), kReading + (1.0 - kReading) * part(i + 1));
    Result<DecompositionFile> file = chooseBody(body, inputs[i].subject, threads);
    if (!file) return Error{file.error().code, role.where + file.error().message};
    std::optional<SpringChoice> springs = chooseSprings(inputs[i].subject, role.options.springs);
    cast.push_back({std::move(role.options), std::move(inputs[i]), std::move(*file), std::move(springs),
                    role.stage.place, role.stage.heading, role.stage.color});
  }
  return cast;
}

Error charactersFor(const std::string& where, std::size_t characters, const std::string& what) {
  return invalidArgument("{}found {} characters and {}, expected one character for all of them or one for each", where,
                         characters, what);
}

std::string countedAs(std::size_t count, const char* one, const char* several) {
  return count == 1 ? fmt::format("1 {}", one) : fmt::format("{} {}", count, several);
}

/// Divides options with several motions, "walk,wave", into those of each avatar, side by side.
Result<std::vector<Role>> rolesOfMotions(const PlaybackInputOptions& options) {
  const std::vector<std::string> motions = namesIn(options.motion);
  const std::vector<std::string> characters = namesIn(options.character);
  if (characters.size() > 1 && characters.size() != motions.size()) {
    return charactersFor("", characters.size(), countedAs(motions.size(), "motion", "motions"));
  }
  if (motions.size() > kMaxCast) {
    return invalidArgument("found {} motions, expected at most {}", motions.size(), kMaxCast);
  }
  std::vector<Role> roles;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    Role& role = roles.emplace_back(Role{options});
    role.options.motion = motions[i];
    role.options.character = characters.size() > 1 ? characters[i] : options.character;
    role.stage.place.x() = kSpacing * (i - 0.5 * (motions.size() - 1));
    if (motions.size() > 1 && motions[i].empty()) {
      return invalidArgument("found an empty name in `{}`, expected motions such as `walk,wave`", options.motion);
    }
  }
  return roles;
}

/// An avatar for each person of a recording, where they stood.
Result<std::vector<Role>> rolesOfPeople(const PlaybackInputOptions& options) {
  if (namesIn(options.motion).size() != 1 || options.motion.empty()) {
    return invalidArgument("--person all: found `{}`, expected one recording of several people", options.motion);
  }
  LORICA_TRY(std::vector<Motion> motions, readEveryone(options.motion, options.performing));
  const std::vector<std::string> characters = namesIn(options.character);
  if (characters.size() > 1 && characters.size() != motions.size()) {
    return charactersFor(options.motion + ": ", characters.size(), countedAs(motions.size(), "person", "people"));
  }
  std::vector<Role> roles;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    Role& role = roles.emplace_back(Role{options, std::move(motions[i])});
    if (characters.size() > 1) role.options.character = characters[i];
  }
  return roles;
}

std::vector<Role> rolesOfStage(std::span<const StageAvatar> stage, const PlaybackInputOptions& options,
                               const std::string& scene) {
  std::vector<Role> roles;
  for (const StageAvatar& avatar : stage) {
    Role& role = roles.emplace_back(Role{options});
    role.options.motion = avatar.motion;
    role.options.character = avatar.character;
    role.stage = avatar;
    role.where = fmt::format("{}: avatars[{}]: ", scene, roles.size() - 1);
  }
  return roles;
}

}  // namespace

Result<OpenedCast> openCast(const PlaybackInputOptions& options, const BodyOptions& body, const std::string& scene,
                            int threads) {
  LORICA_TRY(OpenedScene opened, openStage(scene));
  const bool staged = !opened.stage.empty() && options.motion.empty() && options.character.empty();
  LORICA_TRY(std::vector<Role> roles, staged ? rolesOfStage(opened.stage, options, scene)
                                      : options.performing.person == kEveryone ? rolesOfPeople(options)
                                                                               : rolesOfMotions(options));
  const WorkMonitor::Stage stage(0.0, mustSettle(opened.world) ? kBeforeSettling : 1.0);
  LORICA_TRY(std::vector<CastMember> cast, readCast(std::move(roles), body, threads));
  return OpenedCast{std::move(opened.world), std::move(opened.targets), std::move(cast)};
}

Result<std::shared_ptr<SessionRecorder>> startRecorder(const std::string& file, std::span<const CastMember> cast,
                                                       const BodyOptions& body, const std::string& scene,
                                                       const World& world) {
  std::vector<RecordedAvatar> avatars;
  for (const CastMember& member : cast) {
    const Motion& motion = member.motion();
    const bool named = !member.options.character.empty() || !member.input.subject.file;
    RecordedAs as{motion.name,
                  motion.bones.has_value(),
                  named ? member.options.character : member.options.motion,
                  member.options.reading,
                  member.options.performing,
                  body,
                  member.springs,
                  member.input.ownClip,
                  motion.packets.has_value(),
                  member.place,
                  member.heading,
                  member.color};
    avatars.push_back({std::move(as), member.character(), member.body});
  }
  return startRecorder(file, avatars, scene, world);
}

Result<Session> startSession(std::span<const CastMember> cast, const std::shared_ptr<SessionRecorder>& recorder,
                             World world) {
  Session session(std::move(world));
  for (std::size_t i = 0; i < cast.size(); ++i) {
    const CastMember& member = cast[i];
    LORICA_TRY(std::unique_ptr<PoseSource> source, sourceOf(member, recorder ? recorder->log(i) : nullptr));
    const AvatarSetting setting{placeOf(member.place, member.heading), member.springs};
    LORICA_TRY_DO(addAvatar(session, member.character(), member.body, std::move(source), setting));
  }
  return session;
}

Result<std::vector<std::unique_ptr<PoseSource>>> sourcesOf(std::span<const CastMember> cast,
                                                           const WindowTreatment& treatment) {
  std::vector<std::unique_ptr<PoseSource>> sources;
  for (const CastMember& member : cast) {
    LORICA_TRY(std::unique_ptr<PoseSource> source,
               poseSourceOf(member.character(), member.motion(), treated(member.options.performing, treatment)));
    sources.push_back(std::move(source));
  }
  return sources;
}

std::string listed(std::span<const std::string> names) {
  std::string all;
  for (std::size_t i = 0; i < names.size(); ++i) {
    all += i == 0 ? "" : i + 1 < names.size() ? ", " : " and ";
    all += names[i];
  }
  return all;
}

std::string motionsOf(std::span<const CastMember> cast) {
  std::vector<std::string> names;
  for (const CastMember& member : cast) names.push_back(member.motion().name);
  return listed(names);
}

double secondsOf(std::span<const CastMember> cast) {
  double seconds = 0.0;
  for (const CastMember& member : cast) seconds = std::max(seconds, member.motion().seconds());
  return seconds;
}

}  // namespace lorica
