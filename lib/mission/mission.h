/*
 * The inside of a mission: what the scene file says in the library's units, with its geometry
 * loaded.
 */
#ifndef ASDIC_MISSION_MISSION_H
#define ASDIC_MISSION_MISSION_H

#include <asdic/mission.h>

#include "laws/scatterer.h"
#include "mission_settings.h"
#include "mission/scene_file/trial_plan.h"
#include "mission/track/flight.h"
#include "mission/track/track.h"

/* The track of the object called NAME. */
typedef struct asdic_motion {
    char name[ASDIC_NAME_SIZE];
    asdic_track *track;
} asdic_motion;

typedef struct mission_mesh mission_mesh; /* mission_meshes.c */
struct asdic_text;                        /* base/text.h */

struct asdic_mission {
    asdic_context *ctx;
    char *path; /* as given; "-" is standard input */
    char *text; /* in UTF-8, as run.json keeps it */
    char hash[65];
    char file_hash[65]; /* of the scene file's bytes alone, whatever it includes or draws */
    asdic_settings settings;
    asdic_scene *scene;
    asdic_mission_object *objects;
    size_t object_count;
    asdic_motion *motions; /* by name */
    size_t motion_count;
    asdic_material bottom; /* without a law where there is none */
    const double **rows;   /* of the files that materials name */
    size_t row_files;
    asdic_trial_plan trial; /* of a run of a trial; without a section as its defaults say */
    char trial_hash[65];    /* of that section, its draws too */
    double *points_m;       /* of the flight */
    char *geometry;         /* what the scene was made from, of a run of a trial */
    size_t ground_length;   /* of it, surface and bottom */
    mission_mesh *meshes;   /* objects' files; of a run of a trial also after it is built */
    size_t mesh_count;
    asdic_setting *drawn; /* of a run of a trial; one of NULL ends it; NULL: nothing was drawn */
    /* Of missions by asdic_mission_load_like. */
    char form[65];                    /* hash of all but the places of objects and vehicle */
    char (*classes)[ASDIC_NAME_SIZE]; /* the names of objects in any run, in the file's order */
    size_t class_count;
    bool stands_anywhere;      /* the scene's objects are to be put where `objects` say */
    const asdic_mission *base; /* that the scene belongs to; NULL: its own */
    bool is_varied;            /* settings changed what the text says */
    asdic_choices said;        /* by the text */
    bool is_chosen;            /* choices differ from these */
    asdic_flight flight;       /* how the vehicle manoeuvres; an ordinary one without waypoints */
    asdic_pose pose;           /* of every ping, when there is no track */
    asdic_track *track;        /* NULL: at rest */
    size_t ping_count;
};

/* What the file describes with its objects left out. Says nothing of what the file may be about to
 * get wrong: asdic_mission_load does. */
asdic_status asdic_mission_load_empty(asdic_context *ctx, const char *path, asdic_mission **out);

/* As asdic_mission_load_run, of a vehicle that steers itself: nothing is said of where it would be at a
 * ping, and it may start below the bottom. DONOR (NULL: none), of a run whose simulators are gone,
 * gives its geometry away where it is the same; then it can only be destroyed. */
asdic_status asdic_mission_load_trial(asdic_context *ctx, const char *path,
                                      const asdic_setting *settings, size_t count,
                                      const asdic_draw *draw, asdic_mission *donor,
                                      asdic_mission **out);

/* asdic_mission_load_run of one of many runs. All objects of its scene can be moved, and are to be
 * before a ping, where stands_anywhere. Where one of the COUNT BASES, which may be NULL and must live
 * longer, differs from the run in places alone, the scene is that one's (`base`). The sonar may be
 * below the bottom. Remarks on places are left out there, and unless TELLS. */
asdic_status asdic_mission_load_like(asdic_context *ctx, const char *path, const asdic_draw *draw,
                                     const asdic_mission *const *bases, size_t count, bool tells,
                                     asdic_mission **out);

/* The bottom where it is a mesh or grid: the first object, which has no name. Else NULL. */
const asdic_mission_object *asdic_mission_bottom_mesh(const asdic_mission *mission);

/* Whether the scene file at PATH with SETTINGS can be what run DRAW->run draws: by its text, no other file than those it
 * includes is opened. OPENED, NULL for all but the first: also whether its draws can be those of any run, with the files
 * that they name, each once: OPENED, empty at first and to be finished, keeps their names. */
asdic_status asdic_mission_check_run(asdic_context *ctx, const char *path,
                                     const asdic_setting *settings, size_t count,
                                     const asdic_draw *draw, struct asdic_text *opened);

/* The mission of the scene file at PATH, if that, with what it includes, says what the mission with
 * HASH did; NULL if it is gone, or says something else. */
asdic_status asdic_mission_load_same(asdic_context *ctx, const char *path, const char *hash,
                                     asdic_mission **out);

/* The place of NAME among the mission's classes, from 1; 0: it is none of them. */
size_t asdic_mission_class(const asdic_mission *mission, const char *name);

/* The water in which the first ping meets what scatters. */
asdic_law_water asdic_mission_law_water(const asdic_mission *mission);

/* asdic_mission_uncertainty of OBJECT, an index, alone. */
double asdic_mission_object_uncertainty_db(const asdic_mission *mission, size_t object);

#define ASDIC_BELOW_BOTTOM_SIZE 200

/* Whether the sonar is below the bottom at PING; then TEXT says so, and what to do. */
bool asdic_mission_is_below_bottom(const asdic_mission *mission, size_t ping,
                                   char text[ASDIC_BELOW_BOTTOM_SIZE]);

/* Whether a ping has the object NAME in its range. */
bool asdic_mission_reaches(const asdic_mission *mission, const char *name);

/* Frees the meshes of objects' files. */
void asdic_mission_forget_meshes(asdic_mission *mission);

/* The sound speed at the first ping's depth, for which a simulator fixes the number of bins. */
double asdic_mission_speed_mps(const asdic_mission *mission);

/* Where OBJECT, or its mesh frame, is. */
asdic_pose asdic_mission_object_pose_at(const asdic_mission *mission,
                                        const asdic_mission_object *object, double time_s);

/* Of the object NAME; NULL: it stays where it is. */
const asdic_track *asdic_mission_track_of(const asdic_mission *mission, const char *name);

/* The ping at whose pose ping FIRST learns; of it and the MOST - 1 after it the first COUNT do. */
size_t asdic_mission_lesson(const asdic_mission *mission, size_t first, size_t most, size_t *count);

/* Puts the objects that move where they are at TIME_S of the pings' clock. */
asdic_status asdic_mission_place_at(const asdic_mission *mission, asdic_simulator *simulator,
                                    double time_s);

/* Adds a remark to OUT, where there is room for one. */
void asdic_remark_add(asdic_remarks *out, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Where rays that bend do not come, in the first ping: shadows, turning and trapped rays. */
void asdic_mission_remark_water(const asdic_mission *mission, asdic_remarks *out);

/* Meshes that may be of plates or round, where sound of SPEED_MPS makes a difference of it. */
void asdic_mission_remark_ambiguity(const asdic_mission *mission, double speed_mps,
                                    asdic_remarks *out);

/* FOLDER/track.csv: pings FIRST to FIRST + COUNT - 1. */
asdic_status asdic_mission_write_pings(asdic_context *ctx, const asdic_mission *mission,
                                       size_t first, size_t count, const char *path);

/* SHA-256 in hexadecimal of the triangles and of every ping's poses, of the vehicle and of objects
 * that move (mission_hash.c). */
asdic_status asdic_mission_inputs_hash(asdic_context *ctx, const asdic_mission *mission,
                                       char hex[65]);

#endif
