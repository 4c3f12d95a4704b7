#include "tests/bench/generators/mannequin_surface.h"

#include "geometry/counts.h"
#include "geometry/little_endian.h"
#include "geometry/math.h"
#include "geometry/result.h"
#include "skinning/mannequin/mannequin_skeleton.h"
#include "tests/bench/generators/mannequin_cage.h"
#include "tests/bench/generators/subdivision.h"

#include <algorithm>
#include <span>

namespace lorica {
namespace {

/// Displaces points within an ellipsoid, most at its centre, falling smoothly to zero at its border. [m]
struct Stroke {
  double centre[3];
  double radii[3];
  double push[3];
};

constexpr Stroke kStrokes[] = {
    // Face: nose, eye socket, brow, cheekbone, groove under the nose, lips, chin, ear.
    {{0.0, 1.618, 0.104}, {0.021, 0.036, 0.040}, {0.0, -0.004, 0.018}},
    {{0.031, 1.645, 0.088}, {0.024, 0.018, 0.040}, {0.0, 0.0, -0.011}},
    {{0.028, 1.668, 0.092}, {0.036, 0.013, 0.030}, {0.0, 0.0, 0.004}},
    {{0.055, 1.622, 0.070}, {0.036, 0.034, 0.036}, {0.002, 0.0, 0.003}},
    {{0.0, 1.589, 0.098}, {0.022, 0.008, 0.030}, {0.0, 0.0, -0.003}},
    {{0.0, 1.576, 0.098}, {0.030, 0.013, 0.030}, {0.0, 0.0, 0.005}},
    {{0.0, 1.543, 0.094}, {0.032, 0.018, 0.030}, {0.0, 0.0, 0.005}},
    {{0.078, 1.634, -0.010}, {0.030, 0.038, 0.024}, {0.011, 0.002, -0.007}},
    // Chest: its muscle and the groove over the breastbone; the hollow above the collarbone.
    {{0.082, 1.335, 0.090}, {0.095, 0.085, 0.075}, {0.0, 0.0, 0.011}},
    {{0.0, 1.320, 0.110}, {0.024, 0.090, 0.050}, {0.0, 0.0, -0.005}},
    {{0.080, 1.460, 0.022}, {0.050, 0.022, 0.040}, {0.0, -0.005, -0.004}},
    // Belly: the arch of the ribs, the line down the middle.
    {{0.0, 1.200, 0.105}, {0.055, 0.055, 0.050}, {0.0, 0.0, -0.005}},
    {{0.0, 1.090, 0.095}, {0.016, 0.120, 0.040}, {0.0, 0.0, -0.003}},
    // The end of the belly between the thighs.
    {{0.0, 0.850, 0.070}, {0.080, 0.070, 0.060}, {0.0, -0.004, 0.008}},
    {{0.034, 0.812, 0.030}, {0.034, 0.040, 0.050}, {0.0, -0.003, 0.012}},
    // Back: the furrow of the spine, shoulder blade, buttock.
    {{0.0, 1.200, -0.100}, {0.032, 0.270, 0.060}, {0.0, 0.0, 0.009}},
    {{0.088, 1.365, -0.110}, {0.060, 0.085, 0.050}, {0.0, 0.0, -0.009}},
    {{0.078, 0.872, -0.100}, {0.092, 0.115, 0.085}, {0.0, 0.0, -0.030}},
    // Elbow, kneecap, inner calf, both ankle bones, big toe.
    {{0.458, 1.409, -0.060}, {0.030, 0.024, 0.026}, {0.0, 0.0, -0.004}},
    {{0.097, 0.500, 0.052}, {0.048, 0.060, 0.050}, {0.0, 0.0, 0.005}},
    {{0.070, 0.355, -0.065}, {0.045, 0.095, 0.050}, {-0.004, 0.0, -0.005}},
    {{0.130, 0.090, -0.038}, {0.022, 0.024, 0.026}, {0.006, 0.0, 0.0}},
    {{0.068, 0.096, -0.032}, {0.022, 0.024, 0.026}, {-0.006, 0.0, 0.0}},
    {{0.086, 0.014, 0.155}, {0.028, 0.024, 0.030}, {-0.002, 0.001, 0.008}},
};

/// Adds detail finer than the control cage: muscles, face, knees. Moves points of the left half of the mannequin,
/// x >= 0; points with x == 0 stay in the plane of symmetry.
void sculptMannequin(std::span<Vec3> points) {
  for (Vec3& p : points) {
    const bool inPlane = p.x() == 0.0;
    Vec3 moved = p;
    for (const Stroke& stroke : kStrokes) {
      const Eigen::Map<const Vec3> centre(stroke.centre);
      const Eigen::Map<const Vec3> radii(stroke.radii);
      const Eigen::Map<const Vec3> push(stroke.push);
      const double distanceSq = (p - centre).cwiseQuotient(radii).squaredNorm();
      if (distanceSq >= 1.0) continue;
      const double rest = 1.0 - distanceSq;
      moved += rest * rest * push;
    }
    p = moved;
    if (inPlane) p.x() = 0.0;
  }
}

using DenseMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr int kMaxInfluences = 4;
constexpr double kMinWeight = 2e-3;
constexpr int kInterpolationSteps = 12;

/// The whole cage: the left half and its mirror image, joined in the plane x = 0.
struct WholeCage {
  DenseMatrix points;   ///< pointCount x 3
  DenseMatrix weights;  ///< pointCount x kHumanBoneCount
  PolygonFaces faces;   ///< those of the left half first
};

[[nodiscard]] WholeCage mirrorAndJoin(const HalfCage& half) {
  const int halfCount = countOf(half.points());
  std::vector<int> twin(half.points().size());
  int count = halfCount;
  for (std::size_t v = 0; v < twin.size(); ++v) {
    twin[v] = half.points()[v].x() == 0.0 ? static_cast<int>(v) : count++;
  }

  WholeCage whole;
  whole.points = DenseMatrix::Zero(count, 3);
  whole.weights = DenseMatrix::Zero(count, kHumanBoneCount);
  for (std::size_t v = 0; v < twin.size(); ++v) {
    const Vec3& p = half.points()[v];
    whole.points.row(twin[v]) << -p.x(), p.y(), p.z();
    whole.points.row(v) = p.transpose();
    for (const auto& [bone, weight] : half.weights()[v]) {
      whole.weights(v, static_cast<int>(bone)) += weight;
      if (twin[v] != static_cast<int>(v)) whole.weights(twin[v], static_cast<int>(mirrored(bone))) += weight;
    }
  }
  whole.faces = half.faces();
  for (const std::vector<int>& face : half.faces()) {
    std::vector<int> image;
    for (auto v = face.rbegin(); v != face.rend(); ++v) image.push_back(twin[*v]);
    whole.faces.push_back(std::move(image));
  }
  return whole;
}

/// Moves the cage so that the refined surface passes through the given points (progressive interpolation: each step
/// adds the remaining error; stopped early, the surface stays smooth).
[[nodiscard]] DenseMatrix interpolatingCage(const SparseMatrix& refinedFromCage, const DenseMatrix& targets) {
  DenseMatrix cage = targets;
  for (int i = 0; i < kInterpolationSteps; ++i) cage += targets - refinedFromCage * cage;
  return cage;
}

/// The bone that a point of the left half follows instead of each bone: the bone itself, or for a limb of the right
/// side the bone of the trunk that carries it.
[[nodiscard]] std::array<int, kHumanBoneCount> leftHalfProxies() {
  std::array<int, kHumanBoneCount> proxy{};
  for (int b = 0; b < kHumanBoneCount; ++b) {
    const auto bone = static_cast<HumanBone>(b);
    const bool leg = bone >= HumanBone::kRightUpperLeg && bone <= HumanBone::kRightToes;
    const HumanBone carrier = leg ? HumanBone::kHips : HumanBone::kUpperChest;
    proxy[b] = mannequinJoint(bone).x() < 0.0 ? static_cast<int>(carrier) : b;
  }
  return proxy;
}

/// The largest four, normalised, in descending order; ties by bone.
[[nodiscard]] BoneWeights strongest(const Eigen::RowVectorXd& weights) {
  BoneWeights kept;
  for (int b = 0; b < kHumanBoneCount; ++b) {
    if (weights[b] >= kMinWeight) kept.emplace_back(static_cast<HumanBone>(b), weights[b]);
  }
  std::stable_sort(kept.begin(), kept.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  if (kept.size() > kMaxInfluences) kept.resize(kMaxInfluences);
  double sum = 0.0;
  for (const auto& [bone, weight] : kept) sum += weight;
  for (auto& [bone, weight] : kept) weight /= sum;
  return kept;
}

/// The refined left half: x == 0 exactly in the plane of symmetry.
struct HalfSurface {
  std::vector<Vec3> points;
  std::vector<BoneWeights> weights;
  std::vector<std::array<int, 4>> quads;
};

[[nodiscard]] HalfSurface refinedHalf(const WholeCage& cage) {
  const int cageCount = cage.points.rows();
  const Refinement first = refineCatmullClark(cageCount, cage.faces);
  const int firstCount = first.fineFromCoarse.rows();
  const Refinement second = refineCatmullClark(firstCount, first.faces);
  const int fineCount = second.fineFromCoarse.rows();

  const SparseMatrix refinedFromCage = second.fineFromCoarse.topRows(cageCount) * first.fineFromCoarse;
  const DenseMatrix fitted = interpolatingCage(refinedFromCage, cage.points);
  const DenseMatrix finePoints = second.fineFromCoarse * (first.fineFromCoarse * fitted);
  const DenseMatrix fineWeights = second.fineFromCoarse * (first.fineFromCoarse * cage.weights);

  // Refined faces keep the order of the cage's faces, so the left half of them comes first. Vertices that both halves
  // share are in the plane of symmetry.
  const std::size_t halfFaces = second.faces.size() / 2;
  std::vector<int> sides(fineCount, 0);
  for (std::size_t f = 0; f < second.faces.size(); ++f) {
    for (const int v : second.faces[f]) sides[v] |= f < halfFaces ? 1 : 2;
  }
  const std::array<int, kHumanBoneCount> proxy = leftHalfProxies();
  HalfSurface half;
  std::vector<int> halfIndex(fineCount, -1);
  for (int v = 0; v < fineCount; ++v) {
    const int side = sides[v];
    if (side == 2) continue;
    halfIndex[v] = countOf(half.points);
    Vec3 p = finePoints.row(v).transpose();
    if (side == 3) p.x() = 0.0;
    // Refinement spreads weights across the plane of symmetry: weights of a limb of the other side are moved to the
    // trunk, and in the plane itself no limb has a weight.
    Eigen::RowVectorXd weights = Eigen::RowVectorXd::Zero(kHumanBoneCount);
    for (int b = 0; b < kHumanBoneCount; ++b) {
      const int seen = side == 3 ? std::max(b, static_cast<int>(mirrored(static_cast<HumanBone>(b)))) : b;
      weights[proxy[seen]] += fineWeights(v, b);
    }
    half.points.push_back(p);
    half.weights.push_back(strongest(weights));
  }
  for (std::size_t f = 0; f < halfFaces; ++f) {
    std::array<int, 4> quad{};
    for (std::size_t i = 0; i < 4; ++i) quad[i] = halfIndex[second.faces[f][i]];
    half.quads.push_back(quad);
  }
  return half;
}

/// The triangles of the quads, each split along its shorter diagonal.
[[nodiscard]] std::vector<std::array<int, 3>> trianglesOf(const HalfSurface& half) {
  std::vector<std::array<int, 3>> triangles;
  for (const std::array<int, 4>& q : half.quads) {
    const auto lengthSq = [&](std::size_t i, std::size_t j) {
      return (half.points[q[i]] - half.points[q[j]]).squaredNorm();
    };
    if (lengthSq(0, 2) <= lengthSq(1, 3)) {
      triangles.push_back({q[0], q[1], q[2]});
      triangles.push_back({q[0], q[2], q[3]});
    } else {
      triangles.push_back({q[0], q[1], q[3]});
      triangles.push_back({q[1], q[2], q[3]});
    }
  }
  return triangles;
}

}  // namespace

int HalfCage::addPoint(const Vec3& p, BoneWeights weights) {
  points_.push_back(p);
  weights_.push_back(std::move(weights));
  return countOf(points_) - 1;
}

void HalfCage::bridge(const Ring& from, const Ring& to, int skipped) {
  LORICA_CHECK(from.size() == to.size(), "rings of a tube have equal size");
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (static_cast<int>(i) == skipped) continue;
    const std::size_t j = (i + 1) % from.size();
    addFace({from[i], from[j], to[j], to[i]});
  }
}

std::string mannequinTable() {
  HalfCage cage;
  const TrunkOpenings openings = addTrunkAndHead(cage);
  addArmAndHand(cage, openings.arm);
  addLegAndFoot(cage, openings.leg);

  HalfSurface half = refinedHalf(mirrorAndJoin(cage));
  sculptMannequin(half.points);

  // Put the feet on the floor: subdivision moves the soles.
  const Aabb bounds = boundsOf(half.points);
  for (Vec3& p : half.points) p.y() -= bounds.min.y();

  const std::vector<std::array<int, 3>> triangles = trianglesOf(half);
  std::string table;
  appendLittleEndian(static_cast<std::uint32_t>(half.points.size()), table);
  appendLittleEndian(static_cast<std::uint32_t>(triangles.size()), table);
  for (std::size_t v = 0; v < half.points.size(); ++v) {
    for (const double coordinate : half.points[v]) appendLittleEndian(coordinate, table);
    appendLittleEndian(static_cast<std::uint8_t>(half.weights[v].size()), table);
    for (const auto& [bone, weight] : half.weights[v]) {
      appendLittleEndian(static_cast<std::uint8_t>(bone), table);
      appendLittleEndian(weight, table);
    }
  }
  for (const std::array<int, 3>& triangle : triangles) {
    for (const int corner : triangle) appendLittleEndian(static_cast<std::uint16_t>(corner), table);
  }
  return table;
}

}  // namespace lorica
