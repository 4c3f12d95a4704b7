#include "apps/memory_limit.h"
#include "apps/option_groups.h"
#include "apps/options.h"
#include "apps/show.h"
#include "geometry/errors.h"
#include "viewer/page/link.h"
#include "viewer/page/page_files.h"

#include <fmt/format.h>

#include <unistd.h>
#include <utility>

namespace lorica {
namespace {

/// A camera that nobody asked for is followed if there is one.
Result<void> runServe(const ShowOptions& options, const CommonOptions& common, Host& host) {
  const LiveRequest& live = options.live;
  const std::string& motion = options.request.motion;
  const bool asked = live.depth.asked() || live.threePoint || !live.vmc.listenAt.empty();
  if (asked && !motion.empty()) return invalidArgument("{}: expected a motion or who is followed, not both", motion);
  if (!asked && !(motion.empty() && options.request.scene.empty())) return play(options, common, host);
  if (asked || openDepth(live.depth).ok()) return follow(options, common, host);
  host.tell("No depth camera was found: serving the demo.");
  return showDemo(options, common, host);
}

}  // namespace

void addServeOptions(CLI::App& app, ServeOptions& options, bool flag) {
  CLI::Option* serve =
      flag ? app.add_flag("--serve", options.serve,
                          "Show it on a page, for this machine's browser; with --lan for phones and headsets")
           : nullptr;
  if (flag) app.add_flag("--vr", options.vr, "Show it in this machine's headset (OpenXR) and a window; see docs/VR.md");
  CLI::Option* port =
      addCount(app, "--port", options.setting.port, 1,
               fmt::format("Port of the page [default: the first free one from {} on]", kUsualPort), 65535);
  CLI::Option* lan =
      app.add_flag("--lan", options.setting.lan,
                   "Show the page to phones and headsets on this network: with TLS, for those who have the link");
  CLI::Option* recordings = addOption(app, "--recordings", options.setting.recordings, "DIR",
                                      "Folder that people at the page may record sessions and open files into");
  CLI::Option* certificate = addOption(app, "--certificate", options.setting.certificate, "FILE.pem",
                                       "Certificate of the page [default: one that Lorica makes and keeps]");
  certificate->needs(lan)->needs(
      addOption(app, "--key", options.setting.key, "FILE.pem", "Its private key")->needs(certificate));
  for (CLI::Option* option : {port, lan, recordings}) {
    if (flag) option->needs(serve);
  }
}

Result<std::unique_ptr<Screens>> Screens::open(bool window, const ServeOptions& serve, const SnapshotOptions& pictures,
                                               Host& host) {
  std::unique_ptr<Screens> screens(new Screens);
  if (serve.vr) {
    const auto say = [&host](const std::string& sentence) { host.tell(sentence); };
    LORICA_TRY(screens->window_, HeadsetWindow::create([&] { return openWindow(pictures); }, say));
  } else if (window) {
    LORICA_TRY(Window opened, openWindow(pictures));
    screens->window_ = std::make_unique<Window>(std::move(opened));
  }
  if (!serve.serve) return screens;
  liftUsualLimit();
  ServeSetting setting = serve.setting;
  setting.paths = host.paths;
  LORICA_TRY(screens->server_, PageServer::start(setting));
  if (!pageBuilt()) {
    host.warn("this Lorica was built without its page: run scripts/setup --page and build again; programs can watch");
  }
  screens->page_.emplace(*screens->server_, screens->window_.get());
  screens->lan_ = serve.setting.lan;
  return screens;
}

void Screens::announce(Host& host) const {
  if (!server_) return;
  for (const std::string& link : server_->facts().links) host.tell("Watch at " + link);
  if (lan_) {
    if (server_->facts().certificateRenewed) {
      host.tell(
          "This machine has another address than before, so its certificate is new: phones that had it ask again.");
    }
    host.tell("Browsers warn of a certificate that they do not know: its SHA-256 is\n  " +
              server_->facts().fingerprint);
    if (isatty(STDERR_FILENO) == 1) say(qrCode(server_->facts().links.front()));  // it is coloured
  }
}

Command addServe(CLI::App& parent, CommonOptions& common) {
  const auto options = std::make_shared<ShowOptions>();
  CLI::App* app = addSubcommand(
      parent, common, "serve",
      "Show it on a page, for this machine's browser, phones and headsets: somebody live, a motion, or the demo.",
      "  lorica serve\n"
      "      the person before the depth camera, or the demo without one; open the link in a browser\n"
      "  lorica serve walk --character hero.vrm\n"
      "      a motion, as `lorica play` plays it\n"
      "  lorica serve --virtual --scene bowling\n"
      "      a virtual camera, as `lorica live` follows it\n"
      "  lorica serve --lan\n"
      "      for phones and headsets on this network: the terminal shows a link and a code for cameras\n"
      "  lorica live --serve --window\n"
      "      a page beside a window; play and demo have --serve, too\n"
      "\nWithout --lan nothing but this machine can see it. Ctrl-C ends it. Headsets enter VR from the page.\n"
      "docs/SERVE.md");
  addMotionOptions(*app, options->request);
  addDepthOptions(*app, options->live.depth);
  addVmcInputOptions(*app, options->live.vmc)->excludes(addWearerOptions(*app, options->live));
  addCount(*app, "--people", options->live.people, 1, "People to follow at once, each with an avatar, at most 6");
  addOutputOptions(*app, options->run);
  addBodyOptions(*app, options->request.body);
  addSceneOption(*app, options->request.scene, "none where people are followed, else demo")
      ->each([options](const std::string&) { options->sceneGiven = true; });
  addFaultOption(*app, options->request.performing);
  addRecordOptions(*app, options->run);
  addTextureOption(*app, options->request.reading.textureSize);
  options->serve.serve = true;
  addServeOptions(*app, options->serve, false);
  app->add_flag("--window", options->window, "Open a window beside the page; fail if there is no display");
  return {app, [options](const CommonOptions& given, Host& host) { return runServe(*options, given, host); }};
}

}  // namespace lorica
