#pragma once

#include "apps/background_work.h"
#include "apps/interrupt.h"
#include "geometry/errors.h"
#include "viewer/window.h"

#include <chrono>
#include <functional>
#include <optional>
#include <thread>
#include <utility>

namespace lorica {

/// Loads what a session needs while the window shows how far that is. Files that are dropped meanwhile are requested
/// after that.
/// @param load  runs in another thread
/// @return what was loaded; none if the user closed the window or cancelled; kCancelled after Ctrl-C, or another error
template <class T>
[[nodiscard]] Result<std::optional<T>> loadInWindow(Window& window, std::function<Result<T>()> load) {
  BackgroundWork<T> loading(std::move(load));
  while (window.open()) {
    if (window.takeCancel()) break;
    if (interrupted()) return cancelled();
    if (std::optional<Result<T>> loaded = loading.take()) {
      if (!*loaded) return loaded->error();
      return std::optional<T>(std::move(**loaded));
    }
    const WorkMonitor::Progress progress = loading.progress();
    WindowValues values;
    values.loading = progress.title();
    values.loaded = progress.share;
    window.show(Scene(), values);
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
  }
  return std::optional<T>();
}

}  // namespace lorica
