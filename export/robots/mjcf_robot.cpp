#include "export/mesh_export.h"
#include "export/robots/robot.h"
#include "export/robots/xml_text.h"
#include "geometry/convex_hull.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/mesh_formats.h"
#include "geometry/text.h"
#include "geometry/work_budgets.h"

#include <algorithm>
#include <numbers>
#include <set>
#include <string_view>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr int kDigits = 9;
constexpr const char* kMainClass = "main";
/// MuJoCo draws the groups up to this one unless it is told otherwise; models have what only collides in the next one.
constexpr int kLastDrawnGroup = 2;
constexpr const char* kCollisionGroup = "3";
constexpr double kTinyVolume = 1e-12;  // [m^3] MuJoCo refuses solid meshes below a thousandth of it

std::string named(pugi::xml_node node, const char* attribute = "name") {
  return node.attribute(attribute).value();
}

bool is(pugi::xml_node node, std::string_view name) {
  return node.name() == name;
}

/// An element and the file that it is in.
struct Element {
  std::size_t file = 0;
  pugi::xml_node node;
};

/// A mesh asset.
struct Asset {
  int mesh = -1;        ///< in RobotFile::meshes; -1: it has no faces to divide
  std::string rawName;  ///< for the names of its hulls
  XmlEdits placed;      ///< scale, refpos and refquat as they hold, of its hulls too
  Affine3 geomFromMesh = Affine3::Identity();
};

/// A geom that is replaced.
struct Replaced {
  Element element;
  std::string name, asset;
  bool drawn = false;   ///< in a group that is drawn
  bool weighs = false;  ///< it has a mass if its body takes mass from geoms
};

class MjcfFile final : public RobotFile {
 public:
  explicit MjcfFile(const RobotReading& reading) : reading_(reading) {}

  Result<void> read(const fs::path& file) {
    folder_ = file.parent_path();
    LORICA_TRY_DO(load(file, file.string(), NamedBy::kUser, 0));
    if (!is(files_.front().xml.root(), "mujoco")) {
      return badFormat("{}: found the element <{}>, expected <mujoco>", file.string(),
                       printable(files_.front().xml.root().name(), 60));
    }
    // What holds for the whole model may come behind what it holds for.
    const auto section = [&](const Element& each) { return readSection(each); };
    LORICA_TRY_DO(forEachChild({0, files_.front().xml.root()}, section));
    LORICA_TRY_DO(forEachIn("asset", [&](const Element& each) {
      if (is(each.node, "mesh")) return readAsset(each);
      if (is(each.node, "model")) notes.emplace_back("Models that the file attaches stay as they are.");
      return Result<void>();
    }));
    LORICA_TRY_DO(forEachIn("contact", [&](const Element& each) {
      if (is(each.node, "pair")) {
        pairs_.push_back(each);
        paired_.insert({named(each.node, "geom1"), named(each.node, "geom2")});
      }
      return Result<void>();
    }));
    links.push_back({"world"});
    bodies_.push_back({});
    for (const Element& each : sections_["worldbody"]) LORICA_TRY_DO(readBody(each, {}));
    weldLinks();
    std::map<std::string, int> byName;
    for (std::size_t i = 0; i < links.size(); ++i) byName[links[i].name] = static_cast<int>(i);
    return forEachIn("contact", [&](const Element& each) {
      const auto a = byName.find(named(each.node, "body1"));
      const auto b = byName.find(named(each.node, "body2"));
      if (is(each.node, "exclude") && a != byName.end() && b != byName.end()) {
        excluded.insert(std::minmax(a->second, b->second));
      }
      return Result<void>();
    });
  }

  Result<std::vector<RobotOutput>> replaced(const fs::path& out, const RobotShapes& shapes) override {
    const std::map<std::string, std::vector<std::string>> hullNames = writeHulls(shapes);
    massive_ = 0;
    for (std::size_t g = 0; g < geoms.size(); ++g) LORICA_TRY_DO(replaceGeom(g, shapes, hullNames));
    if (massive_ > 0) {
      notes.push_back(fmt::format(
          "{} geoms give their bodies mass: they stay, without collisions, so that MuJoCo finds the same inertia.",
          massive_));
    }
    for (const Element& pair : pairs_) LORICA_TRY_DO(replacePair(pair));
    return outputs(out);
  }

 private:
  struct File {
    XmlText xml;
    fs::path path;
    int level = 0;  ///< of its root in the whole
  };
  struct Body {
    bool inertial = false;
    std::set<std::string> shown;  ///< meshes that it draws and does not collide with
  };
  struct Context {
    int link = 0;
    std::string childclass = {};
    Isometry3 linkFromHere = Isometry3::Identity();
  };

  // Files.

  Result<void> load(const fs::path& path, const std::string& shown, NamedBy by, int level) {
    if (files_.size() > kMaxRobotIncludes) {
      return badFormat("{}: found more than {} included files, expected at most that", shown, kMaxRobotIncludes);
    }
    LORICA_TRY(XmlText xml, XmlText::read(path, shown, by));
    if (level + xml.deepest() > kMaxXmlDepth) {
      return badFormat("{}: found more than {} levels of elements, expected at most that", shown, kMaxXmlDepth);
    }
    bytes_ += xml.bytes();
    elements_ += xml.elements();
    if (bytes_ > kMaxXmlBytes || elements_ > kMaxXmlElements) {
      return badFormat("{}: found more than {} MiB or {} elements in all files, expected at most that", shown,
                       kMaxXmlBytes >> 20, kMaxXmlElements);
    }
    const std::size_t index = files_.size();
    files_.push_back({std::move(xml), path, level});
    sources.push_back(path);
    open_.push_back(path.lexically_normal());
    std::vector<pugi::xml_node> all = {files_[index].xml.root()};
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (const pugi::xml_node& child : all[i].children()) {
        if (child.type() != pugi::node_element) continue;
        if (is(child, "include")) {
          LORICA_TRY_DO(include(index, child));
        } else {
          all.push_back(child);
          noteNames(child);
        }
      }
    }
    open_.pop_back();
    return {};
  }

  Result<void> include(std::size_t from, pugi::xml_node node) {
    const std::string where = files_[from].xml.where(node);
    const std::string name = named(node, "file");
    LORICA_TRY(const fs::path path, prefixed(where, NamedFiles{folder_, reading_.trust}.find(name)));
    const fs::path normal = path.lexically_normal();
    if (std::ranges::find(open_, normal) != open_.end()) {
      return badFormat("{}: '{}' includes itself, expected files that end", where, printable(name, 120));
    }
    const bool again = std::ranges::any_of(files_, [&](const File& f) { return f.path.lexically_normal() == normal; });
    if (again) return badFormat("{}: '{}' is included twice, expected each file once", where, printable(name, 120));
    int level = files_[from].level;
    for (pugi::xml_node up = node.parent(); up; up = up.parent()) ++level;
    const std::size_t index = files_.size();
    LORICA_TRY_DO(prefixed(where, load(path, printable(name, 120), NamedBy::kFile, level)));
    includes_[node.internal_object()] = index;
    return {};
  }

  /// Names that other elements may not get, and names of geoms that something else than a pair refers to.
  void noteNames(pugi::xml_node node) {
    if (is(node, "mesh"))
      meshNames_.insert(named(node).empty() ? fs::path(named(node, "file")).stem().string() : named(node));
    if (is(node, "geom")) geomNames_.insert(named(node));
    if (is(node, "pair")) return;
    for (const char* attribute : {"geom", "geom1", "geom2"}) usedNames_.insert(named(node, attribute));
    if (named(node, "objtype") == "geom") usedNames_.insert(named(node, "objname"));
    if (named(node, "reftype") == "geom") usedNames_.insert(named(node, "refname"));
  }

  /// Calls visit(Element) -> Result<void> for the children of an element, those of included files in their place.
  template <typename Visit>
  Result<void> forEachChild(const Element& parent, const Visit& visit) {
    for (const pugi::xml_node& child : parent.node.children()) {
      if (child.type() != pugi::node_element) continue;
      const auto included = includes_.find(child.internal_object());
      if (included == includes_.end()) {
        LORICA_TRY_DO(visit(Element{parent.file, child}));
      } else {
        LORICA_TRY_DO(forEachChild({included->second, files_[included->second].xml.root()}, visit));
      }
    }
    return {};
  }

  /// The same for all sections of a name.
  template <typename Visit>
  Result<void> forEachIn(const std::string& section, const Visit& visit) {
    for (const Element& each : sections_[section]) LORICA_TRY_DO(forEachChild(each, visit));
    return {};
  }

  Result<void> readSection(const Element& element) {
    sections_[element.node.name()].push_back(element);
    if (is(element.node, "default")) return readDefault(element, "");
    if (!is(element.node, "compiler")) return {};
    for (const pugi::xml_attribute& a : element.node.attributes()) compiler_[a.name()] = a.value();
    return {};
  }

  std::string where(const Element& element) const { return files_[element.file].xml.where(element.node); }

  // Defaults.

  Result<void> readDefault(const Element& element, const std::string& parent) {
    std::string name = named(element.node, "class");
    if (parent.empty()) {
      // All at the top are one.
      if (root_.empty()) root_ = name.empty() ? kMainClass : name;
      name = root_;
    } else if (name.empty()) {
      return badFormat("{}: found a default class without a name, expected class=\"NAME\"", where(element));
    }
    if (!parent.empty() && defaults_.contains(name)) {
      return badFormat("{}: found the default class '{}' again, expected each once", where(element),
                       printable(name, 60));
    }
    defaults_[name].parent = parent;
    return forEachChild(element, [&](const Element& each) -> Result<void> {
      if (is(each.node, "default")) return readDefault(each, name);
      for (const pugi::xml_attribute& a : each.node.attributes()) {
        defaults_[name].values[std::string(each.node.name()) + ' ' + a.name()] = a.value();
      }
      return {};
    });
  }

  /// An attribute as it holds: the element's own, else that of its class, else that of the class around.
  std::optional<std::string> value(const Element& element, const std::string& name, const std::string& classOf) const {
    if (const pugi::xml_attribute own = element.node.attribute(name.c_str())) return own.value();
    for (auto it = defaults_.find(classOf); it != defaults_.end(); it = defaults_.find(it->second.parent)) {
      const auto found = it->second.values.find(std::string(element.node.name()) + ' ' + name);
      if (found != it->second.values.end()) return found->second;
    }
    return std::nullopt;
  }

  Result<std::string> classOf(const Element& element, const std::string& childclass) const {
    const pugi::xml_attribute own = element.node.attribute("class");
    std::string name = own ? own.value() : childclass.empty() ? root_ : childclass;
    if (!name.empty() && name != kMainClass && !defaults_.contains(name)) {
      return badFormat("{}: found the class '{}', expected one of the defaults", where(element), printable(name, 60));
    }
    return name;
  }

  std::string setting(const char* name, const char* usual) const {
    const auto found = compiler_.find(name);
    return found == compiler_.end() ? usual : found->second;
  }

  // Where things are.

  Result<Isometry3> poseOf(const Element& element, const std::string& classOfIt = "") const {
    const auto vector = [&](const char* name, std::size_t count) -> Result<std::vector<double>> {
      const std::optional<std::string> text = value(element, name, classOfIt);
      if (!text) return std::vector<double>();
      return numbersOf(where(element), name, *text, count, count);
    };
    Isometry3 pose = Isometry3::Identity();
    LORICA_TRY(const std::vector<double> pos, vector("pos", 3));
    if (!pos.empty()) pose.translation() = Vec3(pos[0], pos[1], pos[2]);
    const double radians = setting("angle", "degree") == "radian" ? 1.0 : std::numbers::pi / 180.0;
    // The first that is given by the element itself, else by its class.
    constexpr std::pair<const char*, std::size_t> kKinds[] = {
        {"quat", 4}, {"axisangle", 4}, {"xyaxes", 6}, {"zaxis", 3}, {"euler", 3}};
    const std::pair<const char*, std::size_t>* kind = nullptr;
    for (const auto& each : kKinds) {
      if (element.node.attribute(each.first)) kind = &each;
    }
    for (const auto& each : kKinds) {
      if (kind == nullptr && value(element, each.first, classOfIt)) kind = &each;
    }
    if (kind == nullptr) return pose;
    LORICA_TRY(const std::vector<double> n, vector(kind->first, kind->second));
    const std::string_view name = kind->first;
    const auto unit = [](const Vec3& v) -> Vec3 { return v.norm() > 0.0 ? Vec3(v.normalized()) : Vec3(Vec3::UnitZ()); };
    if (name == "quat") {
      const Quat q(n[0], n[1], n[2], n[3]);
      if (q.norm() > 0.0) pose.linear() = q.normalized().toRotationMatrix();
    } else if (name == "axisangle") {
      pose.linear() = Eigen::AngleAxisd(radians * n[3], unit({n[0], n[1], n[2]})).toRotationMatrix();
    } else if (name == "zaxis") {
      pose.linear() = rotationBetween(Vec3::UnitZ(), unit({n[0], n[1], n[2]})).toRotationMatrix();
    } else if (name == "xyaxes") {
      const Vec3 x = unit({n[0], n[1], n[2]});
      const Vec3 along(n[3], n[4], n[5]);
      const Vec3 y = unit(along - along.dot(x) * x);
      pose.linear() << x, y, x.cross(y);
    } else {
      const std::string order = setting("eulerseq", "xyz");
      Mat3 turn = Mat3::Identity();
      for (std::size_t i = 0; i < std::min<std::size_t>(3, order.size()); ++i) {
        const int axis = std::tolower(order[i]) - 'x';
        if (axis < 0 || axis > 2) {
          return badFormat("{}: eulerseq: found '{}', expected three of x, y, z, X, Y, Z", where(element),
                           printable(order, 60));
        }
        const Mat3 one = Eigen::AngleAxisd(radians * n[i], Vec3::Unit(axis)).toRotationMatrix();
        turn = std::islower(order[i]) != 0 ? Mat3(turn * one) : Mat3(one * turn);
      }
      pose.linear() = turn;
    }
    return pose;
  }

  // Meshes.

  Result<void> readAsset(const Element& element) {
    LORICA_TRY(const std::string classOfIt, classOf(element, ""));
    const std::string file = named(element.node, "file");
    const std::string name = named(element.node).empty() ? fs::path(file).stem().string() : named(element.node);
    Asset asset;
    asset.rawName = plainNames({name}).front();
    // What the mesh refers to is taken away, then it is scaled.
    std::vector<double> scale = {1.0, 1.0, 1.0}, from = {0.0, 0.0, 0.0}, turn = {1.0, 0.0, 0.0, 0.0};
    for (const auto& [attribute, numbers] : {std::pair("scale", &scale), {"refpos", &from}, {"refquat", &turn}}) {
      const std::optional<std::string> text = value(element, attribute, classOfIt);
      if (!text) continue;
      LORICA_TRY(*numbers, numbersOf(where(element), attribute, *text, numbers->size(), numbers->size()));
      asset.placed.emplace_back(attribute, *text);
    }
    asset.geomFromMesh = Eigen::Scaling(scale[0], scale[1], scale[2]) *
                         Quat(turn[0], turn[1], turn[2], turn[3]).normalized().conjugate() *
                         Eigen::Translation3d(-from[0], -from[1], -from[2]);
    if (!file.empty()) {
      assets_[name] = {std::move(asset), element, file};
    } else if (element.node.attribute("vertex") && element.node.attribute("face")) {
      LORICA_TRY(TriMesh mesh, inlineMesh(element));
      asset.mesh = countOf(meshes);
      meshes.push_back({asset.rawName, where(element), {}, std::move(mesh)});
      assets_[name] = {std::move(asset), element, ""};
    } else {
      assets_[name] = {std::move(asset), element, ""};
    }
    return {};
  }

  Result<TriMesh> inlineMesh(const Element& element) const {
    TriMesh mesh;
    LORICA_TRY(const std::vector<double> v,
               numbersOf(where(element), "vertex", named(element.node, "vertex"), 12, kMaxXmlBytes));
    LORICA_TRY(const std::vector<double> f,
               numbersOf(where(element), "face", named(element.node, "face"), 12, kMaxXmlBytes));
    for (std::size_t i = 0; i + 2 < v.size(); i += 3) mesh.vertices.emplace_back(v[i], v[i + 1], v[i + 2]);
    for (std::size_t i = 0; i + 2 < f.size(); i += 3) {
      Triangle t;
      for (std::size_t k = 0; k < 3; ++k) {
        if (!(f[i + k] >= 0.0 && f[i + k] < static_cast<double>(mesh.vertices.size()))) {
          return badFormat("{}: face: found vertex {:g}, expected 0 to {}", where(element), f[i + k],
                           mesh.vertices.size() - 1);
        }
        t[k] = static_cast<VertexIndex>(f[i + k]);
      }
      mesh.triangles.push_back(t);
    }
    return mesh;
  }

  /// The mesh of an asset that a geom collides with; -1: it is convex, or made by MuJoCo.
  Result<int> meshOfAsset(const std::string& name, const Element& geom) {
    const auto found = assets_.find(name);
    if (found == assets_.end()) {
      return badFormat("{}: found the mesh '{}', expected one of the assets", where(geom), printable(name, 60));
    }
    NamedAsset& named = found->second;
    if (named.asset.mesh >= 0 || named.file.empty()) return named.asset.mesh;
    std::string file = named.file;
    if (setting("strippath", "false") == "true") file = fs::path(file).filename().string();
    const std::string folder = setting("meshdir", setting("assetdir", "").c_str());
    if (!folder.empty() && !fs::path(file).is_absolute()) file = (fs::path(folder) / file).string();
    LORICA_TRY(const fs::path path, prefixed(where(named.element), NamedFiles{folder_, reading_.trust}.find(file)));
    LORICA_TRY(named.asset.mesh, meshOf(path, where(named.element)));
    return named.asset.mesh;
  }

  // Bodies.

  Result<void> readBody(const Element& element, const Context& context) {
    return forEachChild(element, [&](const Element& each) -> Result<void> {
      if (is(each.node, "inertial")) bodies_[context.link].inertial = true;
      if (is(each.node, "joint") || is(each.node, "freejoint")) links[context.link].moves = true;
      if (is(each.node, "geom")) return readGeom(each, context);
      if (!is(each.node, "body") && !is(each.node, "frame") && !is(each.node, "replicate")) return {};
      Context inside = context;
      if (const pugi::xml_attribute given = each.node.attribute("childclass")) inside.childclass = given.value();
      if (is(each.node, "replicate")) {
        notes.push_back("Of what is replicated, contacts in the rest pose are those of the first copy.");
      } else {
        LORICA_TRY(const Isometry3 pose, poseOf(each));
        inside.linkFromHere = context.linkFromHere * pose;
      }
      if (is(each.node, "body")) {
        RobotLink link;
        link.name = named(each.node).empty() ? fmt::format("body {}", links.size()) : named(each.node);
        link.parent = context.link;
        link.worldFromLink = links[context.link].worldFromLink * inside.linkFromHere;
        inside.link = countOf(links);
        inside.linkFromHere = Isometry3::Identity();
        links.push_back(std::move(link));
        bodies_.push_back({});
      }
      return readBody(each, inside);
    });
  }

  Result<void> readGeom(const Element& element, const Context& context) {
    LORICA_TRY(const std::string classOfIt, classOf(element, context.childclass));
    if (value(element, "type", classOfIt) != "mesh") return {};
    const auto number = [&](const char* name, double usual) -> Result<double> {
      const std::optional<std::string> text = value(element, name, classOfIt);
      if (!text) return usual;
      LORICA_TRY(const std::vector<double> n, numbersOf(where(element), name, *text, 1, 1));
      return n[0];
    };
    LORICA_TRY(const double contype, number("contype", 1));
    LORICA_TRY(const double conaffinity, number("conaffinity", 1));
    LORICA_TRY(const double group, number("group", 0));
    LORICA_TRY(const double density, number("density", 1000));
    LORICA_TRY(const double mass, number("mass", density));
    Replaced replaced{element, named(element.node), value(element, "mesh", classOfIt).value_or("")};
    replaced.drawn = group <= kLastDrawnGroup;
    replaced.weighs = mass != 0.0;
    if (contype == 0.0 && conaffinity == 0.0 && (replaced.name.empty() || !paired_.contains(replaced.name))) {
      if (replaced.drawn) bodies_[context.link].shown.insert(replaced.asset);
      return {};
    }
    RobotGeom geom;
    LORICA_TRY(geom.mesh, meshOfAsset(replaced.asset, element));
    if (geom.mesh < 0) return {};  // convex as it is
    LORICA_TRY(geom.parentFromGeom, poseOf(element, classOfIt));
    geom.link = context.link;
    geom.linkFromParent = context.linkFromHere;
    geom.geomFromMesh = assets_[replaced.asset].asset.geomFromMesh;
    geom.contype = static_cast<unsigned>(std::clamp(contype, 0.0, 2147483647.0));
    geom.conaffinity = static_cast<unsigned>(std::clamp(conaffinity, 0.0, 2147483647.0));
    LORICA_TRY_DO(add(geom, where(element)));
    replaced_.push_back(std::move(replaced));
    return {};
  }

  // The file with other shapes.

  static std::string freshName(const std::string& wish, std::set<std::string>& taken) {
    std::string name = wish;
    while (!taken.insert(name).second) name += "_";
    return name;
  }

  /// Adds the hulls of all assets that are replaced to the model. @return their names, by asset
  std::map<std::string, std::vector<std::string>> writeHulls(const RobotShapes& shapes) {
    std::map<std::string, std::vector<std::string>> names;
    std::string text;
    for (const Replaced& each : replaced_) {
      const Asset& asset = assets_.at(each.asset).asset;
      if (!shapes.capsules.empty() || names.contains(each.asset)) continue;
      std::vector<std::string>& own = names[each.asset];
      const double share = std::abs(asset.geomFromMesh.linear().determinant());
      for (const TriMesh& hull : shapes.hulls[asset.mesh]) {
        own.push_back(freshName(fmt::format("{}_hull_{}", asset.rawName, own.size()), meshNames_));
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
      files_.front().xml.append(files_.front().xml.root(), "\n  <asset>\n" + text + "  </asset>\n");
    }
    return names;
  }

  Result<void> replaceGeom(std::size_t index, const RobotShapes& shapes,
                           const std::map<std::string, std::vector<std::string>>& hullNames) {
    const Replaced& each = replaced_[index];
    const RobotGeom& geom = geoms[index];
    XmlText& xml = files_[each.element.file].xml;
    const Body& body = bodies_[geom.link];
    const bool inferred = !body.inertial || setting("inertiafromgeom", "auto") == "true";
    const bool massive = geom.link != 0 && inferred && each.weighs && setting("inertiafromgeom", "auto") != "false";
    const bool used = !each.name.empty() && usedNames_.contains(each.name);
    const bool shown = each.drawn && !body.shown.contains(each.asset);
    if (used) {
      notes.push_back(fmt::format("The geom '{}' is used by its name: it stays, without collisions.", each.name));
    }
    const std::string_view original = xml.textOf(each.element.node);
    std::vector<std::string> texts;
    if (massive || used || shown) {
      texts.push_back(editedElement(original, {{"contype", "0"}, {"conaffinity", "0"}}));
    }
    XmlEdits common = {{"mass", "0"}};
    if (each.drawn && (shown || massive || used)) common.emplace_back("group", kCollisionGroup);
    const std::size_t count = shapes.capsules.empty() ? hullNames.at(each.asset).size() : shapes.capsules[index].size();
    LORICA_TRY_DO(write(count, original.size(), where(each.element)));
    for (std::size_t k = 0; k < count; ++k) {
      XmlEdits edits = common;
      if (!each.name.empty()) {
        newNames_[each.name].push_back(freshName(fmt::format("{}_hull_{}", each.name, k), geomNames_));
        edits.emplace_back("name", newNames_[each.name].back());
      }
      if (shapes.capsules.empty()) {
        edits.emplace_back("mesh", hullNames.at(each.asset)[k]);
      } else {
        const Capsule& capsule = shapes.capsules[index][k];
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
  Result<void> replacePair(const Element& pair) {
    const std::string names[] = {named(pair.node, "geom1"), named(pair.node, "geom2")};
    if (!newNames_.contains(names[0]) && !newNames_.contains(names[1])) return {};
    const auto standFor = [&](const std::string& name) {
      const auto found = newNames_.find(name);
      return found == newNames_.end() ? std::vector<std::string>{name} : found->second;
    };
    XmlText& xml = files_[pair.file].xml;
    const std::vector<std::string> first = standFor(names[0]), second = standFor(names[1]);
    LORICA_TRY_DO(write(first.size() * second.size(), xml.textOf(pair.node).size(), where(pair)));
    std::vector<std::string> texts;
    for (const std::string& one : first) {
      for (const std::string& other : second) {
        XmlEdits edits = {{"geom1", one}, {"geom2", other}};
        if (!named(pair.node).empty()) edits.emplace_back("name", fmt::format("{}_{}", named(pair.node), texts.size()));
        texts.push_back(editedElement(xml.textOf(pair.node), edits));
      }
    }
    xml.replace(pair.node, texts);
    return {};
  }

  /// Included files that changed, or include one that did, get names beside the robot's; then the names are replaced.
  std::vector<RobotOutput> outputs(const fs::path& out) {
    std::vector<std::string> wishes;
    for (const File& file : files_) wishes.push_back(out.stem().string() + "_" + file.path.filename().string());
    const std::vector<std::string> names = plainNames(wishes);
    std::vector<RobotOutput> made;
    // Included files come behind the ones that include them.
    for (std::size_t i = files_.size(); i-- > 1;) {
      if (!files_[i].xml.changed()) continue;
      made.push_back({out.parent_path() / names[i], files_[i].xml.changedText()});
      for (const auto& [node, index] : includes_) {
        if (index != i) continue;
        const pugi::xml_node element(node);
        for (File& file : files_) {
          if (file.xml.root().root() != element.root()) continue;
          file.xml.replace(element, {editedElement(file.xml.textOf(element), {{"file", names[i]}})});
        }
      }
    }
    made.push_back({out, files_.front().xml.changedText()});
    return made;
  }

  struct NamedAsset {
    Asset asset;
    Element element;
    std::string file;
  };
  struct DefaultClass {
    std::string parent;
    std::map<std::string, std::string> values;  ///< "geom contype"
  };

  const RobotReading& reading_;
  fs::path folder_;
  std::vector<File> files_;
  std::size_t bytes_ = 0;       ///< of all files
  int elements_ = 0;            ///< the same
  int massive_ = 0;             ///< geoms that stay because they have mass
  std::vector<fs::path> open_;  ///< those that include the one that is read
  std::map<pugi::xml_node_struct*, std::size_t> includes_;
  std::map<std::string, std::string> compiler_;
  std::string root_;  ///< the class of all without one
  std::map<std::string, DefaultClass> defaults_;
  std::map<std::string, std::vector<Element>> sections_;  ///< by name: "asset"
  std::vector<Element> pairs_;
  std::map<std::string, NamedAsset> assets_;
  std::set<std::string> meshNames_, geomNames_, usedNames_, paired_;
  std::vector<Body> bodies_;                                  ///< as links
  std::vector<Replaced> replaced_;                            ///< as geoms
  std::map<std::string, std::vector<std::string>> newNames_;  ///< of geoms
};

}  // namespace

Result<std::unique_ptr<RobotFile>> readMjcf(const fs::path& file, const RobotReading& reading) {
  auto robot = std::make_unique<MjcfFile>(reading);
  LORICA_TRY_DO(robot->read(file));
  return std::unique_ptr<RobotFile>(std::move(robot));
}

}  // namespace lorica
