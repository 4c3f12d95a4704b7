#include "acd/merge.h"

#include "geometry/convex_hull.h"
#include "tests/acd/hard_meshes.h"
#include "tests/acd/parts.h"
#include "tests/support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace lorica {
namespace {

constexpr double kExact = 1e-10;  // tolerance of the hulls

using Groups = std::vector<std::vector<std::size_t>>;

/// Separate convex solids in several keyframes, each a piece.
struct Solids {
  /// @param keyframes  the same solids in the same order in each keyframe
  explicit Solids(const std::vector<std::vector<TriMesh>>& keyframes)
      : mesh(all(keyframes[0])), positions(positionsIn(keyframes)), context(mesh, view()) {
    const Components components = connectedComponents(mesh.vertices.size(), mesh.triangles);
    std::vector<Part> parts(components.count);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      Part& part = parts[components.componentOfTriangle[i]];
      part.triangles.push_back(mesh.triangles[i]);
      part.sourceTriangle.push_back(static_cast<std::int32_t>(i));
    }
    for (Part& part : parts) {
      part.points = pointsUsedBy(part.triangles);
      pieces.push_back(measure(std::move(part), context));
    }
  }
  [[nodiscard]] Merged merged(int partCount) const {
    std::vector<std::shared_ptr<const Piece>> shared;
    for (const Piece& piece : pieces) shared.push_back(std::make_shared<const Piece>(piece));
    return mergePieces(shared, context, partCount, kExact);
  }

  TriMesh mesh;
  std::vector<Vec3> positions;
  CutContext context;
  std::vector<Piece> pieces;

 private:
  static TriMesh all(const std::vector<TriMesh>& solids) {
    TriMesh whole;
    for (const TriMesh& solid : solids) whole = test::joined(whole, solid);
    return whole;
  }
  static std::vector<Vec3> positionsIn(const std::vector<std::vector<TriMesh>>& keyframes) {
    std::vector<Vec3> positions;
    for (const std::vector<TriMesh>& solids : keyframes) {
      const TriMesh whole = all(solids);
      positions.insert(positions.end(), whole.vertices.begin(), whole.vertices.end());
    }
    return positions;
  }
  [[nodiscard]] PoseView view() const { return {positions, countOf(mesh.vertices)}; }
};

/// Independent reference: tries all pairs in each step, with hulls of all original points.
Groups slowlyMerged(const Solids& solids, std::size_t partCount) {
  Groups groups;
  for (std::size_t i = 0; i < solids.pieces.size(); ++i) groups.push_back({i});
  const auto hullVolume = [&](const std::vector<std::size_t>& group) {
    double sum = 0.0;
    for (const std::vector<Vec3>& frame : solids.context.points) {
      std::vector<Vec3> own;
      for (const std::size_t i : group) {
        for (const PointIndex p : solids.pieces[i].part.points) own.push_back(frame[p]);
      }
      sum += convexHullVolume(own);
    }
    return sum;
  };
  while (groups.size() > partCount) {
    double least = std::numeric_limits<double>::infinity();
    std::pair<std::size_t, std::size_t> best;
    for (std::size_t a = 0; a < groups.size(); ++a) {
      for (std::size_t b = a + 1; b < groups.size(); ++b) {
        std::vector<std::size_t> both = groups[a];
        both.insert(both.end(), groups[b].begin(), groups[b].end());
        const double added = hullVolume(both) - hullVolume(groups[a]) - hullVolume(groups[b]);
        if (added < least) {
          least = added;
          best = {a, b};
        }
      }
    }
    groups[best.first].insert(groups[best.first].end(), groups[best.second].begin(), groups[best.second].end());
    groups.erase(groups.begin() + static_cast<std::ptrdiff_t>(best.second));
  }
  return groups;
}

/// Groups in one order.
Groups asSets(Groups groups) {
  for (auto& group : groups) std::ranges::sort(group);
  std::ranges::sort(groups);
  return groups;
}

TEST(Merge, AsManyPartsAsPiecesOrMoreLeavesThemAlone) {
  const TriMesh box = test::makeBox({0, 0, 0}, {1, 1, 1});
  for (const int partCount : {1, 2, 9}) {
    const Merged one = Solids({{box}}).merged(partCount);
    EXPECT_EQ(one.groups, (Groups{{0}}));
    EXPECT_TRUE(one.splitFrom.empty());
  }
  // Two of three boxes coincide: merging them would even save volume, but nothing asks for it.
  const Solids three({{box, test::makeBox({4, 0, 0}, {5, 1, 1}), box}});
  for (const int partCount : {3, 4, 100}) {
    const Merged merged = three.merged(partCount);
    EXPECT_EQ(asSets(merged.groups), (Groups{{0}, {1}, {2}}));
    EXPECT_EQ(merged.splitFrom, (std::vector<PartIndex>{0, 0}));
  }
}

TEST(Merge, PairsThatAddTheLeastVolumeComeFirst) {
  //   +---+---+
  //   | 0 | 1 +---+             +---+      profile in xy, one unit thick: 0 and 1 add nothing, 1 and 2 add a triangle
  //   |   |   | 2 |             | 3 |      of area 1/4, and 3 is far away
  //   +---+---+---+             +---+
  const Solids row({{test::makeBox({0, 0, 0}, {1, 1, 1}), test::makeBox({1, 0, 0}, {2, 1, 1}),
                     test::makeBox({2, 0, 0}, {3, 0.5, 1}), test::makeBox({9, 0, 0}, {10, 0.5, 1})}});
  EXPECT_EQ(row.merged(3).groups, (Groups{{0, 1}, {3}, {2}}));
  EXPECT_EQ(row.merged(2).groups, (Groups{{0, 1, 2}, {3}}));
  EXPECT_EQ(row.merged(1).groups, (Groups{{0, 1, 2, 3}}));
  // The last merge is the first split: 3 was split from the whole, then 2, then 1.
  const Merged all = row.merged(4);
  EXPECT_EQ(all.groups, (Groups{{0}, {3}, {2}, {1}}));
  EXPECT_EQ(all.splitFrom, (std::vector<PartIndex>{0, 0, 0}));
}

TEST(Merge, AddedVolumeIsThatOfAllKeyframes) {
  // Box 1 stays half a unit above the level of box 0 and adds 1/2. Box 2 is level with box 0 in the first keyframe and
  // adds nothing, but it has risen in the second one.
  const auto keyframe = [](double rise) {
    return std::vector<TriMesh>{test::makeBox({0, 0, 0}, {1, 1, 1}), test::makeBox({1, 0.5, 0}, {2, 1.5, 1}),
                                test::makeBox({-1, rise, 0}, {0, 1 + rise, 1})};
  };
  const Groups withOne = {{0, 1}, {2}}, withTwo = {{0, 2}, {1}};
  EXPECT_EQ(asSets(Solids({keyframe(0.0)}).merged(2).groups), withTwo);
  EXPECT_EQ(asSets(Solids({keyframe(0.0), keyframe(0.75)}).merged(2).groups), withTwo) << "0 + 3/4 against 1/2 + 1/2";
  EXPECT_EQ(asSets(Solids({keyframe(0.0), keyframe(1.25)}).merged(2).groups), withOne) << "0 + 5/4 against 1/2 + 1/2";
  EXPECT_EQ(asSets(Solids({keyframe(1.25), keyframe(0.0)}).merged(2).groups), withOne);
}

TEST(Merge, EqualsTryingAllPairs) {
  // In the first keyframe all solids contain the origin, so that no two of them are far apart.
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Dice dice(seed);
    std::vector<std::vector<TriMesh>> keyframes(2);
    for (const std::size_t k : {0u, 1u}) {
      for (int i = 0; i < 9; ++i) {
        const Vec3 low = -Vec3(0.1, 0.1, 0.1) - dice.inBox(0.5).cwiseAbs();
        const Vec3 high = Vec3(0.1, 0.1, 0.1) + dice.inBox(0.5).cwiseAbs();
        const Quat rotation = dice.rotation();
        const Vec3 shift = k == 0 ? Vec3(0, 0, 0) : dice.inBox(1.0);
        keyframes[k].push_back(
            test::moved(test::makeBox(low, high), [&](const Vec3& v) -> Vec3 { return rotation * v + shift; }));
      }
    }
    const Solids solids(keyframes);
    for (int partCount = 1; partCount <= 9; ++partCount) {
      EXPECT_EQ(asSets(solids.merged(partCount).groups),
                asSets(slowlyMerged(solids, static_cast<std::size_t>(partCount))))
          << partCount << " parts";
    }
  }
}

TEST(Merge, EveryPrefixOfTheOrderIsTheCoarserMerge) {
  for (const std::uint64_t seed : {6, 7, 8}) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    test::Dice dice(seed);
    std::vector<TriMesh> solids;
    for (int i = 0; i < 14; ++i) {
      const Vec3 low = dice.inBox(3.0);
      solids.push_back(test::makeBox(low, low + Vec3(1, 1, 1) + dice.inBox(0.8)));
    }
    const Solids all({solids});
    for (int partCount = 1; partCount <= 14; ++partCount) {
      Merged merged = all.merged(partCount);
      ASSERT_EQ(merged.groups.size(), static_cast<std::size_t>(partCount));
      ASSERT_EQ(merged.splitFrom.size() + 1, merged.groups.size());
      std::vector<int> seen(14, 0);
      for (const auto& group : merged.groups) {
        for (const std::size_t piece : group) ++seen[piece];
      }
      EXPECT_EQ(seen, std::vector<int>(14, 1)) << "every piece is in one part";
      while (merged.groups.size() > 1) {
        const std::size_t last = merged.groups.size() - 1;
        const PartIndex into = merged.splitFrom[last - 1];
        ASSERT_LT(into, static_cast<PartIndex>(last)) << "a part is split from an earlier one";
        merged.groups[into].insert(merged.groups[into].end(), merged.groups[last].begin(), merged.groups[last].end());
        merged.groups.pop_back();
        EXPECT_EQ(asSets(merged.groups), asSets(all.merged(static_cast<int>(last)).groups))
            << partCount << " parts, then " << last;
      }
    }
  }
}

}  // namespace
}  // namespace lorica
