#pragma once

#include "geometry/math.h"

#include <array>

namespace lorica {

/// Maximum number of people remembered at once, reported or not.
inline constexpr int kPersonSlots = 8;

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

}  // namespace lorica
