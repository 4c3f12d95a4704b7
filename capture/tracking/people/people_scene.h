#pragma once

#include "capture/sensor/depth_frame.h"
#include "capture/tracking/people/background.h"
#include "capture/tracking/people/components.h"
#include "capture/tracking/people/depth_grid.h"
#include "capture/tracking/people/head_finder.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

inline constexpr int kHeightBins = 256;  ///< of 2 cm, from 0.5 m under the floor

/// A person who is tracked or remembered.
struct PersonSlot {
  bool used = false;
  bool seen = false;       ///< in this frame
  bool reported = false;   ///< included in the output
  bool moved = false;      ///< since found; furniture does not move
  bool confirmed = false;  ///< a body was fitted and explains what is seen
  bool attached = false;   ///< connected to the room: only part of the surface is the person
  int user = 0;            ///< 0 until reported
  int movingFrames = 0;
  int cells = 0;
  int newCells = 0;
  int affirmed = 0;                   ///< cells that the network takes for a person's
  bool strange = false;               ///< the network does not know what they look like
  int knownCells = 0;                 ///< before they merged with the room
  int usualCells = 0;                 ///< the most cells, fading within seconds
  double born = 0.0, lastSeen = 0.0;  ///< [s]
  Vec3f middle = Vec3f::Zero();       ///< floor frame [m]
  Vec3f velocity = Vec3f::Zero();     ///< [m/s]
  float top = 0.0F;                   ///< height of the highest cells, without a few outliers [m]
  bool cutAbove = false;              ///< by the upper image border
  bool cutAside = false;              ///< by one of the side borders
  Vec3f sum = Vec3f::Zero();
  std::array<int, kHeightBins> heights{};  ///< cells at each height
};
using PersonSlots = std::array<PersonSlot, kPersonSlots>;

/// The content of a frame before its surfaces are assigned to people.
struct PeopleScene {
  const DepthGrid& grid;
  const FloorPositions& positions;
  const ComponentFinder& surfaces;
  std::span<const CellKind> kinds;
  LastCells last;
  std::span<const FoundHead> heads;
  bool looked = false;  ///< for heads, in this frame
  Isometry3 floorFromCamera;
  bool floorFound = false;
  double time = 0.0, elapsed = 0.0;  ///< of the frame, and since the last one [s]
};

inline constexpr float kHeadsApart = 0.3F;        ///< between two people's heads, horizontally [m]
inline constexpr float kMinVisibleArea = 0.12F;   ///< of a person [m^2]
inline constexpr float kMinVisibleHeight = 0.4F;  ///< of a person [m]

/// Length along the floor.
[[nodiscard]] float horizontally(const Vec3f& v);
/// Where the middle of a person should be in this frame; floor frame [m].
[[nodiscard]] Vec3f expectedMiddle(const PeopleScene& scene, const PersonSlot& slot);
/// The middle of a head, behind its surface; floor frame [m].
[[nodiscard]] Vec3f axisOf(const PeopleScene& scene, const FoundHead& head);
/// @return -1 if there is none
[[nodiscard]] int freeSlot(const PersonSlots& slots);
[[nodiscard]] PersonSlot newcomer(const PeopleScene& scene, const Vec3f& middle);

/// Finds people whose surface is no person's, because it is connected to furniture or learnt as background: at heads
/// that are found twice in the same position.
class PeopleAtHeads {
 public:
  explicit PeopleAtHeads(const DepthGrid& grid);

  /// @param slots   newcomers occupy free ones
  /// @param person  slot + 1 of each cell: newcomers get cells that are nobody's
  void find(const PeopleScene& scene, PersonSlots& slots, std::span<std::uint8_t> person);
  /// No head is looked for near this position for some seconds.
  /// @param middle  floor frame [m]
  void refuse(const Vec3f& middle, double time);
  /// Cells of the people found by the last call of find().
  [[nodiscard]] std::span<const std::uint32_t> uncovered() const { return uncovered_; }

 private:
  [[nodiscard]] bool isRefused(const Vec3f& axis, double time) const;
  bool growFrom(const PeopleScene& scene, const FoundHead& head, int slot, std::span<std::uint8_t> person);

  struct Refusal {
    Vec3f middle = Vec3f::Zero();
    double until = 0.0;  ///< [s]
  };
  std::array<Refusal, 16> refusals_{};
  std::size_t nextRefusal_ = 0;
  std::vector<Vec3f> waiting_, stillWaiting_;  ///< axes of heads that are nobody's since the last search
  std::vector<std::uint32_t> uncovered_, region_;
};

}  // namespace lorica
