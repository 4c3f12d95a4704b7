#pragma once

#include <cstddef>

namespace lorica::test {

/// How often this program has asked for memory so far. A program that uses anything of this file has operator new
/// counted.
[[nodiscard]] long allocationCount();

/// Largest single allocation by operator new since this was made, in bytes. Shows that a lying count in a file is not
/// believed before the data is seen. One at a time, one thread.
class AllocationWatch {
 public:
  AllocationWatch();
  ~AllocationWatch();
  AllocationWatch(const AllocationWatch&) = delete;
  AllocationWatch& operator=(const AllocationWatch&) = delete;
  [[nodiscard]] std::size_t largest() const;
};

}  // namespace lorica::test
