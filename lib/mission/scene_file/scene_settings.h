/*
 * Values put into a scene's tree before it is read.
 */
#ifndef ASDIC_MISSION_SCENE_SETTINGS_H
#define ASDIC_MISSION_SCENE_SETTINGS_H

#include <asdic/mission.h>

#include "yaml_tree.h"

/* Makes maps on the way that are missing; entries of lists must be there. */
void asdic_scene_set(asdic_yaml_node *root, const asdic_setting *setting, asdic_arena *arena,
                     asdic_problems *problems);

#endif
