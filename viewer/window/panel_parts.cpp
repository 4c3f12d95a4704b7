#include "viewer/window/panel_parts.h"
#include "geometry/counts.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>

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
  // Dear ImGui itself folds by a click on the arrow only, at the right, or by two clicks.
  const float arrow = ImGui::GetWindowPos().x + ImGui::GetWindowSize().x - 2.0f * ImGui::GetFrameHeight();
  const bool besideArrow = ImGui::GetMousePos().x < arrow;
  if (besideArrow && ImGui::IsItemClicked()) ImGui::SetWindowCollapsed(!ImGui::IsWindowCollapsed());
  if (!*fold.small) fold.openIfLarge = !ImGui::IsWindowCollapsed();
  return true;
}

void endSide(PanelLayout& layout, bool left) {
  notePanel(layout);
  (left ? layout.left : layout.right) = ImGui::GetWindowPos().y + ImGui::GetWindowSize().y;
  ImGui::End();
}

void setPanelStyle(const PanelColors& colors, float scale) {
  ImGuiStyle style;
  style.WindowRounding = style.PopupRounding = 14.0f;
  style.FrameRounding = 9.0f;
  style.GrabRounding = 8.0f;
  style.WindowBorderSize = style.FrameBorderSize = 0.0f;
  style.WindowPadding = ImVec2(14.0f, 10.0f);
  style.FramePadding = ImVec2(10.0f, 5.0f);
  style.ItemSpacing = ImVec2(8.0f, 5.0f);
  style.GrabMinSize = 16.0f;
  style.ScrollbarSize = 10.0f;
  style.WindowMenuButtonPosition = ImGuiDir_Right;  // of the arrow that folds
  const auto set = [&style](std::uint32_t color, std::initializer_list<int> slots, float alpha = 1.0f) {
    ImVec4 value = ImGui::ColorConvertU32ToFloat4(inkOf(color));
    value.w *= alpha;
    for (const int slot : slots) style.Colors[slot] = value;
  };
  set(colors.text, {ImGuiCol_Text});
  set(colors.faint, {ImGuiCol_TextDisabled});
  set(colors.panel, {ImGuiCol_WindowBg, ImGuiCol_TitleBg, ImGuiCol_TitleBgActive, ImGuiCol_TitleBgCollapsed});
  set(colors.panel | 0xff, {ImGuiCol_PopupBg});
  set(colors.raised, {ImGuiCol_FrameBg, ImGuiCol_Button});
  set(colors.line, {ImGuiCol_FrameBgHovered, ImGuiCol_ButtonHovered, ImGuiCol_FrameBgActive, ImGuiCol_Separator,
                    ImGuiCol_HeaderHovered, ImGuiCol_Header, ImGuiCol_ScrollbarGrab});
  set(colors.strong, {ImGuiCol_SliderGrab, ImGuiCol_SliderGrabActive, ImGuiCol_ButtonActive, ImGuiCol_HeaderActive,
                      ImGuiCol_PlotHistogram, ImGuiCol_ScrollbarGrabActive});
  set(colors.onStrong, {ImGuiCol_CheckMark});
  set(colors.panel, {ImGuiCol_ScrollbarBg}, 0.0f);
  style.ScaleAllSizes(scale);
  ImGui::GetStyle() = style;
}

Strong::Strong(const PanelLayout& layout, bool on) {
  if (!on) return;
  for (const ImGuiCol slot : {ImGuiCol_Button, ImGuiCol_ButtonHovered, ImGuiCol_FrameBg, ImGuiCol_FrameBgHovered}) {
    ImGui::PushStyleColor(slot, inkOf(layout.colors->strong));
  }
  ImGui::PushStyleColor(ImGuiCol_Text, inkOf(layout.colors->onStrong));
  count_ = 5;
}

bool drawSlider(const PanelLayout& layout, const char* id, float width, float& value, float least, float most) {
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  // Dear ImGui's own frame and knob are not seen, but take the mouse.
  for (const ImGuiCol slot : {ImGuiCol_FrameBg, ImGuiCol_FrameBgHovered, ImGuiCol_FrameBgActive, ImGuiCol_SliderGrab,
                              ImGuiCol_SliderGrabActive}) {
    ImGui::PushStyleColor(slot, ImVec4());
  }
  ImGui::SetNextItemWidth(width);
  const bool changed =
      ImGui::SliderFloat(id, &value, least, most, "", ImGuiSliderFlags_NoInput | ImGuiSliderFlags_NoRoundToFormat);
  ImGui::PopStyleColor(5);
  const float radius = 0.5f * ImGui::GetStyle().GrabMinSize, half = layout.of(3.0f);
  const float y = corner.y + 0.5f * ImGui::GetFrameHeight(), from = corner.x + radius + 2.0f;
  const float share = most > least ? std::clamp((value - least) / (most - least), 0.0f, 1.0f) : 0.0f;
  const float at = from + share * std::max(width - 2.0f * radius - 4.0f, 0.0f);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImU32 strong = ImGui::GetColorU32(ImGuiCol_PlotHistogram);
  list.AddRectFilled(ImVec2(corner.x, y - half), ImVec2(corner.x + width, y + half),
                     ImGui::GetColorU32(ImGuiCol_Separator), half);
  list.AddRectFilled(ImVec2(corner.x, y - half), ImVec2(at, y + half), strong, half);
  list.AddCircleFilled(ImVec2(at, y), radius, strong);
  return changed;
}

namespace {

constexpr float kIconWidth = 40.0f;

enum class Icon { kPlay, kPause, kStep, kStart, kHelp };

/// A button with a drawing, as on the page.
bool drawIcon(const PanelLayout& layout, const char* id, Icon icon) {
  const ImVec2 size(layout.of(kIconWidth), ImGui::GetFrameHeight());
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const bool pressed = ImGui::Button(id, size);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImU32 ink = ImGui::GetColorU32(ImGuiCol_Text);
  const float r = layout.of(7.0f), x = corner.x + 0.5f * size.x, y = corner.y + 0.5f * size.y, bar = layout.of(3.0f);
  const auto upright = [&](float left) { list.AddRectFilled(ImVec2(left, y - r), ImVec2(left + bar, y + r), ink); };
  const auto triangle = [&](float tail, float tip) {
    list.AddTriangleFilled(ImVec2(tail, y - r), ImVec2(tip, y), ImVec2(tail, y + r), ink);
  };
  switch (icon) {
    case Icon::kPlay:
      triangle(x - 0.7f * r, x + r);
      break;
    case Icon::kPause:
      upright(x - bar - 0.2f * r);
      upright(x + 0.2f * r);
      break;
    case Icon::kStep:
      triangle(x - r, x + 0.5f * r);
      upright(x + 0.6f * r);
      break;
    case Icon::kStart:
      triangle(x + r, x - 0.5f * r);
      upright(x - 0.6f * r - bar);
      break;
    case Icon::kHelp: {
      const ImVec2 sign = ImGui::CalcTextSize("?");
      list.AddText(ImVec2(x - 0.5f * sign.x, y - 0.5f * sign.y), ink, "?");
      break;
    }
  }
  return pressed;
}

}  // namespace

void drawTransport(PanelLayout& layout, const WindowValues& values, const Controls& controls, Asked& asked) {
  using Id = ControlId;
  const float margin = layout.margin();
  const float inset = values.insetWidth > 0.0 ? values.insetWidth + 2.0f * margin : 0.0f;
  const float width = layout.width - 2.0f * margin - inset;
  const bool narrow = width < layout.of(640.0f);
  ImGui::SetNextWindowPos(ImVec2(margin, layout.height - margin), ImGuiCond_Always, ImVec2(0.0f, 1.0f));
  ImGui::SetNextWindowSize(ImVec2(width, 0.0f));
  ImGui::Begin("transport", nullptr, kFixed | ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoScrollbar);
  const bool paused = controls[Id::kPause].value != 0.0;
  if (drawIcon(layout, "###play", paused ? Icon::kPlay : Icon::kPause)) asked.ask({.id = Id::kPause});
  ImGui::SameLine();
  if (drawIcon(layout, "###step", Icon::kStep)) asked.ask({.id = Id::kStep});
  if (const Control& seek = controls[Id::kSeek]; !seek.absent) {
    ImGui::SameLine();
    if (!narrow) {
      if (drawIcon(layout, "###start", Icon::kStart)) asked.ask({.id = Id::kRestart});
      ImGui::SameLine();
    }
    const float gap = ImGui::GetStyle().ItemSpacing.x, wide = layout.of(44.0f) + gap;
    const Control& speed = controls[Id::kSpeed];
    const float help = layout.of(kIconWidth) + gap;
    const float speedWidth = help + (narrow ? 0.0f : static_cast<float>(countOf(speed.choices)) * wide);
    float seconds = values.seconds;
    const auto text = [&](double at) {
      return narrow ? fmt::format("{:.1f} s", at) : fmt::format("{:.1f} of {:.1f} s", at, seek.most);
    };
    const float room = std::max(ImGui::GetContentRegionAvail().x - speedWidth, layout.of(60.0f));
    if (drawSlider(layout, "##time", besideSlider(room, text(seek.most)), seconds, 0.0f, seek.most)) {
      asked.ask({.id = Id::kSeek, .to = std::min<double>(seconds, seek.most)});
    }
    asked.choices.scrubbing = ImGui::IsItemActive();
    ImGui::SameLine();
    ImGui::AlignTextToFramePadding();
    ImGui::TextUnformatted(text(values.seconds).c_str());
    const float end = ImGui::GetWindowContentRegionMax().x;
    for (int i = 0; i < countOf(speed.choices) && !narrow; ++i) {
      ImGui::SameLine(end - help - static_cast<float>(countOf(speed.choices) - i) * wide);
      const Strong strong(layout, speed.value == i);
      if (ImGui::Button(speed.choices[i].c_str(), ImVec2(wide - gap, 0.0f))) asked.ask({.id = Id::kSpeed, .to = i});
    }
  } else {
    ImGui::SameLine();
    ImGui::AlignTextToFramePadding();
    ImGui::TextDisabled("live, %.1f s", values.seconds);
  }
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - layout.of(kIconWidth));
  if (drawIcon(layout, "###help", Icon::kHelp)) asked.ask({.id = Id::kHelp});
  if (layout.height > layout.of(260.0f)) {
    ImGui::TextUnformatted(values.name.data(), values.name.data() + values.name.size());
    ImGui::SameLine(0.0f, layout.of(16.0f));
    ImGui::TextDisabled("%.*s", countOf(values.status), values.status.data());
  }
  notePanel(layout);
  layout.floor = ImGui::GetWindowPos().y;
  layout.rightFloor = std::min<float>(layout.floor, layout.height - values.insetHeight - margin);
  ImGui::End();
}

}  // namespace lorica
