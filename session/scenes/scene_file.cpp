#include "session/scenes/scene_file.h"

#include "collision/world/prop_overlaps.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/json.h"
#include "geometry/work_budgets.h"
#include "session/scenes/scene_element.h"
#include "session/scenes/scene_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <utility>

namespace lorica {
namespace {

constexpr std::size_t kMaxAvatars = 64;
constexpr double kFarthest = 50.0;     // maximum of each coordinate [m]
constexpr double kLongestStart = 1e5;  // [s]
constexpr double kNearest = 0.1;       // of two places [m]

constexpr std::string_view kFormat = "lorica scene 1";
constexpr std::size_t kMaxBytes = std::size_t{4} << 20;
constexpr std::size_t kLongestName = 40;

/// Rotation about the world's x, then y, then z axis. @param degrees  three angles
Quat turned(const Vec3& degrees) {
  const Vec3 angles = degrees * (std::numbers::pi / 180.0);
  return Eigen::AngleAxisd(angles.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(angles.y(), Vec3::UnitY()) *
         Eigen::AngleAxisd(angles.x(), Vec3::UnitX());
}

constexpr std::string_view kShapes = "box, sphere, capsule, cylinder or mesh";

void readBox(SceneElement& element, Prop& prop) {
  Vec3 size = Vec3::Constant(0.2);
  element.need("size", "width, height and depth in metres");
  element.vector("size", kSmallestProp, kLargestProp, size);
  prop.halfExtents = 0.5 * size;
}

/// Sphere, capsule or cylinder.
void readRound(SceneElement& element, Prop& prop) {
  double radius = 0.1, height = 0.4;
  element.need("radius", "a radius in metres");
  element.number("radius", 0.005, 10.0, radius);
  prop.halfExtents = Vec3::Constant(radius);
  if (prop.shape == PropShape::kSphere) return;
  element.need("height", "a height in metres");
  element.number("height", 0.01, 20.0, height);
  if (prop.shape == PropShape::kCapsule && height < 2.0 * radius) {
    element.fail("height", fmt::format("{:g}", height), "a height of at least twice the radius");
  }
  prop.halfExtents.y() = 0.5 * height;
}

/// Makes the shape of each mesh once for all props of the file that share it.
class MeshShelf {
 public:
  explicit MeshShelf(const SceneReading& reading) : reading_(reading) {}

  void take(SceneElement& element, Prop& prop) {
    PropMeshRequest request;
    std::string file;
    element.need("file", "a mesh file (.off, .obj, .ply, .stl)");
    element.text("file", file);
    element.number("scale", 1e-6, 1e6, request.scale);
    element.vector("size", kSmallestProp, kLargestProp, request.size);
    element.integer("parts", 1, kMaxPropParts, request.parts);
    if (element.has("scale") && element.has("size")) element.fail("scale", "both scale and size", "one of them");
    if (element.failed()) return;
    if (file.empty()) return element.fail("file", "\"\"", "a mesh file (.off, .obj, .ply, .stl)");
    const Result<std::filesystem::path> found = NamedFiles{reading_.folder, reading_.paths}.find(file);
    if (!found) return element.failWith("file", found.error().message);
    request.file = *found;
    for (const auto& [known, shape] : shelf_) {
      if (known == request) return fill(shape, prop);
    }
    if (shelf_.size() >= kMaxSceneMeshes)
      return element.fail("file", "more meshes", fmt::format("at most {}", kMaxSceneMeshes));
    Result<std::shared_ptr<const PropMeshShape>> shape =
        readPropMesh(request, reading_.decomposer ? reading_.decomposer : decomposePropMesh);
    if (!shape) {
      code_ = shape.error().code;
      return element.failWith("file", shape.error().message);
    }
    shelf_.emplace_back(request, *shape);
    fill(*shape, prop);
  }
  /// Error code of the mesh that failed.
  [[nodiscard]] ErrorCode code() const { return code_; }

 private:
  static void fill(const std::shared_ptr<const PropMeshShape>& shape, Prop& prop) {
    const Prop made = meshProp(shape);
    prop.mesh = made.mesh;
    prop.halfExtents = made.halfExtents;
  }
  const SceneReading& reading_;
  std::vector<std::pair<PropMeshRequest, std::shared_ptr<const PropMeshShape>>> shelf_;
  ErrorCode code_ = ErrorCode::kBadFormat;
};

/// Reads the shape; each shape has its own keys.
void readShape(SceneElement& element, Prop& prop, MeshShelf& meshes) {
  element.need("shape", kShapes);
  if (!element.has("shape")) return;
  const SceneJson& shape = element.at("shape");
  const auto allowWith = [&](std::initializer_list<std::string_view> own) {
    std::vector<std::string_view> keys = {"shape"};
    keys.insert(keys.end(), own);
    keys.insert(keys.end(),
                {"at", "turn", "mass", "fixed", "friction", "restitution", "color", "velocity", "repeat", "target"});
    element.allow(keys);
  };
  if (shape == "box") {
    allowWith({"size"});
    prop.shape = PropShape::kBox;
    readBox(element, prop);
  } else if (shape == "sphere") {
    allowWith({"radius"});
    prop.shape = PropShape::kSphere;
    readRound(element, prop);
  } else if (shape == "capsule" || shape == "cylinder") {
    allowWith({"radius", "height"});
    prop.shape = shape == "capsule" ? PropShape::kCapsule : PropShape::kCylinder;
    readRound(element, prop);
  } else if (shape == "mesh") {
    allowWith({"file", "scale", "size", "parts"});
    prop.shape = PropShape::kMesh;
    meshes.take(element, prop);
  } else {
    element.fail("shape", shownInScene(shape), kShapes);
  }
}

void readSubstance(SceneElement& element, Prop& prop) {
  element.number("mass", 0.001, 10000.0, prop.mass);
  element.number("friction", 0.0, 10.0, prop.friction);
  element.number("restitution", 0.0, 1.0, prop.restitution);
  element.color("color", prop.color);
}

/// Adds the props from `first` on to the target that the element names; props of the same name are one target.
void readTarget(SceneElement& element, std::size_t first, SceneFile& scene) {
  if (!element.has("target")) return;
  std::string name;
  element.text("target", name);
  if (name.empty() || name.size() > kLongestName) {
    element.fail("target", shownInScene(element.at("target")), fmt::format("a name of 1 to {} bytes", kLongestName));
  }
  if (first < scene.props.size() && scene.props[first].mass == 0.0) {
    element.fail("target", "a fixed body, which the avatar passes through", "one that moves");
  }
  auto target = std::find_if(scene.targets.begin(), scene.targets.end(),
                             [&](const HitTarget& known) { return known.name == name; });
  if (target == scene.targets.end()) target = scene.targets.insert(target, HitTarget{name, {}});
  for (std::size_t prop = first; prop < scene.props.size(); ++prop) target->props.push_back(prop);
}

/// The copies of a prop. Each is a step from the one before; it and that step are turned about the vertical.
struct Row {
  int count = 1;
  Vec3 step = Vec3::Zero();
  double turn = 0.0;  // [degrees]
};

Row readRow(SceneElement& element) {
  Row row;
  if (!element.has("repeat")) return row;
  SceneElement repeat = element.child("repeat");
  repeat.allow({"count", "step", "turn"});
  repeat.need("count", "the number of copies");
  repeat.need("step", "three numbers, the offset from one to the next in metres");
  repeat.integer("count", 1, static_cast<int>(kMaxSceneProps), row.count);
  repeat.vector("step", -kFarthest, kFarthest, row.step);
  repeat.number("turn", -360.0, 360.0, row.turn);
  return row;
}

void readProp(SceneElement& element, MeshShelf& meshes, SceneFile& scene) {
  Prop prop;
  readShape(element, prop, meshes);
  readSubstance(element, prop);
  Vec3 position(0.0, 0.0, 0.0), turn = Vec3::Zero();
  element.need("at", "the position of its centre in metres");
  element.vector("at", -kFarthest, kFarthest, position);
  element.vector("turn", -360.0, 360.0, turn);
  element.vector("velocity", -50.0, 50.0, prop.velocity);
  bool fixed = false;
  element.flag("fixed", fixed);
  if (fixed) prop.mass = 0.0;
  prop.worldFromProp = Eigen::Translation3d(position) * turned(turn);

  const Row row = readRow(element);
  const std::size_t first = scene.props.size();
  Vec3 bent = Vec3::Zero();  // from the first copy
  for (int i = 0; i < row.count && scene.props.size() <= kMaxSceneProps; ++i) {
    const Quat heading = turned(Vec3(0.0, i * row.turn, 0.0));
    if (i > 0) bent += heading * row.step;
    scene.props.push_back(prop);
    Isometry3& worldFromCopy = scene.props.back().worldFromProp;
    worldFromCopy.translation() += row.turn == 0.0 ? Vec3(i * row.step) : bent;
    if (row.turn != 0.0) worldFromCopy.linear() = (heading * turned(turn)).toRotationMatrix();
  }
  readTarget(element, first, scene);
}

void readChain(SceneElement& element, SceneFile& scene) {
  element.allow(
      {"from", "to", "links", "radius", "width", "sag", "mass", "hung", "friction", "restitution", "color", "target"});
  Prop link;
  readSubstance(element, link);
  const std::size_t first = scene.props.size();
  addChain(element, link, kMaxSceneProps, scene);
  readTarget(element, first, scene);
}

/// Names the props that the elements of a list made: "props[2]", or "copy 3 of props[2]".
class PropNames {
 public:
  void add(const std::string& element, std::size_t propCount) {
    const std::size_t first = names_.size();
    const bool several = propCount > first + 1;
    while (names_.size() < propCount) {
      names_.push_back(several ? fmt::format("copy {} of {}", names_.size() - first + 1, element) : element);
    }
  }
  [[nodiscard]] const std::string& operator[](std::size_t prop) const { return names_[prop]; }

 private:
  std::vector<std::string> names_;
};

/// Physics cannot resolve these, or only at a cost that grows with the square of the number of props.
void refuseOverlaps(const SceneFile& scene, const PropNames& names, SceneElement& root) {
  if (const std::optional<PropOverlap> overlap = findPropInside(scene.props)) {
    return root.fail("", fmt::format("{} inside {}", names[overlap->inner], names[overlap->outer]),
                     "objects beside each other");
  }
  if (countNearPairs(scene.props) > kMaxSceneNearPairs) {
    root.fail("", "more pairs of objects whose bounding boxes overlap", fmt::format("at most {}", kMaxSceneNearPairs));
  }
}

void refuseLargeMeshes(const SceneFile& scene, SceneElement& root) {
  std::size_t hulls = 0, vertices = 0;
  for (const Prop& prop : scene.props) {
    if (!prop.mesh) continue;
    hulls += prop.mesh->hulls.size();
    for (const ConvexHull& hull : prop.mesh->hulls) vertices += hull.vertices.size();
  }
  if (hulls > kMaxSceneHulls) root.fail("", "more convex parts of meshes", fmt::format("at most {}", kMaxSceneHulls));
  if (vertices > kMaxSceneHullVertices) {
    root.fail("", "more vertices of convex parts of meshes", fmt::format("at most {}", kMaxSceneHullVertices));
  }
}

/// Reads "avatars" of a scene.
std::vector<AvatarSetting> readStage(SceneElement& root) {
  std::vector<AvatarSetting> stage;
  root.each("avatars", [&](SceneElement& element) {
    AvatarSetting avatar;
    element.allow({"character", "motion", "start", "place", "heading", "color"});
    element.text("character", avatar.character);
    element.text("motion", avatar.motion);
    element.number("start", 0.0, kLongestStart, avatar.start);
    element.vector("place", -kFarthest, kFarthest, avatar.place);
    element.number("heading", -360.0, 360.0, avatar.heading);
    if (element.has("color")) element.color("color", avatar.color.emplace());
    if (stage.size() == kMaxAvatars) {
      root.fail("avatars", fmt::format("{} avatars", root.at("avatars").size()),
                fmt::format("at most {}", kMaxAvatars));
    }
    for (std::size_t i = 0; i < stage.size() && !root.failed(); ++i) {
      if ((stage[i].place - avatar.place).norm() >= kNearest) continue;
      element.fail("place", fmt::format("the place of avatars[{}]", i), "places that are 0.1 m apart or more");
    }
    stage.push_back(std::move(avatar));
  });
  return stage;
}

}  // namespace

Result<SceneFile> parseScene(std::string_view text, std::string_view name, const SceneReading& reading) {
  const auto bad = [&](std::string_view what) { return badFormat("{}: {}", name, what); };
  if (text.size() > kMaxBytes) return bad(fmt::format("{} bytes, expected at most {}", text.size(), kMaxBytes));
  LORICA_TRY(const SceneJson json, parseWrittenJson(text, name));
  MeshShelf meshes(reading);
  std::optional<std::string> error;
  SceneFile scene;
  SceneElement root(json, "", error);
  root.allow({"format", "name", "gravity", "floor", "props", "chains", "grains", "water", "avatars"});
  root.need("format", fmt::format("\"{}\"", kFormat));
  if (root.has("format") && root.at("format") != kFormat) {
    root.fail("format", shownInScene(root.at("format")), fmt::format("\"{}\"", kFormat));
  }
  root.text("name", scene.name);
  root.vector("gravity", -100.0, 100.0, scene.world.gravity);
  root.flag("floor", scene.world.floor);
  scene.stage = readStage(root);
  PropNames names;
  for (const char* list : {"props", "chains"}) {
    std::size_t index = 0;
    root.each(list, [&](SceneElement& element) {
      list[0] == 'p' ? readProp(element, meshes, scene) : readChain(element, scene);
      names.add(root.pathOf(list, index++), scene.props.size());
    });
  }
  ParticleSettings particles;
  particles.gravity = scene.world.gravity;
  particles.floor = scene.world.floor;
  scene.particles = readParticles(root, particles);
  if (scene.props.size() > kMaxSceneProps) root.fail("", "more props", fmt::format("at most {}", kMaxSceneProps));
  refuseLargeMeshes(scene, root);
  if (!error) refuseOverlaps(scene, names, root);
  if (error) return Error{meshes.code(), fmt::format("{}: {}", name, *error)};
  return scene;
}

Result<SceneFile> readScene(const std::filesystem::path& file, const MeshDecomposer& decomposer, PathTrust paths) {
  LORICA_TRY(const std::string text, readFile(file, NamedBy::kUser, kMaxBytes));
  Result<SceneFile> scene = parseScene(text, file.string(), {file.parent_path(), decomposer, paths});
  if (scene && scene->name.empty()) scene->name = file.stem().string();
  return scene;
}

Result<World> makeWorld(const SceneFile& scene) {
  World world(scene.world);
  for (const Prop& prop : scene.props) world.addProp(prop);
  for (const SceneFile::Link& link : scene.links) world.addLink(link.a, link.b, link.position);
  if (scene.particles) LORICA_TRY_DO(world.setParticles(*scene.particles));
  return world;
}

}  // namespace lorica
