#include "capture/tracking/segmentation/person_network.h"

#include "geometry/errors.h"
#include "geometry/little_endian.h"

#include <algorithm>
#include <cstring>
#include <string_view>

// The net, with the size of its images. C: 3x3. S: depthwise 3x3, 1x1, and the input added if it has as many channels.
// R: 1x1, linear. Every 2 x 2 pixels of the input become one with four times as many channels, and back at the end.
//
//   80x64  C16 C24 ---------------------------------------------> + C28 R4 -> logits
//            | largest of 2 x 2                                   | each pixel to 2 x 2
//   40x32  C40 S40 S40 ---------------------------> + S40 S40 R24
//            |                                      |
//   20x16  S80 S80 S80 ---------------> + S80 S80 R40
//            |                          |
//   10x8   S144 S144 S144 ---> + S144 R80
//            |                 |
//   5x4    S144 S144 ----------
//
// Numbers are 16 bits, 256 is 1.0, and all but the results of R lie between 0 and 4095.

namespace lorica {

/// The bytes of person_network.bin, which the build makes a source file of.
[[nodiscard]] std::span<const std::uint8_t> personNetworkFile();

namespace {

constexpr int kWidth = PersonNetwork::kWidth;
constexpr std::string_view kMagic = "LPN1";
constexpr int kMaxShift = 20;
constexpr std::int64_t kMaxBias = std::int64_t{1} << 28;  // far from overflow, with the largest sum of inputs

constexpr int kBlock = 8;  // outputs whose weights lie side by side

int filledUp(int channels) {
  return (channels + kBlock - 1) / kBlock * kBlock;
}

int pairsOf(const ConvolutionShape& shape) {
  if (shape.kind == ConvolutionKind::kDepthwise) return static_cast<int>(kDepthwisePairs.size());
  return (shape.kind == ConvolutionKind::kDense ? 9 : 1) * filledUp(shape.in) / 2;
}

// In the order of execution.
std::vector<ConvolutionShape> shapesOfNet() {
  std::vector<ConvolutionShape> shapes;
  const auto dense = [&](int in, int out) { shapes.push_back({ConvolutionKind::kDense, in, out}); };
  const auto separable = [&](int in, int out) {
    shapes.push_back({ConvolutionKind::kDepthwise, in, in});
    shapes.push_back({.kind = ConvolutionKind::kPointwise, .in = in, .out = out, .residual = in == out});
  };
  const auto reduce = [&](int in, int out) {
    shapes.push_back({.kind = ConvolutionKind::kPointwise, .in = in, .out = out, .linear = true});
  };
  dense(16, 16);
  dense(16, 24);
  dense(24, 40);
  for (int i = 0; i < 2; ++i) separable(40, 40);
  separable(40, 80);
  for (int i = 0; i < 2; ++i) separable(80, 80);
  separable(80, 144);
  for (int i = 0; i < 5; ++i) separable(144, 144);
  reduce(144, 80);
  for (int i = 0; i < 2; ++i) separable(80, 80);
  reduce(80, 40);
  for (int i = 0; i < 2; ++i) separable(40, 40);
  reduce(40, 24);
  dense(24, 28);
  reduce(28, 4);
  return shapes;
}

std::size_t bytesOf(const ConvolutionShape& shape) {
  return shape.out * (sizeof(std::int32_t) + 1) + shape.weightCount();
}

// Four pixels become one with 4 x 4 channels: the depths of the four, whether they are measured, their heights, and
// whether there are heights at all.
void fillInput(std::span<const std::uint16_t> depthMm, std::span<const std::int16_t> heightMm, bool floorKnown,
               FeatureMap& input) {
  const std::int16_t floor = floorKnown ? 1024 : 0;
  std::array<std::int16_t, kWidth> depth, measured, height;
  for (int y = 0; y < 2 * input.height(); ++y) {
    const std::size_t first = std::size_t{1} * y * kWidth;
    measure(depthMm.subspan(first, kWidth), heightMm.subspan(first, kWidth), floorKnown, {depth, measured, height});
    std::int16_t* to = input.row(y / 2) + y % 2 * 2;
    for (int x = 0; x < kWidth; x += 2, to += input.channels()) {
      std::copy_n(&depth[x], 2, to);
      std::copy_n(&measured[x], 2, to + 4);
      std::copy_n(&height[x], 2, to + 8);
      std::fill_n(to + 12, 2, floor);
    }
  }
}

// A pixel's first four channels become four pixels.
void spread(const FeatureMap& from, std::span<std::int16_t> to) {
  for (int y = 0; y < from.height(); ++y) {
    const std::int16_t* four = from.row(y);
    std::int16_t* upper = to.data() + std::size_t{2} * y * kWidth;
    for (int x = 0; x < from.width(); ++x, four += from.channels(), upper += 2) {
      std::copy_n(four, 2, upper);
      std::copy_n(four + 2, 2, upper + kWidth);
    }
  }
}

}  // namespace

int ConvolutionShape::taps() const {
  switch (kind) {
    case ConvolutionKind::kDense:
      return 9 * in;
    case ConvolutionKind::kDepthwise:
      return 9;
    case ConvolutionKind::kPointwise:
      break;
  }
  return in;
}

Convolution::Convolution(const ConvolutionShape& layer, std::span<const std::int32_t> bias,
                         std::span<const std::uint8_t> shifts, std::span<const std::int8_t> inFile)
    : shape(layer),
      in(filledUp(layer.in)),
      out(filledUp(layer.out)),
      offset(out),
      shift(out),
      weights(std::size_t{2} * pairsOf(layer) * out) {
  for (int o = 0; o < shape.out; ++o) {
    shift[o] = shifts[o];
    offset[o] = bias[o] + (shifts[o] > 0 ? 1 << (shifts[o] - 1) : 0);
  }

  const int pairs = pairsOf(shape);
  for (int o = 0; o < shape.out; ++o) {
    for (int tap = 0; tap < 2 * pairs; ++tap) {
      const int pair = tap / 2, second = tap % 2;
      std::int16_t& to = weights.data()[((o / kBlock * pairs + pair) * kBlock + o % kBlock) * 2 + second];
      if (shape.kind == ConvolutionKind::kDepthwise) {
        const int pixel = kDepthwisePairs[pair][second];
        if (pixel >= 0) to = inFile[pixel * shape.out + o];  // NOLINT(bugprone-signed-char-misuse): a number
      } else {
        const int pixel = tap / in, channel = tap % in;
        // NOLINTNEXTLINE(bugprone-signed-char-misuse): a number
        if (channel < shape.in) to = inFile[(pixel * shape.in + channel) * shape.out + o];
      }
    }
  }
}

PersonNetwork::Level::Level(int width, int height, int channelsAbove, int channels)
    : above(width, height, channelsAbove),
      aboveFiltered(width, height, channelsAbove),
      a(width, height, channels),
      b(width, height, channels),
      filtered(width, height, channels) {}

PersonNetwork::PersonNetwork()
    : input_(80, 64, 16),
      early_(80, 64, 16),
      top_(80, 64, 24),
      mixed_(80, 64, 32),
      logitsOfCells_(80, 64, 8),
      levels_{Level(40, 32, 24, 40), Level(20, 16, 40, 80), Level(10, 8, 80, 144), Level(5, 4, 144, 144)},
      logits_(std::size_t{1} * kWidth * kHeight) {}

Result<PersonNetwork> PersonNetwork::fromBytes(std::span<const std::uint8_t> file) {
  const std::vector<ConvolutionShape> shapes = shapesOfNet();
  std::size_t size = kMagic.size();
  for (const ConvolutionShape& shape : shapes) size += bytesOf(shape);
  if (file.size() < kMagic.size() || std::memcmp(file.data(), kMagic.data(), kMagic.size()) != 0) {
    return badFormat("a person network starts with {}, these {} bytes do not", kMagic, file.size());
  }
  if (file.size() != size) {
    return badFormat("a person network of {} bytes, expected {}", file.size(), size);
  }

  PersonNetwork network;
  network.convolutions_.reserve(shapes.size());
  std::span<const std::uint8_t> left = file.subspan(kMagic.size());
  const auto take = [&](std::size_t count) {
    const std::span<const std::uint8_t> taken = left.first(count);
    left = left.subspan(count);
    return taken;
  };
  std::vector<std::int32_t> bias;
  std::vector<std::int8_t> weights;
  for (const ConvolutionShape& shape : shapes) {
    const std::size_t number = network.convolutions_.size() + 1;
    bias.resize(shape.out);
    for (int o = 0; o < shape.out; ++o) {
      const std::span<const std::uint8_t> raw = take(sizeof(std::int32_t));
      bias[o] = loadLittleEndian<std::int32_t>(reinterpret_cast<const char*>(raw.data()));
      if (bias[o] < -kMaxBias || bias[o] > kMaxBias) {
        return badFormat("convolution {} of a person network: bias {} of channel {}, expected at most {} in size",
                         number, bias[o], o, kMaxBias);
      }
    }
    const std::span<const std::uint8_t> shifts = take(shape.out);
    for (int o = 0; o < shape.out; ++o) {
      if (shifts[o] > kMaxShift) {
        return badFormat("convolution {} of a person network: shift {} of channel {}, expected 0 to {}", number,
                         shifts[o], o, kMaxShift);
      }
    }
    const std::span<const std::uint8_t> raw = take(shape.weightCount());
    weights.assign(raw.begin(), raw.end());
    network.convolutions_.emplace_back(shape, bias, shifts, weights);
  }
  return network;
}

PersonNetwork PersonNetwork::shipped() {
  return fromBytes(personNetworkFile()).value();
}

void PersonNetwork::convolveNext(const FeatureMap& from, const FeatureMap& block, FeatureMap& to) {
  const Convolution& convolution = convolutions_[next_++];
  LORICA_CHECK(convolution.in == from.channels() && convolution.out == to.channels(),
               "PersonNetwork::run does not go through the net as shapesOfNet lists it");
  convolve(convolution, from, block, to);
}

void PersonNetwork::convolveNext(const FeatureMap& from, FeatureMap& to) {
  convolveNext(from, from, to);
}

void PersonNetwork::separableNext(const FeatureMap& from, FeatureMap& filtered, FeatureMap& to) {
  convolveNext(from, filtered);
  convolveNext(filtered, from, to);
}

std::span<const std::int16_t> PersonNetwork::run(std::span<const std::uint16_t> depthMm,
                                                 std::span<const std::int16_t> heightMm, bool floorKnown) {
  LORICA_CHECK(depthMm.size() == logits_.size() && heightMm.size() == logits_.size(),
               "PersonNetwork::run takes images of 160 x 128");
  next_ = 0;
  auto& [at40, at20, at10, at5] = levels_;  // by their widths

  // Down: each level sees twice as far.
  fillInput(depthMm, heightMm, floorKnown, input_);
  convolveNext(input_, early_);
  convolveNext(early_, top_);
  halve(top_, at40.above);
  convolveNext(at40.above, at40.a);
  separableNext(at40.a, at40.filtered, at40.b);
  separableNext(at40.b, at40.filtered, at40.a);
  halve(at40.a, at20.above);
  for (Level* level : {&at20, &at10}) {
    separableNext(level->above, level->aboveFiltered, level->a);
    separableNext(level->a, level->filtered, level->b);
    separableNext(level->b, level->filtered, level->a);
    halve(level->a, level == &at20 ? at10.above : at5.above);
  }
  separableNext(at5.above, at5.filtered, at5.a);
  separableNext(at5.a, at5.filtered, at5.b);

  // Up: what a level knows is added to what the level above saw.
  addDoubled(at5.b, at10.a);
  separableNext(at10.a, at10.filtered, at10.b);
  convolveNext(at10.b, at10.above);
  addDoubled(at10.above, at20.a);
  separableNext(at20.a, at20.filtered, at20.b);
  separableNext(at20.b, at20.filtered, at20.a);
  convolveNext(at20.a, at20.above);
  addDoubled(at20.above, at40.a);
  separableNext(at40.a, at40.filtered, at40.b);
  separableNext(at40.b, at40.filtered, at40.a);
  convolveNext(at40.a, at40.above);
  addDoubled(at40.above, top_);
  convolveNext(top_, mixed_);
  convolveNext(mixed_, logitsOfCells_);
  LORICA_CHECK(next_ == convolutions_.size(), "PersonNetwork::run leaves out convolutions");
  spread(logitsOfCells_, logits_);
  return logits_;
}

}  // namespace lorica
