/*
 * run.nc, read back by netCDF's own functions: every number that it says of sonar, water and pings,
 * of a fixed sonar and of a scanned one, and pings in several chunks.
 */
#include "asserts.h"

#include "base/vec.h"
#include "out/format.h"
#include "out/netcdf_file.h"

#include <asdic/asdic.h>

#include <errno.h>
#include <math.h>
#include <netcdf.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define DEGREE (180.0 / ASDIC_PI)

enum { BEAMS = 2, BINS = 3, PINGS = 5, CELLS = BEAMS * BINS };

static asdic_context *ctx;
static char folder[] = "/tmp/asdic-netcdf-XXXXXX";
static char name[64];

static const asdic_beam receivers[BEAMS] = {
    {.name = "port", .pitch_rad = 0.5, .yaw_rad = -0.25, .length_h_m = 0.1, .length_v_m = 0.05},
    {.name = "down", .pitch_rad = 1.0, .yaw_rad = 0.3, .length_h_m = 0.2, .length_v_m = 0.001}};
static asdic_sonar sonar;
static asdic_environment environment;

static int set_up(void **state) {
    (void)state;
    if (asdic_context_create(&ctx) != ASDIC_OK || !mkdtemp(folder)) {
        return -1;
    }
    snprintf(name, sizeof name, "%s/run.nc", folder);
    sonar = asdic_sonar_default();
    sonar.frequency_hz = 100e3;
    sonar.bandwidth_hz = 20e3;
    sonar.source_level_db = 210.0;
    sonar.bin_length_m = 0.75;
    sonar.blanking_m = 3.0;
    sonar.transmitter.length_h_m = 0.02;
    sonar.transmitter.length_v_m = 0.04;
    sonar.receivers = receivers;
    sonar.receiver_count = BEAMS;
    environment = asdic_environment_default();
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    asdic_context_destroy(&ctx);
    return rmdir(folder); /* fails when a test or the library left something behind */
}

static asdic_format_about about_of(size_t pings, size_t bins) {
    return (asdic_format_about){.sonar = &sonar,
                                .sound_speed_mps = 1500.0,
                                .absorption_db_per_km = 32.0,
                                .environment = &environment,
                                .pings = pings,
                                .bins = bins,
                                .scene_name = "pool",
                                .scene_hash = "0123abcd",
                                .version = "1.2.3",
                                .seed = 77};
}

/* --- pings ------------------------------------------------------------------------------------ */

static float level_db(size_t ping, size_t array, size_t cell) {
    return cell == 4 ? NAN : (float)(100 * ping + 10 * array + cell);
}

static float truth_value(size_t ping, size_t field, size_t cell) {
    return (float)(100 * ping + 10 * field + cell);
}

static double tilt; /* 0: the vehicle is level */

static asdic_pose pose_of(size_t ping) {
    double p = (double)ping;
    return (asdic_pose){.position_m = {1.0 + p, 2.0 - p, 3.0 + 0.5 * p},
                        .roll_rad = -0.03 * p * tilt,
                        .pitch_rad = 0.02 * p * tilt,
                        .yaw_rad = 0.1 * p};
}

static asdic_status try_ping(void *file, size_t ping, bool truth) {
    float levels[ASDIC_RECORD_ARRAYS][CELLS], shares[ASDIC_TRUTH_FIELDS][CELLS];
    int16_t numbers[2][CELLS];
    asdic_record record = {.ping = 1000 + ping,
                           .time_s = 0.25 * (double)ping,
                           .pose = pose_of(ping),
                           .altitude_m = ping == 2 ? INFINITY : 8.0 + (double)ping,
                           .stderr_db = levels[ASDIC_COMPONENT_COUNT]};
    for (size_t i = 0; i < CELLS; i++) {
        for (size_t a = 0; a < ASDIC_RECORD_ARRAYS; a++) {
            levels[a][i] = level_db(ping, a, i);
        }
        for (size_t k = 0; k < ASDIC_TRUTH_FIELDS; k++) {
            shares[k][i] = truth_value(ping, k, i);
        }
        numbers[0][i] = (int16_t)shares[0][i];
        numbers[1][i] = (int16_t)shares[1][i];
    }
    for (size_t a = 0; a < ASDIC_COMPONENT_COUNT; a++) {
        record.level_db[a] = levels[a];
    }
    if (truth) {
        record.truth =
            (asdic_ping_truth){.strongest = numbers[0],
                               .object = numbers[1],
                               .share = shares[2],
                               .object_share = shares[3],
                               .path = {shares[4], shares[5], shares[6], shares[7], shares[8]},
                               .depression_rad = shares[9]};
    }
    return asdic_format_netcdf.write(file, &record);
}

static void write_ping(void *file, size_t ping, bool truth) {
    assert_ok(ctx, try_ping(file, ping, truth));
}

/* Writes a file and opens it. */
static int make(const asdic_format_about *about) {
    void *file;
    int id;
    assert_ok(ctx, asdic_format_netcdf.open(ctx, name, about, &file));
    for (size_t i = 0; i < about->pings; i++) {
        write_ping(file, i, about->truth);
    }
    assert_int_not_equal(access(name, F_OK), 0);
    assert_ok(ctx, asdic_format_netcdf.commit(&file));
    assert_null(file);
    assert_int_equal(nc_open(name, NC_NOWRITE, &id), NC_NOERR);
    return id;
}

static void drop(int id) {
    assert_int_equal(nc_close(id), NC_NOERR);
    assert_int_equal(unlink(name), 0);
}

/* --- what is read ----------------------------------------------------------------------------- */

static int group(int parent, const char *path) {
    int id;
    assert_int_equal(nc_inq_grp_full_ncid(parent, path, &id), NC_NOERR);
    return id;
}

/* The values of a variable in UNITS along DIMENSIONS ("" of a single number), COUNT of them. */
static void read_values(int id, const char *variable, const char *dimensions, const char *units,
                        double *out, size_t count) {
    int number, rank, ids[4];
    char found[256] = "", text[NC_MAX_NAME + 1] = "";
    size_t length, all = 1;
    if (nc_inq_varid(id, variable, &number) != NC_NOERR) {
        print_error("no variable '%s'\n", variable);
        fail();
    }
    assert_int_equal(nc_inq_var(id, number, NULL, NULL, &rank, ids, NULL), NC_NOERR);
    for (int i = 0; i < rank; i++) {
        assert_int_equal(nc_inq_dim(id, ids[i], text, &length), NC_NOERR);
        strcat(strcat(found, i ? " " : ""), text);
        all *= length;
    }
    assert_string_equal(found, dimensions);
    assert_int_equal(all, count);
    memset(text, 0, sizeof text);
    assert_int_equal(nc_get_att_text(id, number, "units", text), NC_NOERR);
    assert_string_equal(text, units);
    assert_int_equal(nc_get_var_double(id, number, out), NC_NOERR);
}

static void check_number(int id, const char *variable, const char *units, double expected) {
    double value;
    read_values(id, variable, "", units, &value, 1);
    assert_close_relative(value, expected, 1e-14);
}

static void check_text(int id, const char *attribute, const char *expected) {
    char text[1024] = "";
    assert_int_equal(nc_get_att_text(id, NC_GLOBAL, attribute, text), NC_NOERR);
    assert_string_equal(text, expected);
}

/* Of all pings, COLUMNS numbers each, as VALUE has them. */
static void check_pings(int id, const char *variable, const char *dimensions, const char *units,
                        size_t columns, double (*value)(size_t ping, size_t column)) {
    double found[PINGS * CELLS];
    read_values(id, variable, dimensions, units, found, PINGS * columns);
    for (size_t i = 0; i < PINGS * columns; i++) {
        double expected = value(i / columns, i % columns);
        assert_true(isnan(expected) ? isnan(found[i]) : fabs(found[i] - expected) < 1e-12);
    }
}

/* --- a fixed sonar ---------------------------------------------------------------------------- */

enum { NUMBER, TIME, NORTH, EAST, DEPTH, HEADING, PITCH, ROLL, ALTITUDE };
static size_t field; /* of these, of levels or of truth */

static double series_at(size_t ping, size_t column) {
    (void)column;
    const double p = (double)ping;
    const double values[] = {[NUMBER] = 1000.0 + p,
                             [TIME] = 0.25 * p,
                             [NORTH] = 1.0 + p,
                             [EAST] = 2.0 - p,
                             [DEPTH] = 3.0 + 0.5 * p,
                             [HEADING] = 0.1 * p * DEGREE,
                             [PITCH] = 0.02 * p * DEGREE,
                             [ROLL] = -0.03 * p * DEGREE,
                             [ALTITUDE] = ping == 2 ? NAN : 8.0 + p}; /* no bottom: none */
    return values[field];
}

static void check_series(int id, const char *variable, const char *dimension, const char *units,
                         size_t what) {
    field = what;
    check_pings(id, variable, dimension, units, 1, series_at);
}

static double level_at(size_t ping, size_t column) {
    return (double)level_db(ping, field, column);
}

static double truth_at(size_t ping, size_t column) {
    return (double)truth_value(ping, field, column);
}

static void check_levels(int id, const char *variable, const char *dimensions) {
    int number, shuffle, deflate, level, chunked;
    size_t chunks[3];
    check_pings(id, variable, dimensions, "dB", CELLS, level_at);
    assert_int_equal(nc_inq_varid(id, variable, &number), NC_NOERR);
    assert_int_equal(nc_inq_var_deflate(id, number, &shuffle, &deflate, &level), NC_NOERR);
    assert_true(shuffle == 1 && deflate == 1 && level == 1);
    assert_int_equal(nc_inq_var_chunking(id, number, &chunked, chunks), NC_NOERR);
    assert_true(chunked == NC_CHUNKED && chunks[0] == PINGS && chunks[1] == BEAMS &&
                chunks[2] == BINS);
    float fill = 0.0f;
    int none = 1;
    assert_int_equal(nc_inq_var_fill(id, number, &none, &fill), NC_NOERR);
    assert_true(!none && isnan(fill));
}

static void check_beam_names(int id) {
    int number, own, dimension;
    char *names[BINS];
    assert_int_equal(nc_inq_varid(id, "beam", &number), NC_NOERR);
    assert_int_equal(nc_inq_dimid(id, "beam", &own), NC_NOERR);
    assert_int_equal(nc_inq_vardimid(id, number, &dimension), NC_NOERR);
    assert_int_equal(dimension, own);
    assert_int_equal(nc_get_var_string(id, number, names), NC_NOERR);
    assert_string_equal(names[0], "port");
    assert_string_equal(names[1], "down");
    nc_free_string(BEAMS, names);
}

static void check_ranges(int id, const char *dimension) {
    double range_m[BINS];
    read_values(id, "range", dimension, "m", range_m, BINS);
    for (size_t i = 0; i < BINS; i++) {
        assert_close(range_m[i], 0.375 + 0.75 * (double)i, 1e-15);
    }
}

static void levels_lie_by_ping_beam_and_range(void **state) {
    (void)state;
    static const char *const names[ASDIC_RECORD_ARRAYS] = {
        "backscatter_r", "bottom_db",    "surface_db", "volume_db",
        "object_db",     "multipath_db", "noise_db",   "stderr_db"};
    asdic_format_about about = about_of(PINGS, BINS);
    int root = make(&about), beams = group(root, "/Sonar/Beam_group1"), number;
    for (field = 0; field < ASDIC_RECORD_ARRAYS; field++) {
        check_levels(beams, names[field], "ping_time beam range_sample");
    }
    field = 0;
    check_levels(root, "level", "ping_time beam range");
    check_series(root, "ping_time", "ping_time", "s", TIME);
    char clock[NC_MAX_NAME + 1] = "";
    assert_int_equal(nc_inq_varid(root, "ping_time", &number), NC_NOERR);
    assert_int_equal(nc_get_att_text(root, number, "long_name", clock), NC_NOERR);
    assert_non_null(strstr(clock, "or as in its track"));
    check_series(beams, "ping_time", "ping_time", "s", TIME);
    check_series(beams, "ping", "ping_time", "1", NUMBER);
    check_ranges(root, "range");
    check_ranges(beams, "range_sample");
    check_beam_names(root);
    check_beam_names(beams);
    assert_int_not_equal(nc_inq_varid(beams, "share", &number), NC_NOERR);
    assert_int_not_equal(nc_inq_varid(beams, "head_angle", &number), NC_NOERR);
    drop(root);
}

static void the_vehicle_is_where_it_was(void **state) {
    (void)state;
    asdic_format_about about = about_of(PINGS, BINS);
    tilt = 1.0;
    int root = make(&about), platform = group(root, "/Platform"), number;
    const struct {
        const char *name, *units, *standard_name;
        size_t what;
    } rows[] = {{"time", "s", NULL, TIME},
                {"heading", "degree", "platform_orientation", HEADING},
                {"pitch", "degree", "platform_pitch_angle", PITCH},
                {"roll", "degree", "platform_roll_angle", ROLL},
                {"north", "m", NULL, NORTH},
                {"east", "m", NULL, EAST},
                {"depth", "m", "depth", DEPTH},
                {"altitude", "m", "height_above_sea_floor", ALTITUDE}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char text[64] = "";
        check_series(platform, rows[i].name, "time", rows[i].units, rows[i].what);
        assert_int_equal(nc_inq_varid(platform, rows[i].name, &number), NC_NOERR);
        int code = nc_get_att_text(platform, number, "standard_name", text);
        assert_int_equal(code == NC_NOERR, rows[i].standard_name != NULL);
        assert_string_equal(text, rows[i].standard_name ? rows[i].standard_name : "");
    }
    tilt = 0.0;
    drop(root);
}

/* Half power at the edge of a line's pattern sinc^2, one way; all around where none has it. */
static void check_width(double width_deg, double length_m) {
    double x = ASDIC_PI * length_m * sin(0.5 * width_deg / DEGREE) / 0.015;
    assert_close(length_m < 0.01 ? width_deg / 360.0 : sin(x) * sin(x) / (x * x), 0.5, 1e-4);
}

static void the_sonar_is_told(void **state) {
    (void)state;
    asdic_format_about about = about_of(1, BINS);
    int root = make(&about), id = group(root, "/Sonar/Beam_group1");
    check_number(id, "transmit_frequency_start", "Hz", 90e3);
    check_number(id, "transmit_frequency_stop", "Hz", 110e3);
    check_number(id, "transmit_bandwidth", "Hz", 20e3);
    check_number(id, "transmit_source_level", "dB", 210.0);
    check_number(id, "sample_interval", "s", 1e-3);
    check_number(id, "blanking_interval", "s", 4e-3);
    const double axes[3][BEAMS] = {{cos(0.5) * cos(0.25), cos(1.0) * cos(0.3)},
                                   {-cos(0.5) * sin(0.25), cos(1.0) * sin(0.3)},
                                   {sin(0.5), sin(1.0)}};
    const struct {
        const char *name;
        double length_m[BEAMS];
    } widths[] = {{"beamwidth_receive_major", {0.1, 0.2}},
                  {"beamwidth_receive_minor", {0.05, 0.001}},
                  {"beamwidth_transmit_major", {0.02, 0.02}},
                  {"beamwidth_transmit_minor", {0.04, 0.04}}};
    double found[BEAMS];
    for (int k = 0; k < 3; k++) {
        char axis[] = "beam_direction_x";
        axis[15] = (char)('x' + k);
        read_values(id, axis, "beam", "1", found, BEAMS);
        assert_close(found[0], axes[k][0], 1e-15);
        assert_close(found[1], axes[k][1], 1e-15);
    }
    for (size_t i = 0; i < sizeof widths / sizeof *widths; i++) {
        read_values(id, widths[i].name, "beam", "degree", found, BEAMS);
        check_width(found[0], widths[i].length_m[0]);
        check_width(found[1], widths[i].length_m[1]);
    }
    check_text(id, "beam_mode", "horizontal");
    id = group(root, "/Sonar");
    check_text(id, "sonar_model", "pool");
    check_text(id, "sonar_software_version", "1.2.3");
    id = group(root, "/Provenance");
    check_text(id, "conversion_software_version", "1.2.3");
    check_text(id, "scene_sha256", "0123abcd");
    check_text(id, "seed", "77");
    check_text(root, "title", "pool");
    check_text(root, "Conventions", "CF-1.9");
    drop(root);
}

static void the_water_is_told_as_far_as_it_bends_rays(void **state) {
    (void)state;
    static const char *const names[3] = {"sound_speed_gradient", "sound_speed_profile_depth",
                                         "sound_speed_profile"};
    for (int i = 0; i < 3; i++) { /* straight; by a gradient; by a profile */
        asdic_format_about about = about_of(1, BINS);
        environment.sound_speed_gradient_per_s = i == 1 ? -0.5 : 0.0;
        if (i == 2) {
            environment.sound_speed_profile = (asdic_sound_profile){
                .points = 3, .depth_m = {0, 10, 25}, .sound_speed_mps = {1500, 1480, 1490}};
        }
        int root = make(&about), id = group(root, "/Environment"), number;
        double found[3];
        read_values(id, "frequency", "frequency", "Hz", found, 1);
        assert_close(found[0], 100e3, 0.0);
        read_values(id, "absorption_indicative", "frequency", "dB/m", found, 1);
        assert_close(found[0], 0.032, 1e-15);
        check_number(id, "sound_speed_indicative", "m/s", 1500.0);
        for (int k = 0; k < 3; k++) {
            assert_int_equal(nc_inq_varid(id, names[k], &number) == NC_NOERR, i == 1   ? k == 0
                                                                              : i == 2 ? k > 0
                                                                                       : 0);
        }
        if (i == 1) {
            check_number(id, "sound_speed_gradient", "1/s", -0.5);
        } else if (i == 2) {
            read_values(id, "sound_speed_profile_depth", "profile", "m", found, 3);
            assert_true(found[0] == 0.0 && found[1] == 10.0 && found[2] == 25.0);
            read_values(id, "sound_speed_profile", "profile", "m/s", found, 3);
            assert_true(found[0] == 1500.0 && found[1] == 1480.0 && found[2] == 1490.0);
        }
        drop(root);
    }
    environment = asdic_environment_default();
}

static void truth_lies_beside_levels(void **state) {
    (void)state;
    static const char *const names[] = {"strongest", "object",        "share",     "object_share",
                                        "direct",    "by_surface",    "by_bottom", "by_object",
                                        "noise",     "depression_rad"};
    asdic_format_about about = about_of(PINGS, BINS);
    about.truth = true;
    int root = make(&about), id = group(root, "/Sonar/Beam_group1"), number, chunked;
    for (field = 0; field < ASDIC_TRUTH_FIELDS; field++) {
        nc_type type;
        size_t chunks[3];
        int shuffle, deflate, level;
        check_pings(id, names[field], "ping_time beam range_sample", field == 9 ? "rad" : "1",
                    CELLS, truth_at);
        assert_int_equal(nc_inq_varid(id, names[field], &number), NC_NOERR);
        assert_int_equal(nc_inq_vartype(id, number, &type), NC_NOERR);
        assert_int_equal(type, field < 2 ? NC_SHORT : NC_FLOAT);
        assert_int_equal(nc_inq_var_chunking(id, number, &chunked, chunks), NC_NOERR);
        assert_true(chunked == NC_CHUNKED && chunks[0] == 1 && chunks[1] == BEAMS &&
                    chunks[2] == BINS);
        assert_int_equal(nc_inq_var_deflate(id, number, &shuffle, &deflate, &level), NC_NOERR);
        assert_true(shuffle == 1 && deflate == 1 && level == 1);
    }
    drop(root);
}

/* --- a scanned one ---------------------------------------------------------------------------- */

static const asdic_sweep sweep = {.directions = 3, .step_rad = 0.2};

/* There and back; the mission's ping 1000 is the first of its four. */
static double head_rad(size_t ping) {
    static const double heads[4] = {-0.2, 0.0, 0.2, 0.0};
    return heads[ping % 4];
}

enum { HEAD, VEHICLE, FORWARD, STARBOARD, DOWN };

static double scanned_at(size_t ping, size_t beam) {
    const asdic_beam *b = &receivers[beam];
    double yaw_rad = b->yaw_rad + head_rad(ping);
    const double values[] = {[HEAD] = head_rad(ping) * DEGREE,
                             [VEHICLE] = (0.1 * (double)ping - head_rad(ping)) * DEGREE,
                             [FORWARD] = cos(b->pitch_rad) * cos(yaw_rad),
                             [STARBOARD] = cos(b->pitch_rad) * sin(yaw_rad),
                             [DOWN] = sin(b->pitch_rad)};
    return values[field];
}

static void a_head_turns_its_beams(void **state) {
    (void)state;
    asdic_format_about about = about_of(PINGS, BINS);
    about.sweep = sweep;
    int root = make(&about), id = group(root, "/Sonar/Beam_group1");
    field = HEAD;
    check_pings(id, "head_angle", "ping_time", "degree", 1, scanned_at);
    field = VEHICLE;
    check_pings(group(root, "/Platform"), "heading", "time", "degree", 1, scanned_at);
    for (field = FORWARD; field <= DOWN; field++) {
        char axis[] = "beam_direction_x";
        axis[15] = (char)('x' + field - FORWARD);
        check_pings(id, axis, "ping_time beam", "1", BEAMS, scanned_at);
    }
    drop(root);
}

/* --- large files ------------------------------------------------------------------------------ */

/* A chunk has 2^18 levels at most, and a ping at least: here two of three, then one of two. */
static void pings_lie_in_several_chunks(void **state) {
    (void)state;
    for (size_t most = 2; most > 0; most--) {
        size_t bins = most == 2 ? 65535 : 131073, cells = BEAMS * bins, place[3] = {0, 1, bins - 1};
        asdic_format_about about = about_of(most + 1, bins);
        float *levels = calloc(cells, sizeof *levels), found;
        asdic_record record = {.stderr_db = levels};
        void *file;
        int root, id, number;
        size_t chunks[3];
        for (size_t a = 0; a < ASDIC_COMPONENT_COUNT; a++) {
            record.level_db[a] = levels;
        }
        assert_ok(ctx, asdic_format_netcdf.open(ctx, name, &about, &file));
        for (size_t i = 0; i < about.pings; i++) {
            levels[cells - 1] = (float)i + 7.0f;
            assert_ok(ctx, asdic_format_netcdf.write(file, &record));
        }
        assert_ok(ctx, asdic_format_netcdf.commit(&file));
        assert_int_equal(nc_open(name, NC_NOWRITE, &root), NC_NOERR);
        id = group(root, "/Sonar/Beam_group1");
        assert_int_equal(nc_inq_varid(id, "noise_db", &number), NC_NOERR);
        assert_int_equal(nc_inq_var_chunking(id, number, NULL, chunks), NC_NOERR);
        assert_true(chunks[0] == most && chunks[1] == BEAMS && chunks[2] == bins);
        for (place[0] = 0; place[0] < about.pings; place[0]++) {
            assert_int_equal(nc_get_var1_float(id, number, place, &found), NC_NOERR);
            assert_close(found, (double)place[0] + 7.0, 0.0);
        }
        free(levels);
        drop(root);
    }
}

static void what_is_discarded_leaves_nothing(void **state) {
    (void)state;
    asdic_format_about about = about_of(PINGS, BINS);
    void *file;
    assert_ok(ctx, asdic_format_netcdf.open(ctx, name, &about, &file));
    write_ping(file, 0, false);
    asdic_format_netcdf.discard(&file);
    assert_null(file);
    asdic_format_netcdf.discard(&file);
    assert_int_not_equal(access(name, F_OK), 0);
}

/* Of a file that may have LIMIT bytes: what came of it. */
static asdic_status make_within(rlim_t limit) {
    asdic_format_about about = about_of(PINGS, BINS);
    struct rlimit before, now;
    void *file = NULL;
    about.truth = true;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    now = (struct rlimit){limit, before.rlim_max};
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &now), 0);
    asdic_status status = asdic_format_netcdf.open(ctx, name, &about, &file);
    for (size_t i = 0; !status && i < PINGS; i++) {
        status = try_ping(file, i, true);
    }
    if (status) {
        asdic_format_netcdf.discard(&file);
    } else {
        status = asdic_format_netcdf.commit(&file);
    }
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
    return status;
}

/* Wherever room ends, the caller lives to be told, and nothing is left. */
static void room_may_end_anywhere(void **state) {
    (void)state;
    struct stat whole;
    char part[80];
    snprintf(part, sizeof part, "%s.part", name);
    assert_ok(ctx, make_within(RLIM_INFINITY));
    assert_int_equal(stat(name, &whole), 0);
    assert_int_equal(unlink(name), 0);
    for (off_t limit = 0; limit < whole.st_size; limit += whole.st_size / 40 + 1) {
        assert_int_equal(make_within((rlim_t)limit), ASDIC_ERROR_IO);
        assert_contains(asdic_context_error(ctx), part);
        assert_int_not_equal(access(part, F_OK), 0);
        assert_int_not_equal(access(name, F_OK), 0);
    }
    assert_ok(ctx, make_within((rlim_t)whole.st_size));
    assert_int_equal(unlink(name), 0);
}

/* The process that writes ends with its caller, also with one that closed the first three files: sockets are 1 and 2
 * then, and the pipe at 0, which nobody else has, comes to its end. */
static void who_writes_ends_with_the_caller(void **state) {
    (void)state;
    int ends[2], how = -1;
    char part[80], byte;
    assert_int_equal(pipe(ends), 0);
    pid_t caller = fork();
    if (caller == 0) {
        asdic_format_about about = about_of(PINGS, BINS);
        void *file = NULL;
        dup2(ends[1], STDIN_FILENO);
        close(ends[0]);
        close(ends[1]);
        close(STDOUT_FILENO);
        close(STDERR_FILENO);
        _exit(asdic_format_netcdf.open(ctx, name, &about, &file));
    }
    close(ends[1]);
    assert_int_equal(waitpid(caller, &how, 0), caller);
    assert_int_equal(how, 0);
    struct pollfd end = {.fd = ends[0], .events = POLLIN};
    assert_int_equal(poll(&end, 1, 10000), 1);
    assert_int_equal(read(ends[0], &byte, 1), 0);
    close(ends[0]);
    snprintf(part, sizeof part, "%s.part", name);
    assert_int_equal(unlink(part), 0);
}

/* The first failure is kept, and nothing after it succeeds. */
static void the_first_failure_is_kept(void **state) {
    (void)state;
    asdic_nc nc = {.failure = NC_NOERR};
    assert_true(asdic_nc_check(&nc, NC_NOERR));
    assert_false(asdic_nc_check(&nc, NC_ENOMEM));
    assert_false(asdic_nc_check(&nc, NC_EHDFERR));
    assert_false(asdic_nc_check(&nc, NC_NOERR));
    assert_int_equal(nc.failure, NC_ENOMEM);
}

static int close_badly(int id) {
    nc_close(id);
    return ENOSPC; /* as netCDF gives the system's errors on */
}

/* A file that cannot be ended leaves nothing beside what was there, and says what is wrong. */
static void what_fails_at_its_end_leaves_nothing(void **state) {
    (void)state;
    char part[80], says[160];
    snprintf(part, sizeof part, "%s.part", name);
    for (int k = 0; k < 5; k++) {
        asdic_nc nc;
        assert_ok(ctx, asdic_nc_create(ctx, name, &nc));
        assert_int_equal(access(part, F_OK), 0);
        const char *why = strerror(ENOSPC);
        if (k == 0) { /* a folder in its place */
            assert_int_equal(mkdir(name, 0700), 0);
            why = strerror(EISDIR);
        } else if (k == 1) {
            nc.call.close = close_badly;
        } else if (k == 2) { /* cannot be brought to the disk */
            assert_int_equal(unlink(part), 0);
            why = strerror(ENOENT);
        } else if (k == 3) {
            asdic_nc_check(&nc, NC_ENOMEM);
            why = nc_strerror(NC_ENOMEM);
        } else {
            asdic_nc_check(&nc, ENOSPC);
        }
        asdic_status status = asdic_nc_commit(&nc);
        assert_int_equal(status, k == 3 ? ASDIC_ERROR_MEMORY : ASDIC_ERROR_IO);
        snprintf(says, sizeof says, "cannot write '%s': %s", part, why);
        assert_string_equal(asdic_context_error(ctx), says);
        assert_int_not_equal(access(part, F_OK), 0);
        assert_int_equal(access(name, F_OK) == 0, k == 0);
        assert_true(k != 0 || rmdir(name) == 0);
    }
}

/* Where no file can be made there is none to go on with. */
static void what_cannot_begin_says_why(void **state) {
    (void)state;
    char part[80], says[160];
    asdic_nc nc;
    snprintf(part, sizeof part, "%s.part", name);
    assert_int_equal(mkdir(part, 0700), 0);
    assert_int_equal(asdic_nc_create(ctx, name, &nc), ASDIC_ERROR_IO);
    snprintf(says, sizeof says, "cannot write '%s': %s", part, strerror(EISDIR));
    assert_string_equal(asdic_context_error(ctx), says);
    assert_int_equal(rmdir(part), 0);
    /* What a run that was killed left is replaced. */
    FILE *left = fopen(part, "w");
    assert_non_null(left);
    assert_int_equal(fclose(left), 0);
    assert_ok(ctx, asdic_nc_create(ctx, name, &nc));
    assert_ok(ctx, asdic_nc_commit(&nc));
    assert_int_not_equal(access(part, F_OK), 0);
    assert_int_equal(unlink(name), 0);
}

/* A backslash is no slash, in a folder's name. */
static void folders_are_called_what_they_are(void **state) {
    (void)state;
    char other[80], path[100], part[108];
    snprintf(other, sizeof other, "%s/a\\b", folder);
    snprintf(path, sizeof path, "%s/run.nc", other);
    snprintf(part, sizeof part, "%s.part", path);
    assert_int_equal(mkdir(other, 0700), 0);
    for (int is_kept = 0; is_kept < 2; is_kept++) {
        asdic_nc nc;
        assert_ok(ctx, asdic_nc_create(ctx, path, &nc));
        assert_int_equal(access(part, F_OK), 0);
        if (is_kept) {
            assert_ok(ctx, asdic_nc_commit(&nc));
        } else {
            asdic_nc_discard(&nc);
        }
        assert_int_not_equal(access(part, F_OK), 0);
        assert_int_equal(access(path, F_OK) == 0, is_kept);
    }
    assert_int_equal(unlink(path), 0);
    assert_int_equal(rmdir(other), 0);
    asdic_nc nc;
    assert_int_equal(asdic_nc_create(ctx, path, &nc), ASDIC_ERROR_IO);
    assert_contains(asdic_context_error(ctx), strerror(ENOENT));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(levels_lie_by_ping_beam_and_range),
        cmocka_unit_test(the_vehicle_is_where_it_was),
        cmocka_unit_test(the_sonar_is_told),
        cmocka_unit_test(the_water_is_told_as_far_as_it_bends_rays),
        cmocka_unit_test(truth_lies_beside_levels),
        cmocka_unit_test(a_head_turns_its_beams),
        cmocka_unit_test(pings_lie_in_several_chunks),
        cmocka_unit_test(what_is_discarded_leaves_nothing),
        cmocka_unit_test(room_may_end_anywhere),
        cmocka_unit_test(who_writes_ends_with_the_caller),
        cmocka_unit_test(the_first_failure_is_kept),
        cmocka_unit_test(what_fails_at_its_end_leaves_nothing),
        cmocka_unit_test(what_cannot_begin_says_why),
        cmocka_unit_test(folders_are_called_what_they_are),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
