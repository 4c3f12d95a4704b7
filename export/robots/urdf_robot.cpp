#include "export/mesh_export.h"
#include "export/robot_files.h"
#include "export/robots/robot.h"
#include "export/robots/xml_text.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/interrupt.h"
#include "geometry/mesh_formats.h"
#include "geometry/named_file.h"
#include "geometry/text.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <system_error>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr int kUrdfDigits = 9;
constexpr std::size_t kMaxPackageXml = std::size_t{1} << 20;

Mat3 turnedBy(double roll, double pitch, double yaw) {
  return (Eigen::AngleAxisd(yaw, Vec3::UnitZ()) * Eigen::AngleAxisd(pitch, Vec3::UnitY()) *
          Eigen::AngleAxisd(roll, Vec3::UnitX()))
      .toRotationMatrix();
}

/// The `origin` of something: its pose in what it is part of.
Result<Isometry3> originOf(const XmlText& xml, pugi::xml_node element) {
  Isometry3 pose = Isometry3::Identity();
  const pugi::xml_node origin = element.child("origin");
  if (const pugi::xml_attribute xyz = origin.attribute("xyz")) {
    LORICA_TRY(const std::vector<double> n, numbersOf(xml.where(origin), "xyz", xyz.value(), 3, 3));
    pose.translation() = Vec3(n[0], n[1], n[2]);
  }
  if (const pugi::xml_attribute rpy = origin.attribute("rpy")) {
    LORICA_TRY(const std::vector<double> n, numbersOf(xml.where(origin), "rpy", rpy.value(), 3, 3));
    pose.linear() = turnedBy(n[0], n[1], n[2]);
  }
  return pose;
}

/// `<origin xyz="..." rpy="..."/>`
std::string writtenOrigin(const Isometry3& pose) {
  const Mat3 m = pose.linear();
  const double pitch = std::asin(std::clamp(-m(2, 0), -1.0, 1.0));
  const bool upright = std::abs(m(2, 0)) < 1.0 - 1e-12;  // else roll and yaw are one
  const double roll = upright ? std::atan2(m(2, 1), m(2, 2)) : 0.0;
  const double yaw = upright ? std::atan2(m(1, 0), m(0, 0)) : std::atan2(-m(0, 1), m(1, 1));
  return fmt::format("<origin xyz=\"{}\" rpy=\"{:.9g} {:.9g} {:.9g}\"/>",
                     written(Vec3(pose.translation()), kUrdfDigits), roll, pitch, yaw);
}

/// The ROS package that a folder is in, by the nearest package.xml above: its name and root; empty if there is none.
std::pair<std::string, fs::path> packageAround(const fs::path& folder) {
  constexpr int kLevels = 16;
  std::error_code failed;
  fs::path root = fs::canonical(folder.empty() ? fs::path(".") : folder, failed);
  for (int level = 0; !failed && level < kLevels; ++level, root = root.parent_path()) {
    const Result<std::string> text = readFile(root / "package.xml", NamedBy::kFile, kMaxPackageXml);
    pugi::xml_document document;
    if (text && document.load_buffer(text->data(), text->size(), pugi::parse_trim_pcdata)) {
      if (const auto name = document.child("package").child("name")) return {name.child_value(), root};
    }
    if (root == root.root_path()) break;
  }
  return {};
}

class UrdfFile final : public RobotFile {
 public:
  UrdfFile(XmlText xml, const fs::path& file, const RobotReading& reading)
      : xml_(std::move(xml)), folder_(file.parent_path()), reading_(reading), packages_(reading.packages) {
    sources.push_back(file);
    const auto [name, root] = packageAround(folder_);
    if (!name.empty()) packages_.emplace(name, around_ = root);
  }

  Result<void> read() {
    const pugi::xml_node robot = xml_.root();
    if (std::string_view(robot.name()) != "robot") {
      return badFormat("{}: found the element <{}>, expected <robot>", xml_.shown(), printable(robot.name(), 60));
    }
    for (const pugi::xml_node& child : robot.children()) {
      if (std::string_view(child.name()).starts_with("xacro:")) {
        return badFormat("{}: found a macro of xacro, expected URDF: `xacro {} > robot.urdf` makes it",
                         xml_.where(child), xml_.shown());
      }
    }
    LORICA_TRY_DO(readLinks(robot));
    for (const pugi::xml_node& link : robot.children("link")) {
      for (const pugi::xml_node& collision : link.children("collision")) {
        if (collision.child("geometry").child("mesh")) LORICA_TRY_DO(readCollision(link, collision));
      }
    }
    return {};
  }

  Result<std::vector<RobotOutput>> replaced(const fs::path& out, const RobotShapes& shapes) override {
    std::vector<std::string> given;
    for (const RobotMesh& mesh : meshes) given.push_back(mesh.name);
    const std::vector<std::string> names = plainNames(given);
    const fs::path folder = urdfFolder(out);
    std::vector<RobotOutput> made;
    for (std::size_t m = 0; m < meshes.size() && shapes.capsules.empty(); ++m) {
      for (std::size_t k = 0; k < shapes.hulls[m].size(); ++k) {
        made.push_back({folder / fmt::format("{}_hull_{}.stl", names[m], k), formatBinaryStl(shapes.hulls[m][k])});
      }
    }
    for (std::size_t g = 0; g < geoms.size(); ++g) {
      const int m = geoms[g].mesh;
      const std::size_t copies = shapes.capsules.empty() ? shapes.hulls[m].size() : 3 * shapes.capsules[g].size();
      LORICA_TRY_DO(write(copies, xml_.textOf(collisions_[g]).size(), xml_.where(collisions_[g])));
      std::vector<std::string> texts;
      if (!shapes.capsules.empty()) {
        for (const Capsule& capsule : shapes.capsules[g]) addCapsule(g, capsule, texts);
      } else {
        for (std::size_t k = 0; k < shapes.hulls[m].size(); ++k) {
          const std::string file = fmt::format("{}/{}_hull_{}.stl", folder.filename().string(), names[m], k);
          const pugi::xml_node mesh = collisions_[g].child("geometry").child("mesh");
          texts.push_back(
              withPart(g, texts.size(), mesh, editedElement(xml_.textOf(mesh), {{"filename", uriOf(file, out, g)}})));
        }
      }
      xml_.replace(collisions_[g], texts);
    }
    made.push_back({out, xml_.changedText()});
    return made;
  }

 private:
  Result<void> readLinks(pugi::xml_node robot) {
    struct Joint {
      pugi::xml_node node;
      std::string child;
    };
    std::map<std::string, std::vector<Joint>> byParent;
    std::map<std::string, bool> known, isChild;
    for (const pugi::xml_node& link : robot.children("link")) {
      if (!known.emplace(link.attribute("name").value(), true).second) {
        return badFormat("{}: found the link '{}' again, expected each once", xml_.where(link),
                         printable(link.attribute("name").value(), 60));
      }
    }
    for (const pugi::xml_node& joint : robot.children("joint")) {
      const std::string parent = joint.child("parent").attribute("link").value();
      const std::string child = joint.child("child").attribute("link").value();
      for (const std::string& name : {parent, child}) {
        if (known.contains(name)) continue;
        return badFormat("{}: found the link '{}', expected one of the robot's", xml_.where(joint),
                         printable(name, 60));
      }
      if (isChild[child]) {
        return badFormat("{}: found a second joint to '{}', expected one", xml_.where(joint), printable(child, 60));
      }
      isChild[child] = true;
      byParent[parent].push_back({joint, child});
    }
    for (const pugi::xml_node& link : robot.children("link")) {
      if (!isChild[link.attribute("name").value()]) addLink(link.attribute("name").value(), -1);
    }
    for (std::size_t i = 0; i < links.size(); ++i) {
      for (const Joint& joint : byParent[links[i].name]) {
        LORICA_TRY(const Isometry3 pose, originOf(xml_, joint.node));
        addLink(joint.child, static_cast<int>(i));
        links.back().worldFromLink = links[i].worldFromLink * pose;
        links.back().moves = std::string_view(joint.node.attribute("type").value()) != "fixed";
      }
    }
    if (links.size() != known.size()) {
      return badFormat("{}: found {} in circles of joints, expected a tree", xml_.shown(),
                       counted(std::ssize(known) - std::ssize(links), "link"));
    }
    weldLinks();
    return {};
  }

  void addLink(const std::string& name, int parent) {
    byName_[name] = countOf(links);
    links.push_back({name, parent});
  }

  Result<void> readCollision(pugi::xml_node link, pugi::xml_node collision) {
    const pugi::xml_node mesh = collision.child("geometry").child("mesh");
    const std::string where = xml_.where(mesh);
    RobotGeom geom;
    geom.link = byName_.at(link.attribute("name").value());
    LORICA_TRY(geom.parentFromGeom, originOf(xml_, collision));
    if (const pugi::xml_attribute scale = mesh.attribute("scale")) {
      LORICA_TRY(const std::vector<double> n, numbersOf(where, "scale", scale.value(), 3, 3));
      geom.geomFromMesh = Eigen::Scaling(n[0], n[1], n[2]);
    }
    LORICA_TRY(const fs::path file, prefixed(where, fileOf(mesh.attribute("filename").value())));
    LORICA_TRY(geom.mesh, meshOf(file, where));
    LORICA_TRY_DO(add(geom, where));
    collisions_.push_back(collision);
    return {};
  }

  /// The package of a name, and what is behind it; empty if it names none.
  static std::pair<std::string, std::string> packageOf(const std::string& name) {
    for (const std::string scheme : {"package://", "model://"}) {
      if (!name.starts_with(scheme)) continue;
      const std::size_t slash = std::min(name.find('/', scheme.size()), name.size());
      return {name.substr(scheme.size(), slash - scheme.size()), name.substr(std::min(slash + 1, name.size()))};
    }
    return {};
  }

  /// A file of the robot's folder, of the package around it, or of one that is given.
  Result<fs::path> fileOf(const std::string& name) const {
    if (name.find("$(") != std::string::npos || name.find("${") != std::string::npos) {
      return badFormat("'{}' has a substitution of xacro left: `xacro {} > robot.urdf` makes it", printable(name, 120),
                       xml_.shown());
    }
    const auto [package, rest] = packageOf(name);
    if (package.empty()) {
      constexpr std::string_view kFile = "file://";
      const bool absolute = name.starts_with(kFile) && reading_.trust == PathTrust::kAnywhere;
      if (name.starts_with("../") && !around_.empty() && reading_.trust == PathTrust::kBeneath) {
        std::error_code failed;  // a mistake leads out of the package, which find() refuses
        const fs::path here = fs::canonical(folder_.empty() ? fs::path(".") : folder_, failed);
        return NamedFiles{around_}.find((here.lexically_relative(around_) / name).lexically_normal().string());
      }
      return NamedFiles{folder_, reading_.trust}.find(absolute ? name.substr(kFile.size()) : name);
    }
    const auto found = packages_.find(package);
    if (found == packages_.end()) {
      return badFormat("'{}' is in the package '{}', expected --package {}=FOLDER", printable(name, 120),
                       printable(package, 60), printable(package, 60));
    }
    return NamedFiles{found->second, reading_.trust}.find(rest);
  }

  /// How a new file is named: as its mesh was, if that was in a package that the robot's file is in too.
  std::string uriOf(const std::string& file, const fs::path& out, std::size_t geom) const {
    const std::string old = collisions_[geom].child("geometry").child("mesh").attribute("filename").value();
    const std::string package = packageOf(old).first;
    if (package.empty()) return file;
    std::error_code failed;
    const fs::path root = fs::weakly_canonical(packages_.at(package), failed);
    const fs::path here = fs::weakly_canonical(out.parent_path().empty() ? fs::path(".") : out.parent_path(), failed);
    const fs::path between = here.lexically_relative(root);
    if (failed || between.empty() || *between.begin() == "..") return file;
    return "package://" + package + "/" + (between / file).lexically_normal().string();
  }

  /// A copy of a collision element with other text in place of a part of it, and a name of its own.
  std::string withPart(std::size_t geom, std::size_t number, pugi::xml_node part, const std::string& text) const {
    const std::string_view all = xml_.textOf(collisions_[geom]);
    const std::string_view old = xml_.textOf(part);
    const std::size_t at = static_cast<std::size_t>(old.data() - all.data());
    const std::string copy = std::string(all.substr(0, at)) + text + std::string(all.substr(at + old.size()));
    const std::string name = collisions_[geom].attribute("name").value();
    return name.empty() ? copy : editedElement(copy, {{"name", fmt::format("{}_hull_{}", name, number)}});
  }

  /// URDF has no capsule: a cylinder and two balls.
  void addCapsule(std::size_t geom, const Capsule& capsule, std::vector<std::string>& texts) const {
    const Vec3 along = capsule.to - capsule.from;
    Isometry3 place = Isometry3::Identity();
    place.linear() = rotationBetween(Vec3::UnitZ(), along).toRotationMatrix();
    const std::string ball = fmt::format("<sphere radius=\"{:.9g}\"/>", capsule.radius);
    std::vector<std::pair<Vec3, std::string>> solids = {{capsule.from, ball}};
    if (along.norm() > 2e-6 * capsule.radius) {
      solids.emplace_back(capsule.to, ball);
      solids.emplace_back(0.5 * (capsule.from + capsule.to),
                          fmt::format("<cylinder radius=\"{:.9g}\" length=\"{:.9g}\"/>", capsule.radius, along.norm()));
    }
    const pugi::xml_node collision = collisions_[geom];
    for (const auto& [center, solid] : solids) {
      place.translation() = center;
      const std::string origin = writtenOrigin(geoms[geom].parentFromGeom * place);
      // The origin is replaced in the copy, where it may stand before or behind the geometry.
      std::string text = withPart(geom, texts.size(), collision.child("geometry").child("mesh"), solid);
      const std::size_t at = text.find("<origin");
      if (at != std::string::npos && collision.child("origin")) {
        const std::string old(xml_.textOf(collision.child("origin")));
        text.replace(text.find(old), old.size(), origin);
      } else {
        text.insert(text.find('>') + 1, origin);
      }
      texts.push_back(std::move(text));
    }
  }

  XmlText xml_;
  fs::path folder_;
  const RobotReading& reading_;
  std::map<std::string, fs::path> packages_;  ///< root by name: those that are given, then the one around the file
  fs::path around_;                           ///< root of that one; empty if there is none
  std::map<std::string, int> byName_;
  std::vector<pugi::xml_node> collisions_;  ///< as geoms
};

}  // namespace

Result<std::unique_ptr<RobotFile>> readUrdf(const fs::path& file, const RobotReading& reading) {
  LORICA_TRY(XmlText xml, XmlText::read(file, file.string(), NamedBy::kUser));
  auto robot = std::make_unique<UrdfFile>(std::move(xml), file, reading);
  LORICA_TRY_DO(unlessStopped(robot->read()));
  return std::unique_ptr<RobotFile>(std::move(robot));
}

}  // namespace lorica
