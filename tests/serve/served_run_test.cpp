#include "geometry/little_endian.h"
#include "player/run.h"
#include "prepare/cast.h"
#include "serve/page_screen.h"
#include "skinning/linear_blend.h"
#include "tests/serve/test_client.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <thread>
#include <vector>

namespace lorica {
namespace {

using test::becomes;
using test::TestClient;
using test::valueOf;

Cast walkingCast(Host& host) {
  CastRequest request;
  request.motion = "walk";
  request.reading.drawn = true;
  return valueOf(prepareCast(request, host));
}

/// What a client gets is what the same session computes by itself.
TEST(ServedRun, FramesHoldThePosesOfTheSession) {
  const test::TemporaryFolder home;  // no choices that somebody has kept
  ::setenv("XDG_CONFIG_HOME", home.path().c_str(), 1);
  Host host;
  RunSetting setting;
  setting.frames = 40;
  setting.atEnd = AtEnd::kReturn;
  setting.hurry = true;
  const auto alone = valueOf(lorica::Run::start(walkingCast(host), setting, host));
  std::map<double, std::vector<Affine3>> truth;  // world from model, by the session's time
  while (alone->session.frameCount() < setting.frames && valueOf(alone->session.step())) {
    std::vector<Affine3> joints(alone->session.worldFromJoint().size());
    computeWorldFromModel(alone->session.character(), alone->session.worldFromJoint(), joints);
    truth[alone->session.time()] = joints;
  }

  const auto run = valueOf(lorica::Run::start(walkingCast(host), setting, host));
  std::unique_ptr<PageServer> server = valueOf(PageServer::start({}));
  PageScreen screen(*server, nullptr);
  EXPECT_TRUE(valueOf(screen.begin(*run, host)).empty());
  std::thread client([&] {
    TestClient watcher(server->port());
    watcher.watch();
    const nlohmann::json hello = watcher.next("hello").json();
    EXPECT_EQ(hello["name"], "walk");
    EXPECT_EQ(hello["avatars"][0]["joints"].size(), run->session.character().jointFromModel.size());
    int seen = 0;
    for (;;) {
      const TestClient::Message frame = watcher.next("frame");
      if (frame.kind != 2) break;
      ++seen;
      const auto found = truth.find(loadLittleEndian<double>(frame.bytes.data() + 24));
      ASSERT_NE(found, truth.end());
      for (std::size_t j = 0; j < found->second.size(); ++j) {
        const char* pose = frame.bytes.data() + 32 + 8 + 8 + 20 * j;
        for (int c = 0; c < 3; ++c) {
          EXPECT_EQ(loadLittleEndian<float>(pose + 4 * c), static_cast<float>(found->second[j].translation()[c]));
        }
      }
      watcher.send({{"type", "ack"}, {"frame", frame.number()}});
    }
    EXPECT_GT(seen, 0);
  });
  EXPECT_TRUE(becomes([&] { return server->clients() == 1; }));
  Shown shown{&screen, {}, nullptr, {}};
  EXPECT_EQ(valueOf(play(*run, shown, host)), RunEnd::kOver);
  EXPECT_EQ(run->session.hash(), alone->session.hash()) << "watching changes nothing";
  // The client sees the end when the server goes.
  server.reset();
  client.join();
}

}  // namespace
}  // namespace lorica
