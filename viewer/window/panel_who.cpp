#include "viewer/window/panel_widgets.h"

#include <string>
#include <vector>

namespace lorica {
namespace {

void chooseTreatment(const WindowValues& values, WindowTreatment& treatment) {
  static const std::vector<std::string> smoothings = namesOf(kSmoothings), gravities = namesOf(kGravities);
  toggle("mirror", "", treatment.mirror, values.noMirror);
  std::optional<int> chosen;
  const bool given = treatment.smoothing == kSmoothingAsGiven;
  chooseFrom("smoothing", "smoothing: ", given ? "as given" : nullptr, smoothings, treatment.smoothing, chosen,
             values.noSmoothing);
  if (chosen) treatment.smoothing = *chosen;
  chosen.reset();
  chooseFrom("gravity", "gravity: ", nullptr, gravities, treatment.gravity, chosen, values.noGravity);
  if (chosen) treatment.gravity = *chosen;
}

/// The name of a count at the right edge.
void hitsOf(const TargetScore& target) {
  const std::string count = std::to_string(target.hits);
  const float width = ImGui::CalcTextSize(count.c_str()).x;
  ImGui::TextUnformatted(fitted(target.name, ImGui::GetContentRegionAvail().x - 2.0f * width).c_str());
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - width);
  ImGui::TextUnformatted(count.c_str());
}

}  // namespace

void drawWhoPanel(PanelLayout& layout, const WindowValues& values, WindowChoices& choices, WindowRequests& requests) {
  bool open = false;
  if (!beginSide(layout, layout.who, "Who and what", true, open)) return;
  if (open) {
    chooseFile("avatar: ", "another", values.characters, values.character, requests);
    chooseFile("motion: ", "another", values.motions, values.motion, requests);
    if (!values.clips.empty()) chooseFrom("clip", "clip: ", nullptr, values.clips, values.clip, requests.clip);
    if (!values.people.empty()) {
      const char* everyone = values.everyone ? "everyone" : nullptr;
      chooseFrom("person", "person: ", everyone, values.people, values.person, requests.person);
    }
    if (!values.expressions.empty()) {
      const bool given = values.expression == kExpressionsAsGiven;
      chooseFrom("expression", "expression: ", given ? "as given" : "none", values.expressions, values.expression,
                 requests.expression);
    }
    if (!values.scenes.empty()) chooseFrom("scene", "scene: ", nullptr, values.scenes, values.scene, requests.scene);
    chooseFile("recent files", "", values.recent, -1, requests);
    if (values.opens && keyedButton("open a file ...", "O")) requests.choose = true;
    if (!values.hint.empty()) {
      ImGui::PushStyleColor(ImGuiCol_Text, kFaint);
      ImGui::TextWrapped("%.*s", static_cast<int>(values.hint.size()), values.hint.data());
      ImGui::PopStyleColor();
    }
    ImGui::Separator();
    if (values.treatable) chooseTreatment(values, choices.treatment);
    if (values.duration > 0.0) toggle("start again at the end", "L", choices.loop, values.noLoop);
    if (keyedButton("throw a ball", "B", values.noThrow)) requests.throwBall = true;
    if (keyedButton("undo", "U", values.noUndo)) requests.undo = true;
    if (!values.hits.empty()) ImGui::Separator();
    for (const TargetScore& target : values.hits) hitsOf(target);
  }
  endSide(layout, true);
}

}  // namespace lorica
