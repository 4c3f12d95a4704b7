#include "capture/sensor/openni_library.h"

#include "geometry/errors.h"
#include "geometry/hard_stop.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDriverFolder = "OpenNI2/Drivers";

/// lib*.so.0, the only names that OpenNI2 accepts.
bool isDriverName(const std::string& name) {
  return name.size() > 8 && name.compare(0, 3, "lib") == 0 && name.compare(name.size() - 5, 5, ".so.0") == 0;
}

/// "FreenectDriver.so.1.2" becomes "libFreenectDriver.so.0".
std::string driverName(const fs::path& file) {
  std::string name = file.filename().string();
  if (isDriverName(name)) return name;
  name = name.substr(0, name.find(".so"));
  return (name.compare(0, 3, "lib") == 0 ? name : "lib" + name) + ".so.0";
}

/// OpenNI2 looks for drivers, files named lib*.so.0, in OpenNI2/Drivers beside the path from which it was itself
/// loaded, without following links. A private folder with links to the library, its own drivers and the user's drivers
/// therefore makes it find all of them, without an environment variable and without changes to the system.
class OpenNiStage {
 public:
  /// Creates the folder in the temporary directory. The user's drivers are loaded once, so that problems can be
  /// reported, and so that they find their own libraries beside their real files.
  /// @param library  libOpenNI2.so.0
  [[nodiscard]] static Result<std::unique_ptr<OpenNiStage>> make(const fs::path& library,
                                                                 const std::vector<fs::path>& drivers) {
    std::error_code error;
    const fs::path temporary = fs::temp_directory_path(error);
    std::string folder = ((error ? fs::path("/tmp") : temporary) / "lorica-openni-XXXXXX").string();
    if (::mkdtemp(folder.data()) == nullptr) {  // accessible only to this user: its content is executed
      return unwritable("{}: cannot be created, expected a folder for links to drivers", folder);
    }
    std::unique_ptr<OpenNiStage> stage(new OpenNiStage);
    stage->folder_ = folder;
    stage->owner_ = ::getpid();
    stage->cleaning_.emplace([folder = stage->folder_] {
      std::error_code ignored;
      fs::remove_all(folder, ignored);
    });
    fs::create_directories(stage->folder_ / kDriverFolder, error);
    LORICA_TRY_DO(link(library, stage->library()));

    std::map<std::string, OpenNiDriver> packaged;  // by link name; sorted, so that the order is always the same
    for (fs::directory_iterator file(library.parent_path() / kDriverFolder, error), end; !error && file != end;
         file.increment(error)) {
      const std::string name = file->path().filename().string();
      if (isDriverName(name)) packaged[name] = {file->path(), true, {}};
    }
    std::vector<OpenNiDriver> users;
    users.reserve(drivers.size());
    for (const fs::path& driver : drivers) {
      const fs::path file = fs::canonical(driver, error);
      if (error || !fs::is_regular_file(file, error)) {
        return notFound("{}: found no such file, expected an OpenNI2 driver", driver.string());
      }
      // It stays loaded: its threads may need its code after OpenNI2 has shut down.
      void* handle = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
      if (handle == nullptr) {
        return unreadable("{}: the driver cannot be loaded: {}", driver.string(), loaderProblem());
      }
      if (::dlsym(handle, "oniDriverCreate") == nullptr) {
        return unsupported("{}: found a library without oniDriverCreate, expected an OpenNI2 driver", driver.string());
      }
      const std::string name = driverName(file);
      packaged.erase(name);  // the user's driver replaces one of the same name
      LORICA_TRY_DO(link(file, stage->folder_ / kDriverFolder / name));
      users.push_back({file, false, {}});
    }
    for (auto& [name, driver] : packaged) {
      const fs::path to = stage->folder_ / kDriverFolder / name;
      LORICA_TRY_DO(link(driver.file, to));
      stage->drivers_.push_back(std::move(driver));
    }
    stage->drivers_.insert(stage->drivers_.end(), users.begin(), users.end());
    return stage;
  }

  /// Removes the folder, but only in the process that created it.
  ~OpenNiStage() {
    if (owner_ != ::getpid()) return;  // a fork()ed child has the parent's folder
    std::error_code error;
    fs::remove_all(folder_, error);
  }
  OpenNiStage(const OpenNiStage&) = delete;
  OpenNiStage& operator=(const OpenNiStage&) = delete;

  [[nodiscard]] fs::path library() const { return folder_ / "libOpenNI2.so.0"; }
  [[nodiscard]] const std::vector<OpenNiDriver>& drivers() const { return drivers_; }

 private:
  OpenNiStage() = default;

  static Result<void> link(const fs::path& from, const fs::path& to) {
    std::error_code error;
    fs::create_symlink(from, to, error);
    if (error) return unwritable("{}: cannot link to {}: {}", to.string(), from.string(), error.message());
    return {};
  }

  fs::path folder_;
  int owner_ = 0;  ///< process ID
  std::vector<OpenNiDriver> drivers_;
  std::optional<AtHardStop> cleaning_;
};

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
  return notFound("OpenNI2 cannot be loaded, expected libOpenNI2.so.0 (package libopenni2-0): {}", loaderProblem());
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

bool loadAll(void* handle, OpenNiApi& api) {
  const auto load = [&](const char* name, auto& function) { return loadSymbol(handle, name, function); };
  return load("oniInitialize", api.initialize) && load("oniShutdown", api.shutdown) &&
         load("oniGetExtendedError", api.extendedError) && load("oniGetDeviceList", api.deviceList) &&
         load("oniReleaseDeviceList", api.releaseDeviceList) &&
         load("oniRegisterDeviceCallbacks", api.registerCallbacks) &&
         load("oniUnregisterDeviceCallbacks", api.unregisterCallbacks) && load("oniDeviceOpen", api.deviceOpen) &&
         load("oniDeviceClose", api.deviceClose) && load("oniDeviceGetSensorInfo", api.sensorInfo) &&
         load("oniDeviceCreateStream", api.createStream) && load("oniStreamDestroy", api.streamDestroy) &&
         load("oniStreamStart", api.streamStart) && load("oniStreamStop", api.streamStop) &&
         load("oniStreamReadFrame", api.readFrame) && load("oniFrameRelease", api.frameRelease) &&
         load("oniWaitForAnyStream", api.wait) && load("oniStreamSetProperty", api.setProperty) &&
         load("oniStreamGetProperty", api.getProperty);
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

std::string loaderProblem() {
  const char* text = dlerror();
  return text == nullptr ? "unknown" : text;
}

double CameraClock::passed(std::chrono::steady_clock::time_point now) const {
  return std::chrono::duration<double>(now - given_).count();
}

double CameraClock::timeOf(double sensorTime) {
  const auto now = std::chrono::steady_clock::now();
  if (isNew_ && last_ >= 0.0) offset_ = last_ + passed(now) - sensorTime;
  isNew_ = false;
  last_ = std::max(sensorTime + offset_, std::nextafter(last_, 1e300));
  given_ = now;
  return last_;
}

double CameraClock::timeWithout() {
  const auto now = std::chrono::steady_clock::now();
  last_ = std::max(0.0, last_) + passed(now);
  given_ = now;
  isNew_ = true;
  return last_;
}

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
