/* Many pings: where something is. */
#include "map_rig.h"

#include "detect/evidence.h"
#include "detect/hidden.h"
#include "detect/law.h"

#include <stddef.h>

/* A quiet bin clears a cell on the axis by the likelihood ratio of 10 dB, and a cell where the
 * two-way pattern is lower by that of as much less. */
static void quiet_bins_clear_by_what_would_be_heard(void **state) {
    (void)state;
    map_rig r;
    map_begin(&r, 2); /* two beams that are one: half the evidence from each */
    map_look(&r);
    for (int k = 0; k < 2; k++) {
        double aside = k * 5.0 * DEGREE, x = 0.05 * 100e3 / SPEED * sin(aside) * acos(-1.0);
        double gain = k ? pow(sin(x) / x, 4) : 1.0, snr = 10.0 * gain;
        double ratio = 0.3 * snr / (1.0 + snr) - log1p(snr);
        assert_close(map_at(&r, 30.1 * cos(aside), 30.1 * sin(aside)), MAP_PRIOR + ratio, 0.1);
    }
    assert_true(isnan(map_at(&r, 20.3, 15.0)) && isnan(map_at(&r, -0.5, 0.1)));
    assert_true(isnan(map_at(&r, 55.0, 0.1)));
    for (int i = 0; i < 20; i++) {
        map_look(&r);
    }
    assert_close(map_at(&r, 10.3, 0.1), -10.0, 1e-6);
    asdic_occupancy_destroy(&r.map);
}

/* An echo is shared by the arc it may come from: seen from one place alone, no cell is above even
 * odds, however often; seen from another as well, the cell where the arcs cross is. */
static void poses_tell_cells_apart(void **state) {
    (void)state;
    map_rig r;
    map_begin(&r, 1);
    r.intensity[40] = 40.0;
    for (int i = 0; i < 5; i++) {
        map_look(&r);
    }
    double shared = map_at(&r, 20.3, 0.1);
    assert_true(shared > MAP_PRIOR + 1.0 && shared < 0.0);
    double aside = map_at(&r, 20.3, 0.9);
    assert_true(aside > MAP_PRIOR + 1.0 && aside < 0.0);
    assert_true(map_at(&r, 18.3, 0.1) < -9.0);
    r.pose = (asdic_pose){.position_m = {20.3, -20.2, 0.0}, .yaw_rad = 90.0 * DEGREE};
    for (int i = 0; i < 5; i++) {
        map_look(&r);
    }
    assert_true(map_at(&r, 20.3, 0.1) > 0.0);
    assert_true(map_at(&r, 20.3, 1.6) < MAP_PRIOR);
    assert_true(map_at(&r, 21.9, 0.1) < MAP_PRIOR); /* on the second arc, off the first */
    asdic_occupancy_destroy(&r.map);
}

/* Cells of two bins' length, whose centres ahead lie in every other bin: an echo in one of those between is in the
 * cell round it. */
static void long_cells_hear_all_their_bins(void **state) {
    (void)state;
    map_rig r;
    map_begin(&r, 1);
    asdic_occupancy_destroy(&r.map);
    asdic_vec3 low = {-1.0, -30.0, 0.0}, high = {60.0, 30.0, 0.0};
    assert_ok(ctx, asdic_occupancy_create(ctx, low, high, 1.0, 0.01, 10.0, &r.map));
    r.intensity[40] = 40.0; /* 20 to 20.5 m; centres are at 19.5 and 20.5 m */
    for (int i = 0; i < 5; i++) {
        map_look(&r);
    }
    const float *cell = r.map->log_odds + 21 * r.map->columns + 30; /* [20, 21) m */
    assert_true((double)cell[0] > MAP_PRIOR + 1.0);
    assert_true((double)cell[2 * r.map->columns] < MAP_PRIOR - 2.0);
    assert_true((double)cell[-2 * (ptrdiff_t)r.map->columns] < MAP_PRIOR - 2.0);
    asdic_occupancy_destroy(&r.map);
}

/* A map of one long cell ahead, [0, SIDE_M) north: its log-odds after a look. */
static double long_cell(map_rig *r, double side_m) {
    asdic_vec3 low = {0.0, -0.5 * side_m, 0.0}, high = {side_m, 0.5 * side_m, 0.0};
    asdic_occupancy_destroy(&r->map);
    assert_ok(ctx, asdic_occupancy_create(ctx, low, high, side_m, 0.01, 10.0, &r->map));
    assert_int_equal(r->map->rows * r->map->columns, 1);
    map_look(r);
    return (double)r->map->log_odds[0];
}

/* The mean of the ratios over the water of a cell from FROM_M to TO_M ahead, as far above a beam as below. */
static double mean_ratio(const map_rig *r, const asdic_evidence *seen, double from_m, double to_m) {
    enum { HEIGHTS = 50000, DISTANCES = 8 };
    double sum = 0.0, high_m = 0.5 * (from_m + to_m) * seen->headings[0].slope_high;
    int distances = to_m > from_m ? DISTANCES : 1;
    for (int i = 0; i < HEIGHTS * distances; i++) {
        double ahead_m = from_m + ((double)(i % distances) + 0.5) / distances * (to_m - from_m);
        double range_m = hypot(ahead_m, ((double)(i / distances) + 0.5) / HEIGHTS * high_m);
        sum += seen->ratio[(size_t)(range_m / r->sonar.bin_length_m)];
    }
    return sum / (HEIGHTS * distances);
}

/* A tall beam hears the water above and below a cell in bins up to 7 m farther: the cell is told the mean of the
 * ratios over all heights, and an echo in each of these bins speaks for it, wherever in a bin its level range
 * lies. A short cell is asked at its centre, a long one at as many distances as it has bins. */
static void check_column(double side_m, double asked_m, size_t beyond, double tolerance) {
    for (int k = 0; k < 12; k++) {
        double plane_m = 20.01 + 0.04 * k, most = 0.0;
        for (size_t echo = 39; echo < beyond; echo++) {
            map_rig r;
            asdic_evidence seen = {0};
            map_begin(&r, 1);
            asdic_occupancy_destroy(&r.map);
            r.sonar.transmitter.length_v_m = r.beams[0].length_v_m = 0.01;
            r.intensity[echo] = 15.0;
            const asdic_look look = look_of(&r);
            assert_ok(ctx, asdic_evidence_create(ctx, &look, NULL, &seen));
            assert_ok(ctx, asdic_evidence_hide(ctx, &look, NULL, &seen));
            assert_true(seen.headings[0].slope_high > tan(42.0 * DEGREE));
            double mean = mean_ratio(&r, &seen, plane_m - 0.5 * asked_m, plane_m + 0.5 * asked_m);
            asdic_vec3 low = {plane_m - 0.5 * side_m, -0.5 * side_m, 0.0};
            asdic_vec3 high = {plane_m + 0.49 * side_m, 0.49 * side_m, 0.0};
            assert_ok(ctx, asdic_occupancy_create(ctx, low, high, side_m, 0.01, 100.0, &r.map));
            map_look(&r);
            assert_close((double)r.map->log_odds[0], MAP_PRIOR + log(mean), tolerance);
            most = fmax(most, mean);
            asdic_evidence_finish(&seen);
            asdic_occupancy_destroy(&r.map);
        }
        assert_true(most > 1e3);
    }
}

static void columns_of_water_are_heard_in_all_their_bins(void **state) {
    (void)state;
    check_column(0.25, 0.0, 56, 2e-3);
    check_column(2.0, 2.0, 55, 0.2); /* bin 55 hears a corner of the cell alone */
}

/* Of as many bins as there are: an echo in any of them speaks for an object in a cell of 40 m that a flat beam hears. */
static void cells_as_long_as_the_range_hear_all_their_bins(void **state) {
    (void)state;
    map_rig r;
    map_begin(&r, 1);
    r.sonar.transmitter.length_v_m = r.beams[0].length_v_m = 1.0; /* slant is no farther */
    r.background[0] = 1.0;
    double quiet = long_cell(&r, 40.0);
    assert_close(quiet, MAP_PRIOR + 0.3 * 10.0 / 11.0 - log(11.0), 1e-3); /* as of any bin */
    for (size_t n = 1; n < 80; n++) {
        r.intensity[n] = 40.0;
        assert_true(long_cell(&r, 40.0) > quiet + 0.01);
        r.intensity[n] = 0.3;
    }
    asdic_occupancy_destroy(&r.map);
}

/* Without surface and floor an echo from below says as much of a long cell as one from above. */
static void long_cells_hear_all_arcs(void **state) {
    (void)state;
    double heard[3];
    for (size_t b = 0; b < 3; b++) {
        map_rig r;
        map_begin(&r, 3);
        r.beams[0].pitch_rad = -30.0 * DEGREE;
        r.beams[2].pitch_rad = 30.0 * DEGREE;
        r.sonar.transmitter.length_v_m = 0.005; /* all are heard alike */
        r.intensity[b * MAP_BINS + 56] = 40.0;
        heard[b] = long_cell(&r, 30.0);
        asdic_occupancy_destroy(&r.map);
    }
    assert_close(heard[2], heard[0], 1e-4);
    assert_true(heard[1] > MAP_PRIOR);
}

/* A strong echo ahead comes in by the side lobes of the beams at its sides: no arc there, while an
 * object of its own at the same range is seen. */
static void side_lobes_are_explained(void **state) {
    (void)state;
    for (int has_other = 0; has_other < 2; has_other++) {
        map_rig r;
        map_begin(&r, 3);
        static const double yaw_deg[] = {-40.0, 0.0, 40.0};
        for (int b = 0; b < 3; b++) {
            r.beams[b].yaw_rad = yaw_deg[b] * DEGREE;
            double x = 0.05 * 100e3 / SPEED * sin(yaw_deg[b] * DEGREE) * acos(-1.0);
            double lobe = b == 1 ? 1.0 : pow(sin(x) / x, 2);
            r.sonar.transmitter.length_h_m = 0.005; /* all are heard alike */
            r.intensity[b * MAP_BINS + 40] = 1.0 + 1e4 * lobe;
        }
        assert_true(r.intensity[40] > 30.0); /* 15 dB above the background */
        r.intensity[2 * MAP_BINS + 40] += has_other ? 2e4 : 0.0;
        map_look(&r);
        double side = 20.2 * sin(40.0 * DEGREE), ahead = 20.2 * cos(40.0 * DEGREE);
        /* Some sixty cells share the echo: each is 1 - 0.99^60 re the rest. */
        assert_true(map_at(&r, 20.4, 0.1) > MAP_PRIOR + 0.5);
        assert_true(map_at(&r, ahead, -side) < MAP_PRIOR);
        assert_int_equal(map_at(&r, ahead, side) > MAP_PRIOR + 0.5, has_other);
        asdic_occupancy_destroy(&r.map);
    }
}

/* A fan of BEAMS passes a point at its depth, LEVEL_DB over a background of 1 on all axes, which all beams hear by
 * their whole patterns: the map's peak is there. */
static void check_pass(size_t beams, double sector_deg, double length_m, double level_db) {
    enum { PINGS = 100, MOST = 96, BINS = 80 };
    static const asdic_vec3 point = {45.1, -10.1, 0.0};
    static asdic_beam fan[MOST];
    static double intensity[MOST * BINS], background[MOST * BINS];
    asdic_sonar sonar = sonar_of(fan, beams);
    sonar.frequency_hz = 200e3;
    sonar.bandwidth_hz = 10e3;
    sonar.bin_length_m = 0.5;
    sonar.transmitter.length_h_m = sonar.transmitter.length_v_m = 0.006;
    for (size_t b = 0; b < beams; b++) {
        fan[b] = sonar.transmitter;
        fan[b].length_h_m = length_m;
        fan[b].yaw_rad = (((double)b + 0.5) / (double)beams - 0.5) * sector_deg * DEGREE;
    }
    asdic_occupancy *map = NULL;
    asdic_vec3 low = {0.0, -60.0, 0.0}, high = {80.0, 60.0, 0.0};
    assert_ok(ctx, asdic_occupancy_create(ctx, low, high, 0.5, 0.01, 10.0, &map));
    for (int k = 0; k < PINGS; k++) {
        double x = 0.3 * k, y = 0.06 * k;
        double yaw_rad = -0.2 * DEGREE * k; /* the point stays in the fan */
        double range_m = hypot(point.x - x, point.y - y);
        double azimuth_rad = atan2(point.y - y, point.x - x) - yaw_rad;
        double sent = face_gain(&sonar, 0.006, azimuth_rad);
        for (size_t i = 0; i < beams * BINS; i++) {
            double heard = face_gain(&sonar, length_m, azimuth_rad - fan[i / BINS].yaw_rad);
            bool is_there = i % BINS == (size_t)(range_m / sonar.bin_length_m);
            background[i] = 1.0;
            intensity[i] = 1.0 + (is_there ? pow(10.0, 0.1 * level_db) * sent * heard : 0.0);
        }
        const asdic_look look = {.sonar = &sonar,
                                 .sound_speed_mps = SPEED,
                                 .pose = {.position_m = {x, y, 8.0}, .yaw_rad = yaw_rad},
                                 .depth_m = 8.0,
                                 .bins = BINS,
                                 .intensity_lin = intensity,
                                 .background_lin = background,
                                 .snr_db = 10.0};
        assert_ok(ctx, asdic_occupancy_add(ctx, map, &look));
    }
    double most = -INFINITY, off_m = 0.0;
    for (size_t i = 0; i < map->rows * map->columns; i++) {
        double north_m = map->north_m + 0.5 * ((double)(i / map->columns) + 0.5);
        double east_m = map->east_m + 0.5 * ((double)(i % map->columns) + 0.5);
        if ((double)map->log_odds[i] > most) {
            most = (double)map->log_odds[i];
            off_m = hypot(north_m - point.x, east_m - point.y);
        }
    }
    print_message("%zu beams, %.0f dB: log-odds of %.1f, %.2f m off\n", beams, level_db, most,
                  off_m);
    assert_true(most > 0.0 && off_m < 1.5);
    asdic_occupancy_destroy(&map);
}

static void loud_objects_are_found_where_they_are(void **state) {
    (void)state;
    for (double level_db = 25.0; level_db <= 55.0; level_db += 15.0) {
        check_pass(24, 100.0, 0.08, level_db);
        check_pass(96, 100.0, 0.08, level_db);
        check_pass(12, 100.0, 0.05, level_db);
        check_pass(5, 60.0, 0.032, level_db - 11.0);
    }
}

/* Faces that hear 20 dB less from behind: an echo from ahead is no object astern of a beam that looks there. */
static void echoes_through_the_rear_are_explained(void **state) {
    (void)state;
    map_rig r;
    map_begin(&r, 2);
    r.beams[1].yaw_rad = 180.0 * DEGREE;
    r.sonar.rear_floor_db = -20.0;
    r.pose.position_m.x = 30.0;
    r.intensity[40] = 1.0 + 1e5;
    r.intensity[MAP_BINS + 40] = 1.0 + 1e3;
    map_look(&r);
    assert_true(map_at(&r, 50.4, 0.1) > MAP_PRIOR + 0.5);
    assert_true(map_at(&r, 9.9, 0.1) < MAP_PRIOR);
    asdic_occupancy_destroy(&r.map);
}

/* On a floor that is known, 8 m below a beam that looks 30 degrees down, an echo at 16.25 m lies
 * 14.1 m away and nowhere else; what is above the beam's height stays as it was. */
static void echoes_lie_on_the_floor_that_is_known(void **state) {
    (void)state;
    map_rig r;
    map_begin(&r, 1);
    r.beams[0].pitch_rad = 30.0 * DEGREE;
    r.sonar.transmitter.pitch_rad = 30.0 * DEGREE;
    r.pose.position_m.z = r.depth_m = 4.0;
    for (size_t i = 0; i < r.map->rows * r.map->columns; i++) {
        r.map->floor_depth_m[i] = 12.0f;
    }
    r.intensity[32] = 40.0;
    for (int i = 0; i < 5; i++) {
        map_look(&r);
    }
    size_t row = (size_t)((14.1 + 1.0) / 0.25), column = (size_t)(30.1 / 0.25);
    const float *floor_odds = r.map->part[ASDIC_OCCUPANCY_FLOOR] + row * r.map->columns + column;
    assert_true((double)floor_odds[0] > MAP_PRIOR);
    for (size_t off = 4; off < 12; off++) { /* a metre and more from there */
        assert_true((double)floor_odds[off * r.map->columns] < MAP_PRIOR - 3.0);
        assert_true((double)floor_odds[-(ptrdiff_t)(off * r.map->columns)] < MAP_PRIOR - 3.0);
    }
    /* Far off the beam is in the floor. */
    assert_true(isnan(map_at(&r, 40.0, 0.1)));
    asdic_occupancy_destroy(&r.map);
}

/* Two beams, 10 and 26 degrees down, hear a floor 20 degrees down: the second looks to it, and what it hears there tells of
 * it alone. */
static void the_floor_is_asked_of_the_nearest_arc(void **state) {
    (void)state;
    for (size_t b = 0; b < 2; b++) {
        map_rig r;
        map_begin(&r, 2);
        r.beams[0].pitch_rad = 10.0 * DEGREE;
        r.beams[1].pitch_rad = 26.0 * DEGREE;
        r.sonar.transmitter.length_v_m = 0.005; /* both are heard alike */
        r.pose.position_m.z = r.depth_m = 4.0;
        for (size_t i = 0; i < r.map->rows * r.map->columns; i++) {
            r.map->floor_depth_m[i] = 12.0f;
        }
        r.intensity[b * MAP_BINS + 46] = 40.0; /* 23 to 23.5 m: 21.9 m away, 8 m below */
        for (int i = 0; i < 5; i++) {
            map_look(&r);
        }
        size_t row = (size_t)((21.9 + 1.0) / 0.25), column = (size_t)(30.1 / 0.25);
        double odds = r.map->part[ASDIC_OCCUPANCY_FLOOR][row * r.map->columns + column];
        assert_true(b == 1 ? odds > MAP_PRIOR : odds < MAP_PRIOR - 3.0);
        asdic_occupancy_destroy(&r.map);
    }
}

/* Cells are heard whose centres lie within the range: to the north, south, east and west of the sonar the
 * farthest one 5 mm nearer than that, the next one a side farther. */
static void cells_lie_at_their_centres(void **state) {
    (void)state;
    const double cell_m = 0.25, range_m = MAP_BINS * 0.5;
    for (int k = 0; k < 4; k++) {
        map_rig r;
        map_begin(&r, 1);
        asdic_occupancy_destroy(&r.map);
        asdic_vec3 low = {-60.0, -60.0, 0.0}, high = {60.0, 60.0, 0.0};
        assert_ok(ctx, asdic_occupancy_create(ctx, low, high, cell_m, 0.01, 10.0, &r.map));
        r.sonar.bin_length_m = 0.5;
        r.sonar.transmitter.length_v_m = r.beams[0].length_v_m =
            1.0; /* flat: slant is no farther */
        /* The centre of [row][column] is at -60 + 0.125 + 0.25 row. */
        const double centre_m = -60.0 + (440 + 0.5) * cell_m; /* 50.125 */
        double shift = centre_m - range_m + 0.005;
        double c = cos(k * 90.0 * DEGREE), s = sin(k * 90.0 * DEGREE);
        r.pose = (asdic_pose){
            .position_m = {shift * c + 0.125 * fabs(s), shift * s + 0.125 * fabs(c), 0.0},
            .yaw_rad = k * 90.0 * DEGREE};
        map_look(&r);
        for (int step = 0; step < 2; step++) {
            size_t there = (size_t)(k < 2 ? 440 + step : 39 - step), here = 240;
            size_t row = k % 2 ? here : there, column = k % 2 ? there : here;
            assert_int_equal(isnan(r.map->log_odds[row * r.map->columns + column]), step);
        }
        asdic_occupancy_destroy(&r.map);
    }
}

/* Where hardly anything is expected, a quiet look at a cell multiplies its odds by the mean of the ratios of
 * its heights: that of the beam where it hears, 1 elsewhere. The share heard is the beam's height of that of
 * all the water, cut off at the surface; unknown floors leave what is heard. */
static void water_that_is_not_heard_says_nothing(void **state) {
    (void)state;
    static const double depth_m[] = {6.0, 1.0, 6.0, INFINITY};
    static const float floor_m[] = {15.0f, 10.0f, NAN, 15.0f};
    for (int i = 0; i < 4; i++) {
        map_rig r;
        asdic_evidence seen = {0};
        map_begin(&r, 1);
        asdic_occupancy_destroy(&r.map);
        asdic_vec3 low = {-1.0, -30.0, 0.0}, high = {60.0, 30.0, 0.0};
        assert_ok(ctx, asdic_occupancy_create(ctx, low, high, 0.25, 1e-9, 100.0, &r.map));
        r.sonar.bin_length_m = 0.5;
        r.depth_m = depth_m[i];
        r.pose.position_m.z = isinf(depth_m[i]) ? 6.0 : depth_m[i];
        for (size_t k = 0; k < r.map->rows * r.map->columns; k++) {
            r.map->floor_depth_m[k] = floor_m[i];
        }
        const asdic_look look = look_of(&r);
        assert_ok(ctx, asdic_evidence_create(ctx, &look, NULL, &seen));
        assert_int_equal(seen.arcs, 1);
        double ratio = seen.ratio[60], away_m = 30.125;
        double above = fmin(-away_m * seen.headings[0].slope_low, depth_m[i]);
        double heard = above + away_m * seen.headings[0].slope_high;
        double all = isnan(floor_m[i]) || isinf(depth_m[i])
                         ? heard
                         : floor_m[i] - r.pose.position_m.z + depth_m[i];
        assert_true(heard > 3.0 && heard <= all);
        map_look(&r);
        size_t row = (size_t)(31.1 / 0.25), column = (size_t)(30.1 / 0.25);
        double prior = isnan(floor_m[i]) ? log(1e-9) : log(0.5e-9); /* half of it on the floor */
        double got = (double)r.map->part[ASDIC_OCCUPANCY_WATER][row * r.map->columns + column];
        assert_close(got, prior + log(1.0 + heard / all * (ratio - 1.0)), 1e-4);
        asdic_evidence_finish(&seen);
        asdic_occupancy_destroy(&r.map);
    }
}

/* Over cells that are as far to all sides the same ping draws the same map whichever way the sonar looks, where a
 * quarter turn is a number of whole headings. North is the first of these, and its neighbour the last. */
static void maps_do_not_depend_on_the_compass(void **state) {
    (void)state;
    enum { SIDE = 81, MIDDLE = SIDE / 2, REACH = 30 };
    float ahead[SIDE][SIDE] = {{0}};
    for (int quarter = 0; quarter < 4; quarter++) {
        map_rig r;
        map_begin(&r, 1);
        asdic_occupancy_destroy(&r.map);
        const asdic_vec3 low = {-10.125, -10.125, 0.0}, high = {10.125, 10.125, 0.0};
        assert_ok(ctx, asdic_occupancy_create(ctx, low, high, 0.25, 0.3, 10.0, &r.map));
        assert_true(r.map->rows == SIDE && r.map->columns == SIDE);
        r.beams[0].length_h_m = r.sonar.transmitter.length_h_m = 0.0507; /* 136 headings */
        r.sonar.bin_length_m = 2.0;
        r.sonar.bandwidth_hz = 0.5 * SPEED / r.sonar.bin_length_m;
        r.background[0] = 1.0;
        r.intensity[0] = r.intensity[2] = 40.0;
        r.pose.yaw_rad = 90.0 * quarter * DEGREE;
        map_look(&r);
        const int to_north[] = {1, 0, -1, 0}, to_east[] = {0, 1, 0, -1};
        size_t known = 0;
        for (int along = 1; along < REACH; along++) {
            for (int aside = -along; aside <= along; aside++) {
                int row = MIDDLE + along * to_north[quarter] - aside * to_east[quarter];
                int column = MIDDLE + along * to_east[quarter] + aside * to_north[quarter];
                float now = r.map->log_odds[row * SIDE + column];
                float *first = &ahead[along][MIDDLE + aside];
                *first = quarter == 0 ? now : *first;
                known += !isnan(now);
                assert_int_equal(isnan(now), isnan(*first));
                assert_true(isnan(now) || fabs((double)now - (double)*first) < 1e-4);
            }
        }
        assert_true(known > 100);
        asdic_occupancy_destroy(&r.map);
    }
}

/* Ten looks at an echo at 20 m, where the bins behind it hold BEHIND_LIN of the background in single looks of
 * exponential speckle, or in K speckle of SHAPE. */
static void look_at_echo(map_rig *r, double behind_lin, double shape) {
    enum { ECHO = 40, LOOKS = 10 };
    uint64_t state = 1;
    map_begin(r, 1);
    r->sonar.speckle = isinf(shape) ? ASDIC_SPECKLE_RAYLEIGH : ASDIC_SPECKLE_K;
    r->sonar.speckle_shape = isinf(shape) ? r->sonar.speckle_shape : shape;
    const asdic_background unit = asdic_background_of(&r->sonar, SPEED, 1.0, 0.0);
    assert_true(unit.looks == 1);
    for (int look = 0; look < LOOKS; look++) {
        for (size_t n = 0; n < MAP_BINS; n++) {
            asdic_rare_draw d = asdic_rare_draw_one(&unit, 5, state++);
            double texture = isinf(shape) ? 1.0 : d.texture / shape;
            r->intensity[n] = (n > ECHO ? behind_lin : 1.0) * d.speckle * texture;
        }
        r->intensity[ECHO] = 400.0;
        map_look(r);
    }
}

/* What lies in an object's shadow would not be heard: it stays as likely as it was. Behind an echo without a shadow
 * quiet bins clear the cells as they do before it. */
static void shadows_do_not_clear(void **state) {
    (void)state;
    const double shapes[] = {INFINITY, 4.0, 1.0};
    for (int k = 0; k < 3; k++) {
        map_rig dark, clear;
        look_at_echo(&dark, 0.01, shapes[k]);
        look_at_echo(&clear, 1.0, shapes[k]);
        for (double at_m = 23.3; at_m < 48.0; at_m += 6.0) {
            assert_close(map_at(&dark, at_m, 0.1), MAP_PRIOR, 0.5);
            assert_true(map_at(&clear, at_m, 0.1) < -8.0);
        }
        assert_true(map_at(&dark, 15.3, 0.1) < -8.0);
        asdic_occupancy_destroy(&dark.map);
        asdic_occupancy_destroy(&clear.map);
    }
}

/* Hundreds of looks make a shadow surer than a number holds, and a bin that was not heard says nothing of those round
 * it: what is asked stays known. */
static void shadows_of_any_looks_are_numbers(void **state) {
    (void)state;
    for (int k = 0; k < 2; k++) {
        map_rig r;
        map_begin(&r, 1);
        r.sonar.bandwidth_hz *= k ? 400.0 : 1.0;
        for (size_t n = 41; n < MAP_BINS; n++) {
            r.intensity[n] = 0.01;
        }
        r.intensity[40] = 400.0;
        r.intensity[60] = k ? 0.01 : (double)NAN;
        for (int look = 0; look < 10; look++) {
            map_look(&r);
        }
        assert_close(map_at(&r, 25.3, 0.1), MAP_PRIOR, 0.5);
        assert_close(map_at(&r, 40.3, 0.1), MAP_PRIOR, 0.5);
        assert_true(map_at(&r, 15.3, 0.1) < -8.0);
        asdic_occupancy_destroy(&r.map);
    }
}

/* Fixed in the world, clipped, and no larger than memory. */
static void maps_have_limits(void **state) {
    (void)state;
    map_rig r;
    asdic_occupancy *map = NULL;
    map_begin(&r, 1);
    r.intensity[40] = 1e9;
    map_look(&r);
    double before = map_at(&r, 25.3, 0.1);
    r.pose.position_m.x = 5.0;
    map_look(&r);
    assert_true(map_at(&r, 25.3, 0.1) > before);
    assert_true(map_at(&r, 20.3, 0.1) < map_at(&r, 25.3, 0.1) + 3.0);
    for (size_t i = 0; i < r.map->rows * r.map->columns; i++) {
        double odds = (double)r.map->log_odds[i];
        assert_true(isnan(odds) || fabs(odds) <= 10.0);
    }
    asdic_occupancy_destroy(&r.map);
    asdic_vec3 low = {-1.0, -20.0, 0.0}, high = {60.0, 20.0, 0.0};
    assert_status(ctx, asdic_occupancy_create(ctx, low, high, 1e-4, 0.01, 10.0, &map),
                  ASDIC_ERROR_ARGUMENT);
    assert_contains(asdic_context_error(ctx), "a map of 610000 x 400000 cells of 0.0001 m");
    assert_status(ctx, asdic_occupancy_create(ctx, low, high, 1e-300, 0.01, 10.0, &map),
                  ASDIC_ERROR_ARGUMENT);
    assert_contains(asdic_context_error(ctx), "a map of 6.1e+301 x 4e+301 cells of 1e-300 m");
}

/* A look from nowhere, at nothing or through no water is none, and leaves the map as it was. */
static void looks_have_limits(void **state) {
    (void)state;
    map_rig r;
    map_begin(&r, 1);
    map_look(&r);
    float before = r.map->log_odds[100];
    asdic_look good = look_of(&r), bad[8];
    for (int i = 0; i < 8; i++) {
        bad[i] = good;
    }
    bad[0].sound_speed_mps = 0.0;
    bad[1].sound_speed_mps = NAN;
    bad[2].pose.position_m.x = NAN;
    bad[3].bins = 0;
    bad[4].snr_db = NAN;
    bad[5].depth_m = NAN;
    bad[6].sound_speed_mps = 1e-300;
    bad[7].sound_speed_mps = INFINITY;
    for (int i = 0; i < 8; i++) {
        assert_status(ctx, asdic_occupancy_add(ctx, r.map, &bad[i]), ASDIC_ERROR_ARGUMENT);
        assert_memory_equal(&r.map->log_odds[100], &before, sizeof before);
    }
    assert_ok(ctx, asdic_occupancy_add(ctx, r.map, &good));
    asdic_occupancy_destroy(&r.map);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(quiet_bins_clear_by_what_would_be_heard),
        cmocka_unit_test(poses_tell_cells_apart),
        cmocka_unit_test(long_cells_hear_all_their_bins),
        cmocka_unit_test(columns_of_water_are_heard_in_all_their_bins),
        cmocka_unit_test(cells_as_long_as_the_range_hear_all_their_bins),
        cmocka_unit_test(long_cells_hear_all_arcs),
        cmocka_unit_test(side_lobes_are_explained),
        cmocka_unit_test(loud_objects_are_found_where_they_are),
        cmocka_unit_test(echoes_through_the_rear_are_explained),
        cmocka_unit_test(echoes_lie_on_the_floor_that_is_known),
        cmocka_unit_test(the_floor_is_asked_of_the_nearest_arc),
        cmocka_unit_test(cells_lie_at_their_centres),
        cmocka_unit_test(water_that_is_not_heard_says_nothing),
        cmocka_unit_test(maps_do_not_depend_on_the_compass),
        cmocka_unit_test(shadows_do_not_clear),
        cmocka_unit_test(shadows_of_any_looks_are_numbers),
        cmocka_unit_test(maps_have_limits),
        cmocka_unit_test(looks_have_limits),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
