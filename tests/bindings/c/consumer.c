/* A program in C11 that uses all of lorica.h: consumer FILES, the folder that files.cmake made. Exit status 1 and a line for
 * each check that fails. */
#include "check.h"
#include "lorica.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <threads.h>

static char folder[512];

static const char *path(const char *name) {
  static char whole[600];
  snprintf(whole, sizeof whole, "%s/%s", folder, name);
  return whole;
}

/* An L of three unit cubes. */
static const double kVertices[] = {0, 0, 0, 2, 0, 0, 2, 1, 0, 1, 1, 0, 1, 2, 0, 0, 2, 0,
                                   0, 0, 1, 2, 0, 1, 2, 1, 1, 1, 1, 1, 1, 2, 1, 0, 2, 1};
static const int32_t kTriangles[] = {2, 1, 0, 3, 2, 0, 4, 3, 0, 5, 4, 0, 6, 7, 8, 6, 8, 9, 6, 9, 10, 6, 10, 11,
                                     0, 1, 7, 0, 7, 6, 1, 2, 8, 1, 8, 7, 2, 3, 9, 2, 9, 8, 3, 4, 10, 3, 10, 9,
                                     4, 5, 11, 4, 11, 10, 5, 0, 6, 5, 6, 11};
static lorica_mesh l_shape(void) {
  lorica_mesh mesh = {sizeof mesh, kVertices, 12, kTriangles, 20, 0};
  return mesh;
}

static int cancel(void *user, int32_t done, int32_t wanted) {
  (void)wanted;
  *(int *)user += 1;
  return done < 1;
}

static void test_parts(void) {
  const lorica_mesh mesh = l_shape();
  lorica_decompose_options options = {.size = sizeof options, .parts = 2};
  lorica_parts *parts = NULL;
  CHECK(lorica_decompose(&mesh, &options, &parts) == LORICA_OK);
  CHECK(lorica_parts_count(parts) == 2);
  CHECK(fabs(lorica_parts_mesh_volume(parts) - 3) < 1e-9 && fabs(lorica_parts_hull_volume(parts) - 3) < 1e-9);
  CHECK(fabs(lorica_parts_error(parts)) < 1e-9 && strlen(lorica_parts_repaired(parts)) == 0);
  double volume = 0;
  for (size_t p = 0; p < 2; ++p) {
    lorica_hull hull = {.size = sizeof hull};
    CHECK(lorica_parts_hull(parts, p, &hull) == LORICA_OK);
    CHECK(hull.vertex_count >= 4 && hull.triangle_count == 2 * hull.vertex_count - 4);
    for (size_t i = 0; i < 3 * hull.triangle_count; ++i) CHECK((size_t)hull.triangles[i] < hull.vertex_count);
    volume += hull.volume;
  }
  CHECK(fabs(volume - 3) < 1e-9);
  CHECK(strlen(lorica_parts_warning(parts)) == 0 && strlen(lorica_parts_warning(NULL)) == 0);
  double thin[36]; /* legs of 0.1: an area of 0.39 in a hull of 2.195 */
  for (int i = 0; i < 36; ++i) thin[i] = i % 3 < 2 && kVertices[i] == 1 ? 0.1 : kVertices[i];
  lorica_mesh legs = mesh;
  legs.vertices = thin;
  for (options.parts = 1; options.parts <= 2; ++options.parts) {
    lorica_parts *whole = NULL;
    CHECK(lorica_decompose(&legs, &options, &whole) == LORICA_OK);
    const char *said = lorica_parts_warning(whole);
    CHECK(options.parts == 2 ? strlen(said) == 0 : strstr(said, "462.8 % more volume than the mesh") != NULL);
    lorica_parts_free(whole);
  }

  CHECK(lorica_parts_save(parts, path("c.lorica")) == LORICA_OK);
  lorica_parts *again = NULL;
  CHECK(lorica_parts_load(path("c.lorica"), &mesh, NULL, &again) == LORICA_OK);
  lorica_hull first = {.size = sizeof first}, second = {.size = sizeof second};
  lorica_parts_hull(parts, 1, &first);
  lorica_parts_hull(again, 1, &second);
  CHECK(first.vertex_count == second.vertex_count &&
        memcmp(first.vertices, second.vertices, 24 * first.vertex_count) == 0);
  lorica_parts_free(again);
  size_t count = 0, written = 0;
  CHECK(lorica_parts_bytes(parts, NULL, 0, &count) == LORICA_OK && count > 0);
  char* bytes = malloc(count);
  FAILS(LORICA_INVALID_ARGUMENT, "room: found 0 bytes", lorica_parts_bytes(parts, bytes, 0, &written));
  CHECK(lorica_parts_bytes(parts, bytes, count, &written) == LORICA_OK && written == count);
  CHECK(lorica_parts_from_bytes(bytes, count, &mesh, NULL, &again) == LORICA_OK);
  CHECK(lorica_parts_hash(again) == lorica_parts_hash(parts));
  lorica_parts_free(again);
  FAILS(LORICA_BAD_FORMAT, "bytes", lorica_parts_from_bytes(bytes, count - 9, &mesh, NULL, &again));
  free(bytes);
  FAILS(LORICA_UNWRITABLE, "nowhere", lorica_parts_save(parts, path("nowhere/c.lorica")));
  FAILS(LORICA_INVALID_ARGUMENT, "part 2: found 2", lorica_parts_hull(parts, 2, &first));
  FAILS(LORICA_INVALID_ARGUMENT, "out is null", lorica_parts_hull(parts, 0, NULL));
  lorica_parts_free(parts);
  lorica_parts_free(NULL);
}

/* A mesh in several frames: twice as high in each. */
static void test_frames(void) {
  enum { kFrames = 4 };
  double frames[kFrames][36];
  for (int f = 0; f < kFrames; ++f) {
    for (int i = 0; i < 36; ++i) frames[f][i] = (i % 3 == 1 ? 1 << f : 1) * kVertices[i];
  }
  lorica_mesh mesh = l_shape();
  mesh.vertices = frames[0];
  mesh.frame_count = kFrames;
  lorica_decompose_options options = {.size = sizeof options, .parts = 2, .keyframes = 2};
  lorica_parts *parts = NULL, *again = NULL;
  CHECK(lorica_decompose(&mesh, &options, &parts) == LORICA_OK);
  CHECK(lorica_parts_count(parts) == 2 && lorica_parts_frame_count(parts) == kFrames && lorica_parts_hash(parts) != 0);
  for (size_t f = 0; f < kFrames; ++f) {
    double volume = 0;
    for (size_t p = 0; p < 2; ++p) {
      lorica_hull hull = {.size = sizeof hull};
      CHECK(lorica_parts_hull_in_frame(parts, f, p, &hull) == LORICA_OK);
      volume += hull.volume;
    }
    CHECK(fabs(volume - 3.0 * (1 << f)) < 1e-5 && fabs(lorica_parts_error_in_frame(parts, f)) < 1e-5);
  }
  CHECK(fabs(lorica_parts_mesh_volume(parts) - 3) < 1e-9 && lorica_parts_error_in_frame(parts, kFrames) == 0);
  CHECK(lorica_parts_save(parts, path("frames.lorica")) == LORICA_OK);
  CHECK(lorica_parts_load(path("frames.lorica"), &mesh, NULL, &again) == LORICA_OK);
  CHECK(lorica_parts_hash(again) == lorica_parts_hash(parts));
  lorica_hull hull = {.size = sizeof hull};
  FAILS(LORICA_INVALID_ARGUMENT, "frame 4: found 4", lorica_parts_hull_in_frame(parts, kFrames, 0, &hull));
  options.keyframes = 5;
  FAILS(LORICA_INVALID_ARGUMENT, "at most 4", lorica_decompose(&mesh, &options, &again));
  options = (lorica_decompose_options){.size = sizeof options, .hull_vertices = 8};
  FAILS(LORICA_INVALID_ARGUMENT, "hull_vertices", lorica_decompose(&mesh, &options, &again));
  frames[2][5] = NAN;
  FAILS(LORICA_BAD_MESH, "frame 2, vertex 1: z is nan", lorica_decompose(&mesh, NULL, &again));
  lorica_parts_free(again);
  lorica_parts_free(parts);
}

static void test_bad_meshes(void) {
  lorica_parts *parts = NULL;
  lorica_mesh mesh = l_shape();
  FAILS(LORICA_INVALID_ARGUMENT, "mesh is null", lorica_decompose(NULL, NULL, &parts));
  FAILS(LORICA_INVALID_ARGUMENT, "out is null", lorica_decompose(&mesh, NULL, NULL));
  mesh.size = 8;
  FAILS(LORICA_INVALID_ARGUMENT, "mesh.size: found 8", lorica_decompose(&mesh, NULL, &parts));
  mesh = l_shape();
  mesh.vertices = NULL;
  FAILS(LORICA_INVALID_ARGUMENT, "null", lorica_decompose(&mesh, NULL, &parts));
  mesh = l_shape();
  mesh.vertex_count = 11;
  FAILS(LORICA_BAD_MESH, "found vertex 11, expected 0 to 10", lorica_decompose(&mesh, NULL, &parts));
  double broken[36];
  memcpy(broken, kVertices, sizeof broken);
  broken[4] = NAN;
  mesh = l_shape();
  mesh.vertices = broken;
  FAILS(LORICA_BAD_MESH, "vertex 1: y is nan", lorica_decompose(&mesh, NULL, &parts));
  mesh = l_shape();
  mesh.triangle_count = 18; /* one missing triangle would be closed */
  lorica_decompose_options options = {.size = sizeof options, .closed_body = LORICA_CLOSED_NEVER};
  FAILS(LORICA_BAD_MESH, "open", lorica_decompose(&mesh, &options, &parts));
  mesh = l_shape();
  options.preset = 7;
  FAILS(LORICA_INVALID_ARGUMENT, "preset: found 7", lorica_decompose(&mesh, &options, &parts));
  options.preset = LORICA_FAST;
  options.hull_vertices = 2;
  FAILS(LORICA_INVALID_ARGUMENT, "found 2, expected at least 4", lorica_decompose(&mesh, &options, &parts));
  options.hull_vertices = 0;
  options.hull_planes = 3;
  FAILS(LORICA_INVALID_ARGUMENT, "planes of a hull: found 3", lorica_decompose(&mesh, &options, &parts));
  int calls = 0;
  options = (lorica_decompose_options){.size = sizeof options, .progress = cancel, .user = &calls};
  FAILS(LORICA_CANCELLED, "cancel", lorica_decompose(&mesh, &options, &parts));
  CHECK(calls > 0 && parts == NULL);
}

static lorica_character *mannequin = NULL;
static lorica_body *body = NULL;

static void test_characters(void) {
  CHECK(lorica_character_read("mannequin", &mannequin) == LORICA_OK);
  CHECK(lorica_character_joint_count(mannequin) == 52 && lorica_character_height(mannequin) > 1.5);
  CHECK(lorica_character_joint_parent(mannequin, 0) == -1 && lorica_character_joint_name(mannequin, 52) == NULL);
  for (size_t j = 1; j < 52; ++j) CHECK(lorica_character_joint_parent(mannequin, j) < (int32_t)j);
  lorica_character *hero = NULL;
  CHECK(lorica_character_read(path("hero.glb"), &hero) == LORICA_OK);
  CHECK(lorica_character_clip_count(hero) == 2 && strcmp(lorica_character_clip_name(hero, 1), "Nod") == 0);
  CHECK(strstr(lorica_character_first_guess(hero), "it faces +Z") != NULL);
  CHECK(strcmp(lorica_character_first_guess(mannequin), "") == 0);
  FAILS(LORICA_NOT_FOUND, "nobody", lorica_character_read("nobody", &hero));
  FAILS(LORICA_BAD_FORMAT, "its reader", lorica_character_read(path("cycle.dae"), &hero));
  FAILS(LORICA_INVALID_ARGUMENT, "a mesh without skin", lorica_character_read(path("triangle.dae"), &hero));

  lorica_character *bucket = NULL;
  lorica_body *pail = NULL;
  lorica_character_options reading = {.size = sizeof reading, .walls = LORICA_CHARACTER_AUTO, .thickness = 0.02};
  CHECK(lorica_character_read_with(path("bucket.glb"), &reading, &bucket) == LORICA_OK);
  CHECK(strstr(lorica_character_notes(bucket), "thin wall of 20.00 mm") != NULL);
  CHECK(lorica_body_load(bucket, path("bucket.lorica"), &pail) == LORICA_OK);
  lorica_body_free(pail);
  lorica_character_free(bucket);
  CHECK(lorica_character_read(path("bucket.glb"), &bucket) == LORICA_OK);
  CHECK(strstr(lorica_character_notes(bucket), "thin wall") == NULL);
  FAILS(LORICA_INVALID_ARGUMENT, "made from", lorica_body_load(bucket, path("bucket.lorica"), &pail));
  lorica_character_free(bucket);
  const char *const names[] = {"Pail", NULL};
  reading = (lorica_character_options){.size = sizeof reading, .hidden = names, .hidden_count = 1};
  CHECK(lorica_character_read_with(path("bucket.glb"), &reading, &bucket) == LORICA_OK);
  lorica_mesh bare = {.size = sizeof bare}, whole = {.size = sizeof whole};
  CHECK(lorica_character_mesh(bucket, &bare) == LORICA_OK && lorica_character_mesh(mannequin, &whole) == LORICA_OK);
  CHECK(bare.triangle_count == whole.triangle_count);
  lorica_character_free(bucket);
  reading.hidden_count = 2;
  FAILS(LORICA_INVALID_ARGUMENT, "hidden 1 is null", lorica_character_read_with(path("bucket.glb"), &reading, &bucket));
  reading = (lorica_character_options){.size = sizeof reading, .expression_count = 1};
  FAILS(LORICA_INVALID_ARGUMENT, "expressions is null",
        lorica_character_read_with(path("bucket.glb"), &reading, &bucket));
  reading = (lorica_character_options){.size = sizeof reading, .walls = 3};
  FAILS(LORICA_INVALID_ARGUMENT, "walls: found 3", lorica_character_read_with(path("bucket.glb"), &reading, &bucket));
  reading = (lorica_character_options){.size = sizeof reading, .map = "no_map.json"};
  FAILS(LORICA_NOT_FOUND, "no_map.json", lorica_character_read_with(path("hero.glb"), &reading, &bucket));
  reading = (lorica_character_options){.size = sizeof reading, .body_resolution = -1};
  FAILS(LORICA_INVALID_ARGUMENT, "body_resolution: found -1",
        lorica_character_read_with(path("hero.glb"), &reading, &bucket));

  CHECK(lorica_body_load(mannequin, path("body.lorica"), &body) == LORICA_OK);
  CHECK(lorica_body_part_count(body) == 4);
  CHECK(strstr(lorica_body_warning(body), "more volume than the mesh") != NULL); /* of so few parts */
  CHECK(strlen(lorica_body_warning(NULL)) == 0);
  lorica_body *other = NULL;
  FAILS(LORICA_INVALID_ARGUMENT, "made from mannequin", lorica_body_load(hero, path("body.lorica"), &other));
  lorica_body_options options = {.size = sizeof options, .parts = 2, .hull_vertices = 3};
  FAILS(LORICA_INVALID_ARGUMENT, "found 3, expected at least 4", lorica_body_make(hero, &options, &other));
  int calls = 0;
  options = (lorica_body_options){.size = sizeof options, .parts = 3, .progress = cancel, .user = &calls};
  FAILS(LORICA_CANCELLED, "cancel", lorica_body_make(hero, &options, &other));
  lorica_motion *motion = NULL;
  FAILS(LORICA_NOT_FOUND, "no shipped recording", lorica_motion_read(hero, "stroll", NULL, &motion));
  const lorica_motion_options clip = {.size = sizeof clip, .clip = "Run"};
  FAILS(LORICA_NOT_FOUND, "expected one of Bow, Nod", lorica_motion_read(hero, path("hero.glb"), &clip, &motion));
  CHECK(lorica_motion_read(hero, path("hero.glb"), NULL, &motion) == LORICA_OK);
  CHECK(strstr(lorica_motion_first_guess(motion), "the body faces +Z at first") != NULL);
  lorica_live *live = NULL;
  CHECK(lorica_live_make(body, &live) == LORICA_OK);
  FAILS(LORICA_INVALID_ARGUMENT, "another character", lorica_live_play(live, motion, 0));
  lorica_live_free(live);
  lorica_motion_free(motion);
  lorica_character_free(hero);
}

/* The L as a skinned mesh: its upper cube follows a joint of its own. */
static void test_made_characters(void) {
  int32_t joints[12];
  double weights[12], poses[3][32] = {{0}}, inverse_bind[32] = {0};
  for (int v = 0; v < 12; ++v) {
    joints[v] = kVertices[3 * v + 1] == 2;
    weights[v] = 7; /* of any sum */
  }
  for (int i = 0; i < 8; ++i) inverse_bind[i / 4 * 16 + i % 4 * 5] = 1;
  for (int p = 0; p < 3; ++p) {
    memcpy(poses[p], inverse_bind, sizeof inverse_bind);
    poses[p][16 + 13] = 0.5 * p; /* the upper joint rises */
  }
  lorica_skin skin = {.size = sizeof skin,
                      .vertices = kVertices,
                      .vertex_count = 12,
                      .triangles = kTriangles,
                      .triangle_count = 20,
                      .joints = joints,
                      .weights = weights,
                      .joints_per_vertex = 1,
                      .joint_from_model = inverse_bind,
                      .joint_count = 2,
                      .poses = poses[0],
                      .pose_count = 3};
  lorica_character* made = NULL;
  lorica_body *own = NULL, *again = NULL;
  lorica_live* live = NULL;
  CHECK(lorica_character_make(&skin, NULL, &made) == LORICA_OK);
  CHECK(strcmp(lorica_character_name(made), "character") == 0 && lorica_character_joint_count(made) == 2);
  const lorica_body_options options = {.size = sizeof options, .parts = 2};
  CHECK(lorica_body_make(made, &options, &own) == LORICA_OK && lorica_body_part_count(own) == 2);
  size_t count = 0, written = 0;
  CHECK(lorica_body_bytes(own, NULL, 0, &count) == LORICA_OK && count > 0);
  char* bytes = malloc(count);
  FAILS(LORICA_INVALID_ARGUMENT, "room: found 1", lorica_body_bytes(own, bytes, 1, &written));
  CHECK(lorica_body_bytes(own, bytes, count, &written) == LORICA_OK && written == count);
  CHECK(lorica_body_from_bytes(made, bytes, count, &again) == LORICA_OK);
  FAILS(LORICA_INVALID_ARGUMENT, "made from", lorica_body_from_bytes(mannequin, bytes, count, &again));
  free(bytes);
  CHECK(lorica_live_make(again, &live) == LORICA_OK);
  poses[0][16 + 13] = 1.75; /* not among the poses */
  CHECK(lorica_live_pose(live, poses[0], 2) == LORICA_OK);
  for (int v = 0; v < 12; ++v) {
    const double y = kVertices[3 * v + 1] + 1.75 * joints[v];
    bool inside = false;
    for (size_t p = 0; p < 2; ++p) {
      lorica_hull hull = {.size = sizeof hull};
      CHECK(lorica_live_hull(live, p, &hull) == LORICA_OK);
      bool in = true;
      for (size_t t = 0; t < hull.triangle_count; ++t) {
        const double *a = hull.vertices + 3 * hull.triangles[3 * t], *b = hull.vertices + 3 * hull.triangles[3 * t + 1],
                     *c = hull.vertices + 3 * hull.triangles[3 * t + 2];
        const double e[] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, f[] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
        const double height = (e[1] * f[2] - e[2] * f[1]) * (kVertices[3 * v] - a[0]) +
                              (e[2] * f[0] - e[0] * f[2]) * (y - a[1]) +
                              (e[0] * f[1] - e[1] * f[0]) * (kVertices[3 * v + 2] - a[2]);
        in = in && height < 1e-9;
      }
      inside = inside || in;
    }
    CHECK(inside);
  }
  lorica_live_free(live);
  lorica_body_free(again);
  lorica_body_free(own);
  lorica_character_free(made);
  joints[0] = 2;
  FAILS(LORICA_INVALID_ARGUMENT, "vertex 0: found joint 2, expected 0 to 1", lorica_character_make(&skin, NULL, &made));
  joints[0] = 0;
  weights[0] = 0;
  FAILS(LORICA_INVALID_ARGUMENT, "vertex 0: no joint has a weight above 0", lorica_character_make(&skin, NULL, &made));
  weights[0] = 1;
  inverse_bind[3] = NAN;
  FAILS(LORICA_INVALID_ARGUMENT, "inverse bind matrix of joint 0", lorica_character_make(&skin, NULL, &made));
  inverse_bind[3] = 0;
  poses[1][19] = 1;
  FAILS(LORICA_INVALID_ARGUMENT, "the matrix of joint 1 in pose 1", lorica_character_make(&skin, NULL, &made));
  skin.pose_count = 0;
  FAILS(LORICA_INVALID_ARGUMENT, "pose_count is 0", lorica_character_make(&skin, NULL, &made));
  skin.pose_count = 3;
  skin.joint_count = 0;
  FAILS(LORICA_INVALID_ARGUMENT, "found 0 joints", lorica_character_make(&skin, NULL, &made));
  skin.weights = NULL;
  FAILS(LORICA_INVALID_ARGUMENT, "skin.weights is null", lorica_character_make(&skin, NULL, &made));
}

/* The hulls of 40 frames, as tests/bindings/truth.cpp writes those of a session. */
static void compare(const char *motion_name, const char *truth) {
  lorica_motion *motion = NULL;
  lorica_live *live = NULL;
  CHECK(lorica_motion_read(mannequin, motion_name, NULL, &motion) == LORICA_OK);
  CHECK(lorica_live_make(body, &live) == LORICA_OK);
  FILE *file = fopen(path(truth), "rb");
  CHECK(file != NULL);
  static char expected[1 << 20];
  for (size_t frame = 0; file != NULL && frame < 40; ++frame) {
    CHECK(lorica_live_play(live, motion, frame) == LORICA_OK);
    for (size_t p = 0; p < 4; ++p) {
      lorica_hull hull = {.size = sizeof hull};
      CHECK(lorica_live_hull(live, p, &hull) == LORICA_OK);
      int32_t counts[2] = {-1, -1};
      CHECK(fread(counts, sizeof counts, 1, file) == 1);
      CHECK((size_t)counts[0] == hull.vertex_count && (size_t)counts[1] == hull.triangle_count);
      CHECK(fread(expected, 24, hull.vertex_count, file) == hull.vertex_count);
      CHECK(memcmp(expected, hull.vertices, 24 * hull.vertex_count) == 0);
      CHECK(fread(expected, 12, hull.triangle_count, file) == hull.triangle_count);
      CHECK(memcmp(expected, hull.triangles, 12 * hull.triangle_count) == 0);
    }
  }
  if (file != NULL) fclose(file);
  lorica_live_free(live);
  lorica_motion_free(motion);
}

/* A ray at the middle of each hull enters where the hull's own faces are. */
static void test_rays(void) {
  lorica_motion *motion = NULL;
  lorica_live *live = NULL;
  CHECK(lorica_motion_read(mannequin, "walk", NULL, &motion) == LORICA_OK);
  CHECK(lorica_live_make(body, &live) == LORICA_OK);
  double rays[12] = {0, 1, 3, 0, 0, -1, 0, 1, 3, NAN, 0, 1}, distances[2], positions[6], normals[6];
  int32_t parts[2] = {7, 7};
  CHECK(lorica_live_cast_rays(live, rays, 1, INFINITY, 0, NULL, parts, distances, NULL, NULL) == LORICA_OK);
  CHECK(parts[0] == -1 && isinf(distances[0])); /* no pose yet */
  lorica_mesh mesh = {.size = sizeof mesh};
  CHECK(lorica_character_mesh(mannequin, &mesh) == LORICA_OK);
  CHECK(mesh.vertex_count > 1000 && mesh.triangles[3 * mesh.triangle_count - 1] < (int32_t)mesh.vertex_count);
  size_t hits = 0, skins = 0;
  for (size_t frame = 0; frame < 40; ++frame) {
    CHECK(lorica_live_play(live, motion, frame) == LORICA_OK);
    const long before = allocations;
    for (size_t p = 0; p < lorica_body_part_count(body); ++p) {
      lorica_hull hull = {.size = sizeof hull};
      CHECK(lorica_live_hull(live, p, &hull) == LORICA_OK);
      for (int axis = 0; axis < 3; ++axis) {
        double sum = 0;
        for (size_t v = 0; v < hull.vertex_count; ++v) sum += hull.vertices[3 * v + axis];
        rays[3 + axis] = sum / hull.vertex_count - rays[axis];
      }
      CHECK(lorica_live_cast_rays(live, rays, 2, INFINITY, 0, NULL, parts, distances, positions, normals) == LORICA_OK);
      CHECK(parts[0] >= 0 && parts[1] == -1);
      /* The skin is behind the hull, where the corners' weights say. */
      int32_t triangles[2];
      double weights[6], skin[2], points[6];
      CHECK(lorica_live_cast_on_skin(live, rays, 2, INFINITY, triangles, weights, skin, points) == LORICA_OK);
      CHECK(triangles[0] < (int32_t)mesh.triangle_count && triangles[1] == -1 && isinf(skin[1]));
      CHECK(skin[0] > distances[0] - 1e-6);
      if (triangles[0] >= 0) {
        CHECK(fabs(weights[0] + weights[1] + weights[2] - 1) < 1e-12);
        CHECK(fabs(hypot(hypot(points[0] - rays[0], points[1] - rays[1]), points[2] - rays[2]) - skin[0]) < 1e-9);
        ++skins;
      }
      /* A ball touches before its middle would enter, a capsule beside it no later than the ball. */
      const double half[3] = {0.1, 0, 0};
      double ball[2], capsule[2];
      int32_t touched[2];
      CHECK(lorica_live_cast_rays(live, rays, 2, INFINITY, 0.05, NULL, touched, ball, NULL, NULL) == LORICA_OK);
      CHECK(ball[0] < distances[0] - 0.049 && isinf(ball[1]));
      CHECK(lorica_live_cast_rays(live, rays, 2, INFINITY, 0.05, half, touched, capsule, NULL, NULL) == LORICA_OK);
      CHECK(capsule[0] <= ball[0] + 1e-9);
      CHECK(lorica_live_hull(live, (size_t)parts[0], &hull) == LORICA_OK);
      /* No vertex is beyond the plane through the hit. */
      for (size_t v = 0; v < hull.vertex_count; ++v) {
        double beyond = 0;
        for (int axis = 0; axis < 3; ++axis) beyond += normals[axis] * (hull.vertices[3 * v + axis] - positions[axis]);
        CHECK(beyond < 1e-9);
      }
      ++hits;
    }
    if (frame > 0) CHECK(allocations == before);
  }
  CHECK(hits == 40 * lorica_body_part_count(body) && skins > hits / 2);
  FAILS(LORICA_INVALID_ARGUMENT, "triangles", lorica_live_cast_on_skin(live, rays, 1, 1, NULL, NULL, NULL, NULL));
  FAILS(LORICA_INVALID_ARGUMENT, "character", lorica_character_mesh(NULL, &mesh));
  CHECK(lorica_live_cast_rays(live, NULL, 0, 1, 0, NULL, NULL, NULL, NULL, NULL) == LORICA_OK);
  FAILS(LORICA_INVALID_ARGUMENT, "rays", lorica_live_cast_rays(live, NULL, 1, 1, 0, NULL, parts, NULL, NULL, NULL));
  FAILS(LORICA_INVALID_ARGUMENT, "parts", lorica_live_cast_rays(live, rays, 1, 1, 0, NULL, NULL, NULL, NULL, NULL));
  FAILS(LORICA_INVALID_ARGUMENT, "reach: found -1", lorica_live_cast_rays(live, rays, 1, -1, 0, NULL, parts, NULL, NULL, NULL));
  FAILS(LORICA_INVALID_ARGUMENT, "reach: found nan", lorica_live_cast_rays(live, rays, 1, NAN, 0, NULL, parts, NULL, NULL, NULL));
  FAILS(LORICA_INVALID_ARGUMENT, "radius: found -1",
        lorica_live_cast_rays(live, rays, 1, 1, -1, NULL, parts, NULL, NULL, NULL));
  lorica_live_free(live);
  lorica_motion_free(motion);
}

/* Velocities against differences, and the points of what is swept against the hulls of both poses. */
static void test_part_motion(void) {
  lorica_motion *motion = NULL;
  lorica_live *live = NULL;
  CHECK(lorica_motion_read(mannequin, "walk", NULL, &motion) == LORICA_OK);
  CHECK(lorica_live_make(body, &live) == LORICA_OK);
  lorica_part_motion moved = {.size = sizeof moved};
  FAILS(LORICA_INVALID_ARGUMENT, "no pose yet", lorica_live_part_motion(live, 0, 0.1, &moved));
  double *before = malloc(sizeof(double) * 3 * 20000);
  size_t before_count = 0;
  double fastest = 0;
  for (size_t frame = 0; frame < 40; ++frame) {
    const long allocated = allocations;
    CHECK(lorica_live_play(live, motion, frame) == LORICA_OK);
    for (size_t p = 0; p < lorica_body_part_count(body); ++p) {
      lorica_hull hull = {.size = sizeof hull};
      CHECK(lorica_live_hull(live, p, &hull) == LORICA_OK);
      CHECK(lorica_live_part_motion(live, p, 1.0 / 30, &moved) == LORICA_OK);
      CHECK(moved.present_count == hull.vertex_count);
      CHECK(memcmp(moved.points, hull.vertices, 3 * sizeof(double) * hull.vertex_count) == 0);
      for (int axis = 0; axis < 3; ++axis) {
        const double way = moved.world_from_part[12 + axis] - moved.previous_world_from_part[12 + axis];
        CHECK(fabs(30 * way - moved.linear_velocity[axis]) < 1e-9);
        if (way > fastest) fastest = way;
        /* Of a small turn the angular velocity is that of the axes: w x e. */
        const double *e = moved.previous_world_from_part, *w = moved.angular_velocity, *now = moved.world_from_part;
        const int y = (axis + 1) % 3, z = (axis + 2) % 3;
        CHECK(fabs(30 * (now[axis] - e[axis]) - (w[y] * e[z] - w[z] * e[y])) < 0.02 * (fabs(w[0]) + fabs(w[1]) + fabs(w[2])) + 1e-9);
      }
      if (p != 0) continue;
      if (frame > 0) {
        CHECK(moved.point_count == hull.vertex_count + before_count);
        double difference = 0;
        for (size_t i = 0; i < 3 * before_count; ++i) {
          difference = fmax(difference, fabs(before[i] - moved.points[3 * hull.vertex_count + i]));
        }
        CHECK(difference < 1e-12);
      }
      before_count = hull.vertex_count;
      CHECK(before_count < 20000);
      memcpy(before, hull.vertices, 3 * sizeof(double) * hull.vertex_count);
    }
    if (frame > 1) CHECK(allocations == allocated);
  }
  CHECK(fastest > 0.001);
  FAILS(LORICA_INVALID_ARGUMENT, "seconds: found 0", lorica_live_part_motion(live, 0, 0, &moved));
  FAILS(LORICA_INVALID_ARGUMENT, "part 99", lorica_live_part_motion(live, 99, 1, &moved));
  moved.size = 1;
  FAILS(LORICA_INVALID_ARGUMENT, "out.size", lorica_live_part_motion(live, 0, 1, &moved));
  free(before);
  lorica_live_free(live);
  lorica_motion_free(motion);
}

/* What a capsule touches in 40 frames, as tests/bindings/truth.cpp writes it of a session. */
static void test_touches(void) {
  lorica_motion *motion = NULL;
  lorica_live *live = NULL;
  CHECK(lorica_motion_read(mannequin, "walk", NULL, &motion) == LORICA_OK);
  CHECK(lorica_live_make(body, &live) == LORICA_OK);
  double ends[] = {-1.5, 0.9, 0.1, 0.2, 1.1, -0.1};
  lorica_shape capsule = {.size = sizeof capsule, .points = ends, .point_count = 2, .radius = 0.06};
  lorica_touch touch = {.size = sizeof touch};
  size_t count = 7, all = 0;
  CHECK(lorica_live_find_touches(live, &capsule, &count) == LORICA_OK && count == 0); /* no pose yet */
  FILE *file = fopen(path("walk_csv.touches"), "rb");
  CHECK(file != NULL);
  for (size_t frame = 0; file != NULL && frame < 40; ++frame) {
    const long before = allocations;
    CHECK(lorica_live_play(live, motion, frame) == LORICA_OK);
    CHECK(lorica_live_find_touches(live, &capsule, &count) == LORICA_OK);
    if (frame > 0) CHECK(allocations == before);
    int32_t expected = -1, part = -1;
    CHECK(fread(&expected, sizeof expected, 1, file) == 1 && (size_t)expected == count);
    for (size_t i = 0; i < count; ++i, ++all) {
      double numbers[7];
      CHECK(fread(&part, sizeof part, 1, file) == 1 && fread(numbers, sizeof numbers, 1, file) == 1);
      CHECK(lorica_live_touch(live, i, &touch) == LORICA_OK && touch.part == (size_t)part);
      CHECK(memcmp(numbers, touch.position, 24) == 0 && memcmp(numbers + 3, touch.direction, 24) == 0);
      CHECK(numbers[6] == touch.depth);
    }
  }
  CHECK(all >= 40);
  if (file != NULL) fclose(file);
  FAILS(LORICA_INVALID_ARGUMENT, "touch", lorica_live_touch(live, count, &touch));
  capsule.radius = -1;
  FAILS(LORICA_INVALID_ARGUMENT, "radius: found -1", lorica_live_find_touches(live, &capsule, &count));
  capsule.radius = 0;
  capsule.point_count = 0;
  FAILS(LORICA_INVALID_ARGUMENT, "points: found none", lorica_live_find_touches(live, &capsule, &count));
  capsule.point_count = 2;
  ends[4] = NAN;
  FAILS(LORICA_INVALID_ARGUMENT, "point 1: found", lorica_live_find_touches(live, &capsule, &count));
  lorica_live_free(live);
  lorica_motion_free(motion);
}

static double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static void test_live(void) {
  lorica_motion *motion = NULL;
  lorica_live *live = NULL, *twin = NULL;
  CHECK(lorica_motion_read(mannequin, "punch_and_kick", NULL, &motion) == LORICA_OK);
  CHECK(lorica_live_make(body, &live) == LORICA_OK && lorica_live_make(body, &twin) == LORICA_OK);
  lorica_hull hull = {.size = sizeof hull};
  double point[3] = {0}, down[3] = {0, -1, 0}, zero[3] = {0};
  CHECK(lorica_live_hull(live, 0, &hull) == LORICA_OK && hull.vertex_count == 0);
  FAILS(LORICA_INVALID_ARGUMENT, "no pose yet", lorica_live_support(live, 0, down, point));

  const size_t frames = lorica_motion_frame_count(motion);
  size_t contacts = 0;
  for (int round = 0; round < 2; ++round) {
    const long before = allocations;
    for (size_t frame = 0; frame < frames; ++frame) {
      size_t found = 0;
      lorica_live_play(live, motion, frame);
      for (size_t p = 0; p < 4; ++p) lorica_live_hull(live, p, &hull);
      lorica_live_find_contacts(live, &found);
      contacts += found;
      for (size_t c = 0; c < found; ++c) {
        lorica_contact contact = {.size = sizeof contact};
        CHECK(lorica_live_contact(live, c, &contact) == LORICA_OK);
        CHECK(contact.first < contact.second && contact.depth > 0);
        CHECK(fabs(dot(contact.direction, contact.direction) - 1) < 1e-6);
      }
    }
    if (round == 1) CHECK(allocations == before);
  }
  CHECK(contacts > 0);

  static double transforms[52 * 16];
  CHECK(lorica_live_transforms(live, transforms, 52) == LORICA_OK);
  /* Also where the numbers are not aligned for vectors. */
  static double shifted[52 * 16 + 1];
  memcpy(shifted + 1, transforms, sizeof transforms);
  CHECK(lorica_live_pose(twin, shifted + 1, 52) == LORICA_OK);
  lorica_hull other = {.size = sizeof other};
  for (size_t p = 0; p < 4; ++p) {
    lorica_live_hull(live, p, &hull);
    lorica_live_hull(twin, p, &other);
    CHECK(fabs(hull.volume - other.volume) < 1e-9);
    CHECK(lorica_live_support(live, p, down, point) == LORICA_OK);
    for (size_t v = 0; v < hull.vertex_count; ++v) CHECK(dot(hull.vertices + 3 * v, down) <= dot(point, down) + 1e-9);
  }
  CHECK(lorica_live_play_at(live, motion, lorica_motion_time(motion, 3)) == LORICA_OK);
  lorica_live_play(twin, motion, 3);
  static double asked[52 * 16], played[52 * 16];
  lorica_live_transforms(live, asked, 52);
  lorica_live_transforms(twin, played, 52);
  for (size_t i = 0; i < 52 * 16; ++i) CHECK(fabs(asked[i] - played[i]) < 1e-9);

  FAILS(LORICA_INVALID_ARGUMENT, "frame", lorica_live_play(live, motion, frames));
  FAILS(LORICA_INVALID_ARGUMENT, "finite", lorica_live_play_at(live, motion, NAN));
  FAILS(LORICA_INVALID_ARGUMENT, "joint_count: found 51, expected 52", lorica_live_pose(live, transforms, 51));
  FAILS(LORICA_INVALID_ARGUMENT, "direction", lorica_live_support(live, 0, zero, point));
  transforms[17] = INFINITY;
  FAILS(LORICA_INVALID_ARGUMENT, "joint 1", lorica_live_pose(live, transforms, 52));
  lorica_live_free(twin);
  lorica_live_free(live);
  lorica_motion_free(motion);
}

static void test_tracker(void) {
  FILE *file = fopen(path("depth"), "rb");
  CHECK(file != NULL);
  if (file == NULL) return;
  int32_t size[2];
  double fov[2];
  CHECK(fread(size, sizeof size, 1, file) == 1 && fread(fov, sizeof fov, 1, file) == 1);
  const lorica_tracker_options options = {
      .size = sizeof options, .width = size[0], .height = size[1], .horizontal_fov = fov[0], .vertical_fov = fov[1]};
  lorica_tracker *tracker = NULL;
  CHECK(lorica_tracker_make(&options, &tracker) == LORICA_OK);
  const size_t pixels = (size_t)size[0] * (size_t)size[1];
  uint16_t *depth = calloc(pixels, sizeof *depth);
  size_t seen = 0, people = 0;
  double time = 0;
  while (fread(&time, sizeof time, 1, file) == 1) {
    CHECK(fread(depth, sizeof *depth, pixels, file) == pixels);
    CHECK(lorica_tracker_track(tracker, time, depth, pixels, &people) == LORICA_OK);
    int32_t expected = -1;
    CHECK(fread(&expected, sizeof expected, 1, file) == 1 && (size_t)expected == people);
    for (size_t i = 0; i < people; ++i, ++seen) {
      lorica_person person = {.size = sizeof person};
      CHECK(lorica_tracker_person(tracker, i, &person) == LORICA_OK);
      double joints[15][4];
      CHECK(fread(joints, sizeof joints, 1, file) == 1);
      for (int j = 0; j < LORICA_JOINT_COUNT; ++j) {
        CHECK(memcmp(joints[j], person.positions[j], sizeof person.positions[j]) == 0);
        CHECK(joints[j][3] == person.confidences[j]);
      }
    }
  }
  CHECK(seen > 0);
  FAILS(LORICA_INVALID_ARGUMENT, "that of the last image",
        lorica_tracker_track(tracker, time - 1, depth, pixels, &people));
  FAILS(LORICA_INVALID_ARGUMENT, "pixel_count: found 3", lorica_tracker_track(tracker, time + 1, depth, 3, &people));
  const lorica_tracker_options crowd = {.size = sizeof crowd, .max_people = 99};
  lorica_tracker *none = NULL;
  FAILS(LORICA_INVALID_ARGUMENT, "99", lorica_tracker_make(&crowd, &none));
  free(depth);
  fclose(file);
  lorica_tracker_free(tracker);
}

/* Each thread has its own last error. */
static int fail_elsewhere(void *unused) {
  (void)unused;
  lorica_character *nobody = NULL;
  const bool own = strlen(lorica_last_error()) == 0;
  lorica_character_read("elsewhere", &nobody);
  return own && strstr(lorica_last_error(), "elsewhere") != NULL;
}

static void test_threads(void) {
  lorica_character *nobody = NULL;
  FAILS(LORICA_NOT_FOUND, "here", lorica_character_read("here", &nobody));
  thrd_t thread;
  int own = 0;
  CHECK(thrd_create(&thread, fail_elsewhere, NULL) == thrd_success && thrd_join(thread, &own) == thrd_success && own);
  CHECK(strncmp(lorica_last_error(), "here", 4) == 0);
}

/* 100 bytes a call would be seen: less than a part or its file. */
static void test_leaks(void) {
  const lorica_mesh mesh = l_shape();
  const lorica_decompose_options options = {.size = sizeof options, .parts = 1, .threads = 1};
  long kilobytes[2];
  for (int round = 0; round < 2; ++round) {
    for (int call = 0; call < 5000; ++call) {
      lorica_parts *parts = NULL;
      lorica_decompose(&mesh, &options, &parts);
      lorica_parts_free(parts);
    }
    FILE *status = fopen("/proc/self/status", "r");
    char line[200];
    while (status != NULL && fgets(line, sizeof line, status) != NULL) {
      if (strncmp(line, "VmHWM:", 6) == 0) kilobytes[round] = atol(line + 6);
    }
    if (status != NULL) fclose(status);
  }
  CHECK(kilobytes[1] - kilobytes[0] < 500);
}

int main(int argc, char **argv) {
  if (argc != 2) return 2;
  snprintf(folder, sizeof folder, "%s", argv[1]);
  CHECK(strlen(lorica_version()) >= 5 && strlen(lorica_last_error()) == 0);
  test_parts();
  test_frames();
  test_bad_meshes();
  test_characters();
  test_made_characters();
  compare("walk", "walk_csv.hulls");
  compare(path("walk.bvh"), "walk_bvh.hulls");
  test_rays();
  test_part_motion();
  test_touches();
  test_live();
  test_tracker();
  test_threads();
  lorica_character_free(mannequin); /* the body keeps what it needs */
  lorica_live *live = NULL;
  CHECK(lorica_live_make(body, &live) == LORICA_OK);
  lorica_body_free(body);
  lorica_hull hull = {.size = sizeof hull};
  CHECK(lorica_live_hull(live, 3, &hull) == LORICA_OK);
  lorica_live_free(live);
  test_leaks();
  return failures == 0 ? 0 : 1;
}
