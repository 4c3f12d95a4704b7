#include "capture/virtual_sensor/virtual_script.h"

#include "capture/files/joint_csv.h"
#include "capture/virtual_sensor/virtual_performer.h"
#include "geometry/errors.h"
#include "skinning/mannequin/mannequin.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>

namespace lorica {
namespace {

/// Distance between two people [m].
constexpr double kApart = 1.3;

Error badScript(std::string message) {
  return invalidArgument("virtual sensor script: " + std::move(message));
}

std::vector<std::string_view> split(std::string_view text, char by) {
  std::vector<std::string_view> parts;
  while (true) {
    const std::size_t end = text.find(by);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

/// Parses the whole text as a number within bounds.
template <typename Number>
std::optional<Number> numberOf(std::string_view text, Number min, Number max) {
  Number number{};
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (problem != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if (!(number >= min && number <= max)) return std::nullopt;
  return number;
}

std::optional<TimeSpan> spanOf(std::string_view text) {
  const std::vector<std::string_view> ends = split(text, ':');
  if (ends.size() != 2) return std::nullopt;
  const std::optional<double> from = numberOf(ends[0], 0.0, 1e6);
  const std::optional<double> to = numberOf(ends[1], 0.0, 1e6);
  if (!from || !to || *from >= *to) return std::nullopt;
  return TimeSpan{*from, *to};
}

/// Applies one setting. @return what was expected if the value is wrong
std::optional<std::string> apply(std::string_view key, std::string_view value, VirtualScript& script) {
  VirtualSensorSettings& settings = script.settings;
  const auto number = [&](double& to, double min, double max) -> std::optional<std::string> {
    const std::optional<double> read = numberOf(value, min, max);
    if (!read) return fmt::format("a number from {} to {}", min, max);
    to = *read;
    return std::nullopt;
  };
  const auto choice = [&](bool& to, std::string_view yes, std::string_view no) -> std::optional<std::string> {
    if (value != yes && value != no) return fmt::format("{} or {}", yes, no);
    to = value == yes;
    return std::nullopt;
  };
  const auto span = [&](std::vector<TimeSpan>& to) -> std::optional<std::string> {
    const std::optional<TimeSpan> read = spanOf(value);
    if (!read) return "from:to in seconds, for example 2:4.5";
    to.push_back(*read);
    return std::nullopt;
  };
  if (key == "motion") {
    const std::vector<std::string_view> names = split(value, ',');
    script.motions.assign(names.begin(), names.end());
    const bool known = std::all_of(names.begin(), names.end(), [](std::string_view name) {
      return !shippedText(name).empty() || (name.size() > 4 && name.ends_with(".csv"));
    });
    if (known && names.size() <= 2) return std::nullopt;
    return fmt::format("one or two of {}, or files that end in .csv", fmt::join(kShippedMotions, ", "));
  }
  if (key == "loop") return choice(settings.loop, "yes", "no");
  if (key == "pace") return choice(settings.live, "live", "fast");
  if (key == "noise") {
    const std::optional<DepthNoiseKind> kind = depthNoiseNamed(value);
    if (!kind) return "kinect, mild or none";
    const std::uint64_t seed = settings.noise.seed;
    settings.noise = DepthNoiseSettings::of(*kind);
    settings.noise.seed = seed;
    return std::nullopt;
  }
  if (key == "size") return choice(script.halfSize, "half", "full");
  if (key == "seed") {
    const std::optional<std::uint64_t> seed = numberOf<std::uint64_t>(value, 0, ~std::uint64_t{0});
    if (!seed) return "a whole number of at least 0";
    settings.noise.seed = *seed;
    return std::nullopt;
  }
  if (key == "start") return number(script.start, 0.0, 1e6);
  if (key == "height") return number(script.height, 0.5, 2.0);
  if (key == "girth") return number(script.girth, 0.5, 2.0);
  if (key == "distance") {
    Vec3 position = settings.room.worldFromCamera.translation();
    std::optional<std::string> expected = number(position.z(), 1.0, 7.0);
    settings.room.worldFromCamera.translation() = position;
    return expected;
  }
  if (key == "unplug") return span(settings.unplugged);
  if (key == "absent") return span(script.absent);
  return "one of the keys motion, start, loop, pace, noise, size, seed, height, girth, distance, unplug, "
         "absent";
}

}  // namespace

Result<VirtualScript> parseVirtualScript(std::string_view text) {
  VirtualScript script;
  script.settings.live = script.settings.loop = true;
  std::vector<std::string_view> seen;
  for (const std::string_view setting : split(text, ' ')) {
    if (setting.empty()) continue;
    const std::size_t equals = setting.find('=');
    if (equals == std::string_view::npos) return badScript(fmt::format("found '{}', expected key=value", setting));
    const std::string_view key = setting.substr(0, equals);
    if (std::find(seen.begin(), seen.end(), key) != seen.end()) {
      return badScript(fmt::format("found {} twice, expected it only once", key));
    }
    seen.push_back(key);
    if (const std::optional<std::string> expected = apply(key, setting.substr(equals + 1), script)) {
      return badScript(fmt::format("found '{}', expected {}", setting, *expected));
    }
  }
  script.settings.camera = script.settings.noise.sensor;
  if (script.halfSize) {
    script.settings.camera.width /= 2;
    script.settings.camera.height /= 2;
  }
  return script;
}

Result<VirtualSensor> makeVirtualSensor(const VirtualScript& script) {
  const Character body = withProportions(makeMannequin(), {.height = script.height, .girth = script.girth});
  std::vector<VirtualPerson> people;
  people.reserve(script.motions.size());
  for (const std::string& motion : script.motions) {
    const std::string_view shipped = shippedText(motion);
    LORICA_TRY(const std::vector<SkeletonFrame> frames,
               shipped.empty() ? readJointCsv(motion) : parseJointCsv(shipped, motion));
    LORICA_TRY(VirtualPerformer performer, VirtualPerformer::create(body, frames));
    VirtualPerson person{std::move(performer)};
    const auto position = people.size() - 0.5 * (script.motions.size() - 1);
    person.worldFromMotion.translate(Vec3(kApart * position, 0.0, 0.0));
    person.start = script.start;
    person.absent = script.absent;
    people.push_back(std::move(person));
  }
  return VirtualSensor::create(std::move(people), script.settings);
}

}  // namespace lorica
