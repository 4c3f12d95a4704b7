#include "apps/playback.h"

#include "apps/interrupt.h"
#include "apps/snapshots.h"
#include "session/demo_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <set>
#include <thread>

namespace lorica {
namespace {

// In heights of the character.
constexpr double kWindowDistance = 2.97;
const Vec3 kWindowTarget(0.171, 0.486, 0.229);
constexpr int kMostStepsAPicture = 6;
constexpr double kLongestPause = 0.25;  // [s]: a gap in a recording, or a dragged window, is not waited out

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

Result<Session> startSession(const Character& character, const DecompositionFile& body,
                             std::unique_ptr<PoseSource> source, World world) {
  return Session::create(character, body.decomposition, std::move(source), std::move(world), body.cover, body.training);
}

Result<Session> startDemoSession(const Character& character, const DecompositionFile& body, const Motion& motion) {
  Result<std::unique_ptr<PoseSource>> source = poseSourceOf(character, motion);
  if (!source) return source.error();
  return startSession(character, body, std::move(*source), makeDemoWorld(kDemoSeed));
}

std::string captionOf(const std::string& name, const Session& session, double seconds) {
  std::set<int> touched;
  for (const Contact& contact : session.world().contacts()) touched.insert(contact.prop);
  std::string caption =
      fmt::format("{}   {:.1f} s   {}", name, seconds, counted(std::ssize(session.body().parts()), "convex part"));
  if (!touched.empty()) caption += fmt::format("   touching {}", counted(std::ssize(touched), "prop"));
  if (session.outsideKnownRange()) caption += "   beyond training";
  return caption;
}

Camera windowCamera(double height) {
  Camera camera;
  camera.target = height * kWindowTarget;
  camera.eye = camera.target + height * kWindowDistance * kViewDirection;
  return camera;
}

Result<bool> playInWindow(Window& window, Session& session, const std::string& name, const PlaybackOptions& options,
                          Tally& tally) {
  const SessionScene scene(session);
  Clock::time_point due = Clock::now();
  double firstTime = 0.0;
  std::string caption = name;
  bool started = false;
  while (window.open()) {
    if (interrupted()) return Error{ErrorCode::kCancelled, "cancelled"};
    // A picture may take longer than a frame: what is due is computed, up to a limit that keeps the window alive.
    for (int steps = 0; steps < kMostStepsAPicture && (options.hurry || Clock::now() >= due) && window.wantsStep();
         ++steps) {
      const double previousTime = session.time();
      const Result<bool> more = session.step();
      if (!more) return more.error();
      if (!*more) return true;
      if (!started) firstTime = session.time();
      const double seconds = session.time() - firstTime;
      const double step = started ? session.time() - previousTime : 0.0;
      started = true;
      tally.add(session);
      caption = captionOf(name, session, seconds);
      // Late frames are caught up, but a long stop (a pause, a dragged window) is not.
      due += std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(std::min(step, kLongestPause)));
      if (secondsSince(due) > kLongestPause) due = Clock::now();
      if (options.frames > 0 && session.frameCount() >= options.frames) return true;
      if (options.seconds > 0.0 && seconds >= options.seconds) return true;
    }
    if (started) {
      window.show(scene.of(session), caption);
    } else {
      window.show(Scene(), caption);
    }
    // Where the display does not hold us back, this does.
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

void holdInWindow(Window& window, const Session& session, const std::string& caption) {
  const SessionScene scene(session);
  while (window.open() && !interrupted()) {
    window.show(scene.of(session), caption);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

}  // namespace lorica
