#pragma once

struct ImFontAtlas;

namespace lorica {

/// Fills an atlas with one font: ASCII in the strokes that pictures are labelled with, see drawText(), so that it is
/// smooth at any size and needs no font file.
/// @param lineHeight  distance of two base lines [pixels], at least 8
void fillPanelFont(ImFontAtlas& atlas, int lineHeight);

}  // namespace lorica
