#include "viewer/panel_widgets.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

namespace lorica {
namespace {

/// Begins a panel on the right, below the last one. @return whether there is room for it; then endRight() must follow
bool beginRight(PanelLayout& layout, PanelLayout::Fold& fold, const char* title, bool& open) {
  const float margin = layout.margin();
  const float top = layout.right + margin, room = layout.rightFloor - margin - top;
  if (room < layout.of(40.0f)) return false;
  const float width = std::min(layout.of(kWidestPanel), 0.5f * (layout.width - 3.0f * margin));
  ImGui::SetNextWindowPos(ImVec2(layout.width - margin, top), ImGuiCond_Always, ImVec2(1.0f, 0.0f));
  foldAsSizeSays(layout, fold);
  ImGui::SetNextWindowSizeConstraints(ImVec2(width, 0.0f), ImVec2(width, room));
  open = ImGui::Begin(title, nullptr, kFixed | ImGuiWindowFlags_AlwaysAutoResize);
  noteFold(fold);
  return true;
}

void endRight(PanelLayout& layout) {
  notePanel(layout);
  layout.right = ImGui::GetWindowPos().y + ImGui::GetWindowSize().y;
  ImGui::End();
}

template <typename Choices>
std::vector<std::string> namesOf(const Choices& choices) {
  std::vector<std::string> names;
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

void drawMotionPanel(PanelLayout& layout, const WindowValues& values, ControlState& state, WindowRequests& requests) {
  bool open = false;
  const bool any = values.treatable || !values.clips.empty() || !values.people.empty();
  if (!any || !beginRight(layout, layout.motion, "Motion", open)) return;
  if (open) {
    if (!values.clips.empty()) chooseFrom("clip", "clip: ", nullptr, values.clips, values.clip, requests.clip);
    if (!values.people.empty()) {
      chooseFrom("person", "person: ", "everyone", values.people, values.person, requests.person);
    }
    if (values.treatable) chooseTreatment(values, state.choices.treatment);
  }
  endRight(layout);
}

void drawHitsPanel(PanelLayout& layout, const WindowValues& values) {
  bool open = false;
  if (values.hits.empty() || !beginRight(layout, layout.hits, "Hits", open)) return;
  if (open) {
    for (const TargetScore& target : values.hits) {
      ImGui::TextUnformatted(target.name.c_str());
      const std::string count = std::to_string(target.hits);
      ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - ImGui::CalcTextSize(count.c_str()).x);
      ImGui::TextUnformatted(count.c_str());
    }
  }
  endRight(layout);
}

}  // namespace lorica
