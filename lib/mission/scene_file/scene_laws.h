/*
 * The keys of the scattering laws in a scene file. They are made from the laws' own parameters.
 */
#ifndef ASDIC_MISSION_SCENE_LAWS_H
#define ASDIC_MISSION_SCENE_LAWS_H

#include "scene_file.h"

/* The keys of the laws for USE (ASDIC_LAW_BOTTOM ...) that stand in MAP: reports those that the chosen
 * law does not have, and alternatives that are given both. */
void asdic_scene_laws_check(unsigned use, const asdic_yaml_node *map, asdic_problems *problems);

/* The first key of any law for USE in MAP; NULL: none. */
asdic_yaml_node *asdic_scene_laws_given(unsigned use, const asdic_yaml_node *map);

/* The material that MAP and the values LAW read from it give; FILE is what its law wants read. */
asdic_material asdic_scene_laws_material(unsigned use, const asdic_yaml_node *map,
                                         const file_law *law, asdic_material_file *file);

#endif
