#pragma once

#include "player/background_work.h"
#include "viewer/renderer/screen.h"

#include <functional>
#include <optional>
#include <utility>

namespace lorica {

/// Loads what a session needs while a screen shows how far that is. Files that are dropped meanwhile are requested
/// after that.
/// @param load  runs in another thread
/// @return what was loaded; none if the user closed the screen or cancelled; kCancelled if the host says so
template <class T>
[[nodiscard]] Result<std::optional<T>> loadOnScreen(Screen& screen, Host& host, std::function<Result<T>(Host&)> load) {
  BackgroundWork<T> loading(host, std::move(load));
  while (screen.open()) {
    if (screen.takeCancel()) break;
    if (host.cancelled()) return Error{ErrorCode::kCancelled, "cancelled"};
    if (std::optional<Result<T>> loaded = loading.take()) {
      if (!*loaded) return loaded->error();
      return std::optional<T>(std::move(**loaded));
    }
    const MonitoredHost::Progress progress = loading.progress();
    WindowValues values;
    values.loading = progress.title();
    values.loaded = progress.share;
    screen.show(Scene(), values);
    screen.rest(0.03);
  }
  return std::optional<T>();
}

}  // namespace lorica
