#pragma once

/// The part of NiTE 2.2's C interface in use, with its binary layout. Internal: not installed.

#include "capture/skeleton_frame.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace lorica::nite {

struct Vector {
  float x, y, z;
};

struct Quaternion {
  float x, y, z, w;
};

struct Joint {
  std::int32_t type;
  Vector position;  ///< [mm]
  float positionConfidence;
  Quaternion orientation;
  float orientationConfidence;
};
static_assert(sizeof(Joint) == 40 && offsetof(Joint, orientation) == 20);

inline constexpr std::int32_t kNotAskedFor = 0;
inline constexpr std::int32_t kTracked = 2;

struct Skeleton {
  std::array<Joint, kBodyJointCount> joints;  ///< in BodyJoint's order
  std::int32_t state;
};
static_assert(sizeof(Skeleton) == 604);

struct User {
  std::int16_t id;
  std::array<Vector, 2> box;
  Vector middle;
  std::int32_t state;
  Skeleton skeleton;
  std::array<std::int32_t, 4> poses;
};
static_assert(sizeof(User) == 664 && offsetof(User, skeleton) == 44);

struct Frame {
  std::int32_t userCount;
  const User* users;
  void* labels;
  std::array<std::int32_t, 3> labelSize;
  const void* depth;
  std::uint64_t timeUs;
  std::int32_t number;
  float floorConfidence;
  Vector floorPoint;  ///< [mm]
  Vector floorNormal;
};
static_assert(sizeof(Frame) == 88 && offsetof(Frame, timeUs) == 48 && offsetof(Frame, floorPoint) == 64);

/// Functions that accept a camera expect a C++ object of OpenNI2, from which NiTE 2 reads the handle.
struct Device {
  void* playback;
  void* handle;
  std::array<char, 4096> rest;  ///< larger than the rest of the object
};

inline constexpr int kOk = 0;
using Tracker = void*;

/// Called from a thread of NiTE 2.
struct Callbacks {
  void (*frameIsReady)(void* cookie);
};

struct Api {
  int (*initialize)();
  void (*shutdown)();
  int (*createTracker)(Device*, Tracker*);
  int (*destroyTracker)(Tracker);
  int (*startSkeleton)(Tracker, std::int16_t user);
  void (*stopSkeleton)(Tracker, std::int16_t user);
  int (*addCallbacks)(Tracker, Callbacks*, void* cookie);
  void (*removeCallbacks)(Tracker, Callbacks*);
  int (*readFrame)(Tracker, Frame**);  ///< waits forever if no frame is ready
  int (*releaseFrame)(Tracker, Frame*);
};

}  // namespace lorica::nite
