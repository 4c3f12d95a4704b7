#include "geometry/counts.h"
#include "viewer/window/panel_widgets.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

namespace lorica {
namespace {

/// What is drawn and not, in two columns where there is room.
void chooseLayers(const PanelLayout& layout, const WindowValues& values, WindowChoices& choices) {
  SceneOptions& show = choices.show;
  struct Layer {
    const char* name;
    const char* key;
    bool& shown;
    std::string_view why = {};
  };
  const std::array layers = {Layer{"character", "1", show.skin},
                             Layer{"hulls", "2", show.hulls},
                             Layer{"bones", "3", show.bones},
                             Layer{"props", "4", show.props},
                             Layer{"contacts", "5", show.contacts},
                             Layer{"ground", "6", show.ground},
                             Layer{"grains", "7", show.particles, values.grains ? "" : "there is no sand or water"},
                             Layer{"by part", "C", show.colorSkinByPart}};
  const float width = ImGui::GetContentRegionAvail().x, left = ImGui::GetCursorPosX(), gap = layout.of(10.0f);
  const bool two = width >= layout.of(220.0f);
  bool second = false;
  for (const Layer& layer : layers) {
    if (second) ImGui::SameLine(left + 0.5f * (width + gap));
    toggle(layer.name, layer.key, layer.shown, layer.why, two && !second ? left + 0.5f * (width - gap) : 0.0f);
    second = two && !second;
  }
}

void chooseParts(const WindowValues& values, WindowRequests& requests) {
  int parts = values.parts;
  ImGui::SetNextItemWidth(besideSlider(ImGui::GetContentRegionAvail().x, "100 parts ..."));
  if (ImGui::SliderInt("##parts", &parts, 1, values.maxParts, "",
                       ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_NoInput)) {
    requests.parts = parts;
  }
  ImGui::SameLine();
  ImGui::TextUnformatted(
      fmt::format("{} {}{}", parts, parts == 1 ? "part" : "parts", values.preparingParts ? " ..." : "").c_str());
}

/// A background for keying has no ground.
void chooseBackground(SceneOptions& show) {
  static const std::vector<std::string> names = namesOf(kBackgrounds);
  const auto same = [&](const BackgroundChoice& one) {
    return one.transparent == show.transparent && (one.transparent || one.color == show.background);
  };
  const auto* const now = std::find_if(kBackgrounds.begin(), kBackgrounds.end(), same);
  std::optional<int> chosen;
  chooseFrom("background", "background: ", now == kBackgrounds.end() ? "as given" : nullptr, names,
             now == kBackgrounds.end() ? -1 : static_cast<int>(now - kBackgrounds.begin()), chosen);
  if (!chosen || *chosen < 0) return;
  show.background = kBackgrounds[*chosen].color;
  show.transparent = kBackgrounds[*chosen].transparent;
  show.ground = *chosen == 0;
}

void chooseQuality(const WindowValues& values, WindowChoices& choices) {
  std::vector<std::string> names(values.qualities.begin(), values.qualities.end());
  const std::string automatic = fmt::format("auto ({})", names[values.quality]);
  std::optional<int> chosen;
  chooseFrom("quality", "quality: ", automatic.c_str(), names, choices.quality, chosen);
  if (chosen) choices.quality = *chosen;
}

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

void drawLookPanel(PanelLayout& layout, const WindowValues& values, WindowChoices& choices, WindowRequests& requests) {
  bool open = false;
  if (!beginSide(layout, layout.look, "Look", false, open)) return;
  if (open) {
    chooseLayers(layout, values, choices);
    toggle("follow with the camera", "F", choices.follow);
    if (values.avatars.size() > 1) {
      chooseFrom("avatar", "follow: ", "all avatars", values.avatars, values.avatar, requests.avatar);
    }
    if (values.maxParts > 0) chooseParts(values, requests);
    chooseBackground(choices.show);
    if (!values.qualities.empty()) chooseQuality(values, choices);
    if (keyedButton("save a picture", "P")) choices.picture = true;
    if (keyedButton(values.videoSeconds < 0.0 ? "start a video###video" : "stop the video###video", "V")) {
      choices.video = true;
    }
  }
  endSide(layout, false);
}

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
