#pragma once

#include "collision/particles/neighbour_lists.h"

#include <cstddef>

namespace lorica {

/// Constants of the fluid's two kernels, of reach `reach`: densities are relative to the density at rest.
struct FluidKernels {
  float reach;           ///< [m]
  float density;         ///< times (reach^2 - r^2)^3
  float ownDensity;      ///< of a particle alone
  float slope;           ///< times (reach - r)^2: change of density per distance [1/m]
  float relaxation;      ///< fraction of a density error that is corrected at once
  float softening;       ///< added to the sum of squared slopes [1/m^2]
  float wallDensity;     ///< of the fluid replaced by a wall, times a polynomial of the distance: see fluid_kernel.cpp
  float wallSlope;       ///< likewise [1/m]
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

}  // namespace lorica
