#include "capture/virtual_sensor/virtual_room.h"

#include <array>

namespace lorica {
namespace {

/// Corner i of a box: bit 0 is x, bit 1 y, bit 2 z. Counter-clockwise from outside.
constexpr std::array<Triangle, 12> kBoxTriangles = {{{0, 4, 6},
                                                     {0, 6, 2},
                                                     {1, 3, 7},
                                                     {1, 7, 5},
                                                     {0, 1, 5},
                                                     {0, 5, 4},
                                                     {2, 6, 7},
                                                     {2, 7, 3},
                                                     {0, 2, 3},
                                                     {0, 3, 1},
                                                     {4, 5, 7},
                                                     {4, 7, 6}}};

}  // namespace

Isometry3 worldFromCameraAt(const Vec3& position, double tiltDown, double heading) {
  Isometry3 worldFromCamera = Isometry3::Identity();
  worldFromCamera.translate(position);
  worldFromCamera.rotate(Eigen::AngleAxisd(heading, Vec3::UnitY()));
  worldFromCamera.rotate(Eigen::AngleAxisd(-tiltDown, Vec3::UnitX()));
  return worldFromCamera;
}

std::vector<Aabb> chairAt(const Vec3& middle) {
  constexpr double kHalf = 0.22;       // of the seat
  constexpr double kThickness = 0.04;  // of all parts
  constexpr double kSeat = 0.45;
  constexpr double kBack = 0.90;
  std::vector<Aabb> boxes;
  boxes.reserve(6);
  const auto add = [&](const Vec3& min, const Vec3& max) { boxes.push_back({middle + min, middle + max}); };
  add({-kHalf, kSeat - kThickness, -kHalf}, {kHalf, kSeat, kHalf});
  add({-kHalf, kSeat, -kHalf - kThickness}, {kHalf, kBack, -kHalf});
  for (const double x : {-kHalf, kHalf - kThickness}) {
    for (const double z : {-kHalf, kHalf - kThickness}) {
      add({x, 0.0, z}, {x + kThickness, kSeat - kThickness, z + kThickness});
    }
  }
  return boxes;
}

void drawRoom(const VirtualRoom& room, DepthRenderer& renderer) {
  const Isometry3 cameraFromWorld = room.worldFromCamera.inverse();
  const Vec3 position = room.worldFromCamera.translation();
  if (room.floor && position.y() != 0.0) {
    renderer.drawPlane(cameraFromWorld.linear() * Vec3::UnitY(), -position.y(), 0);
  }
  if (room.wall && position.z() != *room.wall) {
    renderer.drawPlane(cameraFromWorld.linear() * Vec3::UnitZ(), *room.wall - position.z(), 0);
  }
  for (const Aabb& box : room.boxes) {
    std::array<Vec3, 8> corners;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vec3 corner((i & 1) != 0 ? box.max.x() : box.min.x(), (i & 2) != 0 ? box.max.y() : box.min.y(),
                        (i & 4) != 0 ? box.max.z() : box.min.z());
      corners[i] = cameraFromWorld * corner;
    }
    renderer.draw(corners, kBoxTriangles, SurfaceSides::kOuter, 0);
  }
}

}  // namespace lorica
