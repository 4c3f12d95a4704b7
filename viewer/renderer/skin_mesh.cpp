#include "viewer/renderer/skin_mesh.h"

#include "geometry/counts.h"
#include "viewer/renderer/scene.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>
#include <utility>

namespace lorica {
namespace {

bool everyEdgeHasItsOpposite(std::span<const Triangle> triangles, std::span<const std::int32_t> slot) {
  std::vector<std::pair<std::int32_t, std::int32_t>> forward;
  std::vector<std::pair<std::int32_t, std::int32_t>> backward;
  for (const Triangle& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t a = slot[t[k]];
      const std::int32_t b = slot[t[(k + 1) % 3]];
      forward.emplace_back(a, b);
      backward.emplace_back(b, a);
    }
  }
  std::sort(forward.begin(), forward.end());
  std::sort(backward.begin(), backward.end());
  return forward == backward;
}

/// Exactly equal positions share a normal slot, because files split vertices along texture seams.
std::vector<std::int32_t> slotsByPosition(std::span<const Vec3> positions) {
  std::vector<std::int32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](std::int32_t i) {
    const Vec3& p = positions[i];
    return std::array<double, 3>{p.x(), p.y(), p.z()};
  };
  std::vector<std::int32_t> slot(positions.size());
  std::iota(slot.begin(), slot.end(), 0);
  if (!std::all_of(positions.begin(), positions.end(), [](const Vec3& p) { return p.allFinite(); })) return slot;
  std::sort(order.begin(), order.end(),
            [&](std::int32_t a, std::int32_t b) { return std::pair(key(a), a) < std::pair(key(b), b); });
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (key(order[i]) == key(order[i - 1])) {
      slot[order[i]] = slot[order[i - 1]];
    }
  }
  return slot;
}

}  // namespace

bool SkinMesh::update(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                      std::span<const PartIndex> partOfTriangle) {
  LORICA_CHECK(partOfTriangle.empty() || partOfTriangle.size() == triangles.size(),
               "partOfTriangle does not match triangles");
  const bool changed = positionCount_ != positions.size() || !std::ranges::equal(triangles_, triangles) ||
                       !std::ranges::equal(partOfTriangle_, partOfTriangle);
  if (changed) {
    positionCount_ = positions.size();
    triangles_.assign(triangles.begin(), triangles.end());
    partOfTriangle_.assign(partOfTriangle.begin(), partOfTriangle.end());
    rebuild(positions);
  }

  // Area-weighted normals, summed over equal positions.
  std::fill(normals_.begin(), normals_.end(), Vec3f::Zero());
  for (const Triangle& t : triangles_) {
    const Vec3& a = positions[t[0]];
    const Vec3f n = (positions[t[1]] - a).cross(positions[t[2]] - a).cast<float>();
    for (const VertexIndex v : t) {
      normals_[normalSlot_[v]] += n;
    }
  }
  for (std::size_t i = 0; i < vertices_.size(); ++i) {
    const auto from = source_[i];
    vertices_[i].position = positions[from].cast<float>();
    vertices_[i].normal = normals_[normalSlot_[from]].stableNormalized();
  }
  return changed;
}

Vec3f SkinMesh::colorOf(PartIndex part) {
  return 0.22f * clay() + 0.72f * partColor(part);
}

void SkinMesh::rebuild(std::span<const Vec3> positions) {
  for (const Triangle& t : triangles_) {
    for (const VertexIndex v : t) {
      LORICA_CHECK(v >= 0 && static_cast<std::size_t>(v) < positions.size(),
                   "scene.triangles has a vertex index out of range");
    }
  }
  normalSlot_ = slotsByPosition(positions);
  normals_.assign(positions.size(), Vec3f::Zero());
  closed_ = everyEdgeHasItsOpposite(triangles_, normalSlot_);

  // One vertex for each pair of position and part.
  struct Corner {
    std::int32_t position;
    PartIndex part;
    std::int32_t index;
  };
  std::vector<Corner> corners;
  corners.reserve(triangles_.size() * 3);
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    const PartIndex part = partOfTriangle_.empty() ? -1 : partOfTriangle_[i];
    for (const VertexIndex v : triangles_[i]) {
      corners.push_back({v, part, countOf(corners)});
    }
  }
  std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) {
    return std::tie(a.position, a.part, a.index) < std::tie(b.position, b.part, b.index);
  });
  source_.clear();
  colors_.clear();
  indices_.resize(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (i == 0 || corners[i].position != corners[i - 1].position || corners[i].part != corners[i - 1].part) {
      source_.push_back(corners[i].position);
      const PartIndex part = corners[i].part;
      colors_.push_back(part < 0 ? clay() : colorOf(part));
    }
    indices_[corners[i].index] = source_.size() - 1;
  }
  vertices_.resize(source_.size());
}

}  // namespace lorica
