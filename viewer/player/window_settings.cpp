#include "viewer/player/window_settings.h"

#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/json.h"
#include "geometry/user_folders.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <optional>

namespace lorica {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kFormat = "lorica window 1";
constexpr std::uint64_t kMaxBytes = std::uint64_t{1} << 20;

/// A layer of the picture.
struct Layer {
  const char* name;
  bool SceneOptions::*shown;
};
constexpr std::array kLayers = {
    Layer{"character", &SceneOptions::skin},    Layer{"hulls", &SceneOptions::hulls},
    Layer{"bones", &SceneOptions::bones},       Layer{"props", &SceneOptions::props},
    Layer{"contacts", &SceneOptions::contacts}, Layer{"ground", &SceneOptions::ground},
    Layer{"grains", &SceneOptions::particles},  Layer{"colourByPart", &SceneOptions::colorSkinByPart},
    Layer{"dark", &SceneOptions::dark}};

/// @return what was expected; none if a switch was read or is not there
std::optional<std::string> readSwitch(const json& settings, const char* name, bool& value) {
  const auto found = settings.find(name);
  if (found == settings.end()) return std::nullopt;
  if (!found->is_boolean()) return fmt::format("{}: true or false", name);
  value = found->get<bool>();
  return std::nullopt;
}

std::optional<std::string> readScale(const json& settings, double& value) {
  const auto found = settings.find("scale");
  if (found == settings.end()) return std::nullopt;
  if (!found->is_number() || !(found->get<double>() >= kSmallestScale && found->get<double>() <= kLargestScale)) {
    return fmt::format("scale: a number from {} to {}", kSmallestScale, kLargestScale);
  }
  value = found->get<double>();
  return std::nullopt;
}

/// @param list  of choices with names @param index  of the chosen one
template <typename Choices>
std::optional<std::string> readChoice(const json& settings, const char* name, const Choices& list, int& index) {
  const auto found = settings.find(name);
  if (found == settings.end()) return std::nullopt;
  const auto* const named =
      std::find_if(list.begin(), list.end(), [&](const auto& choice) { return *found == choice.name; });
  if (named == list.end()) {
    std::string names;
    for (const auto& choice : list) names += fmt::format("{}{}", names.empty() ? "" : ", ", choice.name);
    return fmt::format("{}: one of {}", name, names);
  }
  index = named - list.begin();
  return std::nullopt;
}

std::optional<std::string> readShown(const json& settings, std::map<std::string, bool>& shown) {
  const auto found = settings.find("shown");
  if (found == settings.end()) return std::nullopt;
  if (!found->is_object()) return "shown: an object of layers";
  for (const Layer& layer : kLayers) {
    const auto value = found->find(layer.name);
    if (value == found->end()) continue;
    if (!value->is_boolean()) return fmt::format("shown: {}: true or false", layer.name);
    shown[layer.name] = value->get<bool>();
  }
  return std::nullopt;
}

std::optional<std::string> readRecent(const json& settings, std::vector<std::string>& files) {
  const auto found = settings.find("recent");
  if (found == settings.end()) return std::nullopt;
  const auto isText = [](const json& file) { return file.is_string(); };
  if (!found->is_array() || !std::all_of(found->begin(), found->end(), isText)) return "recent: a list of files";
  for (const json& file : *found) {
    if (files.size() < kMaxRecent) files.push_back(file.get<std::string>());
  }
  return std::nullopt;
}

}  // namespace

TreatmentControl treatmentControl(const MotionOptions& options, bool tracked) {
  TreatmentControl control;
  control.first.mirror = options.mirror;
  if (options.mirror) control.noMirror = "--mirror was given";
  if (options.smoothGiven) {
    control.first.smoothing = options.smooth == MotionOptions::Smoothing::kOff ? 0 : kSmoothingAsGiven;
    control.noSmoothing = "--smooth was given";
  }
  if (!tracked) control.noSmoothing = "only tracked joints are smoothed";
  return control;
}

Treatment allowed(const TreatmentControl& control, Treatment chosen) {
  if (!control.noMirror.empty()) chosen.mirror = control.first.mirror;
  if (!control.noSmoothing.empty()) chosen.smoothing = control.first.smoothing;
  if (!control.noGravity.empty()) chosen.gravity = control.first.gravity;
  return chosen;
}

MotionOptions treated(MotionOptions options, const Treatment& treatment) {
  options.mirror = treatment.mirror;
  if (treatment.smoothing == kSmoothingAsGiven) return options;
  const double cutoff = kSmoothings[treatment.smoothing].factor;
  options.smooth = cutoff > 0.0 ? MotionOptions::Smoothing::kOneEuro : MotionOptions::Smoothing::kOff;
  options.oneEuro = OneEuroSettings();
  options.oneEuro.minCutoff = cutoff;
  return options;
}

fs::path windowSettingsFile() {
  const fs::path folder = userFolder("XDG_CONFIG_HOME", ".config");
  return folder.empty() ? folder : folder / "window.json";
}

Result<WindowSettings> readWindowSettings(const fs::path& file) {
  std::error_code ignored;
  if (file.empty() || !fs::exists(file, ignored)) return WindowSettings();
  LORICA_TRY(const std::string text, readFile(file, NamedBy::kUser, kMaxBytes));
  const auto wrong = [&](const std::string& expected) {
    return badFormat("{}: the window's settings are damaged, expected {}; the usual ones are used", file.string(),
                     expected);
  };
  const Result<json> parsed = parseJson(text, "");
  const json settings = parsed ? *parsed : json();
  if (!settings.is_object() || settings.value("format", json()) != kFormat) {
    return wrong(fmt::format("\"format\": \"{}\"", kFormat));
  }
  WindowSettings read;
  Treatment& treatment = read.choices.treatment;
  for (const std::optional<std::string>& expected :
       {readSwitch(settings, "loop", read.choices.loop), readSwitch(settings, "follow", read.choices.follow),
        readScale(settings, read.choices.scale), readSwitch(settings, "mirror", treatment.mirror),
        readChoice(settings, "smoothing", kSmoothings, treatment.smoothing),
        readChoice(settings, "gravity", kGravities, treatment.gravity), readShown(settings, read.shown),
        readRecent(settings, read.recent)}) {
    if (expected) return wrong(*expected);
  }
  return read;
}

Result<void> writeWindowSettings(const fs::path& file, const WindowSettings& settings) {
  if (file.empty()) return {};
  LORICA_TRY_DO(makeOwnFolder(file.parent_path()));
  json written;
  written["format"] = kFormat;
  written["loop"] = settings.choices.loop;
  written["follow"] = settings.choices.follow;
  written["scale"] = settings.choices.scale;
  const Treatment& treatment = settings.choices.treatment;
  written["mirror"] = treatment.mirror;
  written["smoothing"] = kSmoothings[treatment.smoothing].name;
  written["gravity"] = kGravities[treatment.gravity].name;
  written["shown"] = settings.shown;
  written["recent"] = settings.recent;
  // Names of files need not be text.
  return writeFileAtomically(file, written.dump(2, ' ', false, json::error_handler_t::replace) + "\n",
                             NamedBy::kLorica);
}

void showKept(const WindowSettings& settings, SceneOptions& show) {
  for (const Layer& layer : kLayers) {
    if (const auto kept = settings.shown.find(layer.name); kept != settings.shown.end()) {
      show.*layer.shown = kept->second;
    }
  }
}

void keepShown(const SceneOptions& before, const SceneOptions& now, WindowSettings& settings) {
  for (const Layer& layer : kLayers) {
    if (before.*layer.shown != now.*layer.shown) settings.shown[layer.name] = now.*layer.shown;
  }
}

void addRecent(const std::string& file, WindowSettings& settings) {
  std::erase(settings.recent, file);
  settings.recent.insert(settings.recent.begin(), file);
  if (settings.recent.size() > kMaxRecent) settings.recent.resize(kMaxRecent);
}

}  // namespace lorica
