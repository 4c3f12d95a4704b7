#include "tests/bench/generators/subdivision.h"

#include <gtest/gtest.h>

#include <map>

namespace lorica::test {
namespace {

using Points = Eigen::Matrix<double, Eigen::Dynamic, 3>;

// Vertex i of the cube: bits x, y, z.
const PolygonFaces kCube = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
const PolygonFaces kTetrahedron = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

Points cubePoints() {
  Points points(8, 3);
  for (int i = 0; i < 8; ++i) points.row(i) << ((i & 1) ? 1 : -1), ((i & 2) ? 1 : -1), ((i & 4) ? 1 : -1);
  return points;
}

void expectClosed(const PolygonFaces& faces) {
  std::map<std::pair<int, int>, int> directed;
  for (const std::vector<int>& face : faces) {
    for (std::size_t i = 0; i < face.size(); ++i) ++directed[{face[i], face[(i + 1) % face.size()]}];
  }
  for (const auto& [edge, count] : directed) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(directed.count({edge.second, edge.first}), 1u);
  }
}

TEST(CatmullClark, CubeAfterOneStepIsThatOfThePaper) {
  const Refinement step = refineCatmullClark(8, kCube);
  ASSERT_EQ(step.fineFromCoarse.rows(), 8 + 12 + 6);
  ASSERT_EQ(step.faces.size(), 24u);
  expectClosed(step.faces);
  const Points fine = step.fineFromCoarse * cubePoints();
  for (int i = 0; i < 8; ++i) EXPECT_LT((fine.row(i) - cubePoints().row(i) * 5.0 / 9.0).norm(), 1e-15);
  for (int i = 8; i < 20; ++i) EXPECT_NEAR(fine.row(i).norm(), 0.75 * std::sqrt(2.0), 1e-15);
  for (int i = 20; i < 26; ++i) EXPECT_NEAR(fine.row(i).norm(), 1.0, 1e-15);
}

TEST(CatmullClark, TrianglesBecomeQuadsAndStayClosed) {
  const Refinement step = refineCatmullClark(4, kTetrahedron);
  EXPECT_EQ(step.fineFromCoarse.rows(), 4 + 6 + 4);
  EXPECT_EQ(step.faces.size(), 12u);
  for (const std::vector<int>& face : step.faces) EXPECT_EQ(face.size(), 4u);
  expectClosed(step.faces);
}

TEST(CatmullClark, WeightsAreAveragesSoRowsSumToOneAndNoneIsNegative) {
  for (const auto& [count, faces] : {std::pair{8, kCube}, std::pair{4, kTetrahedron}}) {
    const Refinement first = refineCatmullClark(count, faces);
    const Refinement second = refineCatmullClark(static_cast<int>(first.fineFromCoarse.rows()), first.faces);
    const Eigen::MatrixXd all = Eigen::MatrixXd(SparseMatrix(second.fineFromCoarse * first.fineFromCoarse));
    EXPECT_GE(all.minCoeff(), -1e-16);
    EXPECT_LT((all.rowwise().sum().array() - 1.0).abs().maxCoeff(), 1e-14);
  }
}

TEST(CatmullClark, FlatRegularGridStaysEven) {
  // A torus of 4 x 4 quads, seen as a periodic grid: a vertex's new position is the average known for bicubic splines.
  PolygonFaces faces;
  const auto at = [](int i, int j) { return (i % 4) * 4 + j % 4; };
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) faces.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)});
  }
  const Refinement step = refineCatmullClark(16, faces);
  const Eigen::MatrixXd m = Eigen::MatrixXd(step.fineFromCoarse);
  EXPECT_DOUBLE_EQ(m(at(1, 1), at(1, 1)), 36.0 / 64.0);
  EXPECT_DOUBLE_EQ(m(at(1, 1), at(1, 2)), 6.0 / 64.0);
  EXPECT_DOUBLE_EQ(m(at(1, 1), at(2, 2)), 1.0 / 64.0);
  EXPECT_DOUBLE_EQ(m(at(1, 1), at(3, 3)), 0.0);
}

}  // namespace
}  // namespace lorica::test
