#include "tests/geometry/allocation_watch.h"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<bool> watching{false};
std::atomic<std::size_t> largestRequest{0};

}  // namespace

// The program's own operator new and delete, for all of this test program.
void* operator new(std::size_t size) {
  if (watching.load(std::memory_order_relaxed) && size > largestRequest.load(std::memory_order_relaxed)) {
    largestRequest.store(size, std::memory_order_relaxed);
  }
  if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  throw std::bad_alloc();
}
// std::stable_sort asks this way; without it a sanitizer would see its memory freed by another family.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  try {
    return operator new(size);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace lorica::test {

AllocationWatch::AllocationWatch() {
  largestRequest = 0;
  watching = true;
}

AllocationWatch::~AllocationWatch() {
  watching = false;
}

std::size_t AllocationWatch::largest() const {
  return largestRequest;
}

}  // namespace lorica::test
