#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace lorica {

/// A process of its own that reads FBX and COLLADA files, whose reader (assimp) can be made to crash, to hang and to
/// take all memory. It gets the file's bytes, has limits of time, memory and stack (docs/SECURITY.md), and its result
/// is checked before it is used. What happens in there is one error here. It leaves no process and no file behind.
struct IsolatedReader {
  std::filesystem::path program;       ///< calls serveIsolatedReader() when it is run with these arguments
  std::vector<std::string> arguments;  ///< without the program
  std::function<bool()> cancelled{};   ///< asked about every 20 ms; true ends the process, the error is kCancelled
};

/// The other side: reads one file from standard input and writes the result to standard output, both as
/// IsolatedReader's process gets them. @return the exit status of the process
[[nodiscard]] int serveIsolatedReader();

}  // namespace lorica
