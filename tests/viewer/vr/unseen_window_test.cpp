#include "viewer/window/window.h"

#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace lorica {
namespace {

/// A window whose eyes take their time.
class SlowEyes final : public Window {
 public:
  explicit SlowEyes(Window window) : Window(std::move(window)) {}
  /// @param longest  that a picture may take [s] @return the quality after so many pictures
  RenderQuality after(int count, double seconds, double longest) {
    RenderQuality quality = RenderQuality::kHigh;
    drawFor(
        [&](Renderer& renderer, const Scene&, const SceneOptions&) {
          quality = renderer.quality();
          std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
          return true;
        },
        longest);
    for (int i = 0; i < count; ++i) show(Scene(), WindowValues());
    return quality;
  }
};

// Pictures of 30 ms are fast enough for a window, and too slow for a headset of 90 Hz.
TEST(UnseenWindow, TheQualityStepsDownToHoldTheHeadsetsRate) {
  std::vector<std::string> said;
  Result<Window> window = Window::createUnseen([&](const std::string& sentence) { said.push_back(sentence); });
  if (!window) GTEST_SKIP() << window.error().message;
  SlowEyes eyes(std::move(*window));
  EXPECT_TRUE(eyes.open());
  EXPECT_EQ(eyes.after(60, 0.03, 100.0), RenderQuality::kHigh);
  EXPECT_EQ(eyes.after(100, 0.03, 0.8 / 90.0), RenderQuality::kLow);
  ASSERT_FALSE(said.empty());
  EXPECT_NE(said.front().find("quality set to medium"), std::string::npos) << said.front();
}

}  // namespace
}  // namespace lorica
