#include "capture/tracking/people/person_owners.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace lorica {
namespace {

constexpr float kCore = 0.2F;    // within this distance of a person's axis, a cell is certainly theirs [m]
constexpr float kAlien = 0.35F;  // nearer to another's axis by this: no longer the person's [m]
constexpr int kSameDepth = 120;  // [mm]

bool holds(unsigned slotMask, int slot) {
  return (slotMask & (1U << slot)) != 0;
}

constexpr int kKnownCells = 200;      // of a person's, affirmed by the network: it knows the person
constexpr float kReach = 0.9F;        // max distance from the middle of a person to that of any piece, horizontally [m]
constexpr float kGapNew = 0.35F;      // between pieces of a person in front of known background [m]
constexpr float kGapUnknown = 0.25F;  // and in front of unknown background [m]
constexpr float kUnder = 0.25F;       // from the middle of a person to that of a leg in front of unknown background [m]
constexpr float kOnFloor = 0.15F;     // what reaches down to this height stands on the floor [m]
constexpr float kAloneApart = 0.6F;   // of two surfaces that may be a person each: they are not one person [m]

// Owners of surfaces that are not slots.
constexpr int kNoOwner = -1;
constexpr int kMaybe = -2;    // a person for whom no slot is free
constexpr int kSeveral = -3;  // already shared between people
constexpr int kScenery = -4;  // continues into the background

/// Distance along the floor from the middle of a surface to the expected middle of a person [m].
float awayFrom(const PeopleScene& scene, const DepthComponent& one, const PersonSlot& slot) {
  return horizontally(one.middle() - expectedMiddle(scene, slot));
}

/// Whether a surface shows a head that none of some people may have: it is the visible part of another person.
template <typename Mine>
bool hasOtherHead(const PeopleScene& scene, std::size_t component, const Mine& mine) {
  const DepthComponent& one = scene.surfaces.components()[component];
  if (one.area < kMinVisibleArea || one.max.y() - one.min.y() < kMinVisibleHeight) return false;
  const std::span<const std::int32_t> label = scene.surfaces.labels();
  return std::ranges::any_of(scene.heads, [&](const FoundHead& head) {
    return label[scene.grid.index(head.column, head.row)] == static_cast<std::int32_t>(component) &&
           !mine(axisOf(scene, head));
  });
}

/// Whether a head may be that of a person who is followed.
bool mayBeHeadOf(const PeopleScene& scene, const PersonSlot& slot, const Vec3f& axis) {
  return slot.used && horizontally(axis - expectedMiddle(scene, slot)) < kHeadsApart;
}

/// Whether most of a person has gone out of sight.
bool isHidden(const PersonSlot& slot) {
  return slot.used && (!slot.seen || 2 * slot.cells < slot.usualCells);
}

/// The nearest of those who are hidden, near enough to show on a surface; -1 if there is none.
int hiddenSlot(const PeopleScene& scene, const PersonSlots& slots, const DepthComponent& one) {
  int best = -1;
  float bestDistance = 0.0F;
  for (int k = 0; k < kPersonSlots; ++k) {
    const PersonSlot& slot = slots[k];
    if (!isHidden(slot)) continue;
    const float away = scene.time - slot.lastSeen;
    const float distance = horizontally(one.middle() - slot.middle);
    if (distance > std::min(0.6F + 1.5F * away, 1.8F) || (best >= 0 && distance >= bestDistance)) continue;
    best = k;
    bestDistance = distance;
  }
  return best;
}

/// Whether a surface may be a person and is far from the main piece of the person whose it was.
bool standsApart(const PeopleScene& scene, std::size_t component, int slot, int cells) {
  const std::span<const DepthComponent> all = scene.surfaces.components();
  const DepthComponent& one = all[component];
  if (!mayBePerson(one, scene.grid, scene.floorFound)) return false;
  return std::ranges::any_of(all, [&](const DepthComponent& other) {
    return isMainPiece(other, cells, slot) && horizontally(other.middle() - one.middle()) > kAloneApart;
  });
}

}  // namespace

PersonOwners::PersonOwners(const DepthGrid& grid, const DepthCamera& camera)
    : camera_(camera), atHeads_(grid), person_(grid.cellCount()) {
  queue_.reserve(grid.cellCount());
  owner_.reserve(2048);
  nobody_.resize(grid.cellCount());
}

/// Whether the network knows a person, but says that a surface in front of unknown background is not theirs.
bool PersonOwners::isDenied(const PeopleScene& scene, const DepthComponent& one, int slot,
                            const PersonSlots& slots) const {
  return !slots[slot].strange && !isTooNear(one, scene.grid) && 2 * one.newCells < one.cells &&
         4 * one.affirmed < one.cells && known_[slot] > kKnownCells;
}

bool PersonOwners::mayBeSomeone(std::size_t component) const {
  return owner_[component] == kMaybe;
}

void PersonOwners::share(const PeopleScene& scene, PersonSlots& slots) {
  for (PersonSlot& slot : slots) slot.seen = false;
  assign(scene, slots);
  findNewcomers(scene, slots);
  atHeads_.find(scene, slots, person_);
  joinPieces(scene, slots);
}

void PersonOwners::give(const PeopleScene& scene, std::size_t component, int slot, PersonSlots& slots) {
  const DepthComponent& one = scene.surfaces.components()[component];
  owner_[component] = slot;
  slots[slot].seen = true;
  if (isAffirmed(one)) known_[slot] += one.cells;
  const std::span<const std::int32_t> label = scene.surfaces.labels();
  const bool whole = !isOversize(one) && !slots[slot].attached;
  const Vec3f middle = expectedMiddle(scene, slots[slot]);
  for (int r = one.top; r <= one.bottom; ++r) {
    for (int c = one.left; c <= one.right; ++c) {
      const std::size_t i = scene.grid.index(c, r);
      if (label[i] != static_cast<std::int32_t>(component)) continue;
      if (!whole) {
        // Merged with something large: the part near the person and in front of known background is the person's.
        const Vec3f apart = scene.positions(scene.grid, c, r) - middle;
        const bool before = scene.last.person[i] != 0 && std::abs(scene.grid.depthMm[i] - scene.last.depthMm[i]) < 150;
        const bool came =
            scene.last.depthMm[i] != 0 && static_cast<float>(scene.last.depthMm[i] - scene.grid.depthMm[i]) >
                                              1000.0F * scene.surfaces.step(scene.grid.depthMm[i]);
        const bool mine = before || came || scene.kinds[i] == CellKind::kNew;
        if (std::hypot(apart.x(), apart.z()) > 1.2F || !mine) continue;
      }
      person_[i] = slot + 1;
    }
  }
}

PersonOwners::SplitShare PersonOwners::shareOf(const PeopleScene& scene, const PersonSlot& slot) const {
  SplitShare share;
  share.middle = expectedMiddle(scene, slot);
  const Isometry3 cameraFromFloor = scene.floorFromCamera.inverse();
  const Vec3 before = cameraFromFloor * slot.middle.cast<double>();
  const Vec3 now = cameraFromFloor * share.middle.cast<double>();
  if (before.z() > -0.1 || now.z() > -0.1) return share;
  const double x = (now.x() / -now.z() - before.x() / -before.z()) * camera_.focalX() / scene.grid.step;
  const double y = -(now.y() / -now.z() - before.y() / -before.z()) * camera_.focalY() / scene.grid.step;
  share.columns = std::lround(std::clamp(x, -8.0, 8.0));
  share.rows = std::lround(std::clamp(y, -8.0, 8.0));
  return share;
}

void PersonOwners::splitBetween(const PeopleScene& scene, std::size_t component, unsigned slotMask, PersonSlots& slots,
                                const LastCells& last) {
  std::array<SplitShare, kPersonSlots> shares{};
  for (int k = 0; k < kPersonSlots; ++k) {
    if (!holds(slotMask, k)) continue;
    PersonSlot& slot = slots[k];
    slot.seen = true;
    shares[k] = shareOf(scene, slot);
  }
  owner_[component] = kSeveral;
  const DepthGrid& grid = scene.grid;
  const DepthComponent& one = scene.surfaces.components()[component];
  const std::int32_t label = component;
  const std::span<const std::int32_t> labels = scene.surfaces.labels();
  queue_.clear();
  for (int r = one.top; r <= one.bottom; ++r) {
    for (int c = one.left; c <= one.right; ++c) {
      const std::size_t i = grid.index(c, r);
      if (labels[i] != label) continue;

      const Vec3f position = scene.positions(grid, c, r);
      std::array<float, kPersonSlots> away{};
      int closest = -1;
      float next = 1e9F;  // distance of the second closest axis
      for (int k = 0; k < kPersonSlots; ++k) {
        if (!holds(slotMask, k)) continue;
        const float distance = away[k] = horizontally(position - shares[k].middle);
        if (closest < 0 || distance < away[closest]) {
          if (closest >= 0) next = away[closest];
          closest = k;
        } else if (distance < next) {
          next = distance;
        }
      }
      const float min = away[closest];
      if (min < kCore && min < 0.5F * next) {
        person_[i] = closest + 1;
        queue_.push_back(i);
        continue;
      }
      int nearest = kSameDepth;
      for (int k = 0; k < kPersonSlots; ++k) {
        if (!holds(slotMask, k) || away[k] > min + kAlien) continue;
        const SplitShare& share = shares[k];
        const int column = c - share.columns, row = r - share.rows;
        if (column < 0 || column >= grid.width || row < 0 || row >= grid.height) continue;
        const std::size_t before = grid.index(column, row);
        const int off = std::abs(grid.depthMm[i] - last.depthMm[before]);
        if (last.person[before] != k + 1 || off >= nearest) continue;
        nearest = off;
        person_[i] = k + 1;
      }
      if (person_[i] != 0) queue_.push_back(i);
    }
  }
  grow(scene, label, 0.5F);
  grow(scene, label, 1.0F);
}

void PersonOwners::grow(const PeopleScene& scene, std::int32_t label, float steps) {
  const DepthGrid& grid = scene.grid;
  const std::span<const std::int32_t> labels = scene.surfaces.labels();
  for (std::size_t next = 0; next < queue_.size(); ++next) {
    const std::size_t i = queue_[next];
    const float step = 1000.0F * steps * scene.surfaces.step(grid.depthMm[i]);
    grid.visitNeighbours(i, [&](std::size_t j) {
      if (labels[j] != label || person_[j] != 0) return;
      if (std::abs(grid.depthMm[i] - grid.depthMm[j]) >= step) return;
      person_[j] = person_[i];
      queue_.push_back(j);
    });
  }
}

void PersonOwners::assign(const PeopleScene& scene, PersonSlots& slots) {
  const std::span<const DepthComponent> all = scene.surfaces.components();
  owner_.assign(all.size(), kNoOwner);
  std::ranges::fill(person_, std::uint8_t{0});
  known_.fill(0);
  for (const DepthComponent& one : all) {
    for (int k = 0; k < kPersonSlots && isAffirmed(one); ++k) known_[k] += one.overlap[k];
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    const DepthComponent& one = all[i];
    int best = -1;
    unsigned mask = 0;
    for (int k = 0; k < kPersonSlots; ++k) {
      const int overlap = one.overlap[k];
      if (overlap == 0) continue;
      if (best < 0 || overlap > one.overlap[best]) best = k;
      const PersonSlot& slot = slots[k];
      if (overlap * 12 > one.cells || overlap * 4 > slot.cells) mask |= 1U << k;
    }
    // What was a person's and is not their main piece stays theirs beside the room: a leg beside a chair.
    const bool piece = best >= 0 && 2 * one.overlap[best] > one.cells && !isMainPiece(one, slots[best].cells, best);
    // The network may waver about somebody whom it affirmed before.
    const bool wavers = best >= 0 && 4 * one.affirmed > one.cells && 2 * one.overlap[best] > one.cells;
    if (goesOnIntoBackground(one) && !piece && !wavers && (best < 0 || !slots[best].attached)) {
      owner_[i] = kScenery;
      continue;
    }
    if (best < 0 || one.overlap[best] < std::max(6, one.cells / 50)) continue;
    if (isDenied(scene, one, best, slots)) continue;
    const auto mine = [&](const Vec3f& axis) { return mayBeHeadOf(scene, slots[best], axis); };
    if (!isMainPiece(one, slots[best].cells, best) &&
        (hasOtherHead(scene, i, mine) || standsApart(scene, i, best, slots[best].cells))) {
      continue;
    }
    if ((mask & (mask - 1)) != 0) {
      splitBetween(scene, i, mask, slots, scene.last);
    } else if (!slots[best].confirmed && separateHeads(scene, i, best, slots)) {
      continue;
    } else if (isMainPiece(one, slots[best].cells, best) || awayFrom(scene, one, slots[best]) < kReach) {
      give(scene, i, best, slots);
    }
  }
}

void PersonOwners::findNewcomers(const PeopleScene& scene, PersonSlots& slots) {
  const std::span<const DepthComponent> all = scene.surfaces.components();
  const auto anyones = [&](const Vec3f& axis) {
    return std::ranges::any_of(slots, [&](const PersonSlot& slot) { return mayBeHeadOf(scene, slot, axis); });
  };
  for (;;) {
    int best = -1;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (owner_[i] != kNoOwner) continue;
      if (best >= 0 && all[i].area <= all[best].area) continue;
      // What does not move and the network does not take for a person needs a head.
      const bool likely = isAffirmed(all[i]) || 2 * all[i].newCells > all[i].cells;
      const bool whole = (likely && mayBePerson(all[i], scene.grid, scene.floorFound)) ||
                         (!isOversize(all[i]) && hasOtherHead(scene, i, anyones));
      if (!whole && (hiddenSlot(scene, slots, all[i]) < 0 || !mayBePartOfPerson(all[i]))) continue;
      best = i;
    }
    if (best < 0) return;
    const std::size_t component = best;
    if (separateHeads(scene, component, -1, slots)) continue;
    const int hidden = hiddenSlot(scene, slots, all[component]);
    if (hidden >= 0) {
      if (!slots[hidden].seen) slots[hidden].attached = false;  // the room behind was seen meanwhile
      give(scene, component, hidden, slots);
      continue;
    }
    const int free = freeSlot(slots);
    owner_[component] = kMaybe;
    if (free < 0) continue;
    PersonSlot& slot = slots[free];
    slot = newcomer(scene, all[component].middle());
    give(scene, component, free, slots);
    joinPieces(scene, slots);
  }
}

/// Divides a surface with several heads on it between as many people.
/// @param slot  of the one whose surface it was; -1 = nobody's
/// @return whether there are several
bool PersonOwners::separateHeads(const PeopleScene& scene, std::size_t component, int slot, PersonSlots& slots) {
  const std::span<const std::int32_t> label = scene.surfaces.labels();
  std::array<Vec3f, kPersonSlots> axes;
  std::size_t count = 0;
  for (const FoundHead& head : scene.heads) {
    if (label[scene.grid.index(head.column, head.row)] != static_cast<std::int32_t>(component)) continue;
    const Vec3f axis = axisOf(scene, head);
    const auto near = [&](const Vec3f& other) { return horizontally(axis - other) < kHeadsApart; };
    if (count == axes.size() || std::any_of(axes.begin(), axes.begin() + count, near)) continue;
    axes[count++] = axis;
  }
  if (count < 2) return false;
  unsigned mask = 0;
  for (std::size_t h = 0; h < count; ++h) {
    const int mine = h == 0 && slot >= 0 ? slot : freeSlot(slots);
    if (mine < 0) break;
    const int user = mine == slot ? slots[mine].user : 0;
    const bool reported = mine == slot && slots[mine].reported;
    slots[mine] = newcomer(scene, axes[h]);
    slots[mine].user = user;
    slots[mine].reported = reported;
    mask |= 1U << mine;
  }
  if ((mask & (mask - 1)) == 0) return false;
  splitBetween(scene, component, mask, slots, LastCells{nobody_, scene.last.depthMm});
  return true;
}

/// The distance from a surface to each person, along the rows and columns of the image; @param max if it is larger [m]
std::array<float, kPersonSlots> PersonOwners::gapsTo(const PeopleScene& scene, std::size_t component, float max) const {
  const DepthGrid& grid = scene.grid;
  const DepthComponent& one = scene.surfaces.components()[component];
  const std::span<const std::int32_t> label = scene.surfaces.labels();
  const std::int32_t mine = component;
  const std::ptrdiff_t w = grid.width;
  const float cell = std::sqrt(one.area / one.cells);
  const int reach = max / cell;
  std::array<float, kPersonSlots> gaps;
  gaps.fill(max);
  for (int r = one.top; r <= one.bottom; ++r) {
    for (int c = one.left; c <= one.right; ++c) {
      const std::size_t i = grid.index(c, r);
      if (label[i] != mine) continue;
      const auto look = [&](std::ptrdiff_t stride, int room) {
        for (int s = 1; s <= std::min(room, reach); ++s) {
          const std::size_t j = i + s * stride;
          if (label[j] == mine) return;
          if (person_[j] == 0) continue;
          const Vec3f there = scene.positions(grid, j % w, j / w);
          float& gap = gaps[person_[j] - 1U];
          gap = std::min(gap, (there - scene.positions(grid, c, r)).norm());
        }
      };
      look(-1, c);
      look(1, grid.width - 1 - c);
      look(-w, r);
      look(w, grid.height - 1 - r);
    }
  }
  return gaps;
}

void PersonOwners::joinPieces(const PeopleScene& scene, PersonSlots& slots) {
  const std::span<const DepthComponent> all = scene.surfaces.components();
  for (std::size_t component = 0; component < all.size(); ++component) {
    const DepthComponent& one = all[component];
    if (owner_[component] != kNoOwner || one.area > 0.4) continue;
    const bool isNew = 2 * one.newCells > one.cells;
    const float max = isNew ? kGapNew : kGapUnknown;
    const std::array<float, kPersonSlots> gaps = gapsTo(scene, component, max);
    // The nearest surface may be that of someone in front, so the nearest middle counts. If the background is not
    // known, a piece that stands on the floor may be a chair as well as a leg, but legs are below the trunk.
    const bool stands = !isNew && scene.floorFound && one.min.y() < kOnFloor;
    float nearest = stands ? kUnder : kReach;
    int best = -1;
    for (int k = 0; k < kPersonSlots; ++k) {
      if (gaps[k] >= max) continue;
      const float away = awayFrom(scene, one, slots[k]);
      if (away >= nearest) continue;
      nearest = away;
      best = k;
    }
    if (best < 0 || isDenied(scene, one, best, slots)) continue;
    // A person who has gone behind another one may show beside them.
    const int hidden = isNew ? hiddenSlot(scene, slots, one) : -1;
    if (hidden >= 0 && awayFrom(scene, one, slots[hidden]) < nearest) best = hidden;
    const auto mine = [&](const Vec3f& axis) { return mayBeHeadOf(scene, slots[best], axis); };
    if (!hasOtherHead(scene, component, mine)) give(scene, component, best, slots);
  }
}

}  // namespace lorica
