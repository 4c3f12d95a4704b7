/* Prints what a compiled program knows of lorica.h: sizes and offsets of structs, values of enums. */
#include "lorica.h"

#include <stddef.h>
#include <stdio.h>

#define STRUCT(name) printf("struct %s: %zu bytes\n", #name, sizeof(name))
#define FIELD(name, field) printf("  %3zu +%-4zu %s\n", offsetof(name, field), sizeof(((name *)0)->field), #field)
#define VALUE(name) printf("%s = %d\n", #name, (int)name)

int main(void) {
  STRUCT(lorica_mesh);
  FIELD(lorica_mesh, size);
  FIELD(lorica_mesh, vertices);
  FIELD(lorica_mesh, vertex_count);
  FIELD(lorica_mesh, triangles);
  FIELD(lorica_mesh, triangle_count);
  FIELD(lorica_mesh, frame_count);
  STRUCT(lorica_decompose_options);
  FIELD(lorica_decompose_options, size);
  FIELD(lorica_decompose_options, parts);
  FIELD(lorica_decompose_options, preset);
  FIELD(lorica_decompose_options, max_error);
  FIELD(lorica_decompose_options, max_distance);
  FIELD(lorica_decompose_options, hull_vertices);
  FIELD(lorica_decompose_options, closed_body);
  FIELD(lorica_decompose_options, threads);
  FIELD(lorica_decompose_options, progress);
  FIELD(lorica_decompose_options, user);
  FIELD(lorica_decompose_options, max_concavity);
  FIELD(lorica_decompose_options, thickness);
  FIELD(lorica_decompose_options, walls);
  FIELD(lorica_decompose_options, keyframes);
  STRUCT(lorica_hull);
  FIELD(lorica_hull, size);
  FIELD(lorica_hull, vertices);
  FIELD(lorica_hull, vertex_count);
  FIELD(lorica_hull, triangles);
  FIELD(lorica_hull, triangle_count);
  FIELD(lorica_hull, volume);
  STRUCT(lorica_character_options);
  FIELD(lorica_character_options, size);
  FIELD(lorica_character_options, map);
  FIELD(lorica_character_options, hidden);
  FIELD(lorica_character_options, hidden_count);
  FIELD(lorica_character_options, expressions);
  FIELD(lorica_character_options, expression_count);
  FIELD(lorica_character_options, body_resolution);
  FIELD(lorica_character_options, thickness);
  FIELD(lorica_character_options, walls);
  STRUCT(lorica_body_options);
  FIELD(lorica_body_options, size);
  FIELD(lorica_body_options, parts);
  FIELD(lorica_body_options, hull_vertices);
  FIELD(lorica_body_options, cover);
  FIELD(lorica_body_options, threads);
  FIELD(lorica_body_options, progress);
  FIELD(lorica_body_options, user);
  STRUCT(lorica_motion_options);
  FIELD(lorica_motion_options, size);
  FIELD(lorica_motion_options, clip);
  FIELD(lorica_motion_options, mirror);
  STRUCT(lorica_part_motion);
  FIELD(lorica_part_motion, size);
  FIELD(lorica_part_motion, world_from_part);
  FIELD(lorica_part_motion, previous_world_from_part);
  FIELD(lorica_part_motion, linear_velocity);
  FIELD(lorica_part_motion, angular_velocity);
  FIELD(lorica_part_motion, points);
  FIELD(lorica_part_motion, point_count);
  FIELD(lorica_part_motion, present_count);
  STRUCT(lorica_contact);
  FIELD(lorica_contact, size);
  FIELD(lorica_contact, first);
  FIELD(lorica_contact, second);
  FIELD(lorica_contact, position);
  FIELD(lorica_contact, direction);
  FIELD(lorica_contact, depth);
  STRUCT(lorica_shape);
  FIELD(lorica_shape, size);
  FIELD(lorica_shape, points);
  FIELD(lorica_shape, point_count);
  FIELD(lorica_shape, radius);
  STRUCT(lorica_touch);
  FIELD(lorica_touch, size);
  FIELD(lorica_touch, part);
  FIELD(lorica_touch, position);
  FIELD(lorica_touch, direction);
  FIELD(lorica_touch, depth);
  STRUCT(lorica_tracker_options);
  FIELD(lorica_tracker_options, size);
  FIELD(lorica_tracker_options, width);
  FIELD(lorica_tracker_options, height);
  FIELD(lorica_tracker_options, horizontal_fov);
  FIELD(lorica_tracker_options, vertical_fov);
  FIELD(lorica_tracker_options, max_people);
  STRUCT(lorica_person);
  FIELD(lorica_person, size);
  FIELD(lorica_person, user);
  FIELD(lorica_person, height);
  FIELD(lorica_person, positions);
  FIELD(lorica_person, confidences);
  VALUE(LORICA_OK);
  VALUE(LORICA_NOT_FOUND);
  VALUE(LORICA_UNREADABLE);
  VALUE(LORICA_UNWRITABLE);
  VALUE(LORICA_BAD_FORMAT);
  VALUE(LORICA_BAD_MESH);
  VALUE(LORICA_INVALID_ARGUMENT);
  VALUE(LORICA_UNSUPPORTED);
  VALUE(LORICA_CANCELLED);
  VALUE(LORICA_FAILURE);
  VALUE(LORICA_FAST);
  VALUE(LORICA_PAPER);
  VALUE(LORICA_QUALITY);
  VALUE(LORICA_CLOSED_IF_NEEDED);
  VALUE(LORICA_CLOSED_NEVER);
  VALUE(LORICA_CLOSED_ALWAYS);
  VALUE(LORICA_CHARACTER_SOLID);
  VALUE(LORICA_CHARACTER_AUTO);
  VALUE(LORICA_CHARACTER_SHELL);
  VALUE(LORICA_HEAD);
  VALUE(LORICA_RIGHT_FOOT);
  VALUE(LORICA_JOINT_COUNT);
  return 0;
}
