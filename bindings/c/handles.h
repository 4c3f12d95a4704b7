#pragma once

#include "bindings/live_character.h"
#include "bindings/mesh_parts.h"
#include "skinning/clip.h"

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
  std::vector<lorica::Affine3> poses = {};  ///< worldFromJoint that its program gave; empty if it comes from a file
};

struct lorica_body {
  std::shared_ptr<const lorica::CharacterBody> body;
};

struct lorica_motion {
  lorica::SkeletalMotion motion;
  std::string firstGuess;
};

/// What was found in a pose, see contacts.cpp.
struct FoundContacts;

struct lorica_live {
  lorica::LiveCharacter live;
  lorica::Pose pose;                     ///< scratch
  std::vector<lorica::Affine3> given;    ///< scratch
  std::shared_ptr<FoundContacts> found;  ///< null until it is asked for
};
