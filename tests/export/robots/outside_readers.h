#pragma once

#include "geometry/result.h"
#include "tests/support/datasets.h"

#include <functional>
#include <string>
#include <vector>

namespace lorica::test {

/// A reader of files from outside, and small files of its formats.
struct OutsideReader {
  std::string name;
  std::function<Result<void>(const std::string& bytes)> read;
  std::vector<std::string> seeds;  ///< each is read without an error
};

/// All readers that the libraries below this folder have, but for FBX and COLLADA, whose reader is not ours. Bytes that
/// a format protects by a checksum are the content behind it.
/// @param folder  for readers of files; outlives them
[[nodiscard]] std::vector<OutsideReader> outsideReaders(const TemporaryFolder& folder);

}  // namespace lorica::test
