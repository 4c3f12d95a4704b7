#include "capture/tracking/people/people.h"

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
constexpr int kNoLeg = -450;     // ... below which a cell is no leg's, beside what is a person's
constexpr int kOpen = -1000;     // ... below which it is not left open either: the network wavers at first
constexpr float kLegs = 0.6F;    // doubtful cells this high over the floor may be a leg's [m]
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

PeopleFinder::PeopleFinder(const DepthCamera& depthCamera, int max)
    : camera_(depthCamera),
      maxPeople_(std::clamp(max, 1, kPersonSlots - 2)),
      grid_(depthCamera),
      floor_(grid_),
      walls_(grid_),
      positions_(grid_),
      motion_(grid_),
      background_(grid_),
      evidence_(grid_),
      headFinder_(grid_),
      finder_(grid_),
      owners_(grid_, depthCamera),
      moves_(grid_),
      floorNoise_([](double depth) { return kFloorNoises * depthNoise(depth) / depth; }),
      legs_(grid_.cellCount()),
      leftOpen_(kMaxSurfaces),
      divided_(kMaxSurfaces),
      strange_(kMaxSurfaces),
      kinds_(grid_.cellCount()),
      person_(owners_.person()),
      lastPerson_(grid_.cellCount()),
      taken_(grid_.cellCount()),
      lastDepthMm_(grid_.cellCount()),
      labels_(static_cast<std::size_t>(depthCamera.width) * depthCamera.height) {
  people_.reserve(kPersonSlots);
  queue_.reserve(grid_.cellCount());
  floorFromCamera_ = floor_.floorFromCamera();
}

void PeopleFinder::classify() {
  std::ranges::fill(kinds_, CellKind::kNone);
  if (floor_.found()) {
    const float height = positions_.cameraHeight();
    for (int r = 0; r < grid_.height; ++r) {
      for (int c = 0; c < grid_.width; ++c) {
        const std::size_t i = grid_.index(c, r);
        const std::uint16_t depthMm = grid_.depthMm[i];
        const float above = 0.001F * depthMm * positions_.slope(c, r) + height;
        if (depthMm != 0 && above < kFloorThickness + floorNoise_[depthMm] * height) kinds_[i] = CellKind::kFloor;
      }
    }
  }
  walls_.mark(grid_, kinds_);
  background_.classify(grid_, kinds_);
}

/// Surfaces in front of unknown background that are part person and part room, as the network sees them, are divided.
/// Beside furniture it doubts legs: what goes on from a person at the same depth, low enough and not denied, is theirs
/// once a body explains them. Before, it is left open: the background does not learn it.
/// @return whether there are any
bool PeopleFinder::takeFurnitureOff() {
  const std::span<const std::int16_t> logits = evidence_.logits();
  const std::span<const std::int32_t> label = finder_.labels();
  const std::span<const DepthComponent> all = finder_.components();
  // Whoever the network does not know well is left alone, most of all people half behind others.
  std::ranges::fill(strange_, 0);
  std::ranges::fill(leftOpen_, 0);
  for (std::size_t i = 0; i < label.size(); ++i) {
    if (label[i] < 0) continue;
    if (lastPerson_[i] != 0) strange_[label[i]] += slots_[lastPerson_[i] - 1U].strange;
    if (kinds_[i] == CellKind::kUnknown) leftOpen_[label[i]] += legs_[i] == Leg::kOpen;
  }
  for (std::size_t k = 0; k < all.size(); ++k) {
    const DepthComponent& one = all[k];
    const bool whole =
        isTooNear(one, grid_) || (one.affirmed > kWholeShare * one.cells && 100 * leftOpen_[k] <= one.cells) ||
        (3 * one.affirmed < one.cells && !isOversize(one) && one.area * one.affirmed < kMinVisibleArea * one.cells);
    divided_[k] = !whole && 3 * strange_[k] <= one.cells;
  }
  const auto isDivided = [&](std::size_t i) {
    return label[i] >= 0 && kinds_[i] == CellKind::kUnknown && divided_[label[i]];
  };
  bool any = false;
  for (std::size_t i = 0; i < label.size(); ++i) {
    legs_[i] = Leg::kNone;
    if (!isDivided(i)) continue;
    if (logits[i] < (lastPerson_[i] != 0 ? kLeaves : kJoins)) {
      kinds_[i] = CellKind::kFurniture;
      any = true;
    }
  }
  if (!any || !floor_.found()) return any;
  // From those whom a body explains first.
  for (const bool explained : {true, false}) {
    queue_.clear();
    for (std::size_t i = 0; i < label.size(); ++i) {
      if (!isDivided(i)) continue;
      const bool known = lastPerson_[i] != 0 && slots_[lastPerson_[i] - 1U].confirmed;
      if (known == explained) queue_.push_back(i);
    }
    for (std::size_t next = 0; next < queue_.size(); ++next) {
      const std::size_t i = queue_[next];
      const float step = 500.0F * finder_.step(grid_.depthMm[i]);
      grid_.visitNeighbours(i, [&](std::size_t j) {
        if (kinds_[j] != CellKind::kFurniture || legs_[j] != Leg::kNone || label[j] != label[i]) return;
        if (logits[j] < (explained ? kNoLeg : kOpen)) return;
        if (std::abs(grid_.depthMm[i] - grid_.depthMm[j]) >= step) return;
        if (positions_(grid_, j % grid_.width, j / grid_.width).y() > kLegs) return;
        legs_[j] = explained ? Leg::kTheirs : Leg::kOpen;
        queue_.push_back(j);
      });
    }
  }
  for (std::size_t i = 0; i < label.size(); ++i) {
    if (legs_[i] == Leg::kTheirs) kinds_[i] = CellKind::kUnknown;
  }
  return true;
}

void PeopleFinder::measure() {
  for (PersonSlot& slot : slots_) {
    slot.cells = slot.newCells = slot.affirmed = 0;
    slot.sum.setZero();
    slot.heights.fill(0);
    slot.cutAbove = slot.cutAside = false;
  }
  for (int r = 0; r < grid_.height; ++r) {
    for (int c = 0; c < grid_.width; ++c) {
      const std::size_t i = grid_.index(c, r);
      if (person_[i] == 0) continue;
      PersonSlot& slot = slots_[person_[i] - 1U];
      const Vec3f position = positions_(grid_, c, r);
      ++slot.cells;
      slot.newCells += kinds_[i] == CellKind::kNew;
      slot.affirmed += evidence_.logits()[i] > 0;
      slot.sum += position;
      slot.cutAbove = slot.cutAbove || r <= grid_.firstRow + 1;
      slot.cutAside = slot.cutAside || c <= grid_.firstColumn + 1 || c >= grid_.lastColumn - 1;
      ++slot.heights[std::clamp(static_cast<int>((position.y() + kBinsFrom) * kBinsPerMetre), 0, kHeightBins - 1)];
    }
  }
  for (int k = 0; k < kPersonSlots; ++k) {
    PersonSlot& slot = slots_[k];
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
      const double since = time_ - slot.lastSeen;
      if (since > kPauseFrom && since < kPauseTo) {
        const Vec3f velocity = (middle - slot.middle) / static_cast<float>(since);
        slot.velocity += kVelocityShare * (velocity - slot.velocity);
        if (slot.velocity.norm() > kFastestPerson) slot.velocity *= kFastestPerson / slot.velocity.norm();
      } else {
        slot.velocity.setZero();
      }
      slot.middle = middle;
      slot.lastSeen = time_;
      if (slot.born == time_) moves_.remember(grid_, person_, k);
      if (slot.moved || cameraMoves_) continue;
      const bool isMoving = kOfCells * slot.newCells > kNewCells * slot.cells || moves_.hasMoved(grid_, person_, k);
      slot.movingFrames = isMoving ? slot.movingFrames + 1 : 0;
      slot.moved = slot.movingFrames >= kMovingFrames;
    } else if (time_ - slot.lastSeen > (slot.moved || slot.confirmed ? kRemembered : kDoubtful)) {
      slot = PersonSlot{};
    }
  }
}

/// The network was shown few people behind others: of those it is not asked.
void PeopleFinder::doubtHidden() {
  const Vec3f origin = floorFromCamera_.translation().cast<float>();
  for (PersonSlot& slot : slots_) {
    if (!slot.seen) continue;
    Vec3f away = slot.middle - origin;
    away.y() = 0.0F;
    for (const PersonSlot& other : slots_) {
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
void PeopleFinder::giveUpFurniture(bool floorIsNew) {
  for (int k = 0; k < kPersonSlots; ++k) {
    PersonSlot& slot = slots_[k];
    if (!slot.seen || slot.moved) continue;
    const double age = time_ - slot.born;
    const bool low =
        floorIsNew && !slot.cutAbove && slot.top < kMinHeight && slot.cells * kSmallPart < countOf(person_);
    const auto looksHuman = [&] {
      return slot.confirmed || hasHeadAndShoulders(grid_, positions_, person_, k, slot.top, slot.cutAside);
    };
    const bool likely = age < kStillSeconds || (age < kPersonSeconds && looksHuman());
    if (!low && likely) continue;
    makeBackground(k);
  }
}

void PeopleFinder::makeBackground(int k) {
  for (std::size_t i = 0; i < person_.size(); ++i) {
    if (person_[i] != k + 1) continue;
    person_[i] = 0;
    background_.absorb(grid_, i);
  }
  owners_.refuse(slots_[k].middle, time_);
  slots_[k] = PersonSlot{};
}

void PeopleFinder::explainCells(int k, const fit::PosedModel& body) {
  // Where the body is in the image.
  const Isometry3 cameraFromFloor = floorFromCamera_.inverse();
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
  for (const fit::ShapedCapsule& capsule : body.capsule) {
    const Vec3 middle = cameraFromFloor * capsule.middle.cast<double>();
    const double depth = std::max(kNearestBody, -middle.z());
    const double reach = (capsule.reach + kFar) * camera_.focalX() / depth;
    const double x = 0.5 * camera_.width + camera_.focalX() * middle.x() / depth;
    const double y = 0.5 * camera_.height - camera_.focalY() * middle.y() / depth;
    left = std::min(left, x - reach);
    right = std::max(right, x + reach);
    top = std::min(top, y - reach);
    bottom = std::max(bottom, y + reach);
  }
  const std::uint8_t mine = k + 1;
  for (int r = 0; r < grid_.height; ++r) {
    for (int c = 0; c < grid_.width; ++c) {
      const std::size_t i = grid_.index(c, r);
      const bool was = person_[i] == mine;
      const double x = c * grid_.step, y = r * grid_.step;
      const bool within = x > left && x < right && y > top && y < bottom;
      if (kinds_[i] == CellKind::kNone || (!was && (!within || person_[i] != 0)) || kinds_[i] == CellKind::kNew)
        continue;
      if (kinds_[i] == CellKind::kFloor || kinds_[i] == CellKind::kWall || kinds_[i] == CellKind::kFurniture) continue;
      const Vec3f position = positions_(grid_, c, r);
      float nearest = kFar;
      for (const fit::ShapedCapsule& capsule : body.capsule) {
        if ((position - capsule.middle).norm() - capsule.reach >= nearest) continue;
        nearest = std::min(nearest, std::abs(fit::distanceTo(body, capsule, position).distance));
      }
      if (was && nearest >= kFar) lastPerson_[i] = 0;
      if (!was && nearest < kNear && evidence_.logits()[i] > kNever) {
        lastPerson_[i] = mine;
        if (kinds_[i] == CellKind::kBackground) background_.forget(i);
      }
    }
  }
}

/// A piece in front of unknown background that the body does not explain, such as a chair or someone else's leg, is no
/// longer the person's by having been theirs.
void PeopleFinder::explainPieces(int k, const fit::PosedModel& body) {
  const std::span<const DepthComponent> all = finder_.components();
  const std::span<const std::int32_t> label = finder_.labels();
  for (std::size_t component = 0; component < all.size(); ++component) {
    const DepthComponent& one = all[component];
    const bool isNew = 2 * one.newCells > one.cells, main = 2 * one.cells > slots_[k].cells;
    if (!owners_.isOf(component, k) || isNew || main) continue;
    const auto each = [&](const auto& act) {
      for (int r = one.top; r <= one.bottom; ++r) {
        for (int c = one.left; c <= one.right; ++c) {
          if (label[grid_.index(c, r)] == static_cast<std::int32_t>(component)) act(c, r);
        }
      }
    };
    int far = 0;
    each([&](int c, int r) {
      const Vec3f position = positions_(grid_, c, r);
      const auto isNear = [&](const fit::ShapedCapsule& capsule) {
        return (position - capsule.middle).norm() - capsule.reach < kFar &&
               std::abs(fit::distanceTo(body, capsule, position).distance) < kFar;
      };
      far += std::ranges::none_of(body.capsule, isNear);
    });
    if (2 * far > one.cells) each([&](int c, int r) { lastPerson_[grid_.index(c, r)] = 0; });
  }
}

/// True for a person who has moved or stands free. Something cut off by the image's top or sides may also be a shelf:
/// it must show head and shoulders. What hangs together with the room and stands still, such as a chair before a
/// partition, needs a few cells that the network knows, unless it is too near for that.
bool PeopleFinder::looksLikePerson(const PersonSlot& slot) const {
  if (slot.moved) return true;
  if (slot.attached && slot.affirmed < kFewKnown * slot.cells && horizontally(slot.middle) > kNearestKnown)
    return false;
  if (!slot.cutAbove && !slot.cutAside) return true;
  return hasHeadAndShoulders(grid_, positions_, person_, static_cast<int>(&slot - slots_.data()), slot.top,
                             slot.cutAside);
}

/// Reports the nearest people, moving ones first; people already reported are kept.
void PeopleFinder::report() {
  int reported = 0;
  for (const PersonSlot& slot : slots_) reported += slot.used && slot.reported;
  for (;;) {
    PersonSlot* next = nullptr;
    PersonSlot* min = nullptr;
    const auto before = [](const PersonSlot& a, const PersonSlot& b) {
      if (a.moved != b.moved) return a.moved;
      return std::hypot(a.middle.x(), a.middle.z()) < std::hypot(b.middle.x(), b.middle.z());
    };
    for (PersonSlot& slot : slots_) {
      if (!slot.used) continue;
      if (slot.reported) {
        if (min == nullptr || before(*min, slot)) min = &slot;
      } else if (slot.seen && (next == nullptr || before(slot, *next)) && looksLikePerson(slot)) {
        next = &slot;
      }
    }
    if (next == nullptr) return;
    if (reported == maxPeople_) {
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
          std::ranges::any_of(slots_, [&](const PersonSlot& slot) { return slot.used && slot.user == user; });
      if (!given) next->user = user;
    }
  }
}

/// The output: people by increasing number.
void PeopleFinder::paint(std::span<const std::uint16_t> depthMm) {
  people_.clear();
  std::array<std::uint8_t, kPersonSlots> numbers{};
  for (;;) {
    const PersonSlot* next = nullptr;
    for (const PersonSlot& slot : slots_) {
      if (!slot.used || !slot.seen || !slot.reported) continue;
      if (!people_.empty() && slot.user <= people_.back().user) continue;
      if (next == nullptr || slot.user < next->user) next = &slot;
    }
    if (next == nullptr) break;
    PersonSegment segment;
    segment.user = next->user;
    segment.middle = next->middle.cast<double>();
    segment.moved = next->moved;
    // If the network knows somebody connected to the room, it is certain which pixels are theirs.
    segment.attached = next->attached && (next->strange || next->affirmed < kStrange * next->cells);
    people_.push_back(segment);
    numbers[next - slots_.data()] = people_.size();
  }
  labelPixels(depthMm, numbers);
}

/// A pixel belongs to the neighbouring surface that matches its depth best.
/// @param numbers  for each slot the label of its pixels, 0 if it is not shown
void PeopleFinder::labelPixels(std::span<const std::uint16_t> depthMm, std::span<const std::uint8_t> numbers) {
  for (std::size_t i = 0; i < labels_.size(); ++i) labels_[i] = depthMm[i] == 0 ? 255 : 0;
  if (people_.empty()) return;

  const std::size_t stride = grid_.imageWidth();
  for (int r = 0; r < grid_.height; ++r) {
    for (int c = 0; c < grid_.width; ++c) {
      // Most cells are surrounded by cells of the same label.
      const int left = std::max(c - 1, 0), right = std::min(c + 1, grid_.width - 1);
      const int above = std::max(r - 1, 0), below = std::min(r + 1, grid_.height - 1);
      const std::size_t cell = grid_.index(c, r);
      const std::uint8_t own = person_[cell];
      bool same = true;
      for (int y = above; y <= below && same; ++y) {
        for (int x = left; x <= right; ++x) same = same && person_[grid_.index(x, y)] == own;
      }
      if (same && own == 0) continue;
      for (int dy = 0; dy < grid_.step; ++dy) {
        for (int dx = 0; dx < grid_.step; ++dx) {
          const std::size_t pixel = static_cast<std::size_t>(r * grid_.step + dy) * stride + (c * grid_.step + dx);
          const int depth = depthMm[pixel];
          if (depth == 0) continue;
          std::uint8_t slot = own;
          const float step = 1000.0F * finder_.step(depth);
          int nearest = std::abs(depth - grid_.depthMm[cell]);
          if (!same && nearest > 0.5F * step) {
            for (int y = above; y <= below; ++y) {
              for (int x = left; x <= right; ++x) {
                const std::size_t other = grid_.index(x, y);
                const int off = std::abs(depth - grid_.depthMm[other]);
                if (off >= nearest) continue;
                nearest = off;
                slot = person_[other];
              }
            }
          }
          // Noise within a person still belongs to the person; a hole in the middle does not.
          if (nearest > (same ? 3.0F : 1.0F) * step) slot = 0;
          if (slot == 0 || numbers[slot - 1U] == 0) continue;
          labels_[pixel] = numbers[slot - 1U];
          ++people_[numbers[slot - 1U] - 1U].pixelCount;
        }
      }
    }
  }
}

void PeopleFinder::find(const DepthFrame& frame) {
  LORICA_CHECK(frame.depthMm.size() == labels_.size(), "the depth image must have the camera's size");
  elapsed_ = started_ ? std::clamp(frame.time - time_, 0.0, kLongestFrame) : 0.0;
  time_ = frame.time;
  started_ = true;
  grid_.fill(frame.depthMm);
  const bool floorBefore = floor_.found();
  const bool cameraMoves = motion_.update(grid_, lastDepthMm_, lastPerson_, time_);
  if (cameraMoves && !cameraMoves_) background_.forget();
  cameraMoves_ = cameraMoves;
  floor_.update(grid_, cameraMoves);
  walls_.update(grid_, floor_.up().cast<float>(), cameraMoves);
  const bool floorIsNew = floor_.found() && !floorBefore;
  floorFromCamera_ = floor_.floorFromCamera();
  positions_.set(grid_, floorFromCamera_);
  classify();
  evidence_.update(grid_, positions_, floor_.found());
  for (std::size_t i = 0; i < kinds_.size(); ++i) {
    if (kinds_[i] != CellKind::kBackground || background_.isSettled(i)) continue;
    if (evidence_.logits()[i] > kUnlearns) kinds_[i] = CellKind::kUnknown;
  }
  const LastCells last{lastPerson_, lastDepthMm_};
  finder_.find(grid_, positions_, kinds_, last, evidence_.logits());
  if (takeFurnitureOff()) finder_.find(grid_, positions_, kinds_, last, evidence_.logits());
  const bool looking = frameCount_++ % kHeadPause == 0;
  const std::span<const FoundHead> heads =
      looking ? headFinder_.find(grid_, positions_, floor_.found()) : std::span<const FoundHead>();
  owners_.share(
      {grid_, positions_, finder_, kinds_, last, heads, looking, floorFromCamera_, floor_.found(), time_, elapsed_},
      slots_);
  for (const std::uint32_t cell : owners_.uncovered()) background_.forget(cell);
  measure();
  doubtHidden();
  giveUpFurniture(floorIsNew);

  // The background is learnt from what certainly belongs to nobody.
  const std::span<const std::int32_t> label = finder_.labels();
  for (std::size_t i = 0; i < taken_.size(); ++i) {
    const bool maybe = label[i] >= 0 && owners_.mayBeSomeone(label[i]);
    taken_[i] = person_[i] != 0 || maybe || legs_[i] == Leg::kOpen ||
                (evidence_.logits()[i] > 0 && kinds_[i] >= CellKind::kBackground);
  }
  if (!cameraMoves_) background_.learn(grid_, kinds_, taken_);
  report();
  paint(frame.depthMm);
  std::ranges::copy(person_, lastPerson_.begin());
  lastDepthMm_ = grid_.depthMm;
}

void PeopleFinder::confirm(int user) {
  for (PersonSlot& slot : slots_) slot.confirmed = slot.confirmed || (slot.used && slot.user == user);
}

void PeopleFinder::explain(int user, const fit::PosedModel& body) {
  for (int k = 0; k < kPersonSlots; ++k) {
    const PersonSlot& slot = slots_[k];
    if (!slot.used || slot.user != user) continue;
    if (slot.attached) {
      explainCells(k, body);
    } else {
      explainPieces(k, body);
    }
  }
}

void PeopleFinder::reject(int user) {
  for (int k = 0; k < kPersonSlots; ++k) {
    if (!slots_[k].used || slots_[k].user != user) continue;
    makeBackground(k);
    std::ranges::replace(lastPerson_, static_cast<std::uint8_t>(k + 1), std::uint8_t{0});
  }
}

}  // namespace lorica
