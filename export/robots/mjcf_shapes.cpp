#include "export/mesh_export.h"
#include "export/robots/mjcf_model.h"
#include "geometry/errors.h"
#include "geometry/mesh_formats.h"
#include "geometry/text.h"

#include <algorithm>
#include <string_view>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr int kMjcfDigits = 9;
constexpr const char* kCollisionGroup = "3";  // the first that MuJoCo does not draw
constexpr double kTinyVolume = 1e-12;         // [m^3] MuJoCo refuses solid meshes below a thousandth of it

std::string freshName(std::string name, std::set<std::string>& taken) {
  while (!taken.insert(name).second) name += "_";
  return name;
}

/// Puts other shapes in the place of collision meshes. An attached model is changed in its own file, once for all
/// places where it is: its compiler's settings, defaults and assets hold there as before.
class ShapeWriter {
 public:
  ShapeWriter(MjcfRobot& mjcf, RobotFile& robot, const RobotShapes& shapes)
      : mjcf_(mjcf), robot_(robot), shapes_(shapes) {}

  Result<void> write() {
    LORICA_TRY_DO(takeNamesAround());
    addHulls();
    std::map<pugi::xml_node_struct*, std::vector<std::size_t>> geomsOf;
    for (std::size_t g = 0; g < mjcf_.geoms.size(); ++g) {
      geomsOf[mjcf_.geoms[g].element.node.internal_object()].push_back(g);
    }
    for (std::size_t g = 0; g < mjcf_.geoms.size(); ++g) {
      const std::vector<std::size_t>& same = geomsOf[mjcf_.geoms[g].element.node.internal_object()];
      if (same.front() == g) LORICA_TRY_DO(replaceGeom(same));
    }
    if (massive_ > 0) {
      robot_.notes.push_back(
          fmt::format("{} mass: {}, without collisions, so that MuJoCo finds the same inertia.",
                      massive_ == 1 ? "1 geom gives its body" : counted(massive_, "geom") + " give their bodies",
                      massive_ == 1 ? "it stays" : "they stay"));
    }
    for (int m = 0; m < static_cast<int>(mjcf_.models.size()); ++m) {
      for (const MjcfElement& pair : mjcf_.models[m].pairs) LORICA_TRY_DO(replacePair(m, pair));
    }
    return {};
  }

 private:
  MjcfTree& tree(int model) { return mjcf_.models[model].tree; }

  /// A new name must be free in the models around too, where it has a prefix.
  Result<void> takeNamesAround() {
    for (int place = 1; place < static_cast<int>(mjcf_.places.size()); ++place) {
      MjcfTree& own = tree(mjcf_.modelAt(place));
      Result<void> good;
      mjcf_.forEachAround(place, [&](int around, const std::string& prefix) {
        if (around == mjcf_.modelAt(place)) return;
        for (std::set<std::string> MjcfTree::*names : {&MjcfTree::meshNames, &MjcfTree::geomNames}) {
          const std::set<std::string>& theirs = tree(around).*names;
          for (auto at = theirs.lower_bound(prefix); good && at != theirs.end() && at->starts_with(prefix); ++at) {
            (own.*names).insert(at->substr(prefix.size()));
            good = robot_.write(1, at->size(), own.where(own.root()));
          }
        }
      });
      LORICA_TRY_DO(good);
    }
    return {};
  }

  /// Adds the hulls of all assets that are replaced to their models.
  void addHulls() {
    std::map<int, std::string> texts;
    for (const MjcfGeom& each : mjcf_.geoms) {
      const int model = mjcf_.modelAt(each.place);
      const MjcfAsset& asset = mjcf_.models[model].assets.at(each.asset);
      if (!shapes_.capsules.empty() || hullNames_.contains({model, each.asset})) continue;
      std::vector<std::string>& own = hullNames_[{model, each.asset}];
      const double share = std::abs(asset.geomFromMesh.linear().determinant());
      for (const TriMesh& hull : shapes_.hulls[asset.mesh]) {
        own.push_back(freshName(fmt::format("{}_hull_{}", asset.rawName, own.size()), tree(model).meshNames));
        XmlEdits edits = asset.placed;
        // Of the default class, which may scale.
        const auto isScale = [](const auto& edit) { return edit.first == "scale"; };
        if (std::ranges::none_of(edits, isScale)) edits.emplace_back("scale", "1 1 1");
        if (share * signedVolume(hull.vertices, hull.triangles) < kTinyVolume) edits.emplace_back("inertia", "shell");
        std::string vertices;
        for (const Vec3& p : hull.vertices) vertices += written(p, kMjcfDigits) + " ";
        vertices.pop_back();
        edits.insert(edits.begin(), {{"name", own.back()}, {"vertex", vertices}});
        texts[model] += "    " + editedElement("<mesh/>", edits) + "\n";
      }
    }
    for (const auto& [model, text] : texts) {
      const MjcfElement root = tree(model).root();
      tree(model).xml(root).append(root.node, "\n  <asset>\n" + text + "  </asset>\n");
    }
  }

  /// Whether a geom gives its body mass in the place where it is.
  [[nodiscard]] bool isMassive(std::size_t geom) const {
    const MjcfBody& body = mjcf_.bodies[robot_.geoms[geom].link];
    const bool inferred = !body.inertial || body.massFrom == "true";
    return robot_.geoms[geom].link != 0 && inferred && mjcf_.geoms[geom].weighs && body.massFrom != "false";
  }

  /// Whether something else than a pair names a geom, in its model or one around.
  [[nodiscard]] bool isUsed(std::size_t geom) const {
    const MjcfGeom& each = mjcf_.geoms[geom];
    bool used = false;
    if (each.name.empty()) return used;
    mjcf_.forEachAround(each.place, [&](int model, const std::string& prefix) {
      used |= mjcf_.models[model].tree.usedNames.contains(prefix + each.name);
    });
    return used;
  }

  [[nodiscard]] bool isShown(std::size_t geom) const {
    const MjcfGeom& each = mjcf_.geoms[geom];
    const MjcfBody& body = mjcf_.bodies[robot_.geoms[geom].link];
    return each.drawn && !body.shown.contains({mjcf_.modelAt(each.place), each.asset});
  }

  /// @param same  geoms of one element, in all places where its model is
  Result<void> replaceGeom(const std::vector<std::size_t>& same) {
    const std::size_t index = same.front();
    const MjcfGeom& each = mjcf_.geoms[index];
    const RobotGeom& geom = robot_.geoms[index];
    const int model = mjcf_.modelAt(each.place);
    XmlText& xml = tree(model).xml(each.element);
    const auto any = [&](bool (ShapeWriter::*is)(std::size_t) const) {
      return std::ranges::any_of(same, [&](std::size_t g) { return (this->*is)(g); });
    };
    const bool massive = any(&ShapeWriter::isMassive), used = any(&ShapeWriter::isUsed);
    const bool shown = any(&ShapeWriter::isShown);
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
        shapes_.capsules.empty() ? hullNames_.at({model, each.asset}).size() : shapes_.capsules[index].size();
    LORICA_TRY_DO(robot_.write(count, original.size(), tree(model).where(each.element)));
    std::vector<std::string> names;
    for (std::size_t k = 0; k < count; ++k) {
      XmlEdits edits = common;
      if (!each.name.empty()) {
        names.push_back(freshName(fmt::format("{}_hull_{}", each.name, k), tree(model).geomNames));
        edits.emplace_back("name", names.back());
      }
      if (shapes_.capsules.empty()) {
        edits.emplace_back("mesh", hullNames_.at({model, each.asset})[k]);
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
        edits.emplace_back("pos", written(middle, kMjcfDigits));
        edits.emplace_back("quat", fmt::format("{:.9g} {:.9g} {:.9g} {:.9g}", turn.w(), turn.x(), turn.y(), turn.z()));
      }
      texts.push_back(editedElement(original, edits));
    }
    xml.replace(each.element.node, texts);
    massive_ += massive ? 1 : 0;
    if (!names.empty()) LORICA_TRY_DO(noteNames(same, names));
    return {};
  }

  /// What stands for a geom by its name, wherever a pair names it.
  Result<void> noteNames(const std::vector<std::size_t>& same, const std::vector<std::string>& names) {
    const std::string& name = mjcf_.geoms[same.front()].name;
    for (const std::size_t g : same) {
      Result<void> good;
      mjcf_.forEachAround(mjcf_.geoms[g].place, [&](int model, const std::string& prefix) {
        if (!good || !mjcf_.models[model].paired.contains(prefix + name)) return;
        std::vector<std::string>& there = newNames_[{model, prefix + name}];
        there.clear();
        for (const std::string& each : names) there.push_back(prefix + each);
        good = robot_.write(names.size(), prefix.size() + name.size(), tree(model).where(tree(model).root()));
      });
      LORICA_TRY_DO(good);
    }
    return {};
  }

  /// A pair of geoms becomes one for all that took their places.
  Result<void> replacePair(int model, const MjcfElement& pair) {
    const auto standFor = [&](const std::string& name) {
      const auto found = newNames_.find({model, name});
      return found == newNames_.end() ? std::vector<std::string>{name} : found->second;
    };
    const std::string names[] = {pair.text("geom1"), pair.text("geom2")};
    if (!newNames_.contains({model, names[0]}) && !newNames_.contains({model, names[1]})) return {};
    XmlText& xml = tree(model).xml(pair);
    const std::vector<std::string> first = standFor(names[0]), second = standFor(names[1]);
    LORICA_TRY_DO(robot_.write(first.size() * second.size(), xml.textOf(pair.node).size(), tree(model).where(pair)));
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

  MjcfRobot& mjcf_;
  RobotFile& robot_;
  const RobotShapes& shapes_;
  int massive_ = 0;                                                            ///< geoms that stay for their mass
  std::map<std::pair<int, std::string>, std::vector<std::string>> hullNames_;  ///< of a model's assets
  std::map<std::pair<int, std::string>, std::vector<std::string>> newNames_;   ///< of geoms, as a model names them
};

/// Whether a file is in the folder of another one, or below it.
bool isBelow(const fs::path& file, const fs::path& home) {
  const auto folder = [](const fs::path& of) {
    std::error_code failed;
    return fs::weakly_canonical(fs::absolute(of, failed).parent_path(), failed);
  };
  const fs::path between = folder(file).lexically_relative(folder(home));
  return !between.empty() && *between.begin() != "..";
}

}  // namespace

Result<std::vector<RobotOutput>> mjcfWithShapes(MjcfRobot& mjcf, RobotFile& robot, const RobotShapes& shapes,
                                                const fs::path& out) {
  LORICA_TRY_DO(ShapeWriter(mjcf, robot, shapes).write());
  // A model that changed gets a file beside its own, since what it names is found from there.
  std::vector<RobotOutput> made;
  std::set<fs::path> taken = {out.lexically_normal()};
  for (const int m : mjcf.attachedFirst) {
    MjcfModel& model = mjcf.models[m];
    if (m != 0 && !model.tree.changed()) continue;
    fs::path file = out;
    if (m != 0) {
      if (!isBelow(model.file, out)) {
        return unsupported("{}: an attached model that changes and is outside the robot's folder, expected it there",
                           model.file.string());
      }
      const std::string name = plainNames({out.stem().string() + "_" + model.file.filename().string()}).front();
      file = freePath(model.file.parent_path() / name, taken);
    }
    for (RobotOutput& each : model.tree.outputs(file, taken)) made.push_back(std::move(each));
    for (MjcfModel& around : mjcf.models) {
      for (const auto& [element, index] : around.attachedFiles) {
        if (index != m) continue;
        std::string old = element.text("file");
        std::ranges::replace(old, '\\', '/');
        const std::string named = (fs::path(old).parent_path() / file.filename()).string();
        XmlText& xml = around.tree.xml(element);
        xml.replace(element.node, {editedElement(xml.textOf(element.node), {{"file", named}})});
      }
    }
  }
  return made;
}

}  // namespace lorica
