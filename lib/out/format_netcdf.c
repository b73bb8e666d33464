/*
 * run.nc: a run as netCDF-4. Groups and names are those of the SONAR-netCDF4 convention (Macaulay &
 * Pena, eds., ICES Cooperative Research Report 341, 2018) wherever it has one for what is said. The
 * file does not conform to it and does not claim to: levels are rectangular arrays in dB, where the
 * convention has ragged arrays of samples, and positions are metres from the scene's origin.
 */
#include "format.h"

const char asdic_format_doc_netcdf[] = "also run.nc: netCDF-4 with names after SONAR-netCDF4";

#if ASDIC_HAVE_NETCDF

#include "base/context.h"
#include "base/try.h"
#include "base/vec.h"
#include "beam_width.h"
#include "digits.h"
#include "netcdf_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* About as many numbers per chunk: large enough to compress, small enough to be read alone. */
#define CHUNK_VALUES ((size_t)1 << 18)
/* Deflate's fastest level, on shuffled bytes: slower levels hardly make noise smaller. */
#define DEFLATE_LEVEL 1

/* A track may have a clock of its own. */
#define BY_CLOCK "time by the mission's clock: since its beginning, or as in its track"
#define DEGREE (180.0 / ASDIC_PI)

/* What is said of every ping beside its levels; HEAD where a head turns. */
enum { PING_TIME, HEAD, TIME, HEADING, PITCH, ROLL, NORTH, EAST, DEPTH, ALTITUDE, SERIES_COUNT };

typedef struct netcdf {
    asdic_nc nc;
    size_t beams, bins, pings;
    int platform, beam_group;
    int level_ids[ASDIC_RECORD_ARRAYS], ping_id, series_ids[SERIES_COUNT];
    int root_level_id, root_time_id;       /* what a reader finds that names no group */
    size_t chunk_pings, buffered, written; /* pings */
    float *levels_db[ASDIC_RECORD_ARRAYS]; /* [chunk_pings * beams * bins] */
    uint64_t *ping_numbers;
    double *series[SERIES_COUNT];
    bool truth;
    int truth_ids[ASDIC_TRUTH_FIELDS];
    asdic_sweep sweep;
    double *axes;           /* [3][beams], forward, starboard, down, the head not turned */
    int axis_ids[3];        /* where the head turns: of every ping */
    double *turned_axes[3]; /* [chunk_pings * beams] */
} netcdf;

typedef struct label {
    const char *name, *long_name;
} label;

static const label level_names[ASDIC_RECORD_ARRAYS] = {
    [ASDIC_TOTAL] = {"backscatter_r", "echo level of the bin, all mechanisms, dB re 1 uPa"},
    [ASDIC_BOTTOM] = {"bottom_db", "reverberation of the bottom, dB re 1 uPa"},
    [ASDIC_SURFACE] = {"surface_db", "reverberation of the surface, dB re 1 uPa"},
    [ASDIC_VOLUME] = {"volume_db", "reverberation of the water, dB re 1 uPa"},
    [ASDIC_OBJECT] = {"object_db", "echo of objects, dB re 1 uPa"},
    [ASDIC_MULTIPATH] = {"multipath_db", "echo over a mirror, dB re 1 uPa"},
    [ASDIC_NOISE] = {"noise_db", "noise, dB re 1 uPa"},
    [ASDIC_COMPONENT_COUNT] = {"stderr_db", "one standard error of the sampling of the total, dB"},
};

static void describe_file(netcdf *f, const asdic_format_about *about) {
    char seed[ASDIC_DIGITS_SIZE];
    asdic_digits_natural(seed, about->seed);
    /* CF-1.9 is the first with 64-bit unsigned integers; groups and strings are there since 1.8. */
    const asdic_nc_attribute root[] = {
        {"Conventions", "CF-1.9"},
        {"title", about->scene_name},
        {"summary", "Simulated forward-looking sonar: echo levels by ping, beam and range."},
        {"comment", "Groups and names after SONAR-netCDF4; the file does not conform to it: "
                    "backscatter_r is a rectangular array in dB re 1 uPa, a bin's level being the "
                    "integral of the returned intensity over the bin, and positions are metres "
                    "north, east and down from the scene's origin."},
        {"source", "asdic"},
        {NULL, NULL}};
    const asdic_nc_attribute provenance[] = {{"conversion_software_name", "asdic"},
                                             {"conversion_software_version", about->version},
                                             {"scene_sha256", about->scene_hash},
                                             {"seed", seed},
                                             {NULL, NULL}};
    asdic_nc_texts(&f->nc, f->nc.id, NC_GLOBAL, root);
    asdic_nc_texts(&f->nc, asdic_nc_group(&f->nc, f->nc.id, "Provenance"), NC_GLOBAL, provenance);
}

/* A single number, without dimension or along DIMENSION. */
static void put_numbers(netcdf *f, int group, int dimension, const label *name, const char *units,
                        const double *values) {
    int id = asdic_nc_variable(&f->nc, group, name->name, NC_DOUBLE, dimension >= 0, &dimension,
                               name->long_name, units);
    if (id >= 0) {
        asdic_nc_check(&f->nc, f->nc.call.put_var_double(group, id, values));
    }
}

/* The sound speed over depth, where it changes. */
static void describe_profile(netcdf *f, int group, const asdic_environment *env) {
    const label depth = {"sound_speed_profile_depth", "depth of a point of the profile"},
                speed = {"sound_speed_profile", "sound speed, linear between points"},
                gradient = {"sound_speed_gradient", "change of the sound speed with depth"};
    const asdic_sound_profile *p = &env->sound_speed_profile;
    if (!asdic_environment_bends(env)) {
        return;
    }
    if (p->points == 0) {
        put_numbers(f, group, -1, &gradient, "1/s", &env->sound_speed_gradient_per_s);
        return;
    }
    int dimension = asdic_nc_dimension(&f->nc, group, "profile", p->points);
    put_numbers(f, group, dimension, &depth, "m", p->depth_m);
    put_numbers(f, group, dimension, &speed, "m/s", p->sound_speed_mps);
}

static void describe_water(netcdf *f, const asdic_format_about *about) {
    const label frequency = {"frequency", "acoustic frequency"},
                absorption = {"absorption_indicative", "acoustic absorption"},
                speed = {"sound_speed_indicative", "sound speed"};
    double absorption_db_per_m = about->absorption_db_per_km / 1000.0;
    int group = asdic_nc_group(&f->nc, f->nc.id, "Environment");
    int dimension = asdic_nc_dimension(&f->nc, group, "frequency", 1);
    put_numbers(f, group, dimension, &frequency, "Hz", &about->sonar->frequency_hz);
    put_numbers(f, group, dimension, &absorption, "dB/m", &absorption_db_per_m);
    put_numbers(f, group, -1, &speed, "m/s", &about->sound_speed_mps);
    describe_profile(f, group, about->environment);
}

static void describe_platform(netcdf *f) {
    static const struct {
        label name;
        const char *units, *standard_name;
        int series;
    } rows[] = {
        {{"heading", "yaw from north towards east"}, "degree", "platform_orientation", HEADING},
        {{"pitch", "bow up"}, "degree", "platform_pitch_angle", PITCH},
        {{"roll", "starboard down"}, "degree", "platform_roll_angle", ROLL},
        {{"north", "north of the scene's origin"}, "m", NULL, NORTH},
        {{"east", "east of the scene's origin"}, "m", NULL, EAST},
        {{"depth", "below the sea surface"}, "m", "depth", DEPTH},
        {{"altitude", "above the bottom straight below"}, "m", "height_above_sea_floor", ALTITUDE},
    };
    f->platform = asdic_nc_group(&f->nc, f->nc.id, "Platform");
    int time = asdic_nc_dimension(&f->nc, f->platform, "time", f->pings);
    f->series_ids[TIME] =
        asdic_nc_variable(&f->nc, f->platform, "time", NC_DOUBLE, 1, &time, BY_CLOCK, "s");
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        int id = asdic_nc_variable(&f->nc, f->platform, rows[i].name.name, NC_DOUBLE, 1, &time,
                                   rows[i].name.long_name, rows[i].units);
        const asdic_nc_attribute standard[] = {
            {rows[i].standard_name ? "standard_name" : NULL, rows[i].standard_name}, {NULL, NULL}};
        asdic_nc_texts(&f->nc, f->platform, id, standard);
        f->series_ids[rows[i].series] = id;
    }
}

static void put_beam_numbers(netcdf *f, int beam_dimension, const asdic_format_about *about) {
    enum { COLUMNS = 7 };
    static const struct {
        label name;
        const char *units;
    } columns[COLUMNS] = {
        {{"beam_direction_x", "direction of the beam's axis, forward"}, "1"},
        {{"beam_direction_y", "direction of the beam's axis, to starboard"}, "1"},
        {{"beam_direction_z", "direction of the beam's axis, down"}, "1"},
        {{"beamwidth_receive_major", "half power, one way, horizontally"}, "degree"},
        {{"beamwidth_receive_minor", "half power, one way, vertically"}, "degree"},
        {{"beamwidth_transmit_major", "half power, one way, horizontally"}, "degree"},
        {{"beamwidth_transmit_minor", "half power, one way, vertically"}, "degree"},
    };
    const asdic_sonar *sonar = about->sonar;
    size_t first = f->sweep.directions ? 3 : 0; /* axes that turn are put ping by ping */
    double wavelength_m = about->sound_speed_mps / sonar->frequency_hz;
    double *values = malloc(COLUMNS * f->beams * sizeof *values);
    if (!values) {
        asdic_nc_check(&f->nc, NC_ENOMEM);
        return;
    }
    for (size_t i = 0; i < f->beams; i++) {
        const asdic_beam *rx = &sonar->receivers[i], *tx = &sonar->transmitter;
        const double row[COLUMNS] = {cos(rx->pitch_rad) * cos(rx->yaw_rad),
                                     cos(rx->pitch_rad) * sin(rx->yaw_rad),
                                     sin(rx->pitch_rad),
                                     DEGREE * asdic_half_power_rad(wavelength_m, rx->length_h_m),
                                     DEGREE * asdic_half_power_rad(wavelength_m, rx->length_v_m),
                                     DEGREE * asdic_half_power_rad(wavelength_m, tx->length_h_m),
                                     DEGREE * asdic_half_power_rad(wavelength_m, tx->length_v_m)};
        for (size_t k = 0; k < COLUMNS; k++) {
            values[k * f->beams + i] = row[k];
        }
    }
    memcpy(f->axes, values, 3 * f->beams * sizeof *values);
    for (size_t k = first; k < COLUMNS; k++) {
        put_numbers(f, f->beam_group, beam_dimension, &columns[k].name, columns[k].units,
                    values + k * f->beams);
    }
    free(values);
}

/* The head's angle at every ping, and the directions of the beams that turn with it. */
static void define_head(netcdf *f, const int dimensions[2]) {
    static const label axes[3] = {
        {"beam_direction_x", "direction of the beam's axis at the ping, forward of the vehicle"},
        {"beam_direction_y", "direction of the beam's axis at the ping, to its starboard"},
        {"beam_direction_z", "direction of the beam's axis at the ping, down from it"}};
    f->series_ids[HEAD] =
        asdic_nc_variable(&f->nc, f->beam_group, "head_angle", NC_DOUBLE, 1, dimensions,
                          "turn of the scanning head from the bow to starboard", "degree");
    for (int k = 0; k < 3; k++) {
        f->axis_ids[k] = asdic_nc_variable(&f->nc, f->beam_group, axes[k].name, NC_DOUBLE, 2,
                                           dimensions, axes[k].long_name, "1");
    }
}

static void put_ranges(netcdf *f, int group, int dimension, const asdic_sonar *sonar) {
    const label range = {"range", "range of the bin's centre"};
    double *range_m = malloc(f->bins * sizeof *range_m);
    if (!range_m) {
        asdic_nc_check(&f->nc, NC_ENOMEM);
        return;
    }
    for (size_t i = 0; i < f->bins; i++) {
        range_m[i] = ((double)i + 0.5) * sonar->bin_length_m;
    }
    put_numbers(f, group, dimension, &range, "m", range_m);
    free(range_m);
}

static void put_beam_names(netcdf *f, int group, int dimension, const asdic_sonar *sonar) {
    int id = asdic_nc_variable(&f->nc, group, "beam", NC_STRING, 1, &dimension, "beam name", NULL);
    for (size_t i = 0; i < f->beams && id >= 0; i++) {
        const char *name = sonar->receivers[i].name;
        if (!asdic_nc_check(&f->nc, f->nc.call.put_var1_string(group, id, &i, &name))) {
            return;
        }
    }
}

static void put_pulse(netcdf *f, const asdic_format_about *about) {
    const asdic_sonar *s = about->sonar;
    const struct {
        label name;
        const char *units;
        double value;
    } rows[] = {
        {{"transmit_frequency_start", "start of the pulse"},
         "Hz",
         s->frequency_hz - 0.5 * s->bandwidth_hz},
        {{"transmit_frequency_stop", "end of the pulse"},
         "Hz",
         s->frequency_hz + 0.5 * s->bandwidth_hz},
        {{"transmit_bandwidth", "bandwidth of the pulse"}, "Hz", s->bandwidth_hz},
        {{"transmit_source_level", "dB re 1 uPa at 1 m, after pulse compression"},
         "dB",
         s->source_level_db},
        {{"sample_interval", "two-way time of a bin"},
         "s",
         2.0 * s->bin_length_m / about->sound_speed_mps},
        {{"blanking_interval", "two-way time before reception"},
         "s",
         2.0 * s->blanking_m / about->sound_speed_mps},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        put_numbers(f, f->beam_group, -1, &rows[i].name, rows[i].units, &rows[i].value);
    }
}

/* An array of levels by ping, beam and bin, compressed. */
static int define_level(netcdf *f, int group, const label *name, const int dimensions[3]) {
    const size_t chunks[3] = {f->chunk_pings, f->beams, f->bins};
    const float fill = NAN;
    int id = asdic_nc_variable(&f->nc, group, name->name, NC_FLOAT, 3, dimensions, name->long_name,
                               "dB");
    if (id >= 0 && asdic_nc_check(&f->nc, f->nc.call.def_var_fill(group, id, NC_FILL, &fill)) &&
        asdic_nc_check(&f->nc, f->nc.call.def_var_chunking(group, id, NC_CHUNKED, chunks)) &&
        asdic_nc_check(&f->nc, f->nc.call.def_var_deflate(group, id, 1, 1, DEFLATE_LEVEL))) {
        /* Every chunk is written whole, once; netCDF's cache of 16 MiB a variable would be of no
         * use. */
        asdic_nc_check(&f->nc, f->nc.call.set_var_chunk_cache(group, id, 1, 1, 1.0f));
    }
    return id;
}

static void define_levels(netcdf *f, const int dimensions[3]) {
    const asdic_nc_attribute texts[] = {{"coordinates", "range"}, {NULL, NULL}};
    for (int i = 0; i < ASDIC_RECORD_ARRAYS && f->nc.failure == NC_NOERR; i++) {
        f->level_ids[i] = define_level(f, f->beam_group, &level_names[i], dimensions);
        asdic_nc_texts(&f->nc, f->beam_group, f->level_ids[i], texts);
    }
}

static const char *const truth_names[ASDIC_TRUTH_FIELDS] = {
    "what gives the largest share: an object's number; -1 bottom, -2 surface, -3 volume, -5 "
    "multipath, -6 "
    "noise",
    "number of the strongest object, 0: none",
    "share of the strongest",
    "share of the strongest object",
    "share of what was scattered once",
    "share by way of the surface",
    "share by way of the bottom",
    "share by way of objects",
    "share of noise",
    "where the echo arrives from, below the horizontal"};

/* Ping by ping: they are not buffered. */
static void define_truth(netcdf *f, const int dimensions[3]) {
    const size_t chunks[3] = {1, f->beams, f->bins};
    for (size_t i = 0; i < ASDIC_TRUTH_FIELDS && f->truth && f->nc.failure == NC_NOERR; i++) {
        bool is_number = asdic_truth_fields[i].width == sizeof(int16_t);
        int id = asdic_nc_variable(&f->nc, f->beam_group, asdic_truth_fields[i].name,
                                   is_number ? NC_SHORT : NC_FLOAT, 3, dimensions, truth_names[i],
                                   i + 1 == ASDIC_TRUTH_FIELDS ? "rad" : "1");
        if (id >= 0 && asdic_nc_check(&f->nc, f->nc.call.def_var_chunking(f->beam_group, id,
                                                                          NC_CHUNKED, chunks))) {
            asdic_nc_check(&f->nc,
                           f->nc.call.def_var_deflate(f->beam_group, id, 1, 1, DEFLATE_LEVEL));
        }
        f->truth_ids[i] = id;
    }
}

static void write_truth(netcdf *f, const asdic_ping_truth *truth, size_t ping) {
    const size_t start[3] = {ping, 0, 0}, count[3] = {1, f->beams, f->bins};
    for (size_t i = 0; i < ASDIC_TRUTH_FIELDS && f->truth && truth->share; i++) {
        asdic_nc_check(&f->nc, f->nc.call.put_vara(f->beam_group, f->truth_ids[i], start, count,
                                                   asdic_truth_values(truth, i)));
    }
}

static void describe_beams(netcdf *f, const asdic_format_about *about) {
    const asdic_nc_attribute sonar_texts[] = {
        {"sonar_manufacturer", "none: simulated"}, {"sonar_model", about->scene_name},
        {"sonar_software_name", "asdic"},          {"sonar_software_version", about->version},
        {"sonar_type", "forward-looking sonar"},   {NULL, NULL}};
    const asdic_nc_attribute group_texts[] = {{"beam_mode", "horizontal"}, {NULL, NULL}};
    int sonar = asdic_nc_group(&f->nc, f->nc.id, "Sonar");
    asdic_nc_texts(&f->nc, sonar, NC_GLOBAL, sonar_texts);
    f->beam_group = asdic_nc_group(&f->nc, sonar, "Beam_group1");
    asdic_nc_texts(&f->nc, f->beam_group, NC_GLOBAL, group_texts);
    const int dimensions[3] = {asdic_nc_dimension(&f->nc, f->beam_group, "ping_time", f->pings),
                               asdic_nc_dimension(&f->nc, f->beam_group, "beam", f->beams),
                               asdic_nc_dimension(&f->nc, f->beam_group, "range_sample", f->bins)};
    f->ping_id = asdic_nc_variable(&f->nc, f->beam_group, "ping", NC_UINT64, 1, dimensions,
                                   "number of the ping in the mission", "1");
    f->series_ids[PING_TIME] = asdic_nc_variable(&f->nc, f->beam_group, "ping_time", NC_DOUBLE, 1,
                                                 dimensions, BY_CLOCK, "s");
    put_ranges(f, f->beam_group, dimensions[2], about->sonar);
    put_beam_names(f, f->beam_group, dimensions[1], about->sonar);
    put_beam_numbers(f, dimensions[1], about);
    if (f->sweep.directions) {
        define_head(f, dimensions);
    }
    put_pulse(f, about);
    define_levels(f, dimensions);
    define_truth(f, dimensions);
}

/* The levels once more, with their axes as coordinates, where a reader looks first: tools that
 * name no group would find nothing else. */
static void describe_root(netcdf *f, const asdic_format_about *about) {
    const label level = {"level", level_names[ASDIC_TOTAL].long_name};
    int root = f->nc.id;
    const int dimensions[3] = {asdic_nc_dimension(&f->nc, root, "ping_time", f->pings),
                               asdic_nc_dimension(&f->nc, root, "beam", f->beams),
                               asdic_nc_dimension(&f->nc, root, "range", f->bins)};
    f->root_time_id =
        asdic_nc_variable(&f->nc, root, "ping_time", NC_DOUBLE, 1, dimensions, BY_CLOCK, "s");
    put_beam_names(f, root, dimensions[1], about->sonar);
    put_ranges(f, root, dimensions[2], about->sonar);
    f->root_level_id = define_level(f, root, &level, dimensions);
}

static bool allocate(netcdf *f) {
    size_t values = f->chunk_pings * f->beams * f->bins;
    bool is_there = (f->ping_numbers = malloc(f->chunk_pings * sizeof *f->ping_numbers)) != NULL;
    for (int i = 0; i < ASDIC_RECORD_ARRAYS; i++) {
        f->levels_db[i] = malloc(values * sizeof(float));
        is_there = is_there && f->levels_db[i];
    }
    for (int i = 0; i < SERIES_COUNT; i++) {
        f->series[i] = malloc(f->chunk_pings * sizeof(double));
        is_there = is_there && f->series[i];
    }
    f->axes = malloc(3 * f->beams * sizeof(double));
    for (int i = 0; i < 3; i++) {
        f->turned_axes[i] = malloc(f->chunk_pings * f->beams * sizeof(double));
        is_there = is_there && f->turned_axes[i];
    }
    return is_there && f->axes;
}

static void discard_netcdf(void **file) {
    netcdf *f = *file;
    if (!f) {
        return;
    }
    asdic_nc_discard(&f->nc);
    for (int i = 0; i < ASDIC_RECORD_ARRAYS; i++) {
        free(f->levels_db[i]);
    }
    for (int i = 0; i < SERIES_COUNT; i++) {
        free(f->series[i]);
    }
    for (int i = 0; i < 3; i++) {
        free(f->turned_axes[i]);
    }
    free(f->axes);
    free(f->ping_numbers);
    free(f);
    *file = NULL;
}

static asdic_status begin(netcdf *f, asdic_context *ctx, const char *path,
                          const asdic_format_about *about) {
    TRY(asdic_nc_create(ctx, path, &f->nc));
    if (!allocate(f)) {
        return asdic_fail_memory(ctx, "a netCDF file");
    }
    describe_file(f, about);
    describe_water(f, about);
    describe_platform(f);
    describe_beams(f, about);
    describe_root(f, about);
    return asdic_nc_status(&f->nc);
}

static asdic_status open_netcdf(asdic_context *ctx, const char *path,
                                const asdic_format_about *about, void **out) {
    size_t beams = about->sonar->receiver_count, chunk = CHUNK_VALUES / (beams * about->bins);
    netcdf *f = *out = calloc(1, sizeof *f);
    if (!f) {
        return asdic_fail_memory(ctx, "a netCDF file");
    }
    f->sweep = about->sweep;
    f->beams = beams;
    f->bins = about->bins;
    f->pings = about->pings;
    f->truth = about->truth;
    f->chunk_pings = chunk < 1 ? 1 : chunk > about->pings ? about->pings : chunk;
    asdic_status status = begin(f, ctx, path, about);
    if (status) {
        discard_netcdf(out);
    }
    return status;
}

static asdic_status flush(netcdf *f) {
    const size_t start[3] = {f->written, 0, 0}, count[3] = {f->buffered, f->beams, f->bins};
    if (f->buffered == 0) {
        return ASDIC_OK;
    }
    asdic_nc_check(&f->nc,
                   f->nc.call.put_vara_ulonglong(f->beam_group, f->ping_id, start, count,
                                                 (const unsigned long long *)f->ping_numbers));
    for (int i = 0; i < 3 && f->sweep.directions; i++) {
        asdic_nc_check(&f->nc, f->nc.call.put_vara_double(f->beam_group, f->axis_ids[i], start,
                                                          count, f->turned_axes[i]));
    }
    for (int i = 0; i < SERIES_COUNT; i++) {
        int group = i <= HEAD ? f->beam_group : f->platform;
        if (i == HEAD && !f->sweep.directions) {
            continue;
        }
        asdic_nc_check(&f->nc, f->nc.call.put_vara_double(group, f->series_ids[i], start, count,
                                                          f->series[i]));
    }
    for (int i = 0; i < ASDIC_RECORD_ARRAYS && f->nc.failure == NC_NOERR; i++) {
        asdic_nc_check(&f->nc, f->nc.call.put_vara_float(f->beam_group, f->level_ids[i], start,
                                                         count, f->levels_db[i]));
    }
    asdic_nc_check(&f->nc, f->nc.call.put_vara_double(f->nc.id, f->root_time_id, start, count,
                                                      f->series[PING_TIME]));
    asdic_nc_check(&f->nc, f->nc.call.put_vara_float(f->nc.id, f->root_level_id, start, count,
                                                     f->levels_db[ASDIC_TOTAL]));
    f->written += f->buffered;
    f->buffered = 0;
    return asdic_nc_status(&f->nc);
}

/* The beams' axes in the vehicle's frame as buffered ping N, with the head at HEAD_RAD. */
static void turn_axes(netcdf *f, size_t n, double head_rad) {
    double c = cos(head_rad), s = sin(head_rad);
    for (size_t b = 0; b < f->beams; b++) {
        double x = f->axes[b], y = f->axes[f->beams + b];
        f->turned_axes[0][n * f->beams + b] = c * x - s * y;
        f->turned_axes[1][n * f->beams + b] = s * x + c * y;
        f->turned_axes[2][n * f->beams + b] = f->axes[2 * f->beams + b];
    }
}

static asdic_status write_netcdf(void *file, const asdic_record *record) {
    netcdf *f = file;
    size_t n = f->buffered++, cells = f->beams * f->bins;
    asdic_pose vehicle = asdic_sweep_vehicle(&f->sweep, &record->pose, record->ping);
    double head_rad =
        asdic_sweep_bearing_rad(&f->sweep, asdic_sweep_direction(&f->sweep, record->ping));
    const double series[SERIES_COUNT] = {
        [PING_TIME] = record->time_s,
        [HEAD] = head_rad * DEGREE,
        [TIME] = record->time_s,
        [HEADING] = vehicle.yaw_rad * DEGREE,
        [PITCH] = vehicle.pitch_rad * DEGREE,
        [ROLL] = vehicle.roll_rad * DEGREE,
        [NORTH] = record->pose.position_m.x,
        [EAST] = record->pose.position_m.y,
        [DEPTH] = record->pose.position_m.z,
        [ALTITUDE] = isfinite(record->altitude_m) ? record->altitude_m : NAN};
    for (int i = 0; i < SERIES_COUNT; i++) {
        f->series[i][n] = series[i];
    }
    turn_axes(f, n, head_rad);
    f->ping_numbers[n] = record->ping;
    for (int i = 0; i < ASDIC_RECORD_ARRAYS; i++) {
        memcpy(f->levels_db[i] + n * cells,
               i < ASDIC_COMPONENT_COUNT ? record->level_db[i] : record->stderr_db,
               cells * sizeof(float));
    }
    write_truth(f, &record->truth, f->written + n);
    return f->buffered == f->chunk_pings ? flush(f) : ASDIC_OK;
}

static asdic_status commit_netcdf(void **file) {
    netcdf *f = *file;
    asdic_status status = flush(f);
    status = status ? status : asdic_nc_commit(&f->nc);
    discard_netcdf(file);
    return status;
}

static const asdic_format here = {
    .open = open_netcdf, .write = write_netcdf, .commit = commit_netcdf, .discard = discard_netcdf};

static asdic_status open_process(asdic_context *ctx, const char *path,
                                 const asdic_format_about *about, void **out) {
    return asdic_format_process_open(ctx, &here, path, about, out);
}

const asdic_format asdic_format_netcdf = {.file = "run.nc",
                                          /* not compressed; the level twice */
                                          .level_bytes = (ASDIC_RECORD_ARRAYS + 1) * sizeof(float),
                                          .missing = asdic_nc_missing,
                                          .open = open_process,
                                          .write = asdic_format_process_write,
                                          .commit = asdic_format_process_commit,
                                          .discard = asdic_format_process_discard};

#else

static const char *missing_netcdf(void) {
    return "this build has no netCDF; install libnetcdf-dev and build again";
}

const asdic_format asdic_format_netcdf = {.file = "run.nc", .missing = missing_netcdf};

#endif
