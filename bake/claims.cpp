#include "bake/claims.h"

#include "geometry/errors.h"
#include "geometry/files.h"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <random>
#include <sstream>
#include <utility>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr const char* kEnded = "ended";
constexpr double kBeatsUntilLost = 6.0;
constexpr int kTries = 4;

std::string hostName() {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0) return "machine";
  return name.data();
}

std::string firstLine(const fs::path& file) {
  const Result<std::string> text = readFile(file, NamedBy::kFile);
  return text ? text->substr(0, text->find('\n')) : std::string();
}

/// Where process numbers mean the same: this start of this machine, and this space of numbers (containers have their
/// own). Empty if it cannot be told.
std::string processSpace() {
  std::error_code error;
  const fs::path space = fs::read_symlink("/proc/self/ns/pid", error);
  const std::string boot = firstLine("/proc/sys/kernel/random/boot_id");
  return error || boot.empty() ? std::string() : boot + space.string();
}

/// When a process started, in the machine's ticks; empty if there is none or nothing of it but its number. Another
/// process may have the same number later.
std::string startOf(pid_t process) {
  const std::string line = firstLine(fmt::format("/proc/{}/stat", process));
  const std::size_t name = line.rfind(')');
  if (name == std::string::npos) return "";
  std::istringstream words(line.substr(name + 1));
  std::string state, word;
  words >> state;
  for (int field = 4; field <= 22; ++field) words >> word;
  return words && state != "Z" && state != "X" ? word : std::string();
}

/// A file name that no other worker has.
std::string newName() {
  std::random_device random;
  return fmt::format("{}-{}-{:08x}", hostName(), ::getpid(), random());
}

}  // namespace

Claims::Claims(FileLayer& files, fs::path folder, double lostAfter, std::function<Clock::time_point()> now)
    : files_(&files),
      folder_(std::move(folder)),
      lostAfter_(lostAfter),
      now_(std::move(now)),
      worker_(newName()),
      lastBeat_(now_()) {}

Result<Claims> Claims::open(FileLayer& files, const fs::path& folder, double lostAfter,
                            std::function<Clock::time_point()> now) {
  Claims claims(files, folder, lostAfter, std::move(now));
  if (const int error = files.createFolders(folder / "claims"); error != 0) return unwritable(folder / "claims", error);
  const fs::path own = claims.fileOf(claims.worker_);
  if (const int error = claims.createIn("workers", own, claims.lifeSign()); error != 0) return unwritable(own, error);
  return claims;
}

/// Creates a file in a folder, which another process may remove as long as it is empty.
int Claims::createIn(const char* name, const fs::path& file, std::string_view content) {
  int error = ENOENT;
  for (int attempt = 0; attempt < kTries && error == ENOENT; ++attempt) {
    error = files_->createFolders(folder_ / name);
    if (error == 0) error = files_->create(file, content);
  }
  return error;
}

fs::path Claims::fileOf(const std::string& worker) const {
  return folder_ / "workers" / worker;
}

std::string Claims::lifeSign() const {
  return fmt::format("{:012} {} {} {}\n", beats_, ::getpid(), startOf(::getpid()), processSpace());
}

Result<std::optional<int>> Claims::claim(const std::string& key) {
  for (int earlier = 0;;) {
    const fs::path file = folder_ / "claims" / fmt::format("{}.{}", key, earlier);
    Result<std::string> owner = files_->read(file);
    if (!owner && owner.error().code == ErrorCode::kNotFound) {
      const int error = createIn("claims", file, worker_);
      if (error == 0) owner = worker_;
      if (error != 0 && error != EEXIST) return unwritable(file, error);
      if (error != 0) owner = files_->read(file);  // somebody was faster, or the server answered twice
    }
    // What is there and cannot be read yet is watched like a claim without a name.
    if (!owner) owner = std::string();
    if (*owner == worker_) {
      held_[key] = earlier;
      return std::optional(earlier);
    }
    if (!lost(*owner, file)) return std::optional<int>();
    ++earlier;
  }
}

bool Claims::lost(const std::string& worker, const fs::path& claim) {
  // A worker whose name is not written yet, or whose file is not seen yet, is watched like one that says nothing.
  const bool named = !worker.empty() && fs::path(worker).filename() == worker;
  const Result<std::string> sign = named ? files_->read(fileOf(worker)) : Result<std::string>(std::string());
  if (sign && sign->starts_with(kEnded)) return true;

  std::istringstream words(sign ? *sign : std::string());
  std::string beats, start, space;
  pid_t process = 0;
  if (words >> beats >> process >> start >> space && space == processSpace() && startOf(process) != start) return true;

  const Clock::time_point now = now_();
  const auto [known, isNew] =
      seen_.try_emplace(named ? worker : claim.string(), Seen{sign ? *sign : std::string(), now});
  if (!isNew && sign && known->second.sign != *sign) known->second = {*sign, now};
  return std::chrono::duration<double>(now - known->second.since).count() >= lostAfter_;
}

void Claims::beat() {
  const Clock::time_point now = now_();
  if (std::chrono::duration<double>(now - lastBeat_).count() < lostAfter_ / kBeatsUntilLost) return;
  lastBeat_ = now;
  ++beats_;
  (void)files_->overwrite(fileOf(worker_), lifeSign());  // the next one may succeed
}

void Claims::release(const std::string& key) {
  const auto held = held_.find(key);
  if (held == held_.end()) return;
  // The highest first: as long as one is there, it counts.
  for (int number = held->second; number >= 0; --number) {
    files_->remove(folder_ / "claims" / fmt::format("{}.{}", key, number));
  }
  held_.erase(held);
}

void Claims::end() {
  if (held_.empty()) {
    files_->remove(fileOf(worker_));
  } else {
    (void)files_->overwrite(fileOf(worker_), kEnded);
  }
  for (const char* name : {"claims", "workers"}) files_->removeEmpty(folder_ / name);
}

}  // namespace lorica
