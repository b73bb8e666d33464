/*
 * A scene file's content in its own units, as the tables of scene_keys.c fill it. Every struct
 * begins with the node it was read from, NULL when the file does not have it.
 */
#ifndef ASDIC_MISSION_SCENE_FILE_H
#define ASDIC_MISSION_SCENE_FILE_H

#include <asdic/mission.h>

#include "out/format.h"
#include "schema.h"
#include "trial_plan.h"

typedef struct file_environment {
    asdic_yaml_node *node;
    double temperature_degc, salinity_ppt, ph, wind_speed_kn, shipping_density;
    double particle_strength_db;
    double sound_speed_mps, max_depth_m; /* NAN: derived */
    double sound_speed_gradient_per_s;
    asdic_list sound_speed_profile; /* of double[2]: depth, speed; empty: none */
} file_environment;

/* Keys of all laws together, at most. */
#define ASDIC_FILE_LAW_KEYS 48

typedef union file_law_value {
    double number;
    int word;
    const char *path;
} file_law_value;

/* The values of the laws' keys, in the order of the laws and their keys (scene_laws.c). */
typedef struct file_law {
    file_law_value value[ASDIC_FILE_LAW_KEYS];
} file_law;

/* A file that a material's law wants read; PATH NULL: none. */
typedef struct asdic_material_file {
    const char *path, *columns;
    asdic_yaml_node *node; /* that names it */
} asdic_material_file;

typedef struct file_surface {
    asdic_yaml_node *node;
    bool enabled;
    int law_index;
    file_law law;
} file_surface;

typedef struct file_mesh {
    asdic_yaml_node *node;
    const char *file;
    double scale;
    bool z_up;
} file_mesh;

typedef enum file_grid_values { FILE_GRID_DEPTHS, FILE_GRID_HEIGHTS } file_grid_values;

typedef struct file_grid {
    asdic_yaml_node *node;
    const char *file;
    int values; /* file_grid_values */
} file_grid;

typedef struct file_bottom {
    asdic_yaml_node *node;
    double depth_m; /* NAN: none given */
    file_mesh mesh;
    file_grid grid;
    bool none;
    double position_m[3], rotation_deg[3];
    file_law law;
} file_bottom;

typedef struct file_material {
    asdic_yaml_node *node;
    file_law law;
} file_material;

typedef struct file_box {
    asdic_yaml_node *node;
    double size_m[3];
} file_box;

typedef struct file_plate {
    asdic_yaml_node *node;
    double size_m[2];
} file_plate;

#define ASDIC_MOST_SEGMENTS 1024

typedef struct file_round { /* sphere or cylinder */
    asdic_yaml_node *node;
    double radius_m, length_m;
    int64_t segments;
} file_round;

typedef struct file_point {
    asdic_yaml_node *node;
    double target_strength_db;
} file_point;

typedef struct file_object {
    asdic_yaml_node *node;
    const char *name;
    file_box box;
    file_round sphere, cylinder;
    file_plate plate;
    file_mesh mesh;
    file_point point;
    const char *track; /* NULL: at rest */
    double position_m[3], rotation_deg[3], crease_deg;
    file_material material;
    file_law law;
} file_object;

typedef struct file_beam {
    asdic_yaml_node *node;
    const char *name;
    double pitch_deg, yaw_deg, roll_deg;
    double length_h_m, length_v_m;
} file_beam;

typedef enum file_fan_shape { FILE_FAN_PLANE, FILE_FAN_CONE } file_fan_shape;

typedef struct file_fan {
    asdic_yaml_node *node;
    int64_t count;
    double sector_deg;
    int shape; /* file_fan_shape */
    double pitch_deg, yaw_deg, roll_deg;
    double length_h_m, length_v_m;
} file_fan;

typedef struct file_fan_map {
    asdic_yaml_node *node;
    file_fan fan;
} file_fan_map;

typedef struct file_element {
    asdic_yaml_node *node;
    double length_h_m; /* NAN: none given */
    double length_v_m;
} file_element;

typedef struct file_array_beams {
    asdic_yaml_node *node;
    int64_t count;
    double sector_deg;
} file_array_beams;

typedef struct file_array {
    asdic_yaml_node *node;
    int64_t elements;
    double spacing_wl;
    int shading;         /* asdic_shading */
    double side_lobe_db; /* NAN: none given */
    file_element element;
    file_array_beams beams;
    double pitch_deg, yaw_deg, roll_deg;
} file_array;

typedef struct file_noise {
    asdic_yaml_node *node;
    bool enabled, directivity;
    double self_db; /* -INFINITY: none */
} file_noise;

typedef struct file_sweep {
    asdic_yaml_node *node;
    double sector_deg, step_deg;
} file_sweep;

typedef struct file_sonar {
    asdic_yaml_node *node;
    const char *file; /* NULL: none, or in the tree already (mission_include.c) */
    double frequency_khz, bandwidth_khz, ping_rate_hz, max_range_m, source_level_db;
    double bin_length_m, blanking_m;
    file_beam transmitter;
    asdic_list receivers; /* of file_beam */
    file_fan_map receiver_fan;
    file_array array; /* of coherent pings; elements 0: none */
    file_sweep scan;
    file_noise noise;
    int speckle;          /* asdic_speckle */
    double speckle_shape; /* NAN: none given */
    double rear_floor_db; /* -INFINITY: none */
} file_sonar;

typedef struct file_pose {
    asdic_yaml_node *node;
    double position_m[3];
    double roll_deg, pitch_deg, yaw_deg;
} file_pose;

typedef struct file_waypoints {
    asdic_yaml_node *node;
    asdic_list points; /* of double[3]: m */
    int vehicle;       /* asdic_vehicle */
    double speed_mps, turn_radius_m, response_s, dive_rate_mps;
    double current_mps[2]; /* north, east */
    double altitude_m;     /* NAN: the points' depths */
} file_waypoints;

typedef struct file_mission {
    asdic_yaml_node *node;
    file_pose pose;
    const char *track;
    file_waypoints waypoints;
    int64_t pings; /* 0: one, a turn of the head, or what the track covers */
} file_mission;

#define FILE_RAYS_AUTO 0 /* of file_sampling.rays */

typedef struct file_sampling {
    asdic_yaml_node *node;
    int64_t rays, seed;
    int sampler, multipath;
    bool coherent;
} file_sampling;

typedef enum file_terms { FILE_TERMS_NEEDED, FILE_TERMS_ALL } file_terms;

#define FILE_REFRACTION_AUTO (-1)

typedef struct file_model {
    asdic_yaml_node *node;
    int variant;
    int terms;      /* file_terms */
    int refraction; /* asdic_refraction or FILE_REFRACTION_AUTO */
} file_model;

typedef struct file_detector {
    asdic_yaml_node *node;
    int target;
    double pfa, prior, snr_db, cost_ratio; /* cost_ratio NAN: none given */
} file_detector;

/* In file_output.csv and .records, beside asdic_csv_form and asdic_record_form: as suits the size of
 * a ping. */
#define FILE_AUTO -1

typedef struct file_output {
    asdic_yaml_node *node;
    int csv, records;
    bool elements, truth;
    bool formats[ASDIC_FORMAT_COUNT];
    unsigned images;
} file_output;

/* One of uniform, normal and choice is given. */
typedef struct file_draw {
    asdic_yaml_node *node;
    asdic_yaml_node *key;    /* of what is drawn; NULL in a draw inside a choice */
    double uniform[2];       /* bounds */
    double normal[2];        /* mean, standard deviation */
    double within[2];        /* bounds of normal, when given */
    asdic_yaml_node *choice; /* a list; NULL: none */
} file_draw;

typedef struct file_rule {
    asdic_yaml_node *node;
    int manoeuvre; /* asdic_manoeuvre */
    double reach_m, sector_deg;
    double posterior, loss_ratio; /* loss_ratio NAN: none given */
    int64_t hits, of;
    double climb_m, turn_deg, hold_s;
} file_rule;

typedef struct file_ideal {
    asdic_yaml_node *node; /* NULL: the sonar is simulated */
    double pd, pfa;
} file_ideal;

typedef struct file_trial {
    asdic_yaml_node *node;
    asdic_list draws; /* of file_draw */
    double hull_radius_m;
    double time_s;  /* NAN: by the flight */
    int background; /* asdic_trial_background */
    file_rule rule;
    file_ideal ideal;
} file_trial;

typedef struct asdic_scene_file {
    asdic_yaml_node *node;
    int64_t version;
    file_environment environment;
    file_surface surface;
    file_bottom bottom;
    asdic_list objects; /* of file_object */
    file_sonar sonar;
    file_mission mission;
    file_sampling sampling;
    file_model model;
    file_detector detector;
    file_output output;
    file_trial trial;
} asdic_scene_file;

/* The table of the whole file. */
const asdic_table *asdic_scene_table(void);

/* BYTES as UTF-8 without a byte-order mark, with a zero byte behind its *LENGTH bytes, to be freed
 * with free(); NULL when memory is short. UTF-16 is known by its byte-order mark; what is no valid
 * text passes through, for the reader of the text to refuse. */
char *asdic_text_to_utf8(const char *bytes, size_t size, size_t *length);

/* Parses SIZE bytes of UTF-8 text, checks each key by itself and then together (scene_check.c).
 * Every error goes to PROBLEMS; FILE is meaningful where nothing is bad. False: out of memory. */
bool asdic_scene_file_parse(const char *text, size_t size, asdic_arena *arena,
                            asdic_problems *problems, asdic_scene_file *file);

/* The same from a tree; NULL: none could be read. */
bool asdic_scene_file_take(asdic_yaml_node *root, asdic_arena *arena, asdic_problems *problems,
                           asdic_scene_file *file);

/* The node that PATH names, "sonar.receivers[0].pitch_deg". Maps on the way are made when they are
 * missing, without ARENA not; entries of lists must be there. A problem is BLAME's (NULL: of the node where the path
 * ends). NULL after a problem. */
asdic_yaml_node *asdic_scene_file_find(asdic_yaml_node *root, const char *path,
                                       asdic_yaml_node *blame, asdic_arena *arena,
                                       asdic_problems *problems);

/* SETTING in place of what the tree says. */
void asdic_scene_file_set(asdic_yaml_node *root, const asdic_setting *setting, asdic_arena *arena,
                          asdic_problems *problems);

/* When a key is drawn and set: those of the trial say what is drawn; then come those that name a file to
 * include, or rule what comes of it, since all others may be in what it brings. */
typedef enum asdic_scene_turn {
    ASDIC_TURN_TRIAL,
    ASDIC_TURN_INCLUDES,
    ASDIC_TURN_REST
} asdic_scene_turn;

asdic_scene_turn asdic_scene_key_turn(const char *key);

/* Whether KEY is WHOLE, or a part of it. */
bool asdic_scene_key_is_in(const char *key, const char *whole);

/* Checks what depends on several keys, and names what has no name (scene_check.c). */
void asdic_scene_file_check(asdic_scene_file *file, asdic_arena *arena, asdic_problems *problems);

/* Checks the range and its bins at the sound speed of DEPTH_M, where the sonar is at its first ping.
 * asdic_scene_file_check does so of a sonar at rest. */
void asdic_scene_file_check_bins(const asdic_scene_file *file, double depth_m,
                                 asdic_problems *problems);

/* Whether NODE is given and nothing in it is wrong, so that it can be judged together with
 * others. */
bool asdic_scene_node_good(const asdic_yaml_node *node);

/* The file's content in the library's units (scene_convert.c). The sonar comes without its
 * receivers, but with their number; RECEIVERS has room for them. */
asdic_environment asdic_scene_file_environment(const asdic_scene_file *file);
asdic_sonar asdic_scene_file_sonar(const asdic_scene_file *file);
asdic_sweep asdic_scene_file_sweep(const asdic_scene_file *file);
void asdic_scene_file_receivers(const asdic_scene_file *file, asdic_beam *receivers);
asdic_trial_plan asdic_scene_file_trial(const file_trial *trial);
asdic_pose asdic_scene_file_place(const double position_m[3], const double rotation_deg[3]);
asdic_pose asdic_scene_file_pose(const asdic_scene_file *file);
asdic_material asdic_scene_file_surface(const asdic_scene_file *file, asdic_material_file *rows);
asdic_material asdic_scene_file_bottom(const asdic_scene_file *file, asdic_material_file *rows);
asdic_material asdic_scene_file_material(const file_object *object, asdic_material_file *rows);

#endif
