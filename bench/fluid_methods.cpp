// Water by three methods: the library's position-based one, divergence-free SPH, and APIC on a grid. What a frame
// costs, how high deep water stands, whether it boils, and what is left of a splash: CSV on standard output.
//
// The other two are written here from their papers, plainly, for one thread. So compare their heights and energies with
// the library's as they are, and their costs as a bound from above: vectors would make them a few times faster.

#include "bench/measure.h"
#include "collision/particles/fluid.h"
#include "geometry/math.h"

#include <fmt/format.h>
#include <xxhash.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <memory>
#include <numbers>
#include <string>

namespace lorica::bench {
namespace {

constexpr double kFrame = 1.0 / 30.0;
constexpr float kSpacing = 0.02f;
constexpr float kGravity = 9.81f;
constexpr float kViscosity = 0.1f;  // XSPH, in 1/120 s

/// A box without a lid, from the origin on, and a block of water in its corner; all in drops.
struct Basin {
  int wide = 12, deep = 12, long_ = 12;  // of the water
  int space = 12;                        // length of the box
  [[nodiscard]] Vec3f size() const {
    return kSpacing * Vec3f(static_cast<float>(wide), 4.0f * static_cast<float>(deep), static_cast<float>(space));
  }
  [[nodiscard]] std::vector<Vec3f> drops() const {
    std::vector<Vec3f> made;
    made.reserve(static_cast<std::size_t>(wide) * deep * long_);
    for (int y = 0; y < deep; ++y) {
      for (int z = 0; z < long_; ++z) {
        for (int x = 0; x < wide; ++x) {
          made.emplace_back(kSpacing * (Vec3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)) +
                                        Vec3f::Constant(0.5f)));
        }
      }
    }
    return made;
  }
};

class Method {
 public:
  virtual ~Method() = default;
  virtual void step() = 0;  ///< a frame
  [[nodiscard]] virtual std::span<const Vec3f> positions() const = 0;
  [[nodiscard]] virtual std::span<const Vec3f> velocities() const = 0;
};

class OwnFluid final : public Method {
 public:
  explicit OwnFluid(const Basin& basin) : fluid_(settingsOf(basin)) { fluid_.add(basin.drops()); }
  void step() override { fluid_.step({}, kFrame); }
  [[nodiscard]] std::span<const Vec3f> positions() const override { return fluid_.positions(); }
  [[nodiscard]] std::span<const Vec3f> velocities() const override { return fluid_.velocities(); }

 private:
  static FluidSettings settingsOf(const Basin& basin) {
    FluidSettings settings;
    settings.capacity = basin.drops().size();
    settings.spacing = kSpacing;
    settings.walls = Aabb{Vec3::Zero(), basin.size().cast<double>()};
    return settings;
  }
  Fluid fluid_;
};

/// Positions and velocities, kept in the basin.
class Drops : public Method {
 public:
  explicit Drops(const Basin& basin)
      : size_(basin.size()), positions_(basin.drops()), velocities_(positions_.size(), Vec3f::Zero()) {}
  [[nodiscard]] std::span<const Vec3f> positions() const override { return positions_; }
  [[nodiscard]] std::span<const Vec3f> velocities() const override { return velocities_; }

 protected:
  [[nodiscard]] float fastest() const {
    float sq = 0.0f;
    for (const Vec3f& v : velocities_) sq = std::max(sq, v.squaredNorm());
    return std::sqrt(sq);
  }
  /// A drop stays this far from the walls, and does not go on towards them.
  void keepInside(std::size_t i, float distance) {
    for (int axis = 0; axis < 3; ++axis) {
      float &x = positions_[i][axis], &v = velocities_[i][axis];
      if (x < distance) {
        x = distance;
        v = std::max(v, 0.0f);
      } else if (x > size_[axis] - distance) {
        x = size_[axis] - distance;
        v = std::min(v, 0.0f);
      }
    }
  }
  Vec3f size_;
  std::vector<Vec3f> positions_, velocities_;
};

/// Bender and Koschier, Divergence-Free Smoothed Particle Hydrodynamics, 2015. Pressures against density start from the
/// last ones, and go up and down by half of the error (as in IISPH: Ihmsen et al. 2014). Walls are the integral of the
/// kernel over the half space behind them (as in Koschier and Bender, Density Maps, 2017). Densities are relative. With
/// steps twice as long, 30 layers boil.
class DivergenceFreeSph final : public Drops {
 public:
  explicit DivergenceFreeSph(const Basin& basin) : Drops(basin) {
    for (std::vector<float>* v : {&density_, &inverse_, &pressing_, &change_}) v->resize(positions_.size());
    for (std::vector<Vec3f>* v : {&wall_, &next_}) v->resize(positions_.size(), Vec3f::Zero());
    // The lattice has density 1, inside and next to a wall.
    float half = 0.0f, all = 0.0f;
    for (int x = -2; x <= 2; ++x) {
      for (int y = -2; y <= 2; ++y) {
        for (int z = -2; z <= 2; ++z) {
          const float w = kernel(kSpacing * std::sqrt(static_cast<float>(x * x + y * y + z * z)));
          all += w;
          if (y < 0) half += w;
        }
      }
    }
    mass_ = 1.0f / all;
    // Area of a sphere's cap behind the wall, times the kernel; and the derivative.
    const float step = kReach / kTable;
    for (int d = 0; d < kTable; ++d) {
      const float distance = step * static_cast<float>(d);
      for (int k = d; k < kTable; ++k) {
        const float r = step * (static_cast<float>(k) + 0.5f);
        const float ring = 2.0f * std::numbers::pi_v<float> * r * kernel(r) * step;
        wallDensity_[d] += ring * std::max(0.0f, r - distance);
        wallSlope_[d] += ring;
      }
    }
    const float scale = mass_ * half / wallDensity_[static_cast<int>(0.5f * kSpacing / step)];
    for (int d = 0; d < kTable; ++d) {
      wallDensity_[d] *= scale;
      wallSlope_[d] *= scale;
    }
  }

  void step() override {
    double left = kFrame;
    while (left > 1e-9) {
      const double dt = std::clamp(0.2 * kSpacing / std::max(1e-3f, fastest()), 1.0 / 480.0, 1.0 / 240.0);
      const double now = left / std::ceil(left / dt - 1e-6);
      substep(static_cast<float>(now));
      left -= now;
    }
  }

 private:
  static constexpr float kReach = 2.0f * kSpacing;
  static constexpr int kTable = 256, kMaxIterations = 100;
  static constexpr std::uint32_t kFew = 20;  // neighbours: with fewer, divergence is not corrected

  struct Near {
    std::uint32_t drop;
    float weight;
    Vec3f slope;  // of the density, away from the neighbour: negative along the way between them
  };

  // Cubic spline, but for its factor.
  static float kernel(float r) {
    const float q = r / kReach, rest = std::max(0.0f, 1.0f - q);
    return q < 0.5f ? 6.0f * (q * q * q - q * q) + 1.0f : 2.0f * rest * rest * rest;
  }
  static float kernelSlope(float r) {
    const float q = r / kReach, rest = std::max(0.0f, 1.0f - q);
    return (q < 0.5f ? 18.0f * q * q - 12.0f * q : -6.0f * rest * rest) / kReach;
  }

  void findNeighbours() {
    const auto cell = [](float x) { return std::max(0, static_cast<int>(x / kReach)); };
    const std::array<int, 3> cells = {cell(size_.x()) + 1, cell(size_.y()) + 1, cell(size_.z()) + 1};
    const auto at = [&](int x, int y, int z) { return (z * cells[0] + x) * cells[1] + y; };
    begin_.assign(static_cast<std::size_t>(cells[0]) * cells[1] * cells[2] + 1, 0);
    order_.resize(positions_.size());
    const auto cellOf = [&](const Vec3f& p) { return at(cell(p.x()), cell(p.y()), cell(p.z())); };
    for (const Vec3f& p : positions_) ++begin_[cellOf(p)];
    for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
    for (std::size_t i = positions_.size(); i-- > 0;) order_[--begin_[cellOf(positions_[i])]] = i;

    near_.clear();
    first_.assign(1, 0);
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      const Vec3f& p = positions_[i];
      float density = mass_ * kernel(0.0f), squares = 0.0f;
      Vec3f sum = wallTerms(p, density);
      wall_[i] = sum;
      const int y0 = std::max(0, cell(p.y()) - 1), y1 = std::min(cells[1] - 1, cell(p.y()) + 1);
      for (int z = std::max(0, cell(p.z()) - 1); z <= std::min(cells[2] - 1, cell(p.z()) + 1); ++z) {
        for (int x = std::max(0, cell(p.x()) - 1); x <= std::min(cells[0] - 1, cell(p.x()) + 1); ++x) {
          for (std::uint32_t k = begin_[at(x, y0, z)]; k < begin_[at(x, y1, z) + 1]; ++k) {
            const Vec3f way = p - positions_[order_[k]];
            const float distance = way.norm();
            if (order_[k] == i || distance >= kReach) continue;
            const float weight = mass_ * kernel(distance);
            const Vec3f slope = mass_ * kernelSlope(distance) / std::max(distance, 1e-6f) * way;
            near_.push_back({order_[k], weight, slope});
            density += weight;
            sum += slope;
            squares += slope.squaredNorm();
          }
        }
      }
      first_.push_back(static_cast<std::uint32_t>(near_.size()));
      density_[i] = density;
      inverse_[i] = 1.0f / std::max(sum.squaredNorm() + squares, 1e-6f / (kSpacing * kSpacing));
    }
  }

  Vec3f wallTerms(const Vec3f& p, float& density) const {
    Vec3f slope = Vec3f::Zero();
    for (int axis = 0; axis < 3; ++axis) {
      for (const float side : {1.0f, -1.0f}) {
        const float distance = side > 0.0f ? p[axis] : size_[axis] - p[axis];
        const int d = std::max(0, static_cast<int>(distance / kReach * kTable));
        if (d >= kTable) continue;
        density += wallDensity_[d];
        slope[axis] -= side * wallSlope_[d];
      }
    }
    return slope;
  }

  // Finds pressures for which no drop is denser than it should be after dt (or gets denser), and applies them.
  void solve(float dt, bool densities, std::vector<float>& pressure) {
    const std::size_t count = positions_.size();
    for (int iteration = 0;; ++iteration) {
      for (std::size_t i = 0; i < count; ++i) {
        Vec3f sum = pressure[i] * wall_[i];
        for (std::uint32_t k = first_[i]; k < first_[i + 1]; ++k) {
          sum += (pressure[i] + pressure[near_[k].drop]) * near_[k].slope;
        }
        next_[i] = velocities_[i] - dt * sum;
      }
      if (iteration == kMaxIterations) break;
      double error = 0.0;
      for (std::size_t i = 0; i < count; ++i) {
        float rate = next_[i].dot(wall_[i]);
        for (std::uint32_t k = first_[i]; k < first_[i + 1]; ++k) {
          rate += (next_[i] - next_[near_[k].drop]).dot(near_[k].slope);
        }
        const float excess = dt * rate + (densities ? density_[i] - 1.0f : 0.0f);
        const bool few = !densities && first_[i + 1] - first_[i] < kFew;
        change_[i] = few ? -pressure[i] : 0.5f * excess * inverse_[i] / (dt * dt);
        if (!few)
          error += (pressure[i] > 0.0f ? std::abs(excess) : std::max(0.0f, excess)) / static_cast<double>(count);
      }
      if (iteration >= 2 && error < 1e-3) break;
      for (std::size_t i = 0; i < count; ++i) pressure[i] = std::max(0.0f, pressure[i] + change_[i]);
    }
    std::swap(velocities_, next_);
  }

  void substep(float dt) {
    findNeighbours();
    diverging_.assign(positions_.size(), 0.0f);
    solve(dt, false, diverging_);
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      Vec3f others = Vec3f::Zero();
      for (std::uint32_t k = first_[i]; k < first_[i + 1]; ++k) {
        others += near_[k].weight * (velocities_[near_[k].drop] - velocities_[i]);
      }
      next_[i] = velocities_[i] + 120.0f * dt * kViscosity * others - Vec3f(0.0f, kGravity * dt, 0.0f);
    }
    std::swap(velocities_, next_);
    solve(dt, true, pressing_);
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      positions_[i] += dt * velocities_[i];
      keepInside(i, 0.25f * kSpacing);
    }
  }

  float mass_ = 1.0f;
  std::array<float, kTable> wallDensity_{}, wallSlope_{};
  std::vector<std::uint32_t> begin_, order_, first_;
  std::vector<Near> near_;
  std::vector<float> density_, inverse_, pressing_, diverging_, change_;
  std::vector<Vec3f> wall_, next_;
};

/// Jiang, Schroeder, Selle, Teran and Stomakhin, The Affine Particle-In-Cell Method, 2015: cells of two drops,
/// pressures by conjugate gradients. If wanted, drops are spread evenly by a second solution (Kugelstadt et al.,
/// Implicit Density Projection, 2019).
class AffineCells final : public Drops {
 public:
  AffineCells(const Basin& basin, bool spreads) : Drops(basin), spreads_(spreads) {
    for (int axis = 0; axis < 3; ++axis) cells_[axis] = static_cast<int>(std::lround(size_[axis] / kCell));
    affine_.assign(positions_.size(), Eigen::Matrix3f::Zero());
    for (int c = 0; c < 3; ++c) {
      for (std::vector<float>* v : {&speed_[c], &weight_[c]}) v->resize(countOf(c));
    }
    for (std::vector<float>* v : {&pressure_, &right_, &search_, &image_, &solved_, &fill_}) {
      v->resize(countOf(3));
    }
    wet_.resize(countOf(3));
  }

  void step() override {
    const int substeps = std::clamp(static_cast<int>(std::ceil(kFrame * fastest() / kCell)), 2, 8);
    for (int i = 0; i < substeps; ++i) substep(static_cast<float>(kFrame / substeps));
  }

 private:
  static constexpr float kCell = 2.0f * kSpacing;
  static constexpr float kMostSpread = 0.3f;  // of a cell's volume, corrected at once

  // Values of kind 0, 1, 2 are on the faces across that axis; those of kind 3 at the middles of cells.
  [[nodiscard]] int along(int kind, int axis) const { return cells_[axis] + (kind == axis ? 1 : 0); }
  [[nodiscard]] std::size_t countOf(int kind) const {
    return static_cast<std::size_t>(along(kind, 0)) * along(kind, 1) * along(kind, 2);
  }
  [[nodiscard]] std::size_t index(int kind, int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * along(kind, 1) + y) * along(kind, 0) + x;
  }
  [[nodiscard]] std::size_t stride(int kind, int axis) const {
    return axis == 0 ? 1 : axis == 1 ? along(kind, 0) : static_cast<std::size_t>(along(kind, 0)) * along(kind, 1);
  }

  /// Calls work(value's index, weight, weight's slope) for the eight values around a place.
  template <class Work>
  void around(int kind, const Vec3f& place, const Work& work) const {
    std::array<int, 3> low;
    std::array<std::array<float, 2>, 3> share, slope;
    for (int axis = 0; axis < 3; ++axis) {
      const float last = static_cast<float>(along(kind, axis) - 1);
      const float wanted = place[axis] / kCell - (kind == axis ? 0.0f : 0.5f), x = std::clamp(wanted, 0.0f, last);
      low[axis] = std::min(static_cast<int>(x), std::max(0, along(kind, axis) - 2));
      const float part = x - static_cast<float>(low[axis]), rise = x == wanted ? 1.0f / kCell : 0.0f;
      share[axis] = {1.0f - part, part};
      slope[axis] = {-rise, rise};
    }
    const std::size_t first = index(kind, low[0], low[1], low[2]);
    for (int k = 0; k < 8; ++k) {
      const int x = k & 1, y = k >> 1 & 1, z = k >> 2;
      const float a = share[0][x], b = share[1][y], c = share[2][z];
      work(first + x * stride(kind, 0) + y * stride(kind, 1) + z * stride(kind, 2), a * b * c,
           Vec3f(slope[0][x] * b * c, a * slope[1][y] * c, a * b * slope[2][z]));
    }
  }

  [[nodiscard]] Vec3f velocityAt(const Vec3f& place) const {
    Vec3f velocity = Vec3f::Zero();
    for (int c = 0; c < 3; ++c) {
      around(c, place, [&](std::size_t i, float w, const Vec3f&) { velocity[c] += w * speed_[c][i]; });
    }
    return velocity;
  }

  void substep(float dt) {
    toGrid(dt);
    findDivergence();
    solve();
    addGradient();
    extrapolate();
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      const Vec3f half = positions_[i] + 0.5f * dt * velocityAt(positions_[i]);
      velocities_[i].setZero();
      affine_[i].setZero();
      for (int c = 0; c < 3; ++c) {
        around(c, positions_[i], [&](std::size_t at, float w, const Vec3f& slope) {
          velocities_[i][c] += w * speed_[c][at];
          affine_[i].row(c) += speed_[c][at] * slope.transpose();
        });
      }
      positions_[i] += dt * velocityAt(half);
      keepInside(i, 0.01f * kSpacing);
    }
    if (spreads_) spread();
  }

  void toGrid(float dt) {
    std::fill(wet_.begin(), wet_.end(), std::uint8_t{0});
    for (const Vec3f& p : positions_) wet_[cellOf(p)] = 1;
    for (int c = 0; c < 3; ++c) {
      std::fill(speed_[c].begin(), speed_[c].end(), 0.0f);
      std::fill(weight_[c].begin(), weight_[c].end(), 0.0f);
      for (std::size_t i = 0; i < positions_.size(); ++i) {
        const Vec3f place = positions_[i] / kCell;
        around(c, positions_[i], [&](std::size_t at, float w, const Vec3f&) {
          const auto x = static_cast<int>(at % along(c, 0)), y = static_cast<int>(at / stride(c, 1) % along(c, 1)),
                     z = static_cast<int>(at / stride(c, 2));
          Vec3f node(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
          for (int axis = 0; axis < 3; ++axis) node[axis] += axis == c ? 0.0f : 0.5f;
          weight_[c][at] += w;
          speed_[c][at] += w * (velocities_[i][c] + kCell * affine_[i].row(c).dot(node - place));
        });
      }
      for (std::size_t at = 0; at < speed_[c].size(); ++at) {
        if (weight_[c][at] > 0.0f) speed_[c][at] = speed_[c][at] / weight_[c][at] - (c == 1 ? kGravity * dt : 0.0f);
      }
    }
  }

  [[nodiscard]] std::size_t cellOf(const Vec3f& p) const {
    std::array<int, 3> at;
    for (int axis = 0; axis < 3; ++axis) at[axis] = std::clamp(static_cast<int>(p[axis] / kCell), 0, cells_[axis] - 1);
    return index(3, at[0], at[1], at[2]);
  }

  /// Calls work(x, y, z, its index) for each cell.
  template <class Work>
  void forCells(const Work& work) const {
    std::size_t at = 0;
    for (int z = 0; z < cells_[2]; ++z) {
      for (int y = 0; y < cells_[1]; ++y) {
        for (int x = 0; x < cells_[0]; ++x) work(std::array{x, y, z}, at++);
      }
    }
  }

  void findDivergence() {
    for (int c = 0; c < 3; ++c) {
      forCells([&](const std::array<int, 3>& cell, std::size_t) {
        const std::size_t face = index(c, cell[0], cell[1], cell[2]);
        if (cell[c] == 0) speed_[c][face] = 0.0f;
        if (cell[c] == cells_[c] - 1) speed_[c][face + stride(c, c)] = 0.0f;
      });
    }
    forCells([&](const std::array<int, 3>& cell, std::size_t at) {
      right_[at] = 0.0f;
      if (wet_[at] == 0) return;
      for (int c = 0; c < 3; ++c) {
        const std::size_t face = index(c, cell[0], cell[1], cell[2]);
        right_[at] -= speed_[c][face + stride(c, c)] - speed_[c][face];
      }
    });
  }

  /// Pressures (times dt over density and cell size) whose gradient takes the divergence away; 0 where no drop is.
  void solve() {
    // -1 for each wet neighbour; on the diagonal, the number of neighbours that are not walls.
    std::fill(pressure_.begin(), pressure_.end(), 0.0f);
    rows_.clear();
    forCells([&](const std::array<int, 3>& cell, std::size_t at) {
      if (wet_[at] == 0) return;
      Row row{at, 0.0f, {}, {}};
      for (int c = 0; c < 3; ++c) {
        if (cell[c] > 0) {
          row.diagonal += 1.0f;
          row.before[c] = wet_[at - stride(3, c)] != 0;
        }
        if (cell[c] < cells_[c] - 1) {
          row.diagonal += 1.0f;
          row.after[c] = wet_[at + stride(3, c)] != 0;
        }
      }
      // A lump that only walls touch has no pressure that is known; this gives it one.
      row.diagonal = std::max(row.diagonal, 1.0f) * 1.0001f;
      rows_.push_back(row);
    });
    const std::array<std::size_t, 3> next = {stride(3, 0), stride(3, 1), stride(3, 2)};
    const auto precondition = [&] {
      for (const Row& row : rows_) solved_[row.at] = right_[row.at] / row.diagonal;
    };
    const auto dot = [&](const std::vector<float>& a, const std::vector<float>& b) {
      double sum = 0.0;
      for (const Row& row : rows_) sum += static_cast<double>(a[row.at]) * b[row.at];
      return sum;
    };
    const double wanted = 1e-8 * dot(right_, right_);  // 1e-4 of the divergence
    precondition();
    search_ = solved_;
    double sigma = dot(solved_, right_);
    for (int iteration = 0; iteration < 200 && dot(right_, right_) > std::max(wanted, 1e-16); ++iteration) {
      for (const Row& row : rows_) {
        float sum = row.diagonal * search_[row.at];
        for (int c = 0; c < 3; ++c) {
          if (row.before[c] != 0) sum -= search_[row.at - next[c]];
          if (row.after[c] != 0) sum -= search_[row.at + next[c]];
        }
        image_[row.at] = sum;
      }
      const auto alpha = static_cast<float>(sigma / dot(search_, image_));
      for (const Row& row : rows_) {
        pressure_[row.at] += alpha * search_[row.at];
        right_[row.at] -= alpha * image_[row.at];
      }
      precondition();
      const double sigmaNow = dot(solved_, right_);
      const auto beta = static_cast<float>(sigmaNow / sigma);
      for (const Row& row : rows_) search_[row.at] = solved_[row.at] + beta * search_[row.at];
      sigma = sigmaNow;
    }
  }

  void addGradient() {
    for (int c = 0; c < 3; ++c) {
      std::fill(weight_[c].begin(), weight_[c].end(), 0.0f);  // 1 where the speed is known
    }
    for (const Row& row : rows_) {
      const std::array<int, 3> cell = {static_cast<int>(row.at % cells_[0]),
                                       static_cast<int>(row.at / stride(3, 1) % cells_[1]),
                                       static_cast<int>(row.at / stride(3, 2))};
      for (int c = 0; c < 3; ++c) {
        const std::size_t face = index(c, cell[0], cell[1], cell[2]), far = face + stride(c, c);
        if (cell[c] > 0) speed_[c][face] -= pressure_[row.at];
        if (cell[c] < cells_[c] - 1) speed_[c][far] += pressure_[row.at];
        weight_[c][face] = weight_[c][far] = 1.0f;
      }
    }
  }

  /// Speeds of two layers of faces around the water; those farther out do not matter.
  void extrapolate() {
    for (const float layer : {2.0f, 3.0f}) {
      for (int c = 0; c < 3; ++c) {
        for (std::size_t at = 0; at < speed_[c].size(); ++at) {
          if (weight_[c][at] > 0.0f) continue;
          float sum = 0.0f, count = 0.0f;
          for (int axis = 0; axis < 3; ++axis) {
            const std::size_t step = stride(c, axis), place = at / step % along(c, axis);
            for (const std::size_t other : {place > 0 ? at - step : at, at + step}) {
              if ((other > at && place + 1 == static_cast<std::size_t>(along(c, axis))) || weight_[c][other] <= 0.0f ||
                  weight_[c][other] >= layer) {
                continue;
              }
              sum += speed_[c][other];
              count += 1.0f;
            }
          }
          if (count == 0.0f) continue;
          speed_[c][at] = sum / count;
          weight_[c][at] = layer;
        }
      }
    }
  }

  /// Moves drops from cells with too many to those with too few.
  void spread() {
    std::fill(wet_.begin(), wet_.end(), std::uint8_t{0});
    std::fill(fill_.begin(), fill_.end(), 0.0f);
    const float volume = std::pow(kSpacing / kCell, 3.0f);
    for (const Vec3f& p : positions_) {
      wet_[cellOf(p)] = 1;
      around(3, p, [&](std::size_t at, float w, const Vec3f&) { fill_[at] += w * volume; });
    }
    forCells([&](const std::array<int, 3>& cell, std::size_t at) {
      bool inner = true;  // cells at the surface may be part empty
      for (int c = 0; c < 3; ++c) {
        inner = inner && (cell[c] == 0 || wet_[at - stride(3, c)] != 0) &&
                (cell[c] == cells_[c] - 1 || wet_[at + stride(3, c)] != 0);
      }
      right_[at] = std::clamp(fill_[at] - 1.0f, inner ? -kMostSpread : 0.0f, kMostSpread);
    });
    solve();
    for (int c = 0; c < 3; ++c) std::fill(speed_[c].begin(), speed_[c].end(), 0.0f);
    addGradient();
    extrapolate();
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      positions_[i] += kCell * velocityAt(positions_[i]);
      keepInside(i, 0.01f * kSpacing);
    }
  }

  struct Row {
    std::size_t at;
    float diagonal;
    std::array<std::uint8_t, 3> before, after;  // whether that neighbour is wet
  };
  bool spreads_;
  std::array<int, 3> cells_;
  std::vector<Eigen::Matrix3f> affine_;
  std::array<std::vector<float>, 3> speed_, weight_;
  std::vector<float> pressure_, right_, search_, image_, solved_, fill_;
  std::vector<std::uint8_t> wet_;
  std::vector<Row> rows_;
};

struct Options {
  int seconds = 12;
  int width = 12;
  std::string only;
};

double cpuMilliseconds() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

void measure(const std::string& name, const std::string& scene, const Basin& basin, int seconds, Method& method) {
  const double ideal = 0.5 * kSpacing * basin.deep * basin.long_ / basin.space;  // mean height at rest
  const double count = static_cast<double>(method.positions().size());
  const double atFirst = kGravity * (0.5 * kSpacing * basin.deep - ideal);
  const int frames = 30 * seconds;
  std::vector<double> cpu, height, moving;
  for (int f = 0; f < frames; ++f) {
    const double before = cpuMilliseconds();
    method.step();
    cpu.push_back(cpuMilliseconds() - before);
    double y = 0.0, energy = 0.0;
    for (const Vec3f& p : method.positions()) y += p.y() / count;
    for (const Vec3f& v : method.velocities()) energy += 0.5 * v.squaredNorm() / count;
    height.push_back(y);
    moving.push_back(energy);
  }
  const auto mean = [](const std::vector<double>& of, int first) {  // over a second
    return meanOf(std::span(of).subspan(first, 30));
  };
  // Of the energy that the block had above rest. A basin that starts at rest has none.
  const auto left = [&](int frame) {
    return atFirst < 1e-6 ? 0.0 : (moving[frame - 1] + kGravity * (height[frame - 1] - ideal)) / atFirst;
  };
  const double end = mean(height, frames - 30) / ideal;
  fmt::print("{},{},{:.0f},{:.2f},{:.0f},{:.3f},{:.2f},{:.2f},{:.2f},{:.2f},{:016x}\n", name, scene, count,
             medianOf(cpu), medianOf(cpu) * 1e5 / count, end, 100.0 * (mean(height, 45) / ideal - end),
             1e3 * mean(moving, frames - 30), left(30), left(60),
             XXH3_64bits(method.positions().data(), method.positions().size_bytes()));
  std::fflush(stdout);
}

int run(const Options& options) {
  fmt::print(
      "method,scene,drops,cpu ms a frame,the same for 100000,height at rest,% of height lost from "
      "2 s on,mJ/kg at rest,energy left after 1 s,after 2 s,hash\n");
  const int w = options.width;
  const std::array<std::pair<const char*, Basin>, 4> scenes = {{
      {"15 layers", {w, 15, w, w}},
      {"30 layers", {w, 30, w, w}},
      {"50 layers", {w, 50, w, w}},
      {"dam", {w, 2 * w, w, 2 * w}},
  }};
  for (const auto& [scene, basin] : scenes) {
    const auto measureOne = [&, scene = scene, basin = basin](const char* name, std::unique_ptr<Method> method) {
      if (!options.only.empty() && options.only.find(name[0]) == std::string::npos) return;
      measure(name, scene, basin, options.seconds, *method);
    };
    measureOne("position-based", std::make_unique<OwnFluid>(basin));
    measureOne("divergence-free SPH", std::make_unique<DivergenceFreeSph>(basin));
    measureOne("APIC", std::make_unique<AffineCells>(basin, false));
    measureOne("APIC; drops spread", std::make_unique<AffineCells>(basin, true));
  }
  return 0;
}

}  // namespace
}  // namespace lorica::bench

int main(int argc, char** argv) {
  lorica::bench::Options options;
  CLI::App app("Compares three methods for water");
  app.add_option("--seconds", options.seconds)->check(CLI::Range(4, 1000));
  app.add_option("--width", options.width, "Of the basin, in drops; even")->check(CLI::Range(4, 100));
  app.add_option("--only", options.only, "Methods, by their first letters");
  CLI11_PARSE(app, argc, argv);
  return lorica::bench::run(options);
}
