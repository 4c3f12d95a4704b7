#include "tests/support/allocations.h"

#include <atomic>
#include <cstdlib>
#include <new>

#ifdef __has_feature
#define LORICA_THREAD_SANITIZER __has_feature(thread_sanitizer)
#else
#define LORICA_THREAD_SANITIZER 0
#endif

namespace {

std::atomic<long> allocations{0};
std::atomic<bool> watching{false};
std::atomic<std::size_t> largestRequest{0};

/// @return null if out of memory
[[maybe_unused]] void* counted(std::size_t size) noexcept {
  allocations.fetch_add(1, std::memory_order_relaxed);
  if (watching.load(std::memory_order_relaxed) && size > largestRequest.load(std::memory_order_relaxed)) {
    largestRequest.store(size, std::memory_order_relaxed);
  }
  return std::malloc(size == 0 ? 1 : size);
}

}  // namespace

// Clang's thread sanitizer has operators of its own, which no program can replace: nothing is counted there.
#if !LORICA_THREAD_SANITIZER

// The program's own operator new and delete; those of arrays call these.
void* operator new(std::size_t size) {
  if (void* memory = counted(size)) return memory;
  throw std::bad_alloc();
}
// std::stable_sort uses these; without them a sanitizer would report a mismatch of allocation and deallocation.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return counted(size);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

#endif

namespace lorica::test {

long allocationCount() {
  return allocations;
}

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
