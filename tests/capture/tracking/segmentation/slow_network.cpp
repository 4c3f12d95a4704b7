#include "tests/capture/tracking/segmentation/slow_network.h"

#include "geometry/little_endian.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

namespace lorica::test {
namespace {

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

}  // namespace

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

}  // namespace lorica::test
