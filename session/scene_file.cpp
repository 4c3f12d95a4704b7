#include "session/scene_file.h"

#include "geometry/files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <utility>

namespace lorica {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kFormat = "lorica scene 1";
constexpr std::size_t kMostBytes = std::size_t{4} << 20;
constexpr std::size_t kMostProps = 2000;
constexpr double kFarthest = 50.0;  // of the place of a thing, along each axis [m]

/// A value as it stands in the file, short enough for a sentence.
std::string shown(const Json& value) {
  std::string text = value.dump(-1, ' ', false, Json::error_handler_t::replace);
  if (text.size() > 40) text = text.substr(0, 37) + "...";
  return text;
}

/// An object of the file. Whatever is wrong is kept in the file's one error, the first to be found; what could not be
/// read is what it was before.
class Element {
 public:
  Element(const Json& json, std::string path, std::optional<std::string>& error)
      : json_(json), path_(std::move(path)), error_(error) {
    if (!json_.is_object()) fail("", shown(json_), "an object");
  }

  /// Refuses what is not among the keys that an element has.
  void allow(std::initializer_list<std::string_view> keys) {
    if (!json_.is_object()) return;
    for (const auto& [key, value] : json_.items()) {
      if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
      fail(key.substr(0, 40), "no such key", fmt::format("one of {}", fmt::join(keys, ", ")));
    }
  }
  [[nodiscard]] bool has(const char* key) const { return json_.is_object() && json_.contains(key); }
  [[nodiscard]] const Json& at(const char* key) const { return json_.at(key); }
  [[nodiscard]] Element child(const char* key) const { return {at(key), pathOf(key), error_}; }
  [[nodiscard]] std::string pathOf(std::string_view key) const {
    return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
  }
  void fail(std::string_view key, std::string_view found, std::string_view expected) {
    if (error_) return;
    const std::string where = key.empty() ? (path_.empty() ? "the scene" : path_) : pathOf(key);
    error_ = fmt::format("{}: found {}, expected {}", where, found, expected);
  }
  void need(const char* key, std::string_view expected) {
    if (json_.is_object() && !json_.contains(key)) fail(key, "nothing", expected);
  }

  void number(const char* key, double least, double most, double& value) {
    if (!has(key)) return;
    const std::string expected = fmt::format("a number from {:g} to {:g}", least, most);
    if (const std::optional<double> read = numberIn(at(key), least, most)) {
      value = *read;
    } else {
      fail(key, shown(at(key)), expected);
    }
  }
  void vector(const char* key, double least, double most, Vec3& value) {
    if (!has(key)) return;
    const Json& json = at(key);
    bool fine = json.is_array() && json.size() == 3;
    Vec3 read;
    for (std::size_t i = 0; fine && i < 3; ++i) {
      const std::optional<double> part = numberIn(json[i], least, most);
      fine = part.has_value();
      if (fine) read[static_cast<Eigen::Index>(i)] = *part;
    }
    if (fine) {
      value = read;
    } else {
      fail(key, shown(json), fmt::format("three numbers from {:g} to {:g}", least, most));
    }
  }
  void integer(const char* key, int least, int most, int& value) {
    if (!has(key)) return;
    const Json& json = at(key);
    if (json.is_number_integer() && json >= least && json <= most) {
      value = json.get<int>();
    } else {
      fail(key, shown(json), fmt::format("a whole number from {} to {}", least, most));
    }
  }
  void flag(const char* key, bool& value) {
    if (!has(key)) return;
    if (at(key).is_boolean()) {
      value = at(key).get<bool>();
    } else {
      fail(key, shown(at(key)), "true or false");
    }
  }
  /// "#rrggbb" in sRGB to linear RGB.
  void color(const char* key, Vec3f& value) {
    if (!has(key)) return;
    const Json& json = at(key);
    const std::string text = json.is_string() ? json.get<std::string>() : "";
    const bool fine =
        text.size() == 7 && text[0] == '#' && text.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
    if (!fine) {
      fail(key, shown(json), "a colour such as \"#d08020\"");
      return;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const double srgb = std::stoi(text.substr(1 + 2 * i, 2), nullptr, 16) / 255.0;
      const double linear = srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
      value[static_cast<Eigen::Index>(i)] = static_cast<float>(linear);
    }
  }
  /// Visits the objects of a list.
  template <typename Visit>
  void each(const char* key, Visit visit) {
    if (!has(key)) return;
    if (!at(key).is_array()) {
      fail(key, shown(at(key)), "a list");
      return;
    }
    for (std::size_t i = 0; i < at(key).size() && !error_; ++i) {
      Element element(at(key)[i], fmt::format("{}[{}]", pathOf(key), i), error_);
      if (!error_) visit(element);
    }
  }
  [[nodiscard]] bool failed() const { return error_.has_value(); }

 private:
  static std::optional<double> numberIn(const Json& json, double least, double most) {
    if (!json.is_number()) return std::nullopt;
    const auto value = json.get<double>();
    if (!(value >= least && value <= most)) return std::nullopt;
    return value;
  }

  const Json& json_;
  std::string path_;
  std::optional<std::string>& error_;
};

/// About the world's x, then y, then z axis. @param degrees  three angles
Quat turned(const Vec3& degrees) {
  const Vec3 angles = degrees * (std::numbers::pi / 180.0);
  return Eigen::AngleAxisd(angles.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(angles.y(), Vec3::UnitY()) *
         Eigen::AngleAxisd(angles.x(), Vec3::UnitX());
}

void readShape(Element& element, Prop& prop) {
  element.need("shape", "box, sphere, capsule or cylinder");
  if (!element.has("shape")) return;
  const Json& shape = element.at("shape");
  double radius = 0.1, height = 0.4;
  if (shape == "box") {
    prop.shape = PropShape::kBox;
    element.need("size", "width, height and depth in metres");
    Vec3 size = Vec3::Constant(0.2);
    element.vector("size", 0.01, 20.0, size);
    prop.halfExtents = 0.5 * size;
    return;
  }
  element.need("radius", "a radius in metres");
  element.number("radius", 0.005, 10.0, radius);
  if (shape == "sphere") {
    prop.shape = PropShape::kSphere;
    prop.halfExtents = Vec3::Constant(radius);
    return;
  }
  if (shape != "capsule" && shape != "cylinder") {
    element.fail("shape", shown(shape), "box, sphere, capsule or cylinder");
    return;
  }
  prop.shape = shape == "capsule" ? PropShape::kCapsule : PropShape::kCylinder;
  element.need("height", "a height in metres");
  element.number("height", 0.01, 20.0, height);
  if (shape == "capsule" && height < 2.0 * radius) {
    element.fail("height", fmt::format("{:g}", height), "a capsule at least as high as it is wide");
  }
  prop.halfExtents = Vec3(radius, 0.5 * height, radius);
}

void readSubstance(Element& element, Prop& prop) {
  element.number("mass", 0.001, 10000.0, prop.mass);
  element.number("friction", 0.0, 10.0, prop.friction);
  element.number("restitution", 0.0, 1.0, prop.restitution);
  element.color("color", prop.color);
}

void readProp(Element& element, SceneFile& scene) {
  element.allow({"shape", "size", "radius", "height", "at", "turn", "mass", "fixed", "friction", "restitution", "color",
                 "velocity", "repeat"});
  Prop prop;
  readShape(element, prop);
  readSubstance(element, prop);
  Vec3 place(0.0, 0.0, 0.0), turn = Vec3::Zero();
  element.need("at", "the middle's place in metres");
  element.vector("at", -kFarthest, kFarthest, place);
  element.vector("turn", -360.0, 360.0, turn);
  element.vector("velocity", -50.0, 50.0, prop.velocity);
  bool fixed = false;
  element.flag("fixed", fixed);
  if (fixed) prop.mass = 0.0;
  prop.worldFromProp = Eigen::Translation3d(place) * turned(turn);

  int count = 1;
  Vec3 step = Vec3::Zero();
  if (element.has("repeat")) {
    Element repeat = element.child("repeat");
    repeat.allow({"count", "step"});
    repeat.need("count", "how many there are");
    repeat.need("step", "three numbers, from one to the next in metres");
    repeat.integer("count", 1, static_cast<int>(kMostProps), count);
    repeat.vector("step", -kFarthest, kFarthest, step);
  }
  for (int i = 0; i < count && scene.props.size() <= kMostProps; ++i) {
    scene.props.push_back(prop);
    scene.props.back().worldFromProp.translation() += i * step;
  }
}

/// Capsules end to end, tied to each other where they meet and to the world at one end or both.
void readChain(Element& element, SceneFile& scene) {
  element.allow({"from", "to", "links", "radius", "mass", "hung", "friction", "restitution", "color"});
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  int links = 1;
  double radius = 0.02;
  Prop prop;
  for (const char* key : {"from", "to"}) element.need(key, "a place in metres");
  element.need("links", "how many there are");
  element.vector("from", -kFarthest, kFarthest, from);
  element.vector("to", -kFarthest, kFarthest, to);
  element.integer("links", 1, 200, links);
  element.number("radius", 0.005, 1.0, radius);
  readSubstance(element, prop);
  bool bothEnds = false;
  if (element.has("hung")) {
    const Json& hung = element.at("hung");
    bothEnds = hung == "both";
    if (!bothEnds && hung != "from") element.fail("hung", shown(hung), "\"from\" or \"both\"");
  }
  const Vec3 step = (to - from) / links;
  const double length = step.norm();
  if (length < 2.0 * radius) {
    element.fail("links", fmt::format("links of {:.3g} m", length), "links at least as long as twice their radius");
  }
  if (element.failed()) return;
  prop.shape = PropShape::kCapsule;
  prop.halfExtents = Vec3(radius, 0.5 * length, radius);
  const Quat along = Quat::FromTwoVectors(Vec3::UnitY(), step);
  int before = kWorldItself;
  for (int i = 0; i < links && scene.props.size() <= kMostProps; ++i) {
    prop.worldFromProp = Eigen::Translation3d(from + (i + 0.5) * step) * along;
    const int index = static_cast<int>(scene.props.size());
    scene.props.push_back(prop);
    scene.links.push_back({index, before, from + i * step});
    before = index;
  }
  if (bothEnds) scene.links.push_back({before, kWorldItself, to});
}

}  // namespace

Result<SceneFile> parseScene(std::string_view text, std::string_view name) {
  const auto bad = [&](std::string_view what) {
    return Error{ErrorCode::kBadFormat, fmt::format("{}: {}", name, what)};
  };
  if (text.size() > kMostBytes) return bad(fmt::format("{} bytes, expected at most {}", text.size(), kMostBytes));
  Json json;
  try {
    json = Json::parse(text, nullptr, true, true);
  } catch (const Json::exception& e) {
    const std::string_view what = e.what();
    const std::size_t bracket = what.find("] ");  // before it stands the library's own number
    return bad(fmt::format("not JSON: {}", bracket == std::string_view::npos ? what : what.substr(bracket + 2)));
  }
  std::optional<std::string> error;
  SceneFile scene;
  Element root(json, "", error);
  root.allow({"format", "name", "gravity", "floor", "props", "chains"});
  root.need("format", fmt::format("\"{}\"", kFormat));
  if (root.has("format") && root.at("format") != kFormat) {
    root.fail("format", shown(root.at("format")), fmt::format("\"{}\"", kFormat));
  }
  if (root.has("name")) {
    if (root.at("name").is_string()) {
      scene.name = root.at("name").get<std::string>();
    } else {
      root.fail("name", shown(root.at("name")), "a text");
    }
  }
  root.vector("gravity", -100.0, 100.0, scene.world.gravity);
  root.flag("floor", scene.world.floor);
  root.each("props", [&](Element& element) { readProp(element, scene); });
  root.each("chains", [&](Element& element) { readChain(element, scene); });
  if (scene.props.size() > kMostProps) root.fail("", "more things", fmt::format("at most {}", kMostProps));
  if (error) return bad(*error);
  return scene;
}

Result<SceneFile> readScene(const std::filesystem::path& file) {
  const Result<std::string> text = readFile(file);
  if (!text) return text.error();
  Result<SceneFile> scene = parseScene(*text, file.string());
  if (scene && scene->name.empty()) scene->name = file.stem().string();
  return scene;
}

World makeWorld(const SceneFile& scene) {
  World world(scene.world);
  for (const Prop& prop : scene.props) world.addProp(prop);
  for (const SceneFile::Link& link : scene.links) world.addLink(link.a, link.b, link.place);
  return world;
}

}  // namespace lorica
