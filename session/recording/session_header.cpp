#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/json.h"
#include "geometry/text.h"
#include "geometry/work_budgets.h"
#include "session/recording/session_file.h"
#include "session/scenes/scene_element.h"
#include "session/session_springs.h"

#include <fmt/format.h>

#include <charconv>
#include <limits>
#include <numbers>

namespace lorica {
namespace {

constexpr const char* kFormat = "lorica-session-3";
constexpr int kMaxPoseJoints = 100000;
constexpr double kFarthestPlace = 1e6;  // [m]

/// Reads a hash of sixteen hexadecimal digits.
void readHash(SceneElement& element, const char* key, std::uint64_t& hash) {
  std::string text;
  element.need(key, "16 hexadecimal digits");
  element.text(key, text);
  if (element.failed()) return;
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, hash, 16);
  if (text.size() != 16 || error != std::errc() || stopped != end) {
    element.fail(key, fmt::format("\"{}\"", firstBytes(text, 40)), "16 hexadecimal digits");
  }
}

void readSmoothing(SceneElement element, JointSettings& joints) {
  constexpr double kMax = std::numeric_limits<double>::max();
  element.allow({"min-cutoff", "beta"});
  OneEuroSettings settings;
  element.number("min-cutoff", std::numeric_limits<double>::min(), kMax, settings.minCutoff);
  element.number("beta", 0.0, kMax, settings.beta);
  joints.smoothing = settings;
}

void readFaults(SceneElement& root, AvatarRecord& header) {
  std::string text;
  root.text("faults", text);
  if (text.empty() || root.failed()) return;
  const Result<FaultSettings> faults = parseFaults(text);
  if (faults) {
    header.faults = *faults;
  } else {
    root.failWith("faults", faults.error().message);
  }
}

/// Reads one text or a list of texts.
/// @param example  of one, for the message
void readTexts(SceneElement& element, const char* key, const char* example, std::vector<std::string>& texts) {
  if (!element.has(key)) return;
  const SceneJson& list = element.at(key);
  for (const SceneJson& one : list.is_array() ? list : SceneJson::array({list})) {
    if (!one.is_string()) return element.fail(key, shownInScene(one), fmt::format("texts such as \"{}\"", example));
    texts.push_back(one.get<std::string>());
  }
}

void readCharacter(SceneElement element, AvatarRecord& header) {
  element.allow({"name", "map", "body-resolution", "walls", "thickness", "expressions", "hide", "clip", "hash"});
  element.text("name", header.character);
  element.text("map", header.boneMap);
  element.number("body-resolution", 0.0, 1e3, header.bodyResolution);
  element.text("walls", header.walls);
  element.number("thickness", 0.0, 1e3, header.thickness);
  readTexts(element, "expressions", "Joy=1", header.expressions);
  readTexts(element, "hide", "Axe", header.hidden);
  if (element.has("clip")) element.text("clip", header.clip.emplace());
  readHash(element, "hash", header.characterHash);
}

void readBody(SceneElement element, AvatarRecord& header) {
  element.allow({"file", "hash", "cover", "hull-vertices", "cover-hash", "training-hash"});
  element.text("file", header.decomposition);
  readHash(element, "hash", header.decompositionHash);
  if (element.has("cover")) {
    double tolerance = 0.0;
    element.number("cover", 0.0, 1e3, tolerance);
    header.coverTolerance = tolerance;
  }
  element.integer("hull-vertices", 0, std::numeric_limits<int>::max(), header.hullVertices);
  readHash(element, "cover-hash", header.coverHash);
  readHash(element, "training-hash", header.trainingHash);
}

void readSprings(SceneElement element, AvatarRecord& header) {
  element.allow({"mode", "hash"});
  std::string mode;
  element.need("mode", "none, file or body");
  element.text("mode", mode);
  if (element.failed()) return;
  header.springs = springModeNamed(mode);
  if (!header.springs) element.fail("mode", fmt::format("\"{}\"", firstBytes(mode, 40)), "none, file or body");
  readHash(element, "hash", header.springsHash);
}

void readScene(SceneElement element, SessionHeader& header) {
  element.allow({"name", "folder", "seed", "hash"});
  element.text("name", header.scene);
  element.text("folder", header.sceneFolder);
  readHash(element, "seed", header.sceneSeed);
  readHash(element, "hash", header.worldHash);
}

void readAvatar(SceneElement element, AvatarRecord& header) {
  element.allow({"source", "pose-joints", "pose-trust", "pose-expressions", "character", "decomposition", "mirror",
                 "upper-body", "smoothing", "faults", "place", "heading", "color", "springs"});
  element.text("source", header.source);
  element.integer("pose-joints", 0, kMaxPoseJoints, header.poseJoints);
  if (element.has("pose-trust")) element.flag("pose-trust", header.poseTrust);
  if (element.has("pose-expressions")) element.flag("pose-expressions", header.poseExpressions);
  for (const char* key : {"character", "decomposition"}) element.need(key, "an object");
  if (!element.failed()) readCharacter(element.child("character"), header);
  if (!element.failed()) readBody(element.child("decomposition"), header);
  element.flag("mirror", header.joints.mirror);
  element.flag("upper-body", header.joints.upperBody);
  if (element.has("smoothing") && !element.failed()) readSmoothing(element.child("smoothing"), header.joints);
  readFaults(element, header);
  element.vector("place", -kFarthestPlace, kFarthestPlace, header.place);
  element.number("heading", -360.0, 360.0, header.heading);
  if (element.has("color")) {
    Vec3 color = Vec3::Ones();
    element.vector("color", 0.0, 1.0, color);
    header.color = color.cast<float>();
  }
  if (element.has("springs") && !element.failed()) readSprings(element.child("springs"), header);
}

void readAvatars(SceneElement& root, SessionHeader& header) {
  header.avatars.clear();
  root.each("avatars", [&](SceneElement& element) {
    if (header.avatars.size() < kMaxRecordedAvatars) return readAvatar(element, header.avatars.emplace_back());
    root.fail("avatars", fmt::format("{} avatars", root.at("avatars").size()),
              fmt::format("at most {}", kMaxRecordedAvatars));
  });
  if (!root.failed() && header.avatars.empty()) root.fail("avatars", "an empty list", "at least one avatar");
}

SceneJson jsonOf(const AvatarRecord& header) {
  SceneJson json;
  json["source"] = header.source;
  json["pose-joints"] = header.poseJoints;
  if (header.poseTrust) json["pose-trust"] = true;
  if (header.poseExpressions) json["pose-expressions"] = true;
  SceneJson& character = json["character"];
  character["name"] = header.character;
  if (!header.boneMap.empty()) character["map"] = header.boneMap;
  if (header.bodyResolution > 0.0) character["body-resolution"] = header.bodyResolution;
  if (!header.walls.empty()) character["walls"] = header.walls;
  if (header.thickness > 0.0) character["thickness"] = header.thickness;
  if (!header.expressions.empty()) character["expressions"] = header.expressions;
  if (!header.hidden.empty()) character["hide"] = header.hidden;
  if (header.clip) character["clip"] = *header.clip;
  character["hash"] = hexDigits(header.characterHash);
  SceneJson& body = json["decomposition"];
  if (!header.decomposition.empty()) body["file"] = header.decomposition;
  body["hash"] = hexDigits(header.decompositionHash);
  if (header.coverTolerance) body["cover"] = *header.coverTolerance;
  if (header.hullVertices > 0) body["hull-vertices"] = header.hullVertices;
  body["cover-hash"] = hexDigits(header.coverHash);
  body["training-hash"] = hexDigits(header.trainingHash);
  json["mirror"] = header.joints.mirror;
  if (header.joints.upperBody) json["upper-body"] = true;
  if (header.joints.smoothing) {
    json["smoothing"]["min-cutoff"] = header.joints.smoothing->minCutoff;
    json["smoothing"]["beta"] = header.joints.smoothing->beta;
  }
  json["faults"] = textOf(header.faults);
  if (!header.place.isZero()) json["place"] = {header.place.x(), header.place.y(), header.place.z()};
  if (header.heading != 0.0) json["heading"] = header.heading;
  if (header.color) json["color"] = {header.color->x(), header.color->y(), header.color->z()};
  if (header.springs) {
    json["springs"]["mode"] = nameOf(*header.springs);
    json["springs"]["hash"] = hexDigits(header.springsHash);
  }
  return json;
}

}  // namespace

std::optional<Isometry3> placeOf(const Vec3& place, double heading) {
  if (place.isZero() && heading == 0.0) return std::nullopt;
  Isometry3 worldFromMotion = Isometry3::Identity();
  worldFromMotion.linear() = Eigen::AngleAxisd(heading * std::numbers::pi / 180.0, Vec3::UnitY()).toRotationMatrix();
  worldFromMotion.translation() = place;
  return worldFromMotion;
}

std::string textOf(const SessionHeader& header) {
  SceneJson json;
  json["format"] = kFormat;
  json["avatars"] = SceneJson::array();
  for (const AvatarRecord& avatar : header.avatars) json["avatars"].push_back(jsonOf(avatar));
  SceneJson& scene = json["scene"];
  scene["name"] = header.scene;
  if (!header.sceneFolder.empty()) scene["folder"] = header.sceneFolder;
  scene["seed"] = hexDigits(header.sceneSeed);
  scene["hash"] = hexDigits(header.worldHash);
  // File names need not be UTF-8.
  return json.dump(1, ' ', false, SceneJson::error_handler_t::replace);
}

Result<SessionHeader> parseSessionHeader(std::string_view text, const std::string& name) {
  LORICA_TRY(const SceneJson json, parseWrittenJson(text, name));
  std::optional<std::string> error;
  SessionHeader header;
  SceneElement root(json, "", error);
  std::string format;
  root.need("format", fmt::format("\"{}\"", kFormat));
  root.text("format", format);
  if (!root.failed() && format != kFormat) {
    root.fail("format", fmt::format("\"{}\"", firstBytes(format, 40)), fmt::format("\"{}\"", kFormat));
  }
  if (!root.failed()) root.allow({"format", "avatars", "scene"});
  root.need("avatars", "a list");
  root.need("scene", "an object");
  readAvatars(root, header);
  if (!root.failed()) readScene(root.child("scene"), header);
  if (error) return badFormat("{}: header: {}", name, *error);
  return header;
}

}  // namespace lorica
