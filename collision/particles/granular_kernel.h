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
  const ParticleRow* ends;       ///< see endOf()
  ParticleRow *nextPositions, *nextMotions, *nextEnds;
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

/// Where a grain would be after a substep without contacts [m]; w as of its position, but -1 if it is asleep.
[[nodiscard]] inline ParticleRow endOf(const ParticleRow& position, const ParticleRow& motion, bool asleep,
                                       const ParticleRow& fall) {
  if (asleep) return {position.x, position.y, position.z, -1.0f};
  if (position.w > 0.0f) return {position.x + motion.x, position.y + motion.y, position.z + motion.z, position.w};
  return {position.x + (motion.x + fall.x), position.y + (motion.y + fall.y), position.z + (motion.z + fall.z),
          position.w};
}

/// One substep of some blocks of grains: they move on and fall; contacts remove the approaching motion and the motion
/// that friction holds, and separate overlapping grains. See docs/PARTICLES.md.
void stepGrains(const GrainPass& pass, const NeighbourLists& lists, std::size_t firstBlock, std::size_t lastBlock);

}  // namespace lorica
