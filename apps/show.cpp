#include "apps/show.h"

#include "apps/interrupt.h"
#include "apps/option_groups.h"
#include "apps/report_parts.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <utility>

namespace lorica {
namespace {

constexpr int kWindowWidth = 1280;
constexpr int kWindowHeight = 720;

}  // namespace

Result<Window> openWindow() {
  return Window::create("Lorica", kWindowWidth, kWindowHeight);
}

Result<Showing> show(Run& run, const SnapshotOptions& pictures, Screen* screen, WindowOpener* opener, Host& host) {
  Shown shown{screen, {}, opener, {}};
  std::optional<SnapshotSeries> series;
  if (screen != nullptr) {
    prepareScreen(run, *screen);
  } else {
    LORICA_TRY(series, SnapshotSeries::create(pictures, run.session));
  }
  if (series) {
    shown.picture = [&]() -> Result<bool> {
      const Image* inset = series->due(run.session) ? run.drawInset() : nullptr;
      LORICA_TRY_DO(series->add(run.session, run.name() + run.hits.caption(), inset));
      return true;
    };
  }
  Showing showing;
  LORICA_TRY(showing.end, play(run, shown, host));
  showing.next = std::move(shown.next);
  if (run.live()) answerInterrupt();
  if (series && (run.live() || showing.end != RunEnd::kInterrupted)) {
    LORICA_TRY(showing.drawn, series->finish());
  }
  return showing;
}

std::string whoOf(const Run& run) {
  const int avatars = countOf(run.session.avatars());
  return avatars == 1 ? run.session.character().name : counted(avatars, "avatar");
}

void addAvatarsTo(nlohmann::ordered_json& json, const Session& session) {
  json["avatars"] = nlohmann::ordered_json::array();
  for (const SessionAvatar& avatar : session.avatars()) {
    json["avatars"].push_back(
        {{"character", avatar.character().name}, {"frames", avatar.frameCount()}, {"hash", hexDigits(avatar.hash())}});
  }
}

void addSmoothingTo(nlohmann::ordered_json& json, const Session& session) {
  const std::optional<double> delay = session.source().smoothingDelay();
  json["refusedLegs"] = session.source().refusedLegs();
  json["smoothingDelay"] = delay ? nlohmann::ordered_json(*delay) : nlohmann::ordered_json();
}

void addSmoothingTo(Report& report, const Session& session, const std::string& lag) {
  if (const std::optional<double> delay = session.source().smoothingDelay()) {
    report.line("smoothing", fmt::format("{} {:.0f} ms", lag, 1e3 * *delay));
  }
}

Result<void> finishAndPublish(Run& run, const CommonOptions& common, Report& report, nlohmann::ordered_json& json) {
  LORICA_TRY_DO(run.finish());
  LORICA_TRY_DO(finishRecorder(run, report, json));
  return publish(common, report, json, run.setting.events == "-");
}

}  // namespace lorica
