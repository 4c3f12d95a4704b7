#include "viewer/vr/headset_panel.h"

#include "geometry/text.h"
#include "viewer/renderer/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace lorica {
namespace {

constexpr int kLineHeight = 48;                // [pixels]
constexpr double kAhead = 0.7, kBelow = 0.15;  // of the head, where it opens [m]
constexpr std::size_t kName = 16;              // of what is chosen in a list [bytes]
constexpr double kAboveHand = 0.16;            // [m]

/// "pause: off", "scene: boxes", "restart".
std::string wordsOf(const Control& control) {
  if (control.kind == ControlKind::kToggle)
    return fmt::format("{}: {}", control.label, control.value != 0.0 ? "on" : "off");
  const std::size_t index = control.value < 0.0 ? control.choices.size() : static_cast<std::size_t>(control.value);
  if (index >= control.choices.size()) return control.label;
  return fmt::format("{}: {}", control.label, firstBytes(control.choices[index], kName));
}

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

std::optional<std::size_t> HeadsetPanel::rowAt(const Ray& ray) const {
  if (!open_ || image_.width == 0) return std::nullopt;
  const Isometry3 panelFromStage = stageFromPanel_.inverse();
  const Vec3 origin = panelFromStage * ray.origin, direction = panelFromStage.linear() * ray.direction;
  if (origin.z() <= 0.0 || direction.z() >= 0.0) return std::nullopt;  // from behind, or away from it
  const Vec3 hit = origin - origin.z() / direction.z() * direction;
  if (std::abs(hit.x()) > 0.5 * width() || std::abs(hit.y()) > 0.5 * height()) return std::nullopt;
  const double row = (0.5 * height() - hit.y()) / height() * static_cast<double>(rowCount());
  return std::min(static_cast<std::size_t>(row), rowCount() - 1);
}

bool HeadsetPanel::draw(const Controls& controls, std::optional<std::size_t> pointed) {
  listed_.clear();
  for (const Control& control : controls) {
    if (control.isOn(on_screen::kHeadset) && !control.absent) listed_.push_back({control.id, control.value});
  }
  if (image_.width > 0 && listed_ == rows_ && pointed == pointed_) return false;
  std::swap(rows_, listed_);
  pointed_ = pointed;
  std::string text;
  for (std::size_t row = 0; row < rowCount(); ++row) {
    const std::string words = row == toAvatarRow() ? "come to the avatar again"
                              : row == closeRow()  ? "close this panel"
                                                   : wordsOf(controls[rows_[row].id]);
    text += fmt::format("{}{}{}", row == 0 ? "" : "\n", pointed == row ? "\u25b6 " : "\u2003 ", words);
  }
  image_ = drawTextPanel(text, kLineHeight);
  return true;
}

std::optional<ControlId> HeadsetPanel::controlOf(std::size_t row) const {
  return row < rows_.size() ? std::optional(rows_[row].id) : std::nullopt;
}

}  // namespace lorica
