#include "viewer/window/panel_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
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

constexpr std::array<ImU32, TimeGraph::kMaxStages> kStageColors = {
    IM_COL32(94, 168, 255, 255),  IM_COL32(120, 214, 166, 255), IM_COL32(240, 205, 98, 255),
    IM_COL32(240, 142, 92, 255),  IM_COL32(214, 122, 200, 255), IM_COL32(150, 150, 240, 255),
    IM_COL32(170, 190, 200, 255), IM_COL32(210, 100, 110, 255)};

/// Upper end of the scale [ms]: one of a few values, so that it rarely changes.
double scaleFor(double milliseconds) {
  constexpr std::array kScales = {0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0};
  const auto* found = std::find_if(kScales.begin(), kScales.end(), [&](double s) { return milliseconds <= s; });
  return found == kScales.end() ? 1000.0 : *found;
}

/// A number at the right edge of the line.
void rightText(const char* format, double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), format, value);
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - ImGui::CalcTextSize(text.data()).x);
  ImGui::TextUnformatted(text.data());
}

/// One bar per frame, with its stages stacked.
void drawBars(const TimeGraph& times, const ImVec2& corner, const ImVec2& size, double scale) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float bar = size.x / TimeGraph::kFrames;
  const float first = corner.x + bar * (TimeGraph::kFrames - times.frameCount());
  for (int f = 0; f < times.frameCount(); ++f) {
    const float left = first + bar * f;
    double sum = 0.0;
    float below = corner.y + size.y;
    for (int s = 0; s < times.stageCount(); ++s) {
      sum += times.milliseconds(f, s);
      const float above = corner.y + size.y * (1.0f - static_cast<float>(std::min(sum / scale, 1.0)));
      list.AddRectFilled(ImVec2(left, above), ImVec2(left + bar, below), kStageColors[s]);
      below = above;
    }
  }
}

}  // namespace

void drawNumbersPanel(PanelLayout& layout, const WindowValues& values, const TimeGraph& times) {
  bool open = false;
  if (layout.small() || !beginSide(layout, layout.numbers, "Numbers", false, open)) return;
  if (open) {
    const double scale = scaleFor(times.longest());
    const ImVec2 corner = ImGui::GetCursorScreenPos();
    const ImVec2 size(ImGui::GetContentRegionAvail().x, layout.of(64.0f));
    ImGui::Dummy(size);
    drawBars(times, corner, size, scale);
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddLine(ImVec2(corner.x, corner.y + size.y), ImVec2(corner.x + size.x, corner.y + size.y),
                 inkOf(layout.colors->line));
    list.AddLine(corner, ImVec2(corner.x + size.x, corner.y), inkOf(layout.colors->line));
    std::array<char, 32> label{};
    std::snprintf(label.data(), label.size(), "%g ms", scale);
    list.AddText(ImVec2(corner.x + layout.of(2.0f), corner.y + layout.of(1.0f)), inkOf(layout.colors->faint),
                 label.data());
    double total = 0.0;
    for (int s = times.stageCount() - 1; s >= 0; --s) {  // same order as in the bars, from the top
      const ImVec2 position = ImGui::GetCursorScreenPos();
      const float box = layout.of(9.0f), drop = 0.5f * (ImGui::GetTextLineHeight() - box);
      list.AddRectFilled(ImVec2(position.x, position.y + drop), ImVec2(position.x + box, position.y + drop + box),
                         kStageColors[s], layout.of(2.0f));
      ImGui::SetCursorPosX(ImGui::GetCursorPosX() + layout.of(16.0f));
      ImGui::TextUnformatted(times.name(s));
      rightText("%.2f ms", times.mean(s));
      total += times.mean(s);
    }
    ImGui::Separator();
    ImGui::TextUnformatted("total");
    rightText("%.2f ms", total);
    ImGui::TextUnformatted("drawing");
    rightText("%.1f ms", values.pictureMilliseconds);
    ImGui::TextUnformatted("frames per second");
    rightText("%.0f", values.picturesASecond);
    if (values.smoothingDelay >= 0.0) {
      ImGui::TextUnformatted("joints are late by");
      rightText("%.0f ms", 1e3 * values.smoothingDelay);
    }
    ImGui::TextUnformatted(values.outsideTraining ? "pose outside training range" : "pose within training range");
  }
  endSide(layout, false);
}

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
