#pragma once

#include "apps/options.h"
#include "apps/report.h"
#include "session/prepare/live_cast.h"
#include "viewer/page/page_screen.h"
#include "viewer/page/server.h"
#include "viewer/player/run.h"
#include "viewer/player/snapshots.h"
#include "viewer/player/window_opener.h"
#include "viewer/vr/headset_window.h"
#include "viewer/window/window.h"

#include <memory>
#include <optional>
#include <string>

namespace lorica {

/// --vr, and --serve and what belongs to it.
struct ServeOptions {
  bool serve = false, vr = false;
  ServeSetting setting;
  [[nodiscard]] bool any() const { return serve || vr; }
};

/// --vr, --serve, --port, --lan, --recordings, --certificate and --key. @param flag  whether the first two are asked
/// for; else it is served anyway
void addServeOptions(CLI::App& app, ServeOptions& options, bool flag);

/// What people watch: a window, a page, or both.
class Screens {
 public:
  /// @param pictures  size and background of the window
  [[nodiscard]] static Result<std::unique_ptr<Screens>> open(bool window, const ServeOptions& serve,
                                                             const SnapshotOptions& pictures, Host& host);
  /// Says where the page is: once there is something to see, so that nobody follows the link to a motion that is
  /// missing.
  void announce(Host& host) const;
  [[nodiscard]] Screen& screen() { return page_ ? static_cast<Screen&>(*page_) : *window_; }

 private:
  Screens() = default;
  std::unique_ptr<Window> window_;
  std::unique_ptr<PageServer> server_;
  std::optional<PageScreen> page_;
  bool lan_ = false;
};

/// What play, live and serve are asked for. They and replay share a run on a screen or with pictures, and its report.
struct ShowOptions {
  CastRequest request;
  bool sceneGiven = false;  ///< else whoever is followed stands on an empty stage
  LiveRequest live;         ///< of live and serve
  bool webcam = false;      ///< which nothing here can follow
  RunSetting run;
  SnapshotOptions pictures;
  bool window = false;
  ServeOptions serve;
};
[[nodiscard]] Result<void> play(const ShowOptions& options, const CommonOptions& common, Host& host);
[[nodiscard]] Result<void> follow(const ShowOptions& options, const CommonOptions& common, Host& host);
/// The demo on the page. @param options  its character and --serve
[[nodiscard]] Result<void> showDemo(const ShowOptions& options, const CommonOptions& common, Host& host);

/// Rejects --window if there is no display. @param instead  alternatives, for the error message
[[nodiscard]] Result<void> checkWindow(bool wanted, const std::string& instead);

/// Opens a window before there is a session. @param pictures  its size and background
[[nodiscard]] Result<Window> openWindow(const SnapshotOptions& pictures);

/// How a run was shown.
struct Showing {
  RunEnd end = RunEnd::kOver;
  DrawnFiles drawn;
  std::optional<Cast> next;  ///< the user opened it
  std::string record = {};   ///< the file to record it to; empty = none
};

/// Plays the run on the screen, or with the pictures without one.
/// @param screen  null = none @param opener  null = nothing else can be opened
[[nodiscard]] Result<Showing> show(Run& run, const SnapshotOptions& pictures, Screen* screen, WindowOpener* opener,
                                   Host& host);

/// Continues on a screen with what the user opened there, as `lorica play --window` does, until it is closed. Its
/// report is that of what was played last.
[[nodiscard]] Result<void> playOpened(const CommonOptions& common, Host& host, Screen& screen, WindowOpener& opener,
                                      Showing opened);

/// The name of an avatar's character, with its folder if another file has the same name: "armed/hero".
[[nodiscard]] std::string nameOf(const Run& run, std::size_t avatar);
/// "hero", or "3 avatars".
[[nodiscard]] std::string whoOf(const Run& run);

/// "avatars": character, frames and hash of each.
[[nodiscard]] Facts avatarFacts(const Session& session);
/// "refusedLegs" and "smoothingDelay" of the first avatar. @param lag  "joints lag by"
[[nodiscard]] Facts smoothingFacts(const Session& session, const std::string& lag);

/// Completes the files of a run and prints its report.
[[nodiscard]] Result<void> finishAndPublish(Run& run, const CommonOptions& common, Report& report);

}  // namespace lorica
