#include "export/robots/robot_hulls.h"

#include "acd/score.h"
#include "acd/separating_plane.h"
#include "collision/hulls/mesh_subject.h"
#include "export/robot_files.h"
#include "export/robots/robot.h"
#include "geometry/byte_reader.h"
#include "geometry/convex_hull.h"
#include "geometry/counts.h"
#include "geometry/errors.h"
#include "geometry/files.h"
#include "geometry/mesh_files.h"
#include "geometry/text.h"
#include "geometry/triangle_tree.h"
#include "geometry/work_budgets.h"
#include "skinning/import/character_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

namespace lorica {
namespace {

/// A geom's mesh and what replaces it.
struct GeomShapes {
  const TriMesh* surface = nullptr;
  const std::vector<TriMesh>* shapes = nullptr;  ///< convex
  Affine3 geomFromShapes;                        ///< which may mirror
};

struct NewContacts {
  std::vector<std::pair<int, int>> links;  ///< ascending
  bool all = true;                         ///< false: there was too much to look at
};

constexpr int kMostNear = 20'000;                   // pairs of geoms whose boxes overlap
constexpr std::size_t kMostTriangles = 50'000'000;  // of all pairs of meshes that are compared

TriMesh placed(const TriMesh& mesh, const Affine3& place) {
  TriMesh moved = mesh;
  for (Vec3& p : moved.vertices) p = place * p;
  if (place.linear().determinant() < 0.0) {
    for (Triangle& t : moved.triangles) std::swap(t[1], t[2]);
  }
  return moved;
}

bool touch(std::span<const TriMesh> a, std::span<const TriMesh> b) {
  for (const TriMesh& first : a) {
    const Aabb box = boundsOf(first.vertices);
    for (const TriMesh& second : b) {
      if (overlap(box, boundsOf(second.vertices)) && !separatingPlane(first.vertices, second.vertices)) return true;
    }
  }
  return false;
}

/// Whether two surfaces meet, or one is inside the other.
bool meet(const TriMesh& a, const TriMesh& b) {
  const TriangleTree tree(b.vertices, b.triangles);
  const TriangleTree other(a.vertices, a.triangles);
  if (tree.windingNumber(a.vertices[a.triangles[0][0]]) > 0.5) return true;
  if (other.windingNumber(b.vertices[b.triangles[0][0]]) > 0.5) return true;
  const Aabb box = boundsOf(b.vertices);
  for (const Triangle& t : a.triangles) {
    const std::array<Vec3, 3> corners{a.vertices[t[0]], a.vertices[t[1]], a.vertices[t[2]]};
    if (!overlap(boundsOf(corners), box)) continue;
    const Vec3 middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    double radius = 0.0;
    for (const Vec3& p : corners) radius = std::max(radius, (p - middle).norm());
    bool found = false;
    tree.forEachWithin(middle, radius, [&](std::int32_t i, double) {
      if (found) return;
      const Triangle& s = b.triangles[i];
      const std::array<Vec3, 3> theirs{b.vertices[s[0]], b.vertices[s[1]], b.vertices[s[2]]};
      found = !separatingPlane(corners, theirs);
    });
    if (found) return true;
  }
  return false;
}

/// Pairs of links of which shapes touch in the rest pose though their meshes do not. Links that move as one, or of
/// which one hangs on the other, are left out, as are those that the file lets pass through each other. Other shapes
/// of the links, such as boxes, are not looked at. Internal: not installed.
/// @param geoms  as those of the robot
NewContacts newContacts(const RobotFile& robot, std::span<const GeomShapes> geoms) {
  std::vector<Affine3> poses;
  std::vector<Aabb> boxes;
  for (std::size_t g = 0; g < robot.geoms.size(); ++g) {
    const RobotGeom& geom = robot.geoms[g];
    poses.push_back(Affine3(robot.links[geom.link].worldFromLink * geom.linkFromParent * geom.parentFromGeom) *
                    geoms[g].geomFromShapes);
    boxes.emplace_back();
    for (const TriMesh& shape : *geoms[g].shapes) {
      for (const Vec3& p : shape.vertices) boxes.back().extend(poses.back() * p);
    }
  }
  const auto shapesOf = [&](std::size_t g) {
    std::vector<TriMesh> there;
    for (const TriMesh& shape : *geoms[g].shapes) there.push_back(placed(shape, poses[g]));
    return there;
  };
  const auto weldOf = [&](int link) { return robot.links[link].weld; };
  const auto hangsOn = [&](int a, int b) {
    const int parent = robot.links[weldOf(a)].parent;
    return parent >= 0 && weldOf(parent) == weldOf(b);
  };
  NewContacts found;
  std::set<std::pair<int, int>> touching, meeting;
  int near = 0;
  std::size_t triangles = 0;
  for (std::size_t i = 0; i < robot.geoms.size() && found.all; ++i) {
    for (std::size_t j = i + 1; j < robot.geoms.size() && found.all; ++j) {
      const RobotGeom& a = robot.geoms[i];
      const RobotGeom& b = robot.geoms[j];
      const std::pair<int, int> pair = std::minmax(a.link, b.link);
      if (weldOf(a.link) == weldOf(b.link) || hangsOn(a.link, b.link) || hangsOn(b.link, a.link)) continue;
      if ((a.contype & b.conaffinity) == 0 && (b.contype & a.conaffinity) == 0) continue;
      if (robot.excluded.contains(pair) || meeting.contains(pair) || !overlap(boxes[i], boxes[j])) continue;
      found.all = ++near <= kMostNear && triangles <= kMostTriangles;
      if (!found.all || !touch(shapesOf(i), shapesOf(j))) continue;
      touching.insert(pair);
      triangles += geoms[i].surface->triangles.size() + geoms[j].surface->triangles.size();
      if (meet(placed(*geoms[i].surface, poses[i]), placed(*geoms[j].surface, poses[j]))) meeting.insert(pair);
    }
  }
  std::ranges::set_difference(touching, meeting, std::back_inserter(found.links));
  return found;
}

namespace fs = std::filesystem;

constexpr std::uintmax_t kTriangleBytes = 50;  // in a binary STL file

constexpr int kSegments = 48;  // of a capsule that is measured, around
constexpr int kRings = 12;     // of each of its ends

/// Samples of what is printed with three digits.
ScoreSettings measuring() {
  ScoreSettings settings;
  settings.volumeSamples = 20000;
  settings.surfaceSamples = 10000;
  settings.concavitySamples = 1;
  return settings;
}

/// A COLLADA file as robots' programs have it: metres, along the file's own axes.
Result<TriMesh> readCollada(const fs::path& file, Host& host) {
  LORICA_TRY(const std::string bytes, readFile(file, NamedBy::kFile));
  LORICA_TRY(const CharacterFile read,
             parseCharacterFile(std::as_bytes(std::span(bytes)), file.string(), host.characterFiles()));
  if (!read.isMesh()) return badMesh("{}: found a skin or motion, expected a mesh", file.string());
  TriMesh mesh = read.character.mesh;
  const Affine3& fileFromModel = read.character.jointFromModel.front();
  // The importer's own root node turns what is not Y up, by quarters of a turn.
  Mat3 ownFromYUp = Mat3::Identity();
  if (read.format == "COLLADA" && read.character.skeleton.jointCount() > 1) {
    const Mat3 yUpFromOwn = read.character.skeleton.joint(1).rest.rotation.toRotationMatrix();
    ownFromYUp = yUpFromOwn.transpose().array().round();
  }
  for (Vec3& p : mesh.vertices) p = ownFromYUp * (fileFromModel * p);
  return mesh;
}

/// MuJoCo's own binary files: how many positions, normals, texture coordinates and triangles, then all of these.
Result<TriMesh> readMsh(const fs::path& file) {
  LORICA_TRY(const std::string bytes, readFile(file, NamedBy::kFile));
  ByteReader reader(bytes, 0, file.string());
  const std::size_t positions = reader.takeCount("positions", 12), normals = reader.takeCount("normals", 12);
  const std::size_t texts = reader.takeCount("texture coordinates", 8), faces = reader.takeCount("triangles", 12);
  const std::size_t between = 12 * normals + 8 * texts, whole = 12 * positions + between + 12 * faces;
  if (reader.left() != whole) {
    reader.fail(reader.offset(), fmt::format("found {} bytes to the end, expected {}", reader.left(), whole));
  }
  if (!reader.ok()) return reader.error();
  TriMesh mesh;
  mesh.vertices.resize(positions);
  mesh.triangles.resize(faces);
  for (Vec3& p : mesh.vertices) {
    for (double& x : p) x = reader.take<float>();
    if (!p.allFinite()) reader.fail(reader.offset(), "found a position that is not finite");
  }
  reader.skip(between);
  for (Triangle& triangle : mesh.triangles) {
    for (VertexIndex& v : triangle) v = reader.takeIndex("a corner", 0, static_cast<std::int64_t>(positions));
  }
  if (!reader.ok()) return reader.error();
  return mesh;
}

Result<TriMesh> readCollisionMesh(const RobotMesh& mesh, Host& host) {
  if (mesh.file.empty()) return mesh.mesh;
  const std::string extension = lowerCase(mesh.file.extension().string());
  constexpr std::string_view kRead[] = {".obj", ".stl", ".ply", ".off", ".msh", ".dae"};
  if (std::ranges::find(kRead, extension) == std::end(kRead)) {
    return unsupported("{}: found the extension '{}', expected .obj, .stl, .ply, .off, .msh or .dae",
                       mesh.file.string(), extension);
  }
  LORICA_TRY(TriMesh read, extension == ".dae"   ? readCollada(mesh.file, host)
                           : extension == ".msh" ? readMsh(mesh.file)
                                                 : readMesh(mesh.file, NamedBy::kFile));
  if (read.triangles.empty()) return badMesh("{}: found no triangle, expected a surface", mesh.file.string());
  if (read.triangles.size() > kMaxRobotTriangles) {
    return badMesh("{}: found {} triangles, expected at most {} of a mesh that collides", mesh.file.string(),
                   grouped(countOf(read.triangles)), grouped(kMaxRobotTriangles));
  }
  return read;
}

/// A surface in an order of its own, whatever the file's: equal surfaces compare equal.
struct OrderedSurface {
  std::vector<std::array<double, 3>> points;
  std::vector<std::array<std::size_t, 3>> triangles;

  bool operator==(const OrderedSurface&) const = default;
};

/// Axes are 0 to 2; none: as it is.
constexpr std::array<int, 4> kNoneOrAxes = {-1, 0, 1, 2};

Affine3 mirroredIn(int axis) {
  Vec3 signs = Vec3::Ones();
  if (axis >= 0) signs[axis] = -1.0;
  return Affine3(Eigen::Scaling(signs));
}

OrderedSurface ordered(const TriMesh& mesh, int mirrorAxis) {
  const Affine3 mirror = mirroredIn(mirrorAxis);
  OrderedSurface surface;
  std::vector<std::array<double, 3>> all;
  for (const Vec3& p : mesh.vertices) {
    const Vec3 q = mirror * p + Vec3::Zero();  // -0 becomes 0
    all.push_back({q.x(), q.y(), q.z()});
  }
  surface.points = all;
  std::ranges::sort(surface.points);
  surface.points.erase(std::unique(surface.points.begin(), surface.points.end()), surface.points.end());
  for (Triangle t : mesh.triangles) {
    if (mirrorAxis >= 0) std::swap(t[1], t[2]);
    std::array<std::size_t, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] =
          static_cast<std::size_t>(std::ranges::lower_bound(surface.points, all[t[k]]) - surface.points.begin());
    }
    std::rotate(corners.begin(), std::ranges::min_element(corners), corners.end());
    surface.triangles.push_back(corners);
  }
  std::ranges::sort(surface.triangles);
  return surface;
}

/// A mesh that was divided, in its file's coordinates.
struct Divided {
  TriMesh surface;  ///< as the file has it
  TriMesh closed;   ///< what was divided
  std::vector<TriMesh> hulls;
  std::optional<OrderedSurface> order = {};  ///< of the surface, once it has been compared
};

/// What a mesh is of one that was divided: itself, its equal, or its mirror image.
struct MeshImage {
  std::size_t divided = 0;
  int mirrorAxis = -1;
};

/// The one of those that were divided that a surface is equal to, or the mirror image of in one of the file's axes.
/// Robots have a right leg that is their left one mirrored, as another scale or another file: both get the same hulls.
std::optional<MeshImage> imageOf(const TriMesh& surface, std::vector<Divided>& divided) {
  std::array<std::optional<OrderedSurface>, kNoneOrAxes.size()> own;
  for (std::size_t d = 0; d < divided.size(); ++d) {
    Divided& other = divided[d];
    if (other.surface.vertices.size() != surface.vertices.size()) continue;
    if (other.surface.triangles.size() != surface.triangles.size()) continue;
    if (!other.order) other.order = ordered(other.surface, -1);
    for (std::size_t i = 0; i < own.size(); ++i) {
      if (!own[i]) own[i] = ordered(surface, kNoneOrAxes[i]);
      if (*own[i] == *other.order) return MeshImage{d, kNoneOrAxes[i]};
    }
  }
  return std::nullopt;
}

Result<Divided> divide(const RobotMesh& mesh, TriMesh surface, const RobotExportOptions& options, Host& host) {
  Divided divided;
  divided.surface = std::move(surface);
  ExportSourceOptions how = options.source;
  how.input = mesh.file.string();
  if (how.parts == 0 && how.maxConcavity == 0.0) how.maxConcavity = kRobotConcavity;
  const std::string name = mesh.file.empty() ? mesh.name : mesh.file.filename().string();
  LORICA_TRY(Subject subject, meshSubject(name, divided.surface, how.reading, host));
  LORICA_TRY(const ExportSource source, divideMesh(std::move(subject), how, host));
  LORICA_TRY(PartHulls made, restHulls(source, options.budget, host));
  for (NamedMesh& each : made.objects) {
    if (!each.mesh.triangles.empty()) divided.hulls.push_back(std::move(each.mesh));
  }
  if (divided.hulls.empty()) return badMesh("{}: found a mesh without volume, expected a solid", name);
  divided.closed = source.subject.mesh;
  return divided;
}

/// A polyhedron around a capsule, larger by less than half a percent of its radius.
TriMesh around(const Capsule& capsule) {
  const Vec3 along = capsule.to - capsule.from;
  const Mat3 turn = rotationBetween(Vec3::UnitZ(), along.norm() > 0.0 ? along : Vec3::UnitZ()).toRotationMatrix();
  const double wide = std::cos(std::numbers::pi / kSegments) * std::cos(0.25 * std::numbers::pi / kRings);
  std::vector<Vec3> points;
  for (int r = 0; r <= 2 * kRings + 1; ++r) {
    const bool end = r > kRings;
    const double angle = 0.5 * std::numbers::pi * (r - kRings - (end ? 1 : 0)) / kRings;
    for (int s = 0; s < kSegments; ++s) {
      const double turned = 2.0 * std::numbers::pi * s / kSegments;
      const Vec3 out(std::cos(angle) * std::cos(turned), std::cos(angle) * std::sin(turned), std::sin(angle));
      points.push_back((end ? capsule.to : capsule.from) + capsule.radius / wide * (turn * out));
    }
  }
  const ConvexHull hull = convexHull(points);
  return {hull.vertices, hull.triangles};
}

/// A mesh as one or more geoms have it, and what replaces it; in the frame of these geoms, or its mirror image.
struct Fitted {
  std::size_t divided = 0;
  Affine3 fromMesh;
  TriMesh surface;
  std::vector<TriMesh> shapes;
  std::vector<Capsule> capsules;
  RobotLinkReport figures;
};

/// A geom's axes, of which each may point the other way: then those of all geoms that are mirror images are one.
/// @param fromMesh  into the geom's frame; becomes that into the axes @return the geom from these axes
Affine3 unmirror(Affine3& fromMesh) {
  Vec3 signs = Vec3::Ones();
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 row = fromMesh.linear().row(axis);
    for (const double x : row) {
      if (x == 0.0) continue;
      if (x < 0.0) signs[axis] = -1.0;
      break;
    }
  }
  fromMesh = Eigen::Scaling(signs) * fromMesh;
  return Affine3(Eigen::Scaling(signs));
}

Result<Fitted> fit(std::size_t index, const Affine3& fromMesh, const Divided& divided, const std::string& name,
                   bool capsules) {
  Fitted fitted{index, fromMesh, placed(divided.surface, fromMesh), {}, {}, {}};
  const TriMesh closed = placed(divided.closed, fromMesh);
  RobotLinkReport& figures = fitted.figures;
  for (const TriMesh& hull : divided.hulls) {
    TriMesh shape = placed(hull, fromMesh);
    if (capsules) {
      fitted.capsules.push_back(capsuleAround(shape.vertices));
      shape = around(fitted.capsules.back());
    }
    figures.volumes[2] += capsules ? fitted.capsules.back().volume() : signedVolume(shape.vertices, shape.triangles);
    fitted.shapes.push_back(std::move(shape));
  }
  figures.meshes = 1;
  figures.shapes = countOf(fitted.shapes);
  figures.volumes[0] = signedVolume(closed.vertices, closed.triangles);
  figures.volumes[1] = convexHullVolume(fitted.surface.vertices);
  LORICA_TRY(const Score score, prefixed(name, score(closed, fitted.shapes, measuring(), &fitted.surface)));
  figures.covered = 1.0 - score.uncoveredFraction;
  figures.standOff = {score.toSurface.mean, score.toSurface.largest};
  return fitted;
}

/// Adds the figures of a geom to those of its link.
void add(RobotLinkReport& link, const RobotLinkReport& geom) {
  const auto mean = [](double a, double ofA, double b, double ofB) { return (a * ofA + b * ofB) / (a + b); };
  link.covered = mean(link.volumes[0], link.covered, geom.volumes[0], geom.covered);
  link.standOff[0] = mean(link.shapes, link.standOff[0], geom.shapes, geom.standOff[0]);
  link.standOff[1] = std::max(link.standOff[1], geom.standOff[1]);
  for (std::size_t i = 0; i < link.volumes.size(); ++i) link.volumes[i] += geom.volumes[i];
  link.meshes += geom.meshes;
  link.shapes += geom.shapes;
}

bool isMjcf(const fs::path& file) {
  return lowerCase(file.extension().string()) == ".xml";
}

Result<std::unique_ptr<RobotFile>> readRobot(const RobotExportOptions& options, const RobotReading& reading) {
  const fs::path& input = options.source.input;
  if (lowerCase(input.extension().string()) != lowerCase(options.output.extension().string())) {
    return invalidArgument("{}: found the extension '{}', expected that of {}", options.output.string(),
                           options.output.extension().string(), input.string());
  }
  std::error_code failed;
  const fs::path from = fs::weakly_canonical(fs::absolute(input).parent_path(), failed);
  if (from != fs::weakly_canonical(fs::absolute(options.output).parent_path(), failed)) {
    return invalidArgument(
        "{}: expected a file in the folder of {}: the output lies beside the input, since both find other files from "
        "there",
        options.output.string(), input.string());
  }
  LORICA_TRY(std::unique_ptr<RobotFile> robot, isMjcf(input) ? readMjcf(input, reading) : readUrdf(input, reading));
  if (!robot->geoms.empty()) return robot;
  return badFormat("{}: found no mesh that collides and is not convex by itself, expected one to divide",
                   input.string());
}

/// Refuses names that are taken, before anything is written.
Result<void> checkNames(const std::vector<RobotOutput>& outputs, const RobotFile& robot, bool replace) {
  for (const RobotOutput& each : outputs) {
    std::error_code ignored;
    for (const fs::path& source : robot.sources) {
      if (fs::equivalent(each.file, source, ignored)) {
        return invalidArgument("{}: would replace a file of the robot, expected another name of the output",
                               each.file.string());
      }
    }
    if (!replace && fs::exists(fs::symlink_status(each.file, ignored))) {
      return invalidArgument("{}: exists already, expected a new file (or --force)", each.file.string());
    }
  }
  return {};
}

/// Writes all files, the robot's last, or none.
Result<void> writeAll(const std::vector<RobotOutput>& outputs) {
  std::vector<fs::path> made;
  Result<void> written;
  for (const RobotOutput& each : outputs) {
    std::error_code failed;
    const fs::path folder = each.file.parent_path();
    if (!folder.empty() && fs::create_directory(folder, failed)) made.push_back(folder);
    if (failed) written = unwritable("{}: cannot make this folder: {}", folder.string(), failed.message());
    if (!written) break;
    const bool isNew = !fs::exists(each.file, failed);
    const bool last = &each == &outputs.back();
    written = writeFileAtomically(each.file, each.content, last ? NamedBy::kUser : NamedBy::kLorica);
    if (!written) break;
    if (isNew) made.push_back(each.file);
  }
  std::error_code ignored;
  for (auto each = made.rbegin(); !written && each != made.rend(); ++each) fs::remove(*each, ignored);
  return written;
}

}  // namespace

std::vector<std::string> RobotLinkReport::cells() const {
  std::vector<std::string> cells = {name, std::to_string(shapes)};
  for (const double volume : volumes) cells.push_back(fmt::format("{:.3g}", 1e3 * volume));
  cells.push_back(percent(covered));
  for (const double distance : standOff) cells.push_back(millimetres(distance));
  return cells;
}

bool isRobotFile(const fs::path& file) {
  return isMjcf(file) || lowerCase(file.extension().string()) == ".urdf";
}

Result<RobotReport> exportRobot(const RobotExportOptions& options, Host& host) {
  RobotReading reading{host.paths, {}};
  for (const std::string& each : options.packages) {
    const std::size_t equals = each.find('=');
    if (equals == 0 || equals == std::string::npos) {
      return invalidArgument("--package {}: expected NAME=FOLDER", each);
    }
    reading.packages[each.substr(0, equals)] = each.substr(equals + 1);
  }
  LORICA_TRY(const std::unique_ptr<RobotFile> robot, readRobot(options, reading));

  // Each mesh once, and its mirror image with it, then as its geoms have it.
  std::vector<Divided> divided;
  std::vector<MeshImage> images;
  std::size_t triangles = 0;
  const auto tooMany = [](const std::string& where) {
    return badMesh("{}: with this mesh there are more than {} triangles, expected at most that", where,
                   grouped(kMaxTriangles));
  };
  std::vector<double> ends = {0.0};  // of the work, by how large each mesh is
  for (const RobotMesh& mesh : robot->meshes) {
    std::error_code unknown;
    const std::uintmax_t size =
        mesh.file.empty() ? kTriangleBytes * mesh.mesh.triangles.size() : fs::file_size(mesh.file, unknown);
    ends.push_back(ends.back() + 1.0 + (unknown ? 0.0 : double(size)));
  }
  std::optional<Stage> whole(std::in_place, host);
  for (std::size_t m = 0; m < robot->meshes.size(); ++m) {
    const Stage stage(host, ends[m] / ends.back(), ends[m + 1] / ends.back(),
                      fmt::format("mesh {} of {}", m + 1, robot->meshes.size()));
    const RobotMesh& mesh = robot->meshes[m];
    LORICA_TRY(TriMesh surface, prefixed(mesh.where, readCollisionMesh(mesh, host)));
    triangles += surface.triangles.size();
    if (triangles > kMaxTriangles) return tooMany(mesh.where);
    const std::optional<MeshImage> known = imageOf(surface, divided);
    images.push_back(known.value_or(MeshImage{divided.size(), -1}));
    if (known) continue;
    LORICA_TRY(Divided made, prefixed(mesh.where, divide(mesh, std::move(surface), options, host)));
    divided.push_back(std::move(made));
  }
  whole.reset();
  std::vector<Fitted> fits;
  std::vector<std::size_t> fitOfGeom;
  std::vector<Affine3> geomFromFit;
  for (const RobotGeom& geom : robot->geoms) {
    const auto& [index, mirrorAxis] = images[geom.mesh];
    Affine3 fromMesh = geom.geomFromMesh * mirroredIn(mirrorAxis);
    geomFromFit.push_back(unmirror(fromMesh));
    const auto isFit = [&, index = index](const Fitted& each) {
      return each.divided == index && each.fromMesh.matrix() == fromMesh.matrix();
    };
    const auto found = std::ranges::find_if(fits, isFit);
    fitOfGeom.push_back(static_cast<std::size_t>(found - fits.begin()));
    if (found != fits.end()) continue;
    if (host.cancelled()) return cancelled();
    triangles += divided[index].surface.triangles.size();
    if (triangles > 2 * kMaxTriangles) return tooMany(robot->meshes[geom.mesh].where);
    LORICA_TRY(Fitted made, fit(index, fromMesh, divided[index], robot->meshes[geom.mesh].where, options.capsules));
    fits.push_back(std::move(made));
  }

  // What became of each link.
  RobotReport report;
  report.meshes = divided.size();
  RobotShapes shapes;
  for (const MeshImage& each : images) {
    shapes.hulls.emplace_back();
    for (const TriMesh& hull : divided[each.divided].hulls) {
      shapes.hulls.back().push_back(placed(hull, mirroredIn(each.mirrorAxis)));
    }
  }
  std::vector<GeomShapes> compared;
  std::map<int, RobotLinkReport> byLink;
  for (std::size_t g = 0; g < robot->geoms.size(); ++g) {
    const Fitted& fitted = fits[fitOfGeom[g]];
    const int link = robot->geoms[g].link;
    const auto [place, isNew] = byLink.try_emplace(link, fitted.figures);
    if (!isNew) add(place->second, fitted.figures);
    place->second.name = robot->links[link].name;
    if (options.capsules) {
      shapes.capsules.push_back(fitted.capsules);
      for (Capsule& each : shapes.capsules.back()) {
        each.from = geomFromFit[g] * each.from;
        each.to = geomFromFit[g] * each.to;
      }
    }
    compared.push_back({&fitted.surface, &fitted.shapes, geomFromFit[g]});
  }
  for (auto& [link, figures] : byLink) report.links.push_back(std::move(figures));
  const NewContacts contacts = newContacts(*robot, compared);
  if (!contacts.all)
    robot->notes.emplace_back("So many meshes overlap that not all contacts in the rest pose are here.");
  for (const auto& [a, b] : contacts.links) {
    report.newContacts.emplace_back(robot->links[a].name, robot->links[b].name);
    robot->notes.push_back(fmt::format("{} and {} touch in the rest pose now, and their meshes do not.",
                                       robot->links[a].name, robot->links[b].name));
  }

  LORICA_TRY(const std::vector<RobotOutput> outputs, robot->replaced(options.output, shapes));
  LORICA_TRY_DO(checkNames(outputs, *robot, options.replace));
  if (host.cancelled()) return cancelled();
  LORICA_TRY_DO(writeAll(outputs));
  report.files = outputs.size();
  std::set<std::string> said;
  for (const std::string& note : robot->notes) {
    if (said.insert(note).second) report.notes.push_back(note);
  }
  return report;
}

}  // namespace lorica
