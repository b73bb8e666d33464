/*
 * How many rays a sonar takes when nobody says: the same for beams however finely they part a sector, in
 * proportion to bins and to beams that see nothing of each other, within its limits.
 */
#include "asserts.h"

#include <asdic/ping.h>

#include "base/vec.h"

#define MOST 512
#define SPEED 1500.0

/* TIMES each of BEAMS, one list of them after the other, the later ones TURN_DEG more to starboard each. */
#define BEAM_M 0.75 /* 1.02 degrees at 100 kHz */

static uint32_t rays_of_alike(size_t beams, double sector_deg, double pitch_step_deg,
                              double range_m, asdic_rays_over over, size_t times, double turn_deg) {
    static asdic_beam receivers[MOST];
    asdic_sonar sonar = asdic_sonar_default();
    sonar.transmitter.length_h_m = BEAM_M;
    for (size_t k = 0; k < times * beams; k++) {
        size_t i = k % beams;
        double at = (i + 0.5) / (double)beams - 0.5, turn = (double)(k / beams) * turn_deg;
        receivers[k] = sonar.transmitter;
        receivers[k].yaw_rad = (at * sector_deg + turn) * 3.14159265 / 180.0;
        receivers[k].pitch_rad = i * pitch_step_deg * 3.14159265 / 180.0;
    }
    sonar.receivers = receivers;
    sonar.receiver_count = times * beams;
    sonar.bin_length_m = 0.1;
    sonar.ping_rate_hz = SPEED / (2.0 * range_m);
    return asdic_rays_auto(&sonar, SPEED, over);
}

static uint32_t rays_of(size_t beams, double sector_deg, double pitch_step_deg, double range_m,
                        asdic_rays_over over) {
    return rays_of_alike(beams, sector_deg, pitch_step_deg, range_m, over, 1, 0.0);
}

static void overlap_asks_for_nothing(void **state) {
    (void)state;
    uint32_t once = rays_of(128, 128.0, 0.0, 50.0, ASDIC_OVER_PLANES);
    assert_in_range(once, 245000, 260000); /* 4 x 500 bins x 125.5 beams, in two digits */
    assert_int_equal(rays_of(256, 128.0, 0.0, 50.0, ASDIC_OVER_PLANES), once);
    assert_int_equal(rays_of(512, 128.0, 0.0, 50.0, ASDIC_OVER_PLANES), once);
}

/* Beams that are listed twice or three times count once; a hundredth of a width apart, they count one beam more or less
 * at most. */
static void beams_alike_count_once(void **state) {
    (void)state;
    static const struct {
        size_t beams, times;
        double sector_deg, range_m;
    } cases[] = {{1, 2, 0.0, 1000.0},  {1, 3, 0.0, 1000.0},   {4, 2, 120.0, 250.0},
                 {4, 3, 120.0, 250.0}, {32, 2, 120.0, 50.0},  {128, 2, 128.0, 50.0},
                 {64, 2, 20.0, 300.0}, {128, 3, 100.0, 50.0}, {20, 3, 120.0, 50.0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        size_t beams = cases[i].beams, times = cases[i].times;
        double sector = cases[i].sector_deg, range = cases[i].range_m;
        uint32_t once = rays_of(beams, sector, 0.0, range, ASDIC_OVER_PLANES);
        uint32_t alike = rays_of_alike(beams, sector, 0.0, range, ASDIC_OVER_PLANES, times, 0.0);
        uint32_t nearly =
            rays_of_alike(beams, sector, 0.0, range, ASDIC_OVER_PLANES, times, 0.0102);
        assert_in_range(once, 20001, 500000); /* within the limits */
        assert_int_equal(alike, once);
        if (times == 2 || beams > 8) { /* else they become a sector, whose gaps count */
            assert_in_range(nearly, once - once / beams, once + once / beams + 10000);
        }
    }
}

/* Up to eight beams get rays of their own: side by side, as far as the transmitter is heard, or one above the other. */
static void beams_apart_count_each(void **state) {
    (void)state;
    assert_int_equal(rays_of(4, 4.2, 0.0, 250.0, ASDIC_OVER_PLANES), 40000);
    assert_int_equal(rays_of(4, 0.0, 15.5, 500.0, ASDIC_OVER_PLANES), 80000);
}

/* Where one of them looks past the transmitter's lobe, each takes five times as many. */
static void beams_past_the_transmitter_ask_for_more(void **state) {
    (void)state;
    assert_int_equal(rays_of(4, 120.0, 0.0, 250.0, ASDIC_OVER_PLANES), 200000);
    assert_int_equal(rays_of(8, 120.0, 0.0, 250.0, ASDIC_OVER_PLANES), 400000);
    assert_int_equal(rays_of(4, 0.0, 40.0, 250.0, ASDIC_OVER_PLANES), 200000);
    assert_int_equal(rays_of(2, 4.6, 0.0, 250.0, ASDIC_OVER_PLANES), 100000); /* in its null */
    assert_int_equal(rays_of(8, 120.0, 0.0, 125.0, ASDIC_OVER_MIRRORS), 200000);
}

/* More share those of a sector, and what lies between them counts with them; one above the other they do not. */
static void gaps_in_a_sector_count(void **state) {
    (void)state;
    uint32_t whole = rays_of(128, 120.0, 0.0, 50.0, ASDIC_OVER_PLANES);
    assert_in_range(rays_of(20, 120.0, 0.0, 50.0, ASDIC_OVER_PLANES), whole - 5000, whole + 5000);
    assert_in_range(rays_of(40, 120.0, 0.0, 50.0, ASDIC_OVER_PLANES), whole - 5000, whole + 5000);
    assert_int_equal(rays_of(16, 0.0, 20.0, 125.0, ASDIC_OVER_PLANES), 80000);
}

static void range_counts(void **state) {
    (void)state;
    uint32_t near = rays_of(128, 128.0, 0.0, 10.0, ASDIC_OVER_PLANES),
             far = rays_of(128, 128.0, 0.0, 20.0, ASDIC_OVER_PLANES);
    assert_in_range(far, 2 * near - near / 5, 2 * near + near / 5); /* two digits */
}

static void limits(void **state) {
    (void)state;
    assert_int_equal(rays_of(1, 0.0, 0.0, 10.0, ASDIC_OVER_PLANES), 20000);
    assert_int_equal(rays_of(512, 150.0, 0.0, 300.0, ASDIC_OVER_PLANES), 524288);
    assert_int_equal(asdic_rays_auto(NULL, SPEED, ASDIC_OVER_PLANES), 20000);
    /* What is no sonar, or no water, has no cells. */
    const asdic_beam beam = {.length_h_m = 0.1, .length_v_m = 0.1};
    asdic_sonar sonar = asdic_sonar_default(), silent = sonar;
    sonar.receivers = silent.receivers = &beam;
    sonar.receiver_count = silent.receiver_count = 1;
    silent.frequency_hz = 0.0;
    assert_int_equal(asdic_rays_auto(&sonar, 0.0, ASDIC_OVER_PLANES), 20000);
    assert_int_equal(asdic_rays_auto(&silent, SPEED, ASDIC_OVER_PLANES), 20000);
}

static void mirrors_ask_for_twice_as_many(void **state) {
    (void)state;
    assert_int_equal(rays_of(4, 4.2, 0.0, 250.0, ASDIC_OVER_MIRRORS), 80000);
}

static void meshes_ask_for_more(void **state) {
    (void)state;
    assert_int_equal(rays_of(5, 350.0, 0.0, 60.0, ASDIC_OVER_MESHES), 390000); /* 128 a cell */
    assert_int_equal(rays_of(100, 120.0, 0.0, 10.0, ASDIC_OVER_MESHES), 400000);
    assert_int_equal(rays_of(100, 120.0, 0.0, 13.0, ASDIC_OVER_MESHES), 500000); /* 32 a cell */
}

/* A fan that is turned as a whole has as many beams that do not overlap: that of an echo sounder,
 * whose plane is across, one on its side, one whose apertures lie along the other side. */
static void the_way_a_fan_looks_does_not_count(void **state) {
    (void)state;
    asdic_beam beams[256];
    asdic_sonar sonar = asdic_sonar_default();
    sonar.receivers = beams;
    sonar.receiver_count = 256;
    sonar.bin_length_m = 0.1;
    sonar.ping_rate_hz = SPEED / (2.0 * 50.0);
    uint32_t rays[4];
    for (int way = 0; way < 4; way++) {
        for (size_t i = 0; i < 256; i++) {
            double off = (((double)i + 0.5) / 256.0 - 0.5) * 2.4, half_turn = 0.5 * ASDIC_PI;
            beams[i] = sonar.transmitter;
            beams[i].length_h_m = 0.75;
            if (way == 0) {
                beams[i].yaw_rad = off;
            } else if (way == 1) { /* the fan's plane is down and to both sides */
                beams[i].pitch_rad = half_turn - fabs(off);
                beams[i].yaw_rad = off > 0.0 ? half_turn : -half_turn;
                beams[i].roll_rad = off > 0.0 ? -half_turn : half_turn;
            } else { /* up and down ahead */
                beams[i].pitch_rad = off;
                beams[i].roll_rad = way == 2 ? half_turn : 0.0;
                beams[i].length_h_m = way == 2 ? 0.75 : sonar.transmitter.length_h_m;
                beams[i].length_v_m = way == 2 ? sonar.transmitter.length_v_m : 0.75;
            }
        }
        rays[way] = asdic_rays_auto(&sonar, SPEED, ASDIC_OVER_PLANES);
    }
    assert_in_range(rays[0], 271000, 280000); /* 4 x 500 bins x 2.4 rad of 1.02 degrees */
    for (int way = 1; way < 4; way++) {
        assert_int_equal(rays[way], rays[0]);
    }
}

/* Over a mesh, four times the rays, half the error; over planes it falls faster, steeply where bins go short. */
static void error_is_foretold(void **state) {
    (void)state;
    asdic_beam beam = asdic_sonar_default().transmitter;
    asdic_sonar sonar = asdic_sonar_default();
    sonar.receivers = &beam;
    sonar.receiver_count = 1;
    sonar.bin_length_m = 0.1;
    sonar.ping_rate_hz = SPEED / (2.0 * 800.0); /* 8,000 cells: 32,000 rays over a plane */
    uint32_t rays = asdic_rays_auto(&sonar, SPEED, ASDIC_OVER_PLANES);
    assert_int_equal(rays, 32000);
    const struct {
        asdic_rays_over over;
        uint32_t rays;
        double error_db;
    } cases[] = {{ASDIC_OVER_MESHES, 400000, 0.5},    {ASDIC_OVER_MESHES, 100000, 1.0},
                 {ASDIC_OVER_MESHES, 100, 6.5},       {ASDIC_OVER_PLANES, rays, 0.3},
                 {ASDIC_OVER_PLANES, 512000, 0.0375}, {ASDIC_OVER_PLANES, 8000, 2.4},
                 {ASDIC_OVER_PLANES, 1000, 6.5},      {ASDIC_OVER_MIRRORS, 8000, 3.12},
                 {ASDIC_OVER_MIRRORS, rays, 0.39}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double error_db = asdic_rays_error_db(&sonar, SPEED, cases[i].over, cases[i].rays);
        assert_close_relative(error_db, cases[i].error_db, 0.002);
    }
    for (int over = ASDIC_OVER_PLANES; over <= ASDIC_OVER_MESHES; over++) {
        assert_close(asdic_rays_error_db(NULL, SPEED, (asdic_rays_over)over, 400000), 0.0, 0.0);
    }
}

/* Up to eight beams under a transmitter of four times their width or more take 20 rays a cell, and the error falls with
 * the rays to the power of 3/4. One narrower, a ninth beam or a mesh make an end of that. */
static void few_beams_under_a_wide_transmitter_ask_for_more(void **state) {
    (void)state;
    static asdic_beam beams[16];
    asdic_sonar sonar = asdic_sonar_default();
    sonar.receivers = beams;
    sonar.bin_length_m = 0.1;
    sonar.ping_rate_hz = SPEED / (2.0 * 50.0); /* 500 bins */
    for (size_t i = 0; i < 16; i++) {
        beams[i] = sonar.transmitter;
        beams[i].length_h_m = BEAM_M;
        beams[i].yaw_rad = 0.018 * ((double)(i / 2) - 3.0); /* a width apart */
    }
    static const struct {
        size_t beams;
        double sent_m;
        uint32_t rays;
        asdic_rays_over over;
    } cases[] = {{8, 0.05, 40000, ASDIC_OVER_PLANES},  {8, 0.05, 40000, ASDIC_OVER_MIRRORS},
                 {14, 0.05, 70000, ASDIC_OVER_PLANES}, {14, 0.18, 70000, ASDIC_OVER_PLANES},
                 {14, 0.2, 20000, ASDIC_OVER_PLANES},  {14, 0.05, 400000, ASDIC_OVER_MESHES}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        sonar.receiver_count = cases[i].beams;
        sonar.transmitter.length_h_m = cases[i].sent_m;
        uint32_t rays = asdic_rays_auto(&sonar, SPEED, cases[i].over);
        assert_int_equal(rays, cases[i].rays);
        if (rays < 400000 && rays > 20000) {
            double error_db = asdic_rays_error_db(&sonar, SPEED, cases[i].over, rays);
            assert_close_relative(error_db, 0.5, 1e-6);
            error_db = asdic_rays_error_db(&sonar, SPEED, cases[i].over, 16 * rays);
            assert_close_relative(error_db, 0.0625, 1e-6);
        }
    }
    sonar.transmitter.length_h_m = 0.05;
    sonar.receiver_count = 16; /* eight ways */
    assert_int_equal(asdic_rays_auto(&sonar, SPEED, ASDIC_OVER_PLANES), 80000);
    /* Nine: 4 rays a cell, of a sector 57 degrees wide and an eighth more. */
    beams[15].yaw_rad = 0.946;
    assert_in_range(asdic_rays_auto(&sonar, SPEED, ASDIC_OVER_PLANES), 120000, 135000);
}

/* A narrow beam and a wide one, a narrow one between two, listed to and fro. */
static void beams_are_counted_in_any_order(void **state) {
    (void)state;
    static const double sets[][3][2] = {/* degrees, metres */
                                        {{0.0, 0.2}, {5.0, 0.004}, {5.0, 0.004}},
                                        {{0.0, 0.05}, {1.0, 0.75}, {4.0, 0.1}}};
    for (size_t k = 0; k < sizeof sets / sizeof *sets; k++) {
        uint32_t rays[2];
        for (int turn = 0; turn < 2; turn++) {
            asdic_beam beams[3];
            asdic_sonar sonar = asdic_sonar_default();
            for (int i = 0; i < 3; i++) {
                beams[i] = sonar.transmitter;
                beams[i].yaw_rad = sets[k][turn ? 2 - i : i][0] * 3.14159265 / 180.0;
                beams[i].length_h_m = sets[k][turn ? 2 - i : i][1];
            }
            sonar.transmitter.length_h_m = 0.01;
            sonar.receivers = beams;
            sonar.receiver_count = 3;
            sonar.bin_length_m = 0.01;
            sonar.ping_rate_hz = SPEED / (2.0 * 50.0);
            rays[turn] = asdic_rays_auto(&sonar, SPEED, ASDIC_OVER_PLANES);
        }
        assert_in_range(rays[0], 20001, 500000); /* within the limits */
        assert_int_equal(rays[0], rays[1]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(overlap_asks_for_nothing),
        cmocka_unit_test(beams_alike_count_once),
        cmocka_unit_test(beams_apart_count_each),
        cmocka_unit_test(beams_past_the_transmitter_ask_for_more),
        cmocka_unit_test(gaps_in_a_sector_count),
        cmocka_unit_test(range_counts),
        cmocka_unit_test(limits),
        cmocka_unit_test(mirrors_ask_for_twice_as_many),
        cmocka_unit_test(meshes_ask_for_more),
        cmocka_unit_test(the_way_a_fan_looks_does_not_count),
        cmocka_unit_test(error_is_foretold),
        cmocka_unit_test(few_beams_under_a_wide_transmitter_ask_for_more),
        cmocka_unit_test(beams_are_counted_in_any_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
