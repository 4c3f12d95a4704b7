// How long after a depth image of the virtual camera has arrived a client of a page has read the frame that it led to:
// CSV on standard output. The client is a socket of this process, which acknowledges each frame.

#include "geometry/clock.h"
#include "geometry/little_endian.h"
#include "session/prepare/live_cast.h"
#include "tests/bench/measure.h"
#include "tests/viewer/page/test_client.h"
#include "viewer/page/page_screen.h"
#include "viewer/player/run.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace lorica::bench {
namespace {

/// A window that nobody sees, asked to show what the page shows.
class Watched final : public Screen {
 public:
  explicit Watched(std::function<void()> seen) : seen_(std::move(seen)) {}

  [[nodiscard]] bool open() const override { return true; }
  void show(const Scene& /*scene*/, const WindowValues& /*values*/) override { seen_(); }
  void rest(double seconds) override { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }
  [[nodiscard]] HandAim aim(int /*hand*/) const override { return {}; }
  [[nodiscard]] Camera camera() const override { return camera_; }
  void setCamera(const Camera& camera) override { camera_ = camera; }
  void addTimes(std::span<const TimedStage> /*stages*/) override {}
  void notice(std::string /*sentence*/, double /*seconds*/) override {}
  void problem(std::string /*sentence*/) override {}
  void setTitle(const std::string& /*title*/) override {}

 private:
  std::function<void()> seen_;
  Camera camera_;
};

int run(const std::string& motion, double duration) {
  Host host;
  LiveRequest live;
  live.depth.virtualCamera = true;
  live.depth.motion = motion;
  CastRequest request;
  request.reading.drawn = true;
  Result<LiveCast> cast = prepareLiveCast(request, live, host);
  if (!cast) return fail(cast.error());
  RunSetting setting;
  setting.seconds = duration;
  const Result<std::unique_ptr<Run>> run = Run::start(std::move(*cast), setting, host);
  if (!run) return fail(run.error());
  Result<std::unique_ptr<PageServer>> server = PageServer::start({});
  if (!server) return fail(server.error());
  std::map<double, double> arrived;  // by the session's time [s]
  Watched window([&] {
    const DepthSight* sight = (*run)->sight();
    if (sight != nullptr && !sight->image.depthMm.empty()) {
      arrived.emplace((*run)->session.time(), secondsOf(sight->arrived));
    }
  });
  PageScreen page(**server, &window);
  if (const auto begun = page.begin(**run, host); !begun) return fail(begun.error());

  std::map<double, double> read;  // when the first frame of each time of the session was read [s]
  long frames = 0;
  double first = 0.0, last = 0.0;  // frame [s]
  std::thread client([&] {
    test::TestClient watcher((*server)->port());
    watcher.watch();
    watcher.send({{"type", "show"}, {"layers", {"hulls"}}});
    for (;;) {
      const test::TestClient::Message message = watcher.next("frame");
      if (message.kind != 2) return;
      last = now();
      if (frames++ == 0) first = last;
      read.emplace(loadLittleEndian<double>(message.bytes.data() + 24), last);
      watcher.send({{"type", "ack"}, {"frame", message.number()}});
    }
  });
  while ((*server)->clients() == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  Shown shown{&page};
  const Result<RunEnd> end = play(**run, shown, host);
  server->reset();
  client.join();
  if (!end) return fail(end.error());
  std::vector<double> ms, posed;
  for (const auto& [time, at] : read) {
    if (arrived.contains(time) && at > arrived[time]) ms.push_back(1e3 * (at - arrived[time]));
  }
  for (const double us : (*run)->log.figures().latency) posed.push_back(1e-3 * us);
  fmt::print("clients,frames,mean_ms,p95_ms,largest_ms,posed_median_ms,posed_p95_ms,least_hz\n");
  fmt::print("1,{},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{:.1f}\n", ms.size(), meanOf(ms), atRank(ms, 0.95),
             atRank(ms, 1.0), atRank(posed, 0.5), atRank(posed, 0.95),
             static_cast<double>(frames - 1) / (last - first));
  return 0;
}

}  // namespace
}  // namespace lorica::bench

int main(int argc, char** argv) {
  std::string motion = "punch_and_kick";
  double latency = 30.0;
  CLI::App app("Latency of a session that is watched on a page.");
  app.add_option("--motion", motion, "What the mannequin performs before the virtual camera");
  app.add_option("--latency", latency, "For so long [s]")->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);
  ::setenv("XDG_CONFIG_HOME", "/dev/null", 1);  // no choices that somebody has kept
  const std::filesystem::path here = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  ::setenv("LORICA_RECORDINGS", (here / "../../recordings").c_str(), 0);
  return lorica::bench::run(motion, latency);
}
