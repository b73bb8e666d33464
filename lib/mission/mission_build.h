/*
 * The steps from a scene file that was read to the mission it describes.
 */
#ifndef ASDIC_MISSION_MISSION_BUILD_H
#define ASDIC_MISSION_MISSION_BUILD_H

#include "mission.h"
#include "mission/scene_file/scene_file.h"

/* A scene file is written by hand or by a small script; geometry is elsewhere. */
#define ASDIC_MOST_SCENE_BYTES ((size_t)4 << 20)

/* How much of what the file says is taken: all; all but its objects; its text and hash alone; what can be told wrong
 * without the files it names. */
typedef enum mission_extent {
    MISSION_WHOLE,
    MISSION_EMPTY,
    MISSION_TEXT,
    MISSION_CHECKED
} mission_extent;

typedef struct mission_builder {
    asdic_context *ctx;
    const asdic_scene_file *file;
    asdic_problems *problems;
    asdic_arena *arena;
    asdic_mission *mission;
    mission_extent extent;
    const asdic_setting *settings; /* in place of what the file says */
    size_t setting_count;
    const asdic_draw *draw;    /* the run of a trial; NULL: the scene itself */
    bool draws;                /* the trial has something to draw */
    bool many;                 /* as asdic_mission_load_like; with */
    bool tells;                /* what is said once of many runs */
    struct asdic_text *opened; /* files that draws name, and were opened; NULL: they stay closed */
    const asdic_mission *const *bases;
    size_t base_count;
    const asdic_scene_text *memory; /* where the scene is; NULL: in a file */
    asdic_mission *donor;           /* gives its geometry where ours is the same; NULL: none */
    bool leaves_positions;          /* not checked: where the vehicle is matters later */
    asdic_flight_miss missed;       /* of the waypoints */
} mission_builder;

/* Each step adds to the mission and reports what is wrong with the files it opens to PROBLEMS. Its
 * status is only for what is no error of the input: short memory. */

/* Puts the sonar and the cast that the scene's tree ROOT takes from files into it; *INCLUDED becomes
 * true when there is one. */
asdic_status asdic_mission_include(mission_builder *b, asdic_yaml_node *root, bool *included);
asdic_status asdic_mission_include_cast(mission_builder *b, asdic_yaml_node *root, bool *included);
/* Opens the files that choices of TRIAL's draws name, but for those that were opened, and reports what is wrong with
 * them. */
asdic_status asdic_mission_open_drawn(mission_builder *b, const file_trial *trial);
/* The tree in place of the mission's text and hash. */
asdic_status asdic_mission_keep_tree(mission_builder *b, const asdic_yaml_node *root);
/* Takes CHILD out of MAP. */
void asdic_mission_take_out(asdic_yaml_node *map, const asdic_yaml_node *child);
/* Tracks from files: the vehicle's, and the objects'. */
asdic_status asdic_mission_build_tracks(mission_builder *b);
/* The mesh from PATH, which stays the mission's; as asdic_mesh_load. */
asdic_status asdic_mission_need_mesh(mission_builder *b, const char *path, double scale, bool z_up,
                                     const asdic_mesh **out);
/* All that DONOR has. */
void asdic_mission_take_meshes(asdic_mission *mission, asdic_mission *donor);
/* Surface, bottom and objects; the scene is committed when nothing was wrong. */
asdic_status asdic_mission_build_scene(mission_builder *b);
/* The same where the scene is the base's: the objects alone, where they are. */
asdic_status asdic_mission_borrow_scene(mission_builder *b);
/* The flight along waypoints, and the number of pings. It comes after the scene, whose bottom a
 * flight may follow. */
asdic_status asdic_mission_build_pings(mission_builder *b);
/* What `rays: auto` means for the pings of this scene. */
void asdic_mission_build_rays(mission_builder *b);
/* Checks that the sonar stays above the bottom, and remarks on objects that cannot be seen. */
void asdic_mission_check_positions(mission_builder *b);

/* Whether nothing is wrong with what the geometry and the sonar's way are made from, whatever else is. */
bool asdic_mission_is_sound(const mission_builder *b);

/* NAME, which the scene file gives, as a path from here; NULL when memory is short. */
const char *asdic_mission_resolve(const mission_builder *b, const char *name);

/* Turns a failed STATUS, of opening a file that NODE names for example, into a problem at NODE
 * that says the context's sentence. Short memory is no fault of the file: that status is
 * returned. */
asdic_status asdic_mission_file_problem(mission_builder *b, asdic_yaml_node *node,
                                        asdic_status status);
/* The same of a file that was read, or not, with STATUS while there were BEFORE problems: what was found in it
 * since makes NODE bad. */
asdic_status asdic_mission_file_read(mission_builder *b, asdic_yaml_node *node, size_t before,
                                     asdic_status status);

#endif
