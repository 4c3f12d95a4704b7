#include "viewer/window/panel_widgets.h"

#include "geometry/counts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lorica {
namespace {

/// A button as wide as the panel with its key at the right edge. @param why  it cannot be pressed; empty = it can
bool keyedButton(const char* name, const char* key, std::string_view why = {}) {
  const float width = ImGui::GetContentRegionAvail().x;
  ImGui::BeginDisabled(!why.empty());
  const bool pressed = ImGui::Button(name, ImVec2(width, 0.0f));
  ImGui::EndDisabled();
  tellWhy(why);
  const ImVec2 corner = ImGui::GetItemRectMax(), text = ImGui::CalcTextSize(key);
  const float pad = ImGui::GetStyle().FramePadding.y;
  ImGui::GetWindowDrawList()->AddText(ImVec2(corner.x - text.x - 2.0f * pad, corner.y - text.y - pad),
                                      ImGui::ColorConvertFloat4ToU32(kFaint), key);
  return pressed;
}

/// The width of a slider with its value beside it, where the knob does not cover it. @param longest  text of a value
float besideSlider(float room, const std::string& longest) {
  return std::max(room - ImGui::CalcTextSize(longest.c_str()).x - ImGui::GetStyle().ItemSpacing.x, 0.3f * room);
}

/// A list of what can be opened, by the names of the files; the folders of one are a tooltip.
/// @param present  index of what is played; -1 = none of these
void chooseFile(const char* what, std::span<const std::string> files, int present, WindowRequests& requests) {
  if (files.empty()) return;
  const auto name = [](const std::string& file) { return file.c_str() + (file.rfind('/') + 1); };
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
  ImGui::PushID(what);
  if (ImGui::BeginCombo("##list", present < 0 ? what : name(files[present]))) {
    for (int n = 0; n < countOf(files); ++n) {
      const std::string& file = files[n];
      ImGui::PushID(n);
      if (ImGui::Selectable(name(file), n == present)) requests.files = {file};
      ImGui::PopID();
      if (name(file) != file.c_str()) tellWhy(file);
    }
    ImGui::EndCombo();
  }
  ImGui::PopID();
}

}  // namespace

void notePanel(PanelLayout& layout) {
  const ImVec2 position = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
  layout.panels.push_back({position.x, position.y, position.x + size.x, position.y + size.y});
  if (ImGui::IsWindowCollapsed()) layout.titles = std::max(layout.titles, position.y + size.y);
}

void foldAsSizeSays(const PanelLayout& layout, PanelLayout::Fold& fold) {
  if (fold.small == layout.small()) return;
  fold.small = layout.small();
  ImGui::SetNextWindowCollapsed(layout.small() || !fold.openIfLarge);
}

void noteFold(PanelLayout::Fold& fold) {
  // Dear ImGui itself folds by a click on the arrow only, or by two clicks.
  const bool besideArrow = ImGui::GetMousePos().x > ImGui::GetWindowPos().x + ImGui::GetFrameHeight();
  if (besideArrow && ImGui::IsItemClicked()) ImGui::SetWindowCollapsed(!ImGui::IsWindowCollapsed());
  if (!*fold.small) fold.openIfLarge = !ImGui::IsWindowCollapsed();
}

void setPanelStyle(float scale) {
  ImGuiStyle style;
  ImGui::StyleColorsDark(&style);
  style.WindowRounding = style.PopupRounding = 6.0f;
  style.FrameRounding = style.GrabRounding = 4.0f;
  style.WindowBorderSize = 0.0f;
  style.FrameBorderSize = 1.0f;
  style.WindowPadding = ImVec2(10.0f, 8.0f);
  style.FramePadding = ImVec2(6.0f, 2.0f);
  style.ItemSpacing = ImVec2(8.0f, 4.0f);
  style.GrabMinSize = 12.0f;
  style.ScrollbarSize = 10.0f;
  ImVec4* colors = style.Colors;
  colors[ImGuiCol_Text] = ImVec4(0.93f, 0.95f, 0.97f, 1.0f);
  colors[ImGuiCol_WindowBg] = ImVec4(0.085f, 0.10f, 0.13f, 0.80f);
  colors[ImGuiCol_PopupBg] = ImVec4(0.085f, 0.10f, 0.13f, 0.97f);
  colors[ImGuiCol_TitleBg] = colors[ImGuiCol_TitleBgActive] = ImVec4(0.12f, 0.145f, 0.19f, 0.90f);
  colors[ImGuiCol_TitleBgCollapsed] = ImVec4(0.085f, 0.10f, 0.13f, 0.72f);
  colors[ImGuiCol_Border] = ImVec4(1.0f, 1.0f, 1.0f, 0.10f);
  colors[ImGuiCol_FrameBg] = ImVec4(0.27f, 0.31f, 0.38f, 0.90f);
  colors[ImGuiCol_FrameBgHovered] = ImVec4(0.28f, 0.34f, 0.43f, 0.95f);
  colors[ImGuiCol_FrameBgActive] = ImVec4(0.30f, 0.38f, 0.49f, 1.0f);
  colors[ImGuiCol_Button] = ImVec4(0.26f, 0.32f, 0.42f, 0.95f);
  colors[ImGuiCol_ButtonHovered] = ImVec4(0.28f, 0.38f, 0.50f, 1.0f);
  colors[ImGuiCol_ButtonActive] = ImVec4(0.24f, 0.46f, 0.66f, 1.0f);
  colors[ImGuiCol_CheckMark] = colors[ImGuiCol_SliderGrab] = ImVec4(0.38f, 0.70f, 0.95f, 1.0f);
  colors[ImGuiCol_SliderGrabActive] = ImVec4(0.55f, 0.82f, 1.0f, 1.0f);
  colors[ImGuiCol_Header] = colors[ImGuiCol_HeaderHovered] = ImVec4(0.24f, 0.36f, 0.48f, 0.9f);
  style.ScaleAllSizes(scale);
  ImGui::GetStyle() = style;
}

void drawTransport(PanelLayout& layout, const WindowValues& values, WindowChoices& choices, WindowRequests& requests) {
  const float margin = layout.margin();
  const float inset = values.insetWidth > 0.0 ? values.insetWidth + 2.0f * margin : 0.0f;
  const float width = layout.width - 2.0f * margin - inset;
  const bool narrow = width < layout.of(540.0f);
  ImGui::SetNextWindowPos(ImVec2(margin, layout.height - margin), ImGuiCond_Always, ImVec2(0.0f, 1.0f));
  ImGui::SetNextWindowSize(ImVec2(width, 0.0f));
  ImGui::Begin("transport", nullptr, kFixed | ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoScrollbar);
  const ImVec2 button(layout.of(64.0f), 0.0f);
  if (ImGui::Button(choices.paused ? "Play###play" : "Pause###play", button)) choices.paused = !choices.paused;
  ImGui::SameLine();
  if (ImGui::Button("Step", ImVec2(layout.of(52.0f), 0.0f))) {
    choices.paused = true;
    ++choices.steps;
  }
  if (values.duration > 0.0) {
    ImGui::SameLine();
    if (!narrow) {
      if (ImGui::Button("Start", ImVec2(layout.of(56.0f), 0.0f))) requests.seekTo = 0.0;
      ImGui::SameLine();
    }
    const float speedWidth = narrow ? 0.0f : layout.of(200.0f);
    float seconds = values.seconds;
    const float duration = values.duration;
    const auto text = [&](double at) {
      return narrow ? fmt::format("{:.1f} s", at) : fmt::format("{:.1f} of {:.1f} s", at, values.duration);
    };
    const float room = std::max(ImGui::GetContentRegionAvail().x - speedWidth, layout.of(60.0f));
    ImGui::SetNextItemWidth(besideSlider(room, text(values.duration)));
    if (ImGui::SliderFloat("##time", &seconds, 0.0f, duration, "",
                           ImGuiSliderFlags_NoInput | ImGuiSliderFlags_NoRoundToFormat)) {
      requests.seekTo = seconds;
    }
    choices.scrubbing = ImGui::IsItemActive();
    ImGui::SameLine();
    ImGui::TextUnformatted(text(values.seconds).c_str());
    if (!narrow) {
      ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - speedWidth + ImGui::GetStyle().ItemSpacing.x);
      ImGui::AlignTextToFramePadding();
      ImGui::TextColored(kFaint, "speed %.2g", choices.speed);
      ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - layout.of(110.0f));
      ImGui::SetNextItemWidth(layout.of(110.0f));
      float speed = choices.speed;
      if (ImGui::SliderFloat("##speed", &speed, kSlowest, kFastest, "",
                             ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_NoInput)) {
        // Snap to full speed.
        choices.speed = std::abs(speed - 1.0f) < 0.08f ? 1.0 : std::clamp<double>(speed, kSlowest, kFastest);
      }
    }
  } else {
    ImGui::SameLine();
    ImGui::AlignTextToFramePadding();
    ImGui::TextColored(kFaint, "live, %.1f s", values.seconds);
  }
  if (layout.height > layout.of(260.0f)) {
    ImGui::TextUnformatted(values.name.data(), values.name.data() + values.name.size());
    ImGui::SameLine(0.0f, layout.of(16.0f));
    ImGui::PushStyleColor(ImGuiCol_Text, kFaint);
    ImGui::TextUnformatted(values.status.data(), values.status.data() + values.status.size());
    ImGui::PopStyleColor();
    const char* hint = "H help";
    const float hintWidth = ImGui::CalcTextSize(hint).x;
    const float hintPosition = ImGui::GetWindowContentRegionMax().x - hintWidth;
    if (ImGui::GetItemRectMax().x - ImGui::GetWindowPos().x + layout.of(16.0f) < hintPosition) {
      ImGui::SameLine(hintPosition);
      ImGui::TextColored(kFaint, "%s", hint);
    }
  }
  notePanel(layout);
  layout.floor = ImGui::GetWindowPos().y;
  layout.rightFloor = std::min<float>(layout.floor, layout.height - values.insetHeight - margin);
  ImGui::End();
}

void drawViewPanel(PanelLayout& layout, const WindowValues& values, WindowChoices& choices, WindowRequests& requests) {
  const float margin = layout.margin();
  const float width = std::min(layout.of(kViewPanel), 0.5f * (layout.width - 3.0f * margin));
  const float room = layout.floor - 2.0f * margin;
  if (room < layout.of(40.0f)) return;
  ImGui::SetNextWindowPos(ImVec2(margin, margin));
  foldAsSizeSays(layout, layout.view);
  ImGui::SetNextWindowSizeConstraints(ImVec2(width, 0.0f), ImVec2(width, room));
  const bool open = ImGui::Begin("View", nullptr, kFixed | ImGuiWindowFlags_AlwaysAutoResize);
  noteFold(layout.view);
  if (open) {
    SceneOptions& show = choices.show;
    toggle("character", "1", show.skin);
    toggle("hulls", "2", show.hulls);
    toggle("bones", "3", show.bones);
    toggle("props", "4", show.props);
    toggle("contacts", "5", show.contacts);
    toggle("ground", "6", show.ground);
    toggle("grains", "7", show.particles);
    toggle("colour by part", "C", show.colorSkinByPart);
    toggle("follow", "F", choices.follow);
    if (values.duration > 0.0) toggle("loop", "L", choices.loop, values.noLoop);
    ImGui::Separator();
    const float slider = ImGui::GetContentRegionAvail().x;
    if (values.maxParts > 0) {
      int parts = values.parts;
      ImGui::SetNextItemWidth(besideSlider(slider, "100 parts ..."));
      if (ImGui::SliderInt("##parts", &parts, 1, values.maxParts, "",
                           ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_NoInput)) {
        requests.parts = parts;
      }
      ImGui::SameLine();
      ImGui::TextUnformatted(
          fmt::format("{} {}{}", parts, parts == 1 ? "part" : "parts", values.preparingParts ? " ..." : "").c_str());
    }
    if (values.avatars.size() > 1) {
      chooseFrom("avatar", "follow: ", "all avatars", values.avatars, values.avatar, requests.avatar);
    }
    chooseFile("motion", values.motions, values.motion, requests);
    if (!values.scenes.empty()) chooseFrom("scene", "", nullptr, values.scenes, values.scene, requests.scene);
    if (!values.expressions.empty()) {
      chooseFrom("expression", "expression: ", "none", values.expressions, values.expression, requests.expression);
    }
    chooseFile("files", values.recent, -1, requests);
    if (!values.hint.empty()) {
      ImGui::PushStyleColor(ImGuiCol_Text, kFaint);
      ImGui::TextWrapped("%.*s", countOf(values.hint), values.hint.data());
      ImGui::PopStyleColor();
    }
    if (!values.qualities.empty()) {
      ImGui::SetNextItemWidth(slider);
      const char* now = values.qualities[values.quality];
      const std::string chosen =
          choices.quality < 0 ? fmt::format("quality: {} (auto)", now) : fmt::format("quality: {}", now);
      if (ImGui::BeginCombo("##quality", chosen.c_str())) {
        if (ImGui::Selectable("automatic", choices.quality < 0)) choices.quality = -1;
        for (int q = countOf(values.qualities) - 1; q >= 0; --q) {
          if (ImGui::Selectable(values.qualities[q], choices.quality == q)) choices.quality = q;
        }
        ImGui::EndCombo();
      }
    }
    if (keyedButton("throw a ball", "B", values.noThrow)) requests.throwBall = true;
    if (keyedButton("undo", "U", values.noUndo)) requests.undo = true;
    if (keyedButton("save a picture", "P")) choices.picture = true;
    if (keyedButton(values.videoSeconds < 0.0 ? "start a video###video" : "stop the video###video", "V")) {
      choices.video = true;
    }
  }
  notePanel(layout);
  layout.left = ImGui::GetWindowPos().y + ImGui::GetWindowSize().y;
  ImGui::End();
}

}  // namespace lorica
