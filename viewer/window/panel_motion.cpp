#include "viewer/window/panel_widgets.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace lorica {
namespace {

/// Begins a panel below the last one at a side. @return whether there is room for it; then endBelow() must follow
bool beginBelow(PanelLayout& layout, PanelLayout::Fold& fold, const char* title, bool left, bool& open) {
  const float margin = layout.margin(), gap = layout.small() ? layout.of(4.0f) : margin;
  const float top = (left ? layout.left : layout.right) + gap;
  const float room = (left ? layout.floor : layout.rightFloor) - margin - top;
  if (room < layout.of(24.0f)) return false;
  const float width = std::min(layout.of(left ? kViewPanel : kWidestPanel), 0.5f * (layout.width - 3.0f * margin));
  const ImVec2 corner(left ? margin : layout.width - margin, top);
  ImGui::SetNextWindowPos(corner, ImGuiCond_Always, ImVec2(left ? 0.0f : 1.0f, 0.0f));
  foldAsSizeSays(layout, fold);
  ImGui::SetNextWindowSizeConstraints(ImVec2(width, 0.0f), ImVec2(width, room));
  open = ImGui::Begin(title, nullptr, kFixed | ImGuiWindowFlags_AlwaysAutoResize);
  noteFold(fold);
  return true;
}

void endBelow(PanelLayout& layout, bool left) {
  notePanel(layout);
  (left ? layout.left : layout.right) = ImGui::GetWindowPos().y + ImGui::GetWindowSize().y;
  ImGui::End();
}

template <typename Choices>
std::vector<std::string> namesOf(const Choices& choices) {
  std::vector<std::string> names;
  names.reserve(choices.size());
  for (const auto& choice : choices) names.emplace_back(choice.name);
  return names;
}

void chooseTreatment(const WindowValues& values, WindowTreatment& treatment) {
  static const std::vector<std::string> smoothings = namesOf(kSmoothings), gravities = namesOf(kGravities);
  toggle("mirror", "", treatment.mirror, values.noMirror);
  std::optional<int> chosen;
  const bool delayed = values.smoothingDelay >= 0.0;
  const std::string label =
      delayed ? fmt::format("smoothing ({:.0f} ms late): ", 1e3 * values.smoothingDelay) : "smoothing: ";
  const bool given = treatment.smoothing == kSmoothingAsGiven;
  chooseFrom("smoothing", label, given ? "as given" : nullptr, smoothings, treatment.smoothing, chosen,
             values.noSmoothing);
  if (chosen) treatment.smoothing = *chosen;
  chosen.reset();
  chooseFrom("gravity", "gravity: ", nullptr, gravities, treatment.gravity, chosen, values.noGravity);
  if (chosen) treatment.gravity = *chosen;
}

}  // namespace

void drawMotionPanel(PanelLayout& layout, const WindowValues& values, WindowChoices& choices,
                     WindowRequests& requests) {
  bool open = false;
  const bool any = values.treatable || !values.clips.empty() || !values.people.empty();
  const bool left = layout.small();
  if (!any || !beginBelow(layout, layout.motion, "Motion", left, open)) return;
  if (open) {
    if (!values.clips.empty()) chooseFrom("clip", "clip: ", nullptr, values.clips, values.clip, requests.clip);
    if (!values.people.empty()) {
      const char* everyone = values.everyone ? "everyone" : nullptr;
      chooseFrom("person", "person: ", everyone, values.people, values.person, requests.person);
    }
    if (values.treatable) chooseTreatment(values, choices.treatment);
  }
  endBelow(layout, left);
}

void drawHitsPanel(PanelLayout& layout, const WindowValues& values) {
  bool open = false;
  if (values.hits.empty() || !beginBelow(layout, layout.hits, "Hits", false, open)) return;
  if (open) {
    for (const TargetScore& target : values.hits) {
      ImGui::TextUnformatted(target.name.c_str());
      const std::string count = std::to_string(target.hits);
      ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - ImGui::CalcTextSize(count.c_str()).x);
      ImGui::TextUnformatted(count.c_str());
    }
  }
  endBelow(layout, false);
}

}  // namespace lorica
