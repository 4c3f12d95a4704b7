#pragma once

#include "acd/decompose_plan.h"
#include "acd/piece.h"

#include <memory>
#include <optional>
#include <vector>

namespace lorica {

/// Cuts a mesh into pieces and merges them to parts: Thul et al. 2018, Algorithm 3; with one keyframe Algorithm 2.
class Decomposer {
 public:
  /// @param keyframes  must outlive this object, as must the mesh and the settings
  Decomposer(const TriMesh& mesh, PoseView keyframes, const DecomposeSettings& settings, const CutPlan& plan);

  /// Cuts the mesh into at most the requested number of parts. Returns false if cancelled.
  [[nodiscard]] bool divide();
  /// Whether the parts are fewer than those of another, or as many and with less hull volume.
  [[nodiscard]] bool betterThan(const Decomposer& other) const;
  /// Improves the parts as far as the limits allow. Returns false if cancelled.
  [[nodiscard]] bool improveParts(std::span<const ImproveRound> rounds);
  /// Sorts the parts by level of detail.
  [[nodiscard]] Decomposition finish();

 private:
  using SharedPiece = std::shared_ptr<const Piece>;
  /// A piece with the best split found for it so far.
  struct Leaf {
    SharedPiece piece;
    std::vector<bool> exhausted;  // keyframes in which no plane divides the piece
    bool searched = false;
    std::optional<Split> split;
    double gain = 0.0;
  };

  /// Whether there are limits that each part must meet.
  [[nodiscard]] bool partsLimited() const { return settings_.maxDistance > 0.0 || settings_.maxConcavity > 0.0; }
  [[nodiscard]] bool limited() const { return settings_.maxError > 0.0 || partsLimited(); }
  [[nodiscard]] bool goOn(std::size_t pieces, std::size_t limit) const;
  [[nodiscard]] double shareDone() const;
  [[nodiscard]] bool errorMet(std::span<const SharedPiece> pieces) const;
  [[nodiscard]] double excessOf(const Piece& piece) const;
  [[nodiscard]] bool exceeds(const Piece& piece) const;
  [[nodiscard]] bool limitsMet();
  [[nodiscard]] bool limitsMet(std::span<const SharedPiece> pieces) const;
  [[nodiscard]] bool worthCutting(const Leaf& leaf) const;
  [[nodiscard]] Leaf leafOf(Part part) const;
  [[nodiscard]] std::optional<std::size_t> worstKeyframe(const Leaf& leaf) const;
  bool search(Leaf& leaf);
  std::optional<std::size_t> mostConcave();
  std::optional<std::size_t> mostGaining();
  void carryOut(std::size_t index);
  bool separateComponents();
  [[nodiscard]] std::vector<SharedPiece> piecesNow() const;
  [[nodiscard]] std::vector<SharedPiece> merged(std::span<const SharedPiece> pieces, std::size_t count) const;
  [[nodiscard]] std::vector<SharedPiece> bestMerged(std::size_t count) const;
  [[nodiscard]] std::vector<SharedPiece> mergedByPairs(std::size_t max) const;
  [[nodiscard]] std::vector<SharedPiece> mergedWithinLimits(std::size_t max) const;
  void dropUselessCuts();

  const DecomposeSettings& settings_;
  CutPlan cuts_;
  CutContext context_;
  std::vector<Leaf> leaves_;
  std::vector<double> firstError_;  // of the whole mesh in each keyframe, relative to its volume
  std::vector<PartIndex> splitFrom_;
  std::vector<std::vector<SharedPiece>> stages_;  // the pieces at each of pieceCounts()
  bool errorMet_ = false;                         // by the pieces when limitsMet() was last asked
  std::size_t met_ = 0;                           // pieces when the limits were first met; 0 = not yet
  std::vector<SharedPiece>
      atLimit_;  // those pieces: further cuts can increase a hull's distance to its remaining surface
  std::vector<SharedPiece> parts_;
};

}  // namespace lorica
