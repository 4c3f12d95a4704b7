#include "capture/virtual_sensor/depth_noise.h"

#include "geometry/random_numbers.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lorica {
namespace {

/// Disparity steps per pixel, as reported by the Kinect v1.
constexpr double kStepsPerPixel = 8.0;
/// The baseline used to measure depth, even if shadows are disabled [m].
constexpr double kMeasuringBaseline = 0.075;
constexpr double kClumpCell = 6.0;   ///< [pixels of the sensor]
constexpr double kJitterCell = 3.0;  ///< edges are displaced in blocks of this size [pixels of the sensor]
/// Difference of inverse depth from which an edge is an edge: 4 pixels of disparity of a Kinect v1 [1/m].
constexpr float kEdge = 0.1F;
/// Cosines of the angle from the normal between which a surface disappears gradually: 70 and 83 degrees.
constexpr float kGrazingCosine = 0.342F;
constexpr float kLostCosine = 0.122F;

/// Sum of four 16-bit numbers: approximately normal, variance 1, at most 3.46 (Irwin 1927, Hall 1927).
float deviate(std::uint64_t bits) {
  const auto sum =
      static_cast<std::int32_t>((bits & 0xffff) + ((bits >> 16) & 0xffff) + ((bits >> 32) & 0xffff) + (bits >> 48));
  constexpr float kScale = 1.7320508F / 65536.0F;
  return (sum - 2 * 65535) * kScale;
}

std::uint64_t seedOf(std::uint64_t seed, std::uint64_t frame, std::uint64_t use) {
  RandomNumbers numbers(seed ^ RandomNumbers(frame * 8 + use).bits());
  return numbers.bits();
}

/// The value that a fraction of all deviates exceeds, for fractions below a half: Abramowitz and Stegun 26.2.23,
/// 4.5e-4.
float deviateExceededBy(double part) {
  if (part <= 0.0) return 1e9F;
  const double t = std::sqrt(-2.0 * std::log(part));
  return t - (2.515517 + t * (0.802853 + t * 0.010328)) / (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308)));
}

/// Whole pixels of the image, at least one. Half of an odd size is rounded up, also if the focal lengths are not quite
/// half of each other.
int pixelsOf(double size, double scale) {
  return std::max(1, static_cast<int>(std::ceil(size * scale - 0.1)));
}

/// Adds up the values from `before` pixels left of each pixel to `after` right of it. @param line  one row of scratch
void sumAcross(std::vector<float>& image, std::size_t width, std::size_t before, std::size_t after,
               std::vector<float>& line) {
  for (std::size_t row = 0; row < image.size(); row += width) {
    std::copy_n(image.begin() + row, width, line.begin());
    float sum = 0.0F;
    for (std::size_t i = 0; i < std::min(after, width); ++i) sum += line[i];
    for (std::size_t i = 0; i < width; ++i) {
      if (i + after < width) sum += line[i + after];
      image[row + i] = sum;
      if (i >= before) sum -= line[i - before];
    }
  }
}

/// The same down the columns, from one image to another. @param line  one row of scratch
void sumDown(std::span<const float> image, std::size_t width, std::size_t before, std::size_t after,
             std::vector<float>& line, std::span<float> out) {
  const std::size_t height = image.size() / width;
  std::fill(line.begin(), line.end(), 0.0F);
  const auto add = [&](std::size_t row, float factor) {
    const float* from = &image[row * width];
    for (std::size_t i = 0; i < width; ++i) line[i] += factor * from[i];
  };
  for (std::size_t row = 0; row < std::min(after, height); ++row) add(row, 1.0F);
  for (std::size_t row = 0; row < height; ++row) {
    if (row + after < height) add(row + after, 1.0F);
    std::copy_n(line.begin(), width, out.begin() + row * width);
    if (row >= before) add(row - before, -1.0F);
  }
}

}  // namespace

std::string_view nameOf(DepthNoiseKind kind) {
  constexpr std::array<std::string_view, kDepthNoiseKindCount> kNames = {"kinect", "mild", "none"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::optional<DepthNoiseKind> depthNoiseNamed(std::string_view name) {
  for (int k = 0; k < kDepthNoiseKindCount; ++k) {
    if (nameOf(static_cast<DepthNoiseKind>(k)) == name) return static_cast<DepthNoiseKind>(k);
  }
  return std::nullopt;
}

DepthNoiseSettings DepthNoiseSettings::of(DepthNoiseKind kind) {
  switch (kind) {
    case DepthNoiseKind::kKinect:
      break;
    case DepthNoiseKind::kMild:
      return mild();
    case DepthNoiseKind::kNone:
      return clean();
  }
  return {};
}

DepthNoiseSettings DepthNoiseSettings::clean() {
  DepthNoiseSettings settings;
  settings.axial = settings.lateral = settings.baseline = settings.edgeLoss = settings.steps = settings.dropout = 0.0;
  settings.grazing = false;
  return settings;
}

DepthNoiseSettings DepthNoiseSettings::mild() {
  DepthNoiseSettings settings;
  settings.axial = 0.2;
  settings.lasting = 0.0;
  settings.shared = 0.64;
  settings.smoothness = 4.0;
  settings.edgeLoss = 0.0;
  settings.dropout = 0.004;
  return settings;
}

void DepthNoise::Field::resize(const DepthCamera& camera, int cellSize) {
  cell = cellSize;
  columns = camera.width / cell + 2;
  rows = camera.height / cell + 2;
  values.assign(static_cast<std::size_t>(columns) * rows, 0.0F);
  weights.clear();
  weights.reserve(static_cast<std::size_t>(cell) * cell * 4);
  for (int y = 0; y < cell; ++y) {
    for (int x = 0; x < cell; ++x) {
      const float v = (y + 0.5F) / cell;
      const float u = (x + 0.5F) / cell;
      const std::array<float, 4> w = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
      const float norm = std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2] + w[3] * w[3]);
      for (const float weight : w) weights.push_back(weight / norm);
    }
  }
}

void DepthNoise::Field::draw(std::uint64_t seed) {
  RandomNumbers numbers(seed);
  for (float& value : values) value = deviate(numbers.bits());
}

void DepthNoise::Field::readRow(int row, std::span<float> out) const {
  const int cellRow = row / cell;
  const float* corner = &values[cellRow * columns];
  const float* rowWeights = &weights[(row - cellRow * cell) * cell * 4];
  for (std::size_t begin = 0; begin < out.size(); begin += cell, ++corner) {
    const std::size_t count = std::min<std::size_t>(out.size() - begin, cell);
    const float* w = rowWeights;
    for (std::size_t i = 0; i < count; ++i, w += 4) {
      out[begin + i] = w[0] * corner[0] + w[1] * corner[1] + w[2] * corner[columns] + w[3] * corner[columns + 1];
    }
  }
}

DepthNoise::DepthNoise(const DepthCamera& camera, const DepthNoiseSettings& settings)
    : camera_(camera),
      settings_(settings),
      scale_(camera.focalX() / settings.sensor.focalX()),
      jitterCell_(pixelsOf(kJitterCell, scale_)),
      smearWidth_(pixelsOf(settings.smear, scale_)),
      edgeLossWidth_(settings.edgeLoss > 0.0 ? pixelsOf(settings.edgeLoss, scale_) : 0) {
  const auto pixels = static_cast<std::size_t>(camera.width) * camera.height;
  lit_.assign(pixels, 0.0F);
  spread_.assign(pixels, 0.0F);
  threshold_.assign(pixels, 0.0F);
  lasting_.resize(camera, pixelsOf(settings.smoothness, scale_));
  lasting_.draw(seedOf(settings.seed, 0, 4));
  smooth_.resize(camera, pixelsOf(settings.smoothness, scale_));
  clumps_.resize(camera, pixelsOf(kClumpCell, scale_));
  smoothRow_.assign(camera.width, 0.0F);
  lastingRow_ = clumpsRow_ = rayX_ = smoothRow_;
  if (smearWidth_ > 1) weight_ = sums_ = lit_;
  for (int column = 0; column < camera.width; ++column) rayX_[column] = camera.positionOf(column, 0.0, 1.0).x();
  jitter_.assign(static_cast<std::size_t>(camera.width / jitterCell_ + 1) * (camera.height / jitterCell_ + 1) * 2, 0);
  // Without steps depth is still stored as a disparity, in steps so small that none exceeds 0.1 mm.
  const double steps = settings.steps > 0.0 ? settings.steps : 1e-4 / (2.9e-3 * settings.max * settings.max);
  const double whole = kStepsPerPixel / steps * DepthCamera{}.focalX() * kMeasuringBaseline;
  disparityOfInverse_ = whole;
  if (settings.steps <= 0.0) return;
  millimetres_.resize(static_cast<std::size_t>(whole / settings.min) + 2, 0);
  for (std::size_t step = 1; step < millimetres_.size(); ++step) {
    const double depth = whole / step;
    if (depth >= settings.min && depth <= settings.max) millimetres_[step] = std::lround(1000.0 * depth);
  }
}

void DepthNoise::findLit(std::span<const float> inverseDepth) {
  std::copy(inverseDepth.begin(), inverseDepth.end(), lit_.begin());
  if (settings_.baseline <= 0.0) return;
  // The nearer a point is, the further left the projector sees it. Scanning from the right, a point is lit if the
  // projector sees it left of all previous points. A near surface ends half a pixel left of its last pixel's centre,
  // and what is hidden by less than a pixel of the sensor is measured.
  const float shift = camera_.focalX() * settings_.baseline;
  const float tolerance = scale_ - 0.5;
  const std::size_t width = camera_.width;
  for (std::size_t row = 0; row < lit_.size(); row += width) {
    float leftmost = 2 * camera_.width;
    for (std::size_t i = width; i-- > 0;) {
      const float inverse = inverseDepth[row + i];
      const float position = i - shift * inverse;
      if (position > leftmost + tolerance) lit_[row + i] = 0.0F;
      if (inverse > 0.0F) leftmost = std::min(leftmost, position);
    }
  }
}

void DepthNoise::loseEdges(std::span<const float> inverseDepth) {
  // Beside a near thing the matching window sees both surfaces; on its left the shadow is there anyway.
  const std::size_t width = camera_.width;
  for (std::size_t row = 0; row < lit_.size(); row += width) {
    int left = 0;  // pixels that are still to be lost
    float far = 0.0F;
    for (std::size_t i = row + 1; i < row + width; ++i, --left) {
      if (inverseDepth[i - 1] - inverseDepth[i] > kEdge) {
        left = edgeLossWidth_;
        far = inverseDepth[i - 1] - kEdge;
      }
      if (left > 0 && inverseDepth[i] < far) lit_[i] = 0.0F;
    }
  }
}

void DepthNoise::smear() {
  // A box twice along each axis, the second time shifted the other way: a triangle. Only what is measured counts.
  const std::size_t width = camera_.width;
  const std::size_t half = smearWidth_ / 2;
  const std::size_t rest = smearWidth_ - 1 - half;
  for (std::size_t i = 0; i < lit_.size(); ++i) weight_[i] = lit_[i] > 0.0F ? 1.0F : 0.0F;
  for (std::vector<float>* image : {&lit_, &weight_}) {
    sumAcross(*image, width, rest, half, smoothRow_);
    sumAcross(*image, width, half, rest, smoothRow_);
    sumDown(*image, width, rest, half, smoothRow_, sums_);
    sumDown(sums_, width, half, rest, smoothRow_, *image);
  }
  for (std::size_t i = 0; i < lit_.size(); ++i) lit_[i] = weight_[i] > 0.5F ? lit_[i] / weight_[i] : 0.0F;
}

void DepthNoise::findSurface(std::span<const float> inverseDepth) {
  // The slope of the surface follows from the gradient of inverse depth. Of the two differences to neighbours the
  // smaller one is used, so that an edge does not look like a slope.
  const std::size_t width = camera_.width;
  const float fx = camera_.focalX();
  const float fy = camera_.focalY();
  const float middleY = 0.5F * camera_.height - 0.5F;
  const float usual = deviateExceededBy(settings_.dropout);
  const float perGrazing = settings_.grazing ? 1.0F : 0.0F;
  const float axial = settings_.axial;
  const float scale = disparityOfInverse_;
  const float quantisation = settings_.steps > 0.0 ? 1.0F / 12.0F : 0.0F;
  const AxialNoise& noise = settings_.axialNoise;
  const float base = noise.base;
  const float quadratic = noise.quadratic;
  const float nearest = noise.nearest;
  const float angle = noise.angle;
  const float angleFar = noise.angleFar;
  for (int row = 0; row < camera_.height; ++row) {
    const std::size_t begin = row * width;
    const float* here = &inverseDepth[begin];
    // At the border only one neighbour exists: the other one is replaced by its mirror image.
    const float* above = row > 0 ? here - width : here + width;
    const float* below = row + 1 < camera_.height ? here + width : here - width;
    const float upwards = row > 0 ? 1.0F : -1.0F;
    const float downwards = row + 1 < camera_.height ? 1.0F : -1.0F;
    const float* rayX = rayX_.data();
    float* across = smoothRow_.data();
    for (std::size_t i = 1; i + 1 < width; ++i) {
      const float left = here[i] - here[i - 1];
      const float right = here[i + 1] - here[i];
      across[i] = std::abs(left) < std::abs(right) ? left : right;
    }
    across[0] = here[1] - here[0];
    across[width - 1] = here[width - 1] - here[width - 2];

    const float y = (middleY - row) / fy;
    float* spread = &spread_[begin];
    float* threshold = &threshold_[begin];
    for (std::size_t i = 0; i < width; ++i) {
      const float w = here[i];
      const float upper = upwards * (w - above[i]);
      const float lower = downwards * (below[i] - w);
      const float x = rayX[i];
      const float a = fx * across[i];
      const float b = -fy * (std::abs(upper) < std::abs(lower) ? upper : lower);
      const float c = w - a * x - b * y;
      const float normalSq = (a * a + b * b + c * c) * (x * x + y * y + 1.0F);
      const float cosine = w / std::sqrt(normalSq + 1e-20F);

      const float inverse = w > 0.01F ? w : 0.01F;
      const float distance = 1.0F / inverse;
      const float beyond = distance - nearest;
      const float fromGrazing = cosine * (1.0F + cosine * cosine * (1.0F / 6.0F));  // pi / 2 - theta, approximately
      const float rest = 1.5707963F - fromGrazing;
      const float theta = rest > 0.0F ? rest : 0.0F;
      const float ratio = theta / (fromGrazing > 0.05F ? fromGrazing : 0.05F);
      const float sigma = base + quadratic * beyond * beyond +
                          (angle + angleFar * distance * distance) * std::sqrt(inverse) * ratio * ratio;
      const float inSteps = axial * sigma * scale * inverse * inverse;
      const float variance = inSteps * inSteps - quantisation;
      spread[i] = std::sqrt(variance > 0.0F ? variance : 0.0F);

      // From the usual deviate down to one that nearly all deviates exceed.
      const float lost = perGrazing * (kGrazingCosine - cosine) / (kGrazingCosine - kLostCosine);
      const float seldom = 3.5F - 7.0F * lost;
      const float grazing = lost > 0.0F ? seldom : usual;
      threshold[i] = grazing < usual ? grazing : usual;
    }
  }
}

void DepthNoise::apply(std::span<const float> inverseDepth, std::uint64_t frame, std::span<std::uint16_t> depthMm) {
  LORICA_CHECK(inverseDepth.size() == lit_.size() && depthMm.size() == lit_.size(),
               "images must have the camera's size");
  findLit(inverseDepth);
  if (edgeLossWidth_ > 0) loseEdges(inverseDepth);
  if (smearWidth_ > 1) smear();
  const bool noisy = settings_.axial > 0.0;
  const bool losing = settings_.grazing || settings_.dropout > 0.0;
  if (noisy || losing) findSurface(inverseDepth);
  smooth_.draw(seedOf(settings_.seed, frame, 0));
  clumps_.draw(seedOf(settings_.seed, frame, 1));
  RandomNumbers jitter(seedOf(settings_.seed, frame, 2));
  RandomNumbers white(seedOf(settings_.seed, frame, 3));
  const float lateral = settings_.lateral * scale_;
  for (std::int8_t& offset : jitter_) {
    offset = std::lround(std::clamp(lateral * deviate(jitter.bits()), -100.0F, 100.0F));
  }
  const float lasting = std::sqrt(settings_.lasting);
  const float shared = std::sqrt(settings_.shared);
  const float own = std::sqrt(std::max(0.0, 1.0 - settings_.lasting - settings_.shared));
  const float min = settings_.min;
  const float max = settings_.max;
  const int width = camera_.width;
  const int height = camera_.height;
  const int jitterColumns = width / jitterCell_ + 1;
  std::size_t at = 0;
  for (int row = 0; row < height; ++row) {
    if (noisy && lasting > 0.0F) lasting_.readRow(row, lastingRow_);
    if (noisy && shared > 0.0F) smooth_.readRow(row, smoothRow_);
    if (losing) clumps_.readRow(row, clumpsRow_);
    const int jitterRow = row / jitterCell_ * jitterColumns;
    for (int column = 0; column < width; ++column, ++at) {
      const std::size_t cell = (jitterRow + column / jitterCell_) * 2;
      const int fromColumn = std::clamp(column + jitter_[cell], 0, width - 1);
      const int fromRow = std::clamp(row + jitter_[cell + 1], 0, height - 1);
      const std::size_t from = fromRow * width + fromColumn;
      const float inverse = lit_[from];
      depthMm[at] = 0;
      if (inverse <= 0.0F || (losing && clumpsRow_[column] > threshold_[from])) continue;
      float disparity = disparityOfInverse_ * inverse;
      if (noisy) {
        const float smooth = lasting * lastingRow_[column] + shared * smoothRow_[column];
        disparity += spread_[from] * (smooth + own * deviate(white.bits()));
      }
      if (disparity <= 0.0F) continue;
      if (!millimetres_.empty()) {
        const float upToHalf = disparity + 0.5F;  // truncation rounds this to nearest
        const std::size_t step = upToHalf;
        if (step < millimetres_.size()) depthMm[at] = millimetres_[step];
      } else {
        const float depth = disparityOfInverse_ / disparity;
        const float upToHalf = 1000.0F * depth + 0.5F;
        if (depth >= min && depth <= max) depthMm[at] = upToHalf;
      }
    }
  }
}

}  // namespace lorica
