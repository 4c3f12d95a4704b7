#include "viewer/window/panel_widgets.h"

#include "geometry/counts.h"

#include <algorithm>
#include <cstddef>

namespace lorica {

void tellWhy(std::string_view why) {
  if (why.empty() || !ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  ImGui::SetTooltip("%.*s", countOf(why), why.data());
}

void toggle(const char* name, const char* key, bool& value, std::string_view why, float right) {
  ImGui::BeginDisabled(!why.empty());
  ImGui::Checkbox(name, &value);
  ImGui::EndDisabled();
  tellWhy(why);
  ImGui::SameLine((right > 0.0f ? right : ImGui::GetWindowContentRegionMax().x) - ImGui::CalcTextSize(key).x);
  ImGui::AlignTextToFramePadding();
  ImGui::TextColored(kFaint, "%s", key);
}

bool keyedButton(const char* name, const char* key, std::string_view why) {
  const float width = ImGui::GetContentRegionAvail().x;
  ImGui::BeginDisabled(!why.empty());
  const bool pressed = ImGui::Button(name, ImVec2(width, 0.0f));
  ImGui::EndDisabled();
  tellWhy(why);
  const ImVec2 corner = ImGui::GetItemRectMax(), text = ImGui::CalcTextSize(key);
  const float pad = ImGui::GetStyle().FramePadding.y;
  ImGui::GetWindowDrawList()->AddText(ImVec2(corner.x - text.x - 2.0f * pad, corner.y - text.y - pad),
                                      ImGui::ColorConvertFloat4ToU32(kFaint), key);
  return pressed;
}

float besideSlider(float room, const std::string& longest) {
  return std::max(room - ImGui::CalcTextSize(longest.c_str()).x - ImGui::GetStyle().ItemSpacing.x, 0.3f * room);
}

std::string fitted(const std::string& text, float width) {
  if (ImGui::CalcTextSize(text.c_str()).x <= width) return text;
  const auto shortened = [&](std::size_t length) {
    while (length > 0 && (text[length] & 0xc0) == 0x80) --length;  // not within a character
    return text.substr(0, length) + "...";
  };
  std::size_t length = text.size();
  while (length > 0 && ImGui::CalcTextSize(shortened(length).c_str()).x > width) --length;
  return shortened(length);
}

namespace {

/// The button of a list as wide as the panel. @return whether it is open
bool beginList(const std::string& shown, bool enabled) {
  const float width = ImGui::GetContentRegionAvail().x, pad = ImGui::GetStyle().FramePadding.x;
  const std::string now = fitted(shown, width - ImGui::GetFrameHeight() - 2.0f * pad);
  ImGui::SetNextItemWidth(width);
  if (enabled) return ImGui::BeginCombo("##list", now.c_str());
  ImGui::BeginDisabled();
  (void)ImGui::BeginCombo("##list", now.c_str());  // stays closed
  ImGui::EndDisabled();
  return false;
}

}  // namespace

void chooseFrom(const char* id, const std::string& label, const char* none, std::span<const std::string> names,
                int chosen, std::optional<int>& request, std::string_view why) {
  ImGui::PushID(id);
  const bool open = beginList(label + (chosen < 0 ? std::string(none) : names[chosen]), why.empty());
  tellWhy(why);
  if (open) {
    if (none != nullptr && ImGui::Selectable(none, chosen < 0)) request = -1;
    for (int n = 0; n < countOf(names); ++n) {
      ImGui::PushID(n);
      if (ImGui::Selectable(names[n].c_str(), n == chosen)) request = n;
      ImGui::PopID();
    }
    ImGui::EndCombo();
  }
  ImGui::PopID();
}

void chooseFile(const std::string& label, const char* other, std::span<const std::string> files, int present,
                WindowRequests& requests) {
  if (files.empty()) return;
  const auto name = [](const std::string& file) { return file.c_str() + (file.rfind('/') + 1); };
  ImGui::PushID(label.c_str());
  if (beginList(label + (present < 0 ? other : name(files[present])), true)) {
    for (int n = 0; n < countOf(files); ++n) {
      const std::string& file = files[n];
      ImGui::PushID(n);
      if (ImGui::Selectable(name(file), n == present)) requests.files = {file};
      ImGui::PopID();
      if (name(file) != file.c_str()) tellWhy(file);
    }
    ImGui::EndCombo();
  }
  ImGui::PopID();
}

}  // namespace lorica
