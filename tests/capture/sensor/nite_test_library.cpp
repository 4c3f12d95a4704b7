// A mock library with the NiTE 2 entry points that Lorica calls, in NiTE 2's own layout. It repeats a fixed sequence of
// ten frames, a hundred milliseconds each:
//   0     nobody; no floor yet
//   1     user 5 appears; 2 the skeleton is calibrated; from 3 on it is tracked
//   5     user 2 is there and tracked, too
//   8     user 5 is lost
// The floor is known from frame 4 on, 1 m below a camera that looks 0.1 rad down.

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>

extern "C" {

typedef struct {
  float x, y, z;
} NitePoint3f;
typedef struct {
  float x, y, z, w;
} NiteQuaternion;
typedef struct {
  int jointType;
  NitePoint3f position;
  float positionConfidence;
  NiteQuaternion orientation;
  float orientationConfidence;
} NiteSkeletonJoint;
typedef struct {
  NiteSkeletonJoint joints[15];
  int state;
} NiteSkeleton;
typedef struct {
  int type;
  int state;
} NitePoseData;
typedef struct {
  short id;
  NitePoint3f boxMin, boxMax, centerOfMass;
  int state;
  NiteSkeleton skeleton;
  NitePoseData poses[2];
} NiteUserData;
typedef struct {
  short* pixels;
  int width, height, stride;
} NiteUserMap;
typedef struct {
  int userCount;
  NiteUserData* pUser;
  NiteUserMap userMap;
  void* pDepthFrame;
  unsigned long long timestamp;
  int frameIndex;
  float floorConfidence;
  NitePoint3f floorPoint, floorNormal;
} NiteUserTrackerFrame;

/// Call counts: {initialize, shutdown, trackers created, destroyed, frames read, released, skeletons started, stopped}.
int niteTestCalls[8];
/// Whether niteInitialize was called in the folder with its data.
int niteTestHadData;

int niteInitialize() {
  ++niteTestCalls[0];
  niteTestHadData = std::filesystem::exists("NiTE2/data") ? 1 : 0;
  return niteTestHadData ? 0 : 1;
}
void niteShutdown() {
  ++niteTestCalls[1];
}

/// Simulates a camera that is gone: no frame is ready any more.
int niteTestIsSilent;

typedef struct {
  void (*readyForNextFrame)(void*);
} NiteUserTrackerCallbacks;

static NiteUserTrackerCallbacks* g_callbacks;
static void* g_cookie;

static void sayReady() {
  if (g_callbacks != nullptr && niteTestIsSilent == 0) g_callbacks->readyForNextFrame(g_cookie);
}

int niteRegisterUserTrackerCallbacks(void*, NiteUserTrackerCallbacks* callbacks, void* cookie) {
  g_callbacks = callbacks;
  g_cookie = cookie;
  sayReady();
  return 0;
}
void niteUnregisterUserTrackerCallbacks(void*, NiteUserTrackerCallbacks* callbacks) {
  if (callbacks == g_callbacks) g_callbacks = nullptr;
}

static short g_asked[2];
static int g_number;

int niteInitializeUserTrackerByDevice(void* device, void** tracker) {
  void* handle = static_cast<void**>(device)[1];  // after the playback control of openni::Device
  if (handle == nullptr) return 1;
  ++niteTestCalls[2];
  g_number = 0;
  g_asked[0] = g_asked[1] = 0;
  *tracker = &g_number;
  return 0;
}
int niteShutdownUserTracker(void*) {
  ++niteTestCalls[3];
  return 0;
}
int niteStartSkeletonTracking(void*, short user) {
  ++niteTestCalls[6];
  g_asked[user == 5 ? 0 : 1] = user;
  return 0;
}
void niteStopSkeletonTracking(void*, short) {
  ++niteTestCalls[7];
}

static NiteUserData person(short id, int state, float shift) {
  NiteUserData user;
  std::memset(&user, 0x77, sizeof user);  // nonzero fill for the fields that must not be read
  user.id = id;
  user.skeleton.state = g_asked[id == 5 ? 0 : 1] == id ? state : 0;
  for (int j = 0; j < 15; ++j) {
    NiteSkeletonJoint& joint = user.skeleton.joints[j];
    joint.jointType = j;
    joint.position = {100.0F * static_cast<float>(j) + shift, 50.0F * static_cast<float>(j) - 400.0F, 2000.0F};
    joint.positionConfidence = j == 7 ? 0.0F : j == 6 ? 0.5F : 1.0F;
    const float half = 0.05F * static_cast<float>(j);
    joint.orientation = {0.6F * std::sin(half), 0.0F, 0.8F * std::sin(half), std::cos(half)};
    joint.orientationConfidence = j % 2 == 0 ? 1.0F : 0.0F;
  }
  return user;
}

int niteReadUserTrackerFrame(void*, NiteUserTrackerFrame** out) {
  const int n = g_number++ % 10;
  ++niteTestCalls[4];
  auto* frame = new NiteUserTrackerFrame();
  frame->pUser = new NiteUserData[2];
  if (n >= 1 && n < 8) frame->pUser[frame->userCount++] = person(5, n >= 3 ? 2 : 1, 0.0F);
  if (n >= 5) frame->pUser[frame->userCount++] = person(2, 2, 1000.0F);
  frame->timestamp = 100000ULL * static_cast<unsigned long long>(g_number);
  frame->frameIndex = g_number;
  frame->floorConfidence = n >= 4 ? 1.0F : 0.0F;
  frame->floorPoint = {0.0F, -1000.0F * std::cos(0.1F), 1000.0F * std::sin(0.1F)};
  frame->floorNormal = {0.0F, std::cos(0.1F), -std::sin(0.1F)};
  *out = frame;
  return 0;
}
int niteUserTrackerFrameRelease(void*, NiteUserTrackerFrame* frame) {
  ++niteTestCalls[5];
  delete[] frame->pUser;
  delete frame;
  sayReady();
  return 0;
}
}
