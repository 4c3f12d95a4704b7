#include "capture/tracking/segmentation/convolution.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

// Highway compiles the code between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE once for each instruction set. Not for
// vectors whose size is known only at run time: such vectors cannot be members of an array.
#undef HWY_DISABLED_TARGETS
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "capture/tracking/segmentation/segmentation_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace lorica::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Ints = hn::CappedTag<std::int32_t, 8>;    // sums of 8 outputs, or of fewer
using Shorts = hn::Rebind<std::int16_t, Ints>;  // as many numbers of 16 bits

constexpr std::int16_t kMax = 4095;

void measurePixels(std::span<const std::uint16_t> depthMm, std::span<const std::int16_t> heightMm, bool floorKnown,
                   const PixelInputs& to) {
  const Ints ints;
  const hn::RebindToUnsigned<Ints> counts;
  const Shorts shorts;
  const hn::Rebind<std::uint16_t, Ints> depths;
  // Quotients by way of a product: 0.512 * 2^20, rounded up, which is the same as dividing for all numbers below.
  const auto factor = hn::Set(counts, 536871);
  const auto farthest = hn::Set(counts, 7999);  // gives 4095
  const auto floor = hn::Set(ints, 500), highest = hn::Set(ints, floorKnown ? 4000 : 0), max = hn::Set(ints, kMax);
  for (std::size_t i = 0; i < depthMm.size(); i += hn::Lanes(ints)) {
    const auto depth = hn::PromoteTo(counts, hn::LoadU(depths, depthMm.data() + i));
    const auto scaled = hn::ShiftRight<20>(hn::Mul(hn::Min(depth, farthest), factor));
    hn::StoreU(hn::DemoteTo(shorts, hn::BitCast(ints, scaled)), shorts, to.depth.data() + i);

    const auto nothing = hn::Eq(hn::BitCast(ints, depth), hn::Zero(ints));
    hn::StoreU(hn::DemoteTo(shorts, hn::IfThenZeroElse(nothing, hn::Set(ints, 1024))), shorts, to.measured.data() + i);

    const auto above = hn::Add(hn::PromoteTo(ints, hn::LoadU(shorts, heightMm.data() + i)), floor);
    const auto kept = hn::BitCast(counts, hn::Min(hn::Max(above, hn::Zero(ints)), highest));
    const auto height = hn::Min(hn::BitCast(ints, hn::ShiftRight<19>(hn::Mul(kept, factor))), max);
    hn::StoreU(hn::DemoteTo(shorts, hn::IfThenZeroElse(nothing, height)), shorts, to.height.data() + i);
  }
}

/// Where a convolution of all channels finds its inputs: rows of pairs of numbers that lie side by side.
struct Taps {
  int rows, pairs;  ///< pairs of a row
  std::ptrdiff_t rowStride, pixelStride;
};

#if HWY_TARGET == HWY_SCALAR

/// Two inputs or two weights.
struct PairVec {
  std::int32_t first, second;
};

HWY_INLINE PairVec loadPairs(const std::int16_t* numbers) {
  return {numbers[0], numbers[1]};
}

HWY_INLINE PairVec samePair(const std::int16_t* numbers) {
  return loadPairs(numbers);
}

HWY_INLINE PairVec pairOf(hn::Vec<Ints> first, hn::Vec<Ints> second) {
  return {hn::GetLane(first), hn::GetLane(second)};
}

HWY_INLINE hn::Vec<Ints> addProducts(PairVec inputs, PairVec weights, hn::Vec<Ints> sum, hn::Vec<Ints>& /*more*/) {
  return hn::Add(sum, hn::Set(Ints(), inputs.first * weights.first + inputs.second * weights.second));
}

HWY_INLINE hn::Vec<Ints> totalOf(hn::Vec<Ints> sum, hn::Vec<Ints> /*more*/) {
  return sum;
}

#else

/// Two inputs or two weights for each lane of Ints.
using Pairs = hn::Repartition<std::int16_t, Ints>;
using PairVec = hn::Vec<Pairs>;

HWY_INLINE PairVec loadPairs(const std::int16_t* numbers) {
  return hn::Load(Pairs(), numbers);
}

/// The same two for each lane.
HWY_INLINE PairVec samePair(const std::int16_t* numbers) {
  std::int32_t pair = 0;
  std::memcpy(&pair, numbers, sizeof(pair));
  return hn::BitCast(Pairs(), hn::Set(Ints(), pair));
}

/// @param first, second  not negative, below 2^15
HWY_INLINE PairVec pairOf(hn::Vec<Ints> first, hn::Vec<Ints> second) {
  return hn::BitCast(Pairs(), hn::Or(first, hn::ShiftLeft<16>(second)));
}

/// @param more  a second part of the sum, which some instruction sets need; begins with 0
HWY_INLINE hn::Vec<Ints> addProducts(PairVec inputs, PairVec weights, hn::Vec<Ints> sum, hn::Vec<Ints>& more) {
  return hn::ReorderWidenMulAccumulate(Ints(), inputs, weights, sum, more);
}

HWY_INLINE hn::Vec<Ints> totalOf(hn::Vec<Ints> sum, hn::Vec<Ints> more) {
  return hn::RearrangeToOddPlusEven(sum, more);
}

#endif

/// Rounds sums, adds the residual, if any, and keeps the range. The residual would be shifted left with the bias and
/// right with the sum: it is the same, and cannot overflow, to add it afterwards.
template <bool kResidual>
HWY_INLINE void finish(hn::Vec<Ints> sum, hn::Vec<Ints> shift, const std::int16_t* residual, std::int16_t low,
                       std::int16_t high, std::int16_t* to) {
  const Shorts shorts;
  sum = hn::Shr(sum, shift);
  if constexpr (kResidual) sum = hn::Add(sum, hn::PromoteTo(Ints(), hn::LoadU(shorts, residual)));
  const auto result = hn::DemoteTo(shorts, sum);
  hn::StoreU(hn::Min(hn::Max(result, hn::Set(shorts, low)), hn::Set(shorts, high)), shorts, to);
}

/// A few vectors of outputs, from output `o` on, of all pixels.
template <int kVectors, bool kResidual>
HWY_INLINE void convolveOutputs(const Convolution& c, const Taps& taps, std::size_t o, const FeatureMap& from,
                                const FeatureMap& block, FeatureMap& to) {
  // That share weights once they are loaded: as many as there are registers for sums. Widths are multiples of 5.
  constexpr int kPixels = kVectors == 3 ? 3 : 5;
  const Ints ints;
  const std::size_t lanes = hn::Lanes(ints);
  const std::int16_t low = c.shape.linear ? -32768 : 0, high = c.shape.linear ? 32767 : kMax;
  const std::int16_t* firstWeight[kVectors];
  hn::Vec<Ints> offset[kVectors], shift[kVectors];
  for (int v = 0; v < kVectors; ++v, o += lanes) {
    firstWeight[v] = c.weights.data() + (o / 8 * taps.rows * taps.pairs * 8 + o % 8) * 2;
    offset[v] = hn::LoadU(ints, c.offset.data() + o);
    shift[v] = hn::LoadU(ints, c.shift.data() + o);
  }
  o -= kVectors * lanes;

  for (int y = 0; y < to.height(); ++y) {
    const std::int16_t* firstTap = from.row(y - taps.rows / 2) - taps.rows / 2 * taps.pixelStride;
    // The last pixels may be computed twice.
    for (int x = 0; x < to.width(); x += kPixels) {
      x = std::min(x, to.width() - kPixels);
      hn::Vec<Ints> sum[kPixels][kVectors], more[kPixels][kVectors];
      for (int p = 0; p < kPixels; ++p) {
        for (int v = 0; v < kVectors; ++v) {
          sum[p][v] = offset[v];
          more[p][v] = hn::Zero(ints);
        }
      }
      std::size_t next = 0;
      for (int row = 0; row < taps.rows; ++row) {
        const std::int16_t* tap = firstTap + row * taps.rowStride + x * taps.pixelStride;
        for (int pair = 0; pair < taps.pairs; ++pair, tap += 2, next += 16) {
          PairVec weights[kVectors];
          for (int v = 0; v < kVectors; ++v) weights[v] = loadPairs(firstWeight[v] + next);
          for (int p = 0; p < kPixels; ++p) {
            const auto input = samePair(tap + p * taps.pixelStride);
            for (int v = 0; v < kVectors; ++v) sum[p][v] = addProducts(input, weights[v], sum[p][v], more[p][v]);
          }
        }
      }
      for (int p = 0; p < kPixels; ++p) {
        std::int16_t* result = to.row(y) + (x + p) * c.out + o;
        const std::int16_t* residual = kResidual ? block.row(y) + (x + p) * c.out + o : nullptr;
        for (int v = 0; v < kVectors; ++v) {
          const std::ptrdiff_t at = v * lanes;
          finish<kResidual>(totalOf(sum[p][v], more[p][v]), shift[v], kResidual ? residual + at : nullptr, low, high,
                            result + at);
        }
      }
    }
  }
}

template <bool kResidual>
HWY_INLINE void convolveChannels(const Convolution& c, const FeatureMap& from, const FeatureMap& block,
                                 FeatureMap& to) {
  const int reach = c.shape.kind == ConvolutionKind::kDense ? 3 : 1;
  const Taps taps = {reach, reach * c.in / 2, from.stride(), c.in};
  const std::size_t lanes = hn::Lanes(Ints());
  // By three vectors, and two at the end: with a single one, more would be loaded than computed.
  for (std::size_t o = 0; o < static_cast<std::size_t>(c.out);) {
    const std::size_t left = (c.out - o) / lanes;
    if (left == 1) {
      convolveOutputs<1, kResidual>(c, taps, o, from, block, to);
      o += lanes;
    } else if (left == 2 || left == 4) {
      convolveOutputs<2, kResidual>(c, taps, o, from, block, to);
      o += 2 * lanes;
    } else {
      convolveOutputs<3, kResidual>(c, taps, o, from, block, to);
      o += 3 * lanes;
    }
  }
}

void convolveAll(const Convolution& c, const FeatureMap& from, const FeatureMap& block, FeatureMap& to) {
  if (c.shape.residual) {
    convolveChannels<true>(c, from, block, to);
  } else {
    convolveChannels<false>(c, from, block, to);
  }
}

HWY_INLINE hn::Vec<Ints> inputAt(const std::int16_t* numbers) {
  return hn::PromoteTo(Ints(), hn::LoadU(Shorts(), numbers));
}

void convolveEach(const Convolution& c, const FeatureMap& from, FeatureMap& to) {
  const Ints ints;
  constexpr int kPairs = kDepthwisePairs.size();
  for (std::size_t o = 0; o < static_cast<std::size_t>(c.out); o += hn::Lanes(ints)) {
    const std::int16_t* weights = c.weights.data() + (o / 8 * kPairs * 8 + o % 8) * 2;
    const auto left = loadPairs(weights), middle = loadPairs(weights + 16), right = loadPairs(weights + 32),
               lowest = loadPairs(weights + 48), last = loadPairs(weights + 64);
    const auto offset = hn::LoadU(ints, c.offset.data() + o);
    const auto shift = hn::LoadU(ints, c.shift.data() + o);
    for (int y = 0; y < to.height(); ++y) {
      const std::int16_t* upper = from.row(y - 1) + o;
      const std::int16_t* same = from.row(y) + o;
      const std::int16_t* lower = from.row(y + 1) + o;
      std::int16_t* result = to.row(y) + o;
      // The upper two inputs of a column make a pair, which three pixels use.
      auto pairBefore = pairOf(inputAt(upper - c.out), inputAt(same - c.out));
      auto pairHere = pairOf(inputAt(upper), inputAt(same));
      auto lowBefore = inputAt(lower - c.out);
      auto lowHere = inputAt(lower);
      for (int x = 0; x < to.width(); ++x) {
        upper += c.out;
        same += c.out;
        lower += c.out;
        const auto pairAfter = pairOf(inputAt(upper), inputAt(same));
        const auto lowAfter = inputAt(lower);
        auto more = hn::Zero(ints);
        auto sum = addProducts(pairBefore, left, offset, more);
        sum = addProducts(pairHere, middle, sum, more);
        sum = addProducts(pairAfter, right, sum, more);
        sum = addProducts(pairOf(lowBefore, lowHere), lowest, sum, more);
        sum = addProducts(pairOf(lowAfter, hn::Zero(ints)), last, sum, more);
        finish<false>(totalOf(sum, more), shift, nullptr, 0, kMax, result);
        result += c.out;
        pairBefore = pairHere;
        pairHere = pairAfter;
        lowBefore = lowHere;
        lowHere = lowAfter;
      }
    }
  }
}

void takeLargest(const FeatureMap& from, FeatureMap& to) {
  const hn::CappedTag<std::int16_t, 8> shorts;
  const std::ptrdiff_t channels = to.channels();
  for (int y = 0; y < to.height(); ++y) {
    const std::int16_t* upper = from.row(2 * y);
    const std::int16_t* lower = from.row(2 * y + 1);
    std::int16_t* result = to.row(y);
    for (int x = 0; x < to.width(); ++x, upper += 2 * channels, lower += 2 * channels, result += channels) {
      for (std::ptrdiff_t c = 0; c < channels; c += hn::Lanes(shorts)) {
        const auto above = hn::Max(hn::LoadU(shorts, upper + c), hn::LoadU(shorts, upper + channels + c));
        const auto below = hn::Max(hn::LoadU(shorts, lower + c), hn::LoadU(shorts, lower + channels + c));
        hn::StoreU(hn::Max(above, below), shorts, result + c);
      }
    }
  }
}

void addToFour(const FeatureMap& from, FeatureMap& to) {
  const hn::CappedTag<std::int16_t, 8> shorts;
  const auto zero = hn::Zero(shorts), max = hn::Set(shorts, kMax);
  const std::ptrdiff_t channels = to.channels();
  for (int y = 0; y < to.height(); ++y) {
    const std::int16_t* source = from.row(y / 2);
    std::int16_t* pixel = to.row(y);
    for (int x = 0; x < to.width(); ++x, pixel += channels) {
      for (std::ptrdiff_t c = 0; c < channels; c += hn::Lanes(shorts)) {
        // What does not fit into 16 bits is out of range anyway.
        const auto sum = hn::SaturatedAdd(hn::LoadU(shorts, source + c), hn::LoadU(shorts, pixel + c));
        hn::StoreU(hn::Min(hn::Max(sum, zero), max), shorts, pixel + c);
      }
      if (x % 2 == 1) source += channels;
    }
  }
}

}  // namespace lorica::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace lorica {
namespace {
HWY_EXPORT(measurePixels);
HWY_EXPORT(convolveAll);
HWY_EXPORT(convolveEach);
HWY_EXPORT(takeLargest);
HWY_EXPORT(addToFour);
}  // namespace

void measure(std::span<const std::uint16_t> depthMm, std::span<const std::int16_t> heightMm, bool floorKnown,
             const PixelInputs& to) {
  HWY_DYNAMIC_DISPATCH(measurePixels)(depthMm, heightMm, floorKnown, to);
}

void convolve(const Convolution& convolution, const FeatureMap& from, const FeatureMap& block, FeatureMap& to) {
  if (convolution.shape.kind == ConvolutionKind::kDepthwise) {
    HWY_DYNAMIC_DISPATCH(convolveEach)(convolution, from, to);
  } else {
    HWY_DYNAMIC_DISPATCH(convolveAll)(convolution, from, block, to);
  }
}

void halve(const FeatureMap& from, FeatureMap& to) {
  HWY_DYNAMIC_DISPATCH(takeLargest)(from, to);
}

void addDoubled(const FeatureMap& from, FeatureMap& to) {
  HWY_DYNAMIC_DISPATCH(addToFour)(from, to);
}

}  // namespace lorica
#endif
