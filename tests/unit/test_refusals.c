/*
 * What the library refuses of a program's numbers: each is taken at its limits, and no further. Limits are
 * those that the headers tell; the error says the number.
 */
#include "asserts.h"

#include <asdic/asdic.h>

#include <float.h>

#define LIMIT_M 1e9 /* of a mesh */

static asdic_context *ctx;

/* All numbers of a call, good ones. */
typedef struct call {
    asdic_environment env;
    asdic_sonar sonar;
    asdic_beam receiver;
    asdic_cfar cfar;
    asdic_detector detector;
    asdic_tracker_options tracker;
    double cell_m, prior, limit; /* of a map */
    double pfa;
    double length_m, depth_m;
    unsigned segments, looks, count, rank;
} call;

static call good(void) {
    call c = {.env = asdic_environment_default(),
              .sonar = asdic_sonar_default(),
              .cfar = asdic_cfar_default(),
              .detector = asdic_detector_default(),
              .tracker = asdic_tracker_options_default(),
              .cell_m = 0.5,
              .prior = 0.1,
              .limit = 10.0,
              .pfa = 1e-3,
              .length_m = 1.0,
              .segments = 8,
              .looks = 4,
              .count = 8,
              .rank = 6};
    c.receiver = c.sonar.transmitter;
    c.sonar.receiver_count = 1;
    return c;
}

static asdic_status check_environment(call *c) {
    return asdic_environment_check(ctx, &c->env);
}

static asdic_status check_profile(call *c) {
    c->env.sound_speed_profile.points = 2;
    for (int i = 0; i < 2; i++) {
        double *speed_mps = &c->env.sound_speed_profile.sound_speed_mps[i];
        *speed_mps = *speed_mps == 0.0 ? 1500.0 : *speed_mps;
    }
    double *deep_m = &c->env.sound_speed_profile.depth_m[1];
    *deep_m = *deep_m == 0.0 ? 100.0 : *deep_m;
    return asdic_environment_check(ctx, &c->env);
}

static asdic_status check_layer(call *c) {
    c->env.refraction = ASDIC_REFRACTION_LAYER;
    return asdic_environment_check(ctx, &c->env);
}

static asdic_status check_sonar(call *c) {
    c->sonar.receivers = &c->receiver;
    return asdic_sonar_check(ctx, &c->sonar);
}

/* With bins of a length that leaves few of them at the lowest rate. */
static asdic_status check_rate(call *c) {
    c->sonar.bin_length_m = 100.0;
    return check_sonar(c);
}

/* With a ping rate that leaves few bins of the shortest. */
static asdic_status check_bins(call *c) {
    c->sonar.ping_rate_hz = 1000.0;
    return check_sonar(c);
}

static asdic_status check_spiky(call *c) {
    c->sonar.speckle = ASDIC_SPECKLE_K;
    return check_sonar(c);
}

static asdic_status check_array(call *c) {
    asdic_array *a = &c->sonar.array;
    a->elements = a->elements ? a->elements : 8;
    a->spacing_m = a->spacing_m != 0.0 ? a->spacing_m : 0.01;
    a->side_lobe_db = a->side_lobe_db != 0.0 ? a->side_lobe_db : -30.0;
    a->shading = ASDIC_SHADING_TAYLOR;
    a->element = c->receiver;
    return check_sonar(c);
}

static asdic_status check_cfar(call *c) {
    static const double intensity[4] = {1.0, 1.0, 1.0, 1.0};
    double estimate[4], threshold[4];
    c->cfar.kind = ASDIC_CFAR_OS;
    return asdic_cfar_row(ctx, &c->cfar, 4, 0.3, intensity, 4, estimate, threshold);
}

static asdic_status check_factor(call *c) {
    double factor;
    return asdic_cfar_factor(ctx, ASDIC_CFAR_OS, c->count, c->rank, c->looks, c->pfa, &factor);
}

static asdic_status check_detector(call *c) {
    asdic_scan *scan = NULL;
    c->sonar.receivers = &c->receiver;
    asdic_status status = asdic_scan_create(ctx, &c->sonar, 1500.0, 4, &c->detector, NULL, &scan);
    asdic_scan_destroy(&scan);
    return status;
}

static asdic_status check_tracker(call *c) {
    asdic_tracker *tracker = NULL;
    asdic_status status = asdic_tracker_create(ctx, &c->tracker, &tracker);
    asdic_tracker_destroy(&tracker);
    return status;
}

static asdic_status check_map(call *c) {
    asdic_occupancy *map = NULL;
    double side_m = fmin(4.0 * c->cell_m, 1e300);
    asdic_status status =
        asdic_occupancy_create(ctx, (asdic_vec3){0}, (asdic_vec3){side_m, side_m, 0.0}, c->cell_m,
                               c->prior, c->limit, &map);
    asdic_occupancy_destroy(&map);
    return status;
}

static asdic_status check_threshold(call *c) {
    asdic_background b = {.mean_lin = 1.0, .looks = 1, .shape = INFINITY};
    double threshold;
    return asdic_detect_threshold(ctx, &b, c->pfa, &threshold);
}

static asdic_status check_sphere(call *c) {
    asdic_mesh *mesh = NULL;
    asdic_status status = asdic_mesh_sphere(ctx, c->length_m, c->segments, &mesh);
    asdic_mesh_destroy(&mesh);
    return status;
}

static asdic_status check_pipe(call *c) {
    asdic_mesh *mesh = NULL;
    asdic_status status = asdic_mesh_cylinder(ctx, 1.0, c->length_m, c->segments, &mesh);
    asdic_mesh_destroy(&mesh);
    return status;
}

static asdic_status check_plate(call *c) {
    asdic_mesh *mesh = NULL;
    asdic_status status = asdic_mesh_plate(ctx, 1.0, c->length_m, &mesh);
    asdic_mesh_destroy(&mesh);
    return status;
}

static asdic_status check_plane(call *c) {
    asdic_scene *scene = NULL;
    assert_ok(ctx, asdic_scene_create(ctx, &scene));
    asdic_status status =
        asdic_scene_set_bottom_plane(scene, c->depth_m, asdic_material_bottom(2.0));
    asdic_scene_destroy(&scene);
    return status;
}

enum { OPEN_LOW = 1, OPEN_HIGH = 2, WHOLE = 4, SIZE = 8 };

#define IN(member) offsetof(call, member)
static const struct limit {
    asdic_status (*check)(call *);
    const char *name;
    size_t offset;
    double low, high; /* without a limit: infinite, which is not tried */
    int flags;
} limits[] = {
    {check_environment, "temperature", IN(env.temperature_degc), -2, 40, 0},
    {check_environment, "salinity", IN(env.salinity_ppt), 0, 45, 0},
    {check_environment, "pH", IN(env.ph), 7, 8.5, 0},
    {check_environment, "wind", IN(env.wind_speed_kn), 0, 60, 0},
    {check_environment, "shipping", IN(env.shipping_density), 0, 1, 0},
    {check_environment, "particles", IN(env.particle_strength_db), -200, 0, 0},
    {check_environment, "sound speed", IN(env.sound_speed_mps), 1300, 1700, 0},
    {check_environment, "depth", IN(env.max_depth_m), 0, 11000, 0},
    {check_environment, "gradient", IN(env.sound_speed_gradient_per_s), -30, 30, 0},
    {check_profile, "first depth", IN(env.sound_speed_profile.depth_m[0]), 0, 100.0 - 0.999999e-3,
     0},
    {check_profile, "second depth", IN(env.sound_speed_profile.depth_m[1]), -INFINITY, 11000, 0},
    {check_profile, "first speed", IN(env.sound_speed_profile.sound_speed_mps[0]), 1300, 1700, 0},
    {check_profile, "last speed", IN(env.sound_speed_profile.sound_speed_mps[1]), 1300, 1700, 0},
    {check_layer, "top of a layer", IN(env.layer_from_m), 0, 0, 0},
    {check_layer, "foot of a layer", IN(env.layer_to_m), 0, 11000, 0},
    {check_sonar, "frequency", IN(sonar.frequency_hz), 100, 3e6, 0},
    {check_sonar, "bandwidth", IN(sonar.bandwidth_hz), 1, 1e6, 0},
    {check_rate, "ping rate", IN(sonar.ping_rate_hz), 0.01, 1000, 0},
    {check_sonar, "source level", IN(sonar.source_level_db), -300, 300, 0},
    {check_bins, "bins", IN(sonar.bin_length_m), 1e-3, 1000, 0},
    {check_sonar, "blanking", IN(sonar.blanking_m), 0.01, 1e4, 0},
    {check_sonar, "range", IN(sonar.max_range_m), 0, INFINITY, OPEN_LOW},
    {check_sonar, "leak", IN(sonar.rear_floor_db), -INFINITY, 0, 0},
    {check_sonar, "own noise", IN(sonar.self_noise_db), -INFINITY, 300, 0},
    {check_spiky, "spikes", IN(sonar.speckle_shape), 0.05, 1000, 0},
    {check_sonar, "aim down", IN(sonar.transmitter.pitch_rad), -2 * 3.14159265358979323846,
     2 * 3.14159265358979323846, 0},
    {check_sonar, "aim aside", IN(receiver.yaw_rad), -2 * 3.14159265358979323846,
     2 * 3.14159265358979323846, 0},
    {check_sonar, "roll", IN(receiver.roll_rad), -2 * 3.14159265358979323846,
     2 * 3.14159265358979323846, 0},
    {check_sonar, "width", IN(receiver.length_h_m), 1e-4, 100, 0},
    {check_sonar, "height", IN(sonar.transmitter.length_v_m), 1e-4, 100, 0},
    {check_array, "elements", IN(sonar.array.elements), 2, ASDIC_ARRAY_MAX_ELEMENTS, WHOLE | SIZE},
    {check_array, "side lobes", IN(sonar.array.side_lobe_db), -100, -10, 0},
    {check_cfar, "cells", IN(cfar.cells), 1, 256, WHOLE},
    {check_cfar, "guard", IN(cfar.guard), 0, ASDIC_SONAR_MAX_BINS, WHOLE},
    {check_cfar, "rank's share", IN(cfar.rank), 0, 1, OPEN_LOW},
    {check_factor, "count", IN(count), 6, 512, WHOLE},
    {check_factor, "rank", IN(rank), 1, 8, WHOLE},
    {check_factor, "looks", IN(looks), 1, 1000, WHOLE},
    {check_factor, "P_FA of neighbours", IN(pfa), 0, 1, OPEN_LOW | OPEN_HIGH},
    {check_detector, "P_FA", IN(detector.pfa), 1e-12, 0.5, 0},
    {check_detector, "prior", IN(detector.prior), 1e-9, 0.999, 0},
    {check_detector, "snr", IN(detector.snr_db), -20, 60, 0},
    {check_detector, "cost", IN(detector.cost_ratio), 1e-6, 1e12, 0},
    {check_tracker, "gate", IN(tracker.gate), 0, INFINITY, OPEN_LOW},
    {check_tracker, "acceleration", IN(tracker.acceleration), 0, INFINITY, 0},
    {check_tracker, "speed", IN(tracker.speed_mps), 0, INFINITY, OPEN_LOW},
    {check_tracker, "hits", IN(tracker.confirm), 1, 5, WHOLE},
    {check_tracker, "pings", IN(tracker.of), 3, 32, WHOLE},
    {check_tracker, "misses", IN(tracker.misses), 1, INFINITY, WHOLE},
    {check_map, "cell", IN(cell_m), 0, INFINITY, OPEN_LOW},
    {check_map, "prior of a map", IN(prior), 0, 1, OPEN_LOW | OPEN_HIGH},
    {check_map, "limit of a map", IN(limit), 0, INFINITY, OPEN_LOW},
    {check_threshold, "P_FA of a threshold", IN(pfa), 1e-300, 1, 0},
    {check_sphere, "radius", IN(length_m), 0, LIMIT_M, OPEN_LOW},
    {check_sphere, "segments", IN(segments), 3, INFINITY, WHOLE},
    {check_pipe, "length", IN(length_m), 0, LIMIT_M, OPEN_LOW},
    {check_pipe, "segments of a pipe", IN(segments), 3, 4096, WHOLE},
    {check_plate, "side", IN(length_m), 0, LIMIT_M, OPEN_LOW},
    {check_plane, "bottom", IN(depth_m), 0, 12000, 0},
};

static asdic_status with(const struct limit *l, double value) {
    call c = good();
    void *at = (char *)&c + l->offset;
    if (l->flags & SIZE) {
        *(size_t *)at = value < 0.0 ? SIZE_MAX : (size_t)value;
    } else if (l->flags & WHOLE) {
        *(unsigned *)at = value < 0.0 ? UINT32_MAX : (unsigned)value;
    } else {
        *(double *)at = value;
    }
    return l->check(&c);
}

static size_t failures;

static void expect(const struct limit *l, double value, bool is_good) {
    asdic_status status = with(l, value);
    if (status != (is_good ? ASDIC_OK : ASDIC_ERROR_ARGUMENT)) {
        print_error("%s = %.17g is %s: %s\n", l->name, value, is_good ? "refused" : "taken",
                    status ? asdic_context_error(ctx) : "");
        failures++;
    }
    char number[32];
    snprintf(number, sizeof number, "%g", value);
    bool is_told = status == ASDIC_OK || !isfinite(value) || fabs(value) < DBL_MIN ||
                   strstr(asdic_context_error(ctx), number);
    if (!is_told && !((l->flags & (WHOLE | SIZE)) && value < 0.0)) {
        print_error("%s = %s: %s\n", l->name, number, asdic_context_error(ctx));
        failures++;
    }
}

/* The number next to LIMIT on the side of TO; of whole ones one more or less. */
static double beside(const struct limit *l, double limit, double to) {
    return l->flags & (WHOLE | SIZE) ? limit + (to > limit ? 1.0 : -1.0) : nextafter(limit, to);
}

static void numbers_are_taken_at_their_limits(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
        const struct limit *l = &limits[i];
        if (isfinite(l->low)) {
            bool open = l->flags & OPEN_LOW;
            expect(l, l->low, !open);
            expect(l, open ? 1e-3 : beside(l, l->low, -INFINITY), open);
        }
        if (isfinite(l->high)) {
            bool open = l->flags & OPEN_HIGH;
            expect(l, l->high, !open);
            expect(l, beside(l, l->high, open ? -INFINITY : INFINITY), open);
        }
    }
    assert_int_equal(failures, 0);
}

static void what_is_no_number_is_refused(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
        const struct limit *l = &limits[i];
        bool may_be_missing =
            l->offset == IN(env.sound_speed_mps) || l->offset == IN(env.max_depth_m) ||
            l->offset == IN(sonar.max_range_m) || l->offset == IN(detector.cost_ratio);
        if (!(l->flags & WHOLE)) {
            expect(l, NAN, may_be_missing);
        }
    }
    assert_int_equal(failures, 0);
}

/* The sentence says which number, of what, and its limits. */
static void refusals_are_whole_sentences(void **state) {
    (void)state;
    static const struct {
        const char *name;
        double value;
        const char *sentence;
    } rows[] = {
        {"temperature", 41, "environment: 'temperature_degc' = 41 is out of range [-2, 40] degC"},
        {"first depth", -1,
         "environment: 'sound_speed_profile', point 1: a depth of -1 m is out of range [0, 11000] "
         "m"},
        {"second depth", -1,
         "environment: 'sound_speed_profile', point 2: a depth of -1 m is out of range [0, 11000] "
         "m"},
        {"last speed", 1200,
         "environment: 'sound_speed_profile', point 2: a sound speed of 1200 m/s is out of range "
         "[1300, 1700] m/s"},
        {"foot of a layer", 12000,
         "environment: a layer fitted from 0 m to 12000 m: depths ascend within [0, 11000] m"},
        {"frequency", 99, "sonar: 'frequency_hz' = 99 is out of range [100, 3e+06] Hz"},
        {"range", -1, "sonar: 'max_range_m' = -1 is not above 0 m"},
        {"leak", 1, "sonar: 'rear_floor_db' = 1 is above 0 dB re on-axis"},
        {"spikes", INFINITY, "sonar: 'speckle_shape' = inf is out of range [0.05, 1000]"},
        {"elements", 1, "1 elements: out of range [2, 1024]"},
        {"side lobes", -5, "side lobes of -5 dB: out of range [-100, -10] dB"},
        {"cells", 257, "CFAR of 257 cells a side (1..256), 2 guards (0..65536), rank 0.75 (0..1]"},
        {"looks", 1001,
         "CFAR over 8 bins (1..512), rank 6, 1001 looks (1..1000), P_FA 0.001 (0..1)"},
        {"P_FA", 1, "detector: 'pfa' = 1 is out of range [1e-12, 0.5]"},
        {"cost", -1, "detector: 'cost_ratio' = -1 is out of range [1e-06, 1e+12]"},
        {"misses", 0,
         "a tracker with gate 9.21, acceleration 0.01 m^2/s^3, speed 0.5 m/s, 3 hits of 5 pings "
         "(at most 32), 0 misses"},
        {"prior of a map", 1,
         "a map of cells of 0.5 m, prior 1, limit 10: all must be above 0, the prior below 1"},
        {"P_FA of a threshold", 2, "a false-alarm probability of 2: must be in [1e-300, 1]"},
        {"radius", -1, "the sphere's radius -1 m is out of range (0, 1e+09]"},
        {"segments", 2, "2 segments are out of range [3, 4096]"},
        {"bottom", 12001, "bottom depth 12001 m is out of range [0, 12000]"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        size_t k = 0;
        while (strcmp(limits[k].name, rows[i].name) != 0) {
            k++;
        }
        assert_int_equal(with(&limits[k], rows[i].value), ASDIC_ERROR_ARGUMENT);
        assert_string_equal(asdic_context_error(ctx), rows[i].sentence);
    }
}

/* Sizes whose product is none, or next to none, in 64 bits. */
static void endless_sizes_are_refused(void **state) {
    (void)state;
    const float value = 0.0f;
    const call c = good();
    const asdic_waterfall rows = {
        .levels_db = &value, .pings = (size_t)1 << 63, .bins = 2, .bin_length_m = 1.0};
    const asdic_map map = {.values = &value, .rows = SIZE_MAX, .columns = 1, .cell_m = 1.0};
    const size_t sizes[][2] = {{(size_t)1 << 62, 0}, {4, (size_t)1 << 61}, {4, SIZE_MAX}};
    asdic_picture_options options = asdic_picture_options_default();
    options.db_low = 0.0;
    options.db_high = 1.0;
    assert_status(ctx, asdic_picture_raster(ctx, "never.png", &rows, &options), ASDIC_ERROR_MEMORY);
    assert_status(ctx, asdic_picture_map(ctx, "never.png", &map, &options), ASDIC_ERROR_ARGUMENT);
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        asdic_ros_about about = asdic_ros_about_default();
        asdic_sonar sonar = c.sonar;
        asdic_ros *ros = NULL;
        sonar.receivers = &c.receiver;
        sonar.receiver_count = 1;
        about.sonar = &sonar;
        about.sound_speed_mps = 1500.0;
        about.bins = sizes[i][0];
        about.sweep.directions = sizes[i][1];
        assert_status(ctx, asdic_ros_create(ctx, &about, &ros), ASDIC_ERROR_ARGUMENT);
        assert_null(ros);
    }
}

/* Of 64 bytes without a zero no more are read. */
static void names_without_an_end_are_refused(void **state) {
    (void)state;
    call c = good();
    c.sonar.receivers = &c.receiver;
    asdic_beam *const beams[] = {&c.receiver, &c.sonar.transmitter};
    for (size_t i = 0; i < sizeof beams / sizeof *beams; i++) {
        memset(beams[i]->name, 'q', ASDIC_NAME_SIZE);
        assert_status(ctx, asdic_sonar_check(ctx, &c.sonar), ASDIC_ERROR_ARGUMENT);
        assert_contains(asdic_context_error(ctx), "'qqqqqqqqqqqqqqqq...' has no terminating zero");
        beams[i]->name[ASDIC_NAME_SIZE - 1] = '\0';
        assert_ok(ctx, asdic_sonar_check(ctx, &c.sonar));
    }
    c.receiver.name[0] = '\0';
    assert_ok(ctx, asdic_sonar_check(ctx, &c.sonar));
}

static int set_up(void **state) {
    (void)state;
    return asdic_context_create(&ctx) == ASDIC_OK ? 0 : -1;
}

static int tear_down(void **state) {
    (void)state;
    asdic_context_destroy(&ctx);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_are_taken_at_their_limits),
        cmocka_unit_test(what_is_no_number_is_refused),
        cmocka_unit_test(refusals_are_whole_sentences),
        cmocka_unit_test(endless_sizes_are_refused),
        cmocka_unit_test(names_without_an_end_are_refused),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
