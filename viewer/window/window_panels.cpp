#include "viewer/window/window_panels.h"

#include "geometry/errors.h"
#include "viewer/renderer/font.h"
#include "viewer/window/panel_parts.h"

#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lorica {
namespace {

/// Fills an atlas with one font: ASCII and other characters, by the fonts of viewer/renderer/font.h; without these the
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

struct WindowPanels::Impl {
  ~Impl() {
    if (context == nullptr) return;
    ImGui::SetCurrentContext(context);
    if (ImGui::GetIO().BackendRendererUserData != nullptr) ImGui_ImplOpenGL3_Shutdown();
    ImGui::DestroyContext(context);
  }

  void takeInput(const PanelInput& input);
  void noteCharacters(const WindowValues& values);
  void takeScale(float scale);
  void noteFreeArea(const WindowValues& values);

  ImGuiContext* context = nullptr;
  float scale = 0.0f;      // of the current font and style
  std::u32string beyond;   // ASCII: characters that were shown
  bool fontLacks = false;  // some of them
  PanelLayout layout;
};

/// The font has the characters that were shown until now: names may have any.
void WindowPanels::Impl::noteCharacters(const WindowValues& values) {
  values.eachText([&](std::string_view text) {
    if (std::all_of(text.begin(), text.end(), [](char c) { return (c & 0x80) == 0; })) return;
    for (const char32_t c : charactersOf(text)) {
      if (c < 0x80 || beyond.find(c) != std::u32string::npos) continue;
      beyond += c;
      fontLacks = true;
    }
  });
}

void WindowPanels::Impl::takeScale(float wanted) {
  // Font sizes are whole pixels, so tiny changes have no effect.
  const float rounded = std::clamp(std::round(wanted * 4.0f) / 4.0f, 0.5f, 8.0f);
  if (rounded == scale && !std::exchange(fontLacks, false)) return;
  scale = rounded;
  layout.unit = scale;
  fillPanelFont(*ImGui::GetIO().Fonts, std::lround(kPanelLine * scale), beyond);
  ImGui_ImplOpenGL3_DestroyDeviceObjects();  // the next frame makes them, with the new font
  setPanelStyle(scale);
}

void WindowPanels::Impl::takeInput(const PanelInput& input) {
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = ImVec2(input.width, input.height);
  io.DeltaTime = std::clamp(input.seconds, 1e-4f, 0.25f);
  io.MousePos = ImVec2(input.x, input.y);
  io.MouseDown[0] = input.down[0];
  io.MouseDown[1] = input.down[1];
  io.MouseWheel = input.wheel;
}

void WindowPanels::Impl::noteFreeArea(const WindowValues& values) {
  std::vector<PixelArea>& taken = layout.panels;
  const float insetWidth = values.insetWidth, insetHeight = values.insetHeight;
  const bool inset = insetWidth > 0.0f;
  if (inset) taken.push_back({layout.width - insetWidth, layout.height - insetHeight, layout.width, layout.height});
  layout.free = lorica::freeArea(layout.width, layout.height, taken);
  if (inset) taken.pop_back();  // it takes no input
}

WindowPanels::WindowPanels(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
WindowPanels::~WindowPanels() = default;
WindowPanels::WindowPanels(WindowPanels&&) noexcept = default;
WindowPanels& WindowPanels::operator=(WindowPanels&&) noexcept = default;

Result<WindowPanels> WindowPanels::create() {
  auto impl = std::make_unique<Impl>();
  impl->context = ImGui::CreateContext();
  ImGui::SetCurrentContext(impl->context);
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;  // do not write a settings file
  io.LogFilename = nullptr;
  io.ConfigWindowsMoveFromTitleBarOnly = true;
  io.BackendPlatformName = "lorica";  // keys and mouse are Window's, which divides them between panels and scene
  if (!ImGui_ImplOpenGL3_Init("#version 330 core")) {
    return noDisplay("the panels of the window cannot be drawn: OpenGL 3.3 is needed");
  }
  return WindowPanels(std::move(impl));
}

void WindowPanels::draw(const PanelInput& input, const WindowValues& values, const TimeGraph& times,
                        WindowChoices& choices, WindowRequests& requests) {
  Impl& i = *impl_;
  ImGui::SetCurrentContext(i.context);
  i.noteCharacters(values);
  i.takeScale(input.scale);
  i.takeInput(input);
  ImGui_ImplOpenGL3_NewFrame();
  ImGui::NewFrame();
  i.layout.begin(input.width, input.height);
  if (choices.panels && !values.empty()) {
    drawTransport(i.layout, values, choices, requests);
    drawWhoPanel(i.layout, values, choices, requests);
    drawLookPanel(i.layout, values, choices, requests);
    drawNumbersPanel(i.layout, values, times);
  }
  i.noteFreeArea(values);
  if (!values.loading.empty()) drawLoading(i.layout, values, requests);  // stays where it is: its button is clicked
  drawMessages(i.layout, values, choices.panels);
  if (choices.help) drawHelp(i.layout, values);
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

bool WindowPanels::covers(float x, float y) const {
  return std::any_of(impl_->layout.panels.begin(), impl_->layout.panels.end(),
                     [&](const PixelArea& a) { return x >= a.left && x < a.right && y >= a.top && y < a.bottom; });
}

const PictureArea& WindowPanels::freeArea() const {
  return impl_->layout.free;
}

bool WindowPanels::busy() const {
  ImGui::SetCurrentContext(impl_->context);
  return ImGui::IsAnyItemActive() || ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup);
}

bool WindowPanels::closeList() {
  ImGui::SetCurrentContext(impl_->context);
  if (!ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup)) return false;
  ImGui::ClosePopupToLevel(0, false);
  return true;
}

}  // namespace lorica
