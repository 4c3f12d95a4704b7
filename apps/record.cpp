#include "apps/interrupt.h"
#include "apps/option_groups.h"
#include "apps/options.h"
#include "apps/report_parts.h"
#include "apps/show.h"
#include "capture/files/joint_csv.h"
#include "capture/sensor/depth_recording.h"
#include "capture/streams/packet_file.h"
#include "capture/streams/udp.h"
#include "capture/tracking/tracker.h"
#include "export/motion_export.h"
#include "geometry/counts.h"
#include "geometry/descriptor.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/hard_stop.h"
#include "geometry/new_file.h"
#include "geometry/text.h"
#include "session/prepare/scenes.h"
#include "session/prepare/stream_motion.h"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace lorica {
namespace {

namespace fs = std::filesystem;

/// The options of `lorica record`; a depth recording uses only the file, the camera and the limit.
struct RecordOptions {
  std::string out;
  std::string into = {};  ///< what `finished` makes of it, which reports name; empty = it stays
  CastRequest request;    ///< no motion = a live camera
  bool sceneGiven = false;
  LiveRequest live;
  RunSetting limits;  ///< its frames and seconds
};

bool followsPeople(const CastRequest& request) {
  return request.motion.empty() && request.performing.clip.empty();
}

/// The people before the camera, or what sends, as `lorica live` follows them.
LiveRequest liveOf(const RecordOptions& options) {
  LiveRequest live = options.live;
  live.person = options.request.performing.person;
  return live;
}

Result<std::unique_ptr<Run>> startRecorded(const RecordOptions& options, Host& host) {
  RunSetting setting = options.limits;
  setting.record = options.out;
  setting.doing = "Recording";
  if (followsPeople(options.request)) {
    CastRequest request = options.request;
    if (!options.sceneGiven) request.scene = kEmptyStage;
    LORICA_TRY(LiveCast live, prepareLiveCast(request, liveOf(options), host));
    return Run::start(std::move(live), setting, host);
  }
  LORICA_TRY(Cast cast, prepareCast(options.request, host));
  return Run::start(std::move(cast), setting, host);
}

Result<void> checkSource(const RecordOptions& options, const Host& host) {
  const CastRequest& request = options.request;
  const LiveRequest& live = options.live;
  if (followsPeople(request) && request.performing.person == kEveryone) {
    return invalidArgument(
        "--person all: found a camera, expected a recording; --people says how many avatars follow a camera");
  }
  if (followsPeople(request)) return checkLive(liveOf(options), host);
  const std::string& motion = request.motion.empty() ? request.character : request.motion;
  const char* other = live.people > 1 ? "--people" : !live.vmc.listenAt.empty() ? "--vmc" : nullptr;
  if (other != nullptr) return invalidArgument("found a motion and {}, expected only one of them", other);
  if (live.depth.asked()) {
    return invalidArgument("found a motion, {}, and a camera, expected only one of them", motion);
  }
  return checkVmcInput(live.vmc, host);
}

constexpr const char* kSessionEnding = ".lsession";

struct Recording {
  int frames = 0;  // depth frames in the file
  int rows = 0;    // of the joint CSV
  double seconds = 0.0;
  bool unplugged = false;  // at any time
};

/// The joint CSV next to the depth recording.
fs::path jointsBeside(const std::string& out) {
  return fs::path(out).replace_extension(".csv");
}

/// The files that the options name, which no report may overwrite.
std::vector<fs::path> recordFiles(const RecordOptions& options) {
  std::vector<fs::path> files = options.request.files();
  files.emplace_back(options.out);
  return files;
}

/// Tracks what is recorded, until the limit or Ctrl-C.
Result<Recording> record(DepthRecorder& recorder, Tracker& tracker, JointCsvWriter& joints, Host& host) {
  Recording recording;
  std::optional<double> firstTime;
  DepthFrame frame;
  std::mutex files;  // the program may be ended while the camera waits
  bool finished = false;
  const auto finish = [&]() -> Result<void> {
    const std::lock_guard<std::mutex> lock(files);
    if (std::exchange(finished, true)) return {};
    const Result<int> rows = joints.finish();
    if (!firstTime) {  // ended before the first image
      recorder.discard();
      return cancelled();
    }
    const Result<int> frames = recorder.finish();
    if (!rows) return rows.error();
    if (!frames) return frames.error();
    recording.rows = *rows;
    recording.frames = *frames;
    return {};
  };
  const AtHardStop finishing([&] { (void)finish(); });
  for (;;) {
    if (host.cancelled()) recorder.stop();
    const Result<DepthRead> got = recorder.next(frame);
    if (!got) {
      (void)finish();  // keep what was recorded despite the error
      return got.error();
    }
    recording.unplugged |= *got == DepthRead::kUnplugged;
    if (*got == DepthRead::kEnd) break;
    if (*got != DepthRead::kFrame) continue;
    const std::span<const TrackedPerson> people = tracker.track(frame);
    const std::lock_guard<std::mutex> lock(files);
    if (finished) break;  // the program is being ended
    for (const TrackedPerson& person : people) LORICA_TRY_DO(joints.add(person.skeleton));
    if (!firstTime) firstTime = frame.time;
    recording.seconds = frame.time - *firstTime;
  }
  answerInterrupt();
  LORICA_TRY_DO(finish());
  return recording;
}

/// Rejects options about the performance: depth images are recorded as they are; these options apply when they are
/// played.
Result<void> refuseSessionOptions(const CLI::App& app, const RecordOptions& options) {
  for (const char* name :
       {"MOTION",  "--character", "--map",     "--body-resolution", "--expression", "--hide",
        "--walls", "--thickness", "--springs", "--decomposition",   "--cover",      "--hull-vertices",
        "--scene", "--inject",    "--mirror",  "--upper-body",      "--smooth",     "--min-cutoff",
        "--beta",  "--clip",      "--format",  "--person",          "--people",     "--lens"}) {
    if (app.count(name) == 0) continue;
    return invalidArgument("{}: {} is for sessions ({}), not for depth recordings (.oni)", options.out, name,
                           kSessionEnding);
  }
  return {};
}

Result<void> recordDepth(const RecordOptions& options, const CommonOptions& common, Host& host) {
  LORICA_TRY_DO(checkJsonOutput(common, {options.out, jointsBeside(options.out)}));
  LORICA_TRY_DO(checkOutput(common, "OUT", options.out, ".oni"));
  LORICA_TRY_DO(checkOutput(common, "OUT", jointsBeside(options.out)));
  LORICA_TRY_DO(checkDepth(options.live.depth));
  LORICA_TRY(const std::unique_ptr<DepthSource> depth,
             openWaiting<std::unique_ptr<DepthSource>>(options.live.depth, host,
                                                       [given = options.live.depth] { return openDepth(given); }));
  LORICA_TRY(Tracker tracker, Tracker::create(depth->camera()));
  LORICA_TRY(JointCsvWriter joints, JointCsvWriter::create(jointsBeside(options.out)));
  std::optional<AtHardStop> starting(std::in_place, [&] { (void)joints.finish(); });  // removes the empty file
  Result<std::unique_ptr<DepthRecorder>> recorder =
      DepthRecorder::start(*depth, options.out, {options.limits.frames, options.limits.seconds});
  if (!recorder) {
    (void)joints.finish();
    return recorder.error();
  }
  starting.reset();
  warnOfFound((*recorder)->found(), host);
  warnOfFound(joints.found(), host);

  host.tell(fmt::format("Recording {}; press Ctrl-C to stop.", depth->name()));
  LORICA_TRY(const Recording made, record(**recorder, tracker, joints, host));

  Report report(
      fmt::format("Recorded {} of {} ({:.1f} s)", counted(made.frames, "depth frame"), depth->name(), made.seconds));
  report.add("source", depth->name());
  report.add("depth", "depth", options.out);
  report.add("frames", made.frames);
  report.add("seconds", made.seconds);
  const std::string file = made.rows > 0 ? jointsBeside(options.out).string() : "";
  report.add("joints", "joints", orNull(file),
             made.rows > 0 ? fmt::format("{}, {}", file, counted(made.rows, "skeleton")) : "no person found");
  report.add("skeletons", made.rows);
  report.add("unplugged", made.unplugged);
  if (made.unplugged) report.note("The sensor was unplugged during the recording.");
  return publish(common, report);
}

/// How many avatars the options ask for, as far as is known before anything is read.
std::size_t avatarsOf(const RecordOptions& options) {
  return followsPeople(options.request) ? liveOf(options).avatars() : namesIn(options.request.motion).size();
}

/// Plays motions, or follows the people before a camera or programs that send, and records the session without a
/// window.
/// @param finished  called when the file is complete
Result<void> recordSession(const RecordOptions& options, const CommonOptions& common, Host& host,
                           const std::function<Result<void>()>& finished = {}) {
  LORICA_TRY_DO(checkSource(options, host));
  LORICA_TRY(const std::unique_ptr<Run> run, startRecorded(options, host));
  const Session& session = run->session;
  if (run->live()) host.tell(fmt::format("Recording {}; press Ctrl-C to stop.", run->name()));
  Shown shown;
  const Result<RunEnd> end = play(*run, shown, host);
  answerInterrupt();
  if (host.cancelled() && session.frameCount() == 0) {
    (void)run->recorder->finish();  // removes the file
    return cancelled();
  }
  const int avatars = countOf(session.avatars());
  Report report(fmt::format("Recorded {}{}: {} ({:.1f} s)", run->name(),
                            avatars > 1 ? fmt::format(", {}", counted(avatars, "avatar")) : "",
                            counted(session.frameCount(), "step"), run->seconds()),
                "source character seconds avatars hash");
  report.add("source", run->name());
  report.add("character", session.character().name);
  report.add("seconds", run->seconds());
  report.add(avatarFacts(session));
  LORICA_TRY_DO(finishRecorder(*run, options.into.empty() ? options.out : options.into, report));
  if (!end) return end.error();
  for (const VmcInput& stream : run->streams()) {
    const Facts facts = streamFacts(stream);
    report.add(&stream == &run->streams().front() ? facts : facts.textOnly());
  }
  if (finished) LORICA_TRY_DO(finished());
  report.add("hash", "hash", hexDigits(session.hash()));
  return publish(common, report);
}

/// How long the socket is waited for before Ctrl-C is looked for [s].
constexpr double kPollSeconds = 0.1;

std::uint64_t microsecondsNow() {
  const auto since = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::microseconds>(since).count();
}

/// Writes the packets that arrive to a .pcap file until Ctrl-C or the limit of seconds. It is readable at any time.
/// @param options   of which --vmc, the files and the limit of seconds count
/// @param finished  called when the file is complete
Result<void> recordPackets(const RecordOptions& options, const CommonOptions& common, Host& host,
                           const std::function<Result<void>()>& finished) {
  const std::string& listenAt = options.live.vmc.listenAt;
  const Result<NetworkAddress> address = parseNetworkAddress(listenAt, false);
  LORICA_TRY(UdpSocket socket, prefixed("--vmc", address ? UdpSocket::listen(*address) : address.error()));
  const fs::path file = options.out;
  LORICA_TRY(const std::optional<fs::path> found, keepFound(file));
  warnOfFound(found, host);
  LORICA_TRY(const int descriptor, createPart(file));
  const Descriptor written(descriptor);
  std::atomic<int> packets = 0;
  const auto removeIfEmpty = [&] {
    if (std::error_code ignored; packets == 0) fs::remove(file, ignored);
  };
  const AtHardStop removing(removeIfEmpty);
  std::uint64_t bytes = 0;
  // Each packet is handed to the system at once, so that a killed program loses none.
  const auto write = [&](const std::string& piece) -> Result<void> {
    const int error = writeAll(descriptor, piece, &bytes);
    return error == 0 ? Result<void>() : unwritable(file, error);
  };
  LORICA_TRY_DO(write(packetFileHeader()));

  host.tell(fmt::format("Recording what is sent to {}; press Ctrl-C to stop.", textOf(*address)));
  std::vector<std::byte> memory(kLargestPacket);
  std::optional<std::uint64_t> first;
  double seconds = 0.0;
  bool full = false;
  while (!host.cancelled()) {
    const std::optional<UdpSocket::Packet> packet = socket.receive(memory, kPollSeconds);
    const std::uint64_t now = microsecondsNow();
    if (packet) {
      if (!first) first = now;
      const std::string record = packetRecord(std::span(memory).first(packet->size), now, packet->port, address->port);
      full = bytes + record.size() > kMaxFileBytes;
      if (full) break;
      ++packets;
      LORICA_TRY_DO(write(record));
    }
    seconds = first ? 1e-6 * (now - *first) : 0.0;
    if (options.limits.seconds > 0.0 && seconds >= options.limits.seconds) break;
  }
  answerInterrupt();
  removeIfEmpty();
  if (packets == 0) return cancelled();
  Report report(fmt::format("Recorded {} to {} ({:.1f} s)", counted(packets, "packet"), textOf(*address), seconds));
  LORICA_TRY_DO(finished());
  report.add("recording", "motion", options.into);
  report.add("packets", packets.load());
  report.add("seconds", seconds);
  if (full) {
    report.note(
        fmt::format("The recording ends where its file reached {} MiB, the most that is read.", kMaxFileBytes >> 20));
  }
  return publish(common, report);
}

/// A motion while it happens: the session, or what is sent, is recorded, and converted at its end. If the program is
/// killed, that is left, which `lorica convert` reads.
Result<void> recordMotion(const RecordOptions& options, const CommonOptions& common, Host& host) {
  LORICA_TRY_DO(checkJsonOutput(common, recordFiles(options)));
  LORICA_TRY_DO(checkOutput(common, "OUT", options.out));
  if (options.request.performing.person == kEveryone) {
    return invalidArgument(
        "{}: found --person all, expected the number of one person: a motion file holds one skeleton, a session ({}) "
        "any number",
        options.out, kSessionEnding);
  }
  if (const std::size_t avatars = avatarsOf(options); avatars > 1) {
    return invalidArgument(
        "{}: found {} avatars, expected one: a motion file holds one skeleton, a session ({}) any number", options.out,
        avatars, kSessionEnding);
  }
  // What a program sends needs no character: its packets are kept until then.
  const bool sent = !options.live.vmc.listenAt.empty() && options.request.motion.empty() &&
                    options.request.character.empty() && options.limits.frames == 0;
  RecordOptions first = options;
  first.out = options.out + (sent ? ".part.pcap" : kSessionEnding);
  first.into = options.out;
  if (!sent) LORICA_TRY_DO(checkOutput(common, "OUT", first.out));  // is removed in the end
  const auto finished = [&]() -> Result<void> {
    MotionOptions reading;
    reading.sender = options.live.vmc.sender;
    host.paths = PathTrust::kAnywhere;  // the session names what the user named
    LORICA_TRY(const Motion motion, readMotion(first.out, reading, host));
    // Poses of bones are mirrored already in a session.
    LORICA_TRY_DO(
        writeMotion(options.out, motion, motion.bones && !sent ? MotionOptions() : options.request.performing));
    std::error_code ignored;
    fs::remove(first.out, ignored);
    return {};
  };
  return sent ? recordPackets(first, common, host, finished) : recordSession(first, common, host, finished);
}

Result<void> runRecord(const CLI::App& app, const RecordOptions& options, const CommonOptions& common, Host& host) {
  const std::string ending = lowerCase(fs::path(options.out).extension().string());
  if (ending == kSessionEnding) {
    LORICA_TRY_DO(checkJsonOutput(common, recordFiles(options)));
    LORICA_TRY_DO(checkRecord(common, "OUT", options.out));
    return recordSession(options, common, host);
  }
  if (ending == ".bvh" || ending == ".csv") return recordMotion(options, common, host);
  if (ending != ".oni") {
    return invalidArgument(
        "OUT: found {}, expected a name that ends in .oni (depth), {} (a session), .bvh or .csv (a motion)",
        options.out, kSessionEnding);
  }
  LORICA_TRY_DO(refuseSessionOptions(app, options));
  if (app.count("--vmc") > 0) return invalidArgument("{}: --vmc sends no depth images", options.out);
  return recordDepth(options, common, host);
}

}  // namespace

Command addRecord(CLI::App& parent, CommonOptions& common) {
  const auto options = std::make_shared<RecordOptions>();
  CLI::App* app = addSubcommand(
      parent, common, "record",
      "Record what happens live: depth images (.oni), a motion (.bvh, .csv), or a session to replay (.lsession).",
      "  lorica record body.oni\n"
      "      depth images to body.oni and tracked joints to body.csv, until Ctrl-C\n"
      "  lorica record body.oni --seconds 10 --device 1d27/0609@1/4\n"
      "  lorica record body.oni --depth 7000\n"
      "      what another program sends, see docs/SENSORS.md\n"
      "  lorica record body.oni --virtual --seconds 3\n"
      "      no camera needed: a virtual camera with a virtual person\n"
      "  lorica play body.oni\n"
      "      play the recording\n"
      "  lorica record kick.lsession punch_and_kick --scene bowling\n"
      "      a session: joints, character, settings, scene, and a hash of the result of each step\n"
      "  lorica record me.lsession --seconds 20 --inject dropout=0.1,seed=7\n"
      "      of the person before the camera, with simulated tracking faults\n"
      "  lorica record duel.lsession walk,wave\n"
      "  lorica record we.lsession --people 2 --seconds 20\n"
      "      two avatars: motions side by side, or the people before the camera\n"
      "  lorica replay kick.lsession\n"
      "      run it again and compare the results\n"
      "  lorica record take.bvh --vmc 39539\n"
      "      a motion that a program sends by the VMC protocol; or take.csv, or take.lsession\n"
      "\nDuring the recording the files are named body.part.oni, body.part.csv and kick.part.lsession.\n"
      "They are readable even if the program is killed; the next recording of that name keeps them as "
      "body.found-1.oni, ...");
  app->add_option("OUT", options->out, "The recording to write: .oni, .lsession, .bvh or .csv")->required();
  addMotionOptions(*app, options->request);
  addFaultOption(*app, options->request.performing);
  addBodyOptions(*app, options->request.body);
  addSceneOption(*app, options->request.scene, "none where people are followed, else demo")
      ->each([options](const std::string&) { options->sceneGiven = true; });
  addDepthOptions(*app, options->live.depth);
  addCount(*app, "--people", options->live.people, 1,
           "People before the camera to record, each with an avatar, at most 6; a session only [default: 1]");
  addVmcInputOptions(*app, options->live.vmc);
  addCount(*app, "--frames", options->limits.frames, 1, "Stop after N frames");
  addSeconds(*app, "--seconds", options->limits.seconds, "Stop after S seconds");
  return {app, [app, options](const CommonOptions& given, Host& host) {
            const bool live = options->request.motion.empty();
            if (live) options->live.vmc.sender = options->request.performing.sender;
            return runRecord(*app, *options, given, host);
          }};
}

}  // namespace lorica
