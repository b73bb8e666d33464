/*
 * Keys of what sound meets: surface, bottom, objects.
 */
#include "scene_keys.h"

/* --- surface and bottom ----------------------------------------------------------------------- */

static const asdic_key surface_keys[] = {
    {"enabled", ASDIC_KEY_BOOL, AT(file_surface, enabled), .fallback = "true",
     .doc = "whether there is a sea surface at z = 0"},
};
const asdic_table asdic_surface_table = {TABLE(surface_keys, file_surface),
                                         .doc = "the sea surface, the plane z = 0"};

static const asdic_key mesh_keys[] = {
    {"file", ASDIC_KEY_PATH, ASDIC_KEY_REQUIRED, AT(file_mesh, file), .file = ASDIC_FILE_MESH,
     .doc = "mesh file (OBJ, PLY, STL, OFF), relative to the scene file"},
    {"scale", ASDIC_KEY_NUMBER, AT(file_mesh, scale), .min = 1e-6, .max = 1e6, .fallback = "1",
     .doc = "metres per unit of the file: 0.001 for millimetres"},
    {"z_up", ASDIC_KEY_BOOL, AT(file_mesh, z_up), .fallback = "true",
     .doc = "the file's axes are east, north, up; false: north, east, down"},
};
static const asdic_table mesh_table = {TABLE(mesh_keys, file_mesh), .doc = "a mesh file",
                                       .scalar_key = "file"};

static const asdic_word grid_words[] = {
    {"depths", FILE_GRID_DEPTHS}, {"heights", FILE_GRID_HEIGHTS}, {NULL, 0}};
static const asdic_key grid_keys[] = {
    {"file", ASDIC_KEY_PATH, ASDIC_KEY_REQUIRED, AT(file_grid, file), .file = ASDIC_FILE_GRID,
     .doc = "ESRI ASCII grid, relative to the scene file"},
    {"values", ASDIC_KEY_WORD, AT(file_grid, values), .words = grid_words, .fallback = "depths",
     .doc = "what the grid holds: depths, positive down, or heights, positive up"},
};
static const asdic_table grid_table = {TABLE(grid_keys, file_grid), .doc = "a bathymetric grid",
                                       .scalar_key = "file"};

#define BOTTOM(member) AT(file_bottom, member)
static const asdic_key bottom_keys[] = {
    {"depth_m", ASDIC_KEY_NUMBER, ASDIC_KEY_ONE_OF, BOTTOM(depth_m), .unit = "m", .min = 0.01,
     .max = 11000, .doc = "a flat bottom at this depth"},
    {"mesh", ASDIC_KEY_MAP, ASDIC_KEY_ONE_OF | ASDIC_KEY_OPTIONAL, BOTTOM(mesh),
     .table = &mesh_table, .doc = "a bottom from a mesh file"},
    {"grid", ASDIC_KEY_MAP, ASDIC_KEY_ONE_OF | ASDIC_KEY_OPTIONAL, BOTTOM(grid),
     .table = &grid_table, .doc = "a bottom from a grid of depths"},
    {"none", ASDIC_KEY_BOOL, ASDIC_KEY_ONE_OF, BOTTOM(none), .doc = "true: no bottom at all"},
    {"position_m", ASDIC_KEY_NUMBERS, BOTTOM(position_m), .unit = "m", .min = -1e7, .max = 1e7,
     .count = 3, .fallback = "[0, 0, 0]",
     .doc = "where the origin of a mesh or grid lies: north, east, down"},
    {"rotation_deg", ASDIC_KEY_NUMBERS, BOTTOM(rotation_deg), .unit = "deg", .min = -360,
     .max = 360, .count = 3, .fallback = "[0, 0, 0]",
     .doc = "roll, pitch, yaw of a mesh or grid; applied yaw, then pitch, then roll"},
};
const asdic_table asdic_bottom_table = {TABLE(bottom_keys, file_bottom), .doc = "the sea floor",
                                        .scalar_word = "none"};

/* --- objects ---------------------------------------------------------------------------------- */

static const asdic_key box_keys[] = {
    {"size_m", ASDIC_KEY_NUMBERS, ASDIC_KEY_REQUIRED, AT(file_box, size_m), .unit = "m",
     .min = 1e-4, .max = 1e6, .count = 3, .doc = "length along x, y, z"},
};
static const asdic_table box_table = {TABLE(box_keys, file_box), .doc = "a box"};

#define RADIUS                                                                                     \
    {                                                                                              \
        "radius_m", ASDIC_KEY_NUMBER, ASDIC_KEY_REQUIRED, AT(file_round, radius_m),                \
            .unit = "m", .min = 1e-4, .max = 1e5, .doc = "radius"                                  \
    }
#define SEGMENTS                                                                                   \
    {                                                                                              \
        "segments", ASDIC_KEY_INTEGER, AT(file_round, segments),                                   \
            .min = 8, .max = ASDIC_MOST_SEGMENTS, .fallback = "96",                                \
            .doc = "facets round the circumference"                                                \
    }
static const asdic_key sphere_keys[] = {RADIUS, SEGMENTS};
static const asdic_table sphere_table = {TABLE(sphere_keys, file_round), .doc = "a sphere"};

static const asdic_key cylinder_keys[] = {
    RADIUS,
    {"length_m", ASDIC_KEY_NUMBER, ASDIC_KEY_REQUIRED, AT(file_round, length_m), .unit = "m",
     .min = 1e-4, .max = 1e6, .doc = "length along its axis, which is y"},
    SEGMENTS,
};
static const asdic_table cylinder_table = {TABLE(cylinder_keys, file_round),
                                           .doc = "a closed cylinder along y"};

static const asdic_key plate_keys[] = {
    {"size_m", ASDIC_KEY_NUMBERS, ASDIC_KEY_REQUIRED, AT(file_plate, size_m), .unit = "m",
     .min = 1e-4, .max = 1e6, .count = 2, .doc = "width along y, height along z"},
};
static const asdic_table plate_table = {TABLE(plate_keys, file_plate),
                                        .doc = "a thin plate, its normal along x"};

static const asdic_key point_keys[] = {
    {"target_strength_db", ASDIC_KEY_NUMBER, ASDIC_KEY_REQUIRED, AT(file_point, target_strength_db),
     .unit = "dB re 1 m2", .min = -200, .max = 100,
     .doc = "measured target strength: tungsten carbide sphere of 38.1 mm at 38 kHz -42.3"},
};
static const asdic_table point_table = {TABLE(point_keys, file_point),
                                        .doc = "a point of known target strength",
                                        .scalar_key = "target_strength_db"};

/* All its keys are those of laws. */
const asdic_table asdic_material_table = {.size = sizeof(file_material),
                                          .doc = "how a surface scatters",
                                          .scalar_key = "preset",
                                          .scalar_is_any_word = true};

#define OBJECT(member) AT(file_object, member)
#define SHAPE (ASDIC_KEY_ONE_OF | ASDIC_KEY_OPTIONAL)
static const asdic_key object_keys[] = {
    {"name", ASDIC_KEY_NAME, OBJECT(name),
     .doc = "name in detections, not none, ghost or faint; else object0, object1, ..."},
    {"box", ASDIC_KEY_MAP, SHAPE, OBJECT(box), .table = &box_table, .doc = "a box"},
    {"sphere", ASDIC_KEY_MAP, SHAPE, OBJECT(sphere), .table = &sphere_table, .doc = "a sphere"},
    {"cylinder", ASDIC_KEY_MAP, SHAPE, OBJECT(cylinder), .table = &cylinder_table,
     .doc = "a closed cylinder along y"},
    {"plate", ASDIC_KEY_MAP, SHAPE, OBJECT(plate), .table = &plate_table,
     .doc = "a thin plate, its normal along x"},
    {"mesh", ASDIC_KEY_MAP, SHAPE, OBJECT(mesh), .table = &mesh_table, .doc = "a mesh file"},
    {"point", ASDIC_KEY_MAP, SHAPE, OBJECT(point), .table = &point_table,
     .doc = "a point of known target strength"},
    {"position_m", ASDIC_KEY_NUMBERS, ASDIC_KEY_REQUIRED, OBJECT(position_m), .unit = "m",
     .min = -1e7, .max = 1e7, .count = 3, .unless = "track",
     .doc = "centre (of a mesh: its origin), north, east, down"},
    {"track", ASDIC_KEY_PATH, OBJECT(track), .file = ASDIC_FILE_TRACK,
     .doc = "CSV file, as a mission's, of where it moves: its centre and attitude at the pings' "
            "times"},
    {"rotation_deg", ASDIC_KEY_NUMBERS, OBJECT(rotation_deg), .unit = "deg", .min = -360,
     .max = 360, .count = 3, .fallback = "[0, 0, 0]",
     .doc = "roll, pitch, yaw; applied yaw, then pitch, then roll"},
    {"crease_deg", ASDIC_KEY_NUMBER, OBJECT(crease_deg), .unit = "deg", .min = 0, .max = 90,
     .fallback = "35",
     .doc = "facets that meet at less stand for one curved surface if they go on turning; 0: all "
            "are flat"},
    {"material", ASDIC_KEY_MAP, ASDIC_KEY_AT_MOST_ONE | ASDIC_KEY_OPTIONAL, OBJECT(material),
     .table = &asdic_material_table, .doc = "how it scatters; else steel, slightly rough"},
};
const asdic_table asdic_object_table = {TABLE(object_keys, file_object),
                                        .doc = "something in the water or on the bottom"};
