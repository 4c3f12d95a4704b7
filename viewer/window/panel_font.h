#pragma once

struct ImFontAtlas;

namespace lorica {

/// Fills an atlas with one font: ASCII in the stroke font of drawText(), which is smooth at any size and needs no font
/// file.
/// @param lineHeight  distance of baselines [pixels], at least 8
void fillPanelFont(ImFontAtlas& atlas, int lineHeight);

}  // namespace lorica
