#include "viewer/panel_parts.h"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lorica {
namespace {

constexpr ImGuiWindowFlags kFixed = ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                                    ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav |
                                    ImGuiWindowFlags_NoFocusOnAppearing;
const ImVec4 kFaint(0.62f, 0.66f, 0.72f, 1.0f);
constexpr float kViewPanel = 206.0f;
constexpr ImU32 kPlate = IM_COL32(22, 26, 33, 224);
constexpr ImU32 kInk = IM_COL32(236, 240, 245, 255);
constexpr ImU32 kAmber = IM_COL32(255, 190, 84, 255);
constexpr ImU32 kRed = IM_COL32(235, 78, 70, 255);

struct HelpLine {
  const char* keys;
  const char* what;
};
constexpr std::array kHelp = {HelpLine{"left drag", "rotate the camera, or move a prop"},
                              HelpLine{"right drag", "pan the camera"},
                              HelpLine{"wheel", "zoom"},
                              HelpLine{"R", "reset the camera"},
                              HelpLine{"space", "pause, resume"},
                              HelpLine{"N", "step one frame"},
                              HelpLine{"left, right", "1 s back, forward"},
                              HelpLine{"home", "restart"},
                              HelpLine{"- +", "slower, faster"},
                              HelpLine{"1 2 3 4", "character, hulls, bones, props"},
                              HelpLine{"5 6 7", "contacts, ground, grains"},
                              HelpLine{"C", "colour by part"},
                              HelpLine{"[ ]", "fewer, more parts"},
                              HelpLine{"E", "next expression"},
                              HelpLine{"B", "throw a ball"},
                              HelpLine{"P", "save a picture; with shift, panels too"},
                              HelpLine{"V", "start, stop a video"},
                              HelpLine{"tab", "show, hide panels"},
                              HelpLine{"H", "hide this help"},
                              HelpLine{"esc", "close"}};

/// A check box with its key at the right edge.
void toggle(const char* name, const char* key, bool& value) {
  ImGui::Checkbox(name, &value);
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - ImGui::CalcTextSize(key).x);
  ImGui::AlignTextToFramePadding();
  ImGui::TextColored(kFaint, "%s", key);
}

/// A button as wide as the panel with its key at the right edge.
bool keyedButton(const char* name, const char* key) {
  const float width = ImGui::GetContentRegionAvail().x;
  const bool pressed = ImGui::Button(name, ImVec2(width, 0.0f));
  const ImVec2 corner = ImGui::GetItemRectMax(), text = ImGui::CalcTextSize(key);
  const float pad = ImGui::GetStyle().FramePadding.y;
  ImGui::GetWindowDrawList()->AddText(ImVec2(corner.x - text.x - 2.0f * pad, corner.y - text.y - pad),
                                      ImGui::ColorConvertFloat4ToU32(kFaint), key);
  return pressed;
}

/// A message on its own plate, centred horizontally and not over open panels. The next one is placed below.
void drawPlate(PanelLayout& layout, std::string_view text, ImU32 ink, ImU32 mark) {
  const float top = layout.ceiling;
  ImDrawList& list = *ImGui::GetForegroundDrawList();
  const char* begin = text.data();
  const char* end = begin + text.size();
  const float pad = layout.of(8.0f), bar = layout.of(4.0f);
  const float panel = layout.small() || layout.panels.empty() ? 0.0f : layout.of(kWidestPanel) + layout.margin();
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

void notePanel(PanelLayout& layout) {
  const ImVec2 position = ImGui::GetWindowPos(), size = ImGui::GetWindowSize();
  layout.panels.push_back({position.x, position.y, position.x + size.x, position.y + size.y});
}

void foldAsSizeSays(const PanelLayout& layout, PanelLayout::Fold& fold) {
  if (fold.small == layout.small()) return;
  fold.small = layout.small();
  ImGui::SetNextWindowCollapsed(layout.small() || !fold.openIfLarge);
}

void noteFold(PanelLayout::Fold& fold) {
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

void drawTransport(PanelLayout& layout, const WindowValues& values, const PanelStatus& status, ControlState& state,
                   WindowRequests& requests) {
  const float margin = layout.margin();
  const float inset = status.insetWidth > 0.0 ? static_cast<float>(status.insetWidth) + 2.0f * margin : 0.0f;
  const float width = layout.width - 2.0f * margin - inset;
  const bool narrow = width < layout.of(540.0f);
  ImGui::SetNextWindowPos(ImVec2(margin, layout.height - margin), ImGuiCond_Always, ImVec2(0.0f, 1.0f));
  ImGui::SetNextWindowSize(ImVec2(width, 0.0f));
  ImGui::Begin("transport", nullptr, kFixed | ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoScrollbar);
  const ImVec2 button(layout.of(64.0f), 0.0f);
  if (ImGui::Button(state.paused ? "Play###play" : "Pause###play", button)) state.paused = !state.paused;
  ImGui::SameLine();
  if (ImGui::Button("Step", ImVec2(layout.of(52.0f), 0.0f))) {
    state.paused = true;
    ++state.steps;
  }
  if (values.duration > 0.0) {
    ImGui::SameLine();
    if (!narrow) {
      if (ImGui::Button("Start", ImVec2(layout.of(56.0f), 0.0f))) requests.seekTo = 0.0;
      ImGui::SameLine();
    }
    const float speedWidth = narrow ? 0.0f : layout.of(200.0f);
    ImGui::SetNextItemWidth(std::max(ImGui::GetContentRegionAvail().x - speedWidth, layout.of(60.0f)));
    auto seconds = static_cast<float>(values.seconds);
    const auto duration = static_cast<float>(values.duration);
    const std::string format = fmt::format("%.1f of {:.1f} s", values.duration);
    if (ImGui::SliderFloat("##time", &seconds, 0.0f, duration, narrow ? "%.1f s" : format.c_str(),
                           ImGuiSliderFlags_NoInput | ImGuiSliderFlags_NoRoundToFormat)) {
      requests.seekTo = seconds;
    }
    state.scrubbing = ImGui::IsItemActive();
    if (!narrow) {
      ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - speedWidth + ImGui::GetStyle().ItemSpacing.x);
      ImGui::AlignTextToFramePadding();
      ImGui::TextColored(kFaint, "speed %.2g", state.speed);
      ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - layout.of(110.0f));
      ImGui::SetNextItemWidth(layout.of(110.0f));
      auto speed = static_cast<float>(state.speed);
      if (ImGui::SliderFloat("##speed", &speed, static_cast<float>(kSlowest), static_cast<float>(kFastest), "",
                             ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_NoInput)) {
        // Snap to full speed.
        state.speed = std::abs(speed - 1.0f) < 0.08f ? 1.0 : std::clamp<double>(speed, kSlowest, kFastest);
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
  ImGui::End();
}

void drawViewPanel(PanelLayout& layout, const WindowValues& values, const PanelStatus& status, ControlState& state,
                   WindowRequests& requests) {
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
    SceneOptions& show = state.show;
    toggle("character", "1", show.skin);
    toggle("hulls", "2", show.hulls);
    toggle("bones", "3", show.bones);
    toggle("props", "4", show.props);
    toggle("contacts", "5", show.contacts);
    toggle("ground", "6", show.ground);
    toggle("grains", "7", show.particles);
    toggle("colour by part", "C", show.colorSkinByPart);
    ImGui::Separator();
    const float slider = ImGui::GetContentRegionAvail().x;
    if (values.maxParts > 0) {
      int parts = values.parts;
      ImGui::SetNextItemWidth(slider);
      const char* format = values.preparingParts ? "%d parts ..." : parts == 1 ? "%d part" : "%d parts";
      if (ImGui::SliderInt("##parts", &parts, 1, values.maxParts, format,
                           ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_NoInput)) {
        requests.parts = parts;
      }
    }
    if (!values.scenes.empty()) {
      ImGui::SetNextItemWidth(slider);
      const std::string& now = values.scenes[values.scene];
      if (ImGui::BeginCombo("##scene", now.c_str())) {
        for (int s = 0; s < static_cast<int>(values.scenes.size()); ++s) {
          if (ImGui::Selectable(values.scenes[s].c_str(), s == values.scene)) {
            requests.scene = s;
          }
        }
        ImGui::EndCombo();
      }
    }
    if (!values.expressions.empty()) {
      ImGui::SetNextItemWidth(slider);
      const auto chosen = static_cast<std::size_t>(values.expression);
      const char* now = values.expression < 0 ? "expression: none" : values.expressions[chosen].c_str();
      if (ImGui::BeginCombo("##expression", now)) {
        if (ImGui::Selectable("none", values.expression < 0)) requests.expression = -1;
        for (int e = 0; e < static_cast<int>(values.expressions.size()); ++e) {
          if (ImGui::Selectable(values.expressions[e].c_str(), e == values.expression)) requests.expression = e;
        }
        ImGui::EndCombo();
      }
    }
    if (!status.qualities.empty()) {
      ImGui::SetNextItemWidth(slider);
      const char* now = status.qualities[status.quality];
      const std::string chosen =
          state.quality < 0 ? fmt::format("quality: {} (auto)", now) : fmt::format("quality: {}", now);
      if (ImGui::BeginCombo("##quality", chosen.c_str())) {
        if (ImGui::Selectable("automatic", state.quality < 0)) state.quality = -1;
        for (int q = static_cast<int>(status.qualities.size()) - 1; q >= 0; --q) {
          if (ImGui::Selectable(status.qualities[q], state.quality == q)) state.quality = q;
        }
        ImGui::EndCombo();
      }
    }
    if (keyedButton("throw a ball", "B")) requests.throwBall = true;
    if (keyedButton("save a picture", "P")) state.picture = true;
    if (keyedButton(status.videoSeconds < 0.0 ? "start a video###video" : "stop the video###video", "V")) {
      state.video = true;
    }
  }
  notePanel(layout);
  ImGui::End();
}

void drawWarnings(PanelLayout& layout, const WindowValues& values, const PanelStatus& status) {
  // Between the panels, or below their titles if there is no space between them.
  if (layout.small() && !layout.panels.empty()) layout.ceiling += layout.of(kPanelLine + 12.0f);
  for (const std::string& warning : values.warnings) drawPlate(layout, warning, kAmber, kAmber);
  if (status.videoSeconds >= 0.0) {
    drawPlate(layout, fmt::format("video {:.1f} s, V to stop", status.videoSeconds), kInk, kRed);
  }
  if (!status.notice.empty()) drawPlate(layout, status.notice, kInk, 0);
}

void drawHelp(PanelLayout& layout) {
  // Below the warnings and above the transport. If that is too small, it covers the transport and scrolls if needed.
  constexpr float kTitleAndPads = 46.0f;
  const float line = ImGui::GetTextLineHeightWithSpacing();
  const float wanted = line * static_cast<float>(kHelp.size()) + layout.of(kTitleAndPads);
  const float top = layout.ceiling;
  const float above = layout.panels.empty() ? layout.height - layout.margin() : layout.floor - layout.of(4.0f);
  const float bottom = wanted <= above - top ? above : layout.height - layout.margin();
  const float room = std::max(bottom - top, layout.of(40.0f));
  ImGui::SetNextWindowPos(ImVec2(0.5f * layout.width, 0.5f * (top + bottom)), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
  ImGui::SetNextWindowSizeConstraints(ImVec2(0.0f, 0.0f), ImVec2(layout.width - 2.0f * layout.margin(), room));
  ImGui::SetNextWindowBgAlpha(0.92f);
  ImGui::SetNextWindowFocus();
  ImGui::Begin("Keys and mouse", nullptr, kFixed | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse);
  for (const HelpLine& help : kHelp) {
    ImGui::TextUnformatted(help.keys);
    ImGui::SameLine(layout.of(120.0f));
    ImGui::PushStyleColor(ImGuiCol_Text, kFaint);
    ImGui::TextUnformatted(help.what);
    ImGui::PopStyleColor();
  }
  notePanel(layout);
  ImGui::End();
}

}  // namespace lorica
