#include "viewer/player/dated_file.h"

#include "geometry/errors.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <system_error>

namespace lorica {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxOfADay = 999;
constexpr std::uintmax_t kLeastFree = std::uintmax_t{2} << 30;  // [bytes]

}  // namespace

Result<std::string> newDatedFile(const fs::path& folder, std::string_view ending) {
  std::error_code error;
  if (const fs::space_info space = fs::space(folder, error); error || space.available < kLeastFree) {
    return unwritable("{}: {}", folder.string(),
                      error ? error.message() : fmt::format("less than {} MiB free", kLeastFree >> 20));
  }
  const std::string day = fmt::format("{:%Y-%m-%d}", fmt::localtime(std::time(nullptr)));
  for (int number = 1; number <= kMaxOfADay; ++number) {
    const fs::path file = folder / fmt::format("{}_{:03}{}", day, number, ending);
    if (!fs::exists(file, error) &&
        !fs::exists(fs::path(file).replace_extension(fmt::format(".part{}", ending)), error))
      return file.string();
  }
  return unwritable("{}: {} files ({}) of {}", folder.string(), kMaxOfADay, ending, day);
}

}  // namespace lorica
