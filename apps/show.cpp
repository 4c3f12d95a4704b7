#include "apps/show.h"

#include "apps/interrupt.h"
#include "apps/memory_limit.h"
#include "apps/report_parts.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace lorica {

Result<void> checkWindow(bool wanted, const std::string& instead) {
  if (!wanted || displayAvailable()) return {};
  return noDisplay("--window: there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set); {}", instead);
}

Result<Window> openWindow(const SnapshotOptions& pictures) {
  liftUsualLimit();
  return Window::create("Lorica", pictures.size.width, pictures.size.height, pictures.transparent());
}

Result<Showing> show(Run& run, const SnapshotOptions& pictures, Screen* screen, WindowOpener* opener, Host& host) {
  Shown shown{screen, {}, opener, {}};
  auto* page = dynamic_cast<PageScreen*>(screen);
  std::optional<SnapshotSeries> series;
  if (screen != nullptr) {
    if (pictures.background) shown.background = &*pictures.background;
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

Facts avatarFacts(const Session& session) {
  Json avatars = Json::array();
  for (const SessionAvatar& avatar : session.avatars()) {
    avatars.push_back(
        {{"character", avatar.character().name}, {"frames", avatar.frameCount()}, {"hash", hexDigits(avatar.hash())}});
  }
  Facts facts;
  facts.add("avatars", std::move(avatars));
  return facts;
}

Facts smoothingFacts(const Session& session, const std::string& lag) {
  const std::optional<double> delay = session.source().smoothingDelay();
  Facts facts;
  facts.add("refusedLegs", session.source().refusedLegs());
  facts.add("smoothingDelay", "smoothing", orNull(delay), delay ? fmt::format("{} {:.0f} ms", lag, 1e3 * *delay) : "");
  return facts;
}

Result<void> finishAndPublish(Run& run, const CommonOptions& common, Report& report) {
  LORICA_TRY_DO(run.finish());
  LORICA_TRY_DO(finishRecorder(run, run.setting.record, report));
  if (run.setting.out.any()) {
    report.add(
        "sent", "sent",
        {{"poses", run.sent.vmc}, {"contacts", run.sent.contacts}, {"vrchat", run.sent.vrchat}, {"vmt", run.sent.vmt}},
        inWords(run.sent, run.setting.out));
  }
  return publish(common, report, run.setting.events == "-");
}

}  // namespace lorica
