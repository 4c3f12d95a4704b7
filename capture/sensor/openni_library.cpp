#include "capture/sensor/openni_library.h"

#include "capture/sensor/openni_source.h"
#include "geometry/errors.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <sstream>
#include <string_view>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

/// A loaded libOpenNI2, with the folder that it was loaded from. It stays loaded after OpenNI2 is shut down, because
/// its threads may need its code a little longer, and is unloaded only when other drivers are requested.
struct Loaded {
  ~Loaded() {
    if (handle != nullptr && unload) ::dlclose(handle);
  }
  void* handle = nullptr;
  bool unload = false;  ///< not at the end of the process: other destructors may still call into it
  OpenNiApi api;
  std::unique_ptr<OpenNiStage> stage;
  OpenNiSettings settings;
};

bool same(const OpenNiSettings& a, const OpenNiSettings& b) {
  return a.drivers == b.drivers && a.library == b.library;
}

Error notInstalled() {
  const char* why = dlerror();
  return notFound("OpenNI2 cannot be loaded, expected libOpenNI2.so.0 (package libopenni2-0): {}",
                  why == nullptr ? "unknown" : why);
}

/// Finds the system's libOpenNI2.
Result<fs::path> findLibrary() {
  void* handle = ::dlopen("libOpenNI2.so.0", RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) return notInstalled();
  Dl_info where{};
  void* symbol = ::dlsym(handle, "oniInitialize");
  const bool found = symbol != nullptr && ::dladdr(symbol, &where) != 0 && where.dli_fname != nullptr;
  const fs::path path = found ? fs::path(where.dli_fname) : fs::path();
  ::dlclose(handle);
  std::error_code error;
  const fs::path whole = fs::canonical(path, error);
  if (!found || error) return notFound("libOpenNI2.so.0 was loaded, but its path cannot be determined");
  return whole;
}

template <typename Function>
bool load(void* handle, const char* name, Function& function) {
  function = reinterpret_cast<Function>(::dlsym(handle, name));
  return function != nullptr;
}

bool loadAll(void* handle, OpenNiApi& api) {
  return load(handle, "oniInitialize", api.initialize) && load(handle, "oniShutdown", api.shutdown) &&
         load(handle, "oniGetExtendedError", api.extendedError) && load(handle, "oniGetDeviceList", api.deviceList) &&
         load(handle, "oniReleaseDeviceList", api.releaseDeviceList) &&
         load(handle, "oniRegisterDeviceCallbacks", api.registerCallbacks) &&
         load(handle, "oniUnregisterDeviceCallbacks", api.unregisterCallbacks) &&
         load(handle, "oniDeviceOpen", api.deviceOpen) && load(handle, "oniDeviceClose", api.deviceClose) &&
         load(handle, "oniDeviceGetSensorInfo", api.sensorInfo) &&
         load(handle, "oniDeviceCreateStream", api.createStream) &&
         load(handle, "oniStreamDestroy", api.streamDestroy) && load(handle, "oniStreamStart", api.streamStart) &&
         load(handle, "oniStreamStop", api.streamStop) && load(handle, "oniStreamReadFrame", api.readFrame) &&
         load(handle, "oniFrameRelease", api.frameRelease) && load(handle, "oniWaitForAnyStream", api.wait) &&
         load(handle, "oniStreamSetProperty", api.setProperty) &&
         load(handle, "oniStreamGetProperty", api.getProperty) &&
         load(handle, "oniCreateRecorder", api.createRecorder) &&
         load(handle, "oniRecorderAttachStream", api.recorderAttach) &&
         load(handle, "oniRecorderStart", api.recorderStart) && load(handle, "oniRecorderStop", api.recorderStop) &&
         load(handle, "oniRecorderDestroy", api.recorderDestroy);
}

Result<std::unique_ptr<Loaded>> loadLibrary(const OpenNiSettings& settings) {
  LORICA_TRY(const fs::path library, settings.library.empty() ? findLibrary() : Result<fs::path>(settings.library));
  auto loaded = std::make_unique<Loaded>();
  loaded->settings = settings;
  LORICA_TRY(std::unique_ptr<OpenNiStage> stage, OpenNiStage::make(library, settings.drivers));
  loaded->stage = std::move(stage);
  // Global: NiTE 2 and drivers that use OpenNI2 must find this library.
  loaded->handle = ::dlopen(loaded->stage->library().c_str(), RTLD_NOW | RTLD_GLOBAL);
  if (loaded->handle == nullptr) return notInstalled();
  if (!loadAll(loaded->handle, loaded->api)) {
    return unsupported("{}: not an OpenNI 2.2 library: some of its functions are missing", library.string());
  }
  Dl_info where{};
  const void* symbol = ::dlsym(loaded->handle, "oniInitialize");
  if (::dladdr(symbol, &where) == 0 || loaded->stage->library() != where.dli_fname) {
    return unsupported(
        "libOpenNI2 is already loaded in this process, so no driver can be added: do not link the program with it");
  }
  return loaded;
}

OpenNiCamera cameraOf(const OniDeviceInfo& info) {
  const auto text = [](const char(&field)[ONI_MAX_STR]) {
    std::string out;
    for (const char c : std::string_view(field, ONI_MAX_STR)) {
      if (c == '\0') break;
      out += std::isprint(static_cast<unsigned char>(c)) != 0 ? c : '?';
    }
    return out;
  };
  return {text(info.uri), text(info.vendor), text(info.name), info.usbVendorId, info.usbProductId, {}};
}

/// OpenNI2 does not report which driver provides a camera; its own drivers provide PrimeSense cameras and no others.
std::string driverOf(const OpenNiCamera& camera, const std::vector<OpenNiDriver>& drivers) {
  constexpr std::uint16_t kPrimeSense = 0x1d27;
  const bool own = camera.usbVendor == kPrimeSense || camera.vendor == "PrimeSense";
  std::string names;
  for (const OpenNiDriver& driver : drivers) {
    const std::string name = driver.file.filename().string();
    const bool fits = own ? driver.packaged && name == (camera.name == "PS1080" ? "libPS1080.so.0" : "libPSLink.so.0")
                          : !driver.packaged;
    if (fits) names += (names.empty() ? "" : " or ") + name;
  }
  return names;
}

/// Why OpenNI2 did not load one of its own drivers; empty if it did.
std::string problemOf(const OpenNiDriver& driver) {
  if (void* there = ::dlopen(driver.file.c_str(), RTLD_NOW | RTLD_NOLOAD)) {
    ::dlclose(there);
    return {};
  }
  void* alone = ::dlopen(driver.file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (alone == nullptr) {
    const char* why = dlerror();
    return why == nullptr ? "cannot be loaded" : why;
  }
  ::dlclose(alone);
  return "cannot be started";
}

std::mutex g_mutex;
std::weak_ptr<OpenNiLibrary> g_running;
std::unique_ptr<Loaded> g_loaded;

}  // namespace

Result<std::shared_ptr<OpenNi>> OpenNi::start(const OpenNiSettings& settings) {
  const std::lock_guard<std::mutex> lock(g_mutex);
  if (std::shared_ptr<OpenNiLibrary> running = g_running.lock()) {
    if (same(running->settings(), settings)) return std::shared_ptr<OpenNi>(std::move(running));
    return invalidArgument("OpenNI2 is already running with other drivers, expected the same ones");
  }
  if (g_loaded && !same(g_loaded->settings, settings)) {
    g_loaded->unload = true;
    g_loaded.reset();
  }
  if (!g_loaded) {
    LORICA_TRY(std::unique_ptr<Loaded> loaded, loadLibrary(settings));
    g_loaded = std::move(loaded);
  }
  auto library = std::make_shared<OpenNiLibrary>(g_loaded->api, g_loaded->stage->drivers(), settings);
  LORICA_TRY_DO(library->initialize());
  g_running = library;
  return std::shared_ptr<OpenNi>(std::move(library));
}

OpenNiLibrary::OpenNiLibrary(const OpenNiApi& api, std::vector<OpenNiDriver> drivers, OpenNiSettings settings)
    : api_(api), drivers_(std::move(drivers)), settings_(std::move(settings)) {}

Result<void> OpenNiLibrary::initialize() {
  const WorkingFolder keep;
  try {
    OniDeviceCallbacks callbacks{};
    callbacks.deviceConnected = [](const OniDeviceInfo* device, void* self) {
      static_cast<OpenNiLibrary*>(self)->note(device, false);
    };
    callbacks.deviceDisconnected = [](const OniDeviceInfo* device, void* self) {
      static_cast<OpenNiLibrary*>(self)->note(device, true);
    };
    callbacks.deviceStateChanged = [](const OniDeviceInfo* device, OniDeviceState state, void* self) {
      static_cast<OpenNiLibrary*>(self)->note(device, state == ONI_DEVICE_STATE_ERROR);
    };
    if (api_.initialize(ONI_API_VERSION) != ONI_STATUS_OK) return failure("OpenNI2 cannot be started");
    initialized_ = true;
    if (api_.registerCallbacks(&callbacks, this, &callbacks_) != ONI_STATUS_OK) {
      callbacks_ = nullptr;
      return failure("OpenNI2 cannot report which cameras are plugged in");
    }
    for (OpenNiDriver& driver : drivers_) {
      if (driver.packaged) driver.problem = problemOf(driver);
    }
  } catch (...) {
    return unreadable("OpenNI2 failed on startup, in one of its drivers");
  }
  return {};
}

OpenNiLibrary::~OpenNiLibrary() {
  const WorkingFolder keep;
  try {
    if (callbacks_ != nullptr) api_.unregisterCallbacks(callbacks_);
    if (initialized_) api_.shutdown();
  } catch (...) {
    std::fprintf(stderr, "lorica: OpenNI2 failed on shutdown\n");
  }
}

void OpenNiLibrary::note(const OniDeviceInfo* device, bool gone) {
  if (device == nullptr) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  gone_[cameraOf(*device).uri] = gone;
}

bool OpenNiLibrary::isGone(const std::string& uri) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = gone_.find(uri);
  return found != gone_.end() && found->second;
}

Error OpenNiLibrary::failure(const std::string& what) const {
  const char* said = api_.extendedError();
  // OpenNI2 separates its messages with line breaks and tabs: join them into one sentence.
  std::string why;
  std::istringstream words(said == nullptr ? "" : said);
  for (std::string word; words >> word;) why += why.empty() ? word : " " + word;
  return unreadable(why.empty() ? what : fmt::format("{}: {}", what, why));
}

Result<std::vector<OpenNiCamera>> OpenNiLibrary::cameras() const {
  try {
    OniDeviceInfo* devices = nullptr;
    int count = 0;
    if (api_.deviceList(&devices, &count) != ONI_STATUS_OK) return failure("OpenNI2 cannot list its cameras");
    std::vector<OpenNiCamera> cameras;
    cameras.reserve(count);
    for (int i = 0; i < count; ++i) {
      cameras.push_back(cameraOf(devices[i]));
      cameras.back().driver = driverOf(cameras.back(), drivers_);
    }
    api_.releaseDeviceList(devices);
    return cameras;
  } catch (...) {
    return unreadable("OpenNI2 failed while listing its cameras");
  }
}

Result<std::unique_ptr<DepthSource>> OpenNiLibrary::open(const std::string& uri) {
  LORICA_TRY(const std::vector<OpenNiCamera> listed, cameras());
  std::string problems;
  for (const OpenNiCamera& camera : listed) {
    if (!uri.empty() && camera.uri != uri) continue;
    Result<std::unique_ptr<OpenNiSource>> source = OpenNiSource::open(shared_from_this(), camera);
    if (source) return std::unique_ptr<DepthSource>(std::move(*source));
    problems += (problems.empty() ? "" : "; ") + source.error().message;
  }
  if (!problems.empty()) return unreadable(problems);
  if (uri.empty()) return notFound("OpenNI2 found no depth camera, expected at least one");
  std::string uris;
  for (const OpenNiCamera& camera : listed) uris += (uris.empty() ? "" : ", ") + camera.uri;
  return notFound("found no camera \"{}\", available: {}", uri, uris.empty() ? "none" : uris);
}

}  // namespace lorica
