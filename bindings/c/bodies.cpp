#include "bindings/c/guard.h"
#include "bindings/c/handles.h"
#include "bindings/character_body.h"
#include "geometry/errors.h"

#include <fmt/ranges.h>

#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace lorica {
namespace {

Result<void> check(const lorica_body_options& options) {
  if (std::isfinite(options.cover) && options.cover >= 0.0) return {};
  return invalidArgument("cover: found {}, expected 0 or more", options.cover);
}

/// @param names  so many, none of them null
Result<std::vector<std::string>> namesFrom(const char* const* names, std::size_t count, const char* argument) {
  if (count > 0) LORICA_TRY_DO(given(names, argument));
  for (std::size_t i = 0; i < count; ++i) {
    if (names[i] == nullptr) return invalidArgument("{} {} is null", argument, i);
  }
  return std::vector<std::string>(names, names + count);
}

Result<CharacterOptions> readingFrom(const lorica_character_options* given) {
  LORICA_TRY(const lorica_character_options options, taken(given, "options"));
  LORICA_TRY_DO(checkChoice(options.walls, LORICA_CHARACTER_SHELL, "walls"));
  constexpr std::optional<WallChoice> kWalls[] = {std::nullopt, WallChoice::kByReach, WallChoice::kShell};
  CharacterOptions reading;
  if (options.map != nullptr) reading.map = options.map;
  reading.bodyResolution = options.body_resolution;
  reading.walls = kWalls[options.walls];
  reading.thickness = options.thickness;
  LORICA_TRY(reading.hidden, namesFrom(options.hidden, options.hidden_count, "hidden"));
  LORICA_TRY(reading.expressions, namesFrom(options.expressions, options.expression_count, "expressions"));
  return reading;
}

/// Poses of so many joints.
Result<std::vector<Affine3>> matricesFrom(const double* numbers, std::size_t count, const char* argument,
                                          std::size_t joints) {
  if (count > 0) LORICA_TRY_DO(given(numbers, argument));
  std::vector<Affine3> matrices(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::optional<Affine3> matrix = affineFrom(numbers + 16 * i);
    if (!matrix)
      return invalidArgument("{}: the matrix of joint {} in pose {} {}", argument, i % joints, i / joints, kBadMatrix);
    matrices[i] = *matrix;
  }
  return matrices;
}

Result<GivenSkin> skinFrom(const lorica_skin& skin) {
  LORICA_TRY_DO(given(skin.vertices, "skin.vertices", skin.triangles, "skin.triangles", skin.joints, "skin.joints",
                      skin.weights, "skin.weights", skin.joint_from_model, "skin.joint_from_model"));
  GivenSkin given;
  if (skin.name != nullptr && skin.name[0] != '\0') given.name = skin.name;
  given.perVertex = skin.joints_per_vertex == 0 ? 4 : skin.joints_per_vertex;
  given.positions = {skin.vertices, 3 * skin.vertex_count};
  given.corners = {skin.triangles, 3 * skin.triangle_count};
  given.joints = {skin.joints, given.perVertex * skin.vertex_count};
  given.weights = {skin.weights, given.perVertex * skin.vertex_count};
  given.jointFromModel = {skin.joint_from_model, 16 * skin.joint_count};
  return given;
}

/// Its own clips; empty if there is no character.
std::span<const Clip> clipsOf(const lorica_character* character) {
  if (character == nullptr || !character->owner->file) return {};
  return character->owner->file->clips;
}

/// Its joints; empty if there is no character.
std::span<const Joint> jointsOf(const lorica_character* character) {
  if (character == nullptr) return {};
  return character->owner->character->skeleton.joints();
}

}  // namespace
}  // namespace lorica

using namespace lorica;

lorica_status lorica_character_read(const char* name_or_file, lorica_character** out) {
  return lorica_character_read_with(name_or_file, nullptr, out);
}

lorica_status lorica_character_read_with(const char* name_or_file, const lorica_character_options* options,
                                         lorica_character** out) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(given(name_or_file, "name_or_file", out, "out"));
    LORICA_TRY(const CharacterOptions reading, readingFrom(options));
    ProgramHost host;
    LORICA_TRY(CharacterPointer read, openCharacter(name_or_file, reading, host));
    std::string guess = guessAbout(*read);
    std::string notes = fmt::format("{}", fmt::join(notesOf(*read), "\n"));
    *out = new lorica_character{std::move(read), std::move(guess), std::move(notes)};
    return {};
  });
}

lorica_status lorica_character_make(const lorica_skin* skin, const lorica_character_options* options,
                                    lorica_character** out) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(given(skin, "skin", out, "out"));
    LORICA_TRY(const lorica_skin whole, taken(skin, "skin"));
    LORICA_TRY(const CharacterOptions reading, readingFrom(options));
    LORICA_TRY(const GivenSkin checked, skinFrom(whole));
    LORICA_TRY(std::vector<Affine3> poses,
               matricesFrom(whole.poses, whole.pose_count * whole.joint_count, "poses", whole.joint_count));
    if (whole.pose_count == 0) return invalidArgument("skin: pose_count is 0, expected poses that it is decomposed in");
    ProgramHost host;
    LORICA_TRY(CharacterPointer made, makeCharacter(checked, reading, host));
    std::string notes = fmt::format("{}", fmt::join(notesOf(*made), "\n"));
    *out = new lorica_character{std::move(made), {}, std::move(notes), std::move(poses)};
    return {};
  });
}

void lorica_character_free(lorica_character* character) {
  delete character;
}

const char* lorica_character_name(const lorica_character* character) {
  return character == nullptr ? "" : character->owner->character->name.c_str();
}

double lorica_character_height(const lorica_character* character) {
  return character == nullptr ? 0.0 : character->owner->character->height;
}

const char* lorica_character_first_guess(const lorica_character* character) {
  return character == nullptr ? "" : character->firstGuess.c_str();
}

const char* lorica_character_notes(const lorica_character* character) {
  return character == nullptr ? "" : character->notes.c_str();
}

size_t lorica_character_joint_count(const lorica_character* character) {
  return jointsOf(character).size();
}

const char* lorica_character_joint_name(const lorica_character* character, size_t joint) {
  const std::span<const Joint> joints = jointsOf(character);
  return joint < joints.size() ? joints[joint].name.c_str() : nullptr;
}

int32_t lorica_character_joint_parent(const lorica_character* character, size_t joint) {
  const std::span<const Joint> joints = jointsOf(character);
  return joint < joints.size() ? joints[joint].parent : -1;
}

lorica_status lorica_character_mesh(const lorica_character* character, lorica_mesh* out) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(given(character, "character"));
    const TriMesh& own = character->owner->character->mesh;
    lorica_mesh mesh = {};
    mesh.vertices = own.vertices.front().data();
    mesh.vertex_count = own.vertices.size();
    mesh.triangles = own.triangles.front().data();
    mesh.triangle_count = own.triangles.size();
    return handOut(mesh, out);
  });
}

size_t lorica_character_clip_count(const lorica_character* character) {
  return clipsOf(character).size();
}

const char* lorica_character_clip_name(const lorica_character* character, size_t clip) {
  const std::span<const Clip> clips = clipsOf(character);
  return clip < clips.size() ? clips[clip].name.c_str() : nullptr;
}

lorica_status lorica_body_make(const lorica_character* character, const lorica_body_options* options,
                               lorica_body** out) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(given(character, "character", out, "out"));
    LORICA_TRY(const lorica_body_options wanted, taken(options, "options"));
    LORICA_TRY_DO(check(wanted));
    ProgramHost host(progressFrom(wanted.progress, wanted.user), wanted.threads, wanted.parts);
    CharacterBodySettings settings{wanted.parts, {std::nullopt, wanted.hull_vertices}};
    if (wanted.cover > 0.0) settings.cover.tolerance = wanted.cover;
    LORICA_TRY(auto made, character->poses.empty()
                              ? makeCharacterBody(character->owner, settings, host)
                              : makeBodyInPoses(character->owner, character->poses, settings, host));
    *out = new lorica_body{std::move(made)};
    return {};
  });
}

lorica_status lorica_body_load(const lorica_character* character, const char* file, lorica_body** out) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(given(character, "character", file, "file", out, "out"));
    LORICA_TRY(auto read, readCharacterBody(character->owner, file));
    *out = new lorica_body{std::move(read)};
    return {};
  });
}

lorica_status lorica_body_save(const lorica_body* body, const char* file) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(given(body, "body", file, "file"));
    return writeDecomposition(file, body->body->content);
  });
}

lorica_status lorica_body_from_bytes(const lorica_character* character, const void* bytes, size_t count,
                                     lorica_body** out) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(given(character, "character", bytes, "bytes", out, "out"));
    LORICA_TRY(auto read, parseCharacterBody(character->owner, {static_cast<const char*>(bytes), count}));
    *out = new lorica_body{std::move(read)};
    return {};
  });
}

lorica_status lorica_body_bytes(const lorica_body* body, void* bytes, size_t room, size_t* count) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(given(body, "body"));
    return handOut(body->body->content, bytes, room, count);
  });
}

void lorica_body_free(lorica_body* body) {
  delete body;
}

size_t lorica_body_part_count(const lorica_body* body) {
  return body == nullptr ? 0 : body->body->content.decomposition.parts.size();
}

const char* lorica_body_warning(const lorica_body* body) {
  return body == nullptr ? "" : body->body->warning.c_str();
}

lorica_status lorica_motion_read(const lorica_character* character, const char* name_or_file,
                                 const lorica_motion_options* options, lorica_motion** out) {
  return guarded([&]() -> Result<void> {
    LORICA_TRY_DO(given(character, "character", name_or_file, "name_or_file", out, "out"));
    LORICA_TRY(const lorica_motion_options wanted, taken(options, "options"));
    ProgramHost host;
    LORICA_TRY(Performance performed,
               performanceOf(*character->owner->character, name_or_file, wanted.clip == nullptr ? "" : wanted.clip,
                             wanted.mirror != 0, host));
    *out = new lorica_motion{std::move(performed.motion), std::move(performed.firstGuess)};
    return {};
  });
}

void lorica_motion_free(lorica_motion* motion) {
  delete motion;
}

const char* lorica_motion_first_guess(const lorica_motion* motion) {
  return motion == nullptr ? "" : motion->firstGuess.c_str();
}

size_t lorica_motion_frame_count(const lorica_motion* motion) {
  return motion == nullptr ? 0 : motion->motion.times.size();
}

double lorica_motion_time(const lorica_motion* motion, size_t frame) {
  if (motion == nullptr) return 0.0;
  const std::vector<double>& times = motion->motion.times;
  return frame < times.size() ? times[frame] : times.back();
}
