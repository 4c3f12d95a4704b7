#pragma once

#include "collision/particles/neighbour_lists.h"

#include <cstddef>
#include <cstdint>

// What a substep computes of each particle and its neighbours, with vector instructions. Everything here is internal.
// Results are the same on every instruction set.

namespace lorica {

/// Constants of the fluid's two kernels, of reach `reach`: densities are relative to the density at rest.
struct FluidKernels {
  float reach;        ///< [m]
  float density;      ///< times (reach^2 - r^2)^3
  float ownDensity;   ///< of a particle alone
  float slope;        ///< times (reach - r)^2: change of density per distance [1/m]
  float relaxation;   ///< fraction of a density error that is corrected at once
  float softening;    ///< added to the sum of squared slopes [1/m^2]
  float wallDensity;  ///< of the fluid replaced by a wall, times a polynomial of the distance: see substep_kernel.cpp
  float wallSlope;    ///< likewise [1/m]
  ParticleRow min, max;  ///< positions of the floor and the walls
};

/// What rigid bodies add to the particles near them, as walls do; null without any.
struct BodyTerms {
  const ParticleRow* walls = nullptr;  ///< slopes away from them [1/m]; w: density
  const float* yielding = nullptr;     ///< added to the sum of squared slopes [1/m^2]
};

/// Computes how much pressure each particle of some blocks has to add to its previous one: next.w. The positions are
/// copied to next too.
/// @param pressures  of each particle, never below 0: updated
/// @param pressed    1 if the positions already include these pressures, 0 if they have not been applied yet
void findPressures(const FluidKernels& kernels, const ParticleRow* positions, const NeighbourLists& lists,
                   const BodyTerms& bodies, std::size_t firstBlock, std::size_t lastBlock, float* pressures,
                   float pressed, ParticleRow* next);

/// Moves particles apart along those slopes. In next.w is the pressure that was applied.
/// @param longest   max displacement of a particle [m]
/// @param min, max  bounds of the positions
void movePressed(const FluidKernels& kernels, const ParticleRow* pressed, const NeighbourLists& lists,
                 const BodyTerms& bodies, const ParticleRow& min, const ParticleRow& max, float longest,
                 std::size_t firstBlock, std::size_t lastBlock, ParticleRow* next);

/// Makes the velocities of neighbours more alike (XSPH).
/// @param viscosity  0 to 1: fraction of the weighted mean difference
void blendMotions(const FluidKernels& kernels, const ParticleRow* positions, const ParticleRow* motions,
                  const NeighbourLists& lists, float viscosity, std::size_t firstBlock, std::size_t lastBlock,
                  ParticleRow* next);

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
