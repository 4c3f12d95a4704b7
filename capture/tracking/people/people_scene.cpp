#include "capture/tracking/people/people_scene.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace lorica {
namespace {

constexpr float kHeadDepth = 0.1F;  // from the face to the axis of the head [m]

constexpr float kNeighbour = 0.4F;   // a head this near to a person's middle is that person's [m]
constexpr float kGrown = 0.42F;      // how far aside a person found at a head reaches from the head's axis at first [m]
constexpr float kGrownBack = 0.4F;   // and how far behind the face [m]
constexpr float kGrownFront = 0.7F;  // and in front of it [m]
constexpr float kGrownStep = 0.02F;  // depth steps larger than this share of the depth end a person found at a head
constexpr double kRefused = 5.0;     // how long no head is looked for where none was [s]

}  // namespace

Vec3f expectedMiddle(const PeopleScene& scene, const PersonSlot& slot) {
  return slot.middle + static_cast<float>(scene.elapsed) * slot.velocity;
}

int freeSlot(const PersonSlots& slots) {
  for (int k = 0; k < kPersonSlots; ++k) {
    if (!slots[k].used) return k;
  }
  return -1;
}

float horizontally(const Vec3f& v) {
  return std::hypot(v.x(), v.z());
}

Vec3f axisOf(const PeopleScene& scene, const FoundHead& head) {
  Vec3f away = head.position - scene.floorFromCamera.translation().cast<float>();
  away.y() = 0.0F;
  return head.position + kHeadDepth * away.normalized();
}

PersonSlot newcomer(const PeopleScene& scene, const Vec3f& middle) {
  PersonSlot slot;
  slot.used = true;
  slot.born = slot.lastSeen = scene.time;
  slot.middle = middle;
  return slot;
}

PeopleAtHeads::PeopleAtHeads(const DepthGrid& grid) {
  uncovered_.reserve(grid.cellCount());
  region_.reserve(grid.cellCount());
  waiting_.reserve(16);
  stillWaiting_.reserve(16);
}

void PeopleAtHeads::refuse(const Vec3f& middle, double time) {
  refusals_[nextRefusal_] = {middle, time + kRefused};
  nextRefusal_ = (nextRefusal_ + 1) % refusals_.size();
}

bool PeopleAtHeads::isRefused(const Vec3f& axis, double time) const {
  return std::ranges::any_of(refusals_, [&](const Refusal& refusal) {
    return time < refusal.until && horizontally(refusal.middle - axis) < kNeighbour;
  });
}

/// What is connected to a head, stands out from the room and is within a person's size belongs to a person.
bool PeopleAtHeads::growFrom(const PeopleScene& scene, const FoundHead& head, int slot,
                             std::span<std::uint8_t> person) {
  const DepthGrid& grid = scene.grid;
  const std::size_t w = grid.width;
  const Vec3f axis = axisOf(scene, head);
  const Vec3f camera = scene.floorFromCamera.translation().cast<float>();
  Vec3f away = head.position - camera;
  away.y() = 0.0F;
  away.normalize();
  const Vec3f aside = away.cross(Vec3f::UnitY());
  const std::uint8_t mark = slot + 1;
  region_.clear();
  float top = -1e9F, bottom = 1e9F, area = 0.0F;
  const auto take = [&](std::size_t i) {
    if (person[i] != 0 || grid.depthMm[i] == 0) return false;
    if (scene.kinds[i] == CellKind::kFloor || scene.kinds[i] == CellKind::kWall) return false;
    const Vec3f position = scene.positions(grid, i % w, i / w);
    const float back = (position - head.position).dot(away);
    if (std::abs((position - axis).dot(aside)) > kGrown || back > kGrownBack || back < -kGrownFront) return false;
    person[i] = mark;
    region_.push_back(i);
    top = std::max(top, position.y());
    bottom = std::min(bottom, position.y());
    const float depth = 0.001F * grid.depthMm[i];
    area += depth * depth * static_cast<float>(grid.cellArea);
    return true;
  };
  take(grid.index(head.column, head.row));
  for (std::size_t next = 0; next < region_.size(); ++next) {
    const std::size_t i = region_[next];
    const float step = kGrownStep * grid.depthMm[i];
    grid.visitNeighbours(i, [&](std::size_t j) {
      if (std::abs(grid.depthMm[i] - grid.depthMm[j]) < step) take(j);
    });
  }
  if (area > kMinVisibleArea && top - bottom > kMinVisibleHeight) return true;
  for (const std::uint32_t i : region_) person[i] = 0;
  return false;
}

void PeopleAtHeads::find(const PeopleScene& scene, PersonSlots& slots, std::span<std::uint8_t> person) {
  uncovered_.clear();
  if (!scene.looked) return;
  std::swap(waiting_, stillWaiting_);
  waiting_.clear();
  for (const FoundHead& head : scene.heads) {
    const std::size_t cell = scene.grid.index(head.column, head.row);
    if (person[cell] != 0 || scene.kinds[cell] == CellKind::kFloor || scene.kinds[cell] == CellKind::kWall) continue;
    const Vec3f axis = axisOf(scene, head);
    const bool known = std::ranges::any_of(
        slots, [&](const PersonSlot& slot) { return slot.used && horizontally(slot.middle - axis) < kNeighbour; });
    const int free = freeSlot(slots);
    if (isRefused(axis, scene.time) || known || free < 0) continue;
    // Someone who stands free is found without this in the next frames.
    const auto same = [&](const Vec3f& other) { return horizontally(axis - other) < kHeadsApart; };
    if (std::ranges::none_of(stillWaiting_, same)) {
      waiting_.push_back(axis);
      continue;
    }
    if (!growFrom(scene, head, free, person)) {
      refuse(axis, scene.time);
      continue;
    }
    slots[free] = newcomer(scene, axis);
    slots[free].seen = true;
    slots[free].attached = true;
    uncovered_.insert(uncovered_.end(), region_.begin(), region_.end());
  }
}

}  // namespace lorica
