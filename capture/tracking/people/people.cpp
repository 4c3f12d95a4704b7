#include "capture/tracking/people/people.h"

#include "capture/tracking/people/background.h"
#include "capture/tracking/people/components.h"
#include "capture/tracking/people/depth_grid.h"
#include "capture/tracking/people/head_finder.h"
#include "capture/tracking/people/person_evidence.h"
#include "capture/tracking/people/person_image.h"
#include "capture/tracking/people/person_owners.h"
#include "capture/tracking/people/room_planes.h"
#include "geometry/counts.h"
#include "geometry/result.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace lorica {

namespace {

constexpr double kRemembered = 2.0;                // how long a person out of sight keeps their number [s]
constexpr double kDoubtful = 0.2;                  // the same for what may be furniture [s]
constexpr float kNear = 0.05F;                     // what is this near to the fitted body is the person's [m]
constexpr float kFar = 0.12F;                      // and what is farther is not [m]
constexpr int kHeadPause = 3;                      // frames between searches for heads
constexpr int kMinCells = 20;                      // of a person who is seen
constexpr float kMinHeight = 1.1F;                 // of a person who does not move, over the floor [m]
constexpr int kUsualFrames = 64;                   // in which a person's usual size fades if they appear smaller
constexpr int kMovingFrames = 3;                   // consecutive moving frames until a person counts as moved
constexpr double kStillSeconds = 3.0;              // how long furniture may be taken for a person
constexpr float kWholeShare = 0.85F;               // a surface of which the network affirms this share is left whole
constexpr float kFewKnown = 0.02F;                 // share affirmed of who stands still and is not free, at least
constexpr float kStrange = 0.75F, kKnown = 0.95F;  // share affirmed of a person below and above which the network does
                                                   // not, or does, know what they look like
constexpr float kMerged = 1.3F;                    // whoever covers so much more than before has merged with the room
constexpr int kNever = -1024;    // logit below which a cell near the fitted body does not become the person's
constexpr float kBehind = 0.5F;  // whoever is this near to the line of sight through another is half behind them [m]
constexpr int kUnlearns = 512;   // logit above which a cell of the background shows somebody
constexpr int kJoins = 0, kLeaves = -256;  // logits below which a cell does not become, or remain, a person's
constexpr double kPersonSeconds = 20.0;    // how long someone with head and shoulders may stand motionless
constexpr double kFloorNoises = 2.5;       // a floor lies within so many times the depth's noise ...
constexpr float kFloorThickness = 0.008F;  // ... and this of its plane [m]
constexpr float kBinsFrom = 0.5F, kBinsPerMetre = 50.0F, kBinHeight = 0.02F;  // of a person's heights: from -0.5 m
constexpr int kTopCells = 3, kTopShare = 500;  // cells above somebody's top, at most, and one more for each so many
constexpr double kPauseFrom = 1e-4, kPauseTo = 0.2;  // between frames that tell a velocity [s]
constexpr float kVelocityShare = 0.4F;               // of a new velocity in the smoothed one
constexpr float kFastestPerson = 3.0F;               // [m/s]
constexpr int kNewCells = 3, kOfCells = 20;          // somebody moves if more than 3 of 20 cells are new
constexpr int kSmallPart = 25;                       // a low thing covers less than this part of the image
constexpr double kNearestBody = 0.3;                 // from the camera, of a body that is projected [m]
constexpr double kLongestFrame = 1.0;                // longer pauses count as this [s]

}  // namespace

struct PeopleFinder::Impl {
  Impl(const DepthCamera& depthCamera, int max);

  void classify();
  bool takeFurnitureOff();
  void measure();
  void doubtHidden();
  void giveUpFurniture(bool floorIsNew);
  void makeBackground(int slot);
  void explain(int slot, const fit::PosedModel& body);
  void explainPieces(int slot, const fit::PosedModel& body);
  void report();
  void paint(std::span<const std::uint16_t> depthMm);
  void find(const DepthFrame& frame);

  [[nodiscard]] bool looksLikePerson(const PersonSlot& slot) const;

  DepthCamera camera;
  int maxPeople;
  DepthGrid grid;
  FloorFinder floor;
  WallFinder walls;
  FloorPositions positions;
  Background background;
  PersonEvidence evidence;
  HeadFinder headFinder;
  ComponentFinder finder;
  PersonOwners owners;
  PersonMoves moves;
  DepthTable floorNoise;  ///< of heights over the floor, for a camera 1 m up [m]

  std::vector<int> strange;  ///< cells of each surface that were of people whom the network does not know

  std::vector<CellKind> kinds;
  std::span<std::uint8_t> person;  ///< of the owners: slot + 1
  std::vector<std::uint8_t> lastPerson;
  std::vector<std::uint8_t> taken;
  std::vector<std::uint16_t> lastDepthMm;
  PersonSlots slots;
  double time = 0.0, elapsed = 0.0;
  bool started = false;
  int frameCount = 0;

  std::vector<PersonSegment> people;
  std::vector<std::uint8_t> labels;
  Isometry3 floorFromCamera = Isometry3::Identity();
};

PeopleFinder::Impl::Impl(const DepthCamera& depthCamera, int max)
    : camera(depthCamera),
      maxPeople(std::clamp(max, 1, kPersonSlots - 2)),
      grid(depthCamera),
      floor(grid),
      walls(grid),
      positions(grid),
      background(grid),
      evidence(grid),
      headFinder(grid),
      finder(grid),
      owners(grid, depthCamera),
      moves(grid),
      floorNoise([](double depth) { return kFloorNoises * depthNoise(depth) / depth; }),
      strange(kMaxSurfaces),
      kinds(grid.cellCount()),
      person(owners.person()),
      lastPerson(grid.cellCount()),
      taken(grid.cellCount()),
      lastDepthMm(grid.cellCount()),
      labels(static_cast<std::size_t>(depthCamera.width) * depthCamera.height) {
  people.reserve(kPersonSlots);
  floorFromCamera = floor.floorFromCamera();
}

void PeopleFinder::Impl::classify() {
  std::ranges::fill(kinds, CellKind::kNone);
  if (floor.found()) {
    const float height = positions.cameraHeight();
    for (int r = 0; r < grid.height; ++r) {
      for (int c = 0; c < grid.width; ++c) {
        const std::size_t i = grid.index(c, r);
        const std::uint16_t depthMm = grid.depthMm[i];
        const float above = 0.001F * depthMm * positions.slope(c, r) + height;
        if (depthMm != 0 && above < kFloorThickness + floorNoise[depthMm] * height) kinds[i] = CellKind::kFloor;
      }
    }
  }
  walls.mark(grid, kinds);
  background.classify(grid, kinds);
}

/// Surfaces in front of unknown background that are part person and part room, as the network sees them, are divided.
/// @return whether there are any
bool PeopleFinder::Impl::takeFurnitureOff() {
  const std::span<const std::int16_t> logits = evidence.logits();
  const std::span<const std::int32_t> label = finder.labels();
  const std::span<const DepthComponent> all = finder.components();
  // Whoever the network does not know well is left alone, most of all people half behind others.
  std::ranges::fill(strange, 0);
  for (std::size_t i = 0; i < label.size(); ++i) {
    if (label[i] >= 0 && lastPerson[i] != 0) strange[label[i]] += slots[lastPerson[i] - 1U].strange;
  }
  bool any = false;
  for (std::size_t i = 0; i < label.size(); ++i) {
    if (label[i] < 0 || kinds[i] != CellKind::kUnknown) continue;
    const DepthComponent& one = all[label[i]];
    const bool whole =
        isTooNear(one, grid) || one.affirmed > kWholeShare * one.cells ||
        (3 * one.affirmed < one.cells && !isOversize(one) && one.area * one.affirmed < kMinVisibleArea * one.cells);
    if (whole || 3 * strange[label[i]] > one.cells || logits[i] >= (lastPerson[i] != 0 ? kLeaves : kJoins)) continue;
    kinds[i] = CellKind::kFurniture;
    any = true;
  }
  return any;
}

void PeopleFinder::Impl::measure() {
  for (PersonSlot& slot : slots) {
    slot.cells = slot.newCells = slot.affirmed = 0;
    slot.sum.setZero();
    slot.heights.fill(0);
    slot.cutAbove = slot.cutAside = false;
  }
  for (int r = 0; r < grid.height; ++r) {
    for (int c = 0; c < grid.width; ++c) {
      const std::size_t i = grid.index(c, r);
      if (person[i] == 0) continue;
      PersonSlot& slot = slots[person[i] - 1U];
      const Vec3f position = positions(grid, c, r);
      ++slot.cells;
      slot.newCells += kinds[i] == CellKind::kNew;
      slot.affirmed += evidence.logits()[i] > 0;
      slot.sum += position;
      slot.cutAbove = slot.cutAbove || r <= grid.firstRow + 1;
      slot.cutAside = slot.cutAside || c <= grid.firstColumn + 1 || c >= grid.lastColumn - 1;
      ++slot.heights[std::clamp(static_cast<int>((position.y() + kBinsFrom) * kBinsPerMetre), 0, kHeightBins - 1)];
    }
  }
  for (int k = 0; k < kPersonSlots; ++k) {
    PersonSlot& slot = slots[k];
    if (!slot.used) continue;
    slot.seen = slot.cells >= kMinCells;
    if (slot.seen) {
      // Whom no body explains yet, and who suddenly covers more, is not strange but connected to the room.
      const bool merged = slot.cells > kMerged * slot.knownCells, affirmed = slot.affirmed > kStrange * slot.cells;
      slot.strange = slot.confirmed && !merged && slot.affirmed < (slot.strange ? kKnown : kStrange) * slot.cells;
      if (!merged || !slot.confirmed || affirmed) slot.knownCells = slot.cells;
      slot.usualCells = std::max(slot.cells, slot.usualCells - slot.usualCells / kUsualFrames);
      int above = 0, bin = kHeightBins;
      while (bin > 0 && above < kTopCells + slot.cells / kTopShare) above += slot.heights[--bin];
      slot.top = kBinHeight * (bin + 1) - kBinsFrom;
      const Vec3f middle = slot.sum / static_cast<float>(slot.cells);
      const double since = time - slot.lastSeen;
      if (since > kPauseFrom && since < kPauseTo) {
        const Vec3f velocity = (middle - slot.middle) / static_cast<float>(since);
        slot.velocity += kVelocityShare * (velocity - slot.velocity);
        if (slot.velocity.norm() > kFastestPerson) slot.velocity *= kFastestPerson / slot.velocity.norm();
      } else {
        slot.velocity.setZero();
      }
      slot.middle = middle;
      slot.lastSeen = time;
      if (slot.born == time) moves.remember(grid, person, k);
      if (slot.moved) continue;
      const bool isMoving = kOfCells * slot.newCells > kNewCells * slot.cells || moves.hasMoved(grid, person, k);
      slot.movingFrames = isMoving ? slot.movingFrames + 1 : 0;
      slot.moved = slot.movingFrames >= kMovingFrames;
    } else if (time - slot.lastSeen > (slot.moved || slot.confirmed ? kRemembered : kDoubtful)) {
      slot = PersonSlot{};
    }
  }
}

/// The network was shown few people behind others: of those it is not asked.
void PeopleFinder::Impl::doubtHidden() {
  const Vec3f origin = floorFromCamera.translation().cast<float>();
  for (PersonSlot& slot : slots) {
    if (!slot.seen) continue;
    Vec3f away = slot.middle - origin;
    away.y() = 0.0F;
    for (const PersonSlot& other : slots) {
      if (!other.seen || &other == &slot) continue;
      Vec3f nearer = other.middle - origin;
      nearer.y() = 0.0F;
      if (nearer.norm() > away.norm() || nearer.cross(away).norm() > kBehind * away.norm()) continue;
      slot.strange = true;
      slot.attached = slot.attached || slot.confirmed;
    }
  }
}

/// Something that never moves, or proves to be low once the floor is known, is not a person.
void PeopleFinder::Impl::giveUpFurniture(bool floorIsNew) {
  for (int k = 0; k < kPersonSlots; ++k) {
    PersonSlot& slot = slots[k];
    if (!slot.seen || slot.moved) continue;
    const double age = time - slot.born;
    const bool low = floorIsNew && !slot.cutAbove && slot.top < kMinHeight && slot.cells * kSmallPart < countOf(person);
    const auto looksHuman = [&] {
      return slot.confirmed || hasHeadAndShoulders(grid, positions, person, k, slot.top, slot.cutAside);
    };
    const bool likely = age < kStillSeconds || (age < kPersonSeconds && looksHuman());
    if (!low && likely) continue;
    makeBackground(k);
  }
}

void PeopleFinder::Impl::makeBackground(int k) {
  for (std::size_t i = 0; i < person.size(); ++i) {
    if (person[i] != k + 1) continue;
    person[i] = 0;
    background.absorb(grid, i);
  }
  owners.refuse(slots[k].middle, time);
  slots[k] = PersonSlot{};
}

void PeopleFinder::Impl::explain(int k, const fit::PosedModel& body) {
  // Where the body is in the image.
  const Isometry3 cameraFromFloor = floorFromCamera.inverse();
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
  for (const fit::ShapedCapsule& capsule : body.capsule) {
    const Vec3 middle = cameraFromFloor * capsule.middle.cast<double>();
    const double depth = std::max(kNearestBody, -middle.z());
    const double reach = (capsule.reach + kFar) * camera.focalX() / depth;
    const double x = 0.5 * camera.width + camera.focalX() * middle.x() / depth;
    const double y = 0.5 * camera.height - camera.focalY() * middle.y() / depth;
    left = std::min(left, x - reach);
    right = std::max(right, x + reach);
    top = std::min(top, y - reach);
    bottom = std::max(bottom, y + reach);
  }
  const std::uint8_t mine = k + 1;
  for (int r = 0; r < grid.height; ++r) {
    for (int c = 0; c < grid.width; ++c) {
      const std::size_t i = grid.index(c, r);
      const bool was = person[i] == mine;
      const double x = c * grid.step, y = r * grid.step;
      const bool within = x > left && x < right && y > top && y < bottom;
      if (kinds[i] == CellKind::kNone || (!was && (!within || person[i] != 0)) || kinds[i] == CellKind::kNew) continue;
      if (kinds[i] == CellKind::kFloor || kinds[i] == CellKind::kWall || kinds[i] == CellKind::kFurniture) continue;
      const Vec3f position = positions(grid, c, r);
      float nearest = kFar;
      for (const fit::ShapedCapsule& capsule : body.capsule) {
        if ((position - capsule.middle).norm() - capsule.reach >= nearest) continue;
        nearest = std::min(nearest, std::abs(fit::distanceTo(body, capsule, position).distance));
      }
      if (was && nearest >= kFar) lastPerson[i] = 0;
      if (!was && nearest < kNear && evidence.logits()[i] > kNever) {
        lastPerson[i] = mine;
        if (kinds[i] == CellKind::kBackground) background.forget(i);
      }
    }
  }
}

/// A piece in front of unknown background that the body does not explain, such as a chair or someone else's leg, is no
/// longer the person's by having been theirs.
void PeopleFinder::Impl::explainPieces(int k, const fit::PosedModel& body) {
  const std::span<const DepthComponent> all = finder.components();
  const std::span<const std::int32_t> label = finder.labels();
  for (std::size_t component = 0; component < all.size(); ++component) {
    const DepthComponent& one = all[component];
    const bool isNew = 2 * one.newCells > one.cells, main = 2 * one.cells > slots[k].cells;
    if (!owners.isOf(component, k) || isNew || main) continue;
    const auto each = [&](const auto& act) {
      for (int r = one.top; r <= one.bottom; ++r) {
        for (int c = one.left; c <= one.right; ++c) {
          if (label[grid.index(c, r)] == static_cast<std::int32_t>(component)) act(c, r);
        }
      }
    };
    int far = 0;
    each([&](int c, int r) {
      const Vec3f position = positions(grid, c, r);
      const auto isNear = [&](const fit::ShapedCapsule& capsule) {
        return (position - capsule.middle).norm() - capsule.reach < kFar &&
               std::abs(fit::distanceTo(body, capsule, position).distance) < kFar;
      };
      far += std::ranges::none_of(body.capsule, isNear);
    });
    if (2 * far > one.cells) each([&](int c, int r) { lastPerson[grid.index(c, r)] = 0; });
  }
}

/// True for a person who has moved or stands free. Something cut off by the image's top or sides may also be a shelf:
/// it must show head and shoulders. What hangs together with the room and stands still, such as a chair before a
/// partition, needs a few cells that the network knows, unless it is too near for that.
bool PeopleFinder::Impl::looksLikePerson(const PersonSlot& slot) const {
  if (slot.moved) return true;
  if (slot.attached && slot.affirmed < kFewKnown * slot.cells && horizontally(slot.middle) > kNearestKnown)
    return false;
  if (!slot.cutAbove && !slot.cutAside) return true;
  return hasHeadAndShoulders(grid, positions, person, static_cast<int>(&slot - slots.data()), slot.top, slot.cutAside);
}

/// Reports the nearest people, moving ones first; people already reported are kept.
void PeopleFinder::Impl::report() {
  int reported = 0;
  for (const PersonSlot& slot : slots) reported += slot.used && slot.reported;
  for (;;) {
    PersonSlot* next = nullptr;
    PersonSlot* min = nullptr;
    const auto before = [](const PersonSlot& a, const PersonSlot& b) {
      if (a.moved != b.moved) return a.moved;
      return std::hypot(a.middle.x(), a.middle.z()) < std::hypot(b.middle.x(), b.middle.z());
    };
    for (PersonSlot& slot : slots) {
      if (!slot.used) continue;
      if (slot.reported) {
        if (min == nullptr || before(*min, slot)) min = &slot;
      } else if (slot.seen && (next == nullptr || before(slot, *next)) && looksLikePerson(slot)) {
        next = &slot;
      }
    }
    if (next == nullptr) return;
    if (reported == maxPeople) {
      // Furniture gives way to people.
      if (min == nullptr || min->moved || !next->moved) return;
      min->reported = false;
      min->user = 0;
    } else {
      ++reported;
    }
    next->reported = true;
    for (int user = 1; next->user == 0; ++user) {
      const bool given =
          std::ranges::any_of(slots, [&](const PersonSlot& slot) { return slot.used && slot.user == user; });
      if (!given) next->user = user;
    }
  }
}

/// The output: people by increasing number.
void PeopleFinder::Impl::paint(std::span<const std::uint16_t> depthMm) {
  people.clear();
  std::array<std::uint8_t, kPersonSlots> numbers{};
  for (;;) {
    const PersonSlot* next = nullptr;
    for (const PersonSlot& slot : slots) {
      if (!slot.used || !slot.seen || !slot.reported) continue;
      if (!people.empty() && slot.user <= people.back().user) continue;
      if (next == nullptr || slot.user < next->user) next = &slot;
    }
    if (next == nullptr) break;
    PersonSegment segment;
    segment.user = next->user;
    segment.left = camera.width;
    segment.top = camera.height;
    segment.middle = next->middle.cast<double>();
    segment.topHeight = next->top;
    segment.moved = next->moved;
    // If the network knows somebody connected to the room, it is certain which pixels are theirs.
    segment.attached = next->attached && (next->strange || next->affirmed < kStrange * next->cells);
    people.push_back(segment);
    numbers[next - slots.data()] = people.size();
  }
  paintPeople(grid, finder, depthMm, numbers, person, people, labels);
}

void PeopleFinder::Impl::find(const DepthFrame& frame) {
  elapsed = started ? std::clamp(frame.time - time, 0.0, kLongestFrame) : 0.0;
  time = frame.time;
  started = true;
  grid.fill(frame.depthMm);
  const bool floorBefore = floor.found();
  floor.update(grid);
  walls.update(grid, floor.up().cast<float>());
  const bool floorIsNew = floor.found() && !floorBefore;
  floorFromCamera = floor.floorFromCamera();
  positions.set(grid, floorFromCamera);
  classify();
  evidence.update(grid, positions, floor.found());
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    if (kinds[i] != CellKind::kBackground || background.isSettled(i)) continue;
    if (evidence.logits()[i] > kUnlearns) kinds[i] = CellKind::kUnknown;
  }
  const LastCells last{lastPerson, lastDepthMm};
  finder.find(grid, positions, kinds, last, evidence.logits());
  if (takeFurnitureOff()) finder.find(grid, positions, kinds, last, evidence.logits());
  const bool looking = frameCount++ % kHeadPause == 0;
  const std::span<const FoundHead> heads =
      looking ? headFinder.find(grid, positions, floor.found()) : std::span<const FoundHead>();
  owners.share({grid, positions, finder, kinds, last, heads, looking, floorFromCamera, floor.found(), time, elapsed},
               slots);
  for (const std::uint32_t cell : owners.uncovered()) background.forget(cell);
  measure();
  doubtHidden();
  giveUpFurniture(floorIsNew);

  // The background is learnt from what certainly belongs to nobody.
  const std::span<const std::int32_t> label = finder.labels();
  for (std::size_t i = 0; i < taken.size(); ++i) {
    const bool maybe = label[i] >= 0 && owners.mayBeSomeone(label[i]);
    taken[i] = person[i] != 0 || maybe || (evidence.logits()[i] > 0 && kinds[i] >= CellKind::kBackground);
  }
  background.learn(grid, kinds, taken);
  report();
  paint(frame.depthMm);
  std::ranges::copy(person, lastPerson.begin());
  lastDepthMm = grid.depthMm;
}

PeopleFinder::PeopleFinder(const DepthCamera& camera, int maxPeople)
    : impl_(std::make_unique<Impl>(camera, maxPeople)) {}
PeopleFinder::~PeopleFinder() = default;

void PeopleFinder::find(const DepthFrame& frame) {
  LORICA_CHECK(frame.depthMm.size() == impl_->labels.size(), "the depth image must have the camera's size");
  impl_->find(frame);
}
void PeopleFinder::confirm(int user) {
  for (PersonSlot& slot : impl_->slots) slot.confirmed = slot.confirmed || (slot.used && slot.user == user);
}
void PeopleFinder::explain(int user, const fit::PosedModel& body) {
  for (int k = 0; k < kPersonSlots; ++k) {
    const PersonSlot& slot = impl_->slots[k];
    if (!slot.used || slot.user != user) continue;
    if (slot.attached) {
      impl_->explain(k, body);
    } else {
      impl_->explainPieces(k, body);
    }
  }
}
void PeopleFinder::reject(int user) {
  for (int k = 0; k < kPersonSlots; ++k) {
    if (!impl_->slots[k].used || impl_->slots[k].user != user) continue;
    impl_->makeBackground(k);
    std::ranges::replace(impl_->lastPerson, static_cast<std::uint8_t>(k + 1), std::uint8_t{0});
  }
}
std::span<const PersonSegment> PeopleFinder::people() const {
  return impl_->people;
}
std::span<const std::uint8_t> PeopleFinder::labels() const {
  return impl_->labels;
}
const Isometry3& PeopleFinder::floorFromCamera() const {
  return impl_->floorFromCamera;
}
bool PeopleFinder::floorFound() const {
  return impl_->floor.found();
}

}  // namespace lorica
