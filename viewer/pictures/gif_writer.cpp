#include "viewer/pictures/gif_writer.h"

#include "geometry/files.h"

#include <fmt/format.h>
#include <gif_lib.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace lorica {
namespace {

constexpr int kBinBits = 6;  // per channel, in the histogram
constexpr std::size_t kBinCount = std::size_t{1} << (3 * kBinBits);
constexpr std::size_t kMaxColors = 255;
constexpr std::uint8_t kUnchanged = 255;  // transparent index: keeps the pixel of the previous frame
constexpr int kSame = 3;                  // smaller changes of a channel are ignored, so that gradients do not flicker
constexpr int kMaxSide = 4096;

std::uint32_t binOf(const std::uint8_t* rgb) {
  constexpr int kShift = 8 - kBinBits;
  return static_cast<std::uint32_t>(rgb[0] >> kShift) << (2 * kBinBits) |
         static_cast<std::uint32_t>(rgb[1] >> kShift) << kBinBits | static_cast<std::uint32_t>(rgb[2] >> kShift);
}
int channelOf(std::uint32_t bin, int channel) {
  return static_cast<int>(bin >> ((2 - channel) * kBinBits) & ((1u << kBinBits) - 1));
}

/// Bins that share a colour, and the channel along which they differ most.
struct Box {
  std::vector<std::uint32_t> bins;
  double weight = 0.0;
  int channel = 0;
  int extent = 0;  // distance of the outermost bins
  int middle = 0;  // of these bins, relative to the lowest
};

Box boxOf(std::vector<std::uint32_t> bins, const std::vector<std::uint32_t>& weightOfBin) {
  Box box{std::move(bins)};
  for (int channel = 0; channel < 3; ++channel) {
    int min = 1 << kBinBits, max = 0;
    for (const std::uint32_t bin : box.bins) {
      min = std::min(min, channelOf(bin, channel));
      max = std::max(max, channelOf(bin, channel));
    }
    if (max - min > box.extent) {
      box.extent = max - min;
      box.channel = channel;
      box.middle = (min + max + 1) / 2;
    }
  }
  for (const std::uint32_t bin : box.bins) box.weight += weightOfBin[bin];
  return box;
}

/// Repeatedly splits the most important box of colours until there are enough boxes. Boxes are ranked by extent times
/// the square root of their number of pixels and split in the middle of their extent, so that a few bright pixels keep
/// their colour.
std::vector<Box> cutColors(std::vector<std::uint32_t> bins, const std::vector<std::uint32_t>& weightOfBin) {
  std::vector<Box> boxes;
  boxes.push_back(boxOf(std::move(bins), weightOfBin));
  const auto worth = [](const Box& box) { return std::sqrt(box.weight) * box.extent; };
  while (boxes.size() < kMaxColors) {
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

int appendBytes(GifFileType* gif, const GifByteType* bytes, int count) {
  static_cast<std::string*>(gif->UserData)
      ->append(reinterpret_cast<const char*>(bytes), static_cast<std::size_t>(count));
  return count;
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
      colorOfBin_(kBinCount),
      bytes_(std::make_unique<std::string>()) {
  // giflib fails only if memory runs out or if its own rules are broken; the bytes are in memory.
  int error = 0;
  gif_.reset(EGifOpen(bytes_.get(), appendBytes, &error));
  LORICA_CHECK(gif_ != nullptr, GifErrorString(error));
  EGifSetGifVersion(gif_.get(), true);
  const unsigned char forever[] = {1, 0, 0};
  put(EGifPutScreenDesc(gif_.get(), width, height, 8, 0, nullptr));
  put(EGifPutExtensionLeader(gif_.get(), APPLICATION_EXT_FUNC_CODE));
  put(EGifPutExtensionBlock(gif_.get(), 11, "NETSCAPE2.0"));
  put(EGifPutExtensionBlock(gif_.get(), 3, forever));
  put(EGifPutExtensionTrailer(gif_.get()));
}

void GifWriter::Close::operator()(GifFileType* gif) const {
  int ignored = 0;
  (void)EGifCloseFile(gif, &ignored);
}

void GifWriter::put(int status) const {
  LORICA_CHECK(status == GIF_OK, GifErrorString(gif_->Error));
}

Result<GifWriter> GifWriter::create(const std::filesystem::path& file, int width, int height, double framesPerSecond) {
  if (file.extension() != ".gif") {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{}: the name of an animation must end in .gif", file.string())};
  }
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{}: {} x {} pixels, expected 1 to {}", file.string(), width, height, kMaxSide)};
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
  // Find the changed pixels and how often each colour occurs in them.
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
  const GraphicsControlBlock control{DISPOSE_DO_NOT, false, hundredths(frames_ + 1) - hundredths(frames_), kUnchanged};
  GifByteType packed[4];
  put(EGifPutExtension(gif_.get(), GRAPHICS_EXT_FUNC_CODE, static_cast<int>(EGifGCBToExtension(&control, packed)),
                       packed));
  GifColorType colors[256] = {};
  for (std::size_t i = 0; i < palette_.size(); ++i) colors[i] = {palette_[i][0], palette_[i][1], palette_[i][2]};
  ColorMapObject map{256, 8, false, colors};
  put(EGifPutImageDesc(gif_.get(), 0, 0, width_, height_, false, &map));
  put(EGifPutLine(gif_.get(), indices_.data(), static_cast<int>(indices_.size())));
  ++frames_;
  return {};
}

Result<void> GifWriter::finish() {
  if (frames_ == 0) {
    return Error{ErrorCode::kInvalidArgument, fmt::format("{}: the animation has no frames", file_.string())};
  }
  gif_.reset();  // writes the end
  return writeFileAtomically(file_, *bytes_);
}

}  // namespace lorica
