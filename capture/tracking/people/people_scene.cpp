#include "capture/tracking/people/people_scene.h"

#include <cmath>

namespace lorica {
namespace {

constexpr float kHeadDepth = 0.1F;  // from the face to the axis of the head [m]

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

}  // namespace lorica
