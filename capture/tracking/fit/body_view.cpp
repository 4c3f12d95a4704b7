#include "capture/tracking/fit/body_view.h"

#include <algorithm>
#include <cmath>

namespace lorica::fit {
namespace {

constexpr int kMargin = 14;           ///< around the person [blocks]
constexpr float kLayer = 0.06F;       ///< depths this far behind a block's nearest one belong to another layer [m]
constexpr float kNormalStep = 0.07F;  ///< neighbours that differ by more in depth belong to another surface [m]
constexpr int kCutBlocks = 6;         ///< blocks at the image border for the person to count as cut off
constexpr std::size_t kMaxPoints = 4000;
constexpr std::size_t kOutlierShare = 200;  ///< one of so many points may lie beyond the top or bottom of the others
constexpr std::size_t kLowShare = 100;      ///< one of so many points may lie below the ground that the others show
constexpr float kLowMargin = 0.02F;         ///< from the lowest points seen down to the ground [m]

constexpr float kFarBlocks = 1e6F;
constexpr float kHiderGap = 0.15F;    ///< something nearer than the person beside it by this much may hide more [m]
constexpr int kOccluderBlocks = 3;    ///< of the eight around a block of something that hides the person
constexpr int kRampBlocks = 6;        ///< width of the edges that blur makes, at most [blocks]
constexpr int kRampRows = 4;          ///< every so many rows of the image is looked at
constexpr int kRampFall = 300;        ///< least difference in depth on both sides of an edge [mm]
constexpr int kRampFlat = 10;         ///< on either side it changes by less than one of so many parts of that
constexpr int kStepShare = 3;         ///< a step has one of so many parts of it between two pixels
constexpr int kRampCount = 20;        ///< least count of places where an edge is a ramp
constexpr int kRampMajority = 4;      ///< so many times the places where it is a step
constexpr float kRampSlope = 2.0F;    ///< of a ramp, least fall per step aside
constexpr float kAboveFloor = 0.10F;  ///< what is lower may be the floor [m]
constexpr int kMarginShare = 5;       ///< cameras leave margins empty that are narrower than one of so many parts
constexpr int kEmptyShare = 50;       ///< of a line in a margin less than one of so many parts is measured ...
constexpr int kFilledShare = 3;       ///< ... and beside it at least one of so many: what ends there is the image

enum Kind : std::uint8_t { kElse, kPerson, kUnknown, kNearer, kOccluder };

/// Rank of a cell in an 8 x 8 ordered dither (Bayer 1973): every prefix is evenly distributed.
int bayerRank(int x, int y) {
  int rank = 0;
  for (int bit = 0; bit < 3; ++bit) {
    const int a = (x >> bit) & 1;
    const int b = (y >> bit) & 1;
    rank = rank * 4 + ((a ^ b) * 2 + b);
  }
  return rank;
}

}  // namespace

BodyView::BodyView(const DepthCamera& camera)
    : camera_(camera),
      block_(isSmall(camera) ? 2 : 4),
      focalX_(camera.focalX()),
      focalY_(camera.focalY()),
      columns_(camera.width / block_),
      rows_(camera.height / block_) {
  const auto count = static_cast<std::size_t>(columns_) * rows_;
  blocks_.resize(count);
  positions_.resize(count);
  outside_.resize(count);
  scratch_.resize(count);
  measured_.resize(static_cast<std::size_t>(columns_) + rows_);
  points_.reserve(kMaxPoints);
  for (auto& list : byRank_) list.reserve(count / 64 + 64);
}

V3 BodyView::cameraPositionOf(float column, float row, float depth) const {
  return {(column - 0.5F * camera_.width) * depth / focalX_, (0.5F * camera_.height - row) * depth / focalY_, -depth};
}

void BodyView::look(std::span<const std::uint16_t> depthMm, std::span<const std::uint8_t> labels, std::uint8_t label,
                    const Isometry3& floorFromCamera, bool floorFound) {
  floorFromCamera_ = floorFromCamera.linear().cast<float>();
  cameraPosition_ = floorFromCamera.translation().cast<float>();
  gather(depthMm, labels, label);
  distances();
  makePoints();
  findGround(floorFound);
}

void BodyView::findGround(bool floorFound) {
  ground_.reset();
  if (floorFound) {
    ground_ = 0.0F;
  } else if (!cutBelow_ && !points_.empty()) {
    for (std::size_t k = 0; k < points_.size(); ++k) scratch_[k] = points_[k].position.y();
    const auto low = scratch_.begin() + points_.size() / kLowShare;
    std::nth_element(scratch_.begin(), low, scratch_.begin() + points_.size());
    ground_ = *low - kLowMargin;
  }
}

void BodyView::gather(std::span<const std::uint16_t> depthMm, std::span<const std::uint8_t> labels,
                      std::uint8_t label) {
  left_ = columns_;
  right_ = 0;
  top_ = rows_;
  bottom_ = 0;
  std::ranges::fill(measured_, 0);
  const int width = camera_.width;
  // Pixels of the person for a block to count as theirs, and those that must lie in its nearest layer.
  const int minPixels = block_ == 4 ? 5 : 2, minLayer = block_ == 4 ? 3 : 1;
  for (int by = 0; by < rows_; ++by) {
    for (int bx = 0; bx < columns_; ++bx) {
      const auto first = static_cast<std::size_t>(by * block_) * width + bx * block_;
      int mine = 0;
      int missing = 0;
      std::uint16_t nearest = 0xffff;
      std::uint16_t nearestElse = 0xffff;
      for (int y = 0; y < block_; ++y) {
        const std::size_t at = first + static_cast<std::size_t>(y) * width;
        for (std::size_t x = 0; x < static_cast<std::size_t>(block_); ++x) {
          const std::uint16_t mm = depthMm[at + x];
          if (mm == 0) {
            ++missing;
          } else if (labels[at + x] == label) {
            ++mine;
            nearest = std::min(nearest, mm);
          } else {
            nearestElse = std::min(nearestElse, mm);
          }
        }
      }
      const auto index = static_cast<std::size_t>(by) * columns_ + bx;
      Block& block = blocks_[index];
      block.kind = kElse;
      if (2 * missing <= block_ * block_) {
        ++measured_[bx];
        ++measured_[columns_ + by];
      }
      block.depth = nearestElse == 0xffff ? 0.0F : 0.001F * nearestElse;
      if (mine < minPixels) {
        if (missing > block_ * block_ / 2) block.kind = kUnknown;
        continue;
      }
      float sum = 0.0F, sumX = 0.0F, sumY = 0.0F;
      int count = 0;
      const float limit = nearest + 1000.0F * kLayer;
      for (int y = 0; y < block_; ++y) {
        const std::size_t at = first + static_cast<std::size_t>(y) * width;
        for (std::size_t x = 0; x < static_cast<std::size_t>(block_); ++x) {
          const float mm = depthMm[at + x];
          if (mm == 0.0F || labels[at + x] != label || mm > limit) continue;
          sum += mm;
          sumX += x;
          sumY += y;
          ++count;
        }
      }
      if (count < minLayer) continue;
      const float share = 1.0F / count;
      block.kind = kPerson;
      block.depth = 0.001F * sum * share;
      positions_[index] =
          cameraPositionOf(bx * block_ + 0.5F + sumX * share, by * block_ + 0.5F + sumY * share, block.depth);
      left_ = std::min(left_, bx);
      right_ = std::max(right_, bx + 1);
      top_ = std::min(top_, by);
      bottom_ = std::max(bottom_, by + 1);
    }
  }
  blurred_ = isBlurred(depthMm);
  if (blurred_) dropRamps();
  findMargins();
  int border = 0;
  for (int by = 0; by < rows_; ++by) {
    for (const int k : {0, 1, 2}) {
      for (const int bx : {firstColumn_ + k, lastColumn_ - k}) border += blocks_[indexOf(bx, by)].kind == kPerson;
    }
  }
  for (int bx = 0; bx < columns_; ++bx) {
    for (const int k : {0, 1}) {
      for (const int by : {firstRow_ + k, lastRow_ - k}) border += blocks_[indexOf(bx, by)].kind == kPerson;
    }
  }
  cut_ = border >= kCutBlocks;
  cutBelow_ = bottom_ >= lastRow_;
  cutAbove_ = top_ <= firstRow_ + 1;
  left_ = std::max(0, left_ - kMargin);
  top_ = std::max(0, top_ - kMargin);
  right_ = std::min(columns_, right_ + kMargin);
  bottom_ = std::min(rows_, bottom_ + kMargin);
}

/// Cameras that align their depth with a picture leave margins empty. What is cut off there ends at the image's border.
void BodyView::findMargins() {
  const auto marginOf = [](const int* measured, int count, int step, int across) {
    int margin = 0;
    while (margin < count && measured[margin * step] * kEmptyShare < across) ++margin;
    const bool isMargin =
        margin > 0 && margin * kMarginShare <= count && measured[margin * step] * kFilledShare >= across;
    return isMargin ? margin : 0;
  };
  const int* columns = measured_.data();
  const int* rows = columns + columns_;
  firstColumn_ = marginOf(columns, columns_, 1, rows_);
  lastColumn_ = columns_ - 1 - marginOf(columns + columns_ - 1, columns_, -1, rows_);
  firstRow_ = marginOf(rows, rows_, 1, columns_);
  lastRow_ = rows_ - 1 - marginOf(rows + rows_ - 1, rows_, -1, columns_);
}

/// Whether the image's depth edges around the person are ramps instead of steps: filters of the camera blurred them.
bool BodyView::isBlurred(std::span<const std::uint16_t> depthMm) const {
  const int width = camera_.width, wide = kRampBlocks * block_, flat = block_;
  const int from = std::max(left_ * block_ - wide, flat), to = std::min(right_ * block_, width - wide - flat);
  int ramps = 0, steps = 0;
  for (int y = top_ * block_; y < bottom_ * block_; y += kRampRows) {
    const std::uint16_t* row = &depthMm[static_cast<std::size_t>(y) * width];
    for (int x = from; x < to; ++x) {
      const int near = row[x], far = row[x + wide];
      const int fall = std::abs(far - near);
      if (near == 0 || far == 0 || fall < kRampFall) continue;
      if (std::abs(row[x - flat] - near) * kRampFlat > fall) continue;
      if (std::abs(row[x + wide + flat] - far) * kRampFlat > fall) continue;
      int largest = 0;
      bool whole = true;
      for (int k = x; k < x + wide; ++k) {
        largest = std::max(largest, std::abs(row[k + 1] - row[k]));
        whole = whole && row[k] != 0;
      }
      if (!whole) continue;
      ++(largest * kStepShare > fall ? steps : ramps);
    }
  }
  return ramps > kRampCount + kRampMajority * steps;
}

/// On a ramp between the person and what is behind nothing is seen of either.
void BodyView::dropRamps() {
  for (int y = top_; y < bottom_; ++y) {
    for (int x = left_; x < right_; ++x) {
      const std::size_t i = indexOf(x, y);
      if (blocks_[i].kind != kPerson) continue;
      const float least = kRampSlope * block_ * blocks_[i].depth / focalX_;
      const auto falls = [&](bool inside, std::size_t by) {
        if (!inside) return false;
        const float before = blocks_[i - by].depth, after = blocks_[i + by].depth;
        if (before == 0.0F || after == 0.0F) return false;
        const float first = blocks_[i].depth - before, second = after - blocks_[i].depth;
        return std::min(first, second) > least || std::max(first, second) < -least;
      };
      if (falls(x > 0 && x + 1 < columns_, 1) || falls(y > 0 && y + 1 < rows_, columns_)) blocks_[i].kind = kUnknown;
    }
  }
}

/// Visits the blocks twice, each with its neighbours in the direction of the pass (Borgefors 1986).
/// @param relax  called with a block, a neighbour, and the step between them [blocks]
template <typename Relax>
void BodyView::sweep(const Relax& relax) const {
  const auto visit = [&](int x, int y, int u, int v, float step) {
    if (u >= left_ && u < right_ && v >= top_ && v < bottom_) relax(indexOf(x, y), indexOf(u, v), step);
  };
  for (int y = top_; y < bottom_; ++y) {
    for (int x = left_; x < right_; ++x) {
      visit(x, y, x - 1, y, 1.0F);
      visit(x, y, x, y - 1, 1.0F);
      visit(x, y, x - 1, y - 1, 1.4F);
      visit(x, y, x + 1, y - 1, 1.4F);
    }
  }
  for (int y = bottom_ - 1; y >= top_; --y) {
    for (int x = right_ - 1; x >= left_; --x) {
      visit(x, y, x + 1, y, 1.0F);
      visit(x, y, x, y + 1, 1.0F);
      visit(x, y, x + 1, y + 1, 1.4F);
      visit(x, y, x - 1, y + 1, 1.4F);
    }
  }
}

/// What is clearly nearer than the person beside it may hide more of them: the outline there is not the person's.
void BodyView::markOccluders() {
  // The depth of the nearest block of the person.
  std::vector<float>& away = outside_;
  std::vector<float>& depth = scratch_;
  for (int y = top_; y < bottom_; ++y) {
    for (int x = left_; x < right_; ++x) {
      const std::size_t i = indexOf(x, y);
      away[i] = blocks_[i].kind == kPerson ? 0.0F : kFarBlocks;
      depth[i] = blocks_[i].depth;
    }
  }
  sweep([&](std::size_t i, std::size_t j, float step) {
    if (away[j] + step >= away[i]) return;
    away[i] = away[j] + step;
    depth[i] = depth[j];
  });
  const float size = block_;
  for (int y = top_; y < bottom_; ++y) {
    for (int x = left_; x < right_; ++x) {
      const std::size_t i = indexOf(x, y);
      Block& block = blocks_[i];
      if (block.kind != kElse || block.depth == 0.0F || block.depth > depth[i] - kHiderGap) continue;
      const V3 position = cameraPositionOf((x + 0.5F) * size, (y + 0.5F) * size, block.depth);
      if ((floorFromCamera_ * position + cameraPosition_).y() > kAboveFloor) block.kind = kNearer;
    }
  }
  // Slivers beside a limb are the limb's own edge.
  const auto isNearer = [&](int x, int y) {
    if (x < left_ || x >= right_ || y < top_ || y >= bottom_) return true;
    const std::uint8_t kind = blocks_[indexOf(x, y)].kind;
    return kind == kNearer || kind == kOccluder;
  };
  for (int y = top_; y < bottom_; ++y) {
    for (int x = left_; x < right_; ++x) {
      Block& block = blocks_[indexOf(x, y)];
      if (block.kind != kNearer) continue;
      int around = 0;
      for (const int v : {y - 1, y, y + 1}) {
        for (const int u : {x - 1, x, x + 1}) around += isNearer(u, v) ? 1 : 0;
      }
      if (around > kOccluderBlocks) block.kind = kOccluder;
    }
  }
}

/// Chamfer distances from the outline.
void BodyView::distances() {
  markOccluders();
  const auto mayShow = [&](std::size_t i) { return blocks_[i].kind == kPerson || blocks_[i].kind == kOccluder; };
  const auto inside = [&](int x, int y) {
    if (mayShow(indexOf(x, y))) return true;
    if (blocks_[indexOf(x, y)].kind != kUnknown) return false;
    int near = 0;
    for (int v = std::max(top_, y - 2); v < std::min(bottom_, y + 3); ++v) {
      for (int u = std::max(left_, x - 2); u < std::min(right_, x + 3); ++u) near += mayShow(indexOf(u, v)) ? 1 : 0;
    }
    return near >= 9;
  };
  for (int y = top_; y < bottom_; ++y) {
    for (int x = left_; x < right_; ++x) {
      const bool in = inside(x, y);
      outside_[indexOf(x, y)] = in ? 0.0F : kFarBlocks;
      scratch_[indexOf(x, y)] = in ? kFarBlocks : 0.0F;
    }
  }
  for (std::vector<float>* field : {&outside_, &scratch_}) {
    sweep([&](std::size_t i, std::size_t j, float step) { (*field)[i] = std::min((*field)[i], (*field)[j] + step); });
  }
  for (int y = top_; y < bottom_; ++y) {
    for (int x = left_; x < right_; ++x) {
      const std::size_t i = indexOf(x, y);
      outside_[i] = outside_[i] > 0.0F ? outside_[i] - 0.5F : 0.5F - scratch_[i];
    }
  }
}

void BodyView::makePoints() {
  points_.clear();
  blockCount_ = 0;
  for (auto& list : byRank_) list.clear();
  for (int y = top_; y < bottom_; ++y) {
    for (int x = left_; x < right_; ++x) {
      const auto i = static_cast<std::size_t>(y) * columns_ + x;
      if (blocks_[i].kind == kPerson) byRank_[bayerRank(x & 7, y & 7)].push_back(i);
    }
  }
  const std::size_t step = columns_;
  for (const auto& list : byRank_) {
    blockCount_ += list.size();
    for (const std::uint32_t i : list) {
      if (points_.size() >= kMaxPoints) break;
      const int x = static_cast<int>(i) % columns_;
      const int y = static_cast<int>(i) / columns_;
      const V3& position = positions_[i];
      // Difference of the neighbours on either side, or of one neighbour and the point itself.
      const auto slope = [&](bool hasBefore, bool hasAfter, std::size_t by, V3& out) {
        const auto same = [&](std::size_t j) {
          return blocks_[j].kind == kPerson && std::abs(positions_[j].z() - position.z()) < kNormalStep;
        };
        const bool before = hasBefore && same(i - by);
        const bool after = hasAfter && same(i + by);
        if (!before && !after) return false;
        out = (after ? positions_[i + by] : position) - (before ? positions_[i - by] : position);
        return true;
      };
      Point point;
      point.position = floorFromCamera_ * position + cameraPosition_;
      point.ray = floorFromCamera_ * position.normalized();
      point.column = x;
      point.row = y;
      V3 across, down;
      point.normal = V3::Zero();
      if (slope(x > 0, x + 1 < columns_, 1, across) && slope(y > 0, y + 1 < rows_, step, down)) {
        const V3 normal = down.cross(across);
        const float length = normal.norm();
        if (length > 1e-9F) point.normal = floorFromCamera_ * (normal / length);
      }
      points_.push_back(point);
    }
  }
  if (points_.empty()) return;
  const std::size_t n = points_.size();
  for (std::size_t k = 0; k < n; ++k) scratch_[k] = points_[k].position.y();
  const auto heightAt = [&](std::size_t rank) {
    std::nth_element(scratch_.begin(), scratch_.begin() + rank, scratch_.begin() + n);
    return scratch_[rank];
  };
  bottomHeight_ = heightAt(n / kOutlierShare);
  topHeight_ = heightAt(n - 1 - n / kOutlierShare);
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t k = 0; k < n; ++k) scratch_[k] = points_[k].position[axis];
    const auto half = scratch_.begin() + (n / 2);
    std::nth_element(scratch_.begin(), half, scratch_.begin() + n);
    middle_[axis] = *half;
  }
}

BodyView::Sight BodyView::sightOf(const V3& position) const {
  const V3 p = floorFromCamera_.transpose() * (position - cameraPosition_);
  Sight sight{};
  sight.depth = -p.z();
  sight.axis = -floorFromCamera_.col(2);
  if (sight.depth < 0.2F) return sight;
  const float column = (0.5F * camera_.width + focalX_ * p.x() / sight.depth) / block_ - 0.5F;
  const float row = (0.5F * camera_.height - focalY_ * p.y() / sight.depth) / block_ - 0.5F;
  sight.metresPerBlock = block_ * sight.depth / focalX_;
  sight.inside =
      column > firstColumn_ - 0.5F && row > firstRow_ - 0.5F && column < lastColumn_ + 0.5F && row < lastRow_ + 0.5F;
  if (!sight.inside || right_ - left_ < 2 || bottom_ - top_ < 2) return sight;
  // Beyond the margin, the distance to the margin's border is added.
  const float x = std::clamp<float>(column, left_, right_ - 1.001F);
  const float y = std::clamp<float>(row, top_, bottom_ - 1.001F);
  const int x0 = std::min(static_cast<int>(x), right_ - 2);
  const int y0 = std::min(static_cast<int>(y), bottom_ - 2);
  const float fx = x - x0;
  const float fy = y - y0;
  const auto at = static_cast<std::size_t>(y0) * columns_ + x0;
  const auto below = at + columns_;
  const float a = outside_[at], b = outside_[at + 1], c = outside_[below], d = outside_[below + 1];
  sight.outside = (1 - fy) * ((1 - fx) * a + fx * b) + fy * ((1 - fx) * c + fx * d);
  V3 gradient((1 - fy) * (b - a) + fy * (d - c), -((1 - fx) * (c - a) + fx * (d - b)), 0.0F);
  const V3 beyond(column - x, y - row, 0.0F);
  const float off = beyond.norm();
  if (off > 0.01F) {
    sight.outside += off;
    gradient = V3(beyond.x(), -beyond.y(), 0.0F) / off;
  }
  sight.gradient = floorFromCamera_ * gradient;
  const int bx = std::clamp(static_cast<int>(std::lround(column)), 0, columns_ - 1);
  const int by = std::clamp(static_cast<int>(std::lround(row)), 0, rows_ - 1);
  const Block& block = blocks_[static_cast<std::size_t>(by) * columns_ + bx];
  sight.person = block.kind == kPerson;
  sight.seen = block.depth;
  return sight;
}

void BodyView::setWorn(const std::optional<WornView>& worn) {
  worn_ = worn;
  headOutside_ = worn && !sightOf(worn->head).inside;
}

}  // namespace lorica::fit
