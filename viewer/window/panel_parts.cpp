#include "viewer/window/panel_parts.h"
#include "geometry/counts.h"

#include <fmt/format.h>

#include <algorithm>

namespace lorica {

void notePanel(PanelLayout& layout) {
  const ImVec2 position = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
  layout.panels.push_back({position.x, position.y, position.x + size.x, position.y + size.y});
  if (ImGui::IsWindowCollapsed()) layout.titles = std::max(layout.titles, position.y + size.y);
}

bool beginSide(PanelLayout& layout, PanelLayout::Fold& fold, const char* title, bool left, bool& open) {
  const float margin = layout.margin(), gap = layout.small() ? layout.of(4.0f) : margin;
  const float above = left ? layout.left : layout.right, top = above > 0.0f ? above + gap : margin;
  const float room = (left ? layout.floor : layout.rightFloor) - margin - top;
  if (room < layout.of(24.0f)) return false;
  const float width = std::min(layout.of(kPanelWidth), 0.5f * (layout.width - 3.0f * margin));
  const ImVec2 corner(left ? margin : layout.width - margin, top);
  ImGui::SetNextWindowPos(corner, ImGuiCond_Always, ImVec2(left ? 0.0f : 1.0f, 0.0f));
  if (fold.small != layout.small()) {
    fold.small = layout.small();
    ImGui::SetNextWindowCollapsed(layout.small() || !fold.openIfLarge);
  }
  ImGui::SetNextWindowSizeConstraints(ImVec2(width, 0.0f), ImVec2(width, room));
  open = ImGui::Begin(title, nullptr, kFixed | ImGuiWindowFlags_AlwaysAutoResize);
  // Dear ImGui itself folds by a click on the arrow only, or by two clicks.
  const bool besideArrow = ImGui::GetMousePos().x > ImGui::GetWindowPos().x + ImGui::GetFrameHeight();
  if (besideArrow && ImGui::IsItemClicked()) ImGui::SetWindowCollapsed(!ImGui::IsWindowCollapsed());
  if (!*fold.small) fold.openIfLarge = !ImGui::IsWindowCollapsed();
  return true;
}

void endSide(PanelLayout& layout, bool left) {
  notePanel(layout);
  (left ? layout.left : layout.right) = ImGui::GetWindowPos().y + ImGui::GetWindowSize().y;
  ImGui::End();
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

void drawTransport(PanelLayout& layout, const WindowValues& values, const Controls& controls, Asked& asked) {
  using Id = ControlId;
  const float margin = layout.margin();
  const float inset = values.insetWidth > 0.0 ? values.insetWidth + 2.0f * margin : 0.0f;
  const float width = layout.width - 2.0f * margin - inset;
  const bool narrow = width < layout.of(540.0f);
  ImGui::SetNextWindowPos(ImVec2(margin, layout.height - margin), ImGuiCond_Always, ImVec2(0.0f, 1.0f));
  ImGui::SetNextWindowSize(ImVec2(width, 0.0f));
  ImGui::Begin("transport", nullptr, kFixed | ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoScrollbar);
  const bool paused = controls[Id::kPause].value != 0.0;
  if (ImGui::Button(paused ? "Play###play" : "Pause###play", ImVec2(layout.of(64.0f), 0.0f))) {
    asked.ask({.id = Id::kPause});
  }
  ImGui::SameLine();
  if (ImGui::Button("Step", ImVec2(layout.of(52.0f), 0.0f))) asked.ask({.id = Id::kStep});
  if (const Control& seek = controls[Id::kSeek]; !seek.absent) {
    ImGui::SameLine();
    if (!narrow) {
      if (ImGui::Button("Start", ImVec2(layout.of(56.0f), 0.0f))) asked.ask({.id = Id::kRestart});
      ImGui::SameLine();
    }
    const float speedWidth = narrow ? 0.0f : layout.of(186.0f);
    float seconds = values.seconds;
    const auto text = [&](double at) {
      return narrow ? fmt::format("{:.1f} s", at) : fmt::format("{:.1f} of {:.1f} s", at, seek.most);
    };
    const float room = std::max(ImGui::GetContentRegionAvail().x - speedWidth, layout.of(60.0f));
    ImGui::SetNextItemWidth(besideSlider(room, text(seek.most)));
    if (ImGui::SliderFloat("##time", &seconds, 0.0f, seek.most, "",
                           ImGuiSliderFlags_NoInput | ImGuiSliderFlags_NoRoundToFormat)) {
      asked.ask({.id = Id::kSeek, .to = std::min<double>(seconds, seek.most)});
    }
    asked.choices.scrubbing = ImGui::IsItemActive();
    ImGui::SameLine();
    ImGui::TextUnformatted(text(values.seconds).c_str());
    const Control& speed = controls[Id::kSpeed];
    for (int i = 0; i < countOf(speed.choices) && !narrow; ++i) {
      const float wide = layout.of(40.0f) + ImGui::GetStyle().ItemSpacing.x;
      ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - static_cast<float>(countOf(speed.choices) - i) * wide +
                      ImGui::GetStyle().ItemSpacing.x);
      const bool present = speed.value == i;
      if (present) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyle().Colors[ImGuiCol_ButtonActive]);
      if (ImGui::Button(speed.choices[i].c_str(), ImVec2(layout.of(40.0f), 0.0f))) {
        asked.ask({.id = Id::kSpeed, .to = i});
      }
      if (present) ImGui::PopStyleColor();
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

}  // namespace lorica
