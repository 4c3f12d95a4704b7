#pragma once

#include "viewer/window/panel_parts.h"

#include <imgui.h>

#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lorica {

/// A panel that stays where it is put.
inline constexpr ImGuiWindowFlags kFixed = ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                                           ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav |
                                           ImGuiWindowFlags_NoFocusOnAppearing;
inline const ImVec4 kFaint(0.62f, 0.66f, 0.72f, 1.0f);

template <typename Choices>
std::vector<std::string> namesOf(const Choices& choices) {
  std::vector<std::string> names;
  names.reserve(std::size(choices));
  for (const auto& choice : choices) names.emplace_back(choice.name);
  return names;
}

/// What cannot be done says why under the mouse. Call after its widget. @param why  empty = it can be done
void tellWhy(std::string_view why);

/// A check box. @param key  at the right edge @param right  the edge; 0 = that of the panel
/// @param why  it cannot be changed; empty = it can
void toggle(const char* name, const char* key, bool& value, std::string_view why = {}, float right = 0.0f);

/// A button as wide as the panel with its key at the right edge. @param why  it cannot be pressed; empty = it can
[[nodiscard]] bool keyedButton(const char* name, const char* key, std::string_view why = {});

/// The width of a slider with its value beside it, where the knob does not cover it. @param longest  text of a value
[[nodiscard]] float besideSlider(float room, const std::string& longest);

/// A text as far as it fits into a width [pixels]; a shortened one ends with dots.
[[nodiscard]] std::string fitted(const std::string& text, float width);

/// A list as wide as the panel.
/// @param label    before the chosen name
/// @param none     what -1 is called; null = one is always chosen
/// @param request  gets what the user chooses
/// @param why      it cannot be changed; empty = it can
void chooseFrom(const char* id, const std::string& label, const char* none, std::span<const std::string> names,
                int chosen, std::optional<int>& request, std::string_view why = {});

/// A list of what can be opened, by the names of the files; the folders of one are a tooltip.
/// @param label  before the present one @param other  instead of its name, if it is none of these: present = -1
void chooseFile(const std::string& label, const char* other, std::span<const std::string> files, int present,
                WindowRequests& requests);

}  // namespace lorica
