#include "export/mesh_export.h"
#include "export/robots/mjcf_model.h"
#include "export/robots/mjcf_tree.h"
#include "export/robots/robot.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/text.h"
#include "geometry/work_budgets.h"

#include <algorithm>
#include <optional>
#include <set>

namespace lorica {
namespace {

namespace fs = std::filesystem;

/// MuJoCo draws the groups up to this one unless it is told otherwise; models have what only collides in the next one.
constexpr int kLastDrawnGroup = 2;
constexpr std::size_t kElementBytes = 64;               // as what an element counts, wherever it is attached
constexpr std::size_t kMaxAttached = 2 * kMaxXmlBytes;  // all elements and names with their prefixes [bytes]
constexpr std::size_t kMaxPrefix = 1000;

/// Reads a model and those that it attaches.
class MjcfFile final : public RobotFile {
 public:
  explicit MjcfFile(const RobotReading& reading) : reading_(reading) {}

  Result<void> read(const fs::path& file) {
    home_ = file.parent_path();
    LORICA_TRY_DO(load(file, file.string(), NamedBy::kUser, {}));
    for (const MjcfModel& each : mjcf_.models) {
      sources.insert(sources.end(), each.tree.sources.begin(), each.tree.sources.end());
    }
    links.push_back({"world"});
    mjcf_.bodies.push_back({});
    mjcf_.places.push_back({});
    const MjcfTree& tree = mjcf_.models.front().tree;
    for (const MjcfElement& each : tree.sections("worldbody")) LORICA_TRY_DO(readBody(each, {}));
    weldLinks();
    return readExcludes();
  }

  Result<std::vector<RobotOutput>> replaced(const fs::path& out, const RobotShapes& shapes) override {
    return mjcfWithShapes(mjcf_, *this, shapes, out);
  }

 private:
  struct Context {
    int link = 0;
    int place = 0;
    int level = 0;
    std::string childclass = {};
    Isometry3 linkFromHere = Isometry3::Identity();
  };
  /// A subtree with the models that lead to it, each with the prefix that it has in the one before.
  struct Found {
    MjcfSubtree subtree;
    std::vector<std::pair<int, std::string>> models;
  };

  MjcfModel& modelOf(const Context& context) { return mjcf_.models[mjcf_.modelAt(context.place)]; }

  // Models.

  /// Reads a model's file, and those of the models that it attaches. @return its index
  Result<int> load(const fs::path& file, const std::string& shown, NamedBy by, const fs::path& inside) {
    const int index = countOf(mjcf_.models);
    mjcf_.models.push_back({MjcfTree(reading_, budget_, home_, inside), file});
    MjcfModel& model = mjcf_.models.back();
    modelOfFile_[file.lexically_normal()] = index;
    loading_.push_back(index);
    LORICA_TRY_DO(model.tree.read(file, shown, by));
    // What holds for the whole model may come behind what it holds for.
    LORICA_TRY_DO(model.tree.forEachIn("asset", [&](const MjcfElement& each) -> Result<void> {
      if (each.is("mesh")) return readAsset(model, each);
      return each.is("model") ? readModel(model, each) : Result<void>();
    }));
    LORICA_TRY_DO(model.tree.forEachIn("contact", [&](const MjcfElement& each) {
      if (each.is("exclude")) model.excludes.push_back(each);
      if (each.is("pair")) {
        model.pairs.push_back(each);
        model.paired.insert({each.text("geom1"), each.text("geom2")});
      }
      return Result<void>();
    }));
    for (const MjcfElement& each : model.tree.sections("worldbody")) LORICA_TRY_DO(listSubtrees(model, each, ""));
    loading_.pop_back();
    mjcf_.attachedFirst.push_back(index);
    return index;
  }

  Result<void> readModel(MjcfModel& around, const MjcfElement& element) {
    const std::string where = around.tree.where(element);
    std::string name = element.text("file");
    LORICA_TRY(const fs::path file, prefixed(where, around.tree.find(name)));
    std::ranges::replace(name, '\\', '/');
    auto found = modelOfFile_.find(file.lexically_normal());
    if (found == modelOfFile_.end()) {
      const fs::path inside = (around.tree.inside() / name).lexically_normal().parent_path();
      LORICA_TRY_DO(prefixed(where, load(file, printable(name, 120), NamedBy::kFile, inside)));
      found = modelOfFile_.find(file.lexically_normal());
    } else if (std::ranges::find(loading_, found->second) != loading_.end()) {
      return badFormat("{}: '{}' attaches itself, expected files that end", where, printable(name, 120));
    }
    const MjcfElement root = mjcf_.models[found->second].tree.root();
    around.attached.emplace(element.text().empty() ? root.text("model") : element.text(), found->second);
    around.attachedFiles.emplace_back(element, found->second);
    return {};
  }

  /// Lists what of a model can be attached by its name. What MuJoCo replicates gets other names.
  Result<void> listSubtrees(MjcfModel& model, const MjcfElement& around, const std::string& childclass) {
    return model.tree.forEachChild(around, [&](const MjcfElement& each) -> Result<void> {
      if (each.is("attach")) model.attaches.push_back(each);
      if (!each.is("body") && !each.is("frame")) return {};
      model.subtrees.emplace(std::string(each.node.name()) + ' ' + each.text(), MjcfSubtree{each, childclass});
      const pugi::xml_attribute own = each.node.attribute("childclass");
      return listSubtrees(model, each, own ? own.value() : childclass);
    });
  }

  /// A body or frame of a model by its name, or of one that it attaches by its name there.
  Result<std::optional<Found>> find(int model, const std::string& kind, const std::string& name) {
    const MjcfModel& in = mjcf_.models[model];
    if (const auto own = in.subtrees.find(kind + ' ' + name); own != in.subtrees.end()) {
      return std::optional(Found{own->second, {}});
    }
    for (const MjcfElement& each : in.attaches) {
      LORICA_TRY_DO(count(name.size(), in.tree, each));
      const std::string prefix = each.text("prefix");
      const auto attached = in.attached.find(each.text("model"));
      if (!name.starts_with(prefix) || attached == in.attached.end()) continue;
      LORICA_TRY(std::optional<Found> found, find(attached->second, kind, name.substr(prefix.size())));
      if (!found) continue;
      found->models.insert(found->models.begin(), {attached->second, prefix});
      return found;
    }
    return std::optional<Found>();
  }

  // Meshes.

  Result<void> readAsset(MjcfModel& model, const MjcfElement& element) {
    const MjcfTree& tree = model.tree;
    LORICA_TRY(const std::string classOfIt, tree.classOf(element, ""));
    const std::string file = element.text("file");
    const std::string name = element.text().empty() ? fs::path(file).stem().string() : element.text();
    MjcfAsset asset;
    asset.rawName = plainNames({name}).front();
    // What the mesh refers to is taken away, then it is scaled.
    std::vector<double> scale = {1.0, 1.0, 1.0}, from = {0.0, 0.0, 0.0}, turn = {1.0, 0.0, 0.0, 0.0};
    for (const auto& [attribute, numbers] : {std::pair("scale", &scale), {"refpos", &from}, {"refquat", &turn}}) {
      const std::optional<std::string> text = tree.value(element, attribute, classOfIt);
      if (!text) continue;
      LORICA_TRY(*numbers, numbersOf(tree.where(element), attribute, *text, numbers->size(), numbers->size()));
      asset.placed.emplace_back(attribute, *text);
    }
    asset.geomFromMesh = Eigen::Scaling(scale[0], scale[1], scale[2]) *
                         Quat(turn[0], turn[1], turn[2], turn[3]).normalized().conjugate() *
                         Eigen::Translation3d(-from[0], -from[1], -from[2]);
    asset.element = element;
    asset.file = file;
    model.assets[name] = std::move(asset);
    return {};
  }

  Result<TriMesh> inlineMesh(const MjcfTree& tree, const MjcfElement& element) const {
    TriMesh mesh;
    LORICA_TRY(const std::vector<double> v,
               numbersOf(tree.where(element), "vertex", element.text("vertex"), 12, kMaxXmlBytes));
    LORICA_TRY(const std::vector<double> f,
               numbersOf(tree.where(element), "face", element.text("face"), 12, kMaxXmlBytes));
    for (std::size_t i = 0; i + 2 < v.size(); i += 3) mesh.vertices.emplace_back(v[i], v[i + 1], v[i + 2]);
    for (std::size_t i = 0; i + 2 < f.size(); i += 3) {
      Triangle t;
      for (std::size_t k = 0; k < 3; ++k) {
        if (!(f[i + k] >= 0.0 && f[i + k] < static_cast<double>(mesh.vertices.size()))) {
          return badFormat("{}: face: found vertex {:g}, expected 0 to {}", tree.where(element), f[i + k],
                           mesh.vertices.size() - 1);
        }
        t[k] = static_cast<VertexIndex>(f[i + k]);
      }
      mesh.triangles.push_back(t);
    }
    return mesh;
  }

  /// The mesh of an asset that a geom collides with; -1: it is convex, or made by MuJoCo.
  Result<int> meshOfAsset(MjcfModel& model, const std::string& name, const MjcfElement& geom) {
    const MjcfTree& tree = model.tree;
    const auto found = model.assets.find(name);
    if (found == model.assets.end()) {
      return badFormat("{}: found the mesh '{}', expected one of the assets", tree.where(geom), printable(name, 60));
    }
    MjcfAsset& asset = found->second;
    if (asset.mesh >= 0) return asset.mesh;
    if (asset.file.empty()) {
      if (!asset.element.node.attribute("vertex") || !asset.element.node.attribute("face")) return -1;
      LORICA_TRY(TriMesh mesh, inlineMesh(tree, asset.element));
      asset.mesh = countOf(meshes);
      meshes.push_back({asset.rawName, tree.where(asset.element), {}, std::move(mesh)});
      return asset.mesh;
    }
    std::string file = asset.file;
    if (tree.setting("strippath", "false") == "true") file = fs::path(file).filename().string();
    const std::string folder = tree.setting("meshdir", tree.setting("assetdir", "").c_str());
    if (!folder.empty() && !fs::path(file).is_absolute()) file = (fs::path(folder) / file).string();
    LORICA_TRY(const fs::path path, prefixed(tree.where(asset.element), tree.find(file)));
    LORICA_TRY(asset.mesh, meshOf(path, tree.where(asset.element)));
    return asset.mesh;
  }

  // Bodies.

  /// Counts what is read of the robot, in every place where it is attached.
  Result<void> count(std::size_t bytes, const MjcfTree& tree, const MjcfElement& element) {
    attachedBytes_ += kElementBytes + bytes;
    if (attachedBytes_ <= kMaxAttached) return {};
    return badFormat("{}: with all that it attaches the robot has more than {} elements, expected fewer",
                     tree.where(element), grouped(kMaxAttached / kElementBytes));
  }

  Result<void> readBody(const MjcfElement& element, const Context& context) {
    return modelOf(context).tree.forEachChild(
        element, [&](const MjcfElement& each) -> Result<void> { return readElement(each, context); });
  }

  Result<void> readElement(const MjcfElement& element, const Context& context) {
    const MjcfTree& tree = modelOf(context).tree;
    LORICA_TRY_DO(count(0, tree, element));
    if (element.is("inertial")) mjcf_.bodies[context.link].inertial = true;
    if (element.is("joint") || element.is("freejoint")) links[context.link].moves = true;
    if (element.is("geom")) return readGeom(element, context);
    if (element.is("attach")) return readAttached(element, context);
    if (!element.is("body") && !element.is("frame") && !element.is("replicate")) return {};
    Context inside = context;
    if (++inside.level > kMaxXmlDepth) {
      return badFormat("{}: found more than {} levels of elements, expected at most that", tree.where(element),
                       kMaxXmlDepth);
    }
    if (const pugi::xml_attribute given = element.node.attribute("childclass")) inside.childclass = given.value();
    if (element.is("replicate")) {
      notes.push_back("Of what is replicated, contacts in the rest pose are those of the first copy.");
    } else {
      LORICA_TRY(const Isometry3 pose, tree.poseOf(element));
      inside.linkFromHere = context.linkFromHere * pose;
    }
    if (element.is("body")) {
      RobotLink link;
      link.name = element.text().empty() ? fmt::format("body {}", links.size())
                                         : mjcf_.places[context.place].whole + element.text();
      LORICA_TRY_DO(count(link.name.size(), tree, element));
      link.parent = context.link;
      link.worldFromLink = links[context.link].worldFromLink * inside.linkFromHere;
      inside.link = countOf(links);
      inside.linkFromHere = Isometry3::Identity();
      links.push_back(std::move(link));
      mjcf_.bodies.push_back({tree.setting("inertiafromgeom", "auto"), false, {}});
    }
    return readBody(element, inside);
  }

  /// A body, a frame or all of another model, or a body or frame of this one again. Its own pose holds, but none of
  /// what it is in there.
  Result<void> readAttached(const MjcfElement& element, const Context& context) {
    const MjcfModel& here = modelOf(context);
    const std::string where = here.tree.where(element);
    int model = mjcf_.modelAt(context.place);
    if (element.node.attribute("model")) {
      const auto found = here.attached.find(element.text("model"));
      if (found == here.attached.end()) {
        return badFormat("{}: found the model '{}', expected one of the assets", where,
                         printable(element.text("model"), 60));
      }
      model = found->second;
    }
    const std::string kind = element.node.attribute("body") ? "body" : element.node.attribute("frame") ? "frame" : "";
    if (kind.empty() && model == mjcf_.modelAt(context.place))
      return badFormat("{}: found neither model, body nor frame, expected one", where);
    if (std::ranges::find(attaching_, element.node) != attaching_.end()) {
      return badFormat("{}: '{}' attaches itself, expected bodies that end", where,
                       printable(element.text(kind.c_str()), 60));
    }
    Context inside = context;
    inside.childclass = "";
    LORICA_TRY_DO(enter(model, element.text("prefix"), here.tree, element, inside));
    attaching_.push_back(element.node);
    if (kind.empty()) {
      for (const MjcfElement& each : mjcf_.models[model].tree.sections("worldbody")) {
        LORICA_TRY_DO(readBody(each, inside));
      }
    } else {
      LORICA_TRY(const std::optional<Found> found, find(model, kind, element.text(kind.c_str())));
      if (found) {
        for (const auto& [next, prefix] : found->models) LORICA_TRY_DO(enter(next, prefix, here.tree, element, inside));
        inside.childclass = found->subtree.childclass;
        LORICA_TRY_DO(readElement(found->subtree.element, inside));
      } else {
        notes.push_back(fmt::format("{}: the {} '{}' is in no file: what is attached there stays as it is.", where,
                                    kind, printable(element.text(kind.c_str()), 60)));
      }
    }
    attaching_.pop_back();
    return {};
  }

  /// Makes a place for a model in that of a context. @param by  the element that attaches it
  Result<void> enter(int model, const std::string& prefix, const MjcfTree& tree, const MjcfElement& by,
                     Context& context) {
    std::string whole = mjcf_.places[context.place].whole + prefix;
    if (whole.size() > kMaxPrefix) {
      return badFormat("{}: found prefixes of {} bytes together, expected at most {}", tree.where(by), whole.size(),
                       kMaxPrefix);
    }
    if (++context.level > kMaxXmlDepth) {
      return badFormat("{}: found more than {} levels of elements, expected at most that", tree.where(by),
                       kMaxXmlDepth);
    }
    LORICA_TRY_DO(count(2 * whole.size(), tree, by));
    mjcf_.places.push_back({model, context.place, prefix, std::move(whole)});
    context.place = countOf(mjcf_.places) - 1;
    return {};
  }

  Result<void> readGeom(const MjcfElement& element, const Context& context) {
    MjcfModel& model = modelOf(context);
    const MjcfTree& tree = model.tree;
    LORICA_TRY(const std::string classOfIt, tree.classOf(element, context.childclass));
    if (tree.value(element, "type", classOfIt) != "mesh") return {};
    const auto number = [&](const char* name, double usual) -> Result<double> {
      const std::optional<std::string> text = tree.value(element, name, classOfIt);
      if (!text) return usual;
      LORICA_TRY(const std::vector<double> n, numbersOf(tree.where(element), name, *text, 1, 1));
      return n[0];
    };
    LORICA_TRY(const double contype, number("contype", 1));
    LORICA_TRY(const double conaffinity, number("conaffinity", 1));
    LORICA_TRY(const double group, number("group", 0));
    LORICA_TRY(const double density, number("density", 1000));
    LORICA_TRY(const double mass, number("mass", density));
    MjcfGeom replaced{element, element.text(), tree.value(element, "mesh", classOfIt).value_or(""), context.place};
    replaced.drawn = group <= kLastDrawnGroup;
    replaced.weighs = mass != 0.0;
    if (contype == 0.0 && conaffinity == 0.0) {
      LORICA_TRY(const bool paired, isPaired(replaced));
      if (!paired && replaced.drawn) {
        mjcf_.bodies[context.link].shown.insert({mjcf_.modelAt(context.place), replaced.asset});
      }
      if (!paired) return {};
    }
    RobotGeom geom;
    LORICA_TRY(geom.mesh, meshOfAsset(model, replaced.asset, element));
    if (geom.mesh < 0) return {};  // convex as it is
    LORICA_TRY(geom.parentFromGeom, tree.poseOf(element, classOfIt));
    geom.link = context.link;
    geom.linkFromParent = context.linkFromHere;
    geom.geomFromMesh = model.assets[replaced.asset].geomFromMesh;
    geom.contype = static_cast<unsigned>(std::clamp(contype, 0.0, 2147483647.0));
    geom.conaffinity = static_cast<unsigned>(std::clamp(conaffinity, 0.0, 2147483647.0));
    LORICA_TRY_DO(add(geom, tree.where(element)));
    mjcf_.geoms.push_back(std::move(replaced));
    return {};
  }

  /// Whether a pair names a geom, in its model or one around.
  Result<bool> isPaired(const MjcfGeom& geom) {
    bool paired = false;
    if (geom.name.empty()) return paired;
    std::size_t names = 0;
    mjcf_.forEachAround(geom.place, [&](int model, const std::string& prefix) {
      names += geom.name.size();
      paired |= mjcf_.models[model].paired.contains(prefix + geom.name);
    });
    LORICA_TRY_DO(count(names, mjcf_.models[mjcf_.modelAt(geom.place)].tree, geom.element));
    return paired;
  }

  Result<void> readExcludes() {
    std::map<std::string, int> byName;
    for (std::size_t i = 0; i < links.size(); ++i) byName[links[i].name] = static_cast<int>(i);
    for (const MjcfPlace& place : mjcf_.places) {
      const MjcfModel& model = mjcf_.models[place.model];
      for (const MjcfElement& each : model.excludes) {
        const auto a = byName.find(place.whole + each.text("body1"));
        const auto b = byName.find(place.whole + each.text("body2"));
        LORICA_TRY_DO(count(2 * place.whole.size(), model.tree, each));
        if (a != byName.end() && b != byName.end()) excluded.insert(std::minmax(a->second, b->second));
      }
    }
    return {};
  }

  const RobotReading& reading_;
  MjcfBudget budget_;
  fs::path home_;  ///< the folder of the robot's file
  MjcfRobot mjcf_;
  std::map<fs::path, int> modelOfFile_;
  std::vector<int> loading_;               ///< the models that attach the one that is read
  std::vector<pugi::xml_node> attaching_;  ///< the elements that attach what is read
  std::size_t attachedBytes_ = 0;
};

}  // namespace

Result<std::unique_ptr<RobotFile>> readMjcf(const fs::path& file, const RobotReading& reading) {
  auto robot = std::make_unique<MjcfFile>(reading);
  LORICA_TRY_DO(robot->read(file));
  return std::unique_ptr<RobotFile>(std::move(robot));
}

}  // namespace lorica
