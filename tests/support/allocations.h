#pragma once

#include <cstddef>

namespace lorica::test {

/// Number of allocations of this program so far. A program that uses this header has a counting operator new.
[[nodiscard]] long allocationCount();

/// Largest single allocation by operator new since construction, in bytes. Used to show that a false count in a file
/// does not cause a large allocation. Only one at a time, on one thread.
class AllocationWatch {
 public:
  AllocationWatch();
  ~AllocationWatch();
  AllocationWatch(const AllocationWatch&) = delete;
  AllocationWatch& operator=(const AllocationWatch&) = delete;
  [[nodiscard]] std::size_t largest() const;
};

}  // namespace lorica::test
