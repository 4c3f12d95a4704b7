#pragma once

#include "geometry/clock.h"
#include "session/prepare/detail_levels.h"
#include "session/prepare/scenes.h"
#include "viewer/player/follow_camera.h"
#include "viewer/player/hands.h"
#include "viewer/player/headset_link.h"
#include "viewer/player/monitored_host.h"
#include "viewer/player/run.h"
#include "viewer/player/snapshots.h"
#include "viewer/player/window_opener.h"
#include "viewer/player/window_settings.h"
#include "viewer/player/window_texts.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// The state of play(): run_loop.cpp runs the session and shows it, run_controls.cpp does what the user asks for,
/// run_worlds.cpp exchanges the world.
class RunLoop {
 public:
  RunLoop(Run& run, Shown& shown, Host& host);

  Result<RunEnd> run();
  /// Reads and writes what the user chose.
  void recallSettings();
  void keepSettings();

 private:
  /// A seek: the recording runs to a time without pictures.
  struct Seek {
    double to = 0.0;        // [s]
    std::string_view done;  // to be said then; empty = nothing
  };

  [[nodiscard]] bool onlyWatched() const { return run_.watched(); }
  [[nodiscard]] double seconds() const { return started_ ? session_.time() - firstTime_ : 0.0; }
  Result<RunEnd> runUnseen();
  void listControls();
  Result<void> answer(const std::vector<Change>& changes);
  void perform(const Change& change);
  void report(const Result<void>& done);
  [[nodiscard]] std::string_view whyNot(ControlId id) const;
  void record(bool on);
  void open(const Change& change);
  void takeLoaded();
  [[nodiscard]] Result<std::vector<std::unique_ptr<PoseSource>>> sources() const;
  Result<void> treat();
  [[nodiscard]] std::function<Result<World>(Host&)> worldOf(int scene) const;
  void prepareWorld(std::optional<int> scene);
  Result<void> takeWorld();
  void describeNextWorld(WindowValues& values);
  [[nodiscard]] bool startsAgain() const { return nextWorld_ != nullptr && !nextScene_; }
  Result<void> beginSeek(double to);
  Result<void> runSeek();
  Result<void> advance();
  Result<void> step();
  void goOn();
  Result<void> runAgain(std::string_view done = {});
  [[nodiscard]] double restSeconds() const;
  [[nodiscard]] bool mayLoop() const { return run_.setting.atEnd != AtEnd::kHold && run_.restartable(); }
  [[nodiscard]] bool loops() const;
  [[nodiscard]] bool goesOn() const { return ended_ && run_.setting.atEnd == AtEnd::kChoice; }
  Result<void> startOver();
  Result<void> findFirstParts();
  Result<void> restart();
  Result<void> restartIn(World world);
  [[nodiscard]] Result<bool> stepSession();
  void followHeadsets();
  void describe() { status_ = statusOf(session_, ended_); }
  void show();

  Run& run_;
  Shown& shown_;
  Host& host_;
  Screen* screen_;  // null = none: then there is no more than steps and pictures
  Session& session_;
  SceneList scenes_;
  std::optional<SessionScene> scene_;   // on a screen
  std::optional<DetailLevels> levels_;  // on a screen
  Hands hands_;
  HeadsetLink headset_;
  WarningBoard warnings_;
  WindowSettings settings_;                           // of the user, with what was dropped since
  WindowSettings keptSettings_;                       // as in the user's file
  std::string remark_;                                // about the files that are loading
  SceneOptions firstShown_;                           // when the session came to the screen
  Treatment treatment_;                               // of the session
  std::unique_ptr<BackgroundWork<World>> nextWorld_;  // which the session comes into when it has settled; null = none
  std::optional<int> nextScene_;                      // of nextWorld_; none = the present one, at its start
  MonitoredHost::Progress progress_;                  // of nextWorld_
  PartsOfAvatars firstParts_;                         // in the first frame, for settling again; empty = unknown
  std::vector<std::vector<LivePart>> standing_;       // parts of the avatars after the end
  AvatarFocus focus_;
  std::vector<std::string> avatarNames_;
  std::string title_;
  Controls controls_;
  std::optional<double> seekTo_;  // was asked for in this turn [s]
  bool forgetsLast_ = false;      // the same of the last action
  std::optional<Seek> seek_;
  double due_;  // of the next frame [s]
  double firstTime_ = 0.0;
  double frameBegin_ = 0.0;  // time of the previous frame, since the first [s]
  bool started_ = false, ended_ = false;
  std::uint64_t changes_ = 0;     // of the scene, see WindowValues
  bool aimed_ = false;            // the camera was set for the first frame with an avatar
  bool closed_ = false;           // while the session settled
  int shownFrame_ = 0;            // without a screen
  const Image* inset_ = nullptr;  // null = none
  std::string status_;
  std::vector<std::string> expressions_;  // of the avatar's face
  int expression_ = -1;                   // chosen on the screen
};

}  // namespace lorica
