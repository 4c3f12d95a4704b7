// The page of `lorica serve` in a browser, as people use it.
#include "serve/page_files.h"
#include "tests/peers/peer.h"
#include "tests/support/background_process.h"
#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

namespace lorica {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

#define LORICA_REQUIRE_PAGE() \
  if (!pageBuilt()) GTEST_SKIP() << "this Lorica was built without its page: run scripts/setup --page and build again"

/// The built program while it serves a recording.
class Served {
 public:
  /// Where to watch; empty if nothing is served after two minutes.
  [[nodiscard]] std::string link() const {
    const std::string before = "Watch at ";
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(2);
    while (std::chrono::steady_clock::now() < end) {
      std::ifstream stream(log_);
      const std::string text{std::istreambuf_iterator<char>(stream), {}};
      const std::size_t at = text.find(before);
      const std::size_t stop = at == std::string::npos ? at : text.find('\n', at);
      if (stop != std::string::npos) return text.substr(at + before.size(), stop - at - before.size());
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return "";
  }

 private:
  // Of several that are served at a time, each finds a port of its own.
  static void become() {
    setenv("LORICA_RECORDINGS", test::recordingsFolder().c_str(), 1);
    setenv("XDG_CONFIG_HOME", "/dev/null", 1);  // the settings of whoever runs the tests stay as they are
    unsetenv("DISPLAY");
    const std::string program = test::built("lorica");
    execl(program.c_str(), program.c_str(), "serve", "punch_and_kick", nullptr);
  }

  test::TemporaryFolder folder_;
  fs::path log_ = folder_.write("log", "");
  test::BackgroundProcess process_{become, log_};
};

/// What page_check.mjs finds out. Fails the test, and returns nothing, if it finds a fault.
json check(const char* part) {
  const Served served;
  const std::string link = served.link();
  if (link.empty()) {
    ADD_FAILURE() << "nothing is served";
    return {};
  }
  const fs::path pictures = test::built("peers") / "pictures" / "page";
  setenv("PARTS", part, 1);
  if (!test::runPeer("page_check.mjs", {link, pictures.string()})) return {};
  json result = test::readJson(pictures / "result.json");
  EXPECT_TRUE(result.at("errors").empty()) << result["errors"];
  EXPECT_TRUE(result.at("outside").empty()) << "it asks others: " << result["outside"];
  return result;
}

TEST(PeerServe, ThePageDrawsPlaysDragsAndThrows) {
  LORICA_REQUIRE_PEERS();
  LORICA_REQUIRE_PAGE();
  const json result = check("desktop");
  if (result.empty()) return;
  const json& desktop = result.at("desktop");
  ASSERT_EQ(desktop.at("avatars").size(), 1u);
  const json& avatar = desktop["avatars"][0];
  EXPECT_TRUE(avatar.at("loaded").get<bool>()) << avatar;
  EXPECT_TRUE(avatar.at("present").get<bool>()) << avatar;
  const double height = avatar.at("center").at(1);
  EXPECT_GT(height, 0.4) << "it stands on the floor";
  EXPECT_LT(height, 1.6);
  EXPECT_GT(desktop.at("props").get<int>(), 0);
  EXPECT_GT(desktop.at("frames").get<int>(), 0);
  EXPECT_TRUE(desktop.at("problems").empty()) << desktop["problems"];

  const json& play = result.at("play");
  EXPECT_LT(play.at("restartedAt").get<double>(), std::max(play.at("pausedAt").get<double>(), 0.2));

  const json& drag = result.at("drag");
  ASSERT_FALSE(drag.contains("none")) << "there is no prop to drag";
  EXPECT_GT(drag.at("moved").get<double>(), 0.1);
  EXPECT_LT(drag.at("cameraMoved").get<double>(), 1e-3) << "a drag of a prop must not orbit";
  EXPECT_TRUE(drag.at("orbits").get<bool>());

  const json& thrown = result.at("throw");
  ASSERT_FALSE(thrown.contains("cannot")) << thrown;
  EXPECT_GT(thrown.at("props").at(1).get<int>(), thrown.at("props").at(0).get<int>());
}

TEST(PeerServe, ThePageFitsAPhone) {
  LORICA_REQUIRE_PEERS();
  LORICA_REQUIRE_PAGE();
  const json result = check("phone");
  if (result.empty()) return;
  EXPECT_TRUE(result.at("phone").get<bool>());
}

TEST(PeerServe, AHeadsetStandsBesideGrabsAndLooksOutOfTheAvatar) {
  LORICA_REQUIRE_PEERS();
  LORICA_REQUIRE_PAGE();
  const json result = check("vr");
  if (result.empty()) return;
  const json& vr = result.at("vr");
  EXPECT_NEAR(vr.at("eyeHeight").get<double>(), 1.6, 0.01) << "the headset's own height over the floor";
  EXPECT_GT(vr.at("distance").get<double>(), 0.5) << "beside, not inside";
  ASSERT_TRUE(vr.contains("grab")) << "there is no prop to grab";
  EXPECT_GT(vr["grab"].at("moved").get<double>(), 0.2);
  EXPECT_TRUE(vr.at("released").get<bool>());
  EXPECT_LT(vr.at("inside").at("distance").get<double>(), 0.6) << "inside";
  EXPECT_TRUE(vr.at("ar").get<bool>());
}

}  // namespace
}  // namespace lorica
