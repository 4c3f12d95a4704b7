#include "tests/bench/generators/subdivision.h"

#include "geometry/counts.h"
#include "geometry/result.h"

#include <cstdint>
#include <unordered_map>

namespace lorica {

namespace {

using Entry = Eigen::Triplet<double>;

[[nodiscard]] std::uint64_t edgeKey(int a, int b) {
  const std::uint64_t lo = a < b ? a : b;
  const std::uint64_t hi = a < b ? b : a;
  return lo << 32 | hi;
}

struct Edge {
  int a, b;
  int faces[2] = {-1, -1};
};

struct Edges {
  std::vector<Edge> all;                              ///< in order of first appearance
  std::unordered_map<std::uint64_t, int> indexOfKey;  ///< used for lookups only
};

[[nodiscard]] Edges collectEdges(const PolygonFaces& faces) {
  Edges edges;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const std::vector<int>& face = faces[f];
    for (std::size_t i = 0; i < face.size(); ++i) {
      const int a = face[i];
      const int b = face[(i + 1) % face.size()];
      const auto [found, fresh] = edges.indexOfKey.try_emplace(edgeKey(a, b), countOf(edges.all));
      if (fresh) edges.all.push_back({a, b});
      Edge& edge = edges.all[found->second];
      const int side = fresh ? 0 : 1;
      LORICA_CHECK(edge.faces[side] == -1, "subdivision: an edge has more than two faces");
      edge.faces[side] = f;
    }
  }
  for (const Edge& edge : edges.all) LORICA_CHECK(edge.faces[1] != -1, "subdivision: the mesh is not closed");
  return edges;
}

[[nodiscard]] SparseMatrix assemble(int rows, int columns, const std::vector<Entry>& entries) {
  SparseMatrix matrix(rows, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace

Refinement refineCatmullClark(int vertexCount, const PolygonFaces& faces) {
  const Edges edges = collectEdges(faces);
  const int edgeCount = countOf(edges.all);
  const int faceCount = countOf(faces);
  const int firstEdgePoint = vertexCount;
  const int firstFacePoint = vertexCount + edgeCount;

  std::vector<Entry> entries;
  const auto addFacePoint = [&](int row, int f, double weight) {
    const std::vector<int>& face = faces[f];
    for (const int v : face) entries.emplace_back(row, v, weight / face.size());
  };

  for (int f = 0; f < faceCount; ++f) addFacePoint(firstFacePoint + f, f, 1.0);

  std::vector<int> valence(vertexCount, 0);
  for (int e = 0; e < edgeCount; ++e) {
    const Edge& edge = edges.all[e];
    entries.emplace_back(firstEdgePoint + e, edge.a, 0.25);
    entries.emplace_back(firstEdgePoint + e, edge.b, 0.25);
    for (const int f : edge.faces) addFacePoint(firstEdgePoint + e, f, 0.25);
    ++valence[edge.a];
    ++valence[edge.b];
  }

  // A vertex of valence n moves to (Q + 2 R + (n - 3) v) / n: Q the mean of its face points, R of its edges' middles.
  for (int v = 0; v < vertexCount; ++v) {
    const double n = valence[v];
    entries.emplace_back(v, v, (n - 3.0) / n);
  }
  for (const Edge& edge : edges.all) {
    for (const int v : {edge.a, edge.b}) {
      const double n = valence[v];
      entries.emplace_back(v, edge.a, 1.0 / (n * n));
      entries.emplace_back(v, edge.b, 1.0 / (n * n));
    }
  }
  for (int f = 0; f < faceCount; ++f) {
    for (const int v : faces[f]) {
      const double n = valence[v];
      addFacePoint(v, f, 1.0 / (n * n));
    }
  }

  Refinement refinement;
  refinement.fineFromCoarse = assemble(vertexCount + edgeCount + faceCount, vertexCount, entries);
  for (int f = 0; f < faceCount; ++f) {
    const std::vector<int>& face = faces[f];
    const std::size_t n = face.size();
    for (std::size_t i = 0; i < n; ++i) {
      const int previous = edges.indexOfKey.at(edgeKey(face[(i + n - 1) % n], face[i]));
      const int next = edges.indexOfKey.at(edgeKey(face[i], face[(i + 1) % n]));
      refinement.faces.push_back({face[i], firstEdgePoint + next, firstFacePoint + f, firstEdgePoint + previous});
    }
  }
  return refinement;
}

}  // namespace lorica
