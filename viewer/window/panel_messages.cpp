#include "viewer/window/panel_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string_view>

namespace lorica {
namespace {

constexpr double kDotSeconds = 0.4;
constexpr float kKeys = 110.0f, kBetween = 28.0f;  // widths in the help

bool isHelped(const Control& control) {
  return control.isOn(on_screen::kWindow) && *control.keys != '\0';
}

const char* wordsOf(const Control& control) {
  return *control.help != '\0' ? control.help : control.label;
}

/// On a plate of their own.
void drawKeys(const PanelLayout& layout, const char* keys) {
  const ImVec2 corner = ImGui::GetCursorScreenPos(), size = ImGui::CalcTextSize(keys);
  const float pad = layout.of(5.0f);
  ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(corner.x, corner.y),
                                            ImVec2(corner.x + size.x + 2.0f * pad, corner.y + size.y),
                                            ImGui::GetColorU32(ImGuiCol_FrameBg), layout.of(5.0f));
  ImGui::SetCursorPosX(ImGui::GetCursorPosX() + pad);
  ImGui::TextUnformatted(keys);
}

/// The controls of some groups that have keys.
void drawColumn(std::span<const ControlGroup> groups, const PanelLayout& layout, const Controls& controls) {
  ImGui::BeginGroup();
  for (const ControlGroup group : groups) {
    ImGui::TextUnformatted(kControlGroups[static_cast<std::size_t>(group)]);
    for (const Control& control : controls) {
      if (control.group != group || !isHelped(control)) continue;
      const bool works = !control.absent && control.whyNot.empty();
      ImGui::BeginDisabled(!works);
      drawKeys(layout, control.keys);
      ImGui::SameLine(layout.of(kKeys));
      ImGui::TextDisabled("%s", wordsOf(control));
      ImGui::EndDisabled();
    }
  }
  ImGui::EndGroup();
}

/// Lines and width of a column of the help.
ImVec2 sizeOf(std::span<const ControlGroup> groups, const PanelLayout& layout, const Controls& controls) {
  ImVec2 size(0.0f, static_cast<float>(groups.size()));
  for (const Control& control : controls) {
    if (!isHelped(control) || std::find(groups.begin(), groups.end(), control.group) == groups.end()) continue;
    size.x = std::max(size.x, layout.of(kKeys) + ImGui::CalcTextSize(wordsOf(control)).x);
    size.y += 1.0f;
  }
  return size;
}

constexpr std::array kLeft = {ControlGroup::kCamera, ControlGroup::kTime, ControlGroup::kThings};
constexpr std::array kRight = {ControlGroup::kLook, ControlGroup::kScreen};

/// A message on its own plate, centred horizontally and not over open panels. The next one is placed below.
void drawPlate(PanelLayout& layout, std::string_view text, std::uint32_t plate, std::uint32_t ink) {
  const float top = layout.ceiling;
  ImDrawList& list = *ImGui::GetForegroundDrawList();
  const char* begin = text.data();
  const char* end = begin + text.size();
  const float padX = layout.of(14.0f), padY = layout.of(7.0f);
  const float panel = layout.small() || layout.panels.empty() ? 0.0f : layout.of(kPanelWidth) + layout.margin();
  const float wrap = layout.width - 2.0f * (panel + layout.margin() + padX);
  const ImVec2 size = ImGui::CalcTextSize(begin, end, false, wrap);
  const float left = std::round(0.5f * (layout.width - size.x) - padX);
  const ImVec2 corner(left + size.x + 2.0f * padX, top + size.y + 2.0f * padY);
  list.AddRectFilled(ImVec2(left, top), corner, inkOf(plate), layout.of(12.0f));
  list.AddText(nullptr, 0.0f, ImVec2(left + padX, top + padY), inkOf(ink), begin, end, wrap);
  layout.ceiling = corner.y + layout.of(6.0f);
}

}  // namespace

void drawMessages(PanelLayout& layout, const WindowValues& values, bool all) {
  // Between the panels, or below their titles if there is no space between them.
  if (layout.small() && !layout.panels.empty()) {
    layout.ceiling = std::max(layout.ceiling + layout.of(kPanelLine + 12.0f), layout.titles + layout.of(4.0f));
  }
  const PanelColors& c = *layout.colors;
  if (all) {
    for (const std::string& warning : values.warnings) drawPlate(layout, warning, c.warn, c.warnText);
    if (values.videoSeconds >= 0.0) {
      drawPlate(layout, fmt::format("video {:.1f} s, V to stop", values.videoSeconds), c.bad, c.badText);
    }
  }
  const std::uint32_t panel = c.panel | 0xff;
  if (values.typed) drawPlate(layout, fmt::format("file to open: {}_   (enter, or esc)", *values.typed), panel, c.text);
  if (values.notice.empty()) return;
  values.problem ? drawPlate(layout, values.notice, c.bad, c.badText) : drawPlate(layout, values.notice, panel, c.text);
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
  const ImVec2 left = sizeOf(kLeft, layout, controls), right = sizeOf(kRight, layout, controls);
  const bool two = layout.width >= left.x + right.x + layout.of(kBetween) + 5.0f * layout.margin();
  const float lines = two ? std::max(left.y, right.y) : left.y + right.y;
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
  if (two) ImGui::SameLine(left.x + layout.of(kBetween));
  drawColumn(kRight, layout, controls);
  notePanel(layout);
  ImGui::End();
}

}  // namespace lorica
