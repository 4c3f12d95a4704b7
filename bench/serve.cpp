// What it costs a session that it is watched on a page, beside the same session that nobody watches, in the same run:
// CSV on standard output. The clients are sockets in a process of their own, which acknowledge each frame. With
// --latency instead: how long after a depth image has arrived a client of this process has read the frame that it led
// to, and what a live session takes for its frames. With --all both, the latter also while nobody and twenty watch.

#include "bench/measure.h"
#include "geometry/little_endian.h"
#include "player/run.h"
#include "prepare/live_cast.h"
#include "serve/page_screen.h"
#include "session/scenes/demo_scene.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <tbb/global_control.h>
#include <unistd.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <numeric>
#include <set>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace lorica::bench {
namespace {

constexpr int kProps = 100;
constexpr std::array<int, 3> kWatchers = {0, 1, 20};  // the first is what the others are compared with

struct Options {
  std::string motion = "punch_and_kick";
  int repeats = 5;
  double latency = 0.0;             // duration of that measurement [s]; 0 = the other one
  bool all = false;                 // both
  int watchPort = 0, watchers = 0;  // as the process of the clients
};

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// CPU time of this thread: other load of the machine does not count [us].
double threadMicroseconds() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

// The process of the clients ------------------------------------------------------------------------------------------

/// One client: a socket, and what came over it.
struct Watcher {
  int socket = -1;
  bool open = false;  // a WebSocket
  std::string bytes;
  long frames = 0, all = 0, plain = 0;  // bytes of all frames; of avatars and props alone
  std::size_t most = 0, mostPlain = 0;  // of a frame
  double first = 0.0, last = 0.0;       // frame [s]
  std::map<double, double> came;        // when the first frame of each time of the session was read [s]

  bool connect(int port) {
    socket = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) return false;
    write(
        fmt::format("GET /live HTTP/1.1\r\nHost: 127.0.0.1:{}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                    "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
                    "Sec-WebSocket-Protocol: lorica.live.1\r\n\r\n",
                    port));
    return true;
  }
  void write(const std::string& text) const { (void)!::send(socket, text.data(), text.size(), MSG_NOSIGNAL); }
  void say(const std::string& json) const {  // at most 125 bytes; a mask of zeros changes nothing
    write("\x81" + std::string(1, static_cast<char>(0x80 | json.size())) + std::string(4, '\0') + json);
  }
  void takeFrame(const char* data, std::size_t size) {
    std::size_t plainSize = 32, at = 32;
    const auto sections = loadLittleEndian<std::uint16_t>(data + 6);
    for (int s = 0; s < sections; ++s) {
      const auto kind = loadLittleEndian<std::uint16_t>(data + at);
      const std::size_t length = 8 + (loadLittleEndian<std::uint32_t>(data + at + 4) + 3) / 4 * 4;
      if (kind == 1 || kind == 3) plainSize += length;
      at += length;
    }
    last = seconds();
    came.emplace(loadLittleEndian<double>(data + 24), last);
    if (frames++ == 0) first = last;
    all += static_cast<long>(size);
    plain += static_cast<long>(plainSize);
    most = std::max(most, size);
    mostPlain = std::max(mostPlain, plainSize);
    say(fmt::format(R"({{"type":"ack","frame":{}}})", loadLittleEndian<std::uint64_t>(data + 16)));
  }
  /// @return whether it is still connected
  bool read() {
    std::array<char, 65536> part{};
    const auto got = ::recv(socket, part.data(), part.size(), 0);
    if (got <= 0) return false;
    bytes.append(part.data(), static_cast<std::size_t>(got));
    if (!open) {
      const std::size_t end = bytes.find("\r\n\r\n");
      if (end == std::string::npos) return true;
      bytes.erase(0, end + 4);
      open = true;
      say(R"({"type":"show","layers":["hulls"]})");
    }
    std::size_t at = 0;
    for (;;) {
      if (bytes.size() < at + 2) break;
      std::size_t length = static_cast<unsigned char>(bytes[at + 1]), head = 2;
      if (length >= 126) {
        const std::size_t digits = length == 126 ? 2 : 8;
        if (bytes.size() < at + 2 + digits) break;
        length = 0;
        for (std::size_t i = 0; i < digits; ++i) length = length << 8 | static_cast<unsigned char>(bytes[at + 2 + i]);
        head += digits;
      }
      if (bytes.size() < at + head + length) break;
      const int kind = bytes[at] & 15;
      if (kind == 8) return false;
      if (kind == 2) takeFrame(bytes.data() + at + head, length);
      at += head + length;
    }
    bytes.erase(0, at);
    return true;
  }
};

/// Watches until the server closes; prints a line for each client.
int watch(const Options& options) {
  std::vector<Watcher> watchers(options.watchers);
  std::vector<pollfd> polled;
  for (Watcher& watcher : watchers) {
    if (!watcher.connect(options.watchPort)) return 1;
    polled.push_back({watcher.socket, POLLIN, 0});
  }
  for (std::size_t left = watchers.size(); left > 0;) {
    ::poll(polled.data(), polled.size(), -1);
    for (std::size_t i = 0; i < polled.size(); ++i) {
      if (polled[i].fd < 0 || polled[i].revents == 0 || watchers[i].read()) continue;
      ::close(polled[i].fd);
      polled[i].fd = -1;
      --left;
    }
  }
  for (const Watcher& w : watchers) {
    fmt::print("{} {:.6f} {} {} {} {}\n", w.frames, w.last - w.first, w.all, w.most, w.plain, w.mostPlain);
  }
  return 0;
}

/// That process, as the session's one sees it.
class Watchers {
 public:
  Watchers(int port, int count) {
    if (count <= 0) return;
    output_ = ::popen(fmt::format("/proc/{}/exe --watch-port {} --watchers {}", ::getpid(), port, count).c_str(), "r");
  }
  /// What they got, once the server has closed.
  std::vector<Watcher> results() {
    std::vector<Watcher> all;
    if (output_ == nullptr) return all;
    Watcher w;
    while (std::fscanf(output_, "%ld %lf %ld %zu %ld %zu", &w.frames, &w.last, &w.all, &w.most, &w.plain,
                       &w.mostPlain) == 6) {
      all.push_back(w);
    }
    ::pclose(output_);
    return all;
  }

 private:
  std::FILE* output_ = nullptr;
};

// The process of the session ------------------------------------------------------------------------------------------

/// A page, timed: from the begin of a turn of the loop to its rest, where it has one step.
class TimedScreen final : public Screen {
 public:
  explicit TimedScreen(PageScreen& page) : page_(page) {}

  std::vector<double> us, cpuUs;  // of each frame of the session; 0 = it had no turn for itself
  std::function<void(const Scene&)> seen = [](const Scene&) {};

  [[nodiscard]] bool open() const override { return page_.open(); }
  [[nodiscard]] bool wantsStep() override { return page_.wantsStep(); }
  [[nodiscard]] WindowRequests takeRequests() override {
    if (us.empty() && choices().speed != 2.0) {  // recordings have 30 frames a second
      WindowChoices choices = page_.choices();
      choices.speed = 2.0;
      choices.paused = false;
      page_.setChoices(choices);
    }
    begin_ = seconds();
    cpuBegin_ = threadMicroseconds();
    return page_.takeRequests();
  }
  void addTimes(std::span<const TimedStage> stages) override {
    ++steps_;
    page_.addTimes(stages);
  }
  void rest(double time) override {
    const double cpu = threadMicroseconds() - cpuBegin_, wall = 1e6 * (seconds() - begin_);
    for (int i = 0; i < steps_; ++i) {
      us.push_back(steps_ == 1 ? wall : 0.0);
      cpuUs.push_back(steps_ == 1 ? cpu : 0.0);
    }
    steps_ = 0;
    page_.rest(time);
  }
  void show(const Scene& scene, const WindowValues& values) override {
    seen(scene);
    page_.show(scene, values);
  }
  void chooseFiles() override {}
  [[nodiscard]] bool takeCancel() override { return page_.takeCancel(); }
  [[nodiscard]] HandAim aim(int hand) const override { return page_.aim(hand); }
  [[nodiscard]] Camera camera() const override { return page_.camera(); }
  void setCamera(const Camera& camera) override { page_.setCamera(camera); }
  void notice(std::string sentence, double time) override { page_.notice(std::move(sentence), time); }
  void problem(std::string sentence) override { page_.problem(std::move(sentence)); }
  void setTitle(const std::string& title) override { page_.setTitle(title); }
  [[nodiscard]] const WindowChoices& choices() const override { return page_.choices(); }
  void setChoices(const WindowChoices& choices) override { page_.setChoices(choices); }

 private:
  PageScreen& page_;
  int steps_ = 0;
  double begin_ = 0.0, cpuBegin_ = 0.0;
};

/// The demo's props and so many boxes, which fall around the figure, that there are kProps.
World world() {
  World world = makeDemoWorld(kDemoSeed);
  for (int i = static_cast<int>(world.props().size()); i < kProps; ++i) {
    Prop box;
    const double angle = 2.4 * i;  // the golden angle: evenly around
    const double radius = 0.9 + 0.02 * i;
    box.worldFromProp.translation() = Vec3(radius * std::cos(angle), 1.0 + 0.06 * i, radius * std::sin(angle));
    world.addProp(box);
  }
  return world;
}

std::set<std::string> threads() {
  std::set<std::string> ids;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task")) ids.insert(entry.path().filename());
  return ids;
}

/// CPU time of a thread [s].
double secondsOfThread(const std::string& id) {
  double nanoseconds = 0.0;
  std::ifstream("/proc/self/task/" + id + "/schedstat") >> nanoseconds;
  return 1e-9 * nanoseconds;
}

struct Pass {
  std::vector<double> us, cpuUs;
  double serverShare = 0.0;  // of a core
  double hertz = 0.0;        // of the session
  std::vector<Watcher> watchers;
  std::uint64_t hash = 0;
};

Result<Pass> perform(const CastRequest& request, int count, Host& host) {
  LORICA_TRY(Cast cast, prepareCast(request, host));
  cast.world = world();
  RunSetting setting;
  setting.atEnd = AtEnd::kReturn;
  LORICA_TRY(const std::unique_ptr<Run> run, Run::start(std::move(cast), setting, host));
  const std::set<std::string> before = threads();
  LORICA_TRY(std::unique_ptr<PageServer> server, PageServer::start({}));
  std::string serverThread;
  for (const std::string& id : threads()) {
    if (!before.contains(id)) serverThread = id;
  }
  PageScreen page(*server, nullptr);
  LORICA_TRY_DO(page.begin(*run, host));
  Watchers watchers(server->port(), count);
  while (server->clients() < count || (count > 0 && server->layers() == 0)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  TimedScreen screen(page);
  Shown shown{&screen, {}, nullptr, {}};
  const double begin = seconds(), cpuBegin = secondsOfThread(serverThread);
  LORICA_TRY_DO(play(*run, shown, host));
  Pass pass;
  const double took = seconds() - begin;
  pass.serverShare = (secondsOfThread(serverThread) - cpuBegin) / took;
  pass.hertz = run->session.frameCount() / took;
  server.reset();
  pass.watchers = watchers.results();
  pass.us = std::move(screen.us);
  pass.cpuUs = std::move(screen.cpuUs);
  pass.hash = run->session.hash();
  return pass;
}

/// The times of each frame, least of the repeats; infinity = it never had a turn for itself.
void takeLeast(const std::vector<double>& times, std::vector<double>& least) {
  least.resize(std::max(least.size(), times.size()), std::numeric_limits<double>::infinity());
  for (std::size_t f = 0; f < times.size(); ++f) {
    if (times[f] > 0.0) least[f] = std::min(least[f], times[f]);
  }
}

double medianOfThose(std::vector<double> times) {
  std::erase_if(times, [](double time) { return !std::isfinite(time); });
  return medianOf(std::move(times));
}

/// How many times as long the frames take, over those that both have.
double ratioOf(std::span<const double> times, std::span<const double> reference) {
  double a = 0.0, b = 0.0;
  for (std::size_t f = 0; f < std::min(times.size(), reference.size()); ++f) {
    if (!std::isfinite(times[f] + reference[f])) continue;
    a += times[f];
    b += reference[f];
  }
  return a / b;
}

struct Measured {
  std::vector<double> us, cpuUs;  // least of the repeats
  std::vector<double> allUs;      // of all frames of all repeats
  std::vector<double> shares, sessionHertz, hertz;
  double bytes = 0.0, plain = 0.0, frames = 0.0;
  std::size_t most = 0, mostPlain = 0;
  std::uint64_t hash = 0;
};

int run(const Options& options) {
  tbb::global_control oneCore(tbb::global_control::max_allowed_parallelism, 1);
  Host host;
  CastRequest request;
  request.motion = options.motion;
  request.reading.drawn = true;
  std::map<int, Measured> all;
  for (int repeat = 0; repeat < options.repeats; ++repeat) {
    for (const int count : kWatchers) {
      const Result<Pass> pass = perform(request, count, host);
      if (!pass) return fail(pass.error());
      Measured& measured = all[count];
      takeLeast(pass->us, measured.us);
      takeLeast(pass->cpuUs, measured.cpuUs);
      for (const double us : pass->us) {
        if (us > 0.0) measured.allUs.push_back(us);
      }
      measured.shares.push_back(pass->serverShare);
      measured.sessionHertz.push_back(pass->hertz);
      measured.hash = pass->hash;
      for (const Watcher& w : pass->watchers) {
        measured.hertz.push_back(static_cast<double>(w.frames - 1) / w.last);
        measured.frames += static_cast<double>(w.frames);
        measured.bytes += static_cast<double>(w.all);
        measured.plain += static_cast<double>(w.plain);
        measured.most = std::max(measured.most, w.most);
        measured.mostPlain = std::max(measured.mostPlain, w.mostPlain);
      }
    }
  }
  fmt::print(
      "clients,session_cpu_us,cpu_ratio,session_us,wall_ratio,all_wall_ratio,server_core_share,session_hz,least_hz,"
      "median_hz,"
      "avatar_and_props_bytes,most,with_hulls_bytes,most,kilobytes_a_second,hash\n");
  const Measured& alone = all[0];
  for (const auto& [count, m] : all) {
    const double frames = std::max(1.0, m.frames);
    fmt::print("{},{:.1f},{:.3f},{:.1f},{:.3f},{:.3f},{:.3f},{:.1f},{:.1f},{:.1f},{:.0f},{},{:.0f},{},{:.0f},{:016x}\n",
               count, medianOfThose(m.cpuUs), ratioOf(m.cpuUs, alone.cpuUs), medianOfThose(m.us),
               ratioOf(m.us, alone.us), medianOf(m.allUs) / medianOf(alone.allUs), medianOf(m.shares),
               medianOf(m.sessionHertz), atRank(m.hertz, 0.0), atRank(m.hertz, 0.5), m.plain / frames, m.mostPlain,
               m.bytes / frames, m.most, 1e-3 * m.bytes / frames * atRank(m.hertz, 0.5), m.hash);
  }
  return 0;
}

/// A virtual camera's images until they are read as frames by a client that wants hulls, and what a live session takes
/// while so many watch. The other clients are in a process of their own.
int measureLive(const Options& options, int count) {
  Host host;
  LiveRequest live;
  live.depth.virtualCamera = true;
  live.depth.motion = options.motion;
  CastRequest request;
  request.reading.drawn = true;
  Result<LiveCast> cast = prepareLiveCast(request, live, host);
  if (!cast) return fail(cast.error());
  const LiveJoints& joints = *cast->sources->tracked;
  RunSetting setting;
  setting.seconds = options.latency;
  const Result<std::unique_ptr<Run>> run = Run::start(std::move(*cast), setting, host);
  if (!run) return fail(run.error());
  Result<std::unique_ptr<PageServer>> server = PageServer::start({});
  if (!server) return fail(server.error());
  PageScreen page(**server, nullptr);
  if (const auto begun = page.begin(**run, host); !begun) return fail(begun.error());
  TimedScreen screen(page);
  std::map<double, double> arrived;  // by the session's time [s]
  screen.seen = [&](const Scene& scene) {
    if (joints.frameCount() == 0) return;  // nothing has come yet
    arrived.emplace(scene.time, std::chrono::duration<double>(joints.sight().arrived.time_since_epoch()).count());
  };
  Watcher watcher;
  std::thread client;
  if (count > 0 && !watcher.connect((*server)->port())) return 1;
  if (count > 0) {
    client = std::thread([&] {
      while (watcher.read()) {
      }
      ::close(watcher.socket);
    });
  }
  Watchers others((*server)->port(), count - 1);
  while ((*server)->clients() < count) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  Shown shown{&screen, {}, nullptr, {}};
  const Result<RunEnd> end = play(**run, shown, host);
  server->reset();
  if (client.joinable()) client.join();
  std::vector<double> hertz;
  if (count > 0) hertz.push_back(static_cast<double>(watcher.frames - 1) / (watcher.last - watcher.first));
  for (const Watcher& w : others.results()) hertz.push_back(static_cast<double>(w.frames - 1) / w.last);
  if (!end) return fail(end.error());
  std::vector<double> ms, posed;
  for (const auto& [time, at] : watcher.came) {
    if (arrived.contains(time) && at > arrived[time]) ms.push_back(1e3 * (at - arrived[time]));
  }
  for (const double us : (*run)->log.figures().latency) posed.push_back(1e-3 * us);
  const double mean = std::accumulate(ms.begin(), ms.end(), 0.0) / std::max<std::size_t>(ms.size(), 1);
  fmt::print("{},{},{:.2f},{:.2f},{:.2f},{:.2f},{:.2f},{:.1f},{:.1f}\n", count, ms.size(), mean, atRank(ms, 0.95),
             atRank(ms, 1.0), atRank(posed, 0.5), atRank(posed, 0.95), atRank(screen.cpuUs, 0.5), atRank(hertz, 0.0));
  return 0;
}

int measureLatency(const Options& options, std::span<const int> counts) {
  fmt::print("clients,frames,mean_ms,p95_ms,largest_ms,posed_median_ms,posed_p95_ms,session_cpu_us,least_hz\n");
  for (const int count : counts) {
    if (const int failed = measureLive(options, count); failed != 0) return failed;
  }
  return 0;
}

}  // namespace
}  // namespace lorica::bench

int main(int argc, char** argv) {
  lorica::bench::Options options;
  CLI::App app("Cost of a session that is watched on a page, beside the same session that nobody watches.");
  app.add_option("--motion", options.motion, "What the mannequin performs, at 60 frames a second");
  app.add_option("--latency", options.latency, "Instead: follow a virtual camera for so long [s]");
  app.add_flag("--all", options.all, "Both, the latter for each number of clients");
  app.add_option("--repeats", options.repeats, "The least time of each frame counts")->check(CLI::PositiveNumber);
  app.add_option("--watch-port", options.watchPort)->group("");
  app.add_option("--watchers", options.watchers)->group("");
  CLI11_PARSE(app, argc, argv);
  ::setenv("XDG_CONFIG_HOME", "/dev/null", 1);  // no choices that somebody has kept
  const std::filesystem::path here = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  ::setenv("LORICA_RECORDINGS", (here / "../../recordings").c_str(), 0);
  if (options.watchPort > 0) return lorica::bench::watch(options);
  constexpr int kOne = 1;
  if (options.latency > 0.0) return lorica::bench::measureLatency(options, {&kOne, 1});
  if (const int failed = lorica::bench::run(options); failed != 0 || !options.all) return failed;
  fmt::print("\n");
  options.latency = 15.0;
  return lorica::bench::measureLatency(options, lorica::bench::kWatchers);
}
