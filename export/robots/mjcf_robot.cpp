#include "export/mesh_export.h"
#include "export/robots/mjcf_tree.h"
#include "export/robots/robot.h"
#include "geometry/convex_hull.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/mesh_formats.h"
#include "geometry/text.h"
#include "geometry/work_budgets.h"

#include <algorithm>
#include <set>
#include <string_view>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr int kDigits = 9;
/// MuJoCo draws the groups up to this one unless it is told otherwise; models have what only collides in the next one.
constexpr int kLastDrawnGroup = 2;
constexpr const char* kCollisionGroup = "3";
constexpr double kTinyVolume = 1e-12;  // [m^3] MuJoCo refuses solid meshes below a thousandth of it

/// A mesh asset.
struct Asset {
  int mesh = -1;        ///< in RobotFile::meshes; -1: it has no faces to divide
  std::string rawName;  ///< for the names of its hulls
  XmlEdits placed;      ///< scale, refpos and refquat as they hold, of its hulls too
  Affine3 geomFromMesh = Affine3::Identity();
  MjcfElement element = {};
  std::string file = {};  ///< as it is named; empty: the mesh is in the element, or made by MuJoCo
};

/// A geom that is replaced.
struct Replaced {
  MjcfElement element;
  std::string name, asset;
  bool drawn = false;   ///< in a group that is drawn
  bool weighs = false;  ///< it has a mass if its body takes mass from geoms
};

struct MjcfBody {
  bool inertial = false;
  std::set<std::string> shown;  ///< meshes that it draws and does not collide with
};

/// What shapes take the place of.
struct MjcfModel {
  std::map<std::string, Asset> assets;
  std::vector<MjcfElement> pairs;
  std::vector<MjcfBody> bodies;    ///< as links
  std::vector<Replaced> replaced;  ///< as geoms
};

/// Puts other shapes in the place of collision meshes.
class ShapeWriter {
 public:
  ShapeWriter(MjcfTree& tree, const MjcfModel& model, RobotFile& robot, const RobotShapes& shapes)
      : tree_(tree), model_(model), robot_(robot), shapes_(shapes) {}

  Result<void> write() {
    addHulls();
    for (std::size_t g = 0; g < robot_.geoms.size(); ++g) LORICA_TRY_DO(replaceGeom(g));
    if (massive_ > 0) {
      robot_.notes.push_back(fmt::format(
          "{} geoms give their bodies mass: they stay, without collisions, so that MuJoCo finds the same inertia.",
          massive_));
    }
    for (const MjcfElement& pair : model_.pairs) LORICA_TRY_DO(replacePair(pair));
    return {};
  }

 private:
  static std::string freshName(std::string name, std::set<std::string>& taken) {
    while (!taken.insert(name).second) name += "_";
    return name;
  }

  /// Adds the hulls of all assets that are replaced to the model.
  void addHulls() {
    std::string text;
    for (const Replaced& each : model_.replaced) {
      const Asset& asset = model_.assets.at(each.asset);
      if (!shapes_.capsules.empty() || hullNames_.contains(each.asset)) continue;
      std::vector<std::string>& own = hullNames_[each.asset];
      const double share = std::abs(asset.geomFromMesh.linear().determinant());
      for (const TriMesh& hull : shapes_.hulls[asset.mesh]) {
        own.push_back(freshName(fmt::format("{}_hull_{}", asset.rawName, own.size()), tree_.meshNames));
        XmlEdits edits = asset.placed;
        // Of the default class, which may scale.
        const auto isScale = [](const auto& edit) { return edit.first == "scale"; };
        if (std::ranges::none_of(edits, isScale)) edits.emplace_back("scale", "1 1 1");
        if (share * signedVolume(hull.vertices, hull.triangles) < kTinyVolume) edits.emplace_back("inertia", "shell");
        std::string vertices;
        for (const Vec3& p : hull.vertices) vertices += written(p, kDigits) + " ";
        vertices.pop_back();
        edits.insert(edits.begin(), {{"name", own.back()}, {"vertex", vertices}});
        text += "    " + editedElement("<mesh/>", edits) + "\n";
      }
    }
    if (!text.empty()) {
      tree_.xml(tree_.root()).append(tree_.root().node, "\n  <asset>\n" + text + "  </asset>\n");
    }
  }

  Result<void> replaceGeom(std::size_t index) {
    const Replaced& each = model_.replaced[index];
    const RobotGeom& geom = robot_.geoms[index];
    XmlText& xml = tree_.xml(each.element);
    const MjcfBody& body = model_.bodies[geom.link];
    const bool inferred = !body.inertial || tree_.setting("inertiafromgeom", "auto") == "true";
    const bool massive =
        geom.link != 0 && inferred && each.weighs && tree_.setting("inertiafromgeom", "auto") != "false";
    const bool used = !each.name.empty() && tree_.usedNames.contains(each.name);
    const bool shown = each.drawn && !body.shown.contains(each.asset);
    if (used) {
      robot_.notes.push_back(
          fmt::format("The geom '{}' is used by its name: it stays, without collisions.", each.name));
    }
    const std::string_view original = xml.textOf(each.element.node);
    std::vector<std::string> texts;
    if (massive || used || shown) {
      texts.push_back(editedElement(original, {{"contype", "0"}, {"conaffinity", "0"}}));
    }
    XmlEdits common = {{"mass", "0"}};
    if (each.drawn && (shown || massive || used)) common.emplace_back("group", kCollisionGroup);
    const std::size_t count =
        shapes_.capsules.empty() ? hullNames_.at(each.asset).size() : shapes_.capsules[index].size();
    LORICA_TRY_DO(robot_.write(count, original.size(), tree_.where(each.element)));
    for (std::size_t k = 0; k < count; ++k) {
      XmlEdits edits = common;
      if (!each.name.empty()) {
        newNames_[each.name].push_back(freshName(fmt::format("{}_hull_{}", each.name, k), tree_.geomNames));
        edits.emplace_back("name", newNames_[each.name].back());
      }
      if (shapes_.capsules.empty()) {
        edits.emplace_back("mesh", hullNames_.at(each.asset)[k]);
      } else {
        const Capsule& capsule = shapes_.capsules[index][k];
        const Vec3 along = capsule.to - capsule.from;
        const Vec3 middle = geom.parentFromGeom * Vec3(0.5 * (capsule.from + capsule.to));
        const Quat turn(Mat3(geom.parentFromGeom.linear() * rotationBetween(Vec3::UnitZ(), along).toRotationMatrix()));
        for (const char* gone : {"mesh", "axisangle", "xyaxes", "zaxis", "euler"})
          edits.emplace_back(gone, std::nullopt);
        const double half = 0.5 * along.norm();
        const bool ball = half < 1e-6 * capsule.radius;  // MuJoCo refuses capsules without length
        edits.emplace_back("type", ball ? "sphere" : "capsule");
        edits.emplace_back("size", fmt::format("{:.9g} {:.9g}", capsule.radius, half));
        edits.emplace_back("pos", written(middle, kDigits));
        edits.emplace_back("quat", fmt::format("{:.9g} {:.9g} {:.9g} {:.9g}", turn.w(), turn.x(), turn.y(), turn.z()));
      }
      texts.push_back(editedElement(original, edits));
    }
    xml.replace(each.element.node, texts);
    massive_ += massive ? 1 : 0;
    return {};
  }

  /// A pair of geoms becomes one for all that took their places.
  Result<void> replacePair(const MjcfElement& pair) {
    const std::string names[] = {pair.text("geom1"), pair.text("geom2")};
    if (!newNames_.contains(names[0]) && !newNames_.contains(names[1])) return {};
    const auto standFor = [&](const std::string& name) {
      const auto found = newNames_.find(name);
      return found == newNames_.end() ? std::vector<std::string>{name} : found->second;
    };
    XmlText& xml = tree_.xml(pair);
    const std::vector<std::string> first = standFor(names[0]), second = standFor(names[1]);
    LORICA_TRY_DO(robot_.write(first.size() * second.size(), xml.textOf(pair.node).size(), tree_.where(pair)));
    std::vector<std::string> texts;
    for (const std::string& one : first) {
      for (const std::string& other : second) {
        XmlEdits edits = {{"geom1", one}, {"geom2", other}};
        if (!pair.text().empty()) edits.emplace_back("name", fmt::format("{}_{}", pair.text(), texts.size()));
        texts.push_back(editedElement(xml.textOf(pair.node), edits));
      }
    }
    xml.replace(pair.node, texts);
    return {};
  }

  MjcfTree& tree_;
  const MjcfModel& model_;
  RobotFile& robot_;
  const RobotShapes& shapes_;
  int massive_ = 0;                                            ///< geoms that stay because they have mass
  std::map<std::string, std::vector<std::string>> hullNames_;  ///< of assets
  std::map<std::string, std::vector<std::string>> newNames_;   ///< of geoms
};

/// Reads a model.
class MjcfFile final : public RobotFile {
 public:
  explicit MjcfFile(const RobotReading& reading) : tree_(reading) {}

  Result<void> read(const fs::path& file) {
    LORICA_TRY_DO(tree_.read(file));
    sources = tree_.sources;
    // What holds for the whole model may come behind what it holds for.
    LORICA_TRY_DO(tree_.forEachIn("asset", [&](const MjcfElement& each) {
      if (each.is("mesh")) return readAsset(each);
      if (each.is("model")) notes.emplace_back("Models that the file attaches stay as they are.");
      return Result<void>();
    }));
    LORICA_TRY_DO(tree_.forEachIn("contact", [&](const MjcfElement& each) {
      if (each.is("pair")) {
        model_.pairs.push_back(each);
        paired_.insert({each.text("geom1"), each.text("geom2")});
      }
      return Result<void>();
    }));
    links.push_back({"world"});
    model_.bodies.push_back({});
    for (const MjcfElement& each : tree_.sections("worldbody")) LORICA_TRY_DO(readBody(each, {}));
    weldLinks();
    std::map<std::string, int> byName;
    for (std::size_t i = 0; i < links.size(); ++i) byName[links[i].name] = static_cast<int>(i);
    return tree_.forEachIn("contact", [&](const MjcfElement& each) {
      const auto a = byName.find(each.text("body1"));
      const auto b = byName.find(each.text("body2"));
      if (each.is("exclude") && a != byName.end() && b != byName.end()) {
        excluded.insert(std::minmax(a->second, b->second));
      }
      return Result<void>();
    });
  }

  Result<std::vector<RobotOutput>> replaced(const fs::path& out, const RobotShapes& shapes) override {
    LORICA_TRY_DO(ShapeWriter(tree_, model_, *this, shapes).write());
    return tree_.outputs(out);
  }

 private:
  struct Context {
    int link = 0;
    std::string childclass = {};
    Isometry3 linkFromHere = Isometry3::Identity();
  };

  // Meshes.

  Result<void> readAsset(const MjcfElement& element) {
    LORICA_TRY(const std::string classOfIt, tree_.classOf(element, ""));
    const std::string file = element.text("file");
    const std::string name = element.text().empty() ? fs::path(file).stem().string() : element.text();
    Asset asset;
    asset.rawName = plainNames({name}).front();
    // What the mesh refers to is taken away, then it is scaled.
    std::vector<double> scale = {1.0, 1.0, 1.0}, from = {0.0, 0.0, 0.0}, turn = {1.0, 0.0, 0.0, 0.0};
    for (const auto& [attribute, numbers] : {std::pair("scale", &scale), {"refpos", &from}, {"refquat", &turn}}) {
      const std::optional<std::string> text = tree_.value(element, attribute, classOfIt);
      if (!text) continue;
      LORICA_TRY(*numbers, numbersOf(tree_.where(element), attribute, *text, numbers->size(), numbers->size()));
      asset.placed.emplace_back(attribute, *text);
    }
    asset.geomFromMesh = Eigen::Scaling(scale[0], scale[1], scale[2]) *
                         Quat(turn[0], turn[1], turn[2], turn[3]).normalized().conjugate() *
                         Eigen::Translation3d(-from[0], -from[1], -from[2]);
    asset.element = element;
    asset.file = file;
    if (file.empty() && element.node.attribute("vertex") && element.node.attribute("face")) {
      LORICA_TRY(TriMesh mesh, inlineMesh(element));
      asset.mesh = countOf(meshes);
      meshes.push_back({asset.rawName, tree_.where(element), {}, std::move(mesh)});
    }
    model_.assets[name] = std::move(asset);
    return {};
  }

  Result<TriMesh> inlineMesh(const MjcfElement& element) const {
    TriMesh mesh;
    LORICA_TRY(const std::vector<double> v,
               numbersOf(tree_.where(element), "vertex", element.text("vertex"), 12, kMaxXmlBytes));
    LORICA_TRY(const std::vector<double> f,
               numbersOf(tree_.where(element), "face", element.text("face"), 12, kMaxXmlBytes));
    for (std::size_t i = 0; i + 2 < v.size(); i += 3) mesh.vertices.emplace_back(v[i], v[i + 1], v[i + 2]);
    for (std::size_t i = 0; i + 2 < f.size(); i += 3) {
      Triangle t;
      for (std::size_t k = 0; k < 3; ++k) {
        if (!(f[i + k] >= 0.0 && f[i + k] < static_cast<double>(mesh.vertices.size()))) {
          return badFormat("{}: face: found vertex {:g}, expected 0 to {}", tree_.where(element), f[i + k],
                           mesh.vertices.size() - 1);
        }
        t[k] = static_cast<VertexIndex>(f[i + k]);
      }
      mesh.triangles.push_back(t);
    }
    return mesh;
  }

  /// The mesh of an asset that a geom collides with; -1: it is convex, or made by MuJoCo.
  Result<int> meshOfAsset(const std::string& name, const MjcfElement& geom) {
    const auto found = model_.assets.find(name);
    if (found == model_.assets.end()) {
      return badFormat("{}: found the mesh '{}', expected one of the assets", tree_.where(geom), printable(name, 60));
    }
    Asset& asset = found->second;
    if (asset.mesh >= 0 || asset.file.empty()) return asset.mesh;
    std::string file = asset.file;
    if (tree_.setting("strippath", "false") == "true") file = fs::path(file).filename().string();
    const std::string folder = tree_.setting("meshdir", tree_.setting("assetdir", "").c_str());
    if (!folder.empty() && !fs::path(file).is_absolute()) file = (fs::path(folder) / file).string();
    LORICA_TRY(const fs::path path, prefixed(tree_.where(asset.element), tree_.find(file)));
    LORICA_TRY(asset.mesh, meshOf(path, tree_.where(asset.element)));
    return asset.mesh;
  }

  // Bodies.

  Result<void> readBody(const MjcfElement& element, const Context& context) {
    return tree_.forEachChild(element, [&](const MjcfElement& each) -> Result<void> {
      if (each.is("inertial")) model_.bodies[context.link].inertial = true;
      if (each.is("joint") || each.is("freejoint")) links[context.link].moves = true;
      if (each.is("geom")) return readGeom(each, context);
      if (!each.is("body") && !each.is("frame") && !each.is("replicate")) return {};
      Context inside = context;
      if (const pugi::xml_attribute given = each.node.attribute("childclass")) inside.childclass = given.value();
      if (each.is("replicate")) {
        notes.push_back("Of what is replicated, contacts in the rest pose are those of the first copy.");
      } else {
        LORICA_TRY(const Isometry3 pose, tree_.poseOf(each));
        inside.linkFromHere = context.linkFromHere * pose;
      }
      if (each.is("body")) {
        RobotLink link;
        link.name = each.text().empty() ? fmt::format("body {}", links.size()) : each.text();
        link.parent = context.link;
        link.worldFromLink = links[context.link].worldFromLink * inside.linkFromHere;
        inside.link = countOf(links);
        inside.linkFromHere = Isometry3::Identity();
        links.push_back(std::move(link));
        model_.bodies.push_back({});
      }
      return readBody(each, inside);
    });
  }

  Result<void> readGeom(const MjcfElement& element, const Context& context) {
    LORICA_TRY(const std::string classOfIt, tree_.classOf(element, context.childclass));
    if (tree_.value(element, "type", classOfIt) != "mesh") return {};
    const auto number = [&](const char* name, double usual) -> Result<double> {
      const std::optional<std::string> text = tree_.value(element, name, classOfIt);
      if (!text) return usual;
      LORICA_TRY(const std::vector<double> n, numbersOf(tree_.where(element), name, *text, 1, 1));
      return n[0];
    };
    LORICA_TRY(const double contype, number("contype", 1));
    LORICA_TRY(const double conaffinity, number("conaffinity", 1));
    LORICA_TRY(const double group, number("group", 0));
    LORICA_TRY(const double density, number("density", 1000));
    LORICA_TRY(const double mass, number("mass", density));
    Replaced replaced{element, element.text(), tree_.value(element, "mesh", classOfIt).value_or("")};
    replaced.drawn = group <= kLastDrawnGroup;
    replaced.weighs = mass != 0.0;
    if (contype == 0.0 && conaffinity == 0.0 && (replaced.name.empty() || !paired_.contains(replaced.name))) {
      if (replaced.drawn) model_.bodies[context.link].shown.insert(replaced.asset);
      return {};
    }
    RobotGeom geom;
    LORICA_TRY(geom.mesh, meshOfAsset(replaced.asset, element));
    if (geom.mesh < 0) return {};  // convex as it is
    LORICA_TRY(geom.parentFromGeom, tree_.poseOf(element, classOfIt));
    geom.link = context.link;
    geom.linkFromParent = context.linkFromHere;
    geom.geomFromMesh = model_.assets[replaced.asset].geomFromMesh;
    geom.contype = static_cast<unsigned>(std::clamp(contype, 0.0, 2147483647.0));
    geom.conaffinity = static_cast<unsigned>(std::clamp(conaffinity, 0.0, 2147483647.0));
    LORICA_TRY_DO(add(geom, tree_.where(element)));
    model_.replaced.push_back(std::move(replaced));
    return {};
  }

  MjcfTree tree_;
  MjcfModel model_;
  std::set<std::string> paired_;  ///< names of geoms in pairs
};

}  // namespace

Result<std::unique_ptr<RobotFile>> readMjcf(const fs::path& file, const RobotReading& reading) {
  auto robot = std::make_unique<MjcfFile>(reading);
  LORICA_TRY_DO(robot->read(file));
  return std::unique_ptr<RobotFile>(std::move(robot));
}

}  // namespace lorica
