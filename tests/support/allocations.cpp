#include "tests/support/allocations.h"

#include <atomic>
#include <cstdlib>
#include <new>

#ifdef __SANITIZE_THREAD__
#define LORICA_THREAD_SANITIZER
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define LORICA_THREAD_SANITIZER
#endif
#endif

#ifdef LORICA_THREAD_SANITIZER
#include <sanitizer/allocator_interface.h>
#endif

namespace {

std::atomic<long> allocations{0};
std::atomic<bool> watching{false};
std::atomic<std::size_t> largestRequest{0};

void count(std::size_t size) noexcept {
  allocations.fetch_add(1, std::memory_order_relaxed);
  if (watching.load(std::memory_order_relaxed) && size > largestRequest.load(std::memory_order_relaxed)) {
    largestRequest.store(size, std::memory_order_relaxed);
  }
}

}  // namespace

#ifdef LORICA_THREAD_SANITIZER

// It has operators of its own, and tells of every allocation.
namespace {
[[maybe_unused]] const int installed = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, std::size_t size) { count(size); }, [](const volatile void*) {});
}  // namespace

#else

namespace {
/// @return null if out of memory
void* counted(std::size_t size) noexcept {
  count(size);
  return std::malloc(size == 0 ? 1 : size);
}
}  // namespace

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
