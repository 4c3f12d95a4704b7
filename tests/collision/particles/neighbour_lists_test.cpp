#include "collision/particles/neighbour_lists.h"

#include "geometry/random_numbers.h"
#include "tests/support/instruction_sets.h"

#include <gtest/gtest.h>

#include <set>

namespace lorica::test {
namespace {

struct Case {
  std::size_t count;
  double extent, height, stray;
};

/// The lists, by the particles' original indices.
std::vector<std::set<std::uint32_t>> listed(const std::vector<ParticleRow>& positions, float radius, bool all = true) {
  ParticleGrid grid(positions.size());
  grid.sort(positions, radius);
  std::vector<float> x(paddedCount(positions.size())), y(x.size()), z(x.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const ParticleRow& position = positions[grid.order()[i]];
    x[i] = position.x;
    y[i] = position.y;
    z[i] = position.z;
  }
  NeighbourLists lists(positions.size(), 96);
  lists.build(grid, x.data(), y.data(), z.data(), positions.size(), radius, std::vector<std::uint8_t>(x.size()));
  EXPECT_TRUE(!all || lists.overflows() == 0);
  std::vector<std::set<std::uint32_t>> result(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const std::size_t block = i / kParticleBlock;
    for (int s = 0; s < lists.slotCount(block); ++s) {
      const std::uint32_t other = lists.slots(block)[static_cast<std::size_t>(s) * kParticleBlock + i % kParticleBlock];
      if (other == i) continue;
      EXPECT_TRUE(result[grid.order()[i]].insert(grid.order()[other]).second) << "listed twice";
    }
  }
  return result;
}

TEST(NeighbourLists, HoldWhatComparingAllPairsFinds) {
  RandomNumbers random(9);
  const float radius = 0.05f;
  for (const Case& c : {Case{1, 1, 1, 0}, Case{15, 0.1, 0.1, 0}, Case{16, 0.1, 0.1, 0}, Case{17, 0.1, 0.1, 0},
                        Case{700, 0.5, 0.4, 0}, Case{700, 0.5, 0.4, 60.0}, Case{300, 0.1, 12.0, 0}}) {
    std::vector<ParticleRow> positions;
    for (std::size_t i = 0; i < c.count; ++i) {
      const bool stray = i % 50 == 49;
      const double extent = stray ? c.extent + c.stray : c.extent, height = stray ? c.height + c.stray : c.height;
      positions.push_back({static_cast<float>(random.between(-extent, extent)),
                           static_cast<float>(random.between(0.0, height)),
                           static_cast<float>(random.between(-extent, extent)), 0.0f});
    }
    std::vector<std::set<std::uint32_t>> truth(positions.size());
    for (std::uint32_t i = 0; i < positions.size(); ++i) {
      for (std::uint32_t j = 0; j < positions.size(); ++j) {
        const float dx = positions[j].x - positions[i].x, dy = positions[j].y - positions[i].y,
                    dz = positions[j].z - positions[i].z;
        if (i != j && dx * dx + dy * dy + dz * dz < radius * radius) truth[i].insert(j);
      }
    }
    onEveryInstructionSet([&] { EXPECT_EQ(listed(positions, radius), truth) << c.count << " particles"; });
  }
}

TEST(NeighbourLists, OfWhatIsPressedTogetherSoManyAreLookedAt) {
  // A clump at the lower end of a cell, and two particles at its upper end, too far away from it.
  std::vector<ParticleRow> positions(NeighbourLists::kMaxLooked - 2, ParticleRow{0.001f, 0.001f, 0.001f, 0.0f});
  positions.insert(positions.end(), 2, ParticleRow{0.049f, 0.049f, 0.049f, 0.0f});
  const auto upper = [&] { return listed(positions, 0.05f, false).back().size(); };
  EXPECT_EQ(upper(), 1u);
  positions.insert(positions.begin(), positions.front());
  EXPECT_EQ(upper(), 1u) << "the first of the two is the last that is looked at";
  positions.insert(positions.begin(), positions.front());
  EXPECT_EQ(upper(), 0u);
}

}  // namespace
}  // namespace lorica::test
