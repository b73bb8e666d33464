/*
 * The keys of the scene file. One row says all there is to say about a key; adding a feature adds
 * a row, and finishing one takes the ASDIC_KEY_PLANNED flag off its row.
 */
#include "scene_file.h"

#include <math.h>

#define COUNT_OF(array) (sizeof(array) / sizeof *(array))
#define TABLE(keys_of, type_of)                                                                    \
    .keys = keys_of, .key_count = COUNT_OF(keys_of), .size = sizeof(type_of)
#define AT(type_of, member) .offset = offsetof(type_of, member)

/* --- environment ------------------------------------------------------------------------------ */

static const asdic_word particle_words[] = {
    {"low", -90, false}, {"moderate", -70, false}, {"high", -50, false}, {NULL, 0, false}};

#define ENV(member) AT(file_environment, member)
static const asdic_key environment_keys[] = {
    {"temperature_degc", ASDIC_KEY_NUMBER, ENV(temperature_degc), .unit = "degC", .min = -2,
     .max = 40, .fallback = "10", .doc = "water temperature"},
    {"salinity_ppt", ASDIC_KEY_NUMBER, ENV(salinity_ppt), .unit = "ppt", .min = 0, .max = 45,
     .fallback = "35", .doc = "salinity"},
    {"ph", ASDIC_KEY_NUMBER, ENV(ph), .min = 7, .max = 8.5, .fallback = "8",
     .doc = "acidity, for the boric-acid part of absorption"},
    {"wind_speed_kn", ASDIC_KEY_NUMBER, ENV(wind_speed_kn), .unit = "kn", .min = 0, .max = 60,
     .fallback = "10", .doc = "wind speed, for surface scattering and sea-state noise"},
    {"shipping_density", ASDIC_KEY_NUMBER, ENV(shipping_density), .min = 0, .max = 1,
     .fallback = "0.5", .doc = "distant shipping, from none (0) to heavy (1), for traffic noise"},
    {"particle_density", ASDIC_KEY_NUMBER, ENV(particle_strength_db), .unit = "dB re 1/m at 1 kHz",
     .min = -200, .max = 0, .words = particle_words, .fallback = "low",
     .doc = "particles in the water, for volume scattering: low -90, moderate -70, high -50"},
    {"sound_speed_mps", ASDIC_KEY_NUMBER, ENV(sound_speed_mps), .unit = "m/s", .min = 1300,
     .max = 1700, .doc = "sound speed; else from temperature, salinity and the sonar's depth"},
    {"max_depth_m", ASDIC_KEY_NUMBER, ENV(max_depth_m), .unit = "m", .min = 0, .max = 11000,
     .doc = "depth that absorption is computed for; else the sonar's depth"},
};
static const asdic_table environment_table = {TABLE(environment_keys, file_environment),
                                              .doc = "the water"};

/* --- surface and bottom ----------------------------------------------------------------------- */

static const asdic_key surface_keys[] = {
    {"enabled", ASDIC_KEY_BOOL, AT(file_surface, enabled), .fallback = "true",
     .doc = "whether there is a sea surface at z = 0"},
};
static const asdic_table surface_table = {TABLE(surface_keys, file_surface),
                                          .doc = "the sea surface, the plane z = 0"};

static const asdic_key mesh_keys[] = {
    {"file", ASDIC_KEY_PATH, ASDIC_KEY_REQUIRED, AT(file_mesh, file),
     .doc = "mesh file (OBJ, PLY, STL, OFF), relative to the scene file"},
    {"scale", ASDIC_KEY_NUMBER, AT(file_mesh, scale), .min = 1e-6, .max = 1e6, .fallback = "1",
     .doc = "metres per unit of the file: 0.001 for millimetres"},
    {"z_up", ASDIC_KEY_BOOL, AT(file_mesh, z_up), .fallback = "true",
     .doc = "the file's axes are east, north, up; false: north, east, down"},
};
static const asdic_table mesh_table = {TABLE(mesh_keys, file_mesh), .doc = "a mesh file",
                                       .scalar_key = "file"};

static const asdic_word grid_words[] = {
    {"depths", FILE_GRID_DEPTHS, false}, {"heights", FILE_GRID_HEIGHTS, false}, {NULL, 0, false}};
static const asdic_key grid_keys[] = {
    {"file", ASDIC_KEY_PATH, ASDIC_KEY_REQUIRED, AT(file_grid, file),
     .doc = "ESRI ASCII grid, relative to the scene file"},
    {"values", ASDIC_KEY_WORD, AT(file_grid, values), .words = grid_words, .fallback = "depths",
     .doc = "what the grid holds: depths, positive down, or heights, positive up"},
};
static const asdic_table grid_table = {TABLE(grid_keys, file_grid), .doc = "a bathymetric grid",
                                       .scalar_key = "file"};

static const asdic_word bottom_words[] = {{"mud", 1, false},
                                          {"sand", 2, false},
                                          {"gravel", 3, false},
                                          {"rock", 4, false},
                                          {NULL, 0, false}};

#define BOTTOM(member) AT(file_bottom, member)
static const asdic_key bottom_keys[] = {
    {"depth_m", ASDIC_KEY_NUMBER, ASDIC_KEY_ONE_OF, BOTTOM(depth_m), .unit = "m", .min = 0.01,
     .max = 11000, .doc = "a flat bottom at this depth"},
    {"mesh", ASDIC_KEY_MAP, ASDIC_KEY_ONE_OF | ASDIC_KEY_OPTIONAL, BOTTOM(mesh),
     .table = &mesh_table, .doc = "a bottom from a mesh file"},
    {"grid", ASDIC_KEY_MAP, ASDIC_KEY_ONE_OF | ASDIC_KEY_OPTIONAL, BOTTOM(grid),
     .table = &grid_table, .doc = "a bottom from a grid of depths"},
    {"none", ASDIC_KEY_BOOL, ASDIC_KEY_ONE_OF, BOTTOM(none), .doc = "true: no bottom at all"},
    {"type", ASDIC_KEY_NUMBER, BOTTOM(type), .min = 1, .max = 4, .words = bottom_words,
     .fallback = "sand", .doc = "what the bottom is made of: mud 1, sand 2, gravel 3, rock 4"},
    {"position_m", ASDIC_KEY_NUMBERS, BOTTOM(position_m), .unit = "m", .min = -1e7, .max = 1e7,
     .count = 3, .fallback = "[0, 0, 0]",
     .doc = "where the origin of a mesh or grid lies: north, east, down"},
    {"rotation_deg", ASDIC_KEY_NUMBERS, BOTTOM(rotation_deg), .unit = "deg", .min = -360,
     .max = 360, .count = 3, .fallback = "[0, 0, 0]",
     .doc = "roll, pitch, yaw of a mesh or grid; applied yaw, then pitch, then roll"},
};
static const asdic_table bottom_table = {TABLE(bottom_keys, file_bottom), .doc = "the sea floor",
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
            .min = 8, .max = 1024, .fallback = "96", .doc = "facets round the circumference"       \
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

#define MATERIAL(member) AT(file_material, member)
static const asdic_key material_keys[] = {
    {"impedance_mrayl", ASDIC_KEY_NUMBER, MATERIAL(impedance_mrayl), .unit = "MRayl", .min = 0,
     .max = 200, .fallback = "45", .doc = "acoustic impedance: steel 45, water 1.54, air 0"},
    {"roughness_rms_mm", ASDIC_KEY_NUMBER, MATERIAL(roughness_rms_mm), .unit = "mm", .min = 0,
     .max = 1000, .fallback = "1", .doc = "r.m.s. height of the roughness"},
    {"slope_rms", ASDIC_KEY_NUMBER, MATERIAL(slope_rms), .min = 0, .max = 2, .fallback = "0.1",
     .doc = "r.m.s. slope of the roughness"},
    {"coherent_area_m2", ASDIC_KEY_NUMBER, MATERIAL(coherent_area_m2), .unit = "m2", .min = 1e-8,
     .max = 1e8,
     .doc = "flat area that reflects in phase; else the largest flat patch of the mesh"},
    {"type", ASDIC_KEY_NUMBER, MATERIAL(type), .min = 1, .max = 4, .words = bottom_words,
     .doc = "scatters as this bottom instead: mud 1, sand 2, gravel 3, rock 4"},
};
static const asdic_table material_table = {TABLE(material_keys, file_material),
                                           .doc = "how a surface scatters"};

#define OBJECT(member) AT(file_object, member)
#define SHAPE (ASDIC_KEY_ONE_OF | ASDIC_KEY_OPTIONAL)
static const asdic_key object_keys[] = {
    {"name", ASDIC_KEY_NAME, OBJECT(name), .doc = "name in detections; else object0, object1, ..."},
    {"box", ASDIC_KEY_MAP, SHAPE, OBJECT(box), .table = &box_table, .doc = "a box"},
    {"sphere", ASDIC_KEY_MAP, SHAPE, OBJECT(sphere), .table = &sphere_table, .doc = "a sphere"},
    {"cylinder", ASDIC_KEY_MAP, SHAPE, OBJECT(cylinder), .table = &cylinder_table,
     .doc = "a closed cylinder along y"},
    {"plate", ASDIC_KEY_MAP, SHAPE, OBJECT(plate), .table = &plate_table,
     .doc = "a thin plate, its normal along x"},
    {"mesh", ASDIC_KEY_MAP, SHAPE, OBJECT(mesh), .table = &mesh_table, .doc = "a mesh file"},
    {"position_m", ASDIC_KEY_NUMBERS, ASDIC_KEY_REQUIRED, OBJECT(position_m), .unit = "m",
     .min = -1e7, .max = 1e7, .count = 3,
     .doc = "centre (of a mesh: its origin), north, east, down"},
    {"rotation_deg", ASDIC_KEY_NUMBERS, OBJECT(rotation_deg), .unit = "deg", .min = -360,
     .max = 360, .count = 3, .fallback = "[0, 0, 0]",
     .doc = "roll, pitch, yaw; applied yaw, then pitch, then roll"},
    {"material", ASDIC_KEY_MAP, ASDIC_KEY_AT_MOST_ONE | ASDIC_KEY_OPTIONAL, OBJECT(material),
     .table = &material_table, .doc = "how it scatters; else steel, slightly rough"},
    {"type", ASDIC_KEY_NUMBER, ASDIC_KEY_AT_MOST_ONE, OBJECT(type), .min = 1, .max = 4,
     .words = bottom_words, .doc = "scatters as this bottom: mud 1, sand 2, gravel 3, rock 4"},
};
static const asdic_table object_table = {TABLE(object_keys, file_object),
                                         .doc = "something in the water or on the bottom"};

/* --- sonar ------------------------------------------------------------------------------------ */

#define ANGLE(type_of, member, low, high, what)                                                    \
    {                                                                                              \
#member, ASDIC_KEY_NUMBER, AT(type_of, member), .unit = "deg", .min = low, .max = high,    \
                                                        .fallback = "0", .doc = what               \
    }
#define LENGTH(type_of, member, what)                                                              \
    {                                                                                              \
#member, ASDIC_KEY_NUMBER, AT(type_of, member), .unit = "m", .min = 1e-4, .max = 100,      \
                                                        .fallback = "0.05", .doc = what            \
    }
#define APERTURE(type_of)                                                                          \
    ANGLE(type_of, pitch_deg, -180, 180, "aim below the bow's level; positive looks down"),        \
        ANGLE(type_of, yaw_deg, -180, 180, "aim to starboard of the bow"),                         \
        ANGLE(type_of, roll_deg, -180, 180, "turn about the beam's own axis"),                     \
        LENGTH(type_of, length_h_m, "horizontal side of the aperture"),                            \
        LENGTH(type_of, length_v_m, "vertical side of the aperture")

static const asdic_key transmitter_keys[] = {APERTURE(file_beam)};
static const asdic_table transmitter_table = {TABLE(transmitter_keys, file_beam),
                                              .doc = "the transmitting aperture"};

static const asdic_key beam_keys[] = {
    {"name", ASDIC_KEY_NAME, AT(file_beam, name),
     .doc = "name in tables and file names; else 000, 001, ..."},
    APERTURE(file_beam),
};
static const asdic_table beam_table = {TABLE(beam_keys, file_beam), .doc = "a receiving aperture"};

static const asdic_key fan_keys[] = {
    {"count", ASDIC_KEY_INTEGER, ASDIC_KEY_REQUIRED, AT(file_fan, count), .min = 1, .max = 4096,
     .doc = "number of beams, named 000, 001, ... from port to starboard"},
    {"sector_deg", ASDIC_KEY_NUMBER, ASDIC_KEY_REQUIRED, AT(file_fan, sector_deg), .unit = "deg",
     .min = 0.001, .max = 360, .doc = "angle that the beams share; each looks along its middle"},
    APERTURE(file_fan),
};
static const asdic_table fan_table = {TABLE(fan_keys, file_fan), .doc = "evenly spread beams"};
static const asdic_key fan_map_keys[] = {
    {"fan", ASDIC_KEY_MAP, ASDIC_KEY_REQUIRED, AT(file_fan_map, fan), .table = &fan_table,
     .doc = "evenly spread beams"},
};
static const asdic_table fan_map_table = {TABLE(fan_map_keys, file_fan_map),
                                          .doc = "receivers as a fan"};

static const asdic_key noise_keys[] = {
    {"enabled", ASDIC_KEY_BOOL, AT(file_noise, enabled), .fallback = "true",
     .doc = "whether ambient noise is added"},
    {"directivity", ASDIC_KEY_BOOL, AT(file_noise, directivity), .fallback = "true",
     .doc = "whether the receiver's directivity index is taken off it"},
};
static const asdic_table noise_table = {TABLE(noise_keys, file_noise), .doc = "ambient noise"};

static const asdic_word speckle_words[] = {{"none", ASDIC_SPECKLE_NONE, false},
                                           {"rayleigh", ASDIC_SPECKLE_RAYLEIGH, false},
                                           {"k", ASDIC_SPECKLE_K, false},
                                           {NULL, 0, false}};
static const asdic_word rear_words[] = {{"none", -INFINITY, false}, {NULL, 0, false}};

#define SONAR(member) AT(file_sonar, member)
static const asdic_key sonar_keys[] = {
    {"frequency_khz", ASDIC_KEY_NUMBER, ASDIC_KEY_REQUIRED, SONAR(frequency_khz), .unit = "kHz",
     .min = 0.1, .max = 1000, .doc = "centre frequency"},
    {"bandwidth_khz", ASDIC_KEY_NUMBER, SONAR(bandwidth_khz), .unit = "kHz", .min = 0.001,
     .max = 1000, .fallback = "10", .doc = "bandwidth; the range resolution is c / (2 bandwidth)"},
    {"ping_rate_hz", ASDIC_KEY_NUMBER, SONAR(ping_rate_hz), .unit = "Hz", .min = 0.01, .max = 1000,
     .fallback = "10", .doc = "pings a second; the maximum range is c / (2 ping rate)"},
    {"source_level_db", ASDIC_KEY_NUMBER, SONAR(source_level_db), .unit = "dB re 1 uPa at 1 m",
     .min = -300, .max = 300, .fallback = "0", .doc = "source level after pulse compression"},
    {"bin_length_m", ASDIC_KEY_NUMBER, SONAR(bin_length_m), .unit = "m", .min = 0.001, .max = 1000,
     .fallback = "0.5", .doc = "length of a range bin"},
    {"blanking_m", ASDIC_KEY_NUMBER, SONAR(blanking_m), .unit = "m", .min = 0.01, .max = 10000,
     .fallback = "0.5", .doc = "nothing nearer is received"},
    {"transmitter", ASDIC_KEY_MAP, SONAR(transmitter), .table = &transmitter_table,
     .doc = "the transmitting aperture"},
    {"receivers", ASDIC_KEY_LIST, ASDIC_KEY_REQUIRED, SONAR(receivers), .min = 1, .count = 4096,
     .table = &beam_table, .map_form = &fan_map_table,
     .map_offset = offsetof(file_sonar, receiver_fan),
     .doc = "the receiving apertures: a list, or fan: {count, sector_deg, ...}"},
    {"noise", ASDIC_KEY_MAP, SONAR(noise), .table = &noise_table, .doc = "ambient noise"},
    {"speckle", ASDIC_KEY_WORD, SONAR(speckle), .words = speckle_words, .fallback = "none",
     .doc = "random interference of the echoes in a resolution cell"},
    {"speckle_shape", ASDIC_KEY_NUMBER, SONAR(speckle_shape), .min = 0.05, .max = 1000,
     .doc = "shape of K-distributed speckle; large is Rayleigh"},
    {"rear_floor_db", ASDIC_KEY_NUMBER, SONAR(rear_floor_db), .unit = "dB", .min = -200, .max = 0,
     .words = rear_words, .fallback = "none",
     .doc = "what leaks in and out behind the apertures, re on-axis"},
};
static const asdic_table sonar_table = {TABLE(sonar_keys, file_sonar), .doc = "the sonar"};

/* --- mission ---------------------------------------------------------------------------------- */

static const asdic_key pose_keys[] = {
    {"position_m", ASDIC_KEY_NUMBERS, ASDIC_KEY_REQUIRED, AT(file_pose, position_m), .unit = "m",
     .min = -1e7, .max = 1e7, .count = 3, .doc = "north, east, down from the sea surface"},
    ANGLE(file_pose, roll_deg, -360, 360, "roll, positive to starboard"),
    ANGLE(file_pose, pitch_deg, -360, 360, "pitch, positive raises the bow"),
    ANGLE(file_pose, yaw_deg, -360, 360, "heading, clockwise from north"),
};
static const asdic_table pose_table = {TABLE(pose_keys, file_pose), .doc = "a vehicle at rest"};

#define MISSION(member) AT(file_mission, member)
static const asdic_key mission_keys[] = {
    {"pose", ASDIC_KEY_MAP, ASDIC_KEY_ONE_OF | ASDIC_KEY_OPTIONAL, MISSION(pose),
     .table = &pose_table, .doc = "a vehicle at rest"},
    {"track", ASDIC_KEY_PATH, ASDIC_KEY_ONE_OF, MISSION(track),
     .doc = "CSV file of time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg, relative to the scene"},
    {"waypoints", ASDIC_KEY_LIST, ASDIC_KEY_ONE_OF | ASDIC_KEY_PLANNED,
     .doc = "points that the vehicle passes"},
    {"pings", ASDIC_KEY_INTEGER, MISSION(pings), .min = 1, .max = 1e9,
     .doc = "number of pings; else one, or as many as the track covers"},
};
static const asdic_table mission_table = {TABLE(mission_keys, file_mission),
                                          .doc = "where the vehicle is, ping by ping"};

/* --- how to compute, what to write ------------------------------------------------------------ */

static const asdic_word sampler_words[] = {{"adaptive", ASDIC_SAMPLER_ADAPTIVE, false},
                                           {"beam", ASDIC_SAMPLER_BEAM, false},
                                           {"uniform-sphere", ASDIC_SAMPLER_UNIFORM_SPHERE, false},
                                           {NULL, 0, false}};
static const asdic_word multipath_words[] = {
    {"off", ASDIC_MULTIPATH_OFF, false}, {"first", ASDIC_MULTIPATH_FIRST, false}, {NULL, 0, false}};
static const asdic_key sampling_keys[] = {
    {"rays", ASDIC_KEY_INTEGER, AT(file_sampling, rays), .min = 64, .max = 268435456,
     .fallback = "20000", .doc = "rays per ping"},
    {"sampler", ASDIC_KEY_WORD, AT(file_sampling, sampler), .words = sampler_words,
     .fallback = "adaptive", .doc = "how directions are drawn; uniform-sphere is the paper's"},
    {"seed", ASDIC_KEY_INTEGER, AT(file_sampling, seed), .min = 0, .max = 9007199254740992.0,
     .fallback = "1", .doc = "start of the random sequence; equal seeds give equal bytes"},
    {"multipath", ASDIC_KEY_WORD, AT(file_sampling, multipath), .words = multipath_words,
     .fallback = "first", .doc = "echoes over a second reflection"},
};
static const asdic_table sampling_table = {TABLE(sampling_keys, file_sampling),
                                           .doc = "how rays are spent"};

static const asdic_word variant_words[] = {{"corrected", ASDIC_VARIANT_CORRECTED, false},
                                           {"printed", ASDIC_VARIANT_PRINTED, false},
                                           {NULL, 0, false}};
static const asdic_key model_keys[] = {
    {"variant", ASDIC_KEY_WORD, AT(file_model, variant), .words = variant_words,
     .fallback = "corrected", .doc = "the formulas put right, or as the paper prints them"},
};
static const asdic_table model_table = {TABLE(model_keys, file_model), .doc = "the formulas"};

static const asdic_word target_words[] = {{"swerling0", ASDIC_TARGET_SWERLING0, false},
                                          {"swerling1", ASDIC_TARGET_SWERLING1, false},
                                          {"swerling3", ASDIC_TARGET_SWERLING3, false},
                                          {NULL, 0, false}};
static const asdic_key detector_keys[] = {
    {"target", ASDIC_KEY_WORD, AT(file_detector, target), .words = target_words,
     .fallback = "swerling1", .doc = "how the target's echo fluctuates"},
    {"pfa", ASDIC_KEY_NUMBER, AT(file_detector, pfa), .min = 1e-12, .max = 0.5,
     .fallback = "1.0e-3", .doc = "probability of false alarm per cell"},
    {"prior", ASDIC_KEY_NUMBER, AT(file_detector, prior), .min = 1e-9, .max = 0.999,
     .fallback = "0.01", .doc = "prior probability that a cell holds a target"},
};
static const asdic_table detector_table = {TABLE(detector_keys, file_detector),
                                           .doc = "the detector"};

static const asdic_word csv_words[] = {
    {"long", ASDIC_CSV_LONG, false}, {"wide", ASDIC_CSV_WIDE, true}, {NULL, 0, false}};
static const asdic_word image_words[] = {{"waterfall", ASDIC_IMAGE_WATERFALL, false},
                                         {"ascope", ASDIC_IMAGE_ASCOPE, false},
                                         {"fan", ASDIC_IMAGE_FAN, false},
                                         {NULL, 0, false}};
static const asdic_key output_keys[] = {
    {"csv", ASDIC_KEY_WORD, AT(file_output, csv), .words = csv_words, .fallback = "long",
     .doc = "bins.csv with a row per ping, beam and bin"},
    {"npy", ASDIC_KEY_BOOL, AT(file_output, npy), .fallback = "false",
     .doc = "also levels.npy, float32 [ping, beam, bin]"},
    {"netcdf", ASDIC_KEY_BOOL, ASDIC_KEY_PLANNED, AT(file_output, netcdf), .fallback = "false",
     .doc = "also run.nc, netCDF-4"},
    {"images", ASDIC_KEY_WORDS, AT(file_output, images), .words = image_words,
     .fallback = "[waterfall, ascope, fan]", .doc = "pictures to draw"},
};
static const asdic_table output_table = {TABLE(output_keys, file_output),
                                         .doc = "what a run writes"};

/* --- the file --------------------------------------------------------------------------------- */

#define SCENE(member) AT(asdic_scene_file, member)
static const asdic_key scene_keys[] = {
    {"version", ASDIC_KEY_INTEGER, ASDIC_KEY_REQUIRED, SCENE(version), .min = 1, .max = 1,
     .doc = "version of this format"},
    {"environment", ASDIC_KEY_MAP, SCENE(environment), .table = &environment_table,
     .doc = "the water"},
    {"surface", ASDIC_KEY_MAP, SCENE(surface), .table = &surface_table,
     .doc = "the sea surface, the plane z = 0"},
    {"bottom", ASDIC_KEY_MAP, ASDIC_KEY_REQUIRED, SCENE(bottom), .table = &bottom_table,
     .doc = "the sea floor: depth_m, mesh, grid or none"},
    {"objects", ASDIC_KEY_LIST, SCENE(objects), .min = 0, .count = 65536, .table = &object_table,
     .doc = "what is in the water or on the bottom"},
    {"sonar", ASDIC_KEY_MAP, ASDIC_KEY_REQUIRED, SCENE(sonar), .table = &sonar_table,
     .doc = "transmitter, receivers, pulse and bins"},
    {"mission", ASDIC_KEY_MAP, ASDIC_KEY_REQUIRED, SCENE(mission), .table = &mission_table,
     .doc = "where the vehicle is: pose or track"},
    {"sampling", ASDIC_KEY_MAP, SCENE(sampling), .table = &sampling_table,
     .doc = "how rays are spent"},
    {"model", ASDIC_KEY_MAP, SCENE(model), .table = &model_table, .doc = "the formulas"},
    {"detector", ASDIC_KEY_MAP, SCENE(detector), .table = &detector_table, .doc = "the detector"},
    {"output", ASDIC_KEY_MAP, SCENE(output), .table = &output_table, .doc = "what a run writes"},
};
const asdic_table asdic_scene_table = {
    TABLE(scene_keys, asdic_scene_file),
    .doc = "what asdic simulates: water, surface, bottom, objects, sonar and mission"};
