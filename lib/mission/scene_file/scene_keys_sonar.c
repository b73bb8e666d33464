/*
 * Keys of the sonar, and of where it goes.
 */
#include "scene_keys.h"

#include "laws/keys.h"
#include "mission/track/flight.h"
#include "sim/texture.h"

#include <math.h>

/* --- sonar ------------------------------------------------------------------------------------ */

#define LENGTH_OR(type_of, member, otherwise, what)                                                \
    {                                                                                              \
#member, ASDIC_KEY_NUMBER, AT(type_of, member), .unit = "m", .min = 1e-4, .max = 100,      \
                                                        .fallback = otherwise, .doc = what         \
    }
#define LENGTH(type_of, member, what) LENGTH_OR(type_of, member, "0.05", what)
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

static const asdic_word fan_shape_words[] = {
    {"plane", FILE_FAN_PLANE}, {"cone", FILE_FAN_CONE}, {NULL, 0}};

static const asdic_key fan_keys[] = {
    {"count", ASDIC_KEY_INTEGER, ASDIC_KEY_REQUIRED, AT(file_fan, count), .min = 1,
     .max = ASDIC_SONAR_MAX_RECEIVERS,
     .doc = "number of beams, named 000, 001, ... from port to starboard"},
    {"sector_deg", ASDIC_KEY_NUMBER, ASDIC_KEY_REQUIRED, AT(file_fan, sector_deg), .unit = "deg",
     .min = 0.001, .max = 360, .doc = "angle that the beams share; each looks along its middle"},
    {"shape", ASDIC_KEY_WORD, AT(file_fan, shape), .words = fan_shape_words, .fallback = "plane",
     .doc = "plane: an array is aimed, and its beams lie in one plane; cone: every beam by itself, "
            "at one pitch"},
    APERTURE(file_fan),
};
static const asdic_table fan_table = {TABLE(fan_keys, file_fan), .doc = "evenly spread beams"};
static const asdic_key fan_map_keys[] = {
    {"fan", ASDIC_KEY_MAP, ASDIC_KEY_REQUIRED, AT(file_fan_map, fan), .table = &fan_table,
     .doc = "evenly spread beams"},
};
static const asdic_table fan_map_table = {TABLE(fan_map_keys, file_fan_map),
                                          .doc = "receivers as a fan"};

static const asdic_key element_keys[] = {
    LENGTH_OR(file_element, length_h_m, NULL, "side along the line; else the spacing"),
    LENGTH(file_element, length_v_m, "side across it"),
};
static const asdic_table element_table = {TABLE(element_keys, file_element),
                                          .doc = "the aperture of an element"};
static const asdic_key array_beams_keys[] = {
    {"count", ASDIC_KEY_INTEGER, ASDIC_KEY_REQUIRED, AT(file_array_beams, count), .min = 1,
     .max = ASDIC_SONAR_MAX_RECEIVERS,
     .doc = "number of beams, named 000, 001, ... from port to starboard"},
    {"sector_deg", ASDIC_KEY_NUMBER, ASDIC_KEY_REQUIRED, AT(file_array_beams, sector_deg),
     .unit = "deg", .min = 0.001, .max = 180,
     .doc = "angle that the beams share; each looks along its middle"},
};
static const asdic_table array_beams_table = {TABLE(array_beams_keys, file_array_beams),
                                              .doc = "evenly spread beams"};
static const asdic_word shading_words[] = {{"none", ASDIC_SHADING_NONE},
                                           {"hann", ASDIC_SHADING_HANN},
                                           {"taylor", ASDIC_SHADING_TAYLOR},
                                           {"chebyshev", ASDIC_SHADING_CHEBYSHEV},
                                           {NULL, 0}};
static const asdic_key array_keys[] = {
    {"elements", ASDIC_KEY_INTEGER, ASDIC_KEY_REQUIRED, AT(file_array, elements), .min = 2,
     .max = ASDIC_ARRAY_MAX_ELEMENTS, .doc = "number of elements, from port to starboard"},
    {"spacing_wl", ASDIC_KEY_NUMBER, AT(file_array, spacing_wl), .unit = "wavelengths", .min = 0.01,
     .max = 10, .fallback = "0.5",
     .doc = "from one element to the next, in the water at the surface, so that the array has one "
            "size wherever it is. More than a half makes grating lobes"},
    {"shading", ASDIC_KEY_WORD, AT(file_array, shading), .words = shading_words, .fallback = "none",
     .doc = "how the elements are weighed"},
    {"side_lobe_db", ASDIC_KEY_NUMBER, AT(file_array, side_lobe_db), .unit = "dB", .min = -100,
     .max = -10, .doc = "side lobes of taylor (the first) and chebyshev (all); else -30"},
    {"element", ASDIC_KEY_MAP, AT(file_array, element), .table = &element_table,
     .doc = "the aperture of an element"},
    {"beams", ASDIC_KEY_MAP, ASDIC_KEY_REQUIRED, AT(file_array, beams), .table = &array_beams_table,
     .doc = "evenly spread beams"},
    ANGLE(file_array, pitch_deg, -180, 180, "aim below the bow's level; positive looks down"),
    ANGLE(file_array, yaw_deg, -180, 180, "aim to starboard of the bow"),
    ANGLE(file_array, roll_deg, -180, 180, "turn about the array's own axis"),
};
static const asdic_table array_table = {TABLE(array_keys, file_array),
                                        .doc = "elements on a line, for coherent pings"};

static const asdic_key scan_keys[] = {
    {"sector_deg", ASDIC_KEY_NUMBER, AT(file_sweep, sector_deg), .unit = "deg", .min = 0.01,
     .max = 360, .fallback = "360",
     .doc = "sector round the bow: 360 is gone round and round, less back and forth"},
    {"step_deg", ASDIC_KEY_NUMBER, ASDIC_KEY_REQUIRED, AT(file_sweep, step_deg), .unit = "deg",
     .min = 0.01, .max = 180, .doc = "turn from ping to ping; divides the sector"},
};
static const asdic_table scan_table = {TABLE(scan_keys, file_sweep),
                                       .doc = "a head that turns from ping to ping"};

/* No level at all. */
static const asdic_word none_words[] = {{"none", -INFINITY}, {NULL, 0}};

static const asdic_key noise_keys[] = {
    {"enabled", ASDIC_KEY_BOOL, AT(file_noise, enabled), .fallback = "true",
     .doc = "whether noise is added"},
    {"directivity", ASDIC_KEY_BOOL, AT(file_noise, directivity), .fallback = "true",
     .doc = "whether the receiver's directivity index is taken off ambient noise"},
    {"self_db", ASDIC_KEY_NUMBER, AT(file_noise, self_db), .unit = "dB re 1 uPa^2/Hz", .min = -100,
     .max = 300, .words = none_words, .fallback = "none",
     .doc = "spectrum level of the sonar's own noise at a receiver, of an array at each element"},
};
static const asdic_table noise_table = {TABLE(noise_keys, file_noise),
                                        .doc = "ambient noise, and the sonar's own"};

static const asdic_word speckle_words[] = {{"none", ASDIC_SPECKLE_NONE},
                                           {"rayleigh", ASDIC_SPECKLE_RAYLEIGH},
                                           {"k", ASDIC_SPECKLE_K},
                                           {NULL, 0}};

#define SONAR(member) AT(file_sonar, member)
static const asdic_key sonar_keys[] = {
    {"file", ASDIC_KEY_PATH, SONAR(file), .file = ASDIC_FILE_SONAR,
     .doc = "a file that holds keys of the sonar; those beside it come first, in maps key by key"},
    {"frequency_khz", ASDIC_KEY_NUMBER, ASDIC_KEY_REQUIRED, SONAR(frequency_khz), .unit = "kHz",
     .min = 0.1, .max = ASDIC_MOST_KHZ, .unless = "file", .doc = "centre frequency"},
    {"bandwidth_khz", ASDIC_KEY_NUMBER, SONAR(bandwidth_khz), .unit = "kHz", .min = 0.001,
     .max = 1000, .fallback = "10", .doc = "bandwidth; the range resolution is c / (2 bandwidth)"},
    {"ping_rate_hz", ASDIC_KEY_NUMBER, SONAR(ping_rate_hz), .unit = "Hz", .min = 0.01, .max = 1000,
     .fallback = "10", .doc = "pings a second; no echo from beyond c / (2 ping rate) is received"},
    {"max_range_m", ASDIC_KEY_NUMBER, SONAR(max_range_m), .unit = "m", .min = 0.01, .max = 100000,
     .doc = "where the bins end, at most c / (2 ping rate); else there"},
    {"source_level_db", ASDIC_KEY_NUMBER, SONAR(source_level_db), .unit = "dB re 1 uPa at 1 m",
     .min = -300, .max = 300, .fallback = "0", .doc = "source level after pulse compression"},
    {"bin_length_m", ASDIC_KEY_NUMBER, SONAR(bin_length_m), .unit = "m", .min = 0.001, .max = 1000,
     .fallback = "0.5", .doc = "length of a range bin"},
    {"blanking_m", ASDIC_KEY_NUMBER, SONAR(blanking_m), .unit = "m", .min = 0.01, .max = 10000,
     .fallback = "0.5", .doc = "no echo is heard before it"},
    {"transmitter", ASDIC_KEY_MAP, SONAR(transmitter), .table = &transmitter_table,
     .doc = "the transmitting aperture"},
    {"receivers", ASDIC_KEY_LIST, ASDIC_KEY_REQUIRED | ASDIC_KEY_AT_MOST_ONE, SONAR(receivers),
     .least = 1, .count = ASDIC_SONAR_MAX_RECEIVERS, .unless = "file", .instead = "array",
     .table = &beam_table, .map_form = &fan_map_table,
     .map_offset = offsetof(file_sonar, receiver_fan),
     .doc = "the receiving apertures: a list, or fan: {count, sector_deg, ...}"},
    {"array", ASDIC_KEY_MAP, ASDIC_KEY_OPTIONAL | ASDIC_KEY_AT_MOST_ONE, SONAR(array),
     .table = &array_table,
     .doc = "receiving elements on a line, and the beams that are formed of them"},
    {"scan", ASDIC_KEY_MAP, SONAR(scan), .table = &scan_table,
     .doc = "transmitter and receivers turn together from ping to ping, one direction each"},
    {"noise", ASDIC_KEY_MAP, SONAR(noise), .table = &noise_table,
     .doc = "ambient noise, and the sonar's own"},
    {"speckle", ASDIC_KEY_WORD, SONAR(speckle), .words = speckle_words, .fallback = "none",
     .doc = "random interference of the echoes in a resolution cell, shared by beams that overlap"},
    {"speckle_shape", ASDIC_KEY_NUMBER, SONAR(speckle_shape), .min = ASDIC_SHAPE_LEAST,
     .max = ASDIC_SHAPE_MOST, .doc = "shape of K-distributed speckle; large is Rayleigh"},
    {"rear_floor_db", ASDIC_KEY_NUMBER, SONAR(rear_floor_db), .unit = "dB", .min = -200, .max = 0,
     .words = none_words, .fallback = "none",
     .doc = "what leaks in and out behind the apertures, re the same angle in front"},
};
const asdic_table asdic_sonar_table = {TABLE(sonar_keys, file_sonar), .doc = "the sonar"};

/* --- mission ---------------------------------------------------------------------------------- */

static const asdic_key pose_keys[] = {
    {"position_m", ASDIC_KEY_NUMBERS, ASDIC_KEY_REQUIRED, AT(file_pose, position_m), .unit = "m",
     .min = -1e7, .max = 1e7, .count = 3, .doc = "north, east, down from the sea surface"},
    ANGLE(file_pose, roll_deg, -360, 360, "roll, positive to starboard"),
    ANGLE(file_pose, pitch_deg, -360, 360, "pitch, positive raises the bow"),
    ANGLE(file_pose, yaw_deg, -360, 360, "heading, clockwise from north"),
};
static const asdic_table pose_table = {TABLE(pose_keys, file_pose), .doc = "a vehicle at rest"};

static const asdic_word vehicle_words[] = {
    {"nomoto", ASDIC_VEHICLE_NOMOTO}, {"remus100", ASDIC_VEHICLE_REMUS100}, {NULL, 0}};

#define WAYPOINTS(member) AT(file_waypoints, member)
static const asdic_key waypoints_keys[] = {
    {"points_m", ASDIC_KEY_POINTS, ASDIC_KEY_REQUIRED, WAYPOINTS(points), .unit = "m", .min = -1e7,
     .max = 1e7, .least = 2, .count = 10000,
     .doc = "north, east, down of each point; the vehicle starts in the first"},
    {"vehicle", ASDIC_KEY_WORD, WAYPOINTS(vehicle), .words = vehicle_words, .fallback = "nomoto",
     .doc = "how it answers: by turn_radius_m and response_s (nomoto), or by the published "
            "coefficients of the REMUS 100"},
    {"speed_mps", ASDIC_KEY_NUMBER, WAYPOINTS(speed_mps), .unit = "m/s", .min = 0.05, .max = 20,
     .fallback = "1.5", .doc = "speed through the water"},
    {"turn_radius_m", ASDIC_KEY_NUMBER, WAYPOINTS(turn_radius_m), .unit = "m", .min = 0.1,
     .max = 10000, .fallback = "5",
     .doc = "radius of turns; those that take no longer than response_s are wider"},
    {"response_s", ASDIC_KEY_NUMBER, WAYPOINTS(response_s), .unit = "s", .min = 0.1, .max = 60,
     .fallback = "1", .doc = "time constant with which the vehicle answers rudder and elevator"},
    {"dive_rate_mps", ASDIC_KEY_NUMBER, WAYPOINTS(dive_rate_mps), .unit = "m/s", .min = 0.001,
     .max = 10, .fallback = "0.3", .doc = "fastest change of depth"},
    {"current_mps", ASDIC_KEY_NUMBERS, WAYPOINTS(current_mps), .unit = "m/s", .min = -10, .max = 10,
     .count = 2, .fallback = "[0, 0]",
     .doc =
         "velocity of the water towards north and east, the same everywhere; across a line between "
         "points, or against it, less than speed_mps"},
    {"altitude_m", ASDIC_KEY_NUMBER, WAYPOINTS(altitude_m), .unit = "m", .min = 0.1, .max = 1000,
     .doc = "height above the bottom straight below to be held, instead of the points' depths, "
            "which are flown where there is no bottom"},
};
static const asdic_table waypoints_table = {TABLE(waypoints_keys, file_waypoints),
                                            .doc = "points and how the vehicle manoeuvres",
                                            .list_key = "points_m"};

#define MISSION(member) AT(file_mission, member)
static const asdic_key mission_keys[] = {
    {"pose", ASDIC_KEY_MAP, ASDIC_KEY_ONE_OF | ASDIC_KEY_OPTIONAL, MISSION(pose),
     .table = &pose_table, .doc = "a vehicle at rest"},
    {"track", ASDIC_KEY_PATH, ASDIC_KEY_ONE_OF, MISSION(track), .file = ASDIC_FILE_VEHICLE_TRACK,
     .doc = "CSV file of time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg, relative to the scene"},
    {"waypoints", ASDIC_KEY_MAP, ASDIC_KEY_ONE_OF | ASDIC_KEY_OPTIONAL, MISSION(waypoints),
     .table = &waypoints_table,
     .doc = "points that the vehicle steers along: a list, or a map with its manoeuvring"},
    {"pings", ASDIC_KEY_INTEGER, MISSION(pings), .min = 1, .max = 1e9,
     .doc = "number of pings; else one, or one turn of a scan, or as many as track or waypoints "
            "cover"},
};
const asdic_table asdic_mission_table = {TABLE(mission_keys, file_mission),
                                         .doc = "where the vehicle is, ping by ping"};
