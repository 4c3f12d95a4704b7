#include "capture/registration/registration_file.h"

#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/json.h"
#include "geometry/user_folders.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <numbers>
#include <span>
#include <string>
#include <vector>

namespace lorica {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kFormat = "lorica registration 1";
constexpr std::uint64_t kMaxBytes = 64 << 10;

/// A number of the file, or a list of three: where it is kept, and what it can be.
struct Entry {
  const char* name;
  std::span<double> values;
  double min, max;
};

std::array<Entry, 8> entriesOf(Registration& registration) {
  const auto one = [](double& value) { return std::span(&value, 1); };
  const auto three = [](Vec3& value) { return std::span(value.data(), 3); };
  return {{{"yaw", one(registration.yaw), -std::numbers::pi, std::numbers::pi},
           {"translation", three(registration.translation), -1e4, 1e4},
           {"headInHeadset", three(registration.headInHeadset), -0.5, 0.5},
           {"lag", one(registration.lag), 0.0, kLongestLag},
           {"residual", one(registration.residual), 0.0, 1.0},
           {"yawDeviation", one(registration.yawDeviation), 0.0, HeadRegistration::kMaxYawDeviation},
           {"levelDeviation", one(registration.levelDeviation), 0.0, 10.0},
           {"heightDeviation", one(registration.heightDeviation), 0.0, 10.0}}};
}

bool isIn(const json& value, const Entry& entry) {
  return value.is_number() && value.get<double>() >= entry.min && value.get<double>() <= entry.max;
}

bool read(const json& found, const Entry& entry) {
  if (entry.values.size() == 1) {
    if (isIn(found, entry)) entry.values[0] = found.get<double>();
    return isIn(found, entry);
  }
  if (!found.is_array() || found.size() != entry.values.size()) return false;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (!isIn(found[i], entry)) return false;
    entry.values[i] = found[i].get<double>();
  }
  return true;
}

/// Of what a file holds, for a message.
std::string shortened(const json& found) {
  std::string text = found.dump(-1, ' ', true, json::error_handler_t::replace);
  return text.size() <= 60 ? text : text.substr(0, 60) + "...";
}

}  // namespace

fs::path registrationFile(std::string_view camera) {
  const fs::path folder = userFolder("XDG_CONFIG_HOME", ".config");
  // What a camera is called need not be a file's name.
  return folder.empty() ? folder : folder / "registrations" / (hexDigits(contentHash(camera)) + ".json");
}

Result<Registration> loadRegistration(const fs::path& file) {
  LORICA_TRY(const std::string text, readFile(file, NamedBy::kLorica, kMaxBytes));
  LORICA_TRY(const json kept, parseJson(text, file.string()));
  const auto wrong = [&](std::string_view name, const json& found, const std::string& expected) {
    return badFormat("{}: {}: found {}, expected {}", file.string(), name, shortened(found), expected);
  };
  if (!kept.is_object()) return wrong("the file", kept, "an object");
  const json format = kept.value("format", json());
  if (format != kFormat) return wrong("format", format, fmt::format("\"{}\"", kFormat));
  Registration registration;
  const std::array entries = entriesOf(registration);
  for (const Entry& entry : entries) {
    const json found = kept.value(entry.name, json());
    if (read(found, entry)) continue;
    return wrong(entry.name, found,
                 fmt::format("{} from {:.6g} to {:.6g}", entry.values.size() == 1 ? "a number" : "three numbers",
                             entry.min, entry.max));
  }
  if (kept.size() != entries.size() + 1) {
    return badFormat("{}: found {} entries, expected {}", file.string(), kept.size(), entries.size() + 1);
  }
  return registration;
}

Result<void> saveRegistration(const fs::path& file, const Registration& registration) {
  json kept;
  kept["format"] = kFormat;
  Registration copy = registration;
  for (const Entry& entry : entriesOf(copy)) {
    if (entry.values.size() == 1) {
      kept[entry.name] = entry.values[0];
    } else {
      kept[entry.name] = std::vector<double>(entry.values.begin(), entry.values.end());
    }
  }
  LORICA_TRY_DO(makeOwnFolder(file.parent_path()));
  return writeFileAtomically(file, kept.dump(2) + "\n", NamedBy::kLorica);
}

}  // namespace lorica
