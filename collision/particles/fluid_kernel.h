#pragma once

#include "collision/particles/neighbour_lists.h"

#include <cstddef>

namespace lorica {

/// Constants of the fluid's two kernels, of reach `reach`: densities are shares of the density at rest.
struct FluidKernels {
  float reach;        ///< [m]
  float density;      ///< times (reach^2 - r^2)^3
  float ownDensity;   ///< of a particle alone
  float slope;        ///< times (reach - r)^2: change of density over a way [1/m]
  float relaxation;   ///< share of a wrong density that is corrected at once
  float softening;    ///< added to the sum of squared slopes [1/m^2]
  float wallDensity;  ///< of what would be behind a wall, times a polynomial of the distance: see fluid_kernel.cpp
  float wallSlope;    ///< likewise [1/m]
  ParticleRow least, most;  ///< where the floor and the walls are
};

/// How much each particle of some blocks must press along its slopes, beside what it pressed: next.w, and next has the
/// places too.
/// @param pressures  what each presses, never below 0: updated
/// @param pressed    1 where the places are those that these pressures led to, 0 where they have not been applied yet
void findPressures(const FluidKernels& kernels, const ParticleRow* places, const NeighbourLists& lists,
                   std::size_t firstBlock, std::size_t lastBlock, float* pressures, float pressed, ParticleRow* next);

/// Moves particles apart along those slopes.
/// @param longest  most that one is moved [m]
/// @param least, most  where places are kept
void movePressed(const FluidKernels& kernels, const ParticleRow* pressed, const NeighbourLists& lists,
                 const ParticleRow& least, const ParticleRow& most, float longest, std::size_t firstBlock,
                 std::size_t lastBlock, ParticleRow* next);

/// Makes the velocities of neighbours more alike (XSPH).
/// @param viscosity  0 to 1: share of the weighted mean difference
void blendMotions(const FluidKernels& kernels, const ParticleRow* places, const ParticleRow* motions,
                  const NeighbourLists& lists, float viscosity, std::size_t firstBlock, std::size_t lastBlock,
                  ParticleRow* next);

}  // namespace lorica
