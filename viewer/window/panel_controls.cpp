#include "geometry/counts.h"
#include "geometry/text.h"
#include "viewer/window/panel_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>

namespace lorica {
namespace {

constexpr float kSmallSwitch = 84.0f;  // longest name of one that has another one beside it
constexpr float kLabels = 112.0f;      // where the lists begin

/// A text as far as it fits into a width [pixels]; a shortened one ends with dots.
std::string fitted(const std::string& text, float width) {
  if (ImGui::CalcTextSize(text.c_str()).x <= width) return text;
  const auto shortened = [&](std::size_t length) { return std::string(firstBytes(text, length)) + "..."; };
  std::size_t length = text.size();
  while (length > 0 && ImGui::CalcTextSize(shortened(length).c_str()).x > width) --length;
  return shortened(length);
}

/// Call after the widget of a control that was begun as disabled if it cannot be done.
void endWidget(const Control& control) {
  ImGui::EndDisabled();
  if (control.whyNot.empty() || !ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  ImGui::SetTooltip("%.*s", countOf(control.whyNot), control.whyNot.data());
}

/// A box with a mark, its name, and its key at the right edge; all of it is clicked.
void drawToggle(const PanelLayout& layout, const Control& control, Asked& asked, float right) {
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const float high = ImGui::GetFrameHeight(), side = layout.of(18.0f), pad = ImGui::GetStyle().FramePadding.y;
  const float width =
      (right > 0.0f ? right : ImGui::GetWindowContentRegionMax().x) - (corner.x - ImGui::GetWindowPos().x);
  const bool on = control.value != 0.0;
  if (ImGui::InvisibleButton("###toggle", ImVec2(width, high))) asked.ask({.id = control.id, .to = on ? 0.0 : 1.0});
  endWidget(control);
  const float fade = control.whyNot.empty() ? 1.0f : ImGui::GetStyle().DisabledAlpha;
  const auto ink = [&](ImGuiCol slot) { return ImGui::GetColorU32(slot, fade); };
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 box(corner.x, corner.y + 0.5f * (high - side)), end(box.x + side, box.y + side);
  list.AddRectFilled(box, end, ink(on ? ImGuiCol_PlotHistogram : ImGuiCol_FrameBg), layout.of(4.0f));
  if (on) {
    const auto point = [&](float x, float y) { return ImVec2(box.x + x * side, box.y + y * side); };
    const std::array<ImVec2, 3> mark = {point(0.22f, 0.52f), point(0.42f, 0.72f), point(0.78f, 0.30f)};
    list.AddPolyline(mark.data(), countOf(mark), ink(ImGuiCol_CheckMark), ImDrawFlags_None, layout.of(2.2f));
  } else {
    list.AddRect(box, end, ink(ImGuiCol_TextDisabled), layout.of(4.0f));
  }
  list.AddText(ImVec2(end.x + layout.of(9.0f), corner.y + pad), ink(ImGuiCol_Text), control.label);
  const float key = ImGui::CalcTextSize(control.keys).x;
  list.AddText(ImVec2(corner.x + width - key, corner.y + pad), ink(ImGuiCol_TextDisabled), control.keys);
}

/// As wide as the panel, with its key at the right edge.
void drawButton(const PanelLayout& layout, const Control& control, Asked& asked) {
  const ImVec2 size(ImGui::GetContentRegionAvail().x, 0.0f);
  const bool most = control.id == ControlId::kThrow && control.whyNot.empty();  // what is done most
  const Strong strong(layout, most);
  if (ImGui::Button(fmt::format("{}###{}", control.label, control.name).c_str(), size)) asked.ask({.id = control.id});
  endWidget(control);
  const ImVec2 corner = ImGui::GetItemRectMax(), text = ImGui::CalcTextSize(control.keys);
  const float pad = ImGui::GetStyle().FramePadding.y;
  ImGui::GetWindowDrawList()->AddText(ImVec2(corner.x - text.x - 2.5f * pad, corner.y - text.y - pad),
                                      ImGui::GetColorU32(most ? ImGuiCol_Text : ImGuiCol_TextDisabled), control.keys);
}

void drawNumber(const PanelLayout& layout, const Control& control, Asked& asked) {
  float value = control.value;
  const float width =
      besideSlider(ImGui::GetContentRegionAvail().x,
                   fmt::format("{} {} ...", std::max(static_cast<int>(control.most), 100), control.label));
  if (drawSlider(layout, "##number", width, value, control.least, control.most)) {
    asked.ask({.id = control.id, .to = std::round(value)});
  }
  endWidget(control);
  ImGui::SameLine();
  ImGui::TextUnformatted(fmt::format("{} {}", std::lround(value), control.label).c_str());
}

/// Names of files without their folders, which are tooltips.
void drawList(const PanelLayout& layout, const Control& control, Asked& asked) {
  const bool files = control.kind == ControlKind::kFiles;
  const auto nameOf = [&](int index) {
    const std::string& full = control.choices[static_cast<std::size_t>(index)];
    return full.c_str() + (files ? full.rfind('/') + 1 : 0);
  };
  const int chosen = static_cast<int>(control.value);
  const bool opensAgain = control.id == ControlId::kRecent;  // none of them is the present one
  if (!opensAgain) {
    ImGui::AlignTextToFramePadding();
    ImGui::TextDisabled("%s", control.label);
    ImGui::SameLine(layout.of(kLabels));
  }
  const std::string shown = opensAgain ? control.label : chosen < 0 ? control.none : nameOf(chosen);
  const float width = ImGui::GetContentRegionAvail().x, pad = ImGui::GetStyle().FramePadding.x;
  ImGui::SetNextItemWidth(width);
  const std::string now = fitted(shown, width - ImGui::GetFrameHeight() - 2.0f * pad);
  if (!control.whyNot.empty()) {
    (void)ImGui::BeginCombo("##list", now.c_str());  // stays closed
    return endWidget(control);
  }
  ImGui::EndDisabled();  // else it would have to end within the list
  if (!ImGui::BeginCombo("##list", now.c_str())) return;
  if (control.least < 0.0 && ImGui::Selectable(control.none, chosen < 0)) asked.ask({.id = control.id, .to = -1.0});
  for (int n = 0; n < countOf(control.choices); ++n) {
    ImGui::PushID(n);
    if (ImGui::Selectable(nameOf(n), n == chosen)) asked.ask({.id = control.id, .to = n});
    ImGui::PopID();
    const std::string& full = control.choices[static_cast<std::size_t>(n)];
    if (nameOf(n) != full.c_str() && ImGui::IsItemHovered()) ImGui::SetTooltip("%s", full.c_str());
  }
  ImGui::EndCombo();
}

/// Draws a control, and asks for what the user does with it. What cannot be done says why under the mouse.
/// @param right  edge of its key; 0 = that of the panel
void drawControl(const PanelLayout& layout, const Control& control, Asked& asked, float right) {
  ImGui::PushID(control.name);
  ImGui::BeginDisabled(!control.whyNot.empty());
  switch (control.kind) {
    case ControlKind::kToggle:
      drawToggle(layout, control, asked, right);
      break;
    case ControlKind::kButton:
      drawButton(layout, control, asked);
      break;
    case ControlKind::kNumber:
      drawNumber(layout, control, asked);
      break;
    case ControlKind::kList:
    case ControlKind::kFiles:
      drawList(layout, control, asked);
      break;
    case ControlKind::kOther:
      ImGui::EndDisabled();
      break;
  }
  ImGui::PopID();
}

/// The name of a count at the right edge.
void hitsOf(const TargetScore& target) {
  const std::string count = std::to_string(target.hits);
  const float width = ImGui::CalcTextSize(count.c_str()).x;
  ImGui::TextUnformatted(fitted(target.name, ImGui::GetContentRegionAvail().x - 2.0f * width).c_str());
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - width);
  ImGui::TextUnformatted(count.c_str());
}

/// Draws what a group has, switches with short names in two columns where there is room.
/// @param from, to  the first one, and that behind the last one
void drawControls(const PanelLayout& layout, const Controls& controls, ControlId from, ControlId to, Asked& asked) {
  const float width = ImGui::GetContentRegionAvail().x, left = ImGui::GetCursorPosX(), gap = layout.of(10.0f);
  bool second = false;
  for (std::size_t i = static_cast<std::size_t>(from); i < static_cast<std::size_t>(to); ++i) {
    const Control& control = controls[i];
    if (!control.isOn(on_screen::kWindow) || control.absent) continue;
    const bool small = control.kind == ControlKind::kToggle && *control.keys != '\0' &&
                       ImGui::CalcTextSize(control.label).x < layout.of(kSmallSwitch);
    const bool two = small && width >= layout.of(220.0f);
    if (two && second) ImGui::SameLine(left + 0.5f * (width + gap));
    drawControl(layout, control, asked, two && !second ? left + 0.5f * (width - gap) : 0.0f);
    second = two && !second;
  }
}

}  // namespace

float besideSlider(float room, const std::string& longest) {
  return std::max(room - ImGui::CalcTextSize(longest.c_str()).x - ImGui::GetStyle().ItemSpacing.x, 0.3f * room);
}

void drawLookPanel(PanelLayout& layout, const Controls& controls, Asked& asked) {
  bool open = false;
  if (!beginSide(layout, layout.look, "Look", false, open)) return;
  if (open) drawControls(layout, controls, ControlId::kSkin, ControlId::kPanels, asked);
  endSide(layout, false);
}

void drawWhoPanel(PanelLayout& layout, const WindowValues& values, const Controls& controls, Asked& asked) {
  bool open = false;
  if (!beginSide(layout, layout.who, "Who and what", true, open)) return;
  if (open) {
    drawControls(layout, controls, ControlId::kCharacter, ControlId::kMirror, asked);
    if (!values.hint.empty()) {
      ImGui::PushStyleColor(ImGuiCol_Text, inkOf(layout.colors->faint));
      ImGui::TextWrapped("%.*s", static_cast<int>(values.hint.size()), values.hint.data());
      ImGui::PopStyleColor();
    }
    ImGui::Separator();
    drawControls(layout, controls, ControlId::kMirror, ControlId::kSkin, asked);
    if (!values.hits.empty()) ImGui::Separator();
    for (const TargetScore& target : values.hits) hitsOf(target);
  }
  endSide(layout, true);
}

}  // namespace lorica
