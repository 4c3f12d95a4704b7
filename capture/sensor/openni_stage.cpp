#include "capture/sensor/openni_stage.h"

#include "geometry/errors.h"

#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <system_error>

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

/// The last error of dlopen.
std::string loaderProblem() {
  const char* text = dlerror();
  return text == nullptr ? "unknown" : text;
}

}  // namespace

Result<void> OpenNiStage::link(const fs::path& from, const fs::path& to) const {
  std::error_code error;
  fs::create_symlink(from, to, error);
  if (error) {
    return unwritable("{}: cannot link to {}: {}", to.string(), from.string(), error.message());
  }
  return {};
}

Result<std::unique_ptr<OpenNiStage>> OpenNiStage::make(const fs::path& library, const std::vector<fs::path>& drivers) {
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
  LORICA_TRY_DO(stage->link(library, stage->library()));

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
    LORICA_TRY_DO(stage->link(file, stage->folder_ / kDriverFolder / name));
    users.push_back({file, false, {}});
  }
  for (auto& [name, driver] : packaged) {
    const fs::path to = stage->folder_ / kDriverFolder / name;
    LORICA_TRY_DO(stage->link(driver.file, to));
    stage->drivers_.push_back(std::move(driver));
  }
  stage->drivers_.insert(stage->drivers_.end(), users.begin(), users.end());
  return stage;
}

OpenNiStage::~OpenNiStage() {
  if (owner_ != ::getpid()) return;  // a fork()ed child has the parent's folder
  std::error_code error;
  std::filesystem::remove_all(folder_, error);
}

}  // namespace lorica
