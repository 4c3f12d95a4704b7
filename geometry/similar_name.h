#pragma once

#include <span>
#include <string>
#include <string_view>

namespace lorica {

/// What a misspelt name probably meant, for the end of a sentence.
/// Compared by insertions, deletions and changes of letters, and swaps of two neighbours, without regard to case; of
/// equally near names the first one is taken. Names of more than 200 characters and all after the first 2,000 are not
/// compared.
/// @return `; did you mean "hand.l"?`, or empty if more than half of the name would change
[[nodiscard]] std::string didYouMean(std::string_view name, std::span<const std::string> known);

}  // namespace lorica
