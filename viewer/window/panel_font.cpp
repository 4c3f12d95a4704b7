#include "viewer/window/panel_font.h"

#include "viewer/renderer/font.h"

#include <imgui.h>

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

namespace lorica {

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

}  // namespace lorica
