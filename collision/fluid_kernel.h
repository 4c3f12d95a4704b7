#pragma once

#include "collision/neighbour_lists.h"

#include <cstddef>

namespace lorica {

/// Constants of the fluid's two kernels, of reach `reach`: densities are shares of the density at rest.
struct FluidKernels {
  float reach;       ///< [m]
  float density;     ///< times (reach^2 - r^2)^3
  float ownDensity;  ///< of a particle alone
  float slope;       ///< times (reach - r)^2: change of density over a way [1/m]
  float over;        ///< how much more than the excess of density is corrected
  float softening;   ///< added to the sum of squared slopes [1/m^2]
};

/// How much each particle of some blocks must move along its slopes: next.w, and next has the places too.
void findPressures(const FluidKernels& kernels, const ParticleRow* places, const NeighbourLists& lists,
                   std::size_t firstBlock, std::size_t lastBlock, ParticleRow* next);

/// Moves particles apart along those slopes.
/// @param longest  most that one is moved [m]
/// @param least, most  where places are kept
void movePressed(const FluidKernels& kernels, const ParticleRow* pressures, const NeighbourLists& lists,
                 const ParticleRow& least, const ParticleRow& most, float longest, std::size_t firstBlock,
                 std::size_t lastBlock, ParticleRow* next);

/// Makes the velocities of neighbours more alike (XSPH).
/// @param viscosity  0 to 1: share of the weighted mean difference
void blendMotions(const FluidKernels& kernels, const ParticleRow* places, const ParticleRow* motions,
                  const NeighbourLists& lists, float viscosity, std::size_t firstBlock, std::size_t lastBlock,
                  ParticleRow* next);

}  // namespace lorica
