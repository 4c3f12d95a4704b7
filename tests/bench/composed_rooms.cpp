#include "tests/bench/composed_rooms.h"

#include "capture/sensor/oni_file.h"
#include "capture/virtual_sensor/depth_noise.h"
#include "capture/virtual_sensor/virtual_sensor.h"
#include "geometry/counts.h"
#include "tests/bench/random_people.h"
#include "tests/bench/virtual_furniture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace lorica::bench {
namespace {

constexpr int kFrames = 110;
constexpr int kEmptyFrames = 30;       ///< of a scene in which the person comes later
constexpr double kCutOutTilt = 0.096;  ///< of the camera that saw the people who are cut out [rad]
constexpr int kFiner = 3;              ///< points along a pixel's side
constexpr double kShown = 0.4;         ///< least share of each person's pixels that nothing hides
constexpr std::uint64_t kAttempts = 50;
constexpr double kThick = 0.15;       ///< of a body behind what the camera sees of it [m]
constexpr double kInside = 0.08;      ///< of a surface of the room, where a body would be within it [m]
constexpr double kMostInside = 0.03;  ///< share of a body's pixels
constexpr double kAboveFloor = 0.3;   ///< what is lower may be as near to the room's floor [m]
constexpr double kSeated = 0.35;      ///< how much lower than standing hips are on a seat [m]

/// Depth images of a recording, at most kFrames.
Result<std::vector<std::vector<std::uint16_t>>> readFrames(const RealRecording& recording, DepthCamera& camera) {
  Result<std::unique_ptr<OniFile>> source = openOni(recording.file);
  if (!source) return source.error();
  camera = (*source)->camera();
  std::vector<std::vector<std::uint16_t>> frames;
  DepthFrame depth;
  while (countOf(frames) < 150) {
    const Result<DepthRead> read = (*source)->next(depth);
    if (!read) return read.error();
    if (*read != DepthRead::kFrame) break;
    frames.emplace_back(depth.depthMm.begin(), depth.depthMm.end());
  }
  return frames;
}

/// Someone who was cut out, and where they are in the room.
struct Actor {
  const RealRecording* recording = nullptr;
  DepthCamera camera;
  std::vector<std::vector<std::uint16_t>> depthMm;
  std::vector<int> frames;                            ///< of the recording, in the order in which they are shown
  Isometry3 floorFromCamera = Isometry3::Identity();  ///< of the recording's camera, in the room
  double seat = 0.0;                                  ///< height of the hips if the person sits [m]

  [[nodiscard]] int frameAt(int shown) const { return frames[shown % countOf(frames)]; }

  template <typename Act>
  void eachPoint(int frame, const Act& act) const {
    const std::vector<std::uint16_t>& image = depthMm[frame];
    for (int row = 0; row + 1 < camera.height; ++row) {
      for (int column = 0; column + 1 < camera.width; ++column) {
        const std::size_t i = static_cast<std::size_t>(row) * camera.width + column;
        const double depth = image[i], right = image[i + 1], below = image[i + camera.width];
        if (depth == 0.0) continue;
        const double alongRow = right > 0.0 && std::abs(right - depth) < 60.0 ? right - depth : 0.0;
        const double alongColumn = below > 0.0 && std::abs(below - depth) < 60.0 ? below - depth : 0.0;
        for (int k = 0; k < kFiner * kFiner; ++k) {
          const double x = static_cast<double>(k % kFiner) / kFiner, y = static_cast<double>(k / kFiner) / kFiner;
          const double here = 0.001 * (depth + alongRow * x + alongColumn * y);
          act(floorFromCamera * camera.positionOf(column + 0.5 + x, row + 0.5 + y, here));
        }
      }
    }
  }
};

/// Frames forth and back.
std::vector<int> loopOf(const std::vector<int>& frames) {
  std::vector<int> loop = frames;
  loop.insert(loop.end(), frames.rbegin(), frames.rend());
  return loop;
}

Result<Actor> readActor(const RealRecording& recording, bool sits, int start) {
  Actor actor;
  actor.recording = &recording;
  auto frames = readFrames(recording, actor.camera);
  if (!frames) return frames.error();
  actor.depthMm = std::move(*frames);
  actor.floorFromCamera = worldFromCameraAt(Vec3::Zero(), kCutOutTilt);
  const std::map<int, Joints>& truth = recording.people.front();
  const auto hips = [&](const Joints& joints) {
    return (actor.floorFromCamera * joints[static_cast<std::size_t>(BodyJoint::kTorso)]).y();
  };
  double top = -1e9;
  for (const auto& [frame, joints] : truth) top = std::max(top, hips(joints));
  std::vector<int> shown;
  for (const auto& [frame, joints] : truth) {
    if (frame >= countOf(actor.depthMm) || (sits ? hips(joints) > top - kSeated : frame < start)) continue;
    shown.push_back(frame);
  }
  if (shown.empty()) return Error{ErrorCode::kInvalidArgument, fmt::format("{}: nobody sits", recording.name)};
  actor.frames = loopOf(shown);
  if (sits) {
    const Joints& joints = truth.at(shown[shown.size() / 2]);
    actor.seat = 0.5 * (actor.floorFromCamera * (joints[static_cast<std::size_t>(BodyJoint::kLeftHip)] +
                                                 joints[static_cast<std::size_t>(BodyJoint::kRightHip)]))
                           .y();
  }
  return actor;
}

/// Puts the lowest points on the floor and the middle of the first frame at a place. @param at  floor frame [m]
void place(Actor& actor, const Vec3& at) {
  std::vector<double> heights;
  Vec3 sum = Vec3::Zero();
  actor.eachPoint(actor.frameAt(0), [&](const Vec3& point) {
    heights.push_back(point.y());
    sum += point;
  });
  std::ranges::sort(heights);
  const Vec3 middle = sum / static_cast<double>(heights.size());
  const double low = heights[heights.size() / 200];
  actor.floorFromCamera.pretranslate(Vec3(at.x() - middle.x(), -low, at.z() - middle.z()));
  actor.seat -= actor.seat == 0.0 ? 0.0 : low;
}

/// Points of people within a box on the floor, in every eighth frame.
int pointsWithin(std::span<const std::vector<Vec3>> points, const Vec3& at, double yaw, const Vec3& half) {
  const Quat turn(Eigen::AngleAxisd(-yaw, Vec3::UnitY()));
  int count = 0;
  for (const std::vector<Vec3>& some : points) {
    for (const Vec3& point : some) {
      const Vec3 p = turn * (point - at);
      count += std::abs(p.x()) < half.x() && std::abs(p.z()) < half.z() && p.y() < half.y();
    }
  }
  return count;
}

class ComposedSource : public DepthSource {
 public:
  explicit ComposedSource(const ComposedRoom& room) : room_(room) {}
  [[nodiscard]] const DepthCamera& camera() const override { return room_.camera; }
  [[nodiscard]] std::string name() const override { return room_.truth.name; }
  [[nodiscard]] Result<DepthRead> next(DepthFrame& frame) override {
    if (next_ == room_.depthMm.size()) return DepthRead::kEnd;
    frame.depthMm.assign(room_.depthMm[next_].begin(), room_.depthMm[next_].end());
    frame.time = static_cast<double>(next_++) * room_.truth.frameSeconds;
    return DepthRead::kFrame;
  }

 private:
  const ComposedRoom& room_;
  std::size_t next_ = 0;
};

/// @return nothing if furniture or the room hides more of somebody than kShown leaves, or somebody is within a wall
Result<std::optional<ComposedRoom>> composeOnce(std::span<const RealRecording> recordings, std::uint64_t seed,
                                                RandomNumbers random) {
  const auto below = [&](int count) { return static_cast<int>(random.unit() * count); };
  std::vector<const RealRecording*> rooms, standing, sitting;
  for (const RealRecording& recording : recordings) {
    if (recording.kind == "B") rooms.push_back(&recording);
    if (recording.kind != "cutout") continue;
    // UTD-MHAD's actions 24 and 25 are standing up and sitting down.
    const bool sits = recording.name.starts_with("cut_a24") || recording.name.starts_with("cut_a25");
    (sits ? sitting : standing).push_back(&recording);
  }
  if (rooms.empty() || standing.empty() || sitting.empty()) {
    return Error{ErrorCode::kInvalidArgument, "composing needs recordings of kind B and cut out, some of a24 or a25"};
  }
  ComposedRoom result;
  const RealRecording& room = *rooms[below(countOf(rooms))];
  const auto emptyRoom = readFrames(room, result.camera);
  if (!emptyRoom) return emptyRoom.error();
  const bool seated = seed % 3 == 2, late = !seated && seed % 5 >= 3;
  const int first = late ? kEmptyFrames : 0;

  std::vector<Actor> actors;
  for (int p = 0; p < (seated ? 2 : 1); ++p) {
    const std::vector<const RealRecording*>& from = p == 0 ? standing : sitting;
    const RealRecording& recording = *from[below(countOf(from))];
    Result<Actor> actor = readActor(recording, p == 1, below(40));
    if (!actor) return actor.error();
    actors.push_back(std::move(*actor));
  }
  const double away = random.between(2.5, 3.1), aside = seated ? random.between(0.35, 0.6) : random.between(-0.5, 0.5);
  place(actors[0], {seated ? -aside : aside, 0.0, -away});
  if (seated) place(actors[1], {aside, 0.0, -away - random.between(-0.2, 0.2)});

  // Furniture comes from outside until it touches somebody.
  const Isometry3 cameraFromFloor = room.floorFromCamera.inverse();
  const Vec3 camera = room.floorFromCamera.translation();
  std::vector<std::vector<Vec3>> points;
  for (const Actor& actor : actors) {
    for (int frame = 0; frame < kFrames; frame += 8) {
      std::vector<Vec3>& some = points.emplace_back();
      int skip = 0;
      actor.eachPoint(actor.frameAt(frame), [&](const Vec3& point) {
        if (skip++ % 97 != 0) return;
        some.push_back(point);
        some.push_back(point + kThick * (point - camera).normalized());
      });
    }
  }
  DepthRenderer renderer(result.camera);
  renderer.clear();
  std::string furniture;
  for (const Actor& actor : actors) {
    const Vec3 hips = actor.floorFromCamera *
                      actor.recording->people.front().at(actor.frameAt(0))[static_cast<std::size_t>(BodyJoint::kTorso)];
    if (actor.seat > 0.0) {
      Furniture seat = makeSeat(actor.seat - 0.09, random);
      seat.place({hips.x(), 0.0, hips.z()}, normal(random, 0.1));
      seat.draw(cameraFromFloor, renderer);
    }
    for (int pieces = 2 + below(2); pieces > 0; --pieces) {
      constexpr std::array<FurnitureKind, 9> kKinds = {
          FurnitureKind::kTable, FurnitureKind::kChair,   FurnitureKind::kArmchair,
          FurnitureKind::kSofa,  FurnitureKind::kShelf,   FurnitureKind::kCupboard,
          FurnitureKind::kBed,   FurnitureKind::kCurtain, FurnitureKind::kDesk};
      Furniture piece = makeFurniture(kKinds[below(kKinds.size())], random);
      const double way = std::numbers::pi + random.between(-1.6, 1.6), yaw = normal(random, 0.15);
      const Vec3 out(std::sin(way), 0.0, std::cos(way));
      for (double reach = 0.1; reach < 2.5; reach += 0.02) {
        const Vec3 at = Vec3(hips.x(), 0.0, hips.z()) + reach * out;
        if (pointsWithin(points, at, yaw, piece.half) > 3) continue;
        piece.place(at, yaw);
        piece.draw(cameraFromFloor, renderer);
        break;
      }
    }
  }
  DepthNoiseSettings noise = DepthNoiseSettings::of(DepthNoiseKind::kKinect);
  noise.seed = seed;
  noise.baseline = noise.edgeLoss = 0.0;
  DepthNoise errors(result.camera, noise);

  result.truth.name = fmt::format("composed_{:02}_{}", seed, room.name);
  for (const Actor& actor : actors) result.truth.name += "_" + actor.recording->name.substr(4);
  result.truth.kind = "composed";
  result.truth.firstFrame = first;
  result.truth.peopleVisible = countOf(actors);
  result.truth.floorFromCamera = room.floorFromCamera;
  result.truth.people.resize(actors.size());
  const int width = result.camera.width, height = result.camera.height;
  std::vector<std::uint16_t> things(static_cast<std::size_t>(width) * height);
  // Pixels that show each, that would, and those of the latter where the body is within the room's surfaces.
  std::vector<std::size_t> visible(actors.size()), covered(actors.size()), inside(actors.size());
  std::vector<std::uint8_t> drawn(things.size());  // whether somebody was drawn there
  for (int frame = 0; frame < kFrames; ++frame) {
    std::vector<std::uint16_t>& image = result.depthMm.emplace_back((*emptyRoom)[frame % kEmptyFrames]);
    std::vector<std::uint8_t>& mask = result.masks.emplace_back(image.size());
    errors.apply(renderer.inverseDepth(), static_cast<std::uint64_t>(frame), things);
    for (std::size_t i = 0; i < image.size(); ++i) {
      if (things[i] != 0 && (image[i] == 0 || things[i] < image[i])) image[i] = things[i];
    }
    if (frame < first) continue;
    for (std::size_t p = 0; p < actors.size(); ++p) {
      const Actor& actor = actors[p];
      std::ranges::fill(drawn, 0);
      const int shown = actor.frameAt(frame - first);
      const Isometry3 roomFromCutOut = cameraFromFloor * actor.floorFromCamera;
      actor.eachPoint(shown, [&](const Vec3& point) {
        const Vec3 seen = cameraFromFloor * point;
        const Eigen::Vector2d at = result.camera.imagePointOf(seen);
        const int column = static_cast<int>(std::floor(at.x())), row = static_cast<int>(std::floor(at.y()));
        if (column < 0 || row < 0 || column >= width || row >= height) return;
        // A Kinect's steps of an eighth of a pixel of disparity.
        const double steps = 1.0 / (2.9e-3 * -seen.z());
        const auto depth = static_cast<std::uint16_t>(std::lround(1000.0 / (std::round(steps) * 2.9e-3)));
        const std::size_t i = static_cast<std::size_t>(row) * width + column;
        if (std::exchange(drawn[i], 1) == 0) {
          const double gap = 0.001 * std::abs(int((*emptyRoom)[frame % kEmptyFrames][i]) - int(depth));
          ++covered[p];
          inside[p] += static_cast<std::size_t>(point.y() > kAboveFloor && gap < kInside);
        }
        if (image[i] != 0 && image[i] <= depth) return;
        image[i] = depth;
        mask[i] = static_cast<std::uint8_t>(p + 1);
      });
      Joints& joints = result.truth.people[p][frame];
      joints = actor.recording->people.front().at(shown);
      for (Vec3& joint : joints) joint = roomFromCutOut * joint;
      visible[p] += std::ranges::count(mask, p + 1);
    }
  }
  for (std::size_t p = 0; p < actors.size(); ++p) {
    const auto share = [&](std::size_t count) { return static_cast<double>(count) / static_cast<double>(covered[p]); };
    if (share(visible[p]) < kShown || share(inside[p]) > kMostInside) return std::optional<ComposedRoom>();
  }
  return std::optional(std::move(result));
}

}  // namespace

Result<ComposedRoom> composeRoom(std::span<const RealRecording> recordings, std::uint64_t seed) {
  for (std::uint64_t attempt = 0; attempt < kAttempts; ++attempt) {
    auto room = composeOnce(recordings, seed, RandomNumbers(seed * 7919 + 17 + 1'000'003 * attempt));
    if (!room) return room.error();
    if (*room) return std::move(**room);
  }
  return Error{ErrorCode::kInvalidArgument,
               fmt::format("composed room {}: people are hidden or within walls in every attempt", seed)};
}

std::unique_ptr<DepthSource> sourceOf(const ComposedRoom& room) {
  return std::make_unique<ComposedSource>(room);
}

}  // namespace lorica::bench
