#pragma once

#include "collision/particles/neighbour_lists.h"

#include <cstddef>
#include <cstdint>
#include <span>

namespace lorica {

/// What one substep of grains needs, in the order of the grid and in whole blocks.
struct GrainPass {
  const ParticleRow* places;   ///< where the grains are [m]; w: above 0, it rests on the body and does not fall
  const ParticleRow* motions;  ///< their way in the last substep [m]; w: for how many substeps they have been quiet
  ParticleRow* nextPlaces;
  ParticleRow* nextMotions;
  const std::uint8_t* asleep;  ///< not 0: the grain stays where it is
  ParticleRow fall;            ///< what gravity adds to a motion in a substep [m]
  float diameter, friction;
  float relaxation;           ///< of the corrections, beside their mean
  float opening;              ///< how far an overlap opens in a substep [m] ...
  float deepFrom, deepShare;  ///< ... and the share of what is deeper than this that does too [m]
  float fastest;              ///< longest motion [m]
  float quiet;                ///< a shorter motion is none: the grain is held [m]
  float mostQuiet;            ///< w counts no further
  ParticleRow least, most;    ///< of places: floor and walls
};

/// One substep of some blocks of grains: they go on, fall, and their contacts take from their motions what brings them
/// closer and what friction holds, and move them apart where they overlap. See docs/PARTICLES.md.
void stepGrains(const GrainPass& pass, const NeighbourLists& lists, std::size_t firstBlock, std::size_t lastBlock);

}  // namespace lorica
