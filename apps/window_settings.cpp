#include "apps/window_settings.h"

#include "geometry/files.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdlib>
#include <optional>

namespace lorica {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kFormat = "lorica window 1";
constexpr std::uint64_t kMaxBytes = std::uint64_t{1} << 20;

fs::path environmentPath(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? fs::path() : fs::path(value);
}

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

fs::path windowSettingsFile() {
  if (const fs::path folder = environmentPath("XDG_CONFIG_HOME"); folder.is_absolute()) {
    return folder / "lorica" / "window.json";
  }
  if (const fs::path home = environmentPath("HOME"); home.is_absolute()) {
    return home / ".config" / "lorica" / "window.json";
  }
  return {};
}

Result<WindowSettings> readWindowSettings(const fs::path& file) {
  std::error_code ignored;
  if (file.empty() || !fs::exists(file, ignored)) return WindowSettings();
  const Result<std::string> text = readFile(file, NamedBy::kUser, kMaxBytes);
  if (!text) return text.error();
  const auto wrong = [&](const std::string& expected) {
    return Error{ErrorCode::kBadFormat,
                 fmt::format("{}: the window's settings are damaged, expected {}; the usual ones are used",
                             file.string(), expected)};
  };
  const json settings = json::parse(*text, nullptr, false);
  if (!settings.is_object() || settings.value("format", json()) != kFormat) {
    return wrong(fmt::format("\"format\": \"{}\"", kFormat));
  }
  WindowSettings read;
  for (const std::optional<std::string>& expected :
       {readSwitch(settings, "loop", read.choices.loop), readSwitch(settings, "follow", read.choices.follow),
        readScale(settings, read.choices.scale), readRecent(settings, read.recent)}) {
    if (expected) return wrong(*expected);
  }
  return read;
}

Result<void> writeWindowSettings(const fs::path& file, const WindowSettings& settings) {
  if (file.empty()) return {};
  std::error_code failed;
  fs::create_directories(file.parent_path(), failed);
  json written;
  written["format"] = kFormat;
  written["loop"] = settings.choices.loop;
  written["follow"] = settings.choices.follow;
  written["scale"] = settings.choices.scale;
  written["recent"] = settings.recent;
  // Names of files need not be text.
  return writeFileAtomically(file, written.dump(2, ' ', false, json::error_handler_t::replace) + "\n");
}

void addRecent(const std::string& file, WindowSettings& settings) {
  std::erase(settings.recent, file);
  settings.recent.insert(settings.recent.begin(), file);
  if (settings.recent.size() > kMaxRecent) settings.recent.resize(kMaxRecent);
}

}  // namespace lorica
