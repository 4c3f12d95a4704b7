#include "capture/sensor/depth_lens.h"

#include "geometry/errors.h"
#include "geometry/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

namespace lorica {
namespace {

constexpr int kSmallestImage = 16, kLargestImage = 2048;  // pixels
constexpr double kNarrowest = 0.1, kWidest = 2.8;         // fields of view [rad], as the tracker takes them
constexpr double kWidestRay = 2.1445;                     // tan 65 degrees: further out a pinhole image only stretches
constexpr double kRayStep = 1.0 / 1024;                   // of rays, as a tangent
constexpr double kMorePixels = 1.25;                      // of the pinhole image than of the camera's
constexpr double kLargestDistortion = 1000.0;             // the rational model's reach 10 in practice
constexpr std::uint32_t kNone = 0xffffffff;

constexpr double kFromDegrees = std::numbers::pi / 180.0;

struct UsualRow {
  int width, height;
  double horizontalDegrees, verticalDegrees;
  std::string_view camera;
};
// Nominal fields of view in the makers' data sheets.
constexpr std::array kUsual = {
    UsualRow{640, 480, 58.12, 45.25, "Kinect v1, Xtion"},
    UsualRow{320, 240, 58.12, 45.25, "Kinect v1, Xtion"},
    UsualRow{512, 424, 70.6, 60.0, "Kinect v2"},
    UsualRow{640, 576, 75.0, 65.0, "Azure Kinect, Femto Bolt and Mega, narrow"},
    UsualRow{320, 288, 75.0, 65.0, "Azure Kinect, Femto Bolt and Mega, narrow, binned"},
    UsualRow{848, 480, 87.0, 58.0, "RealSense D400"},
    UsualRow{1280, 720, 87.0, 58.0, "RealSense D400"},
    UsualRow{480, 270, 87.0, 58.0, "RealSense D400"},
    UsualRow{1280, 800, 72.0, 50.0, "OAK-D"},
    UsualRow{640, 400, 72.0, 50.0, "OAK-D"},
    UsualRow{256, 192, 62.0, 48.5, "iPhone, iPad with LiDAR"},
    UsualRow{192, 256, 48.5, 62.0, "iPhone, iPad with LiDAR, upright"},
};

/// Of a ray's distance from the axis how far its point in the image is, without the tangential part.
double radial(const DepthLens& lens, double r) {
  const auto& [k1, k2, p1, p2, k3, k4, k5, k6] = lens.distortion;
  const double s = r * r;
  const double below = 1.0 + s * (k4 + s * (k5 + s * k6));
  return below > 0.0 ? r * (1.0 + s * (k1 + s * (k2 + s * k3))) / below : -1.0;
}

/// The rays up to which the lens maps further out to further out.
double lastRay(const DepthLens& lens) {
  double r = 0.0;
  for (double before = 0.0; r < kWidestRay; r += kRayStep) {
    const double next = radial(lens, r + kRayStep);
    if (!(next > before)) break;
    before = next;
  }
  return r;
}

/// The ray that is seen at a distance from the axis; none beyond `last`.
double rayOf(const DepthLens& lens, double distance, double last) {
  double from = 0.0, to = last;
  if (radial(lens, to) <= distance) return last;
  while (to - from > 1e-9) {
    const double middle = 0.5 * (from + to);
    (radial(lens, middle) < distance ? from : to) = middle;
  }
  return from;
}

Result<void> checkLens(const DepthLens& lens) {
  if (lens.width < kSmallestImage || lens.height < kSmallestImage || lens.width > kLargestImage ||
      lens.height > kLargestImage) {
    return badFormat("found depth images of {} x {}, expected {} to {} pixels a side", lens.width, lens.height,
                     kSmallestImage, kLargestImage);
  }
  const auto bad = [](double focal, int side) {
    const double fov = 2.0 * std::atan2(0.5 * side, focal);
    return !(focal > 0.0) || !(fov > kNarrowest && fov < kWidest);
  };
  if (bad(lens.focalX, lens.width) || bad(lens.focalY, lens.height)) {
    return badFormat(
        "found focal lengths of {:g} and {:g} pixels for images of {} x {}, expected fields of view of 6 to 160 "
        "degrees",
        lens.focalX, lens.focalY, lens.width, lens.height);
  }
  if (!(lens.centreX > 0.0 && lens.centreX < lens.width && lens.centreY > 0.0 && lens.centreY < lens.height)) {
    return badFormat("found the axis at pixel {:g}, {:g}, expected one of the image's {} x {}", lens.centreX,
                     lens.centreY, lens.width, lens.height);
  }
  for (const double k : lens.distortion) {
    if (!(std::abs(k) <= kLargestDistortion)) {
      return badFormat("found a distortion of {:g}, expected at most {:g}", k, kLargestDistortion);
    }
  }
  if (!(lens.metresPerUnit >= 1e-6 && lens.metresPerUnit <= 0.1)) {
    return badFormat("found a unit of {:g} m, expected 0.000001 to 0.1 m, such as 0.001", lens.metresPerUnit);
  }
  return {};
}

/// Numbers with a letter between them.
Result<std::vector<double>> numbersIn(std::string_view text, char between, std::string_view where) {
  std::vector<double> numbers;
  for (std::string_view rest = text;;) {
    const std::size_t end = std::min(rest.find(between), rest.size());
    double value = 0.0;
    const auto [stop, failed] = std::from_chars(rest.data(), rest.data() + end, value);
    if (failed != std::errc() || stop != rest.data() + end || !std::isfinite(value)) {
      return invalidArgument("{}: found '{}', expected a number", where, printable(rest.substr(0, end), 40));
    }
    numbers.push_back(value);
    if (end == rest.size()) return numbers;
    rest.remove_prefix(end + 1);
  }
}

}  // namespace

DepthLens DepthLens::pinhole(int width, int height, double horizontalFov, double verticalFov) {
  DepthLens lens;
  lens.width = width;
  lens.height = height;
  lens.focalX = 0.5 * width / std::tan(0.5 * horizontalFov);
  lens.focalY = 0.5 * height / std::tan(0.5 * verticalFov);
  lens.centreX = 0.5 * (width - 1);
  lens.centreY = 0.5 * (height - 1);
  return lens;
}

std::optional<UsualLens> usualLens(int width, int height) {
  for (const UsualRow& row : kUsual) {
    if (row.width != width || row.height != height) continue;
    return UsualLens{
        DepthLens::pinhole(width, height, kFromDegrees * row.horizontalDegrees, kFromDegrees * row.verticalDegrees),
        row.camera};
  }
  return std::nullopt;
}

Result<DepthLens> parseDepthLens(std::string_view text, int width, int height) {
  constexpr std::string_view kExample = "640x576,fov=75x65,unit=mm";
  struct Given {
    std::string_view key;
    std::vector<double> values;
  };
  std::vector<Given> given;
  double unit = 0.001;
  for (std::string_view rest = text; !rest.empty();) {
    const std::size_t end = std::min(rest.find(','), rest.size());
    const std::string_view word = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    const std::size_t equals = word.find('=');
    const std::string_view key = equals == std::string_view::npos ? "size" : word.substr(0, equals);
    std::string_view value = equals == std::string_view::npos ? word : word.substr(equals + 1);
    const bool pair = key == "size" || key == "fov", list = key == "d";
    if (!pair && !list && key != "fx" && key != "fy" && key != "cx" && key != "cy" && key != "unit") {
      return invalidArgument("found '{}', expected a camera such as {}", printable(word, 40), kExample);
    }
    const bool millimetres = key == "unit" && value.ends_with("mm");
    if (millimetres) value.remove_suffix(2);
    if (millimetres && value.empty()) value = "1";
    LORICA_TRY(std::vector<double> values, numbersIn(value, list ? '/' : 'x', word));
    if (list ? values.size() > 8 : values.size() != (pair ? 2U : 1U)) {
      return invalidArgument("found {} numbers in '{}', expected a camera such as {}", values.size(),
                             printable(word, 40), kExample);
    }
    if (key == "unit") unit = values[0] * (millimetres ? 0.001 : 1.0);
    given.push_back({key, std::move(values)});
  }
  const auto find = [&](std::string_view key) -> const std::vector<double>* {
    for (const Given& one : given) {
      if (one.key == key) return &one.values;
    }
    return nullptr;
  };
  if (const std::vector<double>* size = find("size")) {
    const bool sides = (*size)[0] >= kSmallestImage && (*size)[0] <= kLargestImage && (*size)[1] >= kSmallestImage &&
                       (*size)[1] <= kLargestImage;
    if (!sides || (width != 0 && ((*size)[0] != width || (*size)[1] != height))) {
      return invalidArgument("found images of {:g} x {:g}, expected {}", (*size)[0], (*size)[1],
                             width != 0 ? fmt::format("{} x {}", width, height) : "16 to 2048 pixels a side");
    }
    width = static_cast<int>((*size)[0]);
    height = static_cast<int>((*size)[1]);
  }
  if (width == 0) return invalidArgument("found no size, expected a camera such as {}", kExample);
  DepthLens lens;
  const std::vector<double>* fov = find("fov");
  const std::vector<double>*fx = find("fx"), *fy = find("fy");
  if (fov) {
    for (const double degrees : *fov) {
      if (degrees > 0.0 && degrees < 180.0) continue;  // a tangent would not know others
      return invalidArgument("found a field of view of {:g} degrees, expected 6 to 160", degrees);
    }
    lens = DepthLens::pinhole(width, height, kFromDegrees * (*fov)[0], kFromDegrees * (*fov)[1]);
  } else if (const std::optional<UsualLens> usual = usualLens(width, height)) {
    lens = usual->lens;
  } else if (fx || fy) {
    lens = DepthLens::pinhole(width, height, 1.0, 1.0);
  } else {
    return invalidArgument("found images of {} x {}, which no usual camera has, expected its field of view, fov=75x65",
                           width, height);
  }
  if (fx || fy) {
    lens.focalX = fx ? (*fx)[0] : (*fy)[0];
    lens.focalY = fy ? (*fy)[0] : (*fx)[0];
  }
  if (const auto* x = find("cx")) lens.centreX = (*x)[0];
  if (const auto* y = find("cy")) lens.centreY = (*y)[0];
  if (const auto* d = find("d")) std::copy(d->begin(), d->end(), lens.distortion.begin());
  lens.metresPerUnit = unit;
  LORICA_TRY_DO(checkLens(lens));
  return lens;
}

Result<DepthRectifier> DepthRectifier::create(const DepthLens& lens) {
  LORICA_TRY_DO(checkLens(lens));
  DepthRectifier made;
  made.lens_ = lens;
  const double axisX = lens.centreX + 0.5, axisY = lens.centreY + 0.5;  // from the image's upper left corner
  const bool straight = std::ranges::all_of(lens.distortion, [](double k) { return k == 0.0; });
  const bool centred = std::abs(axisX - 0.5 * lens.width) <= 0.5 && std::abs(axisY - 0.5 * lens.height) <= 0.5;
  DepthCamera& camera = made.camera_;
  if (straight && centred) {
    camera = {lens.width, lens.height, 2.0 * std::atan2(0.5 * lens.width, lens.focalX),
              2.0 * std::atan2(0.5 * lens.height, lens.focalY)};
    return made;
  }

  // The rays of the middle row's and column's ends tell how far the pinhole image reaches.
  const double last = straight ? kWidestRay : lastRay(lens);
  const double seen = radial(lens, last);
  if (seen * lens.focalX < 0.25 * lens.width || seen * lens.focalY < 0.25 * lens.height) {
    return badFormat(
        "found a distortion that folds the image back {:.0f} pixels from its axis, expected none within {} x {}",
        seen * lens.focalX, lens.width, lens.height);
  }
  const auto reach = [&](double axis, int side, double focal) {
    return rayOf(lens, std::max(axis, side - axis) / focal, last);
  };
  const double tanX = reach(axisX, lens.width, lens.focalX), tanY = reach(axisY, lens.height, lens.focalY);
  // Its pixels are as large as the camera's on the axis, unless that takes too many of them.
  const double wanted = 4.0 * tanX * lens.focalX * tanY * lens.focalY;
  const double most = kMorePixels * lens.width * lens.height;
  const double scale = std::min(1.0, std::sqrt(most / wanted));
  const auto sideOf = [&](double tangent, double focal) {
    return std::clamp(2 * static_cast<int>(std::lround(scale * tangent * focal)), kSmallestImage, kLargestImage);
  };
  camera = {sideOf(tanX, lens.focalX), sideOf(tanY, lens.focalY), 2.0 * std::atan(tanX), 2.0 * std::atan(tanY)};

  made.table_.reserve(static_cast<std::size_t>(camera.width) * camera.height);
  const auto& [k1, k2, p1, p2, k3, k4, k5, k6] = lens.distortion;
  for (int row = 0; row < camera.height; ++row) {
    const double y = (2.0 * (row + 0.5) / camera.height - 1.0) * tanY;
    for (int column = 0; column < camera.width; ++column) {
      const double x = (2.0 * (column + 0.5) / camera.width - 1.0) * tanX;
      const double s = x * x + y * y;
      std::uint32_t from = kNone;
      if (s < last * last) {
        const double bent = (1.0 + s * (k1 + s * (k2 + s * k3))) / (1.0 + s * (k4 + s * (k5 + s * k6)));
        const double u = lens.focalX * (x * bent + 2.0 * p1 * x * y + p2 * (s + 2.0 * x * x)) + axisX;
        const double v = lens.focalY * (y * bent + p1 * (s + 2.0 * y * y) + 2.0 * p2 * x * y) + axisY;
        if (u >= 0.0 && u < lens.width && v >= 0.0 && v < lens.height) {
          from = static_cast<std::uint32_t>(v) * lens.width + static_cast<std::uint32_t>(u);
        }
      }
      made.table_.push_back(from);
    }
  }
  return made;
}

void DepthRectifier::apply(std::span<const std::uint16_t> raw, std::vector<std::uint16_t>& depthMm) const {
  LORICA_CHECK(raw.size() == static_cast<std::size_t>(lens_.width) * lens_.height, "an image must fit the lens");
  const float scale = static_cast<float>(1000.0 * lens_.metresPerUnit);
  const bool millimetres = lens_.metresPerUnit == 0.001;
  const auto depthOf = [&](std::uint16_t value) -> std::uint16_t {
    if (millimetres) return value;
    const float depth = static_cast<float>(value) * scale + 0.5F;
    return depth < 65536.0F ? static_cast<std::uint16_t>(depth) : 0;
  };
  if (table_.empty()) {
    depthMm.resize(raw.size());
    std::ranges::transform(raw, depthMm.begin(), depthOf);
    return;
  }
  depthMm.resize(table_.size());
  for (std::size_t i = 0; i < table_.size(); ++i) {
    const std::uint32_t from = table_[i];
    depthMm[i] = from == kNone ? 0 : depthOf(raw[from]);
  }
}

Result<void> checkDepthUnit(const DepthLens& lens, std::span<const std::uint16_t> raw) {
  constexpr double kNearest = 0.05, kFarthest = 20.0;  // [m], generous: rooms have 0.3 to 10
  constexpr std::size_t kEnough = 64;                  // one pixel in so many
  std::size_t measured = 0, near = 0, far = 0;
  for (const std::uint16_t value : raw) {
    if (value == 0) continue;
    ++measured;
    near += value * lens.metresPerUnit < kNearest ? 1 : 0;
    far += value * lens.metresPerUnit > kFarthest ? 1 : 0;
  }
  if (measured == 0 || measured < raw.size() / kEnough || 10 * (near + far) < 9 * measured) return {};
  return badFormat(
      "found {} of the measured pixels {} than {} m with a unit of {:g} m, expected a person in a room: its unit is "
      "another",
      percent(static_cast<double>(near > far ? near : far) / static_cast<double>(measured)),
      near > far ? "nearer" : "farther", near > far ? kNearest : kFarthest, lens.metresPerUnit);
}

}  // namespace lorica
