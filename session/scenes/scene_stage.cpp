#include "session/scenes/scene_stage.h"

#include "session/scenes/scene_element.h"

#include <fmt/format.h>

namespace lorica {
namespace {

constexpr std::size_t kMaxAvatars = 64;
constexpr double kFarthest = 50.0;     // [m]
constexpr double kLongestStart = 1e5;  // [s]
constexpr double kNearest = 0.1;       // of two places [m]

}  // namespace

std::vector<AvatarSetting> readStage(SceneElement& root) {
  std::vector<AvatarSetting> stage;
  root.each("avatars", [&](SceneElement& element) {
    AvatarSetting avatar;
    element.allow({"character", "motion", "start", "place", "heading", "color"});
    element.text("character", avatar.character);
    element.text("motion", avatar.motion);
    element.number("start", 0.0, kLongestStart, avatar.start);
    element.vector("place", -kFarthest, kFarthest, avatar.place);
    element.number("heading", -360.0, 360.0, avatar.heading);
    if (element.has("color")) element.color("color", avatar.color.emplace());
    if (stage.size() == kMaxAvatars) {
      root.fail("avatars", fmt::format("{} avatars", root.at("avatars").size()),
                fmt::format("at most {}", kMaxAvatars));
    }
    for (std::size_t i = 0; i < stage.size() && !root.failed(); ++i) {
      if ((stage[i].place - avatar.place).norm() >= kNearest) continue;
      element.fail("place", fmt::format("the place of avatars[{}]", i), "places that are 0.1 m apart or more");
    }
    stage.push_back(std::move(avatar));
  });
  return stage;
}

}  // namespace lorica
