#include "export/robots/mjcf_tree.h"

#include "export/mesh_export.h"
#include "geometry/errors.h"
#include "geometry/interrupt.h"
#include "geometry/text.h"
#include "geometry/work_budgets.h"

#include <algorithm>
#include <cctype>
#include <numbers>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMainClass = "main";

}  // namespace

fs::path freePath(fs::path path, std::set<fs::path>& taken) {
  while (!taken.insert(path.lexically_normal()).second)
    path.replace_filename(path.stem().string() + "_" + path.extension().string());
  return path;
}

Result<void> MjcfTree::read(const fs::path& file, const std::string& shown, NamedBy by) {
  LORICA_TRY_DO(load(file, shown, by, 0));
  if (!root().is("mujoco")) {
    return badFormat("{}: found the element <{}>, expected <mujoco>", shown, printable(root().node.name(), 60));
  }
  return forEachChild(root(), [&](const MjcfElement& each) { return readSection(each); });
}

Result<fs::path> MjcfTree::find(const std::string& name) const {
  // An attached model may name what is beside its own folder, as long as it stays in the robot's.
  if (inside_.empty()) return NamedFiles{home_, reading_.trust}.find(name);
  if (reading_.trust == PathTrust::kAnywhere) return NamedFiles{home_ / inside_, reading_.trust}.find(name);
  std::string plain = name;
  std::ranges::replace(plain, '\\', '/');
  return NamedFiles{home_, reading_.trust}.find((inside_ / plain).lexically_normal().string());
}

const std::vector<MjcfElement>& MjcfTree::sections(const std::string& name) const {
  static const std::vector<MjcfElement> kNone;
  const auto found = sections_.find(name);
  return found == sections_.end() ? kNone : found->second;
}

Result<void> MjcfTree::load(const fs::path& path, const std::string& shown, NamedBy by, int level) {
  if (budget_.files > kMaxRobotIncludes) {
    return badFormat("{}: found more than {} files that are included or attached, expected at most that", shown,
                     kMaxRobotIncludes);
  }
  LORICA_TRY(XmlText xml, XmlText::read(path, shown, by));
  if (level + xml.deepest() > kMaxXmlDepth) {
    return badFormat("{}: found more than {} levels of elements, expected at most that", shown, kMaxXmlDepth);
  }
  ++budget_.files;
  budget_.bytes += xml.bytes();
  budget_.elements += xml.elements();
  if (budget_.bytes > kMaxXmlBytes || budget_.elements > kMaxXmlElements) {
    return badFormat("{}: found more than {} MiB or {} elements in all files, expected at most that", shown,
                     kMaxXmlBytes >> 20, kMaxXmlElements);
  }
  const std::size_t index = files_.size();
  files_.push_back({std::move(xml), path, level});
  sources.push_back(path);
  open_.push_back(path.lexically_normal());
  std::vector<pugi::xml_node> all = {files_[index].xml.root()};
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (workStopped()) return cancelled();
    for (const pugi::xml_node& child : all[i].children()) {
      if (child.type() != pugi::node_element) continue;
      if (std::string_view(child.name()) == "include") {
        LORICA_TRY_DO(include(index, child));
      } else {
        all.push_back(child);
        noteNames({index, child});
      }
    }
  }
  open_.pop_back();
  return {};
}

Result<void> MjcfTree::include(std::size_t from, pugi::xml_node node) {
  const std::string where = files_[from].xml.where(node);
  const std::string name = node.attribute("file").value();
  LORICA_TRY(const fs::path path, prefixed(where, find(name)));
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

void MjcfTree::noteNames(const MjcfElement& element) {
  if (element.is("mesh")) {
    const bool named = !element.text().empty();
    meshNames.insert(named ? element.text() : fs::path(element.text("file")).stem().string());
  }
  if (element.is("geom")) geomNames.insert(element.text());
  if (element.is("pair")) return;
  for (const char* attribute : {"geom", "geom1", "geom2"}) usedNames.insert(element.text(attribute));
  if (element.text("objtype") == "geom") usedNames.insert(element.text("objname"));
  if (element.text("reftype") == "geom") usedNames.insert(element.text("refname"));
}

Result<void> MjcfTree::readSection(const MjcfElement& element) {
  sections_[element.node.name()].push_back(element);
  if (element.is("default")) return readDefault(element, "");
  if (!element.is("compiler")) return {};
  for (const pugi::xml_attribute& a : element.node.attributes()) compiler_[a.name()] = a.value();
  return {};
}

Result<void> MjcfTree::readDefault(const MjcfElement& element, const std::string& parent) {
  std::string name = element.text("class");
  if (parent.empty()) {
    // All at the top are one.
    if (root_.empty()) root_ = name.empty() ? kMainClass : name;
    name = root_;
  } else if (name.empty()) {
    return badFormat("{}: found a default class without a name, expected class=\"NAME\"", where(element));
  }
  if (!parent.empty() && defaults_.contains(name)) {
    return badFormat("{}: found the default class '{}' again, expected each once", where(element), printable(name, 60));
  }
  defaults_[name].parent = parent;
  return forEachChild(element, [&](const MjcfElement& each) -> Result<void> {
    if (each.is("default")) return readDefault(each, name);
    for (const pugi::xml_attribute& a : each.node.attributes()) {
      defaults_[name].values[std::string(each.node.name()) + ' ' + a.name()] = a.value();
    }
    return {};
  });
}

std::optional<std::string> MjcfTree::value(const MjcfElement& element, const std::string& name,
                                           const std::string& classOf) const {
  if (const pugi::xml_attribute own = element.node.attribute(name.c_str())) return own.value();
  for (auto it = defaults_.find(classOf); it != defaults_.end(); it = defaults_.find(it->second.parent)) {
    const auto found = it->second.values.find(std::string(element.node.name()) + ' ' + name);
    if (found != it->second.values.end()) return found->second;
  }
  return std::nullopt;
}

Result<std::string> MjcfTree::classOf(const MjcfElement& element, const std::string& childclass) const {
  const pugi::xml_attribute own = element.node.attribute("class");
  std::string name = own ? own.value() : childclass.empty() ? root_ : childclass;
  if (!name.empty() && name != kMainClass && !defaults_.contains(name)) {
    return badFormat("{}: found the class '{}', expected one of the defaults", where(element), printable(name, 60));
  }
  return name;
}

std::string MjcfTree::setting(const char* name, const char* usual) const {
  const auto found = compiler_.find(name);
  return found == compiler_.end() ? usual : found->second;
}

Result<Isometry3> MjcfTree::poseOf(const MjcfElement& element, const std::string& classOfIt) const {
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

bool MjcfTree::changed() const {
  return std::ranges::any_of(files_, [](const File& file) { return file.xml.changed(); });
}

std::vector<RobotOutput> MjcfTree::outputs(const fs::path& out, std::set<fs::path>& taken) {
  // Included files that changed, or include one that did, get names beside the first; then the names are replaced.
  std::vector<std::string> given;
  for (const File& file : files_) given.push_back(out.stem().string() + "_" + file.path.filename().string());
  const std::vector<std::string> names = plainNames(given);
  std::vector<RobotOutput> made;
  // Included files come behind the ones that include them.
  for (std::size_t i = files_.size(); i-- > 1;) {
    if (!files_[i].xml.changed()) continue;
    const fs::path path = freePath(out.parent_path() / names[i], taken);
    made.push_back({path, files_[i].xml.changedText()});
    for (const auto& [node, index] : includes_) {
      if (index != i) continue;
      const pugi::xml_node element(node);
      for (File& file : files_) {
        if (file.xml.root().root() != element.root()) continue;
        file.xml.replace(element, {editedElement(file.xml.textOf(element), {{"file", path.filename().string()}})});
      }
    }
  }
  made.push_back({out, files_.front().xml.changedText()});
  return made;
}

}  // namespace lorica
