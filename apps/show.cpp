#include "apps/show.h"

#include "apps/interrupt.h"
#include "apps/report_parts.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <utility>

namespace lorica {

Result<void> checkWindow(bool wanted, const std::string& instead) {
  if (!wanted || displayAvailable()) return {};
  return noDisplay("--window: there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set); {}", instead);
}

Result<Window> openWindow(const SnapshotOptions& pictures) {
  return Window::create("Lorica", pictures.size.width, pictures.size.height, pictures.transparent());
}

Result<Showing> show(Run& run, const SnapshotOptions& pictures, Screen* screen, WindowOpener* opener, Host& host) {
  Shown shown{screen, {}, opener, {}};
  auto* page = dynamic_cast<PageScreen*>(screen);
  std::optional<SnapshotSeries> series;
  if (screen != nullptr) {
    prepareScreen(run, *screen, pictures.background);
    if (page != nullptr) LORICA_TRY_DO(page->begin(run, host));
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
  showing.record = std::move(shown.record);
  if (run.live() || page != nullptr) answerInterrupt();
  if (page != nullptr && showing.end == RunEnd::kInterrupted) showing.end = RunEnd::kClosed;  // how it is ended
  if (series && (run.live() || showing.end != RunEnd::kInterrupted)) {
    LORICA_TRY(showing.drawn, series->finish());
  }
  return showing;
}

std::string nameOf(const Run& run, std::size_t avatar) {
  const PreparedAvatar& own = run.cast.avatars[avatar];
  const auto alike = [&](const PreparedAvatar& other) {
    return other.character().name == own.character().name && other.setting.character != own.setting.character;
  };
  const std::filesystem::path folder = std::filesystem::path(own.setting.character).parent_path().filename();
  if (folder.empty() || std::ranges::none_of(run.cast.avatars, alike)) return own.character().name;
  return folder.string() + "/" + own.character().name;
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
  LORICA_TRY_DO(finishRecorder(run, run.setting.record, report, json));
  if (run.setting.out.any()) {
    json["sent"] = {{"poses", run.sent.vmc}, {"contacts", run.sent.contacts}, {"vrchat", run.sent.vrchat}};
    report.line("sent", inWords(run.sent, run.setting.out));
  }
  return publish(common, report, json, run.setting.events == "-");
}

}  // namespace lorica
