#pragma once

#include "session/scenes/contact_table.h"

#include <span>
#include <vector>

namespace lorica::bench {

/// How a ContactTable compares with the skin that its hulls stand for.
struct SkinComparison {
  long frames = 0, rows = 0;
  long floors = 0, props = 0, pairs = 0;  ///< overlaps of each kind
  long deep = 0;                          ///< overlaps of the skin by more than kDeep
  long missed = 0;                        ///< those without a row whose depth is above 0
  double floorError = 0.0;                ///< largest difference of a part's depth in the floor from its skin's [m]
  double gapError = 0.0;                  ///< largest by which a distance exceeds that of the skins [m]
  std::vector<double> apart;              ///< for each overlap how far the skins are apart; 0 if they overlap [m]
  std::vector<double> standOff;           ///< for each overlap how far its hulls stand off their skins at most [m]
  double beyond = 0.0;                    ///< largest by which `apart` exceeds `standOff` [m]
};

inline constexpr double kDeep = 0.005;  ///< [m]

/// Compares the rows of a session's last frame by brute force: the skinned triangles of each part of the first avatar
/// against the floor, the balls among the props, and those of its other parts that are no neighbours.
void compareWithSkin(const Session& session, std::span<const ContactRow> rows, SkinComparison& sum);

/// Four fixed balls where hands, hips, knees and feet pass.
[[nodiscard]] World fixedBalls();

}  // namespace lorica::bench
