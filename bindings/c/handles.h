#pragma once

#include "bindings/character_body.h"
#include "bindings/mesh_parts.h"
#include "capture/sensor/depth_frame.h"
#include "capture/tracking/tracker.h"

#include <memory>
#include <string>
#include <vector>

// What the opaque types of lorica.h are.

struct lorica_parts {
  lorica::MeshParts parts;
};

struct lorica_character {
  lorica::CharacterPointer owner;
  std::string firstGuess, notes;
};

struct lorica_body {
  std::shared_ptr<const lorica::CharacterBody> body;
};

struct lorica_motion {
  lorica::SkeletalMotion motion;
  std::string firstGuess;
};

struct lorica_live {
  lorica::LiveCharacter live;
  lorica::Pose pose;                   ///< scratch
  std::vector<lorica::Affine3> given;  ///< scratch
  std::vector<lorica::SelfContact> contacts;
  std::vector<lorica::Vec3> points;  ///< scratch
  std::vector<lorica::ShapeContact> touches;

  /// What was found in the last pose.
  void forget() {
    contacts.clear();
    touches.clear();
  }
};

struct lorica_tracker {
  lorica::Tracker tracker;
  lorica::DepthFrame frame;
  std::vector<lorica::TrackedPerson> people;
};
