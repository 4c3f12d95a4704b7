#include "acd/mesh_frame.h"

#include "geometry/mass_properties.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace lorica {
namespace {

constexpr int kCells = 40;          // along each side of a cube of directions
constexpr std::size_t kSeeds = 16;  // directions that are examined
// Cosines up to which normals count as the same: 3, 1 and 0.3 degrees, then 0.1.
constexpr std::array kCloser = {1.0 - 1.4e-3, 1.0 - 1.5e-4, 1.0 - 1.4e-5, 1.0 - 1.5e-6, 1.0 - 1.5e-6};
constexpr double kPerpendicular = 2e-2;  // cosine up to which an axis counts as perpendicular to the first
constexpr double kFirstShare = 0.05;     // minimum share of the surface that has the first axis as its normal
constexpr double kSecondShare = 0.01;
constexpr double kCellShare = 0.0025;  // such normals can lie in four cells

/// A line along which normals lie, and the area that has them.
struct Direction {
  Vec3 axis = Vec3::Zero();
  double area = 0.0;
};

/// Area vectors, each turned into the half space where its largest component is positive.
std::vector<Vec3> areaVectors(std::span<const Vec3> points, std::span<const Triangle> triangles) {
  std::vector<Vec3> areas;
  areas.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    const Vec3& a = points[t[0]];
    Vec3 area = 0.5 * (points[t[1]] - a).cross(points[t[2]] - a);
    int largest = 0;
    area.cwiseAbs().maxCoeff(&largest);
    areas.emplace_back(area[largest] < 0.0 ? Vec3(-area) : area);
  }
  return areas;
}

/// Index of the cell of a cube's surface that a direction points into.
std::size_t cellOf(const Vec3& direction) {
  int largest = 0;
  const double length = direction.cwiseAbs().maxCoeff(&largest);
  std::size_t cell = largest;
  for (int i = 1; i <= 2; ++i) {
    const double at = 0.5 * (direction[(largest + i) % 3] / length + 1.0);
    cell = cell * kCells + static_cast<std::size_t>(std::clamp(static_cast<int>(at * kCells), 0, kCells - 1));
  }
  return cell;
}

/// The mean of the area vectors within an angle of a direction.
Direction meanAround(const Vec3& direction, double cosine, const std::vector<Vec3>& areas) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& vector : areas) {
    const double along = vector.dot(direction);
    if (along * along > cosine * cosine * vector.squaredNorm()) sum += along < 0.0 ? Vec3(-vector) : vector;
  }
  return {sum.normalized(), sum.norm()};
}

/// The directions that most of the surface has as its normal, the largest area first.
std::vector<Direction> commonNormals(const std::vector<Vec3>& areas, double total) {
  struct Cell {
    double area = 0.0;
    Vec3 sum = Vec3::Zero();
  };
  std::vector<Cell> cells(3 * kCells * kCells);
  for (const Vec3& vector : areas) {
    const double area = vector.norm();
    if (!(area > 0.0)) continue;
    Cell& cell = cells[cellOf(vector)];
    cell.area += area;
    cell.sum += vector;
  }
  std::stable_sort(cells.begin(), cells.end(), [](const Cell& a, const Cell& b) { return a.area > b.area; });
  std::vector<Direction> found;
  for (std::size_t i = 0; i < kSeeds && cells[i].area > kCellShare * total; ++i) {
    // The cells lie as the axes do. Means of what is ever closer around end at the same direction from any cell.
    Direction direction{cells[i].sum.normalized(), 0.0};
    for (const double cosine : kCloser) direction = meanAround(direction.axis, cosine, areas);
    found.push_back(direction);
  }
  std::stable_sort(found.begin(), found.end(), [](const Direction& a, const Direction& b) { return a.area > b.area; });
  return found;
}

/// The principal axis whose moment differs most from the other two.
Vec3 distinctAxis(const PrincipalInertia& inertia) {
  const Vec3& m = inertia.moments;
  return m[1] - m[0] > m[2] - m[1] ? inertia.axes.col(0) : inertia.axes.col(2);
}

/// Removes rounding errors of an axis that is meant to lie along a coordinate axis or plane.
Vec3 cleaned(Vec3 axis) {
  for (double& x : axis) {
    if (std::abs(x) < 1e-12) x = 0.0;
  }
  return axis.normalized();
}

/// Third moments of the surface along each axis of a frame: their signs tell the two ends of an axis apart.
Vec3 lopsidedness(const Mat3& frame, std::span<const Vec3> points, std::span<const Triangle> triangles,
                  const std::vector<Vec3>& areas) {
  Vec3 center = Vec3::Zero();
  double total = 0.0;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Triangle& t = triangles[i];
    const double area = areas[i].norm();
    center += area / 3.0 * (points[t[0]] + points[t[1]] + points[t[2]]);
    total += area;
  }
  center /= total;
  Vec3 moments = Vec3::Zero();
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (const VertexIndex v : triangles[i]) {
      const Vec3 p = frame * (points[v] - center);
      moments += areas[i].norm() * p.cwiseProduct(p).cwiseProduct(p);
    }
  }
  return moments;
}

/// Turns a frame by half turns until the two axes with the largest moments point to their heavier ends.
Mat3 turned(Mat3 frame, const Vec3& moments) {
  int least = 0;
  moments.cwiseAbs().minCoeff(&least);
  for (int i = 1; i <= 2; ++i) {
    const int axis = (least + i) % 3;
    if (moments[axis] < 0.0) frame.row(axis) *= -1.0;
  }
  frame.row(least) = Vec3(frame.row((least + 1) % 3)).cross(Vec3(frame.row((least + 2) % 3)));
  return frame;
}

}  // namespace

Mat3 frameOf(std::span<const Vec3> points, std::span<const Triangle> triangles) {
  const std::vector<Vec3> areas = areaVectors(points, triangles);
  double total = 0.0;
  for (const Vec3& area : areas) total += area.norm();
  const std::vector<Direction> normals = commonNormals(areas, total);
  const Mat3 inertia = massProperties(points, triangles).inertia;

  const bool flat = !normals.empty() && normals[0].area >= kFirstShare * total;
  const Vec3 first = cleaned(flat ? normals[0].axis : distinctAxis(principalInertia(inertia)));
  const Mat3 across = Mat3::Identity() - first * first.transpose();
  const auto second = std::find_if(normals.begin(), normals.end(), [&](const Direction& d) {
    return d.area >= kSecondShare * total && std::abs(d.axis.dot(first)) < kPerpendicular;
  });
  // Without such normals: the direction across the first axis about which the solid turns hardest.
  const Vec3 other = second != normals.end() ? second->axis : symmetricAxes(across * inertia * across).vectors.col(2);
  Mat3 frame;
  frame.row(0) = first;
  frame.row(1) = cleaned(across * other);
  frame.row(2) = Vec3(frame.row(0)).cross(Vec3(frame.row(1)));
  return turned(frame, lopsidedness(frame, points, triangles, areas));
}

}  // namespace lorica
