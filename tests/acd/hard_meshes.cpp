#include "tests/acd/hard_meshes.h"

#include "geometry/mesh_repair.h"
#include "tests/support/meshes.h"

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <set>

namespace lorica::test {

Vec3 Dice::inBox(double halfSide) {
  const double x = between(-halfSide, halfSide);
  const double y = between(-halfSide, halfSide);
  return {x, y, between(-halfSide, halfSide)};
}

Quat Dice::rotation() {
  Eigen::Vector4d q = Eigen::Vector4d::Zero();
  do {
    for (int i = 0; i < 4; ++i) q[i] = between(-1, 1);
  } while (q.squaredNorm() < 0.01 || q.squaredNorm() > 1.0);
  return Quat(q.normalized());
}

namespace {

HardMesh still(TriMesh mesh, bool solid = true) {
  std::vector<Vec3> pose = mesh.vertices;
  return {std::move(mesh), std::move(pose), solid};
}

TriMesh rotatedAtRandom(Dice& dice, TriMesh mesh) {
  const Quat q = dice.rotation();
  return moved(std::move(mesh), [&](const Vec3& v) { return q * v; });
}

TriMesh manifold(const TriMesh& mesh) {
  Result<MeshRepair> repair = repairClosedMesh(mesh);
  LORICA_CHECK(repair.ok(), "surfaces of voxels are closed");
  return std::move(repair->mesh);
}

/// A random walk over the grid, or a block with missing pieces.
std::set<Voxel> randomVoxels(Dice& dice, int atMost) {
  std::set<Voxel> voxels = {{0, 0, 0}};
  if (dice.oneIn(2)) {
    Voxel at = {0, 0, 0};
    for (int steps = dice.whole(3, atMost); steps > 0; --steps) {
      voxels.insert(at);
      at[dice.whole(0, 2)] += dice.oneIn(2) ? 1 : -1;
    }
    return voxels;
  }
  const int side = dice.whole(2, 3), percent = dice.whole(30, 90);
  for (int i = 0; i < side * side * side; ++i) {
    if (dice.whole(1, 100) <= percent) voxels.insert({i % side, i / side % side, i / side / side});
  }
  return voxels;
}

// Compilers differ in the evaluation order of arguments, so no call below has two random arguments.

TriMesh sphere(Dice& dice) {
  const int rings = dice.whole(3, 8);
  return makeSphere(1.0, rings, dice.whole(4, 10));
}

/// A closed blob that is star-shaped about its centre.
TriMesh star(Dice& dice, double roughness) {
  TriMesh mesh = sphere(dice);
  for (Vec3& v : mesh.vertices) v *= std::exp(roughness * dice.between(-1, 1));
  return mesh;
}

TriMesh torus(Dice& dice) {
  const double minorRadius = dice.between(0.1, 0.6);
  const int segments = dice.whole(4, 14);
  return makeTorus(1.0, minorRadius, segments, dice.whole(3, 8));
}

/// A random simple solid of about unit size.
TriMesh solid(Dice& dice) {
  switch (dice.whole(0, 5)) {
    case 0: {
      const Vec3 low = -dice.inBox(0.5).cwiseAbs() - Vec3::Constant(0.1);
      return makeBox(low, dice.inBox(0.5).cwiseAbs());
    }
    case 1:
      return shifted(makeLShape(), Vec3(-1, -1, -0.5));
    case 2:
      return torus(dice);
    case 3:
      return star(dice, 0.7);
    case 4:
      return shifted(makeTetrahedron(), Vec3::Constant(-0.2));
    default:
      return manifold(makeVoxelSurface(randomVoxels(dice, 8)));
  }
}

/// Puts a new vertex on an edge: its two triangles become four. t = 0 or 1: exactly on an end.
void splitEdge(TriMesh& mesh, int triangle, int corner, double t) {
  const VertexIndex a = mesh.triangles[triangle][corner], b = mesh.triangles[triangle][(corner + 1) % 3];
  const VertexIndex middle = countOf(mesh.vertices);
  mesh.vertices.push_back(t == 0.0   ? mesh.vertices[a]
                          : t == 1.0 ? mesh.vertices[b]
                                     : Vec3((1 - t) * mesh.vertices[a] + t * mesh.vertices[b]));
  const int count = countOf(mesh.triangles);
  for (int i = 0; i < count; ++i) {
    for (int e = 0; e < 3; ++e) {
      const Triangle old = mesh.triangles[i];
      const VertexIndex from = old[e], to = old[(e + 1) % 3], apex = old[(e + 2) % 3];
      if (std::minmax(from, to) != std::minmax(a, b)) continue;
      mesh.triangles[i] = {from, middle, apex};
      mesh.triangles.push_back({middle, to, apex});
      break;
    }
  }
}

/// Puts a new vertex into a triangle: three take its place.
void splitTriangle(TriMesh& mesh, int triangle, const Vec3& at) {
  const Triangle old = mesh.triangles[triangle];
  const VertexIndex middle = countOf(mesh.vertices);
  mesh.vertices.push_back(at);
  mesh.triangles[triangle] = {old[0], old[1], middle};
  mesh.triangles.insert(mesh.triangles.end(), {{old[1], old[2], middle}, {old[2], old[0], middle}});
}

Vec3 centroid(const TriMesh& mesh, int triangle) {
  const Triangle& t = mesh.triangles[triangle];
  return (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3.0;
}

/// A gentle map of space: bends and twists, never folds at the sizes used here.
std::function<Vec3(const Vec3&)> smoothMap(Dice& dice, double strength) {
  const Vec3 phase = dice.inBox(3.0), wave = dice.inBox(1.0);
  const Quat turn = dice.rotation();
  const double twist = strength * dice.between(-0.6, 0.6);
  return [=](const Vec3& p) {
    const Vec3 q = p + strength * 0.3 *
                           Vec3(std::sin(wave.x() * p.y() + phase.x()), std::sin(wave.y() * p.z() + phase.y()),
                                std::sin(wave.z() * p.x() + phase.z()));
    const double angle = twist * q.y();
    return Vec3(turn * Vec3(std::cos(angle) * q.x() - std::sin(angle) * q.z(), q.y(),
                            std::sin(angle) * q.x() + std::cos(angle) * q.z()));
  };
}

void addKeyframe(HardMesh& hard, const std::function<Vec3(const Vec3&)>& map) {
  for (const Vec3& v : hard.mesh.vertices) hard.keyframes.push_back(map(v));
}

}  // namespace

HardMesh cubesOnAGrid(Dice& dice) {
  TriMesh mesh = manifold(makeVoxelSurface(randomVoxels(dice, 16)));
  if (dice.oneIn(3)) mesh = rotatedAtRandom(dice, mesh);  // faces on a plane only up to rounding
  return still(std::move(mesh));
}

HardMesh severalComponents(Dice& dice) {
  TriMesh mesh;
  const int count = dice.whole(2, 5), arrangement = dice.whole(0, 2);
  for (int i = 0; i < count; ++i) {
    if (arrangement == 0) {  // apart
      mesh = joined(mesh, shifted(rotatedAtRandom(dice, solid(dice)), Vec3(i * 30.0, 0, 0)));
    } else if (arrangement == 1) {  // boxes that touch in a face, an edge or a corner, vertices not shared
      const int y = dice.whole(0, 1);
      const Vec3 corner(i, y, dice.whole(0, 1));
      mesh = joined(mesh, makeBox(corner, corner + Vec3::Ones()));
    } else {  // interlocked: hulls overlap though the solids do not
      const int segments = dice.whole(6, 10);
      const TriMesh ring = makeTorus(1.0, 0.2, segments, dice.whole(3, 5));
      const Quat q(Eigen::AngleAxisd(i % 2 == 0 ? 0.0 : std::numbers::pi / 2, Vec3::UnitX()));
      mesh = joined(mesh, moved(ring, [&](const Vec3& v) { return Vec3(q * v + Vec3(1.3 * i, 0, 0)); }));
    }
  }
  return still(std::move(mesh));
}

HardMesh nestedShells(Dice& dice) {
  // Solid, cavity, island in the cavity, cavity in the island...; each shell is half as large as the next outer one.
  TriMesh mesh;
  const int depth = dice.whole(2, 4);
  const bool boxes = dice.oneIn(2);
  for (int i = 0; i < depth; ++i) {
    const double size = std::pow(0.45, i);
    TriMesh shell = boxes ? makeBox(Vec3::Constant(-size), Vec3::Constant(size)) : makeSphere(1.5 * size, 5, 7);
    if (!boxes && dice.oneIn(2)) shell = rotatedAtRandom(dice, shell);
    mesh = joined(mesh, i % 2 == 0 ? shell : insideOut(shell));
  }
  if (dice.oneIn(2)) {  // a second cavity beside the first
    const TriMesh big = makeBox({-3, -3, -3}, {5, 3, 3});
    mesh = joined(big, insideOut(makeBox({2.5, -1, -1}, {4, 1, 1})));
    mesh = joined(mesh, insideOut(star(dice, 0.3)));
  }
  return still(std::move(mesh));
}

HardMesh manyHandles(Dice& dice) {
  if (dice.oneIn(2)) {
    const TriMesh ring = torus(dice);
    const auto map = smoothMap(dice, dice.unit());
    return still(dice.oneIn(2) ? moved(ring, map) : ring);
  }
  // Blocks with straight holes along the axes.
  std::set<Voxel> voxels;
  const int nx = dice.whole(2, 5), ny = dice.whole(3, 5), nz = dice.whole(1, 3);
  for (int i = 0; i < nx * ny * nz; ++i) voxels.insert({i % nx, i / nx % ny, i / nx / ny});
  for (int hole = dice.whole(1, 3); hole > 0; --hole) {
    const int axis = dice.whole(0, 2);
    const Voxel at = {dice.whole(0, nx - 1), dice.whole(1, ny - 2), dice.whole(0, nz - 1)};
    std::erase_if(voxels, [&](const Voxel& v) {
      return v[(axis + 1) % 3] == at[(axis + 1) % 3] && v[(axis + 2) % 3] == at[(axis + 2) % 3];
    });
  }
  if (voxels.empty()) voxels.insert({0, 0, 0});
  return still(manifold(makeVoxelSurface(voxels)));
}

HardMesh slivers(Dice& dice) {
  TriMesh mesh = dice.oneIn(2) ? torus(dice) : star(dice, 0.5);
  switch (dice.whole(0, 2)) {
    case 0: {  // a flat solid or a needle
      const double thin = std::pow(10.0, dice.between(-4, -1));
      const double thinner = dice.oneIn(2) ? thin : 1.0;
      mesh = moved(mesh, [&](const Vec3& v) { return Vec3(v.x(), thin * v.y(), thinner * v.z()); });
      break;
    }
    case 1:  // triangles 1 : 1e6 beside their edges
      for (int i = 0; i < 10; ++i) {
        const int t = dice.whole(0, countOf(mesh.triangles) - 1), corner = dice.whole(0, 2);
        splitEdge(mesh, t, corner, std::pow(10.0, dice.between(-9, -3)));
      }
      break;
    default: {  // one vertex far out
      const int v = dice.whole(0, countOf(mesh.vertices) - 1);
      mesh = star(dice, 0.2);
      mesh.vertices[v % mesh.vertices.size()] *= std::pow(10.0, dice.between(1, 4));
    }
  }
  return still(dice.oneIn(2) ? rotatedAtRandom(dice, mesh) : mesh);
}

HardMesh duplicateAndCollinearVertices(Dice& dice) {
  TriMesh mesh = dice.oneIn(2) ? manifold(makeVoxelSurface(randomVoxels(dice, 6))) : solid(dice);
  for (int i = dice.whole(3, 25); i > 0; --i) {
    const int t = dice.whole(0, countOf(mesh.triangles) - 1), corner = dice.whole(0, 2);
    switch (dice.whole(0, 4)) {
      case 0:  // on an end: an edge without length
        splitEdge(mesh, t, corner, dice.oneIn(2) ? 0.0 : 1.0);
        break;
      case 1:  // a triangle without area
        splitTriangle(mesh, t, mesh.vertices[mesh.triangles[t][corner]]);
        break;
      case 2:
        splitTriangle(mesh, t, centroid(mesh, t));
        break;
      default:
        splitEdge(mesh, t, corner, dice.oneIn(2) ? 0.5 : dice.unit());
    }
  }
  return still(std::move(mesh));
}

HardMesh spikes(Dice& dice) {
  return still(star(dice, dice.between(0.5, 2.0)));
}

HardMesh prisms(Dice& dice) {
  // A star-shaped profile, triangulated as a fan from its centre; half of them with integers, so that many faces are
  // coplanar.
  const int corners = dice.whole(5, 24);
  const bool whole = dice.oneIn(2);
  TriMesh mesh;
  for (const double z : {0.0, 1.0}) mesh.vertices.emplace_back(0, 0, z);
  for (int i = 0; i < corners; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / corners;
    double r = dice.between(2, 10);
    if (whole) r = dice.oneIn(2) ? 4.0 : 8.0;
    const Vec3 p(r * std::cos(angle), r * std::sin(angle), 0);
    mesh.vertices.insert(mesh.vertices.end(), {p, p + Vec3::UnitZ()});
  }
  for (int i = 0; i < corners; ++i) {
    const VertexIndex a = 2 + 2 * i, b = 2 + 2 * ((i + 1) % corners);
    mesh.triangles.insert(mesh.triangles.end(), {{0, b, a}, {1, a + 1, b + 1}, {a, b, b + 1}, {a, b + 1, a + 1}});
  }
  return still(dice.oneIn(2) ? rotatedAtRandom(dice, mesh) : mesh);
}

HardMesh overlappingShells(Dice& dice) {
  TriMesh mesh;
  for (int i = dice.whole(2, 4); i > 0; --i) {
    TriMesh shell = solid(dice);
    if (dice.oneIn(2)) shell = rotatedAtRandom(dice, shell);
    mesh = joined(mesh, shifted(shell, dice.oneIn(4) ? Vec3::Zero() : dice.inBox(0.8)));
  }
  return still(std::move(mesh));
}

HardMesh crumpled(Dice& dice) {
  TriMesh mesh = dice.oneIn(2) ? torus(dice) : sphere(dice);
  switch (dice.whole(0, 2)) {
    case 0: {  // every vertex at a random position
      const double by = dice.between(0.1, 1.0);
      for (Vec3& v : mesh.vertices) v += dice.inBox(by);
      break;
    }
    case 1: {  // twisted until it passes through itself
      const double twist = dice.between(1, 8);
      mesh = moved(mesh, [&](const Vec3& v) {
        return Vec3(Eigen::AngleAxisd(twist * v.x(), Vec3::UnitX()) * Vec3(2 * v.x(), v.y(), v.z() + 0.5));
      });
      break;
    }
    default:  // on a coarse grid, where many vertices coincide
      for (Vec3& v : mesh.vertices) v = (3.0 * (v + dice.inBox(0.4))).array().round();
  }
  return still(std::move(mesh), false);
}

HardMesh extremeSizes(Dice& dice) {
  HardMesh hard = dice.oneIn(2) ? still(solid(dice)) : dice.oneIn(2) ? nestedShells(dice) : slivers(dice);
  const double scale = std::array<double, 4>{1e-6, 1e6, 1e-12, 1e12}[dice.whole(0, 3)];
  return still(moved(hard.mesh, [&](const Vec3& v) { return Vec3(scale * v); }));
}

HardMesh farFromTheOrigin(Dice& dice) {
  const HardMesh hard = dice.oneIn(2) ? still(solid(dice)) : cubesOnAGrid(dice);
  const double distance = std::pow(10.0, dice.whole(2, 12));
  return still(shifted(hard.mesh, distance * dice.inBox(1.0)));
}

HardMesh smoothMotion(Dice& dice) {
  HardMesh hard = dice.oneIn(2) ? still(solid(dice)) : cubesOnAGrid(dice);
  for (int i = dice.whole(1, 4); i > 0; --i) addKeyframe(hard, smoothMap(dice, dice.unit()));
  return hard;
}

HardMesh violentMotion(Dice& dice) {
  HardMesh hard = still(solid(dice));
  for (int i = dice.whole(1, 3); i > 0; --i) {
    switch (dice.whole(0, 5)) {
      case 0:  // onto a plane
        addKeyframe(hard, [](const Vec3& v) { return Vec3(v.x(), 0.5, v.z()); });
        break;
      case 1:  // inside out
        addKeyframe(hard, [](const Vec3& v) { return Vec3(-v.x(), v.y(), v.z()); });
        break;
      case 2:  // nearly flat
        addKeyframe(hard, [](const Vec3& v) { return Vec3(v.x(), 1e-5 * v.y(), v.z()); });
        break;
      default: {
        const double by = dice.between(0.05, 0.8);
        addKeyframe(hard, [&](const Vec3& v) { return Vec3(v + dice.inBox(by)); });
      }
    }
  }
  return hard;
}

HardMesh partsThatBecomeFlat(Dice& dice) {
  if (dice.oneIn(2)) {
    // A separate component that shrinks onto a plane, a line or a point.
    const TriMesh body = solid(dice);
    HardMesh hard = still(joined(body, shifted(solid(dice), Vec3(20, 0, 0))));
    const int dimensions = dice.whole(0, 2);
    addKeyframe(hard, [&](const Vec3& v) {
      return v.x() < 10 ? v : Vec3(20 + (dimensions > 0 ? v.x() - 20 : 0), dimensions > 1 ? v.y() : 0, 0);
    });
    return hard;
  }
  // A limb of a body that shrinks.
  HardMesh hard = cubesOnAGrid(dice);
  hard = still(shifted(hard.mesh, -hard.mesh.vertices[0]));
  const double from = boundsOf(hard.mesh.vertices).center().x();
  addKeyframe(hard, [&](const Vec3& v) { return v.x() > from ? Vec3(v.x(), 0.25, v.z()) : v; });
  addKeyframe(hard, [&](const Vec3& v) { return v.x() > from ? Vec3(v.x(), 0.25, 0.25) : v; });
  return hard;
}

}  // namespace lorica::test
