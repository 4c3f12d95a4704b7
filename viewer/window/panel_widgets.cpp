#include "viewer/window/panel_widgets.h"

#include "geometry/counts.h"

namespace lorica {

void tellWhy(std::string_view why) {
  if (why.empty() || !ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  ImGui::SetTooltip("%.*s", countOf(why), why.data());
}

void toggle(const char* name, const char* key, bool& value, std::string_view why) {
  ImGui::BeginDisabled(!why.empty());
  ImGui::Checkbox(name, &value);
  ImGui::EndDisabled();
  tellWhy(why);
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - ImGui::CalcTextSize(key).x);
  ImGui::AlignTextToFramePadding();
  ImGui::TextColored(kFaint, "%s", key);
}

void chooseFrom(const char* id, const std::string& label, const char* none, std::span<const std::string> names,
                int chosen, std::optional<int>& request, std::string_view why) {
  const float width = ImGui::GetContentRegionAvail().x;
  const std::string now = label + (chosen < 0 ? std::string(none) : names[chosen]);
  if (!why.empty()) {
    ImGui::BeginDisabled();
    ImGui::Button(now.c_str(), ImVec2(width, 0.0f));
    ImGui::EndDisabled();
    tellWhy(why);
    return;
  }
  ImGui::SetNextItemWidth(width);
  ImGui::PushID(id);
  if (ImGui::BeginCombo("##list", now.c_str())) {
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

}  // namespace lorica
