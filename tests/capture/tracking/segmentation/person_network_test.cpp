#include "capture/tracking/segmentation/person_network.h"

#include "tests/capture/tracking/segmentation/slow_network.h"
#include "tests/support/allocations.h"
#include "tests/support/instruction_sets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <span>
#include <string>
#include <vector>

namespace lorica {
namespace {

constexpr std::size_t kPixels = std::size_t{1} * PersonNetwork::kWidth * PersonNetwork::kHeight;

/// What a network sees, and what it should say.
struct View {
  std::string name;
  std::vector<std::uint16_t> depthMm;
  std::vector<std::int16_t> heightMm;
  bool floorKnown = true;
};

View same(const std::string& name, std::uint16_t depthMm, std::int16_t heightMm, bool floorKnown) {
  return {name, std::vector<std::uint16_t>(kPixels, depthMm), std::vector<std::int16_t>(kPixels, heightMm), floorKnown};
}

View noise(std::mt19937_64& random, bool floorKnown) {
  View view = same("noise", 0, 0, floorKnown);
  std::uniform_int_distribution<int> depth(0, 65535), height(-32768, 32767), kind(0, 3);
  for (std::size_t i = 0; i < kPixels; ++i) {
    // A quarter is not measured, a quarter anything, the rest as in a room.
    const int k = kind(random);
    view.depthMm[i] = k == 0 ? 0 : k == 1 ? depth(random) : 500 + depth(random) % 7600;
    view.heightMm[i] = k <= 1 ? height(random) : height(random) % 3000;
  }
  return view;
}

std::vector<View> views(std::mt19937_64& random) {
  constexpr std::int16_t kLowest = std::numeric_limits<std::int16_t>::min();
  constexpr std::int16_t kHighest = std::numeric_limits<std::int16_t>::max();
  return {same("nothing measured", 0, 0, false),
          same("nothing measured, floor", 0, kHighest, true),
          same("far", 65535, kHighest, true),
          same("far, no floor", 65535, kHighest, false),
          same("far below the floor", 1, kLowest, true),
          noise(random, true),
          noise(random, false)};
}

std::span<const std::int16_t> run(PersonNetwork& network, const View& view) {
  return network.run(view.depthMm, view.heightMm, view.floorKnown);
}

void expectSame(std::span<const std::int16_t> logits, std::span<const std::int16_t> expected) {
  ASSERT_EQ(logits.size(), expected.size());
  const auto [at, there] = std::mismatch(logits.begin(), logits.end(), expected.begin());
  EXPECT_EQ(at, logits.end()) << *at << " instead of " << *there << " at pixel " << at - logits.begin();
}

// Of the size of trained weights, and larger, so that sums reach the bounds.
TEST(PersonNetwork, IsTheSlowOneOnEveryInstructionSet) {
  for (const double size : {1.0, 3.0}) {
    std::mt19937_64 random(41);
    const test::SlowNetwork slow(random, size);
    PersonNetwork network = test::valueOf(PersonNetwork::fromBytes(slow.file()));
    for (const View& view : views(random)) {
      if (size > 1.0 && view.name != "noise") continue;
      SCOPED_TRACE(view.name);
      const std::vector<std::int16_t> expected = slow.run(view.depthMm, view.heightMm, view.floorKnown);
      // A result that is the same everywhere would not show much.
      if (view.name == "noise") {
        const auto [least, most] = std::minmax_element(expected.begin(), expected.end());
        EXPECT_GT(*most, *least + 200);
      }
      test::onEveryInstructionSet([&] { expectSame(run(network, view), expected); });
    }
  }
}

TEST(PersonNetwork, LargestNumbersDoNotOverflow) {
  std::mt19937_64 random(42);
  for (const std::int8_t weight : {std::int8_t{127}, std::int8_t{-128}}) {
    for (const int shift : {0, 20}) {
      test::SlowNetwork slow(random, 1.0);
      for (test::SlowConvolution& k : slow.convolutions) {
        std::fill(k.weights.begin(), k.weights.end(), weight);
        std::fill(k.shift.begin(), k.shift.end(), shift);
        std::fill(k.bias.begin(), k.bias.end(), weight > 0 ? 1 << 28 : -(1 << 28));
      }
      PersonNetwork network = test::valueOf(PersonNetwork::fromBytes(slow.file()));
      const View view = noise(random, true);
      const std::vector<std::int16_t> expected = slow.run(view.depthMm, view.heightMm, view.floorKnown);
      test::onEveryInstructionSet([&] { expectSame(run(network, view), expected); });
    }
  }
}

TEST(PersonNetwork, RemembersNothing) {
  std::mt19937_64 random(43);
  PersonNetwork network = PersonNetwork::shipped();
  const View first = noise(random, true), second = noise(random, false);
  const std::span<const std::int16_t> logits = run(network, first);
  const std::vector<std::int16_t> before(logits.begin(), logits.end());
  static_cast<void>(run(network, second));
  expectSame(run(network, first), before);

  PersonNetwork copy = network;
  static_cast<void>(run(network, second));
  expectSame(run(copy, first), before);
}

TEST(PersonNetwork, RunAllocatesNothing) {
  std::mt19937_64 random(44);
  PersonNetwork network = PersonNetwork::shipped();
  const View view = noise(random, true);
  const long before = test::allocationCount();
  static_cast<void>(run(network, view));
  EXPECT_EQ(test::allocationCount(), before);
}

TEST(PersonNetwork, DamagedFilesAreRefused) {
  std::mt19937_64 random(45);
  test::SlowNetwork slow(random, 1.0);
  const std::vector<std::uint8_t> file = slow.file();
  const auto refusal = [](const std::vector<std::uint8_t>& bytes) {
    const Result<PersonNetwork> network = PersonNetwork::fromBytes(bytes);
    EXPECT_FALSE(network.ok());
    return network.ok() ? "" : network.error().message;
  };
  const std::string size = std::to_string(file.size());

  for (const std::size_t length : {std::size_t{0}, std::size_t{1}, std::size_t{3}}) {
    EXPECT_EQ(refusal({file.begin(), file.begin() + static_cast<std::ptrdiff_t>(length)}),
              "a person network starts with LPN1, these " + std::to_string(length) + " bytes do not");
  }
  for (std::size_t length = 4; length < file.size(); length += length < 300 ? 1 : 997) {
    EXPECT_EQ(refusal({file.begin(), file.begin() + static_cast<std::ptrdiff_t>(length)}),
              "a person network of " + std::to_string(length) + " bytes, expected " + size);
  }
  std::vector<std::uint8_t> bytes = file;
  bytes.push_back(0);
  EXPECT_EQ(refusal(bytes), "a person network of " + std::to_string(file.size() + 1) + " bytes, expected " + size);
  bytes = file;
  bytes[3] = '2';
  EXPECT_EQ(refusal(bytes), "a person network starts with LPN1, these " + size + " bytes do not");

  test::SlowNetwork damaged = slow;
  damaged.convolutions[0].shift[7] = 255;
  EXPECT_EQ(refusal(damaged.file()), "convolution 1 of a person network: shift 255 of channel 7, expected 0 to 20");
  damaged = slow;
  damaged.convolutions.back().shift[3] = 21;
  EXPECT_EQ(refusal(damaged.file()), "convolution 38 of a person network: shift 21 of channel 3, expected 0 to 20");
  damaged = slow;
  damaged.convolutions[4].bias[39] = std::numeric_limits<std::int32_t>::min();
  EXPECT_EQ(refusal(damaged.file()),
            "convolution 5 of a person network: bias -2147483648 of channel 39, expected at most 268435456 in size");
}

}  // namespace
}  // namespace lorica
