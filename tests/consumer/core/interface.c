/* The C interface of the core alone (LORICA_CORE), as its library has it on another system: prints hashes of the parts, hulls and
 * rays of a tube, which tests/web/package_test.mjs makes too. Exit status 1 and a line for each check that fails. */
#include "lorica.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int failures;
#define CHECK(condition)                                                                  \
  ((condition) ? (void)0                                                                  \
               : (++failures, (void)printf("line %d: %s\n  last error: %s\n", __LINE__, #condition, lorica_last_error())))

enum { kRings = 24, kSides = 16, kVertices = kRings * kSides + 2, kTriangles = 2 * kRings * kSides, kJoints = 3, kPoses = 8 };
static double vertices[3 * kVertices], weights[4 * kVertices];
static int32_t triangles[3 * kTriangles], joints[4 * kVertices];
static double inverse_bind[16 * kJoints], poses[kPoses][16 * kJoints];

static uint32_t fnv(const void *bytes, size_t count, uint32_t hash) {
  const unsigned char *byte = bytes;
  for (size_t i = 0; i < count; ++i) hash = (hash ^ byte[i]) * 16777619u;
  return hash;
}

/* Joints along the tube turn about x by angles whose half has this tangent: only arithmetic, so that every system agrees. */
static void pose(double tangent, double *matrices) {
  memset(matrices, 0, sizeof(double) * 16 * kJoints);
  for (int j = 0; j < kJoints; ++j) {
    const double t = j * tangent, cosine = (1 - t * t) / (1 + t * t), sine = 2 * t / (1 + t * t);
    double *m = matrices + 16 * j;
    m[0] = m[15] = 1;
    m[5] = m[10] = cosine;
    m[6] = sine;
    m[9] = -sine;
    m[14] = 0.8 * j;
  }
}

static void make_tube(void) {
  int32_t *out = triangles;
  for (int r = 0; r < kRings; ++r) {
    const double along = 0.1 * r, radius = 0.2 + 0.04 * (r % 6), aside = 0.01 * r * (kRings - r) / 4;
    for (int s = 0; s < kSides; ++s) {
      const int v = r * kSides + s, next = r * kSides + (s + 1) % kSides;
      const double t = s % 4 * 0.25, c = (1 - t * t) / (1 + t * t), d = 2 * t / (1 + t * t);
      const double x[] = {c, -d, -c, d}, y[] = {d, c, -d, -c};
      vertices[3 * v] = radius * x[s / 4] + aside;
      vertices[3 * v + 1] = radius * y[s / 4];
      vertices[3 * v + 2] = along;
      const int joint = r / 8;
      joints[4 * v] = joint;
      joints[4 * v + 1] = joint > 0 ? joint - 1 : 0;
      weights[4 * v] = 0.5 + 0.0625 * (r % 8);
      weights[4 * v + 1] = 0.5 - 0.0625 * (r % 8);
      if (r + 1 == kRings) continue;
      const int32_t two[] = {v, next, next + kSides, v, next + kSides, v + kSides};
      memcpy(out, two, sizeof two);
      out += 6;
    }
  }
  for (int end = 0; end < 2; ++end) {
    const int middle = kRings * kSides + end, first = end * (kRings - 1) * kSides;
    vertices[3 * middle + 2] = 0.1 * end * (kRings - 1);
    vertices[3 * middle] = 0.01 * end * (kRings - 1) / 4;
    joints[4 * middle] = 2 * end;
    weights[4 * middle] = 1;
    for (int s = 0; s < kSides; ++s) {
      const int a = first + s, b = first + (s + 1) % kSides;
      const int32_t one[] = {middle, end ? a : b, end ? b : a};
      memcpy(out, one, sizeof one);
      out += 3;
    }
  }
  for (int j = 0; j < kJoints; ++j) {
    double *m = inverse_bind + 16 * j;
    m[0] = m[5] = m[10] = m[15] = 1;
    m[14] = -0.8 * j;
  }
  for (int p = 0; p < kPoses; ++p) pose(0.05 * p, poses[p]);
}

static int counted;
static int count_progress(void *user, int32_t done, int32_t wanted) {
  (void)done, (void)wanted;
  ++counted;
  return user == NULL;
}

static lorica_mesh tube(void) {
  lorica_mesh mesh = {sizeof mesh, vertices, kVertices, triangles, kTriangles, 0};
  return mesh;
}

static void test_parts(void) {
  const lorica_mesh mesh = tube();
  lorica_decompose_options options = {.size = sizeof options, .parts = 6, .progress = count_progress};
  lorica_parts *parts = NULL, *again = NULL;
  CHECK(lorica_decompose(&mesh, &options, &parts) == LORICA_OK);
  CHECK(counted > 0 && lorica_parts_count(parts) == 6 && lorica_parts_frame_count(parts) == 1);
  CHECK(lorica_parts_error(parts) > 0 && lorica_parts_hull_volume(parts) > lorica_parts_mesh_volume(parts));
  CHECK(lorica_parts_error_in_frame(parts, 0) == lorica_parts_error(parts));
  CHECK(*lorica_parts_repaired(parts) == 0 && *lorica_parts_warning(parts) == 0);
  printf("parts %016llx\n", (unsigned long long)lorica_parts_hash(parts));
  uint32_t hash = 2166136261u;
  lorica_hull hull = {.size = sizeof hull}, other = {.size = sizeof other};
  for (size_t p = 0; p < 6; ++p) {
    CHECK(lorica_parts_hull(parts, p, &hull) == LORICA_OK && hull.volume > 0);
    hash = fnv(hull.vertices, 24 * hull.vertex_count, hash);
    hash = fnv(hull.triangles, 12 * hull.triangle_count, hash);
  }
  printf("hulls %08x\n", hash);
  size_t count = 0, written = 0;
  CHECK(lorica_parts_bytes(parts, NULL, 0, &count) == LORICA_OK && count > 100);
  char *bytes = malloc(count);
  CHECK(lorica_parts_bytes(parts, bytes, count - 1, &written) == LORICA_INVALID_ARGUMENT);
  CHECK(lorica_parts_bytes(parts, bytes, count, &written) == LORICA_OK && written == count);
  CHECK(lorica_parts_from_bytes(bytes, count, &mesh, NULL, &again) == LORICA_OK);
  CHECK(lorica_parts_hash(again) == lorica_parts_hash(parts));
  CHECK(lorica_parts_hull_in_frame(again, 0, 5, &other) == LORICA_OK && other.volume == hull.volume);
  CHECK(lorica_parts_save(parts, "tube.lorica") == LORICA_OK);
  lorica_parts_free(again);
  CHECK(lorica_parts_load("tube.lorica", &mesh, NULL, &again) == LORICA_OK);
  CHECK(lorica_parts_hash(again) == lorica_parts_hash(parts));
  remove("tube.lorica");
  bytes[count / 2] ^= 1;
  lorica_parts_free(again);
  again = NULL;
  CHECK(lorica_parts_from_bytes(bytes, count, &mesh, NULL, &again) == LORICA_BAD_FORMAT && again == NULL);
  free(bytes);
  options.user = &counted;
  CHECK(lorica_decompose(&mesh, &options, &again) == LORICA_CANCELLED);
  lorica_mesh open = mesh;
  open.triangle_count -= 2;
  CHECK(lorica_decompose(&open, NULL, &again) == LORICA_OK); /* two triangles of a cap are filled */
  CHECK(*lorica_parts_repaired(again) != 0);
  lorica_parts_free(again);
  lorica_parts_free(parts);
}

static void test_body(void) {
  lorica_skin skin = {sizeof skin, "tube", vertices, kVertices, triangles, kTriangles, joints, weights, 0, inverse_bind, kJoints,
                      poses[0], kPoses};
  lorica_character *character = NULL;
  CHECK(lorica_character_make(&skin, NULL, &character) == LORICA_OK);
  CHECK(strcmp(lorica_character_name(character), "tube") == 0 && lorica_character_joint_count(character) == kJoints);
  CHECK(lorica_character_joint_parent(character, 1) == -1 && lorica_character_joint_name(character, 2) != NULL);
  CHECK(fabs(lorica_character_height(character) - 0.8) < 0.01 && *lorica_character_notes(character) == 0);
  CHECK(*lorica_character_first_guess(character) == 0 && lorica_character_clip_count(character) == 0);
  CHECK(lorica_character_clip_name(character, 0) == NULL);
  lorica_mesh mesh = {.size = sizeof mesh};
  CHECK(lorica_character_mesh(character, &mesh) == LORICA_OK && mesh.triangle_count == kTriangles);
  lorica_body_options options = {.size = sizeof options, .parts = 5};
  lorica_body *body = NULL, *again = NULL;
  CHECK(lorica_body_make(character, &options, &body) == LORICA_OK);
  CHECK(lorica_body_part_count(body) == 5 && lorica_body_warning(body) != NULL);
  size_t count = 0;
  CHECK(lorica_body_bytes(body, NULL, 0, &count) == LORICA_OK);
  char *bytes = malloc(count);
  CHECK(lorica_body_bytes(body, bytes, count, &count) == LORICA_OK);
  CHECK(lorica_body_from_bytes(character, bytes, count, &again) == LORICA_OK);
  printf("body %08x\n", fnv(bytes, count, 2166136261u));
  free(bytes);
  CHECK(lorica_body_save(body, "tube.lorica") == LORICA_OK);
  lorica_body_free(body);
  CHECK(lorica_body_load(character, "tube.lorica", &body) == LORICA_OK);
  remove("tube.lorica");
  lorica_live *live = NULL;
  CHECK(lorica_live_make(again, &live) == LORICA_OK);
  uint32_t hulls = 2166136261u, rays = hulls;
  for (int f = 0; f < 50; ++f) {
    double matrices[16 * kJoints], read[16 * kJoints];
    pose(0.007 * f, matrices);
    CHECK(lorica_live_pose(live, matrices, kJoints) == LORICA_OK);
    CHECK(lorica_live_transforms(live, read, kJoints) == LORICA_OK && memcmp(read, matrices, sizeof read) == 0);
    for (size_t p = 0; p < 5; ++p) {
      lorica_hull hull = {.size = sizeof hull};
      CHECK(lorica_live_hull(live, p, &hull) == LORICA_OK);
      hulls = fnv(hull.vertices, 24 * hull.vertex_count, hulls);
      hulls = fnv(hull.triangles, 12 * hull.triangle_count, hulls);
    }
    const double ray[] = {0.02 * f - 0.4, 5, 0.05 * f, 0.01, -1, 0.02};
    double distance, position[3] = {0}, normal[3] = {0};
    int32_t part, triangle;
    CHECK(lorica_live_cast_rays(live, ray, 1, INFINITY, 0, NULL, &part, &distance, position, normal) == LORICA_OK);
    rays = fnv(&part, sizeof part, rays);
    rays = fnv(&distance, sizeof distance, rays);
    if (part >= 0) rays = fnv(position, sizeof position, rays);
    CHECK(lorica_live_cast_on_skin(live, ray, 1, INFINITY, &triangle, NULL, NULL, NULL) == LORICA_OK);
    CHECK(triangle < 0 || part >= 0);
  }
  printf("live %08x\nrays %08x\n", hulls, rays);
  const double up[] = {0, 1, 0};
  double top[3];
  lorica_part_motion motion = {.size = sizeof motion};
  lorica_hull hull = {.size = sizeof hull};
  double highest = -INFINITY;
  CHECK(lorica_live_hull(live, 0, &hull) == LORICA_OK);
  for (size_t v = 0; v < hull.vertex_count; ++v) highest = fmax(highest, hull.vertices[3 * v + 1]);
  CHECK(lorica_live_support(live, 0, up, top) == LORICA_OK && fabs(top[1] - highest) < 1e-9);
  CHECK(lorica_live_part_motion(live, 0, 0.1, &motion) == LORICA_OK && motion.point_count >= motion.present_count);
  lorica_live_free(live);
  lorica_body_free(again);
  lorica_body_free(body);
  lorica_character_free(character);
}

/* What the core does without says so, and changes nothing. */
static void test_what_is_not_there(void) {
  lorica_character *character = NULL;
  lorica_motion *motion = NULL;
  lorica_tracker *tracker = NULL;
  lorica_parts *parts = NULL;
  lorica_live *live = NULL;
  size_t count = 0;
  CHECK(lorica_character_read("hero.glb", &character) == LORICA_UNSUPPORTED && character == NULL);
  CHECK(strstr(lorica_last_error(), "core alone") != NULL);
  CHECK(lorica_character_read_with("hero.glb", NULL, &character) == LORICA_UNSUPPORTED);
  CHECK(lorica_tracker_make(NULL, &tracker) == LORICA_UNSUPPORTED && tracker == NULL);
  CHECK(lorica_tracker_track(tracker, 0, NULL, 0, &count) == LORICA_UNSUPPORTED);
  CHECK(lorica_tracker_person(tracker, 0, NULL) == LORICA_UNSUPPORTED);
  lorica_tracker_free(tracker);
  CHECK(lorica_live_find_contacts(live, &count) == LORICA_UNSUPPORTED);
  CHECK(lorica_live_contact(live, 0, NULL) == LORICA_UNSUPPORTED);
  CHECK(lorica_live_find_touches(live, NULL, &count) == LORICA_UNSUPPORTED);
  CHECK(lorica_live_touch(live, 0, NULL) == LORICA_UNSUPPORTED);
  lorica_mesh frames = tube();
  frames.vertex_count /= 2;
  frames.triangle_count = 4;
  frames.frame_count = 2;
  CHECK(lorica_decompose(&frames, NULL, &parts) == LORICA_UNSUPPORTED && parts == NULL);
  CHECK(lorica_motion_frame_count(motion) == 0 && lorica_motion_time(motion, 0) == 0);
  CHECK(*lorica_motion_first_guess(motion) == 0);
  CHECK(lorica_live_play(live, motion, 0) == LORICA_INVALID_ARGUMENT);
  CHECK(lorica_live_play_at(live, motion, 0) == LORICA_INVALID_ARGUMENT);
  lorica_motion_free(motion);
  lorica_skin skin = {sizeof skin, NULL, vertices, kVertices, triangles, kTriangles, joints, weights, 0, inverse_bind, kJoints,
                      poses[0], kPoses};
  CHECK(lorica_character_make(&skin, NULL, &character) == LORICA_OK);
  CHECK(lorica_motion_read(character, "walk", NULL, &motion) == LORICA_UNSUPPORTED && motion == NULL);
  lorica_character_free(character);
  character = NULL;
  skin.joint_count = 2; /* vertices name the third */
  CHECK(lorica_character_make(&skin, NULL, &character) == LORICA_INVALID_ARGUMENT && character == NULL);
  CHECK(strstr(lorica_last_error(), "expected 0 to 1") != NULL);
  skin.joint_count = kJoints;
  skin.pose_count = 0;
  CHECK(lorica_character_make(&skin, NULL, &character) == LORICA_INVALID_ARGUMENT);
  skin.pose_count = kPoses;
  skin.triangle_count /= 2; /* half a tube is open */
  CHECK(lorica_character_make(&skin, NULL, &character) == LORICA_UNSUPPORTED);
  CHECK(strstr(lorica_last_error(), "OpenVDB") != NULL);
  lorica_character_options shell = {.size = sizeof shell, .walls = LORICA_CHARACTER_SHELL};
  CHECK(lorica_character_make(&skin, &shell, &character) == LORICA_OK);
  lorica_character_free(character);
  shell.body_resolution = -1;
  CHECK(lorica_character_make(&skin, &shell, &character) == LORICA_INVALID_ARGUMENT);
  CHECK(strstr(lorica_last_error(), "body_resolution: found -1") != NULL);
}

int main(void) {
  make_tube();
  CHECK(strlen(lorica_version()) > 0);
  test_parts();
  test_body();
  test_what_is_not_there();
  return failures != 0;
}
