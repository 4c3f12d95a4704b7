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
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace lorica::bench {
namespace {

int run(const std::string& motion, double duration) {
  Host host;
  LiveRequest live;
  live.depth.virtualCamera = true;
  live.depth.motion = motion;
  CastRequest request;
  request.reading.drawn = true;
  Result<LiveCast> cast = prepareLiveCast(request, live, host);
  if (!cast) return fail(cast.error());
  const LiveJoints& joints = *cast->sources->tracked;
  RunSetting setting;
  setting.seconds = duration;
  const Result<std::unique_ptr<Run>> run = Run::start(std::move(*cast), setting, host);
  if (!run) return fail(run.error());
  Result<std::unique_ptr<PageServer>> server = PageServer::start({});
  if (!server) return fail(server.error());
  PageScreen page(**server, nullptr);
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
  std::map<double, double> arrived;  // by the session's time [s]
  Shown shown{&page, [&]() -> Result<bool> {
                if (joints.frameCount() == 0) return true;  // nothing has come yet
                arrived.emplace((*run)->session.time(), secondsOf(joints.sight().arrived));
                return true;
              }};
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
