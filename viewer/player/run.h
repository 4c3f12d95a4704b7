#pragma once

#include "capture/sensor/depth_recording.h"
#include "capture/tracking/depth_joints.h"
#include "collision/hulls/host.h"
#include "geometry/result.h"
#include "session/prepare/cast.h"
#include "session/prepare/live_cast.h"
#include "session/prepare/recorded_cast.h"
#include "session/recording/session_recorder.h"
#include "session/recording/session_replay.h"
#include "session/session.h"
#include "viewer/player/events_output.h"
#include "viewer/player/pose_output.h"
#include "viewer/player/run_statistics.h"
#include "viewer/player/window_settings.h"
#include "viewer/renderer/image.h"
#include "viewer/renderer/screen.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lorica {

class WindowOpener;
struct Background;

/// What happens when a recording is over or its limit is reached.
enum class AtEnd : std::uint8_t {
  kReturn,
  kHold,    ///< the last frame stays
  kChoice,  ///< as the user chose on the screen: it starts again, or the world continues around the last pose
  kRepeat
};

/// How a run ends, and what is written and sent meanwhile.
struct RunSetting {
  std::string record;  ///< .lsession file; empty = none
  std::string events;  ///< file or -; empty = none
  PoseOutputOptions out;
  int frames = 0;                ///< maximum number; 0 = no limit
  double seconds = 0.0;          ///< maximum duration [s]; 0 = no limit
  double repeated = 0.0;         ///< maximum duration with all repetitions [s]; 0 = no limit
  bool hurry = false;            ///< on a screen: as fast as possible instead of in real time
  bool sumUp = false;            ///< statistics are of all repetitions; else of the last one
  bool selfContacts = false;     ///< count them, see RunStatistics
  bool allLayers = false;        ///< on a screen: it begins with all layers, whatever the user switched off elsewhere
  AtEnd atEnd = AtEnd::kChoice;  ///< on a screen
  // Of the task that is reported without a screen.
  std::string doing = "Playing";
  std::string unit = "frames";
  int expected = 0;  ///< frames, if fewer than the maximum are usual; 0 = the maximum

  [[nodiscard]] bool written() const { return !record.empty() || !events.empty() || out.any(); }
};

/// A session that runs: what moves its avatars, what is counted and what is written. Made from any cast; `play()` runs
/// it on a screen, with pictures or with neither.
class Run {
 public:
  /// @param cast  of motions
  [[nodiscard]] static Result<std::unique_ptr<Run>> start(Cast cast, RunSetting setting, Host& host);
  [[nodiscard]] static Result<std::unique_ptr<Run>> start(LiveCast live, RunSetting setting, Host& host);
  /// The steps are compared with the recorded ones.
  [[nodiscard]] static Result<std::unique_ptr<Run>> start(RecordedCast recorded, RunSetting setting, Host& host);

  Cast cast;  ///< without its world
  RunSetting setting;
  PosesSent sent;
  Session session;
  RunStatistics statistics;
  TargetHits hits;
  TreatmentControl treatment;
  LiveLog log;                                  ///< of a camera
  Image inset;                                  ///< the camera's depth image, live or recorded
  std::shared_ptr<SessionReplay> comparison;    ///< of a recorded session; else null
  std::shared_ptr<SessionRecorder> recorder;    ///< null = none
  std::function<void(Run&, Host&)> first = {};  ///< called after the first frame, each time that it starts

  /// 0 = live.
  [[nodiscard]] double duration() const { return cast.seconds; }
  [[nodiscard]] const std::string& name() const { return cast.name; }
  [[nodiscard]] bool live() const { return live_ != nullptr; }
  [[nodiscard]] bool tracked() const { return live_ != nullptr && live_->tracked != nullptr; }
  [[nodiscard]] const std::vector<VmcInput>& streams() const;
  /// A recorded session is only watched: nothing can be thrown or chosen.
  [[nodiscard]] bool watched() const { return recorded_ != nullptr; }
  [[nodiscard]] const SessionFile& recorded() const { return *recorded_->session; }
  /// Whether all sources can start again.
  [[nodiscard]] bool restartable() const { return !live(); }
  /// Whether mirror and smoothing can be changed while it runs.
  [[nodiscard]] bool treatable() const { return !watched() && (live_ == nullptr || live_->vmc.empty()); }

  /// Whether a step would not have to wait.
  [[nodiscard]] bool ready() const;
  /// What is wrong with the source; empty = nothing.
  [[nodiscard]] std::string trouble() const;
  /// The program that sends depth; null = a camera, or something else.
  [[nodiscard]] const DepthStream* depthStream() const { return live_ != nullptr ? live_->sent : nullptr; }
  /// What a depth camera saw last; null without one.
  [[nodiscard]] const DepthSight* sight() const { return tracked() ? &live_->tracked->sight() : nullptr; }
  /// Of somebody who is followed; null if nobody is.
  [[nodiscard]] std::shared_ptr<WornHeadset> headset() const { return live_ ? live_->headset : nullptr; }
  /// Time for tracking [s].
  [[nodiscard]] std::optional<double> trackingSeconds() const;
  /// Counts the session's last frame.
  void stepped(Host& host);
  /// Draws the camera's image into `inset`; null without one.
  const Image* drawInset();
  /// Call before the first frame is repeated.
  [[nodiscard]] Result<void> restarted(Host& host);
  /// Another scene was opened. @param scene  as the user gave it
  void sceneChosen(const std::string& scene, Host& host);
  [[nodiscard]] Result<World> worldAgain(Host& host) const { return recorded_->world(host); }
  /// Since the first frame, with all repetitions [s].
  [[nodiscard]] double seconds() const { return before_ + now_; }
  [[nodiscard]] bool enough() const { return setting.repeated > 0.0 && seconds() >= setting.repeated; }

  /// Ends a recording that was begun on a screen; the session goes on. @return number of recorded steps
  [[nodiscard]] Result<int> stopRecording();

  /// Ends the events' file.
  [[nodiscard]] Result<void> finish() { return events_ ? events_->finish() : Result<void>(); }

 private:
  Run(Cast cast, RunSetting setting, Session session);
  [[nodiscard]] static Result<std::unique_ptr<Run>> make(Cast cast, RunSetting setting, Host& host);
  [[nodiscard]] Result<void> watch(Host& host);
  /// What the camera saw in a depth recording at the session's time; none if it cannot be read.
  [[nodiscard]] std::optional<DepthSight> recordedSight();

  std::vector<HitTarget> targets_;
  TreatmentControl unrecorded_;  // what can be chosen when nothing is written
  std::shared_ptr<LiveSources> live_;
  std::unique_ptr<RecordedCast> recorded_;
  std::unique_ptr<DepthRecording> depth_;  // of a recording, once it was shown
  std::shared_ptr<EventsOutput> events_;
  double firstTime_ = 0.0, before_ = 0.0, now_ = 0.0;  // [s]
  int frames_ = 0;                                     // since the start or restart
};

/// Why play() returned.
enum class RunEnd : std::uint8_t {
  kOver,
  kClosed,       ///< the user closed the screen
  kInterrupted,  ///< the host was cancelled
  kExchanged     ///< the user opened something else, which is in Shown::next
};

/// What shows a run.
struct Shown {
  Screen* screen = nullptr;                    ///< people watch and control it; null = none
  std::function<Result<bool>()> picture = {};  ///< called after each frame; false ends the run. Null = no pictures
  WindowOpener* opener = nullptr;              ///< opens files that are dropped on the screen; null = they are refused
  std::optional<Cast> next = {};               ///< see RunEnd::kExchanged
  std::string record = {};                     ///< the file to record `next` to; empty = none
  const Background* background = nullptr;      ///< as the command says; null = as it is kept
};

/// Runs the session until it is over, the screen is closed or the host is cancelled.
///
/// On a screen it runs in real time and skips no frame: if drawing is slow, fewer pictures are drawn. Going back in
/// time restarts the session and runs it to the requested frame without pictures; recorded user actions are repeated in
/// their frames until the user does something else. Without a screen it runs as fast as it can.
/// @return why it ended, or an error about the sources or pictures; what was recorded is kept then
[[nodiscard]] Result<RunEnd> play(Run& run, Shown& shown, Host& host);

/// Prepares a screen for a run: its title and what is drawn. @param background  see setBackground()
void prepareScreen(const Run& run, Screen& screen, const std::optional<Background>& background);

/// Draws the depth image: near is light, unmeasured pixels are black. The tracked joints are green if they are seen and
/// orange if they are guessed. The picture has half the width and height of the depth image; it stays empty before the
/// first one.
void drawDepthPicture(const DepthCamera& camera, const DepthSight& sight, Image& picture);

}  // namespace lorica
