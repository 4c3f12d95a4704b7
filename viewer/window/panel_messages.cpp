#include "viewer/window/panel_widgets.h"

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

struct HelpLine {
  const char* keys;  // null = the title of a group
  const char* what;
  bool (*works)(const WindowValues&) = nullptr;  // null = always
};
bool recorded(const WindowValues& values) {
  return values.duration > 0.0;
}
bool loops(const WindowValues& values) {
  return recorded(values) && values.noLoop.empty();
}
bool hasParts(const WindowValues& values) {
  return values.maxParts > 1;
}
bool hasFace(const WindowValues& values) {
  return !values.expressions.empty();
}
bool throws(const WindowValues& values) {
  return values.noThrow.empty();
}
bool undoes(const WindowValues& values) {
  return values.noUndo.empty();
}
bool opens(const WindowValues& values) {
  return values.opens;
}
bool hasSeveral(const WindowValues& values) {
  return values.avatars.size() > 1;
}
constexpr std::array kHelpLeft = {HelpLine{nullptr, "Camera"},
                                  HelpLine{"left drag", "turn, or move a prop"},
                                  HelpLine{"right drag", "shift"},
                                  HelpLine{"wheel", "zoom"},
                                  HelpLine{"F", "follow the avatars, or not"},
                                  HelpLine{"F2 F3 F4 F5", "front, side, back, top"},
                                  HelpLine{"R", "as at first"},
                                  HelpLine{"I", "headset: inside the avatar, beside it"},
                                  HelpLine{"click", "follow an avatar, or all", hasSeveral},
                                  HelpLine{nullptr, "Time"},
                                  HelpLine{"space", "pause, go on"},
                                  HelpLine{"N", "one frame"},
                                  HelpLine{"left, right", "1 s back, ahead", recorded},
                                  HelpLine{"home", "start again", recorded},
                                  HelpLine{"L", "start again at the end, or not", loops},
                                  HelpLine{"- +", "slower, faster", recorded}};
constexpr std::array kHelpRight = {HelpLine{nullptr, "Look"},
                                   HelpLine{"1 2 3 4", "character, hulls, bones, props"},
                                   HelpLine{"5 6 7", "contacts, ground, grains"},
                                   HelpLine{"C", "colours by part"},
                                   HelpLine{"[ ]", "fewer, more parts", hasParts},
                                   HelpLine{"E", "next expression", hasFace},
                                   HelpLine{"tab", "hide, show the panels"},
                                   HelpLine{"ctrl + - 0", "size of the text"},
                                   HelpLine{nullptr, "Things and files"},
                                   HelpLine{"B", "throw a ball", throws},
                                   HelpLine{"U", "undo the last throw or drag", undoes},
                                   HelpLine{"O, or drop", "open files", opens},
                                   HelpLine{"P", "save a picture; shift: with panels"},
                                   HelpLine{"V", "start, stop a video"},
                                   HelpLine{"H", "this help"},
                                   HelpLine{"esc", "close this help, then the window"}};

void drawColumn(std::span<const HelpLine> lines, const PanelLayout& layout, const WindowValues& values) {
  ImGui::BeginGroup();
  for (const HelpLine& help : lines) {
    if (help.keys == nullptr) {
      ImGui::TextColored(kTitle, "%s", help.what);
      continue;
    }
    const bool works = help.works == nullptr || help.works(values);
    ImGui::TextColored(works ? ImGui::GetStyle().Colors[ImGuiCol_Text] : kGrey, "%s", help.keys);
    ImGui::SameLine(layout.of(kKeys));
    ImGui::TextColored(works ? kFaint : kGrey, "%s", help.what);
  }
  ImGui::EndGroup();
}

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

void drawLoading(PanelLayout& layout, const WindowValues& values, WindowRequests& requests) {
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
  if (ImGui::Button("Cancel", ImVec2(button, 0.0f))) requests.cancel = true;
  notePanel(layout);
  layout.ceiling = ImGui::GetWindowPos().y + ImGui::GetWindowSize().y + layout.of(4.0f);
  ImGui::End();
}

void drawHelp(PanelLayout& layout, const WindowValues& values) {
  // Below the warnings and above the transport. If that is too small, it covers the transport and scrolls if needed.
  constexpr float kTitleAndPads = 46.0f;
  const bool two = layout.width >= layout.of(2.0f * kColumn) + 4.0f * layout.margin();
  const std::size_t lines = two ? std::max(kHelpLeft.size(), kHelpRight.size()) : kHelpLeft.size() + kHelpRight.size();
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
  drawColumn(kHelpLeft, layout, values);
  if (two) ImGui::SameLine(layout.of(kColumn));
  drawColumn(kHelpRight, layout, values);
  notePanel(layout);
  ImGui::End();
}

}  // namespace lorica
