#pragma once

#include "capture/sensor/depth_frame.h"
#include "capture/tracking/fit/body_model.h"
#include "capture/tracking/people/background.h"
#include "capture/tracking/people/camera_motion.h"
#include "capture/tracking/people/components.h"
#include "capture/tracking/people/depth_grid.h"
#include "capture/tracking/people/head_finder.h"
#include "capture/tracking/people/person_evidence.h"
#include "capture/tracking/people/person_owners.h"
#include "capture/tracking/people/room_planes.h"
#include "geometry/math.h"

#include <cstdint>
#include <span>
#include <vector>

namespace lorica {

/// One person's pixels in one frame.
struct PersonSegment {
  int user = 1;  ///< kept from frame to frame while the person is seen, and for two seconds after
  int pixelCount = 0;
  Vec3 middle = Vec3::Zero();  ///< of its points, floor frame [m]
  bool moved = false;          ///< since found; furniture does not move
  bool attached = false;       ///< connected to the room: which pixels are the person's is uncertain, see explain()
};

/// Finds the floor, removes the background, and separates people from it and from each other. See Tracker for frames.
///
/// Use one instance per camera, because it keeps state. Does not allocate after the first frames.
class PeopleFinder {
 public:
  PeopleFinder(const DepthCamera& camera, int maxPeople);
  PeopleFinder(const PeopleFinder&) = delete;
  PeopleFinder& operator=(const PeopleFinder&) = delete;

  /// @param frame  width x height of the camera
  void find(const DepthFrame& frame);

  /// A body explains what is seen of this person: they are one person, and no furniture.
  void confirm(int user);
  /// Of someone connected to the room, what the body explains is the person's from the next frame on, the rest the
  /// room's, unless it moves. Of anyone else, pieces apart from the rest that it does not explain may be another's.
  /// @param body  fitted to the last frame, floor frame
  void explain(int user, const fit::PosedModel& body);
  /// What was taken for this person is furniture: it becomes background.
  /// @param user  of the last frame
  void reject(int user);

  /// By increasing user number.
  [[nodiscard]] std::span<const PersonSegment> people() const { return people_; }
  /// width x height: 0 background, 255 not measured, else the index in people() + 1.
  [[nodiscard]] std::span<const std::uint8_t> labels() const { return labels_; }
  [[nodiscard]] const Isometry3& floorFromCamera() const { return floorFromCamera_; }
  [[nodiscard]] bool floorFound() const { return floor_.found(); }

 private:
  void classify();
  bool takeFurnitureOff();
  void measure();
  void doubtHidden();
  void giveUpFurniture(bool floorIsNew);
  void makeBackground(int slot);
  void explainCells(int slot, const fit::PosedModel& body);
  void explainPieces(int slot, const fit::PosedModel& body);
  void report();
  void paint(std::span<const std::uint16_t> depthMm);
  void labelPixels(std::span<const std::uint16_t> depthMm, std::span<const std::uint8_t> numbers);
  [[nodiscard]] bool looksLikePerson(const PersonSlot& slot) const;

  DepthCamera camera_;
  int maxPeople_;
  DepthGrid grid_;
  FloorFinder floor_;
  WallFinder walls_;
  FloorPositions positions_;
  CameraMotion motion_;
  Background background_;
  PersonEvidence evidence_;
  HeadFinder headFinder_;
  ComponentFinder finder_;
  PersonOwners owners_;
  PersonMoves moves_;
  DepthTable floorNoise_;  ///< of heights over the floor, for a camera 1 m up [m]
  /// What the network denies but may be a leg: a person's, or left open until a body explains them.
  enum class Leg : std::uint8_t { kNone, kOpen, kTheirs };
  std::vector<Leg> legs_;
  std::vector<std::uint32_t> queue_;  ///< cells beside which a leg may go on
  std::vector<int> leftOpen_;         ///< cells of each surface that were left open
  std::vector<bool> divided_;         ///< surfaces that are part person and part room
  std::vector<int> strange_;          ///< cells of each surface that were of people whom the network does not know
  std::vector<CellKind> kinds_;
  std::span<std::uint8_t> person_;  ///< of the owners: slot + 1
  std::vector<std::uint8_t> lastPerson_;
  std::vector<std::uint8_t> taken_;
  std::vector<std::uint16_t> lastDepthMm_;
  PersonSlots slots_;
  double time_ = 0.0, elapsed_ = 0.0;
  bool started_ = false;
  bool cameraMoves_ = false;
  int frameCount_ = 0;
  std::vector<PersonSegment> people_;
  std::vector<std::uint8_t> labels_;
  Isometry3 floorFromCamera_ = Isometry3::Identity();
};

}  // namespace lorica
