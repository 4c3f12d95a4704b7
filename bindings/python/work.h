#pragma once

#include "acd/decompose.h"
#include "acd/decomposition_file.h"
#include "geometry/result.h"

#include <pybind11/pybind11.h>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace lorica {

/// Text that may hold the names of files, which need not be UTF-8: as os.fsdecode() gives them.
[[nodiscard]] pybind11::str textFrom(std::string_view bytes);

/// Raises the exception for an error: FileNotFoundError, OSError, lorica.Cancelled, or ValueError.
[[noreturn]] void raise(const Error& error);

/// The value, or an exception with the error's sentence.
template <typename T>
[[nodiscard]] T valueOf(Result<T> result) {
  if (!result) raise(result.error());
  return std::move(*result);
}

/// Runs work in a thread of its own, without the interpreter's lock. Meanwhile this thread calls `progress` for the
/// work, one call at a time, and looks for signals 20 times a second. Ctrl-C, an exception in `progress`, and its
/// answer False cancel the work; the first two are raised again when it has stopped.
/// @param progress  None, or called with parts done and wanted
void runAside(const pybind11::object& progress, const std::function<void(const DecomposeProgress&)>& work);

/// The same for work with a result.
template <typename T>
[[nodiscard]] T resultAside(const pybind11::object& progress,
                            const std::function<Result<T>(const DecomposeProgress&)>& work) {
  std::optional<Result<T>> result;
  runAside(progress, [&](const DecomposeProgress& report) { result.emplace(work(report)); });
  return valueOf(std::move(*result));
}

/// Gives a sentence as a RuntimeWarning; none if it is empty. Raises what the program makes of warnings.
void warnOf(const std::string& sentence);

/// Writes a .lorica file, without the interpreter's lock.
void save(const DecompositionFile& content, const std::filesystem::path& file);

}  // namespace lorica
