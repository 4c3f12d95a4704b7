#include "geometry/files.h"

#include "geometry/descriptor.h"
#include "geometry/errors.h"
#include "geometry/new_file.h"
#include "geometry/system_files.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <cerrno>
#include <system_error>

namespace lorica {

namespace {

std::string reason(int error) {
  return std::generic_category().message(error);
}

Error cannotRead(const std::filesystem::path& file, int error) {
  const ErrorCode code = error == ENOENT || error == ENOTDIR ? ErrorCode::kNotFound : ErrorCode::kUnreadable;
  return {code, fmt::format("{}: cannot be read: {}", file.string(), reason(error))};
}

Error tooLarge(const std::filesystem::path& file, const std::string& found, std::uint64_t maxBytes) {
  return unreadable("{}: {}, expected at most {} bytes", file.string(), found, maxBytes);
}

}  // namespace

Result<std::string> readFile(const std::filesystem::path& file, NamedBy by, std::uint64_t maxBytes) {
  const Descriptor in(system::openFile(file, O_RDONLY | (by == NamedBy::kUser ? 0 : system::kAtOnce)));
  if (!in.valid()) return cannotRead(file, errno);
  system::FileStatus status{};
  if (system::statusOf(in.get(), status) != 0) return cannotRead(file, errno);
  if (S_ISDIR(status.st_mode)) return cannotRead(file, EISDIR);
  const bool regular = S_ISREG(status.st_mode);
  if (system::isDevice(status) || (!regular && by != NamedBy::kUser)) {  // some never end
    return unreadable("{}: cannot be read: found a {}, expected a file", file.string(),
                      S_ISFIFO(status.st_mode)   ? "named pipe"
                      : system::isSocket(status) ? "socket"
                                                 : "device");
  }
  if (regular && static_cast<std::uint64_t>(status.st_size) > maxBytes) {
    return tooLarge(file, fmt::format("{} bytes", status.st_size), maxBytes);
  }

  // The size is only a hint: pipes have none, and a file may grow while it is read.
  std::string content;
  std::size_t length = 0;
  content.resize(regular ? static_cast<std::size_t>(status.st_size) + 1 : 65536);
  while (true) {
    if (length == content.size()) content.resize(2 * content.size());
    const ssize_t got = ::read(in.get(), content.data() + length, content.size() - length);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return cannotRead(file, errno);
    if (got == 0) break;
    length += got;
    if (length > maxBytes) return tooLarge(file, "more", maxBytes);
  }
  content.resize(length);
  return content;
}

Result<void> writeFileAtomically(const std::filesystem::path& file, std::string_view content, NamedBy by) {
  LORICA_TRY(const std::unique_ptr<NewFile> made, NewFile::create(file, by));
  LORICA_TRY_DO(made->write(content));
  return made->finish();
}

Result<void> checkOwnFolder(const std::filesystem::path& folder) {
  const auto refused = [](const std::filesystem::path& place, const char* why) {
    return unwritable("{}: {}", place.string(), why);
  };
  system::FileStatus own{}, around{};
  const std::filesystem::path parent = folder.has_parent_path() ? folder.parent_path() : ".";
  if (system::statusOf(folder, own) != 0 || system::statusOf(parent, around) != 0) {
    return refused(folder, std::generic_category().message(errno).c_str());
  }
  if (!S_ISDIR(own.st_mode)) return refused(folder, std::generic_category().message(ENOTDIR).c_str());
  if (!system::isOwn(own)) return refused(folder, "belongs to another user");
  if (system::isForAllToWrite(own)) return refused(folder, "everybody may write into it");
  return system::keepsFilesOfOthers(around) ? Result<void>() : refused(parent, "everybody may write into it");
}

Result<void> makeOwnFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder.parent_path(), error);
  if (!error && system::makeFolder(folder) != 0 && errno != EEXIST) error.assign(errno, std::generic_category());
  if (error) return unwritable("{}: {}", folder.string(), error.message());
  return checkOwnFolder(folder);
}

std::uint64_t contentHash(std::string_view bytes, std::uint64_t seed) {
  return XXH3_64bits_withSeed(bytes.data(), bytes.size(), seed);
}

std::string hexDigits(std::uint64_t value) {
  return fmt::format("{:016x}", value);
}

}  // namespace lorica
