#include "viewer/vr/headset_panel.h"

#include "geometry/counts.h"
#include "viewer/renderer/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

constexpr int kLineHeight = 48;                // [pixels]
constexpr double kAhead = 0.7, kBelow = 0.15;  // of the head, where it opens [m]
constexpr std::size_t kScene = 16;             // characters of its name
constexpr double kAboveHand = 0.16;            // [m]

}  // namespace

/// Upright, towards the head.
void HeadsetPanel::face(const Vec3& at, const Isometry3& stageFromHead) {
  const Vec3 towards = stageFromHead.translation() - at;
  const double yaw = std::atan2(towards.x(), towards.z());
  stageFromPanel_ = Eigen::Translation3d(at) * Eigen::AngleAxisd(yaw, Vec3::UnitY());
  open_ = true;
}

void HeadsetPanel::open(const Isometry3& stageFromHead) {
  const Vec3 ahead = Vec3::UnitY().cross(stageFromHead.linear().col(0)).normalized();
  face(stageFromHead.translation() + kAhead * ahead - kBelow * Vec3::UnitY(), stageFromHead);
}

void HeadsetPanel::openAt(const Vec3& hand, const Isometry3& stageFromHead) {
  face(hand + kAboveHand * Vec3::UnitY(), stageFromHead);
}

std::optional<HeadsetPanel::Row> HeadsetPanel::rowAt(const Ray& ray) const {
  if (!open_ || image_.width == 0) return std::nullopt;
  const Isometry3 panelFromStage = stageFromPanel_.inverse();
  const Vec3 origin = panelFromStage * ray.origin, direction = panelFromStage.linear() * ray.direction;
  if (origin.z() <= 0.0 || direction.z() >= 0.0) return std::nullopt;  // from behind, or away from it
  const Vec3 hit = origin - origin.z() / direction.z() * direction;
  if (std::abs(hit.x()) > 0.5 * width() || std::abs(hit.y()) > 0.5 * height()) return std::nullopt;
  const double row = (0.5 * height() - hit.y()) / height() * kRows;
  return Row(std::min(int(row), kRows - 1));
}

bool HeadsetPanel::draw(const WindowValues& values, const WindowChoices& choices, std::optional<Row> pointed) {
  const Drawn now{choices.paused, choices.show.hulls, choices.inside, values.scene, pointed};
  if (drawn_ == now) return false;
  drawn_ = now;
  const bool scene = values.scene >= 0 && values.scene < countOf(values.scenes);
  const std::array<std::string, kRows> rows = {
      choices.paused ? "continue" : "pause",
      "restart",
      "next scene" + (scene ? " (this is " + values.scenes[values.scene].substr(0, kScene) + ")" : ""),
      choices.show.hulls ? "hide the hulls" : "show the hulls",
      choices.inside ? "stand beside the avatar" : "see through the avatar's eyes",
      "come to the avatar again",
      "find the camera again: walk a curve",
      "close this panel"};
  std::string text;
  for (int row = 0; row < kRows; ++row) {
    text += fmt::format("{}{}{}", row == 0 ? "" : "\n", pointed == Row(row) ? "\u25b6 " : "\u2003 ", rows[row]);
  }
  image_ = drawTextPanel(text, kLineHeight);
  return true;
}

void HeadsetPanel::choose(Row row, const WindowValues& values, WindowChoices& choices, WindowRequests& requests) {
  switch (row) {
    case Row::kPause:
      choices.paused = !choices.paused;
      break;
    case Row::kRestart:
      requests.seekTo = 0.0;
      break;
    case Row::kScene:
      if (!values.scenes.empty()) requests.scene = (values.scene + 1) % countOf(values.scenes);
      break;
    case Row::kHulls:
      choices.show.hulls = !choices.show.hulls;
      break;
    case Row::kInside:
      choices.inside = !choices.inside;
      break;
    case Row::kFindCamera:
      requests.findCamera = true;
      break;
    case Row::kRecentre:
    case Row::kClose:
      break;
  }
}

}  // namespace lorica
