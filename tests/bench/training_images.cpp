// Renders what the person network learns from: people in furnished rooms as depth cameras see them, with the truth.
// scripts/train-segmentation runs it; docs/TRACKING.md says what it is for.
//
//     training_images OUT COUNT SEED
//
// Each record: uint16 depth [mm] and uint8 truth (0 room, 1 person, 255 not measured), 160 x 120 each, then float: the
// floor's normal in the camera's frame, the camera's height [m], 1 if the floor is known, the focal length [pixels].
// All little-endian. The same seed gives the same images.

#include "capture/virtual_sensor/virtual_sensor.h"
#include "tests/bench/generators/other_cameras.h"
#include "tests/bench/random_people.h"
#include "tests/bench/virtual_furniture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <span>
#include <vector>

namespace lorica::bench {
namespace {

constexpr int kWidth = 320, kHeight = 240;
constexpr int kBodies = 24, kPoses = 1500;
constexpr int kSceneImages = 2000;       ///< images until bodies and poses are drawn anew
constexpr int kLeastPersonPixels = 120;  ///< of an image with people, at half resolution

/// Someone in the room.
struct Placed {
  RandomPeople::Person person;
  Vec3 at = Vec3::Zero();
  double yaw = 0.0;
};

class Scene {
 public:
  Scene(RandomPeople& people, RandomNumbers& random) : people_(people), random_(random) {
    cutOut_ = happens(0.12);
    const bool empty = !cutOut_ && happens(0.08);
    height_ = happens(0.7) ? between(0.8, 1.6) : between(0.4, 2.2);
    distance_ = happens(0.8) ? between(1.9, 3.6) : between(1.2, 4.8);
    const double tilt = std::atan2(height_ - between(0.7, 1.1), distance_) + around(0.07);
    worldFromCamera_ = worldFromCameraAt({0.0, height_, 0.0}, tilt);
    worldFromCamera_.rotate(Eigen::AngleAxisd(around(0.025), Vec3::UnitZ()));
    cameraFromWorld_ = worldFromCamera_.inverse();
    crowded_ = !cutOut_ && happens(0.25);
    const double more = crowded_ ? 0.85 : 0.25;
    int count = empty ? 0 : 1;
    if (!empty && !cutOut_) count += static_cast<int>(happens(more)) + static_cast<int>(happens(0.06));
    for (int i = 0; i < count; ++i) addPerson();
    camera_.width = kWidth;
    camera_.height = kHeight;
    focal_ = 285.63 * (happens(0.5) ? 1.0 : between(0.72, 1.3));
    camera_.horizontalFov = 2.0 * std::atan(0.5 * kWidth / focal_);
    camera_.verticalFov = 2.0 * std::atan(0.5 * kHeight / focal_);
  }

  [[nodiscard]] bool hasPeople() const { return !placed_.empty(); }

  void draw(DepthRenderer& renderer) {
    for (const Placed& one : placed_) {
      std::vector<Vec3> seen(one.person.positions.size());
      std::ranges::transform(one.person.positions, seen.begin(), [&](const Vec3& p) { return cameraFromWorld_ * p; });
      renderer.draw(seen, one.person.triangles, one.person.sides, 1);
    }
    if (cutOut_) return;
    floor_ = !happens(0.06);
    drawShell(renderer);
    for (const Placed& one : placed_) {
      if (!one.person.sits || happens(0.1)) continue;
      Furniture seat = makeSeat(one.person.hips - between(0.08, 0.13), random_);
      seat.place(one.at, one.yaw);
      seat.draw(cameraFromWorld_, renderer);
    }
    for (int pieces = 1 + below(9); pieces > 0; --pieces) {
      Furniture piece = makeFurniture(static_cast<FurnitureKind>(below(kFurnitureKindCount)), random_);
      if (standsFree(piece)) piece.draw(cameraFromWorld_, renderer);
    }
  }

  /// Depth with a random camera's errors. @param depthMm  of the renderer's size
  void measure(const DepthRenderer& renderer, std::span<std::uint16_t> depthMm) {
    constexpr std::array<std::string_view, 8> kCameras = {"kinect", "kinect",    "kinect", "kinect",
                                                          "mild",   "realsense", "tof",    "none"};
    DepthNoiseSettings noise = noiseNamed(kCameras[below(kCameras.size())]);
    noise.axial *= between(0.4, 1.3);
    noise.dropout *= between(0.0, 4.0);
    noise.edgeLoss *= happens(0.4) ? 0.0 : between(0.0, 1.4);
    if (happens(0.4)) noise.baseline = 0.0;  // no shadow: nothing missing around people
    noise.lateral *= between(0.5, 1.4);
    if (happens(0.3)) noise.grazing = false;
    noise.seed = random_.bits();
    noise.max = happens(0.5) ? 8.0 : between(4.0, 8.0);
    DepthNoise(camera_, noise).apply(renderer.inverseDepth(), 0, depthMm);
    if (cutOut_) {
      for (std::size_t i = 0; i < depthMm.size(); ++i) depthMm[i] = renderer.labels()[i] != 0 ? depthMm[i] : 0;
    }
  }

  /// See the top of the file; what is known of the floor is a little wrong.
  [[nodiscard]] std::array<float, 6> floorValues() {
    Vec3 up = cameraFromWorld_.linear() * Vec3::UnitY();
    up += Vec3{around(0.01), around(0.01), around(0.01)};
    up.normalize();
    return {static_cast<float>(up.x()),       static_cast<float>(up.y()),
            static_cast<float>(up.z()),       static_cast<float>(height_ + around(0.015)),
            floor_ && !cutOut_ ? 1.0F : 0.0F, static_cast<float>(0.5 * focal_)};
  }

  [[nodiscard]] const DepthCamera& camera() const { return camera_; }

 private:
  double between(double min, double max) { return random_.between(min, max); }
  double around(double spread) { return normal(random_, spread); }
  bool happens(double probability) { return random_.unit() < probability; }
  int below(int count) { return static_cast<int>(random_.unit() * count); }

  void addPerson() {
    Placed one{people_.draw(random_)};
    const bool first = placed_.empty();
    bool free = false;
    for (int attempt = 0; attempt < 20 && !free; ++attempt) {
      const double away = first ? distance_ : std::clamp(distance_ + around(0.6), 1.2, 4.8);
      one.at = Vec3(between(-0.42, 0.42) * away * (first ? 0.75 : 1.0), 0.0, -away);
      if (crowded_ && !first && happens(0.8)) {  // half behind the first one
        const Vec3 other = placed_.front().at;
        one.at = other * ((other.norm() + between(0.35, 1.4)) / other.norm()) + Vec3(around(0.3), 0.0, 0.0);
      }
      free = std::ranges::none_of(
          placed_, [&](const Placed& other) { return (other.at - one.at).norm() < (crowded_ ? 0.38 : 0.55); });
    }
    if (!free) return;
    const double way = random_.unit();
    one.yaw = way < 0.6    ? around(0.4)
              : way < 0.88 ? between(-kPi, kPi)
                           : (happens(0.5) ? 1 : -1) * (0.5 * kPi + around(0.2));
    if (happens(0.5)) one.yaw += std::atan2(-one.at.x(), -one.at.z());
    const Vec3 offset = one.at + Vec3(0.0, happens(0.05) ? between(0.0, 0.3) : 0.0, 0.0);
    const Quat turn(Eigen::AngleAxisd(one.yaw, Vec3::UnitY()));
    for (Vec3& position : one.person.positions) position = offset + turn * position;
    placed_.push_back(std::move(one));
  }

  /// Vertices of people within a box that stands on the floor, of every eleventh.
  [[nodiscard]] int peopleWithin(const Vec3& at, double yaw, const Vec3& half) const {
    const Quat turn(Eigen::AngleAxisd(-yaw, Vec3::UnitY()));
    int count = 0;
    for (const Placed& one : placed_) {
      for (std::size_t v = 0; v < one.person.positions.size(); v += 11) {
        const Vec3 p = turn * (one.person.positions[v] - at);
        count += std::abs(p.x()) < half.x() && std::abs(p.z()) < half.z() && p.y() < half.y();
      }
    }
    return count;
  }

  /// Floor, ceiling and walls.
  void drawShell(DepthRenderer& renderer) {
    const Vec3 up = cameraFromWorld_.linear() * Vec3::UnitY();
    if (floor_) {
      renderer.drawPlane(up, -height_, 0);
      const double ceiling = between(2.2, 3.2);
      if (happens(0.7) && ceiling > height_ + 0.2) renderer.drawPlane(up, ceiling - height_, 0);
    }
    const auto drawWall = [&](const Vec3& at, double yaw) {
      if (peopleWithin(at - Quat(Eigen::AngleAxisd(yaw, Vec3::UnitY())) * Vec3(0.0, 0.0, 2.0), yaw, {6.0, 4.0, 1.98}) >
          2)
        return;
      Furniture wall;
      wall.positions = {{-6.0, -0.1, 0.0}, {6.0, -0.1, 0.0}, {6.0, 3.2, 0.0}, {-6.0, 3.2, 0.0}};
      wall.triangles = {{0, 1, 2}, {0, 2, 3}};
      wall.place(at, yaw);
      wall.draw(cameraFromWorld_, renderer);
    };
    const double behind = happens(0.3) ? between(0.25, 0.7) : between(0.5, 3.5);
    if (happens(0.85)) drawWall({0.0, 0.0, -distance_ - behind}, around(0.15));
    for (const double side : {-1.0, 1.0}) {
      if (happens(0.35)) drawWall({side * between(0.9, 2.5), 0.0, -3.0}, -side * 0.5 * kPi + around(0.1));
    }
  }

  /// Finds a place for a piece, often close to somebody. @return whether there is one
  bool standsFree(Furniture& piece) {
    const bool near = !placed_.empty() && happens(0.65);
    const double yaw = happens(0.5) ? around(0.15) + 0.5 * kPi * below(4) : between(-kPi, kPi);
    const bool inFront = happens(0.3);
    for (int attempt = 0; attempt < 12; ++attempt) {
      Vec3 at;
      if (near) {
        const double way = happens(0.5) ? kPi + around(0.7) : between(-kPi, kPi);
        const double gap = happens(0.65) ? between(-0.05, 0.2) : between(0.2, 0.9);
        const double reach = 0.15 + gap + 0.5 * (piece.half.x() + piece.half.z());
        at = placed_[below(countOf(placed_))].at + reach * Vec3(std::sin(way), 0.0, std::cos(way));
      } else {
        const double away = between(1.0, 5.5);
        at = Vec3(between(-0.7, 0.7) * away, 0.0, -away);
      }
      if (at.z() > -0.9 || peopleWithin(at, yaw, 0.97 * piece.half) > 2) continue;
      // Tall things seldom hide people.
      const bool hides =
          piece.half.y() > 0.8 && std::ranges::any_of(placed_, [&](const Placed& one) {
            return at.z() > one.at.z() && std::abs(at.x() - one.at.x() * at.z() / one.at.z()) < piece.half.x() + 0.15;
          });
      if (hides && !inFront) continue;
      piece.place(at, yaw);
      return true;
    }
    return false;
  }

  static constexpr double kPi = std::numbers::pi;
  RandomPeople& people_;
  RandomNumbers& random_;
  DepthCamera camera_;
  Isometry3 worldFromCamera_ = Isometry3::Identity(), cameraFromWorld_ = Isometry3::Identity();
  double height_ = 1.0, distance_ = 3.0, focal_ = 285.63;
  bool cutOut_ = false, crowded_ = false, floor_ = false;
  std::vector<Placed> placed_;
};

/// What is seen at a pixel: the label of the surface nearby whose depth is the measured one.
std::uint8_t labelAt(const DepthRenderer& renderer, int column, int row, double depthMm) {
  double min = 1e9;
  std::uint8_t label = 0;
  for (int y = std::max(row - 2, 0); y <= std::min(row + 2, kHeight - 1); ++y) {
    for (int x = std::max(column - 2, 0); x <= std::min(column + 2, kWidth - 1); ++x) {
      const float inverse = renderer.inverseDepth()[y * kWidth + x];
      if (inverse <= 0.0F) continue;
      const int apart = (x - column) * (x - column) + (y - row) * (y - row);
      const double off = std::abs(1000.0 / inverse - depthMm) + 12.0 * apart;
      if (off >= min) continue;
      min = off;
      label = renderer.labels()[y * kWidth + x];
    }
  }
  return label;
}

/// @return whether enough of the people shows
bool halve(const DepthRenderer& renderer, std::span<const std::uint16_t> depthMm, std::span<std::uint16_t> halfMm,
           std::span<std::uint8_t> truth) {
  int shown = 0;
  for (int row = 0; row < kHeight / 2; ++row) {
    for (int column = 0; column < kWidth / 2; ++column) {
      const int i = row * (kWidth / 2) + column;
      halfMm[i] = 0;
      truth[i] = 255;
      for (int k = 0; k < 4 && halfMm[i] == 0; ++k) {
        const int x = 2 * column + k % 2, y = 2 * row + k / 2;
        halfMm[i] = depthMm[y * kWidth + x];
        if (halfMm[i] != 0) truth[i] = labelAt(renderer, x, y, halfMm[i]);
      }
      shown += truth[i] == 1;
    }
  }
  return shown >= kLeastPersonPixels;
}

int run(const char* file, int count, std::uint64_t seed) {
  std::FILE* out = std::fopen(file, "wb");
  if (out == nullptr) {
    fmt::print(stderr, "{}: cannot be written\n", file);
    return 1;
  }
  RandomNumbers random(seed);
  std::vector<std::uint16_t> depthMm(kWidth * kHeight), halfMm(kWidth * kHeight / 4);
  std::vector<std::uint8_t> truth(halfMm.size());
  for (int image = 0; image < count;) {
    RandomPeople people(kBodies, kPoses, random);
    for (int i = 0; i < kSceneImages && image < count;) {
      Scene scene(people, random);
      DepthRenderer renderer(scene.camera());
      renderer.clear();
      scene.draw(renderer);
      scene.measure(renderer, depthMm);
      const bool enough = halve(renderer, depthMm, halfMm, truth);
      const std::array<float, 6> floor = scene.floorValues();
      if (scene.hasPeople() && !enough) continue;
      std::fwrite(halfMm.data(), sizeof(std::uint16_t), halfMm.size(), out);
      std::fwrite(truth.data(), 1, truth.size(), out);
      std::fwrite(floor.data(), sizeof(float), floor.size(), out);
      ++i;
      ++image;
    }
  }
  const bool written = std::fclose(out) == 0;
  if (!written) fmt::print(stderr, "{}: could not be written completely\n", file);
  return written ? 0 : 1;
}

}  // namespace
}  // namespace lorica::bench

int main(int argc, char** argv) {
  if (argc != 4 || std::atoi(argv[2]) < 1) {
    fmt::print(stderr, "usage: training_images OUT COUNT SEED\n");
    return 2;
  }
  return lorica::bench::run(argv[1], std::atoi(argv[2]), std::strtoull(argv[3], nullptr, 10));
}
