#include "geometry/counts.h"
#include "tests/bench/generators/mannequin_cage.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lorica {

namespace {

using enum HumanBone;

constexpr int kColumns = 9;  ///< of the left half: 0 is the middle of the front, 4 the side, 8 the middle of the back
using Row = std::array<int, kColumns>;

/// A horizontal section: an oval, squarer if `square` is below 1.
struct Section {
  double yFront, ySide, yBack;
  double halfWidth;
  double zFront, zBack, zSide;
  double square;
};

// From the hip crease up to the hollow of the neck.
constexpr Section kTrunk[] = {
    {0.838, 0.892, 0.848, 0.170, 0.072, -0.090, -0.012, 0.86},  // hip crease, gluteal cleft
    {0.940, 0.950, 0.935, 0.160, 0.098, -0.110, -0.012, 0.90},  // widest part of the pelvis
    {1.020, 1.020, 1.015, 0.143, 0.100, -0.096, -0.008, 0.93},  // iliac crest
    {1.095, 1.095, 1.095, 0.129, 0.096, -0.084, -0.003, 0.96},  // waist
    {1.185, 1.185, 1.185, 0.145, 0.108, -0.100, -0.006, 0.96},  // lower ribs
    {1.285, 1.300, 1.290, 0.162, 0.115, -0.117, -0.012, 0.92},  // pit of the arm
    {1.340, 1.350, 1.350, 0.163, 0.110, -0.121, -0.015, 0.90},
    {1.390, 1.400, 1.405, 0.160, 0.089, -0.115, -0.018, 0.90},
    {1.428, 1.456, 1.462, 0.147, 0.056, -0.095, -0.020, 0.88},  // top of the shoulder, hollow of the neck
};
constexpr int kTrunkRows = 9;
constexpr int kArmRow = 5;     ///< the arm's opening spans rows 5 to 8 ...
constexpr int kArmColumn = 3;  ///< ... and columns 3 to 5

// From the root of the neck to the forehead.
constexpr Section kNeckAndHead[] = {
    {1.450, 1.482, 1.500, 0.074, 0.038, -0.080, -0.024, 1.00},   // slope of the trapezius
    {1.490, 1.520, 1.535, 0.055, 0.030, -0.074, -0.024, 1.00},   // neck
    {1.522, 1.555, 1.580, 0.057, 0.052, -0.078, -0.012, 0.95},   // under the jaw, nape
    {1.536, 1.578, 1.610, 0.066, 0.092, -0.092, -0.004, 0.95},   // chin
    {1.570, 1.605, 1.640, 0.070, 0.099, -0.100, -0.004, 0.92},   // mouth
    {1.612, 1.642, 1.668, 0.0745, 0.101, -0.103, -0.004, 0.90},  // nose
    {1.660, 1.680, 1.695, 0.0755, 0.098, -0.102, -0.004, 0.90},  // brow
    {1.708, 1.716, 1.722, 0.066, 0.080, -0.086, -0.004, 0.92},   // forehead
};

[[nodiscard]] double bent(double s, double exponent) {
  return std::copysign(std::pow(std::abs(s), exponent), s);
}

[[nodiscard]] Vec3 pointOn(const Section& s, int column) {
  if (column == 0) return {0.0, s.yFront, s.zFront};
  if (column == kColumns - 1) return {0.0, s.yBack, s.zBack};
  const double angle = std::numbers::pi * column / (kColumns - 1);
  const double side = std::sin(angle);
  const double front = std::cos(angle);
  const bool ahead = column < 4;
  const double blend = column == 4 ? 0.0 : front * front;
  return {s.halfWidth * bent(side, s.square), s.ySide + blend * ((ahead ? s.yFront : s.yBack) - s.ySide),
          s.zSide + std::abs(bent(front, s.square)) * (column == 4 ? 0.0 : (ahead ? s.zFront : s.zBack) - s.zSide)};
}

/// Rises from 0 to 1 around the joint at `y`.
[[nodiscard]] double passed(double height, double y, double halfWidth) {
  return std::clamp((height - y) / (2.0 * halfWidth) + 0.5, 0.0, 1.0);
}

/// Weights along the spine: each bone blends into the next one up.
[[nodiscard]] BoneWeights spineWeights(double y) {
  const double spine = passed(y, 1.04, 0.07);
  const double chest = passed(y, 1.15, 0.07);
  const double upper = passed(y, 1.28, 0.07);
  BoneWeights weights;
  for (const auto& [bone, w] :
       BoneWeights{{kHips, 1.0 - spine}, {kSpine, spine - chest}, {kChest, chest - upper}, {kUpperChest, upper}}) {
    if (w > 0.0) weights.emplace_back(bone, w);
  }
  return weights;
}

/// Gives the fraction `share` of a point's weight to another bone.
[[nodiscard]] BoneWeights withShare(BoneWeights weights, HumanBone bone, double share) {
  if (share <= 0.0) return weights;
  for (auto& [other, w] : weights) w *= 1.0 - share;
  weights.emplace_back(bone, share);
  return weights;
}

// Weight of the thigh in the two lowest rows, by column.
constexpr double kThighShare[2][kColumns] = {{0.0, 0.22, 0.40, 0.48, 0.50, 0.46, 0.38, 0.20, 0.0},
                                             {0.0, 0.0, 0.08, 0.12, 0.14, 0.12, 0.06, 0.0, 0.0}};
// Weights of the collarbone and the upper arm in rows 5 to 8, by column.
constexpr double kCollarShare[4][kColumns] = {{0.0, 0.0, 0.04, 0.08, 0.08, 0.08, 0.05, 0.0, 0.0},
                                              {0.0, 0.0, 0.12, 0.25, 0.0, 0.25, 0.15, 0.05, 0.0},
                                              {0.0, 0.05, 0.22, 0.40, 0.0, 0.40, 0.25, 0.08, 0.0},
                                              {0.0, 0.08, 0.30, 0.55, 0.60, 0.55, 0.35, 0.10, 0.0}};
constexpr double kUpperArmShare[4][kColumns] = {{0.0, 0.0, 0.02, 0.16, 0.28, 0.16, 0.03, 0.0, 0.0},
                                                {0.0, 0.0, 0.06, 0.30, 0.0, 0.30, 0.06, 0.0, 0.0},
                                                {0.0, 0.0, 0.06, 0.34, 0.0, 0.34, 0.06, 0.0, 0.0},
                                                {0.0, 0.0, 0.04, 0.32, 0.38, 0.32, 0.05, 0.0, 0.0}};

[[nodiscard]] BoneWeights trunkWeights(int row, int column, const Vec3& p) {
  BoneWeights weights = spineWeights(p.y());
  if (row < 2) return withShare(std::move(weights), kLeftUpperLeg, kThighShare[row][column]);
  if (row < kArmRow) return weights;
  weights = withShare(std::move(weights), kLeftShoulder, kCollarShare[row - kArmRow][column]);
  return withShare(std::move(weights), kLeftUpperArm, kUpperArmShare[row - kArmRow][column]);
}

[[nodiscard]] BoneWeights neckAndHeadWeights(int row, int column) {
  const double back = column / 8.0;
  switch (row) {
    case 0: {
      const BoneWeights root = {{kUpperChest, 0.72}, {kNeck, 0.28}};
      return withShare(root, kLeftShoulder, column > 1 && column < 7 ? 0.15 : 0.0);
    }
    case 1:
      return {{kUpperChest, 0.12}, {kNeck, 0.78}, {kHead, 0.10}};
    case 2:
      return {{kNeck, 0.45 + 0.1 * back}, {kHead, 0.55 - 0.1 * back}};
    case 3:
      return {{kNeck, 0.05 + 0.2 * back}, {kHead, 0.95 - 0.2 * back}};
    default:
      return {{kHead, 1.0}};
  }
}

}  // namespace

TrunkOpenings addTrunkAndHead(HalfCage& cage) {
  std::vector<Row> rows;
  const auto stack = [&](const Row& row) {
    if (!rows.empty()) {
      const Row& below = rows.back();
      const int first = countOf(rows) - 1;
      for (std::size_t k = 0; k + 1 < kColumns; ++k) {
        const bool inArm = first >= kArmRow && first < kArmRow + 3 && (k == kArmColumn || k == kArmColumn + 1);
        if (!inArm) cage.addFace({below[k], below[k + 1], row[k + 1], row[k]});
      }
    }
    rows.push_back(row);
  };

  // The rim of the arm's opening is set point by point: a fold of chest muscle in front, a fold of back muscle behind,
  // and a hollow between them.
  const Vec3 rim[4][3] = {{{0.147, 1.306, 0.056}, {0.158, 1.320, -0.014}, {0.152, 1.304, -0.086}},
                          {{0.157, 1.350, 0.060}, {}, {0.160, 1.352, -0.092}},
                          {{0.158, 1.404, 0.050}, {}, {0.160, 1.406, -0.085}},
                          {{0.149, 1.443, 0.026}, {0.150, 1.457, -0.018}, {0.149, 1.452, -0.060}}};
  for (int r = 0; r < kTrunkRows; ++r) {
    Row row{};
    for (int k = 0; k < kColumns; ++k) {
      const bool onRim = r >= kArmRow && k >= kArmColumn && k <= kArmColumn + 2;
      if (onRim && k == kArmColumn + 1 && (r == kArmRow + 1 || r == kArmRow + 2)) {
        row[k] = -1;  // inside the opening
        continue;
      }
      const Vec3 p = onRim ? rim[r - kArmRow][k - kArmColumn] : pointOn(kTrunk[r], k);
      row[k] = cage.addPoint(p, trunkWeights(r, k, p));
    }
    stack(row);
  }
  int headRow = 0;
  for (const Section& section : kNeckAndHead) {
    Row row{};
    for (int k = 0; k < kColumns; ++k) {
      row[k] = cage.addPoint(pointOn(section, k), neckAndHeadWeights(headRow, k));
    }
    stack(row);
    ++headRow;
  }

  // The crown is a grid of 4 x 4 quads, of which this half has 2 x 4; its corners are columns 2 and 6.
  //
  //   z    0 - 1 - 2      column numbers of the last row; m in the plane of symmetry
  //   ^    m - h - 3
  //   |    m - h - 4
  //   +> x m - h - 5
  //        8 - 7 - 6
  const BoneWeights head = {{kHead, 1.0}};
  const Row& top = rows.back();
  const Vec3 middle[3] = {{0.0, 1.738, 0.046}, {0.0, 1.752, -0.006}, {0.0, 1.742, -0.056}};
  const Vec3 off[3] = {{0.034, 1.732, 0.042}, {0.038, 1.744, -0.006}, {0.035, 1.735, -0.052}};
  int grid[5][3] = {{top[0], top[1], top[2]}, {}, {}, {}, {top[8], top[7], top[6]}};
  for (int j = 1; j <= 3; ++j) {
    grid[j][0] = cage.addPoint(middle[j - 1], head);
    grid[j][1] = cage.addPoint(off[j - 1], head);
    grid[j][2] = top[j + 2];
  }
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 2; ++i) cage.addFace({grid[j][i], grid[j][i + 1], grid[j + 1][i + 1], grid[j + 1][i]});
  }

  TrunkOpenings openings;
  const auto at = [&](int row, int column) { return rows[row][column]; };
  openings.arm = {at(8, 4), at(8, 3), at(7, 3), at(6, 3), at(5, 3), at(5, 4), at(5, 5), at(6, 5), at(7, 5), at(8, 5)};
  for (int k = kColumns - 1; k >= 0; --k) openings.leg.push_back(at(0, k));
  openings.leg.push_back(cage.addPoint({0.0, 0.812, -0.008}, {{kHips, 1.0}}));
  return openings;
}

}  // namespace lorica
