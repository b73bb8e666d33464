/* Where rays are sent: which lobes apertures get, how wide, with which share; how loud a direction may be. */
#include "asserts.h"

#include "base/vec.h"
#include "sim/aim.h"
#include "sim/beam_fan.h"

#define any_true(m) (m)
#include "../../kernels/sampler.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DEGREE (ASDIC_PI / 180.0)
#define WAVELENGTH_M 0.01
#define MOST 40

static dev_beam beams[MOST + 1];          /* the transmitter and its receivers */
static dev_lobe lobes[DEV_MAX_LOBES + 1]; /* the last is none of them */

/* A square aperture of 10 wavelengths. */
static dev_beam look(double yaw_deg, double pitch_deg, double roll_deg) {
    const asdic_beam beam = {.yaw_rad = yaw_deg * DEGREE,
                             .pitch_rad = pitch_deg * DEGREE,
                             .roll_rad = roll_deg * DEGREE,
                             .length_h_m = 0.1,
                             .length_v_m = 0.1};
    const asdic_pose level = {.position_m = {1.0, 2.0, 3.0}};
    return asdic_aim_beam(&beam, &level, WAVELENGTH_M);
}

static double turned(double degrees) {
    return remainder(degrees, 360.0);
}

/* Where a ridge crosses the horizontal, degrees. */
static double crossing_deg(const dev_lobe *lobe) {
    return turned((double)lobe->beta_rad / DEGREE + 90.0 * (double)lobe->side);
}

static void beams_have_frames_of_the_world(void **state) {
    (void)state;
    const asdic_beam beam = {.yaw_rad = 0.3, .length_h_m = 0.2, .length_v_m = 0.05};
    const asdic_pose pose = {.yaw_rad = 0.4};
    dev_beam b = asdic_aim_beam(&beam, &pose, WAVELENGTH_M);
    const double c = cos(0.7), s = sin(0.7), rows[9] = {c, s, 0, -s, c, 0, 0, 0, 1};
    assert_close(b.length_h_wl, 20.0, 1e-5);
    assert_close(b.length_v_wl, 5.0, 1e-5);
    for (int i = 0; i < 9; i++) {
        assert_close(b.rows[i], rows[i], 1e-6);
    }
}

/* The half-power half-width of sinc^4 is 0.32 wavelengths per aperture. */
static void alike_beams_share_a_lobe(void **state) {
    (void)state;
    beams[0] = beams[1] = look(40.0, 0.0, 0.0);
    beams[2] = look(40.1, 0.0, 0.0);
    assert_int_equal(asdic_aim_lobes(ASDIC_SAMPLER_ADAPTIVE, beams, 2, false, lobes), 1);
    assert_close(crossing_deg(&lobes[0]), 40.0, 1e-4);
    assert_true(lobes[0].scale_h > 0.028f && lobes[0].scale_h < 0.034f);
    assert_true(lobes[0].limit_rad < 0.0f && lobes[0].margin_rad == 0.0f && lobes[0].tilt == 0.0f);
    assert_true(lobes[0].share == 1.0f && lobes[0].share_begin == 0.0f);
    /* Narrower by two, or aside by more than a width: a lobe of its own. */
    beams[2].length_h_wl = 20.0f;
    assert_int_equal(asdic_aim_lobes(ASDIC_SAMPLER_ADAPTIVE, beams, 2, false, lobes), 2);
    assert_true(lobes[1].scale_h < 0.017f && lobes[1].share_begin == 0.5f);
    beams[2].length_h_wl = 5.0f;
    assert_int_equal(asdic_aim_lobes(ASDIC_SAMPLER_ADAPTIVE, beams, 2, false, lobes), 2);
    beams[2] = look(42.5, 0.0, 0.0);
    assert_int_equal(asdic_aim_lobes(ASDIC_SAMPLER_ADAPTIVE, beams, 2, false, lobes), 2);
    beams[2] = look(-42.5, 0.0, 0.0);
    assert_int_equal(asdic_aim_lobes(ASDIC_SAMPLER_ADAPTIVE, beams, 2, false, lobes), 2);
    assert_close(crossing_deg(&lobes[1]), -42.5, 1e-4);
    beams[2] = look(-140.0, 0.0, 0.0); /* the same ridge, its other half */
    assert_int_equal(asdic_aim_lobes(ASDIC_SAMPLER_ADAPTIVE, beams, 2, false, lobes), 2);
    assert_close(crossing_deg(&lobes[1]), -140.0, 1e-4);
}

/* On a ridge the direction cosine along the side is zero at every elevation. */
static void check_ridge(const dev_lobe *lobe, const float *row) {
    for (double angle = -1.2; angle < 1.3; angle += 0.4) {
        double off = -(double)lobe->tilt * tan(angle);
        if (fabs(off) <= 1.0) {
            double azimuth = (double)lobe->beta_rad + (double)lobe->side * acos(off);
            double along =
                (row[0] * cos(azimuth) + row[1] * sin(azimuth)) * cos(angle) + row[2] * sin(angle);
            assert_close(along, 0.0, 1e-6);
        }
    }
}

static void rolled_beams_have_two_ridges(void **state) {
    (void)state;
    beams[0] = beams[1] = look(-70.0, 10.0, 45.0);
    assert_int_equal(asdic_aim_lobes(ASDIC_SAMPLER_ADAPTIVE, beams, 1, false, lobes), 2);
    bool is_first =
        hypot(beams[0].rows[3], beams[0].rows[4]) > hypot(beams[0].rows[6], beams[0].rows[7]);
    check_ridge(&lobes[0], beams[0].rows + (is_first ? 3 : 6));
    check_ridge(&lobes[1], beams[0].rows + (is_first ? 6 : 3));
    double level = hypot(beams[0].rows[3], beams[0].rows[4]);
    assert_close_relative(
        lobes[is_first ? 0 : 1].scale_h * level,
        lobes[1].scale_h * hypot(beams[0].rows[is_first ? 6 : 3], beams[0].rows[is_first ? 7 : 4]),
        1e-5);
    /* On its side the vertical aperture leads; of a little roll one ridge matters. */
    beams[0] = beams[1] = look(-70.0, 0.0, 90.0);
    assert_int_equal(asdic_aim_lobes(ASDIC_SAMPLER_ADAPTIVE, beams, 1, false, lobes), 1);
    check_ridge(&lobes[0], beams[0].rows + 6);
    assert_close(crossing_deg(&lobes[0]), -70.0, 1e-3);
    beams[0] = beams[1] = look(-70.0, 0.0, 20.0);
    assert_int_equal(asdic_aim_lobes(ASDIC_SAMPLER_ADAPTIVE, beams, 1, false, lobes), 1);
    check_ridge(&lobes[0], beams[0].rows + 3);
}

/* Where the arc of azimuths ends, directions are at right angles to the transmitter's axis; round the nadir of one
 * that looks down all azimuths lie in front, round the zenith none. */
static void fronts_end_beside_the_transmitter(void **state) {
    (void)state;
    dev_ping *ping = calloc(1, sizeof *ping);
    assert_non_null(ping);
    const double pitches[] = {0.0, 0.5, -0.9};
    for (int i = 0; i < 3; i++) {
        const double x = cos(pitches[i]), z = sin(pitches[i]);
        ping->sampling.front[0] = (float)x;
        ping->sampling.front[2] = (float)z;
        for (double uz = -0.98; uz < 1.0; uz += 0.14) {
            double m = sqrt(1.0 - uz * uz), arc = front_arc(ping, uz, m);
            if (m * x > fabs(uz * z)) {
                assert_true(arc > 0.0 && arc < ASDIC_PI);
                assert_close(m * cos(arc) * x + uz * z, 0.0, 1e-6);
            } else {
                assert_true(arc > ASDIC_PI);
            }
        }
    }
    free(ping);
}

/* Across a ridge a lobe has the same width in direction cosines, and so more azimuths where elevations are steep. */
static void lobes_are_as_wide_at_all_elevations(void **state) {
    (void)state;
    dev_ping *ping = calloc(1, sizeof *ping);
    assert_non_null(ping);
    ping->sampling.front[0] = 1.0f;
    for (int turn = 0; turn < 2; turn++) {
        beams[0] = beams[1] = look(0.0, 10.0, turn ? 20.0 : 0.0);
        assert_int_equal(asdic_aim_lobes(ASDIC_SAMPLER_ADAPTIVE, beams, 1, false, lobes), 1);
        const float *row = beams[0].rows + 3;
        for (double angle = -1.1; angle < 1.2; angle += 0.2) {
            double uz = sin(angle), m = cos(angle), step = 1e-4, cosine[2];
            azimuth_lobe a = azimuth_lobe_at(ping, &lobes[0], uz, m, 0.5 * ASDIC_PI);
            for (int k = 0; k < 2; k++) {
                double azimuth = a.near + (k ? step : -step);
                cosine[k] = (row[0] * cos(azimuth) + row[1] * sin(azimuth)) * m + row[2] * uz;
            }
            double by_azimuth = fabs(cosine[1] - cosine[0]) / (2.0 * step);
            assert_close(0.5 * (cosine[0] + cosine[1]), 0.0, 1e-6);
            assert_close_relative(a.scale * by_azimuth, 0.32 / 10.0,
                                  0.12); /* as alike_beams_share_a_lobe */
            assert_close_relative(a.scale * by_azimuth,
                                  (double)lobes[0].scale_h * hypot(row[0], row[1]), 1e-4);
        }
    }
    free(ping);
}

/* Whether AZIMUTH lies in one of A's windows that get rays, narrowed by EDGE. */
static bool is_in_windows(const azimuth_lobe *a, double azimuth, double edge) {
    return (a->near_share > 0.0 &&
            fabs(remainder(azimuth - a->near, 2.0 * ASDIC_PI)) <= a->near_limit - edge) ||
           (a->near_share < 1.0 &&
            fabs(remainder(azimuth - a->far, 2.0 * ASDIC_PI)) <= a->far_limit - edge);
}

/* At one elevation every azimuth in front of both, and no other, unless their ridge is heard: then it leads. */
static void check_both_fronts(const dev_ping *ping, double uz, int *alone) {
    double m = sqrt(1.0 - uz * uz), arc = front_arc(ping, uz, m);
    azimuth_lobe a = azimuth_lobe_at(ping, &lobes[1], uz, m, arc);
    for (double azimuth = -3.1; azimuth < 3.14; azimuth += 0.05) {
        double facing[2];
        for (int b = 0; b < 2; b++) {
            const float *axis = beams[b].rows;
            facing[b] = m * (axis[0] * cos(azimuth) + axis[1] * sin(azimuth)) + uz * axis[2];
        }
        bool both = facing[0] > 0.0 && facing[1] > 0.0;
        assert_true(!both || is_in_windows(&a, azimuth, 0.0));
        if (a.scale > 1e3 && fmin(facing[0], facing[1]) < -1e-5) {
            assert_false(is_in_windows(&a, azimuth, 2e-3));
            ++*alone;
        }
    }
}

static void receivers_aside_get_what_both_face(void **state) {
    (void)state;
    static const double aims_deg[][4] = {
        {0, 0, 180, 10}, {0, 0, 170, 0}, {20, 10, -150, 5}, {-30, 15, 95, 3}, {160, -20, 45, 10}};
    dev_ping *ping = calloc(1, sizeof *ping);
    assert_non_null(ping);
    for (size_t k = 0; k < sizeof aims_deg / sizeof *aims_deg; k++) {
        int alone = 0;
        beams[0] = look(aims_deg[k][0], aims_deg[k][1], 0.0);
        beams[1] = look(aims_deg[k][2], aims_deg[k][3], 0.0);
        assert_int_equal(asdic_aim_lobes(ASDIC_SAMPLER_ADAPTIVE, beams, 1, false, lobes), 2);
        memcpy(ping->sampling.front, beams[0].rows, sizeof ping->sampling.front);
        ping->sampling.front_azimuth_rad = atan2f(beams[0].rows[1], beams[0].rows[0]);
        for (double uz = -0.95; uz < 1.0; uz += 0.1) {
            check_both_fronts(ping, uz, &alone);
        }
        assert_true(alone > 100);
    }
    /* Behind, two that differ in pitch have edges of their own; ahead they have one ridge. */
    for (int behind = 0; behind < 2; behind++) {
        beams[0] = look(20.0, 0.0, 0.0);
        beams[1] = look(20.0 + 180.0 * behind, 0.0, 0.0);
        beams[2] = look(20.0 + 180.0 * behind, 10.0, 0.0);
        assert_int_equal(asdic_aim_lobes(ASDIC_SAMPLER_ADAPTIVE, beams, 2, false, lobes),
                         behind ? 3 : 1);
    }
    free(ping);
}

static void what_leaks_backwards_gets_rays(void **state) {
    (void)state;
    beams[0] = beams[1] = look(0.0, 0.0, 0.0);
    assert_int_equal(asdic_aim_lobes(ASDIC_SAMPLER_ADAPTIVE, beams, 1, true, lobes), 2);
    assert_close(lobes[0].share, 0.9, 1e-6);
    assert_close(lobes[1].share, 0.1, 1e-6);
    assert_close(lobes[1].share_begin, 0.9, 1e-6);
    assert_close(lobes[1].limit_rad, ASDIC_PI, 1e-6);
    assert_close(crossing_deg(&lobes[1]), 0.0, 1e-4);
    assert_true(lobes[1].scale_h > 1e3f);
}

static void the_beam_sampler_looks_along_beams(void **state) {
    (void)state;
    beams[0] = beams[1] = look(20.0, 0.0, 0.0);
    beams[1].length_v_wl = 9.0f; /* much the same */
    beams[2] = look(20.0, 15.0, 0.0);
    assert_int_equal(asdic_aim_lobes(ASDIC_SAMPLER_BEAM, beams, 2, false, lobes), 3);
    for (int k = 0; k < 2; k++) {
        assert_memory_equal(lobes[k].rows, beams[2 * k].rows, sizeof lobes[k].rows);
        assert_true(lobes[k].scale_h == lobes[k].scale_v && lobes[k].scale_h > 0.028f &&
                    lobes[k].scale_h < 0.034f);
        assert_close(lobes[k].limit_rad, 90.0 * DEGREE, 1e-6);
        assert_close(lobes[k].share, 0.45, 1e-6);
    }
    assert_close(lobes[2].share, 0.1, 1e-6);
    assert_close(lobes[2].limit_rad, 90.0 * DEGREE, 1e-6);
    asdic_aim_lobes(ASDIC_SAMPLER_BEAM, beams, 2, true, lobes);
    assert_close(lobes[2].limit_rad, 180.0 * DEGREE, 1e-6);
    /* A roll by ten degrees, or a height that differs by two, is another beam. */
    beams[2] = look(20.0, 0.0, 10.0);
    assert_int_equal(asdic_aim_lobes(ASDIC_SAMPLER_BEAM, beams, 2, false, lobes), 3);
    beams[2] = look(20.0, 0.0, 0.0);
    beams[2].length_v_wl = 20.0f;
    assert_int_equal(asdic_aim_lobes(ASDIC_SAMPLER_BEAM, beams, 2, false, lobes), 3);
    beams[2].length_v_wl = 5.0f;
    assert_int_equal(asdic_aim_lobes(ASDIC_SAMPLER_BEAM, beams, 2, false, lobes), 3);
    beams[0] = look(20.0, 3.0, 0.0);
    beams[1] = beams[2] = look(20.0, -3.0, 0.0);
    assert_int_equal(asdic_aim_lobes(ASDIC_SAMPLER_BEAM, beams, 2, false, lobes), 3);
    /* Of fifteen far apart eight, each as wide as an eighth of the sector. */
    beams[0] = look(0.0, 0.0, 0.0);
    for (int k = 0; k < 15; k++) {
        beams[1 + k] = look(160.0 + 3.0 * k, 0.0, 0.0);
    }
    assert_int_equal(asdic_aim_lobes(ASDIC_SAMPLER_BEAM, beams, 15, false, lobes), 9);
    for (int k = 0; k < 8; k++) {
        assert_memory_equal(lobes[k].rows, beams[1 + 2 * k].rows, sizeof lobes[k].rows);
        assert_close(lobes[k].scale_h, 42.0 * DEGREE / 8.0, 1e-5);
    }
}

/* Nine rolled beams have eighteen ridges. */
static void lobes_have_a_limit(void **state) {
    (void)state;
    for (int k = 0; k < 9; k++) {
        beams[k] = look(20.0 * k, 0.0, 45.0);
    }
    for (int rear = 0; rear < 2; rear++) {
        unsigned most = DEV_MAX_LOBES - 1 + (unsigned)rear;
        double sum = 0.0;
        memset(lobes, 0x55, sizeof lobes);
        dev_lobe beyond = lobes[DEV_MAX_LOBES];
        assert_int_equal(asdic_aim_lobes(ASDIC_SAMPLER_ADAPTIVE, beams, 8, rear, lobes), most);
        for (unsigned j = 0; j < most; j++) {
            assert_close(lobes[j].share_begin, sum, 1e-6);
            sum += (double)lobes[j].share;
        }
        assert_close(sum, 1.0, 1e-6);
        assert_memory_equal(&beyond, &lobes[DEV_MAX_LOBES], sizeof beyond);
    }
}

/* Twelve receivers from 130 to 240 degrees: one lobe, even over them, for two and a half widths more. */
static void a_sector_is_one_lobe(void **state) {
    (void)state;
    beams[13] = look(300.0, 0.0, 0.0); /* none of them */
    for (int turn = 0; turn < 2; turn++) {
        beams[0] = look(185.0, 0.0, 0.0);
        for (int k = 0; k < 12; k++) {
            beams[1 + k] = look(turn ? 240.0 - 10.0 * k : 130.0 + 10.0 * k, 0.0, 0.0);
        }
        beams[5].length_h_wl = 5.0f; /* the widest sets the margin */
        assert_int_equal(asdic_aim_lobes(ASDIC_SAMPLER_ADAPTIVE, beams, 12, false, lobes), 1);
        assert_close(crossing_deg(&lobes[0]), -175.0, 1e-3);
        assert_close(lobes[0].limit_rad, 55.0 * DEGREE, 1e-5);
        assert_close(lobes[0].margin_rad, 2.5 / 5.0, 1e-6);
        assert_true(lobes[0].scale_h > 1e3f && lobes[0].share == 1.0f);
    }
    assert_close_relative(asdic_aim_footprint_rays(&lobes[0]),
                          2.0 * 2.5 * (55.0 * DEGREE + 0.5) / 0.5, 1e-5);
    lobes[0].limit_rad = 0.01f;
    lobes[0].margin_rad = 100.0f;
    assert_close_relative(asdic_aim_footprint_rays(&lobes[0]), 5.0005, 1e-5);
    lobes[0].margin_rad = 0.0f;
    assert_close(asdic_aim_footprint_rays(&lobes[0]), 4.0, 0.0);
    /* The tilts are those of the outermost. */
    for (int k = 0; k < 12; k++) {
        beams[1 + k] = look(10.0 * k, 0.0, k == 0 ? 5.0 : k == 11 ? -8.0 : 0.0);
    }
    asdic_aim_lobes(ASDIC_SAMPLER_ADAPTIVE, beams, 12, false, lobes);
    assert_close(fabs((double)lobes[0].tilt), tan(5.0 * DEGREE), 1e-5);
    assert_close(fabs((double)lobes[0].most_tilt), tan(8.0 * DEGREE), 1e-5);
    assert_true(lobes[0].tilt * lobes[0].most_tilt < 0.0f);
}

/* A transmitter on either side of a sector from 130 to 240 degrees gets half of the rays; between
 * its outermost beams, or if it is wide, none by itself. */
static void a_sector_leaves_the_transmitter_aside(void **state) {
    (void)state;
    static const struct {
        double yaw_deg;
        float length_wl;
        unsigned lobes;
    } senders[] = {{129, 10, 2}, {131, 10, 1}, {239, 10, 1}, {241, 10, 2},
                   {300, 10, 2}, {300, 2, 1},  {241, 4, 2}};
    for (size_t i = 0; i < sizeof senders / sizeof *senders; i++) {
        beams[0] = look(senders[i].yaw_deg, 0.0, 0.0);
        beams[0].length_h_wl = senders[i].length_wl;
        for (int k = 0; k < 12; k++) {
            beams[1 + k] = look(130.0 + 10.0 * k, 0.0, 0.0);
        }
        unsigned count = asdic_aim_lobes(ASDIC_SAMPLER_ADAPTIVE, beams, 12, false, lobes);
        assert_int_equal(count, senders[i].lobes);
        assert_close(crossing_deg(&lobes[0]), -175.0, 1e-3);
        assert_true(lobes[0].margin_rad > 0.0f);
        if (count == 2) {
            assert_close(crossing_deg(&lobes[1]), turned(senders[i].yaw_deg), 1e-3);
            assert_true(lobes[1].margin_rad == 0.0f && lobes[1].share_begin == 0.5f);
        }
    }
}

/* From 16 receivers on; they have an axis in common where they are alike but for yaw and
 * width. */
static void many_receivers_may_have_an_axis_in_common(void **state) {
    (void)state;
    asdic_beam receivers[16];
    const asdic_sonar sonar = {.receivers = receivers, .receiver_count = 16};
    const asdic_sonar fewer = {.receivers = receivers, .receiver_count = 15};
    asdic_beam_fan fan = {0};
    for (int k = 0; k < 16; k++) {
        receivers[k] =
            (asdic_beam){.yaw_rad = 3.0 * k * DEGREE, .length_h_m = 0.1, .length_v_m = 0.1};
    }
    asdic_beam_fan_plan(&sonar, &fan);
    assert_true(fan.many && fan.common_axis);
    asdic_beam_fan_plan(&fewer, &fan);
    assert_false(fan.many || fan.common_axis);
    for (int k = 0; k < 16; k++) {
        asdic_beam *odd = &receivers[k];
        double *const keys[] = {&odd->pitch_rad, &odd->roll_rad, &odd->length_v_m};
        for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
            double before = *keys[i];
            *keys[i] += 0.01;
            asdic_beam_fan_plan(&sonar, &fan);
            assert_true(fan.many && !fan.common_axis);
            *keys[i] = before;
        }
        odd->length_h_m = 0.05;
        asdic_beam_fan_plan(&sonar, &fan);
        assert_true(fan.many && fan.common_axis);
        odd->length_h_m = 0.1;
    }
    asdic_beam_fan_plan(&sonar, &fan);
    assert_true(fan.common_axis);
}

/* sinc^2 is at most 1 / (1 + (pi x)^2), nearly; here x = 10 sin of the angle off. */
static void the_loudest_receiver_counts(void **state) {
    (void)state;
    beams[0] = beams[1] = look(0.0, 0.0, 0.0);
    beams[2] = look(30.0, 0.0, 0.0);
    const asdic_vec3 ahead = {1.0, 0.0, 0.0};
    assert_close(asdic_aim_envelope(beams, 2, ahead), 1.0, 1e-6);
    double at_30 = 1.0 / (1.0 + pow(ASDIC_PI * 5.0, 2.0));
    const asdic_vec3 aside = {cos(30.0 * DEGREE), sin(30.0 * DEGREE), 0.0};
    assert_close_relative(asdic_aim_envelope(beams, 2, aside), at_30, 1e-5);
    assert_close_relative(asdic_aim_envelope(beams, 1, aside), at_30 * at_30, 1e-5);
    const asdic_vec3 below = {cos(30.0 * DEGREE), 0.0, sin(30.0 * DEGREE)};
    assert_close_relative(asdic_aim_envelope(beams, 1, below), at_30 * at_30, 1e-5);
    beams[2] = look(0.0, -25.0, 0.0); /* along either axis, 25 degrees off the other */
    assert_close_relative(asdic_aim_envelope(beams + 1, 1, ahead),
                          1.0 / (1.0 + pow(ASDIC_PI * 10.0 * sin(25.0 * DEGREE), 2.0)), 1e-5);
    const float *axis = beams[2].rows;
    assert_close_relative(asdic_aim_envelope(beams + 1, 1, (asdic_vec3){axis[0], axis[1], axis[2]}),
                          1.0 / (1.0 + pow(ASDIC_PI * 10.0 * sin(25.0 * DEGREE), 2.0)), 1e-5);
    const asdic_vec3 both = {sqrt(0.48), 0.6, 0.4};
    double h = 1.0 + pow(ASDIC_PI * 6.0, 2.0), v = 1.0 + pow(ASDIC_PI * 4.0, 2.0);
    assert_close_relative(asdic_aim_envelope(beams, 1, both), pow(h * v, -2.0), 1e-5);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(beams_have_frames_of_the_world),
        cmocka_unit_test(alike_beams_share_a_lobe),
        cmocka_unit_test(rolled_beams_have_two_ridges),
        cmocka_unit_test(fronts_end_beside_the_transmitter),
        cmocka_unit_test(lobes_are_as_wide_at_all_elevations),
        cmocka_unit_test(receivers_aside_get_what_both_face),
        cmocka_unit_test(what_leaks_backwards_gets_rays),
        cmocka_unit_test(the_beam_sampler_looks_along_beams),
        cmocka_unit_test(lobes_have_a_limit),
        cmocka_unit_test(a_sector_is_one_lobe),
        cmocka_unit_test(a_sector_leaves_the_transmitter_aside),
        cmocka_unit_test(many_receivers_may_have_an_axis_in_common),
        cmocka_unit_test(the_loudest_receiver_counts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
