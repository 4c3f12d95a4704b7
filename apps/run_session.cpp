#include "apps/run_session.h"

#include "apps/interrupt.h"
#include "apps/progress_bar.h"
#include "geometry/errors.h"

#include <algorithm>
#include <optional>

namespace lorica {
namespace {

constexpr int kWindowWidth = 1280;
constexpr int kWindowHeight = 720;

}  // namespace

Result<void> checkWindow(bool wanted, const std::string& instead) {
  if (!wanted || displayAvailable()) return {};
  return noDisplay("--window: there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set); {}", instead);
}

Result<Window> openWindow() {
  return Window::create("Lorica", kWindowWidth, kWindowHeight);
}

void prepareWindow(const std::string& name, const Character& character, std::size_t avatars, Window& window) {
  window.setTitle(name.empty() ? "Lorica" : "Lorica: " + name);
  window.setCamera(windowCamera(character.height, avatars));
  window.setShown(usualView(character));
}

Result<DrawnFiles> runHeadless(const HeadlessRun& run, const SnapshotOptions& pictures, Session& session) {
  LORICA_TRY(std::optional<SnapshotSeries> series, SnapshotSeries::create(pictures, session));
  ProgressBar bar(run.doing + " " + run.name, run.unit);
  for (int frame = 0; frame < run.frames; ++frame) {
    if (interrupted()) return cancelled();
    LORICA_TRY(const bool more, session.step());
    if (!more) break;
    if (run.stepped) run.stepped();
    bar.update(frame + 1, run.expected > 0 ? std::max(run.expected, frame + 1) : run.frames);
    if (!series) continue;
    const std::string name = run.caption ? run.name + run.caption() : run.name;
    LORICA_TRY_DO(series->add(session, name));
  }
  return series ? series->finish() : DrawnFiles();
}

}  // namespace lorica
