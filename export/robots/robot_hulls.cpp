#include "export/robots/robot_hulls.h"

#include "acd/score.h"
#include "acd/separating_plane.h"
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
#include "session/prepare/mesh_subject.h"
#include "skinning/import/character_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <span>
#include <utility>
#include <vector>

namespace lorica {
namespace {

/// A geom's mesh and what replaces it, in the geom's frame.
struct GeomShapes {
  const TriMesh* surface = nullptr;
  const std::vector<TriMesh>* shapes = nullptr;  ///< convex
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
  std::vector<Isometry3> poses;
  std::vector<Aabb> boxes;
  for (std::size_t g = 0; g < robot.geoms.size(); ++g) {
    const RobotGeom& geom = robot.geoms[g];
    poses.push_back(robot.links[geom.link].worldFromLink * geom.linkFromParent * geom.parentFromGeom);
    boxes.emplace_back();
    for (const TriMesh& shape : *geoms[g].shapes) {
      for (const Vec3& p : shape.vertices) boxes.back().extend(poses.back() * p);
    }
  }
  const auto shapesOf = [&](std::size_t g) {
    std::vector<TriMesh> there;
    for (const TriMesh& shape : *geoms[g].shapes) there.push_back(placed(shape, Affine3(poses[g])));
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
      if (meet(placed(*geoms[i].surface, Affine3(poses[i])), placed(*geoms[j].surface, Affine3(poses[j]))))
        meeting.insert(pair);
    }
  }
  std::ranges::set_difference(touching, meeting, std::back_inserter(found.links));
  return found;
}

namespace fs = std::filesystem;

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
  LORICA_TRY(const std::string text, readFile(file, NamedBy::kFile));
  LORICA_TRY(const CharacterFile read, readCharacterFile(file, host.characterFiles()));
  if (!read.isMesh()) return badMesh("{}: found a skin or motion, expected a mesh", file.string());
  TriMesh mesh = read.character.mesh;
  const Affine3& fileFromModel = read.character.jointFromModel.front();
  // The importer has turned what is not Y up.
  const bool xUp = text.find("<up_axis>X_UP<") != std::string::npos;
  const bool zUp = text.find("<up_axis>Z_UP<") != std::string::npos;
  for (Vec3& p : mesh.vertices) {
    p = fileFromModel * p;
    if (xUp) p = Vec3(p.y(), -p.x(), p.z());
    if (zUp) p = Vec3(p.x(), -p.z(), p.y());
  }
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

/// A mesh that was divided, in its file's coordinates.
struct Divided {
  TriMesh surface;  ///< as the file has it
  TriMesh closed;   ///< what was divided
  std::vector<TriMesh> hulls;
};

Result<Divided> divide(const RobotMesh& mesh, const RobotExportOptions& options, Host& host) {
  Divided divided;
  LORICA_TRY(divided.surface, readCollisionMesh(mesh, host));
  ExportSourceOptions how = options.source;
  how.input = mesh.file.string();
  if (how.parts == 0 && how.maxConcavity == 0.0) how.maxConcavity = kRobotConcavity;
  const std::string name = mesh.file.empty() ? mesh.name : mesh.file.filename().string();
  LORICA_TRY(Subject subject, meshSubject(name, divided.surface, how.reading, host));
  LORICA_TRY(const ExportSource source, divideMesh(std::move(subject), how, host));
  LORICA_TRY(PartHulls made, restHulls(source, options.maxVertices, host));
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

/// A mesh as one or more geoms have it, and what replaces it; in the frame of these geoms.
struct Fitted {
  int mesh = 0;
  Affine3 geomFromMesh;
  TriMesh surface;
  std::vector<TriMesh> shapes;
  std::vector<Capsule> capsules;
  RobotLinkReport figures;
};

Result<Fitted> fit(const RobotGeom& geom, const Divided& divided, const std::string& name, bool capsules) {
  Fitted fitted{geom.mesh, geom.geomFromMesh, placed(divided.surface, geom.geomFromMesh), {}, {}, {}};
  const TriMesh closed = placed(divided.closed, geom.geomFromMesh);
  RobotLinkReport& figures = fitted.figures;
  for (const TriMesh& hull : divided.hulls) {
    TriMesh shape = placed(hull, geom.geomFromMesh);
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
    return invalidArgument("{}: expected a file in the folder of {}, from where its other files are found",
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

  // Each mesh once, then as its geoms have it.
  std::vector<Divided> divided;
  std::size_t triangles = 0;
  const auto tooMany = [](const std::string& where) {
    return badMesh("{}: with this mesh there are more than {} triangles, expected at most that", where,
                   grouped(kMaxTriangles));
  };
  for (std::size_t m = 0; m < robot->meshes.size(); ++m) {
    const double count = countOf(robot->meshes);
    const Stage stage(host, m / count, (m + 1) / count);
    LORICA_TRY(Divided made, prefixed(robot->meshes[m].where, divide(robot->meshes[m], options, host)));
    triangles += made.surface.triangles.size();
    if (triangles > kMaxTriangles) return tooMany(robot->meshes[m].where);
    divided.push_back(std::move(made));
  }
  std::vector<Fitted> fits;
  std::vector<std::size_t> fitOfGeom;
  for (const RobotGeom& geom : robot->geoms) {
    const auto isFit = [&](const Fitted& each) {
      return each.mesh == geom.mesh && each.geomFromMesh.matrix() == geom.geomFromMesh.matrix();
    };
    const auto found = std::ranges::find_if(fits, isFit);
    fitOfGeom.push_back(static_cast<std::size_t>(found - fits.begin()));
    if (found != fits.end()) continue;
    if (host.cancelled()) return cancelled();
    triangles += divided[geom.mesh].surface.triangles.size();
    if (triangles > 2 * kMaxTriangles) return tooMany(robot->meshes[geom.mesh].where);
    LORICA_TRY(Fitted made, fit(geom, divided[geom.mesh], robot->meshes[geom.mesh].where, options.capsules));
    fits.push_back(std::move(made));
  }

  // What became of each link.
  RobotReport report;
  report.meshes = robot->meshes.size();
  RobotShapes shapes;
  for (Divided& each : divided) shapes.hulls.push_back(std::move(each.hulls));
  std::vector<GeomShapes> compared;
  std::map<int, RobotLinkReport> byLink;
  for (std::size_t g = 0; g < robot->geoms.size(); ++g) {
    const Fitted& fitted = fits[fitOfGeom[g]];
    const int link = robot->geoms[g].link;
    const auto [place, isNew] = byLink.try_emplace(link, fitted.figures);
    if (!isNew) add(place->second, fitted.figures);
    place->second.name = robot->links[link].name;
    if (options.capsules) shapes.capsules.push_back(fitted.capsules);
    compared.push_back({&fitted.surface, &fitted.shapes});
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
