#include "session/prepare/depth_motion.h"

#include "capture/sensor/depth_recording.h"
#include "capture/tracking/depth_joints.h"
#include "capture/tracking/track_log.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "session/prepare/first_guess.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace lorica {
namespace {

std::string whoWasSeen(int followed, int frames, int maxPeople) {
  if (followed == 0) return fmt::format("no person found in {}", counted(frames, "depth frame"));
  const std::string others = maxPeople > 1 ? fmt::format("; up to {} people at once, see --person", maxPeople) : "";
  return fmt::format("a person is tracked in {} of {}{}", grouped(followed), counted(frames, "depth frame"), others);
}

/// Unit and floor of joints from a depth camera.
std::vector<std::string> guessOf(const DepthSight& sight) {
  const Isometry3 worldFromCamera = sight.cameraFromWorld.inverse();
  const double height = worldFromCamera.translation().y();
  if (!sight.floorFound) {
    return {"millimetres",
            fmt::format("Y is up as the camera has it; no floor was found, y = 0 is {:.2f} m below it", height)};
  }
  const double down =
      -std::asin(std::clamp(-worldFromCamera.linear().col(2).y(), -1.0, 1.0)) * 180.0 / std::numbers::pi;
  return {
      "millimetres",
      fmt::format("Y is up from the floor, which was found {:.2f} m below the camera; it looks {} by {:.0f} degrees",
                  height, down < 0.0 ? "up" : "down", std::abs(down))};
}

/// The whole frames of a recording. Says if it was truncated.
Result<std::unique_ptr<DepthRecording>> openWhole(const std::filesystem::path& file, const std::string& lens,
                                                  Host& host) {
  LORICA_TRY(std::unique_ptr<DepthRecording> depth, openDepthRecording(file, lens));
  if (depth->about().cutOff) {
    host.warn(fmt::format("{}: the recording is truncated; found {} that {} whole", file.string(),
                          counted(depth->about().frameCount, "frame"), depth->about().frameCount == 1 ? "is" : "are"));
  }
  return depth;
}

}  // namespace

Result<Motion> readDepthMotion(const std::filesystem::path& file, const MotionOptions& options, Host& host) {
  LORICA_TRY(std::unique_ptr<DepthRecording> depth, openWhole(file, options.lens, host));
  const std::string format = depth->about().format;
  const int frames = depth->about().frameCount;
  LORICA_TRY(Tracker tracker, prefixed(file.string(), Tracker::create(depth->camera())));

  DepthJoints people(std::move(depth), std::move(tracker), options.person);
  Motion motion;
  motion.name = file.stem().string();
  motion.format = format + ", depth";
  motion.depth = RecordedDepth{file, options.lens};
  motion.joints.reserve(frames);
  Task task(host, "Tracking " + motion.name, "frames");
  int followed = 0;
  int maxPeople = 0;
  while (true) {
    if (task.cancelled()) return cancelled();
    LORICA_TRY(const std::optional<SkeletonFrame> joints, people.next());
    if (!joints.has_value()) break;
    motion.joints.push_back(*joints);
    motion.depth->cameraFromWorld.push_back(people.sight().cameraFromWorld);
    followed += people.sight().followed ? 1 : 0;
    maxPeople = std::max(maxPeople, people.sight().people);
    task.update(countOf(motion.joints), frames);
  }
  motion.notes.push_back(whoWasSeen(followed, frames, maxPeople));
  if (options.person > 0 && followed == 0 && maxPeople > 0) {
    return invalidArgument("{}: person {} not found: {}", file.string(), options.person,
                           maxPeople == 1 ? "1 person appears" : fmt::format("{} people appear", maxPeople));
  }
  motion.firstGuess = firstGuessOf(guessOf(people.sight()), motion);
  return motion;
}

Result<std::string> firstGuessOfDepth(const std::filesystem::path& file, const std::string& lens) {
  constexpr int kMaxFrames = 90;
  LORICA_TRY(std::unique_ptr<DepthRecording> depth, openDepthRecording(file, lens));
  LORICA_TRY(Tracker tracker, prefixed(file.string(), Tracker::create(depth->camera())));
  DepthJoints people(std::move(depth), std::move(tracker));
  Motion motion;
  std::vector<std::string> guess;
  while (countOf(motion.joints) < kMaxFrames) {
    LORICA_TRY(const std::optional<SkeletonFrame> joints, people.next());
    if (!joints) break;
    motion.joints.push_back(*joints);
    guess = guessOf(people.sight());
    if (people.sight().floorFound && people.sight().followed) break;
  }
  return firstGuessOf(std::move(guess), motion);
}

Result<std::vector<Motion>> readDepthMotionOfAll(const std::filesystem::path& file, const std::string& lens,
                                                 Host& host) {
  constexpr int kPlaces = 6;  // as many as a tracker follows
  LORICA_TRY(std::unique_ptr<DepthRecording> depth, openWhole(file, lens, host));
  const int frames = depth->about().frameCount;
  LORICA_TRY(Tracker tracker, prefixed(file.string(), Tracker::create(depth->camera(), {.maxPeople = kPlaces})));
  DepthJoints people(std::move(depth), std::move(tracker), PeoplePlaces(kPlaces));
  std::vector<Motion> motions(kPlaces);
  std::vector<std::string> guess;
  RecordedDepth seen{file, lens};
  const std::string format = depth->about().format;
  Task task(host, "Tracking " + file.stem().string(), "frames");
  while (true) {
    if (task.cancelled()) return cancelled();
    LORICA_TRY(const std::optional<SkeletonFrame> joints, people.next());
    if (!joints.has_value()) break;
    for (std::size_t p = 0; p < motions.size(); ++p) motions[p].joints.push_back(people.sight().places[p]);
    guess = guessOf(people.sight());
    seen.cameraFromWorld.push_back(people.sight().cameraFromWorld);
    task.update(countOf(motions.front().joints), frames);
  }
  std::erase_if(motions, [](const Motion& motion) {
    return std::ranges::all_of(motion.joints, [](const SkeletonFrame& frame) { return frame.user == kNobody; });
  });
  if (motions.empty()) {
    return invalidArgument("{}: found no person in {}, expected at least one", file.string(),
                           counted(frames, "depth frame"));
  }
  for (std::size_t p = 0; p < motions.size(); ++p) {
    motions[p].name = fmt::format("{}: person {}", file.stem().string(), p + 1);
    motions[p].format = format + ", depth";
    motions[p].depth = seen;
    motions[p].firstGuess = firstGuessOf(guess, motions[p]);
  }
  return motions;
}

Result<int> writeTrackLog(const std::filesystem::path& file, const std::string& lens, const std::filesystem::path& base,
                          Host& host) {
  LORICA_TRY(std::unique_ptr<DepthRecording> depth, openWhole(file, lens, host));
  const int frames = depth->about().frameCount;
  LORICA_TRY(Tracker tracker, prefixed(file.string(), Tracker::create(depth->camera())));
  Task task(host, "Tracking " + file.stem().string(), "frames");
  LORICA_TRY(TrackLog log, TrackLog::create(base));
  DepthFrame frame;
  for (int number = 0; number < frames; ++number) {
    if (host.cancelled()) return cancelled();
    LORICA_TRY(const DepthRead read, depth->next(frame));
    if (read != DepthRead::kFrame) break;
    log.add(number, tracker.track(frame), tracker);
    task.update(number + 1, frames);
  }
  LORICA_TRY_DO(log.finish());
  return frames;
}

}  // namespace lorica
