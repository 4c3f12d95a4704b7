#pragma once

#include "acd/decompose_plan.h"
#include "acd/piece.h"

#include <limits>
#include <memory>
#include <optional>
#include <vector>

namespace lorica {

/// Cuts a mesh into pieces and merges them to parts: Thul et al. 2018, Algorithm 3; with one keyframe Algorithm 2.
class Decomposer {
 public:
  /// @param keyframes  must outlive this object, as must the mesh
  Decomposer(const TriMesh& mesh, PoseView keyframes, const DecomposeSettings& settings, const CutPlan& plan);

  /// Whether step() has more to do.
  [[nodiscard]] bool going() const { return going_; }
  /// Cuts a piece, if there are fewer than those to which parts can be merged. Returns false if cancelled.
  [[nodiscard]] bool step();
  [[nodiscard]] std::size_t pieces() const { return leaves_.size(); }
  /// The pieces when the limits were first met; 0 = not yet.
  [[nodiscard]] std::size_t met() const { return met_; }
  /// Stops at so many pieces at the latest.
  void giveUpAt(std::size_t pieces);
  /// Whether the next step cuts a piece across its longest axis, see SplitEffort::acrossBelow, or one did so before.
  [[nodiscard]] bool cutsAcross() const { return cutsAcross_; }
  /// As this one, but from now on no piece is cut so.
  [[nodiscard]] std::unique_ptr<Decomposer> withoutCutsAcross() const;
  /// Merges the pieces to at most the requested number of parts.
  void merge();
  /// Whether the limits are met that another misses, or the parts are fewer, or as many and with less hull volume.
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

  DecomposeSettings settings_;
  CutPlan cuts_;
  CutContext context_;
  std::vector<Leaf> leaves_;
  std::vector<double> firstError_;  // of the whole mesh in each keyframe, relative to its volume
  std::vector<PartIndex> splitFrom_;
  std::vector<std::vector<SharedPiece>> stages_;  // the pieces at each of pieceCounts()
  bool going_ = true, cutsAcross_ = false;
  std::vector<std::size_t> counts_;  // of pieces, from which merging is tried
  std::size_t maxPieces_ = std::numeric_limits<std::size_t>::max();
  bool errorMet_ = false;  // by the pieces when limitsMet() was last asked
  std::size_t met_ = 0;    // pieces when the limits were first met; 0 = not yet
  std::vector<SharedPiece>
      atLimit_;  // those pieces: further cuts can increase a hull's distance to its remaining surface
  std::vector<SharedPiece> parts_;
};

}  // namespace lorica
