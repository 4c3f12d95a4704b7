#include "viewer/gif_writer.h"

#include "geometry/files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace lorica {
namespace {

constexpr int kBinBits = 6;  // of a channel, in the histogram
constexpr std::size_t kBinCount = std::size_t{1} << (3 * kBinBits);
constexpr std::size_t kMostColors = 255;
constexpr std::uint8_t kUnchanged = 255;  // the index that lets the frame before show through
constexpr int kSame = 3;                  // a channel that moved less stays as it is shown: gradients do not flicker
constexpr int kMostSide = 4096;

std::uint32_t binOf(const std::uint8_t* rgb) {
  constexpr int kShift = 8 - kBinBits;
  return static_cast<std::uint32_t>(rgb[0] >> kShift) << (2 * kBinBits) |
         static_cast<std::uint32_t>(rgb[1] >> kShift) << kBinBits | static_cast<std::uint32_t>(rgb[2] >> kShift);
}
int channelOf(std::uint32_t bin, int channel) {
  return static_cast<int>(bin >> ((2 - channel) * kBinBits) & ((1u << kBinBits) - 1));
}

void appendShort(std::string& bytes, int number) {
  bytes += static_cast<char>(number & 0xff);
  bytes += static_cast<char>(number >> 8 & 0xff);
}

/// Bins that share a colour, and along which channel they differ most.
struct Box {
  std::vector<std::uint32_t> bins;
  double weight = 0.0;
  int channel = 0;
  int extent = 0;  // bins between the outermost ones
  int middle = 0;  // of them, above the lowest
};

Box boxOf(std::vector<std::uint32_t> bins, const std::vector<std::uint32_t>& weightOfBin) {
  Box box{std::move(bins)};
  for (int channel = 0; channel < 3; ++channel) {
    int least = 1 << kBinBits, most = 0;
    for (const std::uint32_t bin : box.bins) {
      least = std::min(least, channelOf(bin, channel));
      most = std::max(most, channelOf(bin, channel));
    }
    if (most - least > box.extent) {
      box.extent = most - least;
      box.channel = channel;
      box.middle = (least + most + 1) / 2;
    }
  }
  for (const std::uint32_t bin : box.bins) box.weight += weightOfBin[bin];
  return box;
}

/// Cuts the box whose colours matter most in halves until there are enough: by size, not by count, so that a few bright
/// pixels keep their colour.
std::vector<Box> cutColors(std::vector<std::uint32_t> bins, const std::vector<std::uint32_t>& weightOfBin) {
  std::vector<Box> boxes;
  boxes.push_back(boxOf(std::move(bins), weightOfBin));
  const auto worth = [](const Box& box) { return std::sqrt(box.weight) * box.extent; };
  while (boxes.size() < kMostColors) {
    const auto worst =
        std::max_element(boxes.begin(), boxes.end(), [&](const Box& a, const Box& b) { return worth(a) < worth(b); });
    if (worst->extent == 0) break;
    Box box = std::move(*worst);
    const auto middle = std::partition(box.bins.begin(), box.bins.end(),
                                       [&box](std::uint32_t bin) { return channelOf(bin, box.channel) < box.middle; });
    *worst = boxOf({box.bins.begin(), middle}, weightOfBin);
    boxes.push_back(boxOf({middle, box.bins.end()}, weightOfBin));
  }
  return boxes;
}

/// LZW with codes of 9 to 12 bits, lowest bit first, in blocks of at most 255 bytes.
void appendLzw(std::string& bytes, const std::vector<std::uint8_t>& indices) {
  constexpr int kClear = 256, kEnd = 257, kMostCodes = 4096;
  std::vector<std::int16_t> longer(static_cast<std::size_t>(kMostCodes) * 256);  // code of a string and one more index
  int codes = 0, bits = 0;
  std::string packed;
  std::uint32_t buffer = 0;
  int filled = 0;
  const auto put = [&](int code) {
    buffer |= static_cast<std::uint32_t>(code) << filled;
    for (filled += bits; filled >= 8; filled -= 8, buffer >>= 8) packed += static_cast<char>(buffer & 0xff);
  };
  const auto clear = [&] {
    std::fill(longer.begin(), longer.end(), std::int16_t{-1});
    codes = kEnd + 1;
    bits = 9;
  };
  clear();
  put(kClear);
  int code = indices.front();
  for (std::size_t i = 1; i < indices.size(); ++i) {
    std::int16_t& next = longer[static_cast<std::size_t>(code) * 256 + indices[i]];
    if (next >= 0) {
      code = next;
      continue;
    }
    put(code);
    if (codes < kMostCodes) {
      if (codes == 1 << bits) ++bits;  // the reader learns this code with its next one
      next = static_cast<std::int16_t>(codes++);
    } else {
      put(kClear);
      clear();
    }
    code = indices[i];
  }
  put(code);
  if (codes == 1 << bits && bits < 12) ++bits;
  put(kEnd);
  if (filled > 0) packed += static_cast<char>(buffer & 0xff);
  bytes += '\x08';
  for (std::size_t at = 0; at < packed.size(); at += 255) {
    const std::string block = packed.substr(at, 255);
    bytes += static_cast<char>(block.size());
    bytes += block;
  }
  bytes += '\0';
}

}  // namespace

GifWriter::GifWriter(std::filesystem::path file, int width, int height, double framesPerSecond)
    : file_(std::move(file)),
      width_(width),
      height_(height),
      framesPerSecond_(framesPerSecond),
      indices_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height)),
      weightOfBin_(kBinCount),
      sumOfBin_(kBinCount),
      colorOfBin_(kBinCount) {
  bytes_ = "GIF89a";
  appendShort(bytes_, width);
  appendShort(bytes_, height);
  bytes_ += std::string("\x70\0\0", 3);                                // no palette for all frames
  bytes_ += std::string("\x21\xff\x0bNETSCAPE2.0\x03\x01\0\0\0", 19);  // again and again
}

Result<GifWriter> GifWriter::create(const std::filesystem::path& file, int width, int height, double framesPerSecond) {
  if (file.extension() != ".gif") {
    return Error{ErrorCode::kInvalidArgument, fmt::format("{}: an animation's name must end in .gif", file.string())};
  }
  if (width < 1 || height < 1 || width > kMostSide || height > kMostSide) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{}: {} x {} pixels, expected 1 to {}", file.string(), width, height, kMostSide)};
  }
  if (!(framesPerSecond > 0.0 && framesPerSecond <= 50.0)) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{}: {} frames per second, expected above 0, at most 50", file.string(), framesPerSecond)};
  }
  return GifWriter(file, width, height, framesPerSecond);
}

Result<void> GifWriter::add(const Image& image) {
  if (image.width != width_ || image.height != height_ || image.rgba.size() != indices_.size() * 4) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{}: frame {} is {} x {} pixels, expected {} x {}", file_.string(), frames_, image.width,
                             image.height, width_, height_)};
  }
  // What changed, and how often each colour occurs in it.
  std::fill(weightOfBin_.begin(), weightOfBin_.end(), 0u);
  const bool first = frames_ == 0;
  if (first) shown_.assign(indices_.size() * 3, 0);
  std::vector<std::uint32_t> bins;
  for (std::size_t i = 0; i < indices_.size(); ++i) {
    const std::uint8_t* rgb = image.rgba.data() + 4 * i;
    const std::uint8_t* old = shown_.data() + 3 * i;
    const bool same =
        std::abs(rgb[0] - old[0]) <= kSame && std::abs(rgb[1] - old[1]) <= kSame && std::abs(rgb[2] - old[2]) <= kSame;
    indices_[i] = same && !first ? kUnchanged : 0;
    if (indices_[i] == kUnchanged) continue;
    const std::uint32_t bin = binOf(rgb);
    if (weightOfBin_[bin]++ == 0) {
      bins.push_back(bin);
      sumOfBin_[bin] = {};
    }
    for (std::size_t c = 0; c < 3; ++c) sumOfBin_[bin][c] += rgb[c];
  }
  palette_.clear();
  if (!bins.empty()) {
    std::sort(bins.begin(), bins.end());
    for (const Box& box : cutColors(std::move(bins), weightOfBin_)) {
      std::array<double, 3> sum{};
      for (const std::uint32_t bin : box.bins) {
        colorOfBin_[bin] = static_cast<std::uint8_t>(palette_.size());
        for (std::size_t c = 0; c < 3; ++c) sum[c] += sumOfBin_[bin][c];
      }
      std::array<std::uint8_t, 3> color{};
      for (std::size_t c = 0; c < 3; ++c) color[c] = static_cast<std::uint8_t>(std::lround(sum[c] / box.weight));
      palette_.push_back(color);
    }
  }
  for (std::size_t i = 0; i < indices_.size(); ++i) {
    if (indices_[i] == kUnchanged) continue;
    indices_[i] = colorOfBin_[binOf(image.rgba.data() + 4 * i)];
    std::copy_n(palette_[indices_[i]].begin(), 3, shown_.begin() + static_cast<std::ptrdiff_t>(3 * i));
  }

  const auto hundredths = [&](int frame) { return static_cast<int>(std::lround(100.0 * frame / framesPerSecond_)); };
  bytes_ += std::string("\x21\xf9\x04\x05", 4);  // what is unchanged is transparent; the frame stays
  appendShort(bytes_, hundredths(frames_ + 1) - hundredths(frames_));
  bytes_ += static_cast<char>(kUnchanged);
  bytes_ += '\0';
  bytes_ += ',';
  appendShort(bytes_, 0);
  appendShort(bytes_, 0);
  appendShort(bytes_, width_);
  appendShort(bytes_, height_);
  bytes_ += '\x87';  // a palette of 256
  palette_.resize(256);
  for (const std::array<std::uint8_t, 3>& color : palette_) {
    for (const std::uint8_t channel : color) bytes_ += static_cast<char>(channel);
  }
  appendLzw(bytes_, indices_);
  ++frames_;
  return {};
}

Result<void> GifWriter::finish() {
  if (frames_ == 0) {
    return Error{ErrorCode::kInvalidArgument, fmt::format("{}: an animation of no frames", file_.string())};
  }
  return writeFileAtomically(file_, bytes_ + ';');
}

}  // namespace lorica
