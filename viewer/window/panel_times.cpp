#include "viewer/window/panel_parts.h"

#include <algorithm>
#include <cstdio>

namespace lorica {
namespace {

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

}  // namespace lorica
