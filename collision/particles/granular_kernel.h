#pragma once

#include "collision/particles/neighbour_lists.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace lorica {

/// Input and output of one substep of grains, in the order of the grid and in whole blocks.
struct GrainPass {
  const ParticleRow* positions;  ///< [m]; w: above 0 if the grain rests on the body and does not fall
  const ParticleRow* motions;    ///< in the last substep [m]; w: number of substeps for which they have been quiet
  ParticleRow* nextPositions;
  ParticleRow* nextMotions;
  const std::uint8_t* asleep;  ///< not 0: the grain stays in place
  ParticleRow fall;            ///< what gravity adds to a motion in a substep [m]
  float diameter, friction;
  float relaxation;           ///< multiple of the mean correction
  float opening;              ///< how far an overlap opens in a substep [m] ...
  float deepFrom, deepShare;  ///< ... plus this share of an overlap's excess over deepFrom [m]
  float fastest;              ///< max motion [m]
  float quiet;                ///< a grain that would move less than this is held [m]
  float maxQuiet;             ///< max value of w
  ParticleRow min, max;       ///< bounds of positions: floor and walls
};

/// One substep of some blocks of grains: they move on and fall; contacts remove the approaching motion and the motion
/// that friction holds, and separate overlapping grains. See docs/PARTICLES.md.
void stepGrains(const GrainPass& pass, const NeighbourLists& lists, std::size_t firstBlock, std::size_t lastBlock);

}  // namespace lorica
