#pragma once

#include "viewer/window/panel_parts.h"

#include <imgui.h>

namespace lorica {

/// A panel that stays where it is put.
inline constexpr ImGuiWindowFlags kFixed = ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                                           ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav |
                                           ImGuiWindowFlags_NoFocusOnAppearing;
inline const ImVec4 kFaint(0.62f, 0.66f, 0.72f, 1.0f);

}  // namespace lorica
