/* First-order multipath: both ways of an echo over a wall, and what stands in the way of each leg. */
#include "multipath_rig.h"

#include "kernels/backscatter.h"

/* A wall along the beam at y = 4 m and a square of 0.6 m at 20 m, turned towards both. */
#define WALL_M 4.0
#define SQUARE_X_M 20.0
#define SQUARE_Y_M -1.0
#define SQUARE_YAW_DEG -10.0
#define SQUARE_M 0.6

static target_rig wall_and_square(void) {
    target_rig r = open_sea(30.0);
    add_plate(&r, 60.0, 20.0, (asdic_vec3){10.0, WALL_M, 0.0}, 90.0, mirror());
    add_plate(&r, SQUARE_M, SQUARE_M, (asdic_vec3){SQUARE_X_M, SQUARE_Y_M, 0.0}, SQUARE_YAW_DEG,
              sand());
    return r;
}

/* Both multipath echoes of the square by integration over its area, in double, from the image of
 * the sonar behind the wall. */
static void integrate_square(const target_rig *r, double *same, double *across, double *mean_m) {
    enum { STEPS = 200 };
    double gain = bottom_gain(2.0, FREQUENCY_HZ / 1e3), peak = bottom_peak(2.0);
    double alpha = asdic_environment_absorption_db_per_km(&r->env, FREQUENCY_HZ, 100.0);
    double k = alpha * log(10.0) / 1e4, nx = cos(SQUARE_YAW_DEG * DEGREE),
           ny = sin(SQUARE_YAW_DEG * DEGREE);
    double area = SQUARE_M * SQUARE_M / STEPS / STEPS, ranges = 0.0;
    *same = *across = 0.0;
    for (int i = 0; i < STEPS; i++) {
        for (int j = 0; j < STEPS; j++) {
            double a = ((i + 0.5) / STEPS - 0.5) * SQUARE_M,
                   z = ((j + 0.5) / STEPS - 0.5) * SQUARE_M;
            double x = SQUARE_X_M - a * ny, y = SQUARE_Y_M + a * nx;
            double to_image = sqrt(x * x + (y - 2.0 * WALL_M) * (y - 2.0 * WALL_M) + z * z);
            double to_sonar = sqrt(x * x + y * y + z * z);
            double sin_image = fabs(x * nx + (y - 2.0 * WALL_M) * ny) / to_image;
            double sin_sonar = fabs(x * nx + y * ny) / to_sonar;
            double s_image = bottom_backscatter_lin(gain, peak, 2.0, sin_image);
            double s_sonar = bottom_backscatter_lin(gain, peak, 2.0, sin_sonar);
            /* Towards the wall the beam sees the square mirrored in it. */
            double out = one_way(&r->sonar.transmitter, x, 2.0 * WALL_M - y, z);
            double direct = one_way(&r->receiver, x, y, z);
            double d = 0.5 * (to_image + to_sonar);
            *same +=
                area * out * out * s_image / pow(to_image, 4.0) * exp(-2.0 * k * (to_image - 1.0));
            double part = area * 2.0 * out * direct * sqrt(s_image * s_sonar) /
                          (to_image * to_image * to_sonar * to_sonar) * exp(-2.0 * k * (d - 1.0));
            *across += part;
            ranges += part * d;
        }
    }
    *mean_m = ranges / *across;
}

static void both_paths_meet_an_integration(void **state) {
    (void)state;
    double same, across, mean_m;
    target_rig r = wall_and_square();
    r.sampling.rays = 1 << 20;
    integrate_square(&r, &same, &across, &mean_m);
    asdic_ping *ping = shoot_many(&r, 8);
    assert_close(mean_m, 21.0, 0.1); /* the way over the wall and back over it is 21.9 m */
    double got_across = energy(ping, ASDIC_MULTIPATH, 20.5, 21.5);
    double got_same = energy(ping, ASDIC_MULTIPATH, 21.5, 22.5);
    print_message("across: %.2f dB, integrated %.2f; same way: %.2f dB, integrated %.2f\n",
                  db(got_across), db(across), db(got_same), db(same));
    /* Some 5,000 rays meet the square over the wall. */
    assert_close(db(got_across), db(across), 0.3);
    assert_close(db(got_same), db(same), 0.3);
    assert_close_relative(energy(ping, ASDIC_MULTIPATH, 0.0, INFINITY), got_across + got_same,
                          1e-9);
    asdic_ping_destroy(&ping);
    target_rig_destroy(&r);
}

/* A small screen on each leg in turn: S to the wall, the wall to X, X to S. */
static void every_leg_can_be_hidden(void **state) {
    (void)state;
    enum { CLEAR, SONAR_TO_WALL, WALL_TO_SQUARE, SQUARE_TO_SONAR, CASES };
    double clear_across = 0.0, clear_same = 0.0;
    for (int screen = CLEAR; screen < CASES; screen++) {
        target_rig r = wall_and_square();
        /* The wall's path runs from the sonar to (8.9, 4) and on to the square. */
        if (screen == SONAR_TO_WALL) {
            add_plate(&r, 0.9, 1.5, (asdic_vec3){5.0, 2.25, 0.0}, 24.0, sand());
        } else if (screen == WALL_TO_SQUARE) {
            add_plate(&r, 0.9, 1.5, (asdic_vec3){14.4, 1.5, 0.0}, -24.0, sand());
        } else if (screen == SQUARE_TO_SONAR) {
            add_plate(&r, 0.9, 1.5, (asdic_vec3){8.0, -0.4, 0.0}, 0.0, sand());
        }
        asdic_ping *ping = shoot(&r);
        double got_across = energy(ping, ASDIC_MULTIPATH, 20.5, 21.5);
        double got_same = energy(ping, ASDIC_MULTIPATH, 21.5, 22.5);
        double direct = energy(ping, ASDIC_OBJECT, 19.5, 20.5);
        print_message("screen %d: across %.1f dB, same way %.1f dB, direct %.1f dB\n", screen,
                      db(got_across), db(got_same), db(direct));
        if (screen == CLEAR) {
            clear_across = got_across;
            clear_same = got_same;
        }
        assert_true(got_across == 0.0 || screen == CLEAR);
        if (screen == SQUARE_TO_SONAR) { /* over the wall both ways it is still seen */
            assert_close_relative(got_same, clear_same, 1e-6);
            assert_true(direct == 0.0);
        } else {
            assert_int_equal(got_same > 0.0, screen == CLEAR);
            assert_true(direct > 0.0);
        }
        asdic_ping_destroy(&ping);
        target_rig_destroy(&r);
    }
    assert_true(clear_across > 0.0 && clear_same > 0.0);
}

/* Off leaves every other component as it was. */
static void off_is_off(void **state) {
    (void)state;
    asdic_ping *pings[2];
    for (int on = 0; on < 2; on++) {
        target_rig r = wall_and_square();
        r.sampling.multipath = on ? ASDIC_MULTIPATH_FIRST : ASDIC_MULTIPATH_OFF;
        pings[on] = shoot(&r);
        target_rig_destroy(&r);
    }
    size_t bytes = pings[0]->bins * sizeof(double);
    assert_true(energy(pings[0], ASDIC_MULTIPATH, 0.0, INFINITY) == 0.0);
    assert_true(energy(pings[1], ASDIC_MULTIPATH, 0.0, INFINITY) > 0.0);
    assert_memory_equal(pings[0]->intensity_lin[ASDIC_OBJECT],
                        pings[1]->intensity_lin[ASDIC_OBJECT], bytes);
    assert_memory_equal(pings[0]->intensity_lin[ASDIC_VOLUME],
                        pings[1]->intensity_lin[ASDIC_VOLUME], bytes);
    asdic_ping_destroy(&pings[0]);
    asdic_ping_destroy(&pings[1]);
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(both_paths_meet_an_integration),
        cmocka_unit_test(every_leg_can_be_hidden),
        cmocka_unit_test(off_is_off),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
