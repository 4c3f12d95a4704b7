#include "geometry/errors.h"
#include "viewer/renderer/text.h"
#include "viewer/window/panel_parts.h"

#include <backends/imgui_impl_opengl3.h>
#include <imgui_internal.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lorica {
namespace {

/// Fills an atlas with one font: ASCII and other characters, by the fonts of viewer/renderer/text.h; without these the
/// font of Dear ImGui, which has ASCII.
/// @param lineHeight  distance of baselines [pixels], at least 8
/// @param others      beyond ASCII
void fillPanelFont(ImFontAtlas& atlas, int lineHeight, const std::u32string& others) {
  atlas.Clear();
  ImFontConfig config;
  config.SizePixels = lineHeight;
  config.FontDataOwnedByAtlas = false;
  config.OversampleH = 2;
  // Each file once, with the characters that are drawn with it.
  std::vector<std::pair<std::string_view, ImVector<ImWchar>>> files;
  const auto add = [&files](char32_t first, char32_t last) {
    const std::string_view file = fontFileFor(first);
    auto found = std::find_if(files.begin(), files.end(), [&](const auto& f) { return f.first.data() == file.data(); });
    if (found == files.end()) found = files.insert(found, {file, {}});
    for (const char32_t end : {first, last}) found->second.push_back(end);
  };
  add(U' ', U'~');
  for (const char32_t c : others) {
    if (c <= IM_UNICODE_CODEPOINT_MAX) add(c, c);
  }
  if (files.front().first.empty()) {
    atlas.AddFontDefault(&config);
    atlas.Build();
    return;
  }
  for (auto& [file, ranges] : files) {
    ranges.push_back(0);
    atlas.AddFontFromMemoryTTF(const_cast<char*>(file.data()), file.size(), config.SizePixels, &config, ranges.Data);
    config.MergeMode = true;
  }
  atlas.Build();  // while the ranges are there
}

}  // namespace

void WindowPanels::End::operator()(ImGuiContext* context) const {
  ImGui::SetCurrentContext(context);
  if (ImGui::GetIO().BackendRendererUserData != nullptr) ImGui_ImplOpenGL3_Shutdown();
  ImGui::DestroyContext(context);
}

/// The font has the characters that were shown until now: names may have any.
void WindowPanels::noteCharacters(const WindowValues& values) {
  values.eachText([&](std::string_view text) {
    if (std::all_of(text.begin(), text.end(), [](char c) { return (c & 0x80) == 0; })) return;
    for (const char32_t c : charactersOf(text)) {
      if (c < 0x80 || beyond_.find(c) != std::u32string::npos) continue;
      beyond_ += c;
      fontLacks_ = true;
    }
  });
}

void WindowPanels::takeStyle(float wantedScale, const SceneOptions& show) {
  const bool dark = show.background ? show.background->maxCoeff() < 0.5f : show.dark;
  const PanelColors* colors = dark ? &kDarkPanels : &kLightPanels;
  // Font sizes are whole pixels, so tiny changes have no effect.
  const float rounded = std::clamp(std::round(wantedScale * 4.0f) / 4.0f, 0.5f, 8.0f);
  const bool newFont = rounded != scale_ || std::exchange(fontLacks_, false);
  if (!newFont && colors == layout_.colors) return;
  layout_.colors = colors;
  layout_.unit = scale_ = rounded;
  setPanelStyle(*colors, scale_);
  if (!newFont) return;
  fillPanelFont(*ImGui::GetIO().Fonts, std::lround(kPanelLine * scale_), beyond_);
  ImGui_ImplOpenGL3_DestroyDeviceObjects();  // the next frame makes them, with the new font
}

void WindowPanels::takeInput(const PanelInput& input) {
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = ImVec2(input.width, input.height);
  io.DeltaTime = std::clamp(input.seconds, 1e-4f, 0.25f);
  io.MousePos = ImVec2(input.x, input.y);
  io.MouseDown[0] = input.down[0];
  io.MouseDown[1] = input.down[1];
  io.MouseWheel = input.wheel;
}

void WindowPanels::noteFreeArea(const WindowValues& values) {
  std::vector<PixelArea>& taken = layout_.panels;
  const float insetWidth = values.insetWidth, insetHeight = values.insetHeight;
  const bool inset = insetWidth > 0.0f;
  if (inset) taken.push_back({layout_.width - insetWidth, layout_.height - insetHeight, layout_.width, layout_.height});
  layout_.free = lorica::freeArea(layout_.width, layout_.height, taken);
  if (inset) taken.pop_back();  // it takes no input
}

Result<WindowPanels> WindowPanels::create() {
  WindowPanels made;
  made.context_.reset(ImGui::CreateContext());
  ImGui::SetCurrentContext(made.context_.get());
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;  // do not write a settings file
  io.LogFilename = nullptr;
  io.ConfigWindowsMoveFromTitleBarOnly = true;
  io.BackendPlatformName = "lorica";  // keys and mouse are Window's, which divides them between panels and scene
  if (!ImGui_ImplOpenGL3_Init("#version 330 core")) {
    return noDisplay("the panels of the window cannot be drawn: OpenGL 3.3 is needed");
  }
  return made;
}

void WindowPanels::draw(const PanelInput& input, const WindowValues& values, const TimeGraph& times,
                        const Controls& controls, Asked& asked) {
  ImGui::SetCurrentContext(context_.get());
  noteCharacters(values);
  takeStyle(input.scale, asked.choices.show);
  takeInput(input);
  ImGui_ImplOpenGL3_NewFrame();
  ImGui::NewFrame();
  layout_.begin(input.width, input.height);
  if (asked.choices.panels && !values.empty()) {
    drawTransport(layout_, values, controls, asked);
    if (!asked.choices.help || layout_.small()) {  // help takes the whole width
      drawWhoPanel(layout_, values, controls, asked);
      drawLookPanel(layout_, controls, asked);
      drawNumbersPanel(layout_, values, times);
    }
  }
  noteFreeArea(values);
  if (!values.loading.empty()) drawLoading(layout_, values, asked);  // stays where it is: its button is clicked
  drawMessages(layout_, values, asked.choices.panels);
  if (asked.choices.help) drawHelp(layout_, controls);
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

bool WindowPanels::covers(float x, float y) const {
  return std::any_of(layout_.panels.begin(), layout_.panels.end(),
                     [&](const PixelArea& a) { return x >= a.left && x < a.right && y >= a.top && y < a.bottom; });
}

bool WindowPanels::busy() const {
  ImGui::SetCurrentContext(context_.get());
  return ImGui::IsAnyItemActive() || ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup);
}

bool WindowPanels::closeList() {
  ImGui::SetCurrentContext(context_.get());
  if (!ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup)) return false;
  ImGui::ClosePopupToLevel(0, false);
  return true;
}

}  // namespace lorica
