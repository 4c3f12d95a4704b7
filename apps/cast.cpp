#include "apps/cast.h"

#include "apps/playback.h"
#include "apps/scenes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <utility>

namespace lorica {
namespace {

constexpr double kSpacing = 1.2;  ///< between avatars that stand side by side [m]

/// @param motion  that was read; none = the one that the options name
Result<CastMember> readMember(PlaybackInputOptions options, const BodyOptions& body, int threads,
                              std::optional<Motion> motion = std::nullopt) {
  Result<PlaybackInput> input = motion ? readPlaybackInput(options, std::move(*motion)) : readPlaybackInput(options);
  if (!input) return input.error();
  if (Result<void> fine = checkCover(body.cover, *input->subject.character); !fine) return fine.error();
  Result<DecompositionFile> file = chooseBody(body, input->subject, threads);
  if (!file) return file.error();
  std::optional<SpringChoice> springs = chooseSprings(input->subject, options.springs);
  return CastMember{std::move(options), std::move(*input), std::move(*file), std::move(springs)};
}

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

/// Divides options with several motions, "walk,wave", into those of each avatar.
Result<std::vector<PlaybackInputOptions>> optionsOfCast(const PlaybackInputOptions& options) {
  const std::vector<std::string> motions = namesIn(options.motion);
  const std::vector<std::string> characters = namesIn(options.character);
  if (characters.size() > 1 && characters.size() != motions.size()) {
    return Error{
        ErrorCode::kInvalidArgument,
        fmt::format("found {} characters and {}, expected one character for all of them or one for each",
                    characters.size(), motions.size() == 1 ? "1 motion" : fmt::format("{} motions", motions.size()))};
  }
  if (motions.size() > kMaxCast) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("found {} motions, expected at most {}", motions.size(), kMaxCast)};
  }
  std::vector<PlaybackInputOptions> all;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    PlaybackInputOptions& one = all.emplace_back(options);
    one.motion = motions[i];
    one.character = characters.size() > 1 ? characters[i] : options.character;
    if (motions.size() > 1 && one.motion.empty()) {
      return Error{ErrorCode::kInvalidArgument,
                   fmt::format("found an empty name in `{}`, expected motions such as `walk,wave`", options.motion)};
    }
  }
  return all;
}

/// An avatar for each person of a recording, where they stood.
Result<std::vector<CastMember>> readPeople(const PlaybackInputOptions& options, const BodyOptions& body, int threads) {
  if (namesIn(options.motion).size() != 1 || options.motion.empty()) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("--person all: found `{}`, expected one recording of several people", options.motion)};
  }
  Result<std::vector<Motion>> motions = readEveryone(options.motion, options.performing);
  if (!motions) return motions.error();
  const std::vector<std::string> characters = namesIn(options.character);
  if (characters.size() > 1 && characters.size() != motions->size()) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{}: found {} characters and {}, expected one character for all of them or one for each",
                             options.motion, characters.size(),
                             motions->size() == 1 ? "1 person" : fmt::format("{} people", motions->size()))};
  }
  std::vector<CastMember> cast;
  for (std::size_t i = 0; i < motions->size(); ++i) {
    PlaybackInputOptions one = options;
    if (characters.size() > 1) one.character = characters[i];
    Result<CastMember> member = readMember(std::move(one), body, threads, std::move((*motions)[i]));
    if (!member) return member.error();
    cast.push_back(std::move(*member));
  }
  return cast;
}

Result<std::vector<CastMember>> readCast(const PlaybackInputOptions& options, const BodyOptions& body, int threads) {
  if (options.performing.person == kEveryone) return readPeople(options, body, threads);
  Result<std::vector<PlaybackInputOptions>> each = optionsOfCast(options);
  if (!each) return each.error();
  std::vector<CastMember> cast;
  for (PlaybackInputOptions& one : *each) {
    Result<CastMember> member = readMember(std::move(one), body, threads);
    if (!member) return member.error();
    const double left = static_cast<double>(cast.size()) - 0.5 * static_cast<double>(each->size() - 1);
    member->place.x() = kSpacing * left;
    cast.push_back(std::move(*member));
  }
  return cast;
}

Result<std::vector<CastMember>> readCast(std::span<const StageAvatar> stage, const PlaybackInputOptions& options,
                                         const BodyOptions& body, const std::string& scene, int threads) {
  std::vector<CastMember> cast;
  for (const StageAvatar& avatar : stage) {
    const auto wrong = [&](const std::string& what) {
      return Error{ErrorCode::kInvalidArgument, fmt::format("{}: avatars[{}]: {}", scene, cast.size(), what)};
    };
    PlaybackInputOptions one = options;
    one.motion = avatar.motion;
    one.character = avatar.character;
    Result<CastMember> member = readMember(std::move(one), body, threads);
    if (!member) return Error{member.error().code, wrong(member.error().message).message};
    if (avatar.start > member->motion().seconds()) {
      return wrong(fmt::format("start: found {} s, expected at most {:.2f} s, the duration of {}", avatar.start,
                               member->motion().seconds(), member->motion().name));
    }
    startAt(avatar.start, member->input.motion);
    member->place = avatar.place;
    member->heading = avatar.heading;
    cast.push_back(std::move(*member));
  }
  return cast;
}

}  // namespace

Result<OpenedCast> openCast(const PlaybackInputOptions& options, const BodyOptions& body, const std::string& scene,
                            int threads) {
  Result<OpenedScene> opened = openStage(scene);
  if (!opened) return opened.error();
  const bool staged = !opened->stage.empty() && options.motion.empty() && options.character.empty();
  Result<std::vector<CastMember>> cast =
      staged ? readCast(opened->stage, options, body, scene, threads) : readCast(options, body, threads);
  if (!cast) return cast.error();
  return OpenedCast{std::move(opened->world), std::move(opened->targets), std::move(*cast)};
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
                  member.heading};
    avatars.push_back({std::move(as), member.character(), member.body});
  }
  return startRecorder(file, avatars, scene, world);
}

Result<Session> startSession(std::span<const CastMember> cast, const std::shared_ptr<SessionRecorder>& recorder,
                             World world) {
  Session session(std::move(world));
  for (std::size_t i = 0; i < cast.size(); ++i) {
    const CastMember& member = cast[i];
    Result<std::unique_ptr<PoseSource>> source = sourceOf(member, recorder ? recorder->log(i) : nullptr);
    if (!source) return source.error();
    const AvatarSetting setting{placeOf(member.place, member.heading), member.springs};
    Result<void> added = addAvatar(session, member.character(), member.body, std::move(*source), setting);
    if (!added) return added.error();
  }
  return session;
}

Result<std::vector<std::unique_ptr<PoseSource>>> sourcesOf(std::span<const CastMember> cast) {
  std::vector<std::unique_ptr<PoseSource>> sources;
  for (const CastMember& member : cast) {
    Result<std::unique_ptr<PoseSource>> source = sourceOf(member, nullptr);
    if (!source) return source.error();
    sources.push_back(std::move(*source));
  }
  return sources;
}

std::string motionsOf(std::span<const CastMember> cast) {
  std::string all;
  for (std::size_t i = 0; i < cast.size(); ++i) {
    all += i == 0 ? "" : i + 1 < cast.size() ? ", " : " and ";
    all += cast[i].motion().name;
  }
  return all;
}

double secondsOf(std::span<const CastMember> cast) {
  double seconds = 0.0;
  for (const CastMember& member : cast) seconds = std::max(seconds, member.motion().seconds());
  return seconds;
}

}  // namespace lorica
