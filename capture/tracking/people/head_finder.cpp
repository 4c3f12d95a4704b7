#include "capture/tracking/people/head_finder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace lorica {
namespace {

/// Where the image is looked at, relative to the middle of a head: to the right and down [m].
struct Offset {
  float right, down;
};
constexpr std::array<Offset, 4> kInside = {{{-0.04F, 0.0F}, {0.04F, 0.0F}, {0.0F, -0.05F}, {0.0F, 0.06F}}};
constexpr std::array<Offset, 2> kBeside = {{{-0.17F, -0.02F}, {0.17F, -0.02F}}};
constexpr std::array<Offset, 3> kAbove = {{{-0.11F, -0.17F}, {0.0F, -0.21F}, {0.11F, -0.17F}}};
constexpr std::array<Offset, 4> kBody = {{{-0.15F, 0.33F}, {0.15F, 0.33F}, {0.0F, 0.33F}, {0.0F, 0.48F}}};
constexpr std::array<Offset, 3> kHighBody = {{{-0.13F, 0.25F}, {0.13F, 0.25F}, {0.0F, 0.25F}}};

constexpr int kSkin = 60;        // depth differences within a head [mm]
constexpr int kStandsOut = 90;   // least depth difference to what is beside and above a head [mm]
constexpr int kBodyDepth = 280;  // largest depth difference between head and chest [mm]
constexpr std::uint16_t kNearest = 500, kFarthest = 5500;  // [mm]
constexpr float kMinHeadHeight = 0.5F;  // of a head over the floor: chests are not below the floor [m]
constexpr float kMinArea = 60.0F;       // of the votes for a head: their number times squared depth [m^2]
constexpr float kApart = 0.25F;         // two heads are at least this far from each other [m]
constexpr std::size_t kMaxVotes = 4096, kMaxHeads = 8;

}  // namespace

HeadFinder::HeadFinder(const DepthGrid& grid) : cellsPerMetre_(1.0F / std::abs(grid.rayX[1] - grid.rayX[0])) {
  votes_.reserve(kMaxVotes);
  heads_.reserve(kMaxHeads);
}

std::span<const FoundHead> HeadFinder::find(const DepthGrid& grid, const FloorPositions& positions, bool floorFound) {
  votes_.clear();
  heads_.clear();
  constexpr int kStep = 2;
  for (int row = 0; row < grid.height; row += kStep) {
    for (int column = 0; column < grid.width; column += kStep) {
      const std::uint16_t depth = grid.depthMm[grid.index(column, row)];
      if (depth < kNearest || depth > kFarthest || votes_.size() == kMaxVotes) continue;
      const float scale = 1000.0F * cellsPerMetre_ / depth;
      // Depth relative to the head's; far above zero where nothing is measured or the image ends.
      constexpr int kNothing = 100'000;
      const auto rowOf = [&](const Offset& offset) { return row + static_cast<int>(std::lround(offset.down * scale)); };
      const auto behind = [&](const Offset& offset) {
        const int c = column + std::lround(offset.right * scale);
        const int r = rowOf(offset);
        if (c < 0 || r < 0 || c >= grid.width || r >= grid.height) return kNothing;
        const std::uint16_t there = grid.depthMm[grid.index(c, r)];
        return there == 0 ? kNothing : there - depth;
      };
      const auto standsOut = [&](const Offset& offset) { return behind(offset) > kStandsOut; };
      // Of someone near, the chest may be below the image: then the shoulders must show higher up.
      const auto body = [&](const Offset& offset) {
        return rowOf(offset) > grid.lastRow || std::abs(behind(offset)) < kBodyDepth;
      };
      const bool near = rowOf(kBody.back()) > grid.lastRow;
      if (!std::ranges::all_of(kBeside, standsOut)) continue;
      if (!std::ranges::all_of(kInside, [&](const Offset& offset) { return std::abs(behind(offset)) < kSkin; }))
        continue;
      if (!std::ranges::all_of(kBody, body)) continue;
      if (near && (rowOf(kHighBody.front()) > grid.lastRow || !std::ranges::all_of(kHighBody, body))) continue;
      if (std::ranges::count_if(kAbove, standsOut) < 2) continue;
      const Vec3f position = positions(grid, column, row);
      if (floorFound && position.y() < kMinHeadHeight) continue;
      votes_.push_back({column, row, depth, position, 1});
    }
  }
  // Votes for one head lie together: its middle is that of its votes.
  while (!votes_.empty() && heads_.size() < kMaxHeads) {
    FoundHead head = votes_.front();
    const Vec3f first = head.position;
    Vec3f sum = Vec3f::Zero();
    int columns = 0, rows = 0;
    head.hits = 0;
    std::erase_if(votes_, [&](const FoundHead& vote) {
      if ((vote.position - first).norm() > kApart) return false;
      sum += vote.position;
      columns += vote.column;
      rows += vote.row;
      ++head.hits;
      return true;
    });
    head.column = columns / head.hits;
    head.row = rows / head.hits;
    head.position = sum / static_cast<float>(head.hits);
    if (const std::uint16_t there = grid.depthMm[grid.index(head.column, head.row)]; there != 0) head.depthMm = there;
    const float depth = 0.001F * head.depthMm;
    if (head.hits * depth * depth > kMinArea) heads_.push_back(head);
  }
  std::ranges::sort(heads_, [](const FoundHead& a, const FoundHead& b) { return a.hits > b.hits; });
  return heads_;
}

}  // namespace lorica
