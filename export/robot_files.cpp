#include "export/robot_files.h"

#include "export/mesh_export.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/mesh_formats.h"

#include <fmt/format.h>

namespace lorica {

namespace {

namespace fs = std::filesystem;

// A joint resists with a share of what it carries, so that a body at rest stays at rest.
constexpr double kDampingPerKg = 0.05;  // [N m s / rad / kg]
constexpr double kLeastDamping = 0.1;   // [N m s / rad]
constexpr double kArmature = 0.01;      // [kg m^2]

std::string three(const Vec3& v) {
  return written(v, 9);
}

/// The body's inertia along the axes of robotics.
Mat3 inertiaOf(const RigidBody& body) {
  return zUp(body.inertia);
}

double degrees(double radians) {
  return radians * 180.0 / 3.14159265358979323846;
}

double massBelow(const RigidModel& model, std::size_t body) {
  double mass = model.bodies[body].mass;
  for (std::size_t b = body + 1; b < model.bodies.size(); ++b) {
    if (model.bodies[b].parent == static_cast<int>(body)) mass += massBelow(model, b);
  }
  return mass;
}

class Mjcf {
 public:
  Mjcf(const RigidModel& model, MjcfMotion motion) : model_(model), motion_(motion) {}

  std::string format() {
    text_ = fmt::format("<mujoco model=\"{}\">\n  <compiler angle=\"degree\" autolimits=\"true\"/>\n", model_.name);
    // With MuJoCo's default friction, what lies on the floor creeps.
    text_ += "  <option cone=\"elliptic\" impratio=\"10\"/>\n";
    text_ += "  <asset>\n";
    for (const RigidBody& body : model_.bodies) {
      for (const NamedMesh& hull : body.hulls) addMesh(hull);
    }
    text_ += "  </asset>\n  <worldbody>\n";
    for (std::size_t b = 0; b < model_.bodies.size(); ++b) {
      if (motion_ == MjcfMotion::kMocap || model_.bodies[b].parent < 0) addBody(b, 2);
    }
    text_ += "  </worldbody>\n";
    if (motion_ == MjcfMotion::kJoints && !model_.overlapping.empty()) {
      text_ += "  <contact>\n";
      for (const auto& [a, b] : model_.overlapping) {
        text_ +=
            fmt::format("    <exclude body1=\"{}\" body2=\"{}\"/>\n", model_.bodies[a].name, model_.bodies[b].name);
      }
      text_ += "  </contact>\n";
    }
    return text_ + "</mujoco>\n";
  }

 private:
  void addMesh(const NamedMesh& hull) {
    text_ += fmt::format("    <mesh name=\"{}\" vertex=\"", hull.name);
    for (const Vec3& p : hull.mesh.vertices) text_ += three(zUp(p)) + " ";
    text_.back() = '"';
    text_ += "/>\n";
  }

  void addBody(std::size_t index, int depth) {
    const RigidBody& body = model_.bodies[index];
    const bool mocap = motion_ == MjcfMotion::kMocap;
    const bool nested = !mocap && body.parent >= 0;
    const Vec3 from = nested ? model_.bodies[body.parent].origin : Vec3(Vec3::Zero());
    const std::string indent(2 * depth, ' ');
    text_ += fmt::format("{}<body name=\"{}\" pos=\"{}\"{}>\n", indent, body.name, three(zUp(Vec3(body.origin - from))),
                         mocap ? " mocap=\"true\"" : "");
    if (!mocap) {
      if (body.parent < 0) text_ += fmt::format("{}  <freejoint name=\"{}_free\"/>\n", indent, body.name);
      const double damping = kLeastDamping + kDampingPerKg * massBelow(model_, index);
      for (const RigidHinge& hinge : body.hinges) {
        text_ += fmt::format(
            "{}  <joint name=\"{}\" axis=\"{}\" range=\"{:.9g} {:.9g}\" damping=\"{:.6g}\" armature=\"{}\"/>\n", indent,
            hinge.name, three(zUp(hinge.axis)), degrees(hinge.min), degrees(hinge.max), damping, kArmature);
      }
      const Mat3 inertia = inertiaOf(body);
      text_ += fmt::format(
          "{}  <inertial pos=\"{}\" mass=\"{:.9g}\" fullinertia=\"{:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g}\"/>\n",
          indent, three(zUp(body.center)), body.mass, inertia(0, 0), inertia(1, 1), inertia(2, 2), inertia(0, 1),
          inertia(0, 2), inertia(1, 2));
    }
    for (const NamedMesh& hull : body.hulls) {
      text_ += fmt::format("{}  <geom name=\"{}\" type=\"mesh\" mesh=\"{}\"/>\n", indent, hull.name, hull.name);
    }
    for (std::size_t b = index + 1; !mocap && b < model_.bodies.size(); ++b) {
      if (model_.bodies[b].parent == static_cast<int>(index)) addBody(b, depth + 1);
    }
    text_ += indent + "</body>\n";
  }

  const RigidModel& model_;
  MjcfMotion motion_;
  std::string text_;
};

constexpr const char* kLinkBetween =
    "  <link name=\"{}\">\n    <inertial>\n      <mass value=\"0.001\"/>\n"
    "      <inertia ixx=\"1e-5\" ixy=\"0\" ixz=\"0\" iyy=\"1e-5\" iyz=\"0\" izz=\"1e-5\"/>\n"
    "    </inertial>\n  </link>\n";

void addUrdfLink(std::string& text, const RigidBody& body, const std::string& folder) {
  const Mat3 inertia = inertiaOf(body);
  text += fmt::format(
      "  <link name=\"{}\">\n    <inertial>\n      <origin xyz=\"{}\"/>\n      <mass value=\"{:.9g}\"/>\n"
      "      <inertia ixx=\"{:.9g}\" ixy=\"{:.9g}\" ixz=\"{:.9g}\" iyy=\"{:.9g}\" iyz=\"{:.9g}\" izz=\"{:.9g}\"/>\n    "
      "</inertial>\n",
      body.name, three(zUp(body.center)), body.mass, inertia(0, 0), inertia(0, 1), inertia(0, 2), inertia(1, 1),
      inertia(1, 2), inertia(2, 2));
  for (const char* use : {"visual", "collision"}) {
    for (const NamedMesh& hull : body.hulls) {
      text += fmt::format(
          "    <{}>\n      <geometry>\n        <mesh filename=\"{}/{}.stl\"/>\n      </geometry>\n    </{}>\n", use,
          folder, hull.name, use);
    }
  }
  text += "  </link>\n";
}

/// The joints between a body and its parent, with links between them.
void addUrdfJoints(std::string& text, const RigidModel& model, std::size_t index) {
  const RigidBody& body = model.bodies[index];
  const RigidBody& parent = model.bodies[body.parent];
  const Vec3 offset = zUp(Vec3(body.origin - parent.origin));
  if (body.hinges.empty()) {
    text += fmt::format(
        "  <joint name=\"{}_fixed\" type=\"fixed\">\n    <parent link=\"{}\"/>\n    <child link=\"{}\"/>\n"
        "    <origin xyz=\"{}\"/>\n  </joint>\n",
        body.name, parent.name, body.name, three(offset));
    return;
  }
  const double damping = kLeastDamping + kDampingPerKg * massBelow(model, index);
  std::string from = parent.name;
  for (std::size_t h = 0; h < body.hinges.size(); ++h) {
    const RigidHinge& hinge = body.hinges[h];
    const bool last = h + 1 == body.hinges.size();
    const std::string to = last ? body.name : hinge.name + "_link";
    if (!last) text += fmt::format(fmt::runtime(kLinkBetween), to);
    text += fmt::format(
        "  <joint name=\"{}\" type=\"revolute\">\n    <parent link=\"{}\"/>\n    <child link=\"{}\"/>\n"
        "    <origin xyz=\"{}\"/>\n    <axis xyz=\"{}\"/>\n"
        "    <limit lower=\"{:.9g}\" upper=\"{:.9g}\" effort=\"1000\" velocity=\"100\"/>\n"
        "    <dynamics damping=\"{:.6g}\"/>\n  </joint>\n",
        hinge.name, from, to, three(h == 0 ? offset : Vec3(Vec3::Zero())), three(zUp(hinge.axis)), hinge.min, hinge.max,
        damping);
    from = to;
  }
}

}  // namespace

std::string formatMjcf(const RigidModel& model, MjcfMotion motion) {
  return Mjcf(model, motion).format();
}

Result<void> writeMjcf(const fs::path& file, const RigidModel& model, MjcfMotion motion) {
  return writeFileAtomically(file, formatMjcf(model, motion));
}

std::string formatUrdf(const RigidModel& model, const std::string& folder) {
  std::string text = fmt::format("<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n", model.name);
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    addUrdfLink(text, model.bodies[b], folder);
    if (model.bodies[b].parent >= 0) addUrdfJoints(text, model, b);
  }
  return text + "</robot>\n";
}

std::vector<UrdfMesh> urdfMeshes(const RigidModel& model, const std::string& folder) {
  std::vector<UrdfMesh> meshes;
  for (const RigidBody& body : model.bodies) {
    for (NamedMesh hull : body.hulls) {
      for (Vec3& p : hull.mesh.vertices) p = zUp(p);
      meshes.push_back({fmt::format("{}/{}.stl", folder, hull.name), formatBinaryStl(hull.mesh)});
    }
  }
  return meshes;
}

fs::path urdfFolder(const fs::path& file) {
  return file.parent_path() / plainNames({file.stem().string() + "_meshes"}).front();
}

Result<void> writeUrdf(const fs::path& file, const RigidModel& model) {
  const fs::path path = urdfFolder(file);
  const std::string folder = path.filename().string();
  std::error_code failed;
  const bool made = fs::create_directory(path, failed);
  if (failed) return unwritable("{}: cannot make this folder: {}", path.string(), failed.message());
  const Result<std::string> earlier = readFile(file);
  const std::string now = formatUrdf(model, folder);
  Result<void> written;
  for (const UrdfMesh& mesh : urdfMeshes(model, folder)) {
    written = writeFileAtomically(file.parent_path() / mesh.name, mesh.content);
    if (!written) break;
  }
  if (written) written = writeFileAtomically(file, now);
  if (!written && made) fs::remove_all(path, failed);
  if (!written || !earlier) return written;
  for (const fs::directory_entry& mesh : fs::directory_iterator(path, failed)) {
    const std::string name = "\"" + folder + "/" + mesh.path().filename().string() + "\"";
    if (earlier->find(name) != std::string::npos && now.find(name) == std::string::npos) fs::remove(mesh, failed);
  }
  return written;
}

}  // namespace lorica
