#include "viewer/window/panel_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace lorica {
namespace {

constexpr ImU32 kPlate = IM_COL32(22, 26, 33, 224);
constexpr ImU32 kInk = IM_COL32(236, 240, 245, 255);
constexpr ImU32 kAmber = IM_COL32(255, 190, 84, 255);
constexpr ImU32 kRed = IM_COL32(235, 78, 70, 255);

const ImVec4 kTitle(0.55f, 0.82f, 1.0f, 1.0f), kGrey(0.40f, 0.43f, 0.48f, 1.0f);

constexpr double kDotSeconds = 0.4;
constexpr float kKeys = 104.0f, kColumn = 366.0f;  // widths in the help

bool isHelped(const Control& control) {
  return control.isOn(on_screen::kWindow) && *control.keys != '\0';
}

/// The controls of some groups that have keys.
void drawColumn(std::span<const ControlGroup> groups, const PanelLayout& layout, const Controls& controls) {
  ImGui::BeginGroup();
  for (const ControlGroup group : groups) {
    ImGui::TextColored(kTitle, "%s", kControlGroups[static_cast<std::size_t>(group)]);
    for (const Control& control : controls) {
      if (control.group != group || !isHelped(control)) continue;
      const bool works = !control.absent && control.whyNot.empty();
      ImGui::TextColored(works ? ImGui::GetStyle().Colors[ImGuiCol_Text] : kGrey, "%s", control.keys);
      ImGui::SameLine(layout.of(kKeys));
      ImGui::TextColored(works ? kFaint : kGrey, "%s", *control.help != '\0' ? control.help : control.label);
    }
  }
  ImGui::EndGroup();
}

std::size_t linesOf(std::span<const ControlGroup> groups, const Controls& controls) {
  std::size_t lines = groups.size();
  for (const Control& control : controls) {
    if (isHelped(control) && std::find(groups.begin(), groups.end(), control.group) != groups.end()) ++lines;
  }
  return lines;
}

constexpr std::array kLeft = {ControlGroup::kCamera, ControlGroup::kTime, ControlGroup::kThings};
constexpr std::array kRight = {ControlGroup::kLook, ControlGroup::kScreen};

/// A message on its own plate, centred horizontally and not over open panels. The next one is placed below.
void drawPlate(PanelLayout& layout, std::string_view text, ImU32 ink, ImU32 mark) {
  const float top = layout.ceiling;
  ImDrawList& list = *ImGui::GetForegroundDrawList();
  const char* begin = text.data();
  const char* end = begin + text.size();
  const float pad = layout.of(8.0f), bar = layout.of(4.0f);
  const float panel = layout.small() || layout.panels.empty() ? 0.0f : layout.of(kPanelWidth) + layout.margin();
  const float wrap = layout.width - 2.0f * (panel + layout.margin() + pad) - bar;
  const ImVec2 size = ImGui::CalcTextSize(begin, end, false, wrap);
  const float left = std::round(0.5f * (layout.width - size.x - 2.0f * pad - bar));
  const ImVec2 corner(left + size.x + 2.0f * pad + bar, top + size.y + pad);
  list.AddRectFilled(ImVec2(left, top), corner, kPlate, layout.of(5.0f));
  if (mark != 0) {
    list.AddRectFilled(ImVec2(left, top), ImVec2(left + bar, corner.y), mark, layout.of(5.0f),
                       ImDrawFlags_RoundCornersLeft);
  }
  list.AddText(nullptr, 0.0f, ImVec2(left + bar + pad, top + std::round(0.5f * pad)), ink, begin, end, wrap);
  layout.ceiling = corner.y + layout.of(4.0f);
}

}  // namespace

void drawMessages(PanelLayout& layout, const WindowValues& values, bool all) {
  // Between the panels, or below their titles if there is no space between them.
  if (layout.small() && !layout.panels.empty()) {
    layout.ceiling = std::max(layout.ceiling + layout.of(kPanelLine + 12.0f), layout.titles + layout.of(4.0f));
  }
  if (all) {
    for (const std::string& warning : values.warnings) drawPlate(layout, warning, kAmber, kAmber);
    if (values.videoSeconds >= 0.0) {
      drawPlate(layout, fmt::format("video {:.1f} s, V to stop", values.videoSeconds), kInk, kRed);
    }
  }
  if (values.typed) drawPlate(layout, fmt::format("file to open: {}_   (enter, or esc)", *values.typed), kInk, kAmber);
  if (!values.notice.empty()) drawPlate(layout, values.notice, kInk, values.problem ? kRed : 0);
}

void drawLoading(PanelLayout& layout, const WindowValues& values, Asked& asked) {
  const float width = std::min(layout.of(360.0f), layout.width - 2.0f * layout.margin());
  ImGui::SetNextWindowPos(ImVec2(0.5f * layout.width, layout.ceiling), ImGuiCond_Always, ImVec2(0.5f, 0.0f));
  ImGui::SetNextWindowSize(ImVec2(width, 0.0f));
  ImGui::SetNextWindowBgAlpha(0.92f);
  ImGui::Begin("loading", nullptr, kFixed | ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoScrollbar);
  ImGui::PushTextWrapPos(0.0f);
  // Dots that come and go: it is alive where the share stays for a while.
  const int dots = int(ImGui::GetTime() / kDotSeconds) % 4;
  ImGui::TextUnformatted(fmt::format("{} {}", values.loading, std::string(dots, '.')).c_str());
  ImGui::PopTextWrapPos();
  const float button = layout.of(72.0f);
  const ImVec2 bar(ImGui::GetContentRegionAvail().x - button - ImGui::GetStyle().ItemSpacing.x, 0.0f);
  ImGui::ProgressBar(values.loaded, bar);
  ImGui::SameLine();
  if (ImGui::Button("Cancel", ImVec2(button, 0.0f))) asked.ask({.id = ControlId::kCancel});
  notePanel(layout);
  layout.ceiling = ImGui::GetWindowPos().y + ImGui::GetWindowSize().y + layout.of(4.0f);
  ImGui::End();
}

void drawHelp(PanelLayout& layout, const Controls& controls) {
  // Below the warnings and above the transport. If that is too small, it covers the transport and scrolls if needed.
  constexpr float kTitleAndPads = 46.0f;
  const bool two = layout.width >= layout.of(2.0f * kColumn) + 4.0f * layout.margin();
  const std::size_t left = linesOf(kLeft, controls), right = linesOf(kRight, controls);
  const std::size_t lines = two ? std::max(left, right) : left + right;
  const float wanted = ImGui::GetTextLineHeightWithSpacing() * lines + layout.of(kTitleAndPads);
  const float top = layout.ceiling;
  const float above = layout.panels.empty() ? layout.height - layout.margin() : layout.floor - layout.of(4.0f);
  const float bottom = wanted <= above - top ? above : layout.height - layout.margin();
  const float room = std::max(bottom - top, layout.of(40.0f));
  ImGui::SetNextWindowPos(ImVec2(0.5f * layout.width, 0.5f * (top + bottom)), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
  ImGui::SetNextWindowSizeConstraints(ImVec2(0.0f, 0.0f), ImVec2(layout.width - 2.0f * layout.margin(), room));
  ImGui::SetNextWindowBgAlpha(0.92f);
  ImGui::SetNextWindowFocus();
  ImGui::Begin("Keys and mouse", nullptr, kFixed | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse);
  drawColumn(kLeft, layout, controls);
  if (two) ImGui::SameLine(layout.of(kColumn));
  drawColumn(kRight, layout, controls);
  notePanel(layout);
  ImGui::End();
}

}  // namespace lorica
