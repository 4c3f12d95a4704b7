#include "capture/sensor/openni.h"

#include "capture/sensor/openni_library.h"
#include "geometry/errors.h"

#include <dlfcn.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <system_error>
#include <thread>
#include <utility>

/// The part of NiTE 2.2's C interface in use, with its binary layout.
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

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr double kMillimetre = 1e-3;
constexpr double kFootHeight = 0.08;  ///< of the ankle above the floor [m]
constexpr float kSure = 0.5F;
constexpr std::chrono::milliseconds kPause(100);    ///< between checks for an unplugged camera
constexpr std::chrono::milliseconds kSilence(500);  ///< after this time without a frame, nobody is assumed to be there

/// NiTE 2 looks from behind the camera: x to the left, y up, z away from it. Converted by half a turn about y.
Vec3 positionOf(const nite::Vector& p) {
  return kMillimetre * Vec3(-p.x, p.y, -p.z);
}
Vec3 directionOf(const nite::Vector& p) {
  return {-p.x, p.y, -p.z};
}

class NiteSource final : public SkeletonSource {
 public:
  NiteSource(std::shared_ptr<OpenNiLibrary> openNi, std::string name)
      : openNi_(std::move(openNi)), name_(std::move(name)) {}
  ~NiteSource() override {
    endTracker();
    if (initialized_) api_.shutdown();
    closeDevice();
    // The library stays loaded: its threads may need its code after shutdown.
  }
  NiteSource(const NiteSource&) = delete;
  NiteSource& operator=(const NiteSource&) = delete;

  Result<void> start(const fs::path& library, const std::string& uri) {
    std::error_code error;
    const fs::path file = fs::canonical(library, error);
    if (error) return notFound("{}: found no such file, expected libNiTE2.so", name_);
    void* handle = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (handle == nullptr) return unreadable("{}: cannot be loaded: {}", name_, loaderProblem());
    const auto load = [&](const char* name, auto& function) { return loadSymbol(handle, name, function); };
    if (!load("niteInitialize", api_.initialize) || !load("niteShutdown", api_.shutdown) ||
        !load("niteInitializeUserTrackerByDevice", api_.createTracker) ||
        !load("niteShutdownUserTracker", api_.destroyTracker) ||
        !load("niteStartSkeletonTracking", api_.startSkeleton) ||
        !load("niteStopSkeletonTracking", api_.stopSkeleton) ||
        !load("niteRegisterUserTrackerCallbacks", api_.addCallbacks) ||
        !load("niteUnregisterUserTrackerCallbacks", api_.removeCallbacks) ||
        !load("niteReadUserTrackerFrame", api_.readFrame) || !load("niteUserTrackerFrameRelease", api_.releaseFrame)) {
      ::dlclose(handle);
      return unsupported("{}: not a NiTE 2 library: some of its functions are missing", name_);
    }

    LORICA_TRY(const std::vector<OpenNiCamera> cameras, openNi_->cameras());
    const auto camera = std::find_if(cameras.begin(), cameras.end(),
                                     [&](const OpenNiCamera& c) { return uri.empty() || c.uri == uri; });
    if (camera == cameras.end()) {
      return notFound("{}: found no camera {}, expected a connected camera", name_, uri);
    }
    camera_ = *camera;
    LORICA_TRY_DO(openDevice());

    const WorkingFolder keep;
    fs::current_path(file.parent_path(), error);  // NiTE 2 looks for its data in the working folder
    if (const int status = api_.initialize(); status != nite::kOk) {
      return unreadable("{}: cannot be started (status {}): is its data folder NiTE2 beside it?", name_, status);
    }
    initialized_ = true;
    return beginTracker();
  }

  Result<std::optional<SkeletonFrame>> next() override {
    if (tracker_ == nullptr && !comeBack()) {
      std::this_thread::sleep_for(kPause);
      return std::optional<SkeletonFrame>(nobody());
    }
    if (!waitForFrame()) {
      if (openNi_->isGone(camera_.uri)) {
        endTracker();
        closeDevice();
      }
      return std::optional<SkeletonFrame>(nobody());
    }
    nite::Frame* frame = nullptr;
    if (const int status = api_.readFrame(tracker_, &frame); status != nite::kOk || frame == nullptr) {
      return unreadable("{}: cannot read a frame (status {})", name_, status);
    }
    SkeletonFrame skeleton = read(*frame);
    (void)api_.releaseFrame(tracker_, frame);
    return std::optional<SkeletonFrame>(std::move(skeleton));
  }

 private:
  Result<void> openDevice() {
    OniDeviceHandle device = nullptr;
    if (openNi_->api().deviceOpen(camera_.uri.c_str(), &device) != ONI_STATUS_OK) {
      return openNi_->failure(fmt::format("{}: cannot be opened", camera_.uri));
    }
    device_.handle = device;
    return {};
  }

  void closeDevice() {
    if (device_.handle != nullptr) (void)openNi_->api().deviceClose(static_cast<OniDeviceHandle>(device_.handle));
    device_.handle = nullptr;
  }

  Result<void> beginTracker() {
    const int status = api_.createTracker(&device_, &tracker_);
    if (status != nite::kOk || tracker_ == nullptr) {
      tracker_ = nullptr;
      return unreadable("{}: cannot track with {} (status {})", name_, camera_.uri, status);
    }
    if (api_.addCallbacks(tracker_, &callbacks_, this) != nite::kOk) {
      (void)api_.destroyTracker(std::exchange(tracker_, nullptr));
      return unreadable("{}: cannot report when a frame is ready", name_);
    }
    clock_.restart();
    return {};
  }

  void endTracker() {
    if (tracker_ == nullptr) return;
    for (const std::int16_t user : asked_) api_.stopSkeleton(tracker_, user);
    asked_.clear();
    person_ = 0;
    api_.removeCallbacks(tracker_, &callbacks_);
    (void)api_.destroyTracker(std::exchange(tracker_, nullptr));
    const std::lock_guard<std::mutex> lock(mutex_);
    frameIsReady_ = false;
  }

  bool comeBack() {
    if (openNi_->isGone(camera_.uri)) return false;
    if (openDevice() && beginTracker()) return true;
    closeDevice();
    return false;
  }

  /// @return whether a frame is ready; false if the camera is gone, or silent for long
  bool waitForFrame() {
    const auto until = std::chrono::steady_clock::now() + kSilence;
    std::unique_lock<std::mutex> lock(mutex_);
    while (!frameIsReady_) {
      if (openNi_->isGone(camera_.uri) || std::chrono::steady_clock::now() >= until) return false;
      frameCame_.wait_for(lock, kPause);
    }
    frameIsReady_ = false;
    return true;
  }

  /// A frame in which nobody is tracked, at the current time.
  SkeletonFrame nobody() {
    SkeletonFrame skeleton;
    skeleton.time = clock_.timeWithout();
    skeleton.user = std::max<int>(person_, 1);
    return skeleton;
  }

  SkeletonFrame read(const nite::Frame& frame) {
    const std::span<const nite::User> users(frame.users, frame.users == nullptr ? 0 : std::max(0, frame.userCount));
    const nite::User* chosen = nullptr;
    std::set<std::int16_t> here;
    for (const nite::User& user : users) {
      here.insert(user.id);
      if (user.skeleton.state == nite::kNotAskedFor && asked_.insert(user.id).second) {
        if (api_.startSkeleton(tracker_, user.id) != nite::kOk) asked_.erase(user.id);  // requested again next time
      }
      if (user.skeleton.state != nite::kTracked) continue;
      const bool isThePerson = user.id == person_;
      if (chosen == nullptr || isThePerson || (chosen->id != person_ && user.id < chosen->id)) chosen = &user;
    }
    std::erase_if(asked_, [&](std::int16_t user) { return here.count(user) == 0; });  // numbers are reused

    SkeletonFrame skeleton;
    skeleton.time = clock_.timeOf(1e-6 * frame.timeUs);
    if (chosen == nullptr) {
      skeleton.user = std::max<int>(person_, 1);
      return skeleton;
    }
    person_ = chosen->id;
    skeleton.user = person_;
    for (std::size_t j = 0; j < skeleton.joints.size(); ++j) skeleton.joints[j] = jointOf(chosen->skeleton.joints[j]);
    findFloor(frame, skeleton);
    for (TrackedJoint& joint : skeleton.joints) {
      if (joint.confidence <= 0.0) continue;
      joint.position = floorFromCamera_ * joint.position;
      if (joint.orientation) *joint.orientation = Quat(floorFromCamera_.rotation()) * *joint.orientation;
    }
    return skeleton;
  }

  static TrackedJoint jointOf(const nite::Joint& from) {
    TrackedJoint joint;
    const Vec3 position = positionOf(from.position);
    if (!position.allFinite() || !(from.positionConfidence > 0.0F)) return joint;
    joint.position = position;
    joint.confidence = std::min<double>(1.0, from.positionConfidence);
    const nite::Quaternion& q = from.orientation;
    const Quat turned(q.w, -q.x, q.y, -q.z);  // the same half turn
    if (from.orientationConfidence >= kSure && std::abs(turned.norm() - 1.0) < 0.05)
      joint.orientation = turned.normalized();
    return joint;
  }

  void findFloor(const nite::Frame& frame, const SkeletonFrame& skeleton) {
    const Vec3 normal = directionOf(frame.floorNormal);
    const Vec3 point = positionOf(frame.floorPoint);
    const bool upright =
        normal.allFinite() && point.allFinite() && normal.norm() > 0.5 && normal.normalized().y() > 0.7;
    if (frame.floorConfidence >= kSure && upright) {
      const Quat turn = rotationBetween(normal, Vec3::UnitY());
      floorFromCamera_ = Isometry3::Identity();
      floorFromCamera_.linear() = turn.toRotationMatrix();
      floorFromCamera_.translation().y() = -(turn * point).y();
      floorKnown_ = true;
    }
    if (floorKnown_) return;
    for (const BodyJoint foot : {BodyJoint::kLeftFoot, BodyJoint::kRightFoot}) {
      if (skeleton[foot].confidence >= kSure) lowestFoot_ = std::min(lowestFoot_, skeleton[foot].position.y());
    }
    if (lowestFoot_ < std::numeric_limits<double>::max())
      floorFromCamera_.translation().y() = kFootHeight - lowestFoot_;
  }

  std::shared_ptr<OpenNiLibrary> openNi_;
  std::string name_;
  nite::Api api_{};
  nite::Device device_{};
  nite::Tracker tracker_ = nullptr;
  bool initialized_ = false;
  OpenNiCamera camera_;
  nite::Callbacks callbacks_{[](void* self) {
    auto& source = *static_cast<NiteSource*>(self);
    const std::lock_guard<std::mutex> lock(source.mutex_);
    source.frameIsReady_ = true;
    source.frameCame_.notify_one();
  }};
  std::mutex mutex_;  ///< never held while NiTE 2 is called: its threads call the callback
  std::condition_variable frameCame_;
  bool frameIsReady_ = false;
  std::set<std::int16_t> asked_;  ///< users whose skeletons were requested
  std::int16_t person_ = 0;
  CameraClock clock_;  ///< a restarted tracker may count from 0
  Isometry3 floorFromCamera_ = Isometry3::Identity();
  bool floorKnown_ = false;
  double lowestFoot_ = std::numeric_limits<double>::max();
};

}  // namespace

Result<std::unique_ptr<SkeletonSource>> makeNiteSource(std::shared_ptr<OpenNi> openNi, const fs::path& library,
                                                       const std::string& uri) {
  auto running = std::dynamic_pointer_cast<OpenNiLibrary>(std::move(openNi));
  LORICA_CHECK(running != nullptr, "NiTE 2 needs a running OpenNI2");
  auto source = std::make_unique<NiteSource>(std::move(running), library.string());
  LORICA_TRY_DO(source->start(library, uri));
  return std::unique_ptr<SkeletonSource>(std::move(source));
}

}  // namespace lorica
