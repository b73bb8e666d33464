/* What a map of wide beams takes for objects and is none: balls on a floor and above it, passed by a
 * vehicle that weaves, and three beams of 20 degrees. */
#include "ping_rig.h"

static test_device device;

enum { BALLS = 12, PINGS = 200, BEAMS = 3 };
#define CELL_M 0.5
#define NEAR_M 1.5 /* a cell as near to a ball is no false one */
#define LIMIT 10.0
#define FLOOR_M 12.0

/* Balls anywhere ahead of the way, half of them on the floor. */
static void place_balls(ping_rig *r, asdic_vec3 at[BALLS]) {
    unsigned seed = 7;
    asdic_mesh *mesh = NULL;
    assert_ok(device.ctx, asdic_mesh_sphere(device.ctx, 0.4, 32, &mesh));
    for (int i = 0; i < BALLS; i++) {
        double part[2];
        for (int k = 0; k < 2; k++) {
            part[k] = (double)(rand_r(&seed) % 1000) / 1000.0;
        }
        at[i] = (asdic_vec3){20.0 + 50.0 * part[0], 30.0 * part[1] - 15.0, i % 2 ? 11.6 : 8.5};
        char name[8];
        snprintf(name, sizeof name, "b%d", i);
        const asdic_pose pose = {.position_m = at[i]};
        assert_ok(device.ctx, asdic_scene_add_object(r->scene, name, mesh, pose,
                                                     asdic_material_facet(45.0, 5e-4, 0.2)));
    }
    asdic_mesh_destroy(&mesh);
}

static asdic_pose weave(int ping) {
    double x = 0.35 * ping, y = 7.0 * sin(x / 9.0);
    return (asdic_pose){.position_m = {x, y, 7.0}, .yaw_rad = atan(7.0 / 9.0 * cos(x / 9.0))};
}

/* The rule that a bin counts for every cell within half a width of its beam's axis. */
static void add_by_axis(asdic_occupancy *map, const asdic_look *look, const double *llr) {
    for (size_t i = 0; i < map->rows * map->columns; i++) {
        double north = map->north_m + CELL_M * ((double)(i / map->columns) + 0.5);
        double east = map->east_m + CELL_M * ((double)(i % map->columns) + 0.5);
        north -= look->pose.position_m.x;
        east -= look->pose.position_m.y;
        double bin = floor(hypot(north, east) / look->sonar->bin_length_m), least = INFINITY;
        double bearing = atan2(east, north) - look->pose.yaw_rad;
        for (size_t b = 0; b < look->sonar->receiver_count && bin < (double)look->bins; b++) {
            double width = asdic_beam_width_rad(look->sonar, b, look->sound_speed_mps);
            double aside = fabs(remainder(bearing - look->sonar->receivers[b].yaw_rad, 2.0 * M_PI));
            double own = llr[b * look->bins + (size_t)bin];
            if (aside <= 0.5 * width && aside < least && !isnan(own)) {
                double before =
                    isnan(map->log_odds[i]) ? map->prior_log_odds : (double)map->log_odds[i];
                map->log_odds[i] = (float)fmin(fmax(before + own, -LIMIT), LIMIT);
                least = aside;
            }
        }
    }
}

static double far_from(const asdic_vec3 at[BALLS], double north_m, double east_m, int *which) {
    double least = INFINITY;
    for (int i = 0; i < BALLS; i++) {
        double distance = hypot(at[i].x - north_m, at[i].y - east_m);
        *which = distance < least ? i : *which;
        least = fmin(least, distance);
    }
    return least;
}

typedef struct score {
    int found;                  /* balls above even odds */
    double false_m2, at_ten_m2; /* above even odds; where the ten clearest balls are still found */
} score;

static int falling(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x < y) - (x > y);
}

static score judge(const asdic_occupancy *map, const asdic_vec3 at[BALLS]) {
    double peak[BALLS];
    score s = {0};
    for (int i = 0; i < BALLS; i++) {
        peak[i] = -INFINITY;
    }
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < map->rows * map->columns; i++) {
            double north = map->north_m + CELL_M * ((double)(i / map->columns) + 0.5);
            double east = map->east_m + CELL_M * ((double)(i % map->columns) + 0.5);
            double odds = (double)map->log_odds[i];
            int ball = 0;
            bool is_near = far_from(at, north, east, &ball) <= NEAR_M;
            if (pass == 0 && is_near && odds > peak[ball]) {
                peak[ball] = odds;
            }
            s.false_m2 += pass == 1 && !is_near && odds > 0.0 ? CELL_M * CELL_M : 0.0;
            s.at_ten_m2 += pass == 1 && !is_near && odds >= peak[9] ? CELL_M * CELL_M : 0.0;
        }
        qsort(peak, BALLS, sizeof *peak, falling);
    }
    for (int i = 0; i < BALLS; i++) {
        s.found += peak[i] > 0.0;
    }
    return s;
}

static void set_sonar(ping_rig *r) {
    r->sonar.frequency_hz = 200e3;
    r->sonar.ping_rate_hz = 12.0;
    r->sonar.bin_length_m = 0.2;
    r->sonar.speckle = ASDIC_SPECKLE_RAYLEIGH;
    r->sonar.transmitter.length_h_m = 0.007;
    r->sonar.transmitter.length_v_m = 0.02;
    for (int b = 0; b < BEAMS; b++) {
        r->receivers[b] = r->sonar.transmitter;
        r->receivers[b].length_h_m = 0.019;
        r->receivers[b].yaw_rad = 20.0 * (b - 1) * RIG_DEGREE;
    }
    r->sonar.receivers = r->receivers;
    r->sonar.receiver_count = BEAMS;
    r->sampling.rays = 8192;
}

static void false_cells_are_few(void **state) {
    (void)state;
    asdic_context *ctx = device.ctx;
    ping_rig r = rig_create(&device);
    asdic_vec3 at[BALLS], low = {0.0, -60.0, 0.0}, high = {130.0, 60.0, 0.0};
    asdic_detector d = asdic_detector_default();
    set_sonar(&r);
    place_balls(&r, at);
    asdic_simulator *sim = rig_simulator(&r);
    size_t bins = asdic_simulator_bin_count(sim), cells = BEAMS * bins;
    double speed = asdic_environment_sound_speed_mps(&r.env, 7.0);
    asdic_ping *ping = NULL;
    asdic_scan *scan = NULL;
    asdic_occupancy *map = NULL, *by_axis = NULL;
    double *rest = calloc(cells, sizeof *rest);
    assert_ok(ctx, asdic_ping_create(ctx, BEAMS, bins, &ping));
    assert_ok(ctx, asdic_scan_create(ctx, &r.sonar, speed, bins, &d, NULL, &scan));
    assert_ok(ctx, asdic_occupancy_create(ctx, low, high, CELL_M, d.prior, LIMIT, &map));
    assert_ok(ctx, asdic_occupancy_create(ctx, low, high, CELL_M, d.prior, LIMIT, &by_axis));
    for (size_t i = 0; i < map->rows * map->columns; i++) {
        map->floor_depth_m[i] = (float)FLOOR_M;
    }
    for (int k = 0; k < PINGS; k++) {
        asdic_pose pose = weave(k);
        assert_ok(ctx, asdic_simulator_ping(sim, &pose, (uint64_t)k, ping));
        for (size_t i = 0; i < cells; i++) {
            rest[i] = ping->intensity_lin[ASDIC_BOTTOM][i] + ping->intensity_lin[ASDIC_SURFACE][i] +
                      ping->intensity_lin[ASDIC_VOLUME][i] + ping->intensity_lin[ASDIC_NOISE][i];
        }
        const double *total = ping->intensity_lin[ASDIC_TOTAL];
        assert_ok(ctx, asdic_scan_ping(scan, total, rest, NULL, NULL));
        const asdic_look look = {.sonar = &r.sonar,
                                 .sound_speed_mps = speed,
                                 .pose = pose,
                                 .depth_m = pose.position_m.z,
                                 .bins = bins,
                                 .intensity_lin = total,
                                 .background_lin = asdic_scan_get(scan).background_lin,
                                 .snr_db = d.snr_db};
        assert_ok(ctx, asdic_occupancy_add(ctx, map, &look));
        add_by_axis(by_axis, &look, asdic_scan_get(scan).llr);
    }
    score now = judge(map, at), before = judge(by_axis, at);
    print_message("above even odds: %d balls and %.0f m2 of false cells; by axes %d, %.0f m2\n",
                  now.found, now.false_m2, before.found, before.false_m2);
    print_message("ten balls found: %.0f m2 of false cells; by axes %.0f m2\n", now.at_ten_m2,
                  before.at_ten_m2);
    assert_true(now.found >= 10 && now.found >= before.found - 1);
    assert_true(now.false_m2 < before.false_m2 / 4.0);
    assert_true(now.at_ten_m2 < before.at_ten_m2 / 4.0);
    free(rest);
    asdic_occupancy_destroy(&map);
    asdic_occupancy_destroy(&by_axis);
    asdic_scan_destroy(&scan);
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(false_cells_are_few)};
    device = test_device_open_or_skip();
    return test_device_end(&device, cmocka_run_group_tests(tests, NULL, NULL));
}
