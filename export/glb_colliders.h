#pragma once

#include "export/rigid_colliders.h"
#include "geometry/mesh_files.h"
#include "skinning/clip_files/character_document.h"
#include "skinning/springs/spring_bones.h"

#include <filesystem>
#include <string>
#include <vector>

namespace lorica {

/// How engines are told that a mesh of a GLB is a collider.
struct GlbColliderSettings {
  std::string prefix, postfix;  ///< of the nodes' names, see Engine
  bool khr = false;             ///< also KHR_physics_rigid_bodies, as drafted on kKhrDraft
  bool shown = true;            ///< the hulls are drawn translucent; false: nothing of them is drawn
};

/// The draft of KHR_physics_rigid_bodies that is written: colliders refer to meshes directly.
inline constexpr const char* kKhrDraft = "2026-06-12";

/// Adds each hull as a mesh on a node of its own below its bone: OMI_physics_body (kinematic, as bones are moved) with
/// a convex OMI_physics_shape. Nothing else of the document changes.
/// @param names  of the hulls, as many
void addColliders(CharacterDocument& document, std::span<const RigidCollider> colliders,
                  std::span<const std::string> names, const GlbColliderSettings& settings);

/// Hulls alone, of a mesh that does not move: static bodies.
/// @return or that the file cannot be written
[[nodiscard]] Result<void> writeGlbHulls(const std::filesystem::path& file, const std::vector<NamedMesh>& hulls,
                                         const GlbColliderSettings& settings);

/// Writes a document, completely or not at all.
[[nodiscard]] Result<void> writeDocument(const std::filesystem::path& file, CharacterDocument& document);

/// Adds spring-bone colliders to the document of a VRM file, in a group that every spring uses: hair and clothes keep
/// out of the body. Each hull becomes the capsule around it, shrunk to the hull's volume, since a capsule that holds
/// all poses would push away what rests on the skin; VRM 0.x has only balls, so a capsule becomes a row of them. Bones
/// that swing themselves get none. Nothing else of the document changes.
/// @param springs  of the file
/// @return the number of shapes added; or that the file is no VRM or has no springs
[[nodiscard]] Result<int> addSpringColliders(CharacterDocument& document, std::span<const RigidCollider> colliders,
                                             const Skeleton& skeleton, const SpringBones& springs,
                                             const std::string& name);

}  // namespace lorica
