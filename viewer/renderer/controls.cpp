#include "viewer/renderer/controls.h"

#include "geometry/counts.h"

#include <algorithm>
#include <cmath>

namespace lorica {
namespace {

/// @return its index; -1 = another one was given
int backgroundOf(const SceneOptions& show) {
  const auto same = [&](const BackgroundChoice& one) {
    return one.transparent == show.transparent &&
           (one.transparent || (one.color == show.background && (one.color || one.dark == show.dark)));
  };
  const auto* const found = std::find_if(kBackgrounds.begin(), kBackgrounds.end(), same);
  return found == kBackgrounds.end() ? -1 : static_cast<int>(found - kBackgrounds.begin());
}

void describe(const Choices& kept, Control& control) {
  Choices& choices = const_cast<Choices&>(kept);  // the rows' accessors serve reading and writing
  if (control.flag != nullptr) control.value = control.flag(choices) ? 1.0 : 0.0;
  if (control.index != nullptr) control.value = control.index(choices);
  if (control.names != nullptr) control.choices = control.names();
  if (control.id == ControlId::kBackground) {
    control.value = backgroundOf(choices.show);
    control.choices = choiceNames<kBackgrounds>();
    control.none = "as given";
  }
}

/// Whether a screen does it alone.
bool isChoice(const Control& control) {
  return control.flag != nullptr || control.index != nullptr || control.id == ControlId::kStep ||
         control.isOn(on_screen::kOwn);
}

}  // namespace

std::string_view Control::back() const {
  const std::string_view all = keys;
  const std::size_t space = all.find(' ');
  return space == std::string_view::npos ? std::string_view() : all.substr(0, space);
}

std::string_view Control::key() const {
  const std::string_view all = keys;
  return all.substr(all.find(' ') + 1);
}

const Control* controlNamed(std::string_view name) {
  const auto* const found = std::find_if(control_rows::kRows.begin(), control_rows::kRows.end(),
                                         [&](const Control& control) { return control.name == name; });
  return found == control_rows::kRows.end() ? nullptr : found;
}

void listChoices(const Choices& choices, Controls& controls) {
  std::copy(control_rows::kRows.begin(), control_rows::kRows.end(), controls.begin());
  for (Control& control : controls) {
    describe(choices, control);
    control.absent = !isChoice(control) && control.kind != ControlKind::kOther;
  }
}

std::optional<double> valueAfter(const Control& control, const Change& change) {
  switch (control.kind) {
    case ControlKind::kToggle:
      return std::abs(std::fmod(change.to.value_or(control.value + change.by), 2.0)) == 1.0 ? 1.0 : 0.0;
    case ControlKind::kNumber: {
      if (!change.to) return std::clamp(control.value + change.by, control.least, control.most);
      if (!(*change.to >= control.least && *change.to <= control.most)) return std::nullopt;
      return change.to;
    }
    case ControlKind::kList:
    case ControlKind::kFiles: {
      const double count = countOf(control.choices);
      if (change.to) {
        if (std::trunc(*change.to) != *change.to || *change.to < control.least || *change.to >= count)
          return std::nullopt;
        return change.to;
      }
      if (count == 0.0) return std::nullopt;
      const double next = std::max(control.value, -1.0) + std::trunc(change.by);
      if (!control.back().empty()) return std::clamp(next, control.least, count - 1.0);
      const double size = count - control.least;
      return control.least + std::fmod(std::fmod(next - control.least, size) + size, size);
    }
    case ControlKind::kButton:
    case ControlKind::kOther:
      break;
  }
  return change.to.value_or(change.by);
}

bool choose(const Change& change, Choices& choices) {
  Control control = control_rows::kRows[static_cast<std::size_t>(change.id)];
  if (!isChoice(control)) return false;
  describe(choices, control);
  const std::optional<double> value = valueAfter(control, change);
  if (!value) return true;
  if (control.flag != nullptr) control.flag(choices) = *value != 0.0;
  if (control.index != nullptr) control.index(choices) = static_cast<int>(*value);
  if (control.id == ControlId::kStep) {
    choices.paused = true;
    choices.steps += std::max(1, static_cast<int>(*value));
  }
  if (control.id == ControlId::kBackground) {
    const BackgroundChoice& chosen = kBackgrounds[static_cast<std::size_t>(*value)];
    choices.show.background = chosen.color;
    choices.show.transparent = chosen.transparent;
    choices.show.dark = chosen.dark;
    choices.show.ground = !chosen.color && !chosen.transparent;  // a background for keying has none
  }
  return true;
}

void addTo(std::vector<Change>& changes, Change change) {
  const bool ordered =
      change.id == ControlId::kPress || change.id == ControlId::kRelease || change.id == ControlId::kThrow;
  const auto same = [&](const Change& other) { return other.id == change.id && other.client == change.client; };
  const auto before = ordered ? changes.end() : std::find_if(changes.begin(), changes.end(), same);
  if (before == changes.end()) return changes.push_back(std::move(change));
  if (!change.to && before->to) change.to = *before->to + change.by;
  if (!change.to) change.by += before->by;
  change.files.insert(change.files.begin(), before->files.begin(), before->files.end());
  *before = std::move(change);
}

bool takeCancelFrom(std::vector<Change>& changes) {
  const bool cancel =
      std::any_of(changes.begin(), changes.end(), [](const Change& c) { return c.id == ControlId::kCancel; });
  std::erase_if(changes, [](const Change& c) { return c.files.empty() && c.id != ControlId::kRelease; });
  return cancel;
}

}  // namespace lorica
