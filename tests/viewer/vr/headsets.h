#pragma once

#include "session/prepare/cast.h"
#include "session/prepare/live_cast.h"
#include "session/prepare/recorded_cast.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"
#include "tests/viewer/vr/monado_headset.h"
#include "viewer/player/run.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>

namespace lorica::test {

/// Is asked between pictures whether to end.
struct Asking : Host {
  std::function<bool()> ends;
  [[nodiscard]] bool cancelled() const override { return ends && ends(); }
};

/// The mannequin with a red ball that stands in the air and a blue box on a post, seen in a headset.
class Headsets : public MonadoHeadset {
 protected:
  static constexpr int kPatience = 600;  // pictures

  void SetUp() override {
    MonadoHeadset::SetUp();
    if (!IsSkipped() && !HasFatalFailure()) start();
  }
  [[nodiscard]] CastRequest request() const {
    CastRequest request;
    request.reading.drawn = true;
    request.scene = folder_
                        .write("ball.json", R"({"format": "lorica scene 1", "props": [
      {"shape": "sphere", "radius": 0.11, "at": [0.5, 1.3, 0.3], "fixed": true, "color": "#ff0000"},
      {"shape": "cylinder", "radius": 0.14, "height": 0.9, "at": [-0.7, 0.45, 0.4], "fixed": true, "color": "#808488"},
      {"shape": "box", "size": [0.2, 0.2, 0.2], "at": [-0.7, 1.0, 0.4], "mass": 0.4, "color": "#2f74b0"}]})")
                        .string();
    return request;
  }
  /// @param record  the session to a file; empty = not
  void start(const std::string& record = {}) {
    RunSetting setting;
    setting.record = record;
    setting.atEnd = AtEnd::kRepeat;
    CastRequest played = request();
    played.motion = (recordingsFolder() / "squat_and_reach.csv").string();
    run = test::valueOf(lorica::Run::start(test::valueOf(prepareCast(played, host)), setting, host));
  }
  /// The mannequin follows head and hands.
  void follow(const std::string& record) {
    RunSetting setting;
    setting.record = record;
    LiveRequest live;
    live.threePoint = true;
    run = test::valueOf(lorica::Run::start(test::valueOf(prepareLiveCast(request(), live, host)), setting, host));
  }
  /// That a recorded session has the same results again, without a headset.
  void expectReplayed(const std::filesystem::path& file) {
    RecordedRequest recorded;
    recorded.file = file.string();
    host.ends = nullptr;
    const auto again = test::valueOf(lorica::Run::start(test::valueOf(prepareRecordedCast(recorded, host)), {}, host));
    Shown unseen;
    EXPECT_TRUE(lorica::play(*again, unseen, host));
    EXPECT_TRUE(again->comparison->over());
    EXPECT_GT(again->comparison->steps(), 10);
    EXPECT_FALSE(again->comparison->difference()) << again->comparison->difference()->what;
  }

  /// Plays until `done`, which is asked after each picture.
  void playUntil(const std::function<bool()>& done, int patience = kPatience) {
    int pictures = 0;
    bool finished = false;
    host.ends = [&] {
      tell(told);
      finished = finished || done();
      return finished || ++pictures > patience;
    };
    Shown shown;
    shown.screen = window.get();
    const Result<RunEnd> end = lorica::play(*run, shown, host);
    EXPECT_TRUE(end) << end.error().message;
    EXPECT_TRUE(finished) << "it has not come to that in " << patience << " pictures";
    host.ends = nullptr;
  }
  [[nodiscard]] const HeadsetFrame& frame() const { return window->headset()->frame(); }
  /// Whether the headset is where it was told to be, to a millimetre.
  [[nodiscard]] bool arrived() const {
    return window->headset() != nullptr && window->headset()->running() && frame().located && frame().drawn &&
           (frame().stageFromHead.translation() - told.head.at).norm() < 1e-3 &&
           frame().stageFromHead.linear().isApprox(told.head.turned.toRotationMatrix(), 1e-3);
  }

  Asking host;
  std::unique_ptr<lorica::Run> run;
  TemporaryFolder folder_;
};

}  // namespace lorica::test
