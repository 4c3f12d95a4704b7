#include "capture/tracking/segmentation/person_network.h"

#include "geometry/little_endian.h"
#include "tests/support/allocations.h"
#include "tests/support/instruction_sets.h"
#include "tests/support/value_of.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lorica::test {
namespace {

/// The parts of a network's file that belong to one convolution.
struct SlowConvolution {
  char kind;    ///< '3': 3x3 of all channels, 'd': 3x3 of each channel, '1': 1x1
  int in, out;  ///< channels
  std::vector<std::int32_t> bias;
  std::vector<std::uint8_t> shift;
  std::vector<std::int8_t> weights;
};

/// A PersonNetwork as simple as it can be, to compare with.
class SlowNetwork {
 public:
  /// Random weights. With `size` 1 the features are of the size of a trained network's; up to 4, many reach the bounds.
  SlowNetwork(std::mt19937_64& random, double size);

  [[nodiscard]] std::vector<std::uint8_t> file() const;
  [[nodiscard]] std::vector<std::int16_t> run(std::span<const std::uint16_t> depthMm,
                                              std::span<const std::int16_t> heightMm, bool floorKnown) const;

  std::vector<SlowConvolution> convolutions;
};

/// Numbers of an image, channel by channel.
struct Planes {
  Planes(int w, int h, int c) : width(w), height(h), channels(c), numbers(std::size_t{1} * w * h * c) {}
  [[nodiscard]] std::int64_t& at(int c, int y, int x) { return numbers[(c * height + y) * width + x]; }
  [[nodiscard]] const std::int64_t& at(int c, int y, int x) const { return numbers[(c * height + y) * width + x]; }

  int width, height, channels;
  std::vector<std::int64_t> numbers;
};

/// Adds a channel, moved and scaled, to another one. What would come from outside is 0.
void addMoved(const Planes& from, int channel, int dy, int dx, std::int64_t weight, Planes& to, int toChannel) {
  for (int y = std::max(0, -dy); y < std::min(to.height, to.height - dy); ++y) {
    const int first = std::max(0, -dx), end = std::min(to.width, to.width - dx);
    const std::int64_t* source = &from.at(channel, y + dy, first + dx);
    std::int64_t* sum = &to.at(toChannel, y, first);
    for (int x = first; x < end; ++x) *sum++ += weight * *source++;
  }
}

/// @param residual  null for none
Planes convolved(const SlowConvolution& k, const Planes& in, bool linear, const Planes* residual) {
  Planes out(in.width, in.height, k.out);
  for (int o = 0; o < k.out; ++o) {
    if (k.kind == '1') {
      for (int i = 0; i < k.in; ++i) addMoved(in, i, 0, 0, k.weights[i * k.out + o], out, o);
    } else {
      for (int ky = 0; ky < 3; ++ky) {
        for (int kx = 0; kx < 3; ++kx) {
          const int tap = ky * 3 + kx;
          if (k.kind == 'd') {
            addMoved(in, o, ky - 1, kx - 1, k.weights[tap * k.out + o], out, o);
          } else {
            for (int i = 0; i < k.in; ++i) {
              addMoved(in, i, ky - 1, kx - 1, k.weights[(tap * k.in + i) * k.out + o], out, o);
            }
          }
        }
      }
    }
    const int shift = k.shift[o];
    if (residual != nullptr) addMoved(*residual, o, 0, 0, std::int64_t{1} << shift, out, o);
    for (int y = 0; y < in.height; ++y) {
      for (int x = 0; x < in.width; ++x) {
        std::int64_t sum = out.at(o, y, x) + k.bias[o];
        if (shift > 0) sum += std::int64_t{1} << (shift - 1);
        sum >>= shift;
        out.at(o, y, x) =
            linear ? std::clamp<std::int64_t>(sum, -32768, 32767) : std::clamp<std::int64_t>(sum, 0, 4095);
      }
    }
  }
  return out;
}

Planes pooled(const Planes& in) {
  Planes out(in.width / 2, in.height / 2, in.channels);
  for (int c = 0; c < in.channels; ++c) {
    for (int y = 0; y < out.height; ++y) {
      for (int x = 0; x < out.width; ++x) {
        out.at(c, y, x) = std::max({in.at(c, 2 * y, 2 * x), in.at(c, 2 * y, 2 * x + 1), in.at(c, 2 * y + 1, 2 * x),
                                    in.at(c, 2 * y + 1, 2 * x + 1)});
      }
    }
  }
  return out;
}

Planes joined(const Planes& below, const Planes& same) {
  Planes out = same;
  for (int c = 0; c < out.channels; ++c) {
    for (int y = 0; y < out.height; ++y) {
      for (int x = 0; x < out.width; ++x) {
        out.at(c, y, x) = std::clamp<std::int64_t>(below.at(c, y / 2, x / 2) + same.at(c, y, x), 0, 4095);
      }
    }
  }
  return out;
}

/// Goes through the convolutions in their order.
class Walk {
 public:
  explicit Walk(std::span<const SlowConvolution> all) : left_(all) {}

  Planes dense(const Planes& in) { return convolved(take(), in, false, nullptr); }
  Planes linear(const Planes& in) { return convolved(take(), in, true, nullptr); }
  Planes separable(const Planes& in) {
    const Planes middle = convolved(take(), in, false, nullptr);
    const SlowConvolution& k = take();
    return convolved(k, middle, false, k.in == k.out ? &in : nullptr);
  }

 private:
  const SlowConvolution& take() {
    const SlowConvolution& first = left_.front();
    left_ = left_.subspan(1);
    return first;
  }

  std::span<const SlowConvolution> left_;
};

SlowNetwork::SlowNetwork(std::mt19937_64& random, double size) {
  const auto uniform = [&](int min, int max) { return std::uniform_int_distribution<int>(min, max)(random); };
  const auto add = [&](char kind, int in, int out) {
    const int taps = kind == '3' ? 9 * in : kind == 'd' ? 9 : in;
    SlowConvolution k = {kind, in, out, {}, {}, {}};
    for (int i = 0; i < taps * out; ++i) k.weights.push_back(static_cast<std::int8_t>(uniform(-128, 127)));
    const int usual = static_cast<int>(std::lround(std::log2(64.0 * std::sqrt(taps) / size)));
    for (int o = 0; o < out; ++o) {
      const int shift = std::clamp(usual + uniform(-1, 1), 0, 20);
      k.shift.push_back(shift);
      k.bias.push_back(uniform(-100, 100) * (1 << shift) + uniform(-40, 40));
    }
    convolutions.push_back(std::move(k));
  };
  const auto separable = [&](int in, int out) {
    add('d', in, in);
    add('1', in, out);
  };
  add('3', 16, 16);
  add('3', 16, 24);
  add('3', 24, 40);
  separable(40, 40);
  separable(40, 40);
  separable(40, 80);
  separable(80, 80);
  separable(80, 80);
  separable(80, 144);
  separable(144, 144);
  separable(144, 144);
  separable(144, 144);
  separable(144, 144);
  separable(144, 144);
  add('1', 144, 80);
  separable(80, 80);
  separable(80, 80);
  add('1', 80, 40);
  separable(40, 40);
  separable(40, 40);
  add('1', 40, 24);
  add('3', 24, 28);
  add('1', 28, 4);
}

std::vector<std::uint8_t> SlowNetwork::file() const {
  std::string bytes = "LPN1";
  for (const SlowConvolution& k : convolutions) {
    for (const std::int32_t bias : k.bias) appendLittleEndian(bias, bytes);
    bytes.append(k.shift.begin(), k.shift.end());
    bytes.append(k.weights.begin(), k.weights.end());
  }
  return {bytes.begin(), bytes.end()};
}

std::vector<std::int16_t> SlowNetwork::run(std::span<const std::uint16_t> depthMm,
                                           std::span<const std::int16_t> heightMm, bool floorKnown) const {
  Planes input(80, 64, 16);
  for (int y = 0; y < 128; ++y) {
    for (int x = 0; x < 160; ++x) {
      const std::int64_t depth = depthMm[y * 160 + x], height = heightMm[y * 160 + x];
      const bool measured = depth != 0;
      const auto put = [&](int c, std::int64_t value) { input.at(c * 4 + y % 2 * 2 + x % 2, y / 2, x / 2) = value; };
      put(0, measured ? std::min<std::int64_t>(4095, depth * 512 / 1000) : 0);
      put(1, measured ? 1024 : 0);
      put(2, measured && floorKnown && height > -500 ? std::min<std::int64_t>(4095, (height + 500) * 1024 / 1000) : 0);
      put(3, floorKnown ? 1024 : 0);
    }
  }

  Walk walk(convolutions);
  const Planes x0 = walk.dense(walk.dense(input));
  Planes x1 = walk.dense(pooled(x0));
  for (int i = 0; i < 2; ++i) x1 = walk.separable(x1);
  Planes x2 = walk.separable(pooled(x1));
  for (int i = 0; i < 2; ++i) x2 = walk.separable(x2);
  Planes x3 = walk.separable(pooled(x2));
  for (int i = 0; i < 2; ++i) x3 = walk.separable(x3);
  Planes y = walk.separable(pooled(x3));
  y = walk.separable(y);
  y = walk.separable(joined(y, x3));
  y = joined(walk.linear(y), x2);
  for (int i = 0; i < 2; ++i) y = walk.separable(y);
  y = joined(walk.linear(y), x1);
  for (int i = 0; i < 2; ++i) y = walk.separable(y);
  y = joined(walk.linear(y), x0);
  y = walk.dense(y);
  y = walk.linear(y);

  std::vector<std::int16_t> logits;
  for (int row = 0; row < 128; ++row) {
    for (int x = 0; x < 160; ++x) {
      logits.push_back(static_cast<std::int16_t>(y.at(row % 2 * 2 + x % 2, row / 2, x / 2)));
    }
  }
  return logits;
}

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
}  // namespace lorica::test
