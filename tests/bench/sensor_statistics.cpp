// Statistics of depth recordings beside those of the virtual sensor before similar scenes: rows on standard output.

#include "capture/files/joint_csv.h"
#include "capture/sensor/oni_file.h"
#include "capture/virtual_sensor/virtual_performer.h"
#include "capture/virtual_sensor/virtual_sensor.h"
#include "skinning/mannequin/mannequin.h"
#include "tests/bench/generators/other_cameras.h"
#include "tests/bench/measure.h"
#include "tests/bench/real_recordings.h"
#include "tests/support/chair.h"
#include "viewer/pictures/image_files.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace lorica::bench {
namespace {

namespace fs = std::filesystem;

constexpr int kStill = 10;  ///< frames over which pixels are compared

/// A recording, or what replaces it. Pixels that do not belong to the question are 0.
struct Images {
  int width = 0, height = 0;
  std::vector<std::vector<double>> depth;  ///< of each frame [m]

  /// Depth steps of a Kinect v1: eighths of a pixel of disparity. NaN if not measured.
  [[nodiscard]] double steps(std::size_t frame, int x, int y) const {
    const double z = at(frame, x, y);
    return z > 0.0 ? 8.0 * DepthCamera{}.focalX() * 0.075 / z : std::nan("");
  }
  [[nodiscard]] double at(std::size_t frame, int x, int y) const {
    return depth[frame][static_cast<std::size_t>(y * width + x)];
  }
};

using Sequences = std::vector<Images>;

/// Calls act(image, frame, x, y) for the pixels of every n-th frame that have so many others on each side.
template <typename Act>
void eachPixel(const Sequences& all, std::size_t every, int sideX, int sideY, const Act& act) {
  for (const Images& one : all) {
    for (std::size_t f = 0; f < one.depth.size(); f += every) {
      for (int y = sideY; y + sideY < one.height; ++y) {
        for (int x = sideX; x + sideX < one.width; ++x) act(one, f, x, y);
      }
    }
  }
}

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
}

/// Noise from second differences along a direction: what is smooth over twice the distance does not count [steps].
double neighbourNoise(const Sequences& all, int dx, int dy) {
  std::vector<double> values;
  eachPixel(all, 5, dx, dy, [&](const Images& one, std::size_t f, int x, int y) {
    const double second = one.steps(f, x - dx, y - dy) - 2.0 * one.steps(f, x, y) + one.steps(f, x + dx, y + dy);
    if (std::abs(second) < 12.0) values.push_back(second);
  });
  return rms(values) / std::sqrt(6.0);
}

/// Pixels that do not drift during kStill frames: share of those that do not change at all, or deviation of all
/// [steps].
double stillPixels(const Sequences& all, bool share) {
  int still = 0;
  std::vector<double> deviations;
  eachPixel(all, kStill, 0, 0, [&](const Images& one, std::size_t f, int x, int y) {
    if (f + kStill > one.depth.size()) return;
    std::array<double, kStill> s{};
    double mean = 0.0, slope = 0.0, square = 0.0;
    for (int t = 0; t < kStill; ++t) {
      s[static_cast<std::size_t>(t)] = one.steps(f + static_cast<std::size_t>(t), x, y);
      mean += s[static_cast<std::size_t>(t)] / kStill;
      slope += (t - 0.5 * (kStill - 1)) * s[static_cast<std::size_t>(t)];
    }
    constexpr double kSquares = kStill * (kStill * kStill - 1.0) / 12.0;
    if (!(std::abs(slope / kSquares) < 0.03)) return;
    for (const double value : s) square += (value - mean) * (value - mean);
    deviations.push_back(std::sqrt(square / (kStill - 1)));
    still += static_cast<int>(square < 0.02);
  });
  return share ? 100.0 * still / static_cast<double>(std::max<std::size_t>(deviations.size(), 1)) : rms(deviations);
}

/// Missing pixels with measured ones near on all four sides, in percent of the measured.
double enclosedHoles(const Sequences& all) {
  constexpr int kNear = 6;
  double holes = 0.0, measured = 0.0;
  eachPixel(all, 5, kNear, kNear, [&](const Images& one, std::size_t f, int x, int y) {
    if (one.at(f, x, y) > 0.0) {
      measured += 1.0;
      return;
    }
    std::array<bool, 4> sides{};
    for (int d = 1; d <= kNear; ++d) {
      sides[0] = sides[0] || one.at(f, x - d, y) > 0.0;
      sides[1] = sides[1] || one.at(f, x + d, y) > 0.0;
      sides[2] = sides[2] || one.at(f, x, y - d) > 0.0;
      sides[3] = sides[3] || one.at(f, x, y + d) > 0.0;
    }
    holes += sides[0] && sides[1] && sides[2] && sides[3] ? 1.0 : 0.0;
  });
  return 100.0 * holes / std::max(measured, 1.0);
}

/// How much the outline jumps from row to row, or in a row from frame to frame [pixels].
double outlineJitter(const Sequences& all, bool left, bool inTime) {
  std::vector<double> values;
  for (const Images& one : all) {
    const auto edge = [&](std::size_t f, int y) {
      for (int i = 1; i < one.width; ++i) {
        const int x = left ? i : one.width - 1 - i;
        if (one.at(f, x, y) > 0.0 && one.at(f, left ? x - 1 : x + 1, y) == 0.0) return static_cast<double>(x);
      }
      return std::nan("");
    };
    for (std::size_t f = 1; f + 1 < one.depth.size(); ++f) {
      for (int y = 1; y + 1 < one.height; ++y) {
        const double second = inTime ? edge(f - 1, y) - 2.0 * edge(f, y) + edge(f + 1, y)
                                     : edge(f, y - 1) - 2.0 * edge(f, y) + edge(f, y + 1);
        if (std::abs(second) < 6.0) values.push_back(second);
      }
    }
  }
  return rms(values) / std::sqrt(6.0);
}

/// Deviation of 1/z from a plane in windows on the flattest surfaces at a distance, and its correlation.
struct Flat {
  double residual = 0.0;                ///< first quartile of the windows [steps]
  std::array<double, 3> correlation{};  ///< at 1, 2 and 3 pixels, mean of both axes
};
Flat flatness(const Sequences& all, double from, double to) {
  constexpr int kHalf = 6, kSide = 2 * kHalf + 1;
  struct Window {
    double residual;
    std::array<double, 3> correlation;
  };
  std::vector<Window> windows;
  Eigen::Matrix<double, kSide * kSide, 3> columns;
  for (int i = 0; i < kSide * kSide; ++i) columns.row(i) << 1.0, i % kSide - kHalf, i / kSide - kHalf;
  const auto solve = (columns.transpose() * columns).inverse().eval();
  for (const Images& one : all) {
    for (int y = kHalf; y + kHalf < one.height; y += 5) {
      for (int x = kHalf; x + kHalf < one.width; x += 5) {
        Eigen::Matrix<double, kSide * kSide, 1> s;
        for (int i = 0; i < kSide * kSide; ++i) s[i] = one.steps(0, x - kHalf + i % kSide, y - kHalf + i / kSide);
        const double z = one.at(0, x, y);
        if (!s.allFinite() || z < from || z >= to) continue;
        const Eigen::Matrix<double, kSide * kSide, 1> rest = s - columns * (solve * (columns.transpose() * s));
        if (rest.cwiseAbs().maxCoeff() > 6.0) continue;
        Window window{std::sqrt(rest.squaredNorm() / rest.size()), {}};
        for (int lag = 1; lag <= 3; ++lag) {
          double sum = 0.0;
          int count = 0;
          for (int i = 0; i < kSide * kSide; ++i) {
            if (i % kSide + lag < kSide) sum += rest[i] * rest[i + lag], ++count;
            if (i / kSide + lag < kSide) sum += rest[i] * rest[i + lag * kSide], ++count;
          }
          window.correlation[static_cast<std::size_t>(lag - 1)] = sum / count / (window.residual * window.residual);
        }
        windows.push_back(window);
      }
    }
  }
  Flat flat;
  if (windows.empty()) return flat;
  std::ranges::sort(windows, {}, &Window::residual);
  flat.residual = windows[windows.size() / 4].residual;
  const std::size_t used = std::max<std::size_t>(windows.size() * 2 / 5, 1);
  for (std::size_t w = 0; w < used; ++w) {
    for (std::size_t k = 0; k < 3; ++k) flat.correlation[k] += windows[w].correlation[k] / static_cast<double>(used);
  }
  return flat;
}

/// Missing pixels between a near and a far surface of a row, whose parallax is 2 to 6 pixels: median, as a share of the
/// parallax on the projector's side, and in pixels on the other.
double edgeGap(const Sequences& all, bool shadow) {
  std::vector<double> gaps;
  for (const Images& one : all) {
    const double stepsPerPixel = 8.0 * 640.0 / one.width;
    for (int y = 0; y < one.height; ++y) {
      int before = -1;
      for (int x = 0; x < one.width; ++x) {
        if (one.at(0, x, y) == 0.0) continue;
        if (before >= 0 && x - before <= 17) {
          const double parallax = (one.steps(0, x, y) - one.steps(0, before, y)) / stepsPerPixel;
          const double gap = x - before - 1.0;
          if (shadow && parallax >= 2.0 && parallax < 6.0) gaps.push_back(gap / parallax);
          if (!shadow && parallax <= -2.0 && parallax > -6.0) gaps.push_back(gap);
        }
        before = x;
      }
    }
  }
  return gaps.empty() ? 0.0 : atRank(gaps, 0.5);
}

double missing(const Sequences& all) {
  double none = 0.0, count = 0.0;
  for (const Images& one : all) {
    for (const std::vector<double>& frame : one.depth) {
      none += static_cast<double>(std::ranges::count(frame, 0.0));
      count += static_cast<double>(frame.size());
    }
  }
  return 100.0 * none / count;
}

/// Change of 1/z of pixels from frame to frame, divided by the square root of two [1/m]. What moves is left out.
double change(const Images& one, std::size_t f, int x, int y) {
  const double a = one.at(f, x, y), b = f + 1 < one.depth.size() ? one.at(f + 1, x, y) : 0.0;
  const double value = a > 0.0 && b > 0.0 ? (1.0 / a - 1.0 / b) / std::numbers::sqrt2 : 1.0;
  return std::abs(value) < 0.015 ? value : std::nan("");
}

double changePerFrame(const Sequences& all, double from, double to) {
  std::vector<double> values;
  eachPixel(all, 3, 0, 0, [&](const Images& one, std::size_t f, int x, int y) {
    const double value = change(one, f, x, y), depth = one.at(f, x, y);
    if (!std::isnan(value) && depth >= from && depth < to) values.push_back(std::abs(value));
  });
  return values.empty() ? 0.0 : 1e3 * 1.4826 * atRank(values, 0.5);
}

double changeCorrelation(const Sequences& all, int lag) {
  double both = 0.0, squares = 0.0;
  eachPixel(all, 3, 0, 0, [&](const Images& one, std::size_t f, int x, int y) {
    if (x + lag >= one.width || y + lag >= one.height) return;
    for (const auto& [otherX, otherY] : {std::pair{x + lag, y}, std::pair{x, y + lag}}) {
      const double a = change(one, f, x, y), b = change(one, f, otherX, otherY);
      if (std::isnan(a) || std::isnan(b)) continue;
      both += a * b;
      squares += a * a;
    }
  });
  return squares > 0.0 ? both / squares : 0.0;
}

/// Width of the ramps between flat surfaces whose depths differ by more than a fifth, from 15 to 85 % [pixels].
double rampWidth(const Sequences& all) {
  constexpr int kSpan = 24;
  std::vector<double> widths;
  for (const Images& one : all) {
    for (std::size_t f = 0; f < one.depth.size(); f += 10) {
      for (int y = 0; y < one.height; y += 2) {
        for (int x = 3; x + kSpan + 3 < one.width; ++x) {
          const double a = one.at(f, x, y), b = one.at(f, x + kSpan, y);
          if (a == 0.0 || b == 0.0 || std::abs(a - b) < 0.2 * std::max(a, b)) continue;
          if (std::abs(a - one.at(f, x - 3, y)) > 0.01 * a || std::abs(b - one.at(f, x + kSpan + 3, y)) > 0.01 * b)
            continue;
          int first = 0, last = 0;
          while ((one.at(f, x + first, y) - a) / (b - a) <= 0.15) ++first;
          while ((one.at(f, x + last, y) - a) / (b - a) <= 0.85) ++last;
          widths.push_back(last - first);
        }
      }
    }
  }
  return widths.empty() ? 0.0 : atRank(widths, 0.5);
}

/// What a camera's real images and rendered ones are compared by.
struct Comparison {
  std::string camera;
  Sequences real, rendered;

  void print(const std::string& statistic, const std::function<double(const Sequences&)>& value) const {
    fmt::print("{},{},{:.3g},{:.3g}\n", csvField(camera), statistic, value(real), value(rendered));
    std::fflush(stdout);
  }
};

std::vector<double> metres(std::span<const std::uint16_t> depthMm) {
  std::vector<double> result;
  result.reserve(depthMm.size());
  for (const std::uint16_t mm : depthMm) result.push_back(0.001 * mm);
  return result;
}

Result<Images> readImages(const fs::path& file, std::size_t maxFrames) {
  Result<std::unique_ptr<OniFile>> source = openOni(file);
  if (!source) return source.error();
  Images images{(*source)->camera().width, (*source)->camera().height, {}};
  DepthFrame frame;
  while (images.depth.size() < maxFrames) {
    const Result<DepthRead> read = (*source)->next(frame);
    if (!read) return read.error();
    if (*read != DepthRead::kFrame) break;
    images.depth.push_back(metres(frame.depthMm));
  }
  return images;
}

Images renderImages(VirtualSensor& sensor, std::size_t frames) {
  Images images{sensor.camera().width, sensor.camera().height, {}};
  DepthFrame frame;
  for (std::size_t f = 0; f < frames; ++f) {
    sensor.render(f, frame);
    images.depth.push_back(metres(frame.depthMm));
  }
  return images;
}

/// Length of a leg and the trunk.
double sizeOf(const Joints& joints) {
  const auto at = [&](BodyJoint joint) { return joints[static_cast<std::size_t>(joint)]; };
  using J = BodyJoint;
  const double legs = (at(J::kLeftHip) - at(J::kLeftKnee)).norm() + (at(J::kLeftKnee) - at(J::kLeftFoot)).norm() +
                      (at(J::kRightHip) - at(J::kRightKnee)).norm() + (at(J::kRightKnee) - at(J::kRightFoot)).norm();
  return 0.5 * legs + (at(J::kNeck) - 0.5 * (at(J::kLeftHip) + at(J::kRightHip))).norm();
}

/// Bodies of the recorded people's sizes, 10 % wider than the tracker's model, repeat their joints at the same places
/// before the same camera, which was 1.1 m high and tilted by about 6 degrees. The people are cut out: behind them is
/// nothing.
Result<VirtualSensor> renderedCopy(const RealRecording& recording, const Joints& offsets, const DepthCamera& camera) {
  VirtualSensorSettings settings;
  settings.camera = camera;
  settings.framesPerSecond = 1.0 / recording.frameSeconds;
  settings.room.worldFromCamera = worldFromCameraAt({0.0, 1.1, 0.0}, 0.105);
  settings.room.floor = false;
  settings.room.wall.reset();
  const Character mannequin = makeMannequin();
  std::vector<VirtualPerson> people;
  for (const std::map<int, Joints>& person : recording.people) {
    std::vector<SkeletonFrame> motion;
    std::vector<double> sizes;
    motion.reserve(person.size());
    for (const auto& [number, joints] : person) {
      SkeletonFrame& frame = motion.emplace_back();
      frame.time = number * recording.frameSeconds;
      for (std::size_t j = 0; j < kBodyJointCount; ++j) {
        frame.joints[j].position = settings.room.worldFromCamera * joints[j] + offsets[j];
        frame.joints[j].confidence = 1.0;
      }
      sizes.push_back(sizeOf(positionsOf(frame)));
    }
    std::ranges::nth_element(sizes, sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2));
    const Result<VirtualPerformer> usual = VirtualPerformer::create(mannequin, motion);
    if (!usual) return usual.error();
    const double height = sizes[sizes.size() / 2] / sizeOf(positionsOf(usual->joints()));
    Result<VirtualPerformer> performer =
        VirtualPerformer::create(withProportions(mannequin, {.height = height, .girth = 1.1}), motion);
    if (!performer) return performer.error();
    people.push_back({std::move(*performer)});
    people.back().start = -motion.front().time;
    if (motion.front().time > 0.0) people.back().absent.push_back({0.0, motion.front().time - 0.01});
  }
  return VirtualSensor::create(std::move(people), settings);
}

/// A room with a chair and, if asked for, someone who waves.
Result<VirtualSensor> roomBefore(const DepthNoiseSettings& noise, bool person) {
  VirtualSensorSettings settings;
  settings.noise = noise;
  settings.camera = noise.sensor;
  settings.camera.width /= 2;
  settings.camera.height /= 2;
  settings.room.worldFromCamera = worldFromCameraAt({0.0, 1.2, 2.6}, 0.2);
  settings.room.wall = -1.2;
  settings.room.boxes = test::chairAt({0.8, 0.0, 0.3});
  settings.room.boxes.push_back({Vec3(-1.6, 0.0, -0.8), Vec3(-0.8, 1.6, -0.2)});
  settings.room.boxes.push_back({Vec3(0.4, 0.0, 0.9), Vec3(0.9, 0.5, 1.1)});
  std::vector<VirtualPerson> people;
  if (person) {
    Result<VirtualPerformer> performer = VirtualPerformer::create(makeMannequin(), shippedFrames("wave"));
    if (!performer) return performer.error();
    people.push_back({std::move(*performer)});
  }
  return VirtualSensor::create(std::move(people), settings);
}

Result<void> measureKinect(const fs::path& folder) {
  const Result<std::vector<RealRecording>> recordings = readRealRecordings(folder, {"cut_"});
  if (!recordings) return recordings.error();
  const Result<Joints> offsets = readOffsets(folder / "offsets.json");
  if (!offsets) return offsets.error();
  Comparison both{"Kinect v1, people", {}, {}};
  for (const RealRecording& recording : *recordings) {
    Result<Images> images = readImages(recording.file, 150);
    if (!images) return images.error();
    const DepthCamera camera = (*openOni(recording.file))->camera();
    Result<VirtualSensor> copy = renderedCopy(recording, *offsets, camera);
    if (!copy) return copy.error();
    both.rendered.push_back(renderImages(*copy, images->depth.size()));
    both.real.push_back(std::move(*images));
  }
  for (const int lag : {1, 2, 4}) {
    both.print(fmt::format("noise against neighbours {} px beside [steps]", lag),
               [&](const Sequences& all) { return neighbourNoise(all, lag, 0); });
    both.print(fmt::format("noise against neighbours {} px above [steps]", lag),
               [&](const Sequences& all) { return neighbourNoise(all, 0, lag); });
  }
  both.print("pixels that do not change in 10 frames [%]", [](const Sequences& all) { return stillPixels(all, true); });
  both.print("deviation in 10 frames [steps]", [](const Sequences& all) { return stillPixels(all, false); });
  both.print("enclosed missing pixels [%]", enclosedHoles);
  for (const bool left : {true, false}) {
    for (const bool inTime : {false, true}) {
      both.print(
          fmt::format("{} outline from {} [px]", left ? "left" : "right", inTime ? "frame to frame" : "row to row"),
          [&](const Sequences& all) { return outlineJitter(all, left, inTime); });
    }
  }
  return {};
}

Result<void> measureRooms(const fs::path& folder) {
  Comparison both{"Kinect v1, rooms", {}, {}};
  for (const char* name : {"A_armchair3_a9s1", "A_armchair5_a19s5", "B_armchair2_a26s7", "C_armchair4_a22s3_a9s5"}) {
    Result<Images> images = readImages(folder / fmt::format("{}.oni", name), 1);
    if (!images) return images.error();
    // People and a wide margin around them are not part of the room.
    const Result<Image> mask = readPng(folder / "masks" / fmt::format("{}_0000.png", name));
    if (!mask) return mask.error();
    constexpr int kMargin = 12;
    std::vector<double>& depth = images->depth.front();
    for (int y = 0; y < images->height; ++y) {
      for (int x = 0; x < images->width; ++x) {
        if (mask->rgba[4 * static_cast<std::size_t>(y * images->width + x)] == 0) continue;
        for (int v = std::max(0, y - kMargin); v <= std::min(images->height - 1, y + kMargin); ++v) {
          const auto row = depth.begin() + static_cast<std::ptrdiff_t>(v) * images->width;
          std::fill(row + std::max(0, x - kMargin), row + std::min(images->width, x + kMargin + 1), 0.0);
        }
      }
    }
    both.real.push_back(std::move(*images));
  }
  Result<VirtualSensor> sensor = roomBefore({}, false);
  if (!sensor) return sensor.error();
  both.rendered.push_back(renderImages(*sensor, 1));
  for (const auto& [from, to] : {std::pair{1.5, 2.5}, std::pair{2.5, 3.5}, std::pair{3.5, 5.0}}) {
    both.print(fmt::format("deviation from planes {} to {} m away [steps]", from, to),
               [from = from, to = to](const Sequences& all) { return flatness(all, from, to).residual; });
  }
  for (std::size_t lag = 1; lag <= 3; ++lag) {
    both.print(fmt::format("its correlation at {} px", lag),
               [&](const Sequences& all) { return flatness(all, 1.5, 5.0).correlation[lag - 1]; });
  }
  both.print("missing left of near things [parallax]", [](const Sequences& all) { return edgeGap(all, true); });
  both.print("missing right of near things [px]", [](const Sequences& all) { return edgeGap(all, false); });
  return {};
}

Result<void> measureRealSense(const fs::path& folder) {
  Result<Images> images = readImages(folder / "realsense_point.oni", 80);
  if (!images) return images.error();
  Result<VirtualSensor> sensor = roomBefore(realSenseNoise(), true);
  if (!sensor) return sensor.error();
  const Sequences rendered = {renderImages(*sensor, images->depth.size())};
  const Comparison both{"RealSense", {std::move(*images)}, rendered};
  both.print("missing pixels [%]", missing);
  for (const auto& [from, to] : {std::pair{1.4, 2.0}, std::pair{2.0, 2.6}, std::pair{2.6, 4.0}}) {
    both.print(fmt::format("change of 1/z per frame {} to {} m away [0.001/m]", from, to),
               [from = from, to = to](const Sequences& all) { return changePerFrame(all, from, to); });
  }
  for (const int lag : {1, 2, 4, 8, 12, 16}) {
    both.print(fmt::format("its correlation at {} px", lag),
               [&](const Sequences& all) { return changeCorrelation(all, lag); });
  }
  both.print("width of edges from 15 to 85 % [px]", rampWidth);
  return {};
}

}  // namespace
}  // namespace lorica::bench

int main(int argc, char** argv) {
  using namespace lorica::bench;
  std::string folder;
  CLI::App app{"Compares depth recordings with the virtual sensor."};
  app.add_option("folder", folder, "depth recordings of real people, see tracking --real")->required();
  CLI11_PARSE(app, argc, argv);
  fmt::print("camera,statistic,real,rendered\n");
  for (const auto& measure : {measureKinect, measureRooms, measureRealSense}) {
    if (lorica::Result<void> done = measure(folder); !done) return fail(done.error());
  }
  return 0;
}
