#pragma once

#include <cstdint>

namespace lorica {

/// Colours of the panels, 0xrrggbbaa: those of the page (viewer/page/web/page.css has them by the same names).
struct PanelColors {
  std::uint32_t text, faint, panel, raised, line, strong, onStrong, warn, warnText, bad, badText;
};
inline constexpr PanelColors kLightPanels{0x1d2430ff, 0x5b6676ff, 0xffffffd9, 0xeef1f5ff, 0xd4dae2ff, 0x1264c4ff,
                                          0xffffffff, 0xfff3d6ff, 0x6b4500ff, 0xffe1deff, 0x8a1408ff};
inline constexpr PanelColors kDarkPanels{0xe7ebf1ff, 0x9aa6b6ff, 0x161b23e0, 0x262e3aff, 0x333d4bff, 0x6db1ffff,
                                         0x08131fff, 0x3d3113ff, 0xffdf9aff, 0x471f1bff, 0xffb9b0ff};

}  // namespace lorica
