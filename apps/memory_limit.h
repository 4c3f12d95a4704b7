#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace lorica {

/// What a command may take that has no --memory: 2 GB, or 200 bytes for each byte of the files that it names, if that
/// is more. Files beside a .gltf count with it.
/// @param words  of the command line
[[nodiscard]] std::uint64_t usualMemory(std::span<const std::string> words);

/// Who set the limit.
enum class LimitOf {
  kUser,  ///< --memory
  kUsual  ///< usualMemory(), which what runs may lift
};

/// Lets this process allocate no more than that; a lower limit that it was started with stays. Where memory is missing
/// from now on, it ends with a sentence and exit status 2, whatever thread it is in: temporary files are removed, and
/// recordings are finished, as at a hard stop.
/// @param threads  whose stacks are on top of it
void limitMemory(std::uint64_t bytes, int threads, LimitOf set);

/// Takes back the usual limit: for windows, whose drivers take what they like; for pages and headsets, whose session
/// must not end by what one guest opens; and for `bake`, which limits each of its items. What the user set stays.
void liftUsualLimit();

/// Ends the program as above.
[[noreturn]] void endWithoutMemory() noexcept;

}  // namespace lorica
