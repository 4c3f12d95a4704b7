#include "skinning/linear_blend.h"
#include "skinning/mannequin.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

namespace {
std::atomic<long> allocations{0};

void* counted(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size == 0 ? 1 : size)) return p;
  std::abort();
}
}  // namespace

// This test program counts what it allocates.
void* operator new(std::size_t size) {
  return counted(size);
}
void* operator new[](std::size_t size) {
  return counted(size);
}
// std::stable_sort asks this way; without it a sanitizer would see its memory freed by another family.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return counted(size);
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete[](void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}
void operator delete[](void* p, std::size_t) noexcept {
  std::free(p);
}

namespace lorica::test {
namespace {

TEST(PerFrame, KinematicsAndSkinningAllocateNothing) {
  const Character character = makeMannequin();
  const Pose pose = restPose(character.skeleton);
  std::vector<Affine3> world(pose.size());
  std::vector<Affine3> skin(pose.size());
  std::vector<Vec3> vertices(character.mesh.vertices.size());

  const long before = allocations;
  ASSERT_GT(before, 0);  // the counter works: making all this did allocate
  computeWorldFromJoint(character.skeleton, pose, world);
  computeWorldFromModel(character, world, skin);
  skinLinearBlend(character, skin, vertices);
  EXPECT_EQ(allocations - before, 0);
}

}  // namespace
}  // namespace lorica::test
