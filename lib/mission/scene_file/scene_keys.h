/*
 * The tables of the scene file, by part. One row says all there is to say about a key.
 */
#ifndef ASDIC_MISSION_SCENE_KEYS_H
#define ASDIC_MISSION_SCENE_KEYS_H

#include "scene_file.h"

#define COUNT_OF(array) (sizeof(array) / sizeof *(array))
#define TABLE(keys_of, type_of)                                                                    \
    .keys = keys_of, .key_count = COUNT_OF(keys_of), .size = sizeof(type_of)
#define AT(type_of, member) .offset = offsetof(type_of, member)

#define ANGLE(type_of, member, low, high, what)                                                    \
    {                                                                                              \
#member, ASDIC_KEY_NUMBER, AT(type_of, member), .unit = "deg", .min = low, .max = high,    \
                                                        .fallback = "0", .doc = what               \
    }

/* Without the keys of scattering laws, which scene_laws.c adds. scene_keys.c */
extern const asdic_table asdic_file_table;
/* scene_keys_geometry.c */
extern const asdic_table asdic_surface_table, asdic_bottom_table, asdic_object_table,
    asdic_material_table;
/* scene_keys_trial.c; a draw inside a choice has no key */
extern const asdic_table asdic_trial_table, asdic_inner_draw_table;
/* scene_keys_sonar.c */
extern const asdic_table asdic_sonar_table, asdic_mission_table;

#endif
