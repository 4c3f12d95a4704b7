// What people at a screen ask for in one turn of a run.
#include "player/run.h"
#include "prepare/live_cast.h"
#include "tests/support/datasets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lorica {
namespace {

using test::valueOf;

/// A screen at which one turn after the other is as the test wants it.
class ScriptedScreen final : public Screen {
 public:
  /// @return what is asked for in this turn; it may end the run
  std::function<WindowRequests(ScriptedScreen&)> turn;
  bool ended = false;
  std::vector<std::string> said;
  HandAim pointed;

  [[nodiscard]] bool open() const override { return !ended; }
  [[nodiscard]] bool wantsStep() override { return true; }
  void show(const Scene&, const WindowValues&) override {}
  void rest(double) override {}
  [[nodiscard]] WindowRequests takeRequests() override { return turn(*this); }
  void chooseFiles() override {}
  [[nodiscard]] bool takeCancel() override { return false; }
  [[nodiscard]] HandAim aim(int) const override { return pointed; }
  [[nodiscard]] Camera camera() const override { return {}; }
  void setCamera(const Camera&) override {}
  void addTimes(std::span<const TimedStage>) override {}
  void notice(std::string sentence, double) override { said.push_back(std::move(sentence)); }
  void problem(std::string sentence) override { said.push_back(std::move(sentence)); }
  void setTitle(const std::string&) override {}
  [[nodiscard]] const WindowChoices& choices() const override { return choices_; }
  void setChoices(const WindowChoices& choices) override { choices_ = choices; }

 private:
  WindowChoices choices_;
};

/// Live nothing can be undone: that is said, and what else was asked for in the same turn is done. A prop that was let
/// go must not hang on a hand that is not there.
TEST(RunRequests, AnUndoThatCannotBeDoneSwallowsNoRelease) {
  const test::TemporaryFolder home;
  ::setenv("XDG_CONFIG_HOME", home.path().c_str(), 1);
  Host host;
  CastRequest request;
  LiveRequest live;
  live.depth.virtualCamera = true;
  const auto run = valueOf(Run::start(valueOf(prepareLiveCast(request, live, host)), {}, host));
  const World& world = run->session.world();
  Ray down{Vec3::Zero(), -Vec3::UnitY()};
  for (std::size_t i = 0; i < world.props().size(); ++i) {
    down.origin = world.props()[i].worldFromProp.translation() + Vec3(0.0, 3.0, 0.0);
    const std::optional<PropPick> pick = world.pick(down);
    if (world.props()[i].mass > 0.0 && pick && pick->prop == static_cast<int>(i)) break;
  }
  ScriptedScreen screen;
  screen.pointed = {down, down.direction};
  bool held = false;
  int turns = 0, frame = 0;
  screen.turn = [&](ScriptedScreen& self) {
    WindowRequests requests;
    if (turns > 0 && run->session.frameCount() == frame) return requests;  // actions are done with the next frame
    frame = run->session.frameCount();
    const bool holds = run->session.world().held(0).has_value();
    if (turns == 0) requests.hands[0].pressed = down;
    if (turns == 1) {
      held = holds;
      requests.undo = true;
      requests.hands[0].released = true;
    }
    if (turns == 2) {
      EXPECT_FALSE(holds) << "it was let go";
      self.ended = true;
    }
    ++turns;
    return requests;
  };
  Shown shown{&screen, {}, nullptr, {}};
  EXPECT_EQ(valueOf(play(*run, shown, host)), RunEnd::kClosed);
  EXPECT_TRUE(held) << "there was something to let go";
  EXPECT_EQ(screen.said, std::vector<std::string>{"what happened live cannot be undone"});
}

}  // namespace
}  // namespace lorica
