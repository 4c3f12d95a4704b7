#pragma once

#include "apps/command_line.h"
#include "player/snapshots.h"
#include "serve/page_screen.h"
#include "serve/server.h"
#include "viewer/vr/headset_window.h"

#include <memory>
#include <optional>

namespace lorica {

/// --vr, and --serve and what belongs to it.
struct ServeOptions {
  bool serve = false, vr = false;
  ServeSetting setting;
  [[nodiscard]] bool any() const { return serve || vr; }
};

/// --vr, --serve, --port, --lan, --recordings, --certificate and --key. @param flag  whether the first two are asked
/// for; else it is served anyway
void addServeOptions(CommandLine& app, ServeOptions& options, bool flag);

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

}  // namespace lorica
