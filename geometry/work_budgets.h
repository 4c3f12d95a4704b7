#pragma once

#include <cstddef>
#include <cstdint>

namespace lorica {

// What files, packets and options can ask for at most, however small they are. Each is checked before the work, and
// what is more is refused with a sentence, or left out with a note. docs/SECURITY.md has them as a table. Sizes of
// files are with their readers.

// Options, and the arguments of C and Python.
inline constexpr int kMaxThreads = 1024;                       ///< of any command or call
inline constexpr int kMaxOfAnything = 1'000'000;               ///< parts, vertices of a hull, frames, pictures
inline constexpr std::size_t kMaxCast = 64;                    ///< avatars that a command sets up
inline constexpr std::size_t kMaxContactRows = 10'000'000;     ///< of a table of contacts: 960 MB while they wait
inline constexpr std::size_t kMaxSequenceFrames = 2'000;       ///< of a mesh in several poses
inline constexpr std::size_t kMaxSequencePoints = 20'000'000;  ///< of all its frames: 480 MB, and as much as shapes
inline constexpr std::size_t kMaxPeople = 6;                   ///< before a camera
inline constexpr std::size_t kMaxRecordedPeople = 64;          ///< in a recording of joints

// Characters: glTF, VRM, FBX, COLLADA.
inline constexpr std::size_t kMaxGltfElements = 100'000;   ///< of a kind, such as nodes, materials or accessors
inline constexpr std::size_t kMaxDraws = 200'000;          ///< primitives, each once for every node that draws it
inline constexpr std::size_t kMaxTriangles = 10'000'000;   ///< of a mesh
inline constexpr std::size_t kMaxUnionSteps = 50'000'000;  ///< to unite the pieces of a mesh: two seconds
inline constexpr std::size_t kMaxLooked = 20'000'000;      ///< triangles, to tell what is inside a surface: a second
inline constexpr std::size_t kMaxLookedEach = 500;         ///< and as many more for each of them
inline constexpr std::size_t kMaxJoints = 2'048;  ///< of a file with skins, clips or springs: some steps are quadratic
inline constexpr std::size_t kMaxClips = 10'000;  ///< of a file
inline constexpr double kMaxClipPoses = 8e6;  ///< frames times joints of a clip as a motion: two of them take 1.3 GB
inline constexpr double kMaxTrainingPoses = 2e6;  ///< of all clips that hulls are fitted to, looked at less often
inline constexpr int kMaxPictureSide = 16384;     ///< pixels; larger pictures are refused before anything is decoded
inline constexpr std::int64_t kMaxPicturePixels = 1 << 26;   ///< width x height; 8192 x 8192 is allowed
inline constexpr std::uint64_t kMaxStoredTexels = 1U << 29;  ///< of all pictures; those beyond are not drawn
inline constexpr std::uint64_t kMaxKeptTexels = 1U << 27;    ///< of all as they are drawn; more are reduced to fit
inline constexpr int kMaxMorphTargets = 4'096;               ///< those beyond are left out
inline constexpr int kMaxExpressions = 1'024;                ///< those beyond are left out
inline constexpr int kMaxExpressionBinds = 100'000;          ///< those beyond are left out
inline constexpr std::size_t kMaxSprings = 10'000;           ///< joints that swing
inline constexpr std::size_t kMaxSpringColliders = 10'000;   ///< of a file
inline constexpr std::size_t kMaxSpringPairs = 1'000'000;    ///< of a joint that swings and a collider of its chain
inline constexpr std::size_t kMaxNodeConstraints = 1'000;    ///< of a file: joints that follow others

// Scenes.
inline constexpr std::size_t kMaxSceneProps = 2'000;  ///< things that move or stand, links of chains counted each
inline constexpr std::size_t kMaxSceneMeshes = 64;    ///< different ones
inline constexpr std::size_t kMaxSceneHulls = 4'000;  ///< of all props that are meshes
inline constexpr std::size_t kMaxSceneHullVertices = 400'000;  ///< of those hulls, counted for each prop
inline constexpr std::size_t kMaxSceneNearPairs = 20'000;      ///< props whose boxes overlap
inline constexpr std::size_t kMaxPropVertices = 20'000;        ///< of a prop that is a mesh
inline constexpr int kMaxPropParts = 32;                       ///< of a prop that is a mesh
inline constexpr int kMaxParticles = 300'000;                  ///< of water or sand
inline constexpr std::size_t kMaxParticleSources = 100;        ///< of water or sand: fills and pours
inline constexpr std::size_t kMaxParticlePairs = 2'000'000;    ///< of a particle and a prop near it: 112 MB

// Robots: MJCF, URDF.
inline constexpr std::size_t kMaxRobotIncludes = 100;       ///< files that a robot's file includes or attaches
inline constexpr std::size_t kMaxRobotMeshes = 1'000;       ///< different ones that collide
inline constexpr std::size_t kMaxRobotGeoms = 10'000;       ///< places where one collides
inline constexpr std::size_t kMaxRobotTriangles = 500'000;  ///< of a mesh that collides

// Streams from the network, their recordings, and sessions.
inline constexpr std::size_t kMaxWaitingFrames = 256;      ///< the oldest give way
inline constexpr std::size_t kMaxStreamFrames = 216'000;   ///< of a recording: an hour at 60 a second
inline constexpr std::size_t kMaxPoseExpressions = 256;    ///< of a pose that is sent or recorded
inline constexpr std::size_t kMaxExpressionName = 128;     ///< bytes
inline constexpr std::size_t kMaxRecordedAvatars = 1'000;  ///< of a session

}  // namespace lorica
