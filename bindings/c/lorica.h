// clang-format off: it would tear the example
/* Lorica in C: convex parts of meshes, live hulls of moving characters, joints from depth images.
 *
 *     lorica_mesh mesh = {.size = sizeof mesh, .vertices = xyz, .vertex_count = 8,
 *                         .triangles = abc, .triangle_count = 12};
 *     lorica_decompose_options options = {.size = sizeof options, .parts = 16};
 *     lorica_parts *parts;
 *     if (lorica_decompose(&mesh, &options, &parts) != LORICA_OK) return complain(lorica_last_error());
 *     for (size_t p = 0; p < lorica_parts_count(parts); ++p) {
 *       lorica_hull hull = {.size = sizeof hull};
 *       lorica_parts_hull(parts, p, &hull);
 *       use(hull.vertices, hull.vertex_count);
 *     }
 *     lorica_parts_free(parts);
 *
 * Units and axes. Characters: metres, seconds, radians, right-handed, Y up, facing +Z in the bind pose. Meshes keep
 * their own unit. Triangles run counter-clockwise seen from outside. Strings are UTF-8.
 *
 * Versions. Every struct starts with its size. Fill structs with zeros, set `size` to sizeof of the struct, then what
 * you need: zero always means the default. A library that is newer than the program reads, and fills, only what the
 * program knows. A size that the library does not know is LORICA_INVALID_ARGUMENT.
 *
 * Errors. What can fail returns a lorica_status; other than LORICA_OK, lorica_last_error() has a sentence, and nothing
 * that was pointed to has changed. No C++ exception leaves the library. A null pointer is LORICA_INVALID_ARGUMENT,
 * unless it is allowed here. A handle that was freed, or one of another kind, is undefined behaviour.
 *
 * Ownership. What a function returns by `**out` is freed by the function of its type whose name ends in _free; null may
 * be freed. Handles keep alive what they were made from, so the order does not matter. Pointers to numbers and strings
 * belong to the handle that they were asked from and are valid as long as it is, for a live body until it is moved.
 *
 * Threads. Any number of threads may use different handles. lorica_parts, lorica_character, lorica_body and
 * lorica_motion never change: threads may share them. lorica_live and lorica_tracker may be used by one thread at a
 * time. */
// clang-format on
#ifndef LORICA_H
#define LORICA_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* In front of everything that the library exports. */
#if defined(_WIN32) && defined(LORICA_BUILDS_DLL)
#define LORICA_API __declspec(dllexport)
#elif defined(_WIN32)
#define LORICA_API __declspec(dllimport)
#elif defined(__GNUC__)
#define LORICA_API __attribute__((visibility("default")))
#else
#define LORICA_API
#endif

/* Whether a call succeeded, or why not. */
typedef enum lorica_status {
  LORICA_OK = 0,
  LORICA_NOT_FOUND = 1,        /* a file, clip or recording that is not there */
  LORICA_UNREADABLE = 2,       /* there, but cannot be read */
  LORICA_UNWRITABLE = 3,       /* the output cannot be written; nothing is left half written */
  LORICA_BAD_FORMAT = 4,       /* malformed text or bytes */
  LORICA_BAD_MESH = 5,         /* a mesh that cannot be decomposed */
  LORICA_INVALID_ARGUMENT = 6, /* out of range, null, or things that do not belong together */
  LORICA_UNSUPPORTED = 7,      /* understood, but not handled */
  LORICA_CANCELLED = 8,        /* the progress function returned 0 */
  LORICA_FAILURE = 9           /* out of memory, or a fault of the library */
} lorica_status;

/* "0.1.0" */
LORICA_API const char* lorica_version(void);

/* What the last failure in this thread was, with the numbers in it; "" if none was. Valid until the next failure in
 * this thread. */
LORICA_API const char* lorica_last_error(void);

/* Called for long work, in any thread, one call at a time. Return 0 to cancel. @param user  as given in the options */
typedef int (*lorica_progress)(void* user, int32_t done, int32_t wanted);

/* ---- Meshes ---- */

/* Triangles. Those of the caller need be valid during the call only. */
typedef struct lorica_mesh {
  size_t size;              /* sizeof this struct, set by the caller */
  const double* vertices;   /* x y z for each, frame after frame */
  size_t vertex_count;      /* of the vertices in a frame */
  const int32_t* triangles; /* three indices for each */
  size_t triangle_count;    /* of the triangles */
  size_t frame_count;       /* poses of the same triangles; 0 = 1 */
} lorica_mesh;

/* How hard it tries. LORICA_PAPER is the algorithm as published. */
typedef enum lorica_preset { LORICA_FAST = 0, LORICA_PAPER = 1, LORICA_QUALITY = 2 } lorica_preset;

/* When a closed surface is built around a mesh, and takes its place. */
typedef enum lorica_closed_body {
  LORICA_CLOSED_IF_NEEDED = 0, /* if it is open and cannot be repaired */
  LORICA_CLOSED_NEVER = 1,     /* such a mesh is refused */
  LORICA_CLOSED_ALWAYS = 2
} lorica_closed_body;

/* What an open surface is. */
typedef enum lorica_walls {
  LORICA_WALLS_AUTO = 0, /* a thin wall, unless nothing outside can reach what is behind it */
  LORICA_WALLS_SOLID = 1,
  LORICA_WALLS_SHELL = 2 /* a thin wall, also where it is closed */
} lorica_walls;

/* How a mesh is cut. */
typedef struct lorica_decompose_options {
  size_t size;      /* sizeof this struct, set by the caller */
  int32_t parts;    /* at most; 0 = 16, or with a limit below as many as it takes; -1 = until no concave edge remains */
  int32_t preset;   /* lorica_preset */
  double max_error; /* stop when the hulls have at most this much more volume, relative to the mesh; 0 = no limit */
  double max_distance;      /* fewest parts with no point of a hull farther than this from the surface; 0 = no limit */
  int32_t hull_vertices;    /* hulls with more are enclosed in larger ones, at least 4; 0 = no limit. It and parts
                               always hold; the limits above give where not all can */
  int32_t closed_body;      /* lorica_closed_body */
  int32_t threads;          /* 0 = all of the machine's; the result does not depend on it */
  lorica_progress progress; /* parts done and wanted; may be null */
  void* user;               /* passed to progress */
  double max_concavity;     /* fewest parts whose concavity, as CoACD measures it, is at most this; 0 = no limit */
  double thickness;         /* of thin walls; 0 = 1 % of the longest side, at most half of the narrowest gap */
  int32_t walls;            /* lorica_walls */
  int32_t keyframes;   /* of several frames, decompose in so many at even intervals; 0 = up to 12 that differ most */
  int32_t hull_planes; /* as hull_vertices: flat faces, of any number of corners */
} lorica_decompose_options;

/* A convex polyhedron. Filled by the library; see Ownership. */
typedef struct lorica_hull {
  size_t size;              /* sizeof this struct, set by the caller */
  const double* vertices;   /* x y z for each */
  size_t vertex_count;      /* of the vertices */
  const int32_t* triangles; /* three indices for each; none while the hull is flat */
  size_t triangle_count;    /* of the triangles */
  double volume;            /* in the cubed unit of the vertices */
} lorica_hull;

/* A decomposed mesh. */
typedef struct lorica_parts lorica_parts;

/* Decomposes a mesh into nearly convex parts. Their hulls together contain every vertex of its surface. There is no
 * seed: the same input gives the same hulls. @param options  null = defaults */
LORICA_API lorica_status lorica_decompose(const lorica_mesh* mesh, const lorica_decompose_options* options,
                                          lorica_parts** out);
/* The parts in a .lorica file that was made from this mesh. @param options  only hull_vertices, hull_planes,
 * closed_body, threads */
LORICA_API lorica_status lorica_parts_load(const char* file, const lorica_mesh* mesh,
                                           const lorica_decompose_options* options, lorica_parts** out);
/* Writes a .lorica file, completely or not at all. It holds no positions. */
LORICA_API lorica_status lorica_parts_save(const lorica_parts* parts, const char* file);
/* The same of the bytes of such a file. */
LORICA_API lorica_status lorica_parts_from_bytes(const void* bytes, size_t count, const lorica_mesh* mesh,
                                                 const lorica_decompose_options* options, lorica_parts** out);
/* The bytes of their file. @param bytes  written, at most `room`; null = only their number   @param count  written */
LORICA_API lorica_status lorica_parts_bytes(const lorica_parts* parts, void* bytes, size_t room, size_t* count);
/* Null is allowed. */
LORICA_API void lorica_parts_free(lorica_parts* parts);
/* At least 1. */
LORICA_API size_t lorica_parts_count(const lorica_parts* parts);
/* In the first frame. @param part  below lorica_parts_count() */
LORICA_API lorica_status lorica_parts_hull(const lorica_parts* parts, size_t part, lorica_hull* out);
/* At least 1. */
LORICA_API size_t lorica_parts_frame_count(const lorica_parts* parts);
/* @param frame  below lorica_parts_frame_count() */
LORICA_API lorica_status lorica_parts_hull_in_frame(const lorica_parts* parts, size_t frame, size_t part,
                                                    lorica_hull* out);
/* Of the mesh, or of the closed surface in its place, in the first frame. */
LORICA_API double lorica_parts_mesh_volume(const lorica_parts* parts);
/* Of all hulls together, in the first frame. */
LORICA_API double lorica_parts_hull_volume(const lorica_parts* parts);
/* (hull volume - mesh volume) / mesh volume; of several frames, the mean */
LORICA_API double lorica_parts_error(const lorica_parts* parts);
/* The same of one frame; 0 if there is no such frame. */
LORICA_API double lorica_parts_error_in_frame(const lorica_parts* parts, size_t frame);
/* Of the parts, as `lorica decompose` prints it: equal parts have equal hashes on every machine. */
LORICA_API uint64_t lorica_parts_hash(const lorica_parts* parts);
/* What was done to the mesh first, in words; "" if nothing. */
LORICA_API const char* lorica_parts_repaired(const lorica_parts* parts);
/* A sentence if the error is more than 50 %; "" if not. */
LORICA_API const char* lorica_parts_warning(const lorica_parts* parts);

/* ---- Characters ---- */

typedef struct lorica_character lorica_character;

/* What an open surface of a character is. */
typedef enum lorica_character_walls {
  LORICA_CHARACTER_SOLID = 0, /* the border of a solid, unless all of it is sheets, such as a flag: then thin walls */
  LORICA_CHARACTER_AUTO = 1,  /* a thin wall, unless nothing outside can reach what is behind it */
  LORICA_CHARACTER_SHELL = 2  /* a thin wall, also where it is closed */
} lorica_character_walls;

/* How a character's file is read. */
typedef struct lorica_character_options {
  size_t size;                    /* sizeof this struct, set by the caller */
  const char* map;                /* file that says which joints are the humanoid's bones; null or "" = automatic */
  const char* const* hidden;      /* names of meshes that are left out, such as a weapon */
  size_t hidden_count;            /* of these names */
  const char* const* expressions; /* "NAME=WEIGHT"; the hulls hold what these morph */
  size_t expression_count;        /* of these */
  double body_resolution;         /* of the voxels of a closed body, if one has to be made [m]; 0 = automatic */
  double thickness; /* of thin walls [m]; 0 = 1 % of their longest side, at most half of the narrowest gap */
  int32_t walls;    /* lorica_character_walls */
} lorica_character_options;

/* @param name_or_file  "mannequin", or a .glb, .gltf, .vrm, .fbx or .dae file with a skin or clips. FBX and COLLADA are
 * read in a process of their own: see docs/SECURITY.md */
LORICA_API lorica_status lorica_character_read(const char* name_or_file, lorica_character** out);
/* The same in other ways. @param options  null = defaults */
LORICA_API lorica_status lorica_character_read_with(const char* name_or_file, const lorica_character_options* options,
                                                    lorica_character** out);
/* A skinned mesh that your program has read itself, such as an engine's. What it points to need be valid during the
 * call only. */
typedef struct lorica_skin {
  size_t size;                    /* sizeof this struct, set by the caller */
  const char* name;               /* for errors; null = "character" */
  const double* vertices;         /* x y z for each, in the bind pose, model space [m] */
  size_t vertex_count;            /* of the vertices */
  const int32_t* triangles;       /* three indices for each */
  size_t triangle_count;          /* of the triangles */
  const int32_t* joints;          /* that move a vertex, joints_per_vertex for each */
  const double* weights;          /* of them, the same; they need not sum to 1 */
  size_t joints_per_vertex;       /* 0 = 4 */
  const double* joint_from_model; /* inverse bind matrices: 16 numbers for each joint, by columns */
  size_t joint_count;             /* at least 1 */
  const double* poses; /* that it is decomposed in: world_from_joint, a matrix for each joint, pose after pose [m] */
  size_t pose_count;   /* at least 1; of more than 12 those that differ most are used */
} lorica_skin;

/* A character of that. An open surface gets a closed body, as in a file. @param options  null = defaults;
 * body_resolution, thickness and walls count */
LORICA_API lorica_status lorica_character_make(const lorica_skin* skin, const lorica_character_options* options,
                                               lorica_character** out);
/* What was repaired, guessed or left out when the file was read, and which pieces are thin walls: a sentence a line. */
LORICA_API const char* lorica_character_notes(const lorica_character* character);
/* Null is allowed. */
LORICA_API void lorica_character_free(lorica_character* character);
/* Of its file, without the ending. */
LORICA_API const char* lorica_character_name(const lorica_character* character);
/* What the file was taken to be, in words: rest pose, unit, axes, facing and floor; "" for the mannequin. */
LORICA_API const char* lorica_character_first_guess(const lorica_character* character);
/* In the bind pose [m]. */
LORICA_API double lorica_character_height(const lorica_character* character);
/* Parents come before children. */
LORICA_API size_t lorica_character_joint_count(const lorica_character* character);
/* Null if there is no such joint. */
LORICA_API const char* lorica_character_joint_name(const lorica_character* character, size_t joint);
/* -1 = none, or no such joint. */
LORICA_API int32_t lorica_character_joint_parent(const lorica_character* character, size_t joint);
/* Its mesh in the bind pose [m]; of one whose surface is open, the closed body that is decomposed. */
LORICA_API lorica_status lorica_character_mesh(const lorica_character* character, lorica_mesh* out);
/* Of the file; 0 for the mannequin. */
LORICA_API size_t lorica_character_clip_count(const lorica_character* character);
/* Null if there is no such clip. */
LORICA_API const char* lorica_character_clip_name(const lorica_character* character, size_t clip);

/* How a character is decomposed. */
typedef struct lorica_body_options {
  size_t size;           /* sizeof this struct, set by the caller */
  int32_t parts;         /* at most; 0 = the body of `lorica play`, 16 parts, kept in the user's cache */
  int32_t hull_vertices; /* at most this many in each hull and frame, at least 4; 0 = no limit */
  double cover;    /* use fewer points, so that the surface sticks out by at most this before the hulls are enlarged
                      to hold it [m]; 0 = all points */
  int32_t threads; /* 0 = all of the machine's */
  lorica_progress progress; /* parts done and wanted; may be null */
  void* user;               /* passed to progress */
} lorica_body_options;

/* A decomposed character. */
typedef struct lorica_body lorica_body;

/* Trained on the character's own clips and on recordings of people; one of lorica_character_make() on its poses.
 * @param options  null = defaults */
LORICA_API lorica_status lorica_body_make(const lorica_character* character, const lorica_body_options* options,
                                          lorica_body** out);
/* The body in a .lorica file that was made from this character. */
LORICA_API lorica_status lorica_body_load(const lorica_character* character, const char* file, lorica_body** out);
/* The same of the bytes of such a file. */
LORICA_API lorica_status lorica_body_from_bytes(const lorica_character* character, const void* bytes, size_t count,
                                                lorica_body** out);
/* The bytes of its file. @param bytes  written, at most `room`; null = only their number   @param count  written */
LORICA_API lorica_status lorica_body_bytes(const lorica_body* body, void* bytes, size_t room, size_t* count);
/* Writes a .lorica file, completely or not at all. */
LORICA_API lorica_status lorica_body_save(const lorica_body* body, const char* file);
/* Null is allowed. */
LORICA_API void lorica_body_free(lorica_body* body);
/* Of its decomposition, at least 1. */
LORICA_API size_t lorica_body_part_count(const lorica_body* body);
/* A sentence if its hulls have more than 50 % more volume than the character, mean over the poses that it was trained
 * on; "" if not. */
LORICA_API const char* lorica_body_warning(const lorica_body* body);

/* How a motion is read. */
typedef struct lorica_motion_options {
  size_t size;      /* sizeof this struct, set by the caller */
  const char* clip; /* of a character file with several; null or "" = the first */
  int32_t mirror;   /* not 0: left and right are swapped */
} lorica_motion_options;

/* A motion as a character performs it. */
typedef struct lorica_motion lorica_motion;

/* @param name_or_file  recorded joints (.csv, .txt, .json), .bvh, depth (.oni), a character file with clips, or a
 *                      shipped recording: "walk"
 * @param options       null = defaults */
LORICA_API lorica_status lorica_motion_read(const lorica_character* character, const char* name_or_file,
                                            const lorica_motion_options* options, lorica_motion** out);
/* Null is allowed. */
LORICA_API void lorica_motion_free(lorica_motion* motion);
/* What the file was taken to be, in words: rest pose, unit, axes, facing and floor; "" for a shipped recording. */
LORICA_API const char* lorica_motion_first_guess(const lorica_motion* motion);
/* At least 1. */
LORICA_API size_t lorica_motion_frame_count(const lorica_motion* motion);
/* [s]; of the last frame if there is no such frame */
LORICA_API double lorica_motion_time(const lorica_motion* motion, size_t frame);

/* ---- Every frame ---- */

/* A body that is moved. After the first frames nothing is allocated. */
typedef struct lorica_live lorica_live;

/* In no pose yet: play or pose it first. */
LORICA_API lorica_status lorica_live_make(const lorica_body* body, lorica_live** out);
/* Null is allowed. */
LORICA_API void lorica_live_free(lorica_live* live);

/* Moves it to a frame of a motion of the same character, ... */
LORICA_API lorica_status lorica_live_play(lorica_live* live, const lorica_motion* motion, size_t frame);
/* ... to any time of it, between frames interpolated [s], ... */
LORICA_API lorica_status lorica_live_play_at(lorica_live* live, const lorica_motion* motion, double seconds);
/* ... or to a pose of your own skeleton.
 * @param world_from_joint  16 numbers for each joint: the matrix by columns, as glTF and OpenGL have it, [m] */
LORICA_API lorica_status lorica_live_pose(lorica_live* live, const double* world_from_joint, size_t joint_count);

/* The joints' transforms in this pose. @param world_from_joint  written, as above */
LORICA_API lorica_status lorica_live_transforms(const lorica_live* live, double* world_from_joint, size_t joint_count);
/* A part's hull in world space [m]. Empty before the first pose. Valid until the body is moved. */
LORICA_API lorica_status lorica_live_hull(const lorica_live* live, size_t part, lorica_hull* out);
/* The point of a part's hull that is farthest along a direction, for your own collision tests.
 * @param direction  x y z, world, of any length above 0   @param point  x y z, written, world [m] */
LORICA_API lorica_status lorica_live_support(const lorica_live* live, size_t part, const double* direction,
                                             double* point);

/* How a part moved since the pose before this one; in the first pose, not at all. */
typedef struct lorica_part_motion {
  size_t size;                         /* sizeof this struct, set by the caller */
  double world_from_part[16];          /* its own frame, which follows the best-fit rigid motion of its points: a matrix
                                          by columns, [m] */
  double previous_world_from_part[16]; /* the same one pose ago */
  double linear_velocity[3];           /* of the frame's origin, world [m/s] */
  double angular_velocity[3];          /* about world axes [rad/s] */
  const double* points; /* x y z for each, world [m]: vertices of its hull, then of its hull one pose ago. Their convex
                           hull is what the part swept by a straight motion */
  size_t point_count;   /* of both */
  size_t present_count; /* of the hull in this pose, which come first */
} lorica_part_motion;

/* @param seconds  since the pose before, above 0 */
LORICA_API lorica_status lorica_live_part_motion(lorica_live* live, size_t part, double seconds,
                                                 lorica_part_motion* out);

/* Where rays enter the hulls in this pose, each the nearest hull on its way, or where balls or capsules that are swept
 * along them touch. Rays that are not finite or have no direction hit nothing, nor does anything before the first pose.
 * @param rays   6 numbers for each: origin x y z, direction x y z of any length, world [m]
 * @param reach  where they end [m], INFINITY: nowhere
 * @param radius of what is swept [m]; 0 = rays
 * @param half   x y z from the middle of a capsule, which moves along the ray, to an end of its axis [m]; NULL = a ball
 * @param parts      written, one for each ray; -1 = nothing hit
 * @param distances  written, one for each ray [m]: 0 if it begins inside, INFINITY if nothing is hit; or NULL
 * @param positions  written, x y z for each ray that hits, world [m]; or NULL
 * @param normals    written, x y z for each ray that hits, unit, outward, against rays that begin inside; or NULL */
LORICA_API lorica_status lorica_live_cast_rays(lorica_live* live, const double* rays, size_t count, double reach,
                                               double radius, const double* half, int32_t* parts, double* distances,
                                               double* positions, double* normals);
/* Where rays meet the skin in this pose, from either side: the nearest point of the character's mesh. It is looked for
 * in hulls that the rays enter; a ray that passes a hull but not the skin within goes on to the next hull.
 * @param rays, reach  as above
 * @param triangles  written, one for each ray: of lorica_character_mesh(); -1 = no skin is met
 * @param weights    written, three for each ray that meets skin, of sum 1: of the triangle's corners; or NULL
 * @param distances  written, one for each ray [m]: INFINITY if no skin is met; or NULL
 * @param positions  written, x y z for each ray that meets skin, world [m]; or NULL */
LORICA_API lorica_status lorica_live_cast_on_skin(lorica_live* live, const double* rays, size_t count, double reach,
                                                  int32_t* triangles, double* weights, double* distances,
                                                  double* positions);

/* Two overlapping parts of one body that are no neighbours. */
typedef struct lorica_contact {
  size_t size;         /* sizeof this struct, set by the caller */
  size_t first;        /* part, smaller than the second */
  size_t second;       /* part */
  double position[3];  /* where the overlap is deepest, world [m] */
  double direction[3]; /* unit, from the first to the second */
  double depth;        /* how far the second has to move along it [m] */
} lorica_contact;

/* Finds the overlaps in this pose. The first call prepares the search. @param count  written */
LORICA_API lorica_status lorica_live_find_contacts(lorica_live* live, size_t* count);
/* One of those that were found last. */
LORICA_API lorica_status lorica_live_contact(const lorica_live* live, size_t index, lorica_contact* out);

/* A convex solid of yours: everything within a radius of the convex hull of points. One point makes a ball, two a
 * capsule, eight corners a box. */
typedef struct lorica_shape {
  size_t size;          /* sizeof this struct, set by the caller */
  const double* points; /* x y z for each, world [m]; at least one */
  size_t point_count;   /* of the points */
  double radius;        /* 0 or more [m] */
} lorica_shape;

/* A part of the body and a shape that overlap. */
typedef struct lorica_touch {
  size_t size;         /* sizeof this struct, set by the caller */
  size_t part;         /* of the body */
  double position[3];  /* where the overlap is deepest, world [m] */
  double direction[3]; /* unit, from the part to the shape */
  double depth;        /* how far the shape has to move along it [m] */
} lorica_touch;

/* Finds the parts that a shape overlaps in this pose, in the order of parts; none before the first pose. To within 0.2
 * mm and 1 %. @param count  written */
LORICA_API lorica_status lorica_live_find_touches(lorica_live* live, const lorica_shape* shape, size_t* count);
/* One of those that were found last. */
LORICA_API lorica_status lorica_live_touch(const lorica_live* live, size_t index, lorica_touch* out);

/* ---- Joints from depth images ---- */

/* The camera, and whom to look for. */
typedef struct lorica_tracker_options {
  size_t size;           /* sizeof this struct, set by the caller */
  int32_t width;         /* of the images [pixels]; 0 = 640 */
  int32_t height;        /* the same; 0 = 480 */
  double horizontal_fov; /* [rad]; 0 = that of Kinect v1 and Xtion */
  double vertical_fov;   /* the same */
  int32_t max_people;    /* at once, 1 to 6; 0 = 2 */
} lorica_tracker_options;

/* In the order of NiTE 2. Left and right are the person's own. */
typedef enum lorica_joint {
  LORICA_HEAD,
  LORICA_NECK,
  LORICA_LEFT_SHOULDER,
  LORICA_RIGHT_SHOULDER,
  LORICA_LEFT_ELBOW,
  LORICA_RIGHT_ELBOW,
  LORICA_LEFT_HAND,
  LORICA_RIGHT_HAND,
  LORICA_TORSO,
  LORICA_LEFT_HIP,
  LORICA_RIGHT_HIP,
  LORICA_LEFT_KNEE,
  LORICA_RIGHT_KNEE,
  LORICA_LEFT_FOOT,
  LORICA_RIGHT_FOOT,
  LORICA_JOINT_COUNT
} lorica_joint;

/* Who is tracked, in one image. */
typedef struct lorica_person {
  size_t size;             /* sizeof this struct, set by the caller */
  int32_t user;            /* stays while the person is tracked */
  double height;           /* standing [m]; 0 = not yet known */
  double positions[15][3]; /* by lorica_joint: metres, Y up, the floor is y = 0, the camera looks along -Z */
  double confidences[15];  /* 0 = unknown, 0.5 = inferred, 1 = seen */
} lorica_person;

/* Tracks people before one depth camera. After the first images nothing is allocated. */
typedef struct lorica_tracker lorica_tracker;

/* @param options  null = defaults */
LORICA_API lorica_status lorica_tracker_make(const lorica_tracker_options* options, lorica_tracker** out);
/* Null is allowed. */
LORICA_API void lorica_tracker_free(lorica_tracker* tracker);
/* @param seconds   in the camera's clock, more than that of the last image
 * @param depth_mm  width x height, rows from the top, not mirrored; 0 = not measured
 * @param people    written: how many are tracked */
LORICA_API lorica_status lorica_tracker_track(lorica_tracker* tracker, double seconds, const uint16_t* depth_mm,
                                              size_t pixel_count, size_t* people);
/* One of those who were tracked last. */
LORICA_API lorica_status lorica_tracker_person(const lorica_tracker* tracker, size_t index, lorica_person* out);

#ifdef __cplusplus
}
#endif

#endif
