#pragma once

#include "viewer/window/panel_style.h"

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace lorica {

/// What cannot be done says why under the mouse. Call after its widget. @param why  empty = it can be done
void tellWhy(std::string_view why);

/// A check box. @param key  at the right edge @param why  it cannot be changed; empty = it can
void toggle(const char* name, const char* key, bool& value, std::string_view why = {});

/// A list as wide as the panel.
/// @param label    before the chosen name
/// @param none     what -1 is called; null = one is always chosen
/// @param request  gets what the user chooses
/// @param why      it cannot be changed; empty = it can
void chooseFrom(const char* id, const std::string& label, const char* none, std::span<const std::string> names,
                int chosen, std::optional<int>& request, std::string_view why = {});

}  // namespace lorica
