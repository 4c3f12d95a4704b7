#include "bake/bake_job.h"

namespace lorica {

std::uint64_t memoryBound(std::uint64_t triangles) {
  constexpr std::uint64_t kBase = std::uint64_t{512} << 20;
  constexpr std::uint64_t kPerTriangle = std::uint64_t{2} << 10;
  return kBase + kPerTriangle * triangles;
}

}  // namespace lorica
