#pragma once

#include <string>

struct ImFontAtlas;

namespace lorica {

/// Fills an atlas with one font: ASCII and other characters, by the fonts of viewer/renderer/font.h; without these the
/// font of Dear ImGui, which has ASCII.
/// @param lineHeight  distance of baselines [pixels], at least 8
/// @param others      beyond ASCII
void fillPanelFont(ImFontAtlas& atlas, int lineHeight, const std::u32string& others);

}  // namespace lorica
