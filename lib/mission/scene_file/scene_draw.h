/*
 * What a scene's `trial` section draws at random: from the scene's tree and the number of a run to the
 * tree of that run.
 *
 * A number depends on the seed, the run and the key that it is for, and on nothing else: draws that
 * are added or taken away leave the others as they were, and variants of a scene share what they
 * have in common. Whoever wants the mission of a run calls asdic_mission_load_run (asdic/mission.h).
 */
#ifndef ASDIC_MISSION_SCENE_DRAW_H
#define ASDIC_MISSION_SCENE_DRAW_H

#include "scene_file.h"

/* Keys and values that were drawn, in the order of the file; values are YAML on one line. They live
 * in the arena. What is set stands in place of what is drawn, but for parts of it that are drawn. */
typedef struct asdic_drawn {
    asdic_setting *items;
    size_t count;
    const asdic_setting *settings;
    size_t setting_count;
} asdic_drawn;

/* Puts what is set, and what run DRAW->run draws by TRIAL, which asdic_scene_draw_check found good,
 * into ROOT: the keys of TURN alone. What is wrong with the values is found when the tree is read.
 * Appends to DRAWN. What is set in an entry of a list that was drawn as `none` is gone with it; such
 * entries keep their places until asdic_scene_draw_finish. */
void asdic_scene_draw(asdic_yaml_node *root, const file_trial *trial, const asdic_draw *draw,
                      asdic_scene_turn turn, asdic_arena *arena, asdic_problems *problems,
                      asdic_drawn *drawn);

/* Takes those entries out of their lists, once nothing is set by its index any more. */
void asdic_scene_draw_finish(asdic_yaml_node *root, const asdic_drawn *drawn, asdic_arena *arena,
                             asdic_problems *problems);

/* Names without doubles. */
typedef struct asdic_names {
    char (*items)[ASDIC_NAME_SIZE]; /* freed with free() */
    size_t count;
} asdic_names;

/* The names that objects of ROOT, from which no run was drawn yet, have in any run: in the order of the file, those
 * of choices in the place of what is drawn. False: out of memory. */
bool asdic_scene_draw_names(const asdic_yaml_node *root, const file_trial *trial,
                            asdic_names *names);

/* Reports draws that are impossible, those inside choices too. */
void asdic_scene_draw_check(const file_trial *trial, asdic_arena *arena, asdic_problems *problems);

/* Reports draws, good by themselves, of keys that a scene does not have, or ROOT not the entries of lists (NULL: not
 * known yet), and those whose ends or choices no scene may have. */
void asdic_scene_draw_check_values(const file_trial *trial, asdic_yaml_node *root,
                                   asdic_arena *arena, asdic_problems *problems);

/* Hands the names of files that choices hold to FILES, some more than once. */
void asdic_scene_draw_name_files(const file_trial *trial, asdic_arena *arena,
                                 const asdic_file_taker *files);

#endif
