#include "tests/support/damaged_meshes.h"

#include <algorithm>
#include <random>
#include <utility>

namespace lorica::test {
namespace {

class Damager {
 public:
  explicit Damager(const TriMesh& mesh) : mesh_(mesh), box_(surfaceBounds(mesh)) {}

  [[nodiscard]] TriMesh insideOut() const {
    TriMesh mesh = mesh_;
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    return mesh;
  }

  [[nodiscard]] TriMesh flipped(double share) {
    TriMesh mesh = mesh_;
    for (Triangle& t : mesh.triangles) {
      if (chance(share)) std::swap(t[1], t[2]);
    }
    return mesh;
  }

  /// All triangles below a plane face the other way: at most a third of the area.
  [[nodiscard]] TriMesh flippedSide() const {
    TriMesh mesh = mesh_;
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
      order.emplace_back(mesh.vertices[mesh.triangles[k][0]].y(), k);
    }
    std::sort(order.begin(), order.end());
    double area = surfaceArea(mesh.vertices, mesh.triangles) / 3.0;
    for (const auto& [height, k] : order) {
      Triangle& t = mesh.triangles[k];
      area -= surfaceArea(mesh.vertices, {&t, 1});
      if (area < 0.0) break;
      std::swap(t[1], t[2]);
    }
    return mesh;
  }

  [[nodiscard]] TriMesh doubled(bool turned) {
    TriMesh mesh = mesh_;
    for (Triangle t : mesh_.triangles) {
      if (!chance(0.02) && mesh.triangles.size() > mesh_.triangles.size()) continue;
      if (turned) std::swap(t[1], t[2]);
      mesh.triangles.push_back(t);
    }
    return mesh;
  }

  /// Each triangle with its own vertices, each moved by up to `noise` of the diagonal.
  [[nodiscard]] TriMesh soup(double noise) {
    TriMesh mesh;
    for (const Triangle& t : mesh_.triangles) {
      const auto first = static_cast<VertexIndex>(mesh.vertices.size());
      for (const VertexIndex v : t) mesh.vertices.push_back(mesh_.vertices[v] + noise * box_.diagonal() * direction());
      mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return mesh;
  }

  [[nodiscard]] TriMesh withDegenerates() {
    TriMesh mesh = mesh_;
    for (int i = 0; i < 10; ++i) {
      const Triangle& t = mesh_.triangles[anyTriangle()];
      mesh.triangles.push_back({t[0], t[1], t[0]});
    }
    return mesh;
  }

  /// Up to 20 triangles are missing; no two of them have a common corner.
  [[nodiscard]] TriMesh withPinholes() {
    std::vector<bool> taken(mesh_.vertices.size(), false), gone(mesh_.triangles.size(), false);
    for (int i = 0; i < 20; ++i) {
      const std::size_t k = anyTriangle();
      const Triangle& t = mesh_.triangles[k];
      if (taken[t[0]] || taken[t[1]] || taken[t[2]]) continue;
      for (const VertexIndex v : t) taken[v] = true;
      gone[k] = true;
    }
    return without(gone);
  }

  /// The triangles around five vertices are missing.
  [[nodiscard]] TriMesh withHoles() {
    std::vector<bool> gone(mesh_.triangles.size(), false);
    for (int i = 0; i < 5; ++i) {
      const VertexIndex at = mesh_.triangles[anyTriangle()][0];
      for (std::size_t k = 0; k < gone.size(); ++k) {
        const Triangle& t = mesh_.triangles[k];
        if (std::find(t.begin(), t.end(), at) != t.end()) gone[k] = true;
      }
    }
    return without(gone);
  }

  /// Everything in the last fifth along x is missing.
  [[nodiscard]] TriMesh cutOpen() const {
    std::vector<bool> gone(mesh_.triangles.size(), false);
    const double limit = box_.min.x() + 0.8 * (box_.max.x() - box_.min.x());
    for (std::size_t k = 0; k < gone.size(); ++k) {
      for (const VertexIndex v : mesh_.triangles[k]) gone[k] = gone[k] || mesh_.vertices[v].x() > limit;
    }
    return without(gone);
  }

  [[nodiscard]] TriMesh torn(double share) {
    std::vector<bool> gone(mesh_.triangles.size(), false);
    for (std::size_t k = 0; k < gone.size(); ++k) gone[k] = chance(share);
    return without(gone);
  }

  /// A third triangle at each of ten edges.
  [[nodiscard]] TriMesh withFins(double size) {
    TriMesh mesh = mesh_;
    for (int i = 0; i < 10; ++i) {
      const Triangle t = mesh_.triangles[anyTriangle()];
      mesh.vertices.push_back(mesh.vertices[t[0]] + size * box_.diagonal() * direction());
      mesh.triangles.push_back({t[0], t[1], static_cast<VertexIndex>(mesh.vertices.size() - 1)});
    }
    return mesh;
  }

  /// Tiny triangles that hang in the air.
  [[nodiscard]] TriMesh withSpecks() {
    TriMesh mesh = mesh_;
    for (int i = 0; i < 20; ++i) {
      const auto first = static_cast<VertexIndex>(mesh.vertices.size());
      const Vec3 at = mesh_.vertices[mesh_.triangles[anyTriangle()][0]] + 0.02 * box_.diagonal() * direction();
      for (int k = 0; k < 3; ++k) mesh.vertices.push_back(at + 0.001 * box_.diagonal() * direction());
      mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return mesh;
  }

 private:
  [[nodiscard]] double share() { return static_cast<double>(random_()) / 4294967296.0; }
  [[nodiscard]] bool chance(double of) { return share() < of; }
  [[nodiscard]] std::size_t anyTriangle() { return random_() % mesh_.triangles.size(); }
  /// At most 1 long.
  [[nodiscard]] Vec3 direction() {
    Vec3 d;
    do {
      d = Vec3(2.0 * share() - 1.0, 2.0 * share() - 1.0, 2.0 * share() - 1.0);
    } while (d.norm() > 1.0);
    return d;
  }

  [[nodiscard]] TriMesh without(const std::vector<bool>& gone) const {
    TriMesh mesh{mesh_.vertices, {}};
    for (std::size_t k = 0; k < gone.size(); ++k) {
      if (!gone[k]) mesh.triangles.push_back(mesh_.triangles[k]);
    }
    return mesh;
  }

  const TriMesh& mesh_;
  Aabb box_;
  std::mt19937 random_{1};
};

}  // namespace

std::vector<DamagedMesh> damagedMeshes(const TriMesh& mesh) {
  Damager damager(mesh);
  std::vector<DamagedMesh> all;
  all.push_back({"inside out", Loss::kNone, damager.insideOut()});
  all.push_back({"5 % of the triangles flipped", Loss::kNone, damager.flipped(0.05)});
  all.push_back({"one side flipped", Loss::kNone, damager.flippedSide()});
  all.push_back({"triangles doubled", Loss::kNone, damager.doubled(false)});
  all.push_back({"triangles doubled, facing both ways", Loss::kNone, damager.doubled(true)});
  all.push_back({"each triangle on its own", Loss::kNone, damager.soup(0.0)});
  all.push_back({"cracks between all triangles", Loss::kRounding, damager.soup(1e-7)});
  all.push_back({"degenerate triangles", Loss::kNone, damager.withDegenerates()});
  all.push_back({"single triangles missing", Loss::kNone, damager.withPinholes()});
  all.push_back({"tiny triangles in the air", Loss::kNone, damager.withSpecks()});
  all.push_back({"five holes", Loss::kSurface, damager.withHoles()});
  all.push_back({"fins", Loss::kSurface, damager.withFins(0.05)});
  all.push_back({"a fifth cut off", Loss::kSurface, damager.cutOpen()});
  all.push_back({"10 % of the triangles missing", Loss::kSurface, damager.torn(0.1)});
  return all;
}

}  // namespace lorica::test
