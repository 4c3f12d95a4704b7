#pragma once

// What the examples of the documents name without making it, for each document that has some.

#include <lorica/acd/decompose.h>
#include <lorica/collision/live/live_body.h>
#include <lorica/collision/particles/particle_push.h>

#include <string>
#include <vector>

inline void complain(const std::string&) {}
inline void use(const auto&...) {}

#define SNIPPET_LIBRARY void library(std::vector<lorica::Vec3> keyframes, std::vector<lorica::Affine3> transforms)

#define SNIPPET_PARTICLES                                                                    \
  using namespace lorica;                                                                    \
  void particles(LiveBody& body, double secondsSinceLastFrame, std::vector<Vec3f> positions, \
                 std::vector<Vec3f> velocities, float friction)
