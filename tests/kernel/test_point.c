/* Point targets: the sonar equation to the last digits, and what hides them. */
#include "ping_rig.h"

#include "kernels/beam.h"
#include "kernels/mirror.h"

static test_device t;

/* SL - TL + TS and both beams at RANGE_M, bearing AZIMUTH and elevation DOWN of the bow; each leaks behind its face. */
static double expected_db(const ping_rig *r, int beam, double range_m, double azimuth_rad,
                          double down_rad, double strength_db) {
    double alpha = asdic_environment_absorption_db_per_km(&r->env, r->sonar.frequency_hz, 7.0);
    double c_mps = asdic_environment_sound_speed_mps(&r->env, 7.0);
    double per_m = r->sonar.frequency_hz / c_mps, gain = 1.0;
    for (int way = 0; way < 2; way++) {
        const asdic_beam *face = way ? &r->receivers[beam] : &r->sonar.transmitter;
        double pitch = face->pitch_rad;
        double x = cos(down_rad) * cos(azimuth_rad), z = sin(down_rad);
        gain *= beam_pattern_lin(x * cos(pitch) + z * sin(pitch), cos(down_rad) * sin(azimuth_rad),
                                 z * cos(pitch) - x * sin(pitch), face->length_h_m * per_m,
                                 face->length_v_m * per_m, pow(10.0, 0.1 * r->sonar.rear_floor_db));
    }
    return r->sonar.source_level_db + strength_db + 10.0 * log10(gain) - 40.0 * log10(range_m) -
           2.0 * (range_m - 1.0) * alpha / 1000.0;
}

static ping_rig empty_sea(void) {
    ping_rig r = rig_create(&t);
    r.env.particle_strength_db = -200.0;
    r.sampling.rays = 1024;
    rig_empty(&r);
    asdic_scene_set_surface(r.scene, false);
    return r;
}

static asdic_vec3 place(double range_m, double azimuth_rad, double down_rad) {
    return (asdic_vec3){range_m * cos(down_rad) * cos(azimuth_rad),
                        range_m * cos(down_rad) * sin(azimuth_rad), 7.0 + range_m * sin(down_rad)};
}

static double level_db(const asdic_ping *ping, int beam, double range_m) {
    size_t bin = (size_t)(range_m / ping->bin_length_m);
    return asdic_level_db(ping->intensity_lin[ASDIC_OBJECT][beam * ping->bins + bin]);
}

static void points_meet_the_sonar_equation(void **state) {
    (void)state;
    static const struct {
        double range_m, azimuth_deg, down_deg, strength_db;
    } points[] = {{0.8, 0, 0, -42.3},   {12.26, 0, 0, -42.3},   {30.1, 10, -5, 3.0},
                  {55.2, -25, 20, -20}, {70.7, 60, -40, -60.0}, {74.3, 1, 1, 100.0},
                  {20.3, 151, 7, 10},   {45.4, -117, -3, 20}}; /* the last two behind the faces */
    enum { COUNT = sizeof points / sizeof *points };
    ping_rig r = empty_sea();
    r.sonar.source_level_db = 200.0;
    r.sonar.rear_floor_db = -20.0;
    r.sonar.transmitter.length_h_m = 0.013; /* as no receiver is */
    r.sonar.transmitter.length_v_m = 0.021;
    r.sonar.transmitter.pitch_rad = -0.07;
    for (int i = 0; i < COUNT; i++) {
        assert_ok(t.ctx,
                  asdic_scene_add_point(r.scene, "sphere",
                                        place(points[i].range_m, points[i].azimuth_deg * RIG_DEGREE,
                                              points[i].down_deg * RIG_DEGREE),
                                        points[i].strength_db));
    }
    asdic_ping *ping = rig_shoot(&r, 3, true);
    double most = 0.0;
    for (int beam = 0; beam < RIG_BEAMS; beam++) {
        for (int i = 0; i < COUNT; i++) {
            double expected =
                expected_db(&r, beam, points[i].range_m, points[i].azimuth_deg * RIG_DEGREE,
                            points[i].down_deg * RIG_DEGREE, points[i].strength_db);
            most = fmax(most, fabs(level_db(ping, beam, points[i].range_m) - expected));
        }
    }
    print_message("off by %.2g dB at most\n", most);
    assert_true(most < 1e-4); /* beyond the main lobe a face's rounded axes count */
    /* Nothing else is in the object component, and the total holds it. */
    double sum = 0.0, object = 0.0;
    for (size_t n = 0; n < ping->bins; n++) {
        sum += ping->intensity_lin[ASDIC_OBJECT][n] > 0.0;
        object += ping->intensity_lin[ASDIC_TOTAL][n] - ping->intensity_lin[ASDIC_OBJECT][n] -
                  ping->intensity_lin[ASDIC_VOLUME][n];
    }
    assert_true(sum == COUNT);
    assert_true(fabs(object) < 1e-12 * ping->intensity_lin[ASDIC_TOTAL][148]);
    asdic_ping_destroy(&ping);
    rig_destroy(&r);
}

/* A pulse of 10 bins: the level in each that it reaches is a tenth of the sonar equation's, SL - TL + TS - 10 log 10, to
 * the range's last and from the blanking's first. */
static void pulses_are_cut_at_both_ends(void **state) {
    (void)state;
    static const double ranges_m[] = {6.26, 40.26, 73.26};
    ping_rig r = empty_sea();
    r.sonar.source_level_db = 200.0;
    r.sonar.blanking_m = 5.0;
    r.sonar.bandwidth_hz = asdic_environment_sound_speed_mps(&r.env, 7.0) / (2.0 * 5.0);
    for (int i = 0; i < 3; i++) {
        assert_ok(t.ctx, asdic_scene_add_point(r.scene, "sphere", place(ranges_m[i], 0, 0), -30.0));
    }
    asdic_ping *ping = rig_shoot(&r, 3, true);
    for (int i = 0; i < 3; i++) {
        int at = (int)(ranges_m[i] / 0.5);
        double whole_db = expected_db(&r, 0, ranges_m[i], 0.0, 0.0, -30.0);
        for (int n = at - 6; n <= at + 6 && n < (int)ping->bins; n++) {
            int off = abs(n - at);
            double part = n < 10 || off > 5 ? 0.0 : off == 5 ? 0.05 : 0.1; /* from 5 m on */
            double level = asdic_level_db(ping->intensity_lin[ASDIC_OBJECT][n]);
            if (part > 0.0) {
                assert_close(level, whole_db + 10.0 * log10(part), 1e-4);
            } else {
                assert_true(ping->intensity_lin[ASDIC_OBJECT][n] == 0.0);
            }
        }
    }
    assert_int_equal(ping->bins, 149); /* so that the last is cut, too: its bin is 146 */
    asdic_ping_destroy(&ping);
    rig_destroy(&r);
}

/* Of pulses of ten bins, echoes of points and of their mirror images are in each bin what they are of a longer range: from
 * just before its end, and from beyond. */
static void the_range_s_end_changes_no_echo(void **state) {
    (void)state;
    static const double across_m[] = {26.6, 27.2, 28.9, 30.0};
    for (int i = 0; i < 4; i++) {
        asdic_ping *pings[2];
        for (int longer = 0; longer < 2; longer++) {
            ping_rig r = empty_sea();
            asdic_scene_set_surface(r.scene, true);
            r.env.wind_speed_kn = 0.0;
            r.sampling.multipath = ASDIC_MULTIPATH_BOUNDARIES;
            r.sonar.max_range_m = longer ? 40.0 : 29.0;
            r.sonar.bandwidth_hz = asdic_environment_sound_speed_mps(&r.env, 7.0) / (2.0 * 5.0);
            assert_ok(t.ctx, asdic_scene_add_point(r.scene, "sphere",
                                                   (asdic_vec3){across_m[i], 0.0, 4.0}, 30.0));
            pings[longer] = rig_shoot(&r, 3, true);
            rig_destroy(&r);
        }
        assert_int_equal(pings[0]->bins, 58);
        for (int k = 0; k < 2; k++) {
            double most = 0.0;
            asdic_component c = k ? ASDIC_MULTIPATH : ASDIC_OBJECT;
            for (size_t n = 0; n < 58; n++) {
                double echo = pings[1]->intensity_lin[c][n];
                most = fmax(most, echo);
                assert_close(pings[0]->intensity_lin[c][n], echo, 1e-3 * most);
            }
            assert_true(pings[1]->intensity_lin[c][57] > 0.1 * most);
        }
        asdic_ping_destroy(&pings[0]);
        asdic_ping_destroy(&pings[1]);
    }
}

/* A pulse begins before the blanking's end, or ends behind it: what is behind is heard, and what is before is not, not even
 * in a bin whose end is the blanking's within rounding. */
static void the_blanking_cuts_pulses_alone(void **state) {
    (void)state;
    static const double blanking_m[] = {2.3, 0.7, 0.6, 1.2};
    for (int i = 0; i < 4; i++) {
        asdic_ping *pings[2];
        for (int early = 0; early < 2; early++) {
            ping_rig r = empty_sea();
            r.sonar.max_range_m = 4.0;
            r.sonar.bin_length_m = 0.1;
            r.sonar.blanking_m = early ? 0.1 : blanking_m[i];
            r.sonar.bandwidth_hz = asdic_environment_sound_speed_mps(&r.env, 7.0) / (2.0 * 0.51);
            for (int side = -1; side <= 1; side += 2) {
                double range_m = blanking_m[i] + 0.15 * side;
                assert_ok(t.ctx, asdic_scene_add_point(r.scene, "sphere", place(range_m, 0.0, 0.0),
                                                       -30.0));
            }
            pings[early] = rig_shoot(&r, 3, true);
            rig_destroy(&r);
        }
        size_t deaf = (size_t)(blanking_m[i] / 0.1 + 0.5);
        for (size_t n = 0; n < pings[0]->bins; n++) {
            double echo = n < deaf ? 0.0 : pings[1]->intensity_lin[ASDIC_OBJECT][n];
            assert_close(pings[0]->intensity_lin[ASDIC_OBJECT][n], echo, 1e-9 * echo);
            assert_true(n >= deaf || pings[0]->intensity_lin[ASDIC_TOTAL][n] == 0.0);
        }
        assert_true(pings[0]->intensity_lin[ASDIC_OBJECT][deaf] > 0.0);
        asdic_ping_destroy(&pings[0]);
        asdic_ping_destroy(&pings[1]);
    }
}

/* The same bytes for every ping, seed and number of rays. */
static void points_have_no_sampling_error(void **state) {
    (void)state;
    ping_rig r = empty_sea();
    assert_ok(t.ctx, asdic_scene_add_point(r.scene, "sphere", place(20.2, 0, 0), -30.0));
    asdic_ping *a = rig_shoot(&r, 3, true);
    r.sampling.seed = 99;
    r.sampling.rays = 4096;
    asdic_ping *b = rig_shoot(&r, 4, false);
    assert_memory_equal(a->intensity_lin[ASDIC_OBJECT], b->intensity_lin[ASDIC_OBJECT],
                        a->beams * a->bins * sizeof(double));
    /* The water's own error hardly counts beside the point. */
    assert_true(a->intensity_lin[ASDIC_OBJECT][40] > 0.0);
    assert_true(a->stderr_db[40] < 1e-6f);
    asdic_ping_destroy(&a);
    asdic_ping_destroy(&b);
    rig_destroy(&r);
}

/* Each of these hides the point; without it the point is heard. */
static void points_are_hidden(void **state) {
    (void)state;
    enum { NOTHING, BOX, FLOOR, FLOOR_MESH, SURFACE, BLANKING, RANGE, BEHIND, CASES };
    for (int what = NOTHING; what < CASES; what++) {
        ping_rig r = empty_sea();
        double range_m = what == BLANKING ? 0.4 : what == RANGE ? 74.6 : 20.2;
        asdic_vec3 at = place(range_m, what == BEHIND ? 3.1 : 0.0, 0.0);
        asdic_mesh *mesh = NULL;
        asdic_pose pose = {.position_m = {10.0, 0.0, 7.0}};
        if (what == BOX) {
            assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){0.1, 1.0, 1.0}, &mesh));
            assert_ok(t.ctx, asdic_scene_add_object(r.scene, "box", mesh, pose,
                                                    asdic_material_bottom(2.0)));
        } else if (what == FLOOR) { /* a point in the mud under a sonar above it */
            at.z = 12.5;
            assert_ok(t.ctx,
                      asdic_scene_set_bottom_plane(r.scene, 12.0, asdic_material_bottom(2.0)));
        } else if (what == FLOOR_MESH) {
            pose.pitch_rad = 90 * RIG_DEGREE;
            pose.position_m.z = 12.0;
            at.z = 14.0;
            at.x = 12.0;
            assert_ok(t.ctx, asdic_mesh_plate(t.ctx, 40.0, 40.0, &mesh));
            assert_ok(t.ctx,
                      asdic_scene_add_bottom(r.scene, mesh, pose, asdic_material_bottom(2.0)));
        } else if (what == SURFACE) {
            asdic_scene_set_surface(r.scene, true);
            at.z = -1.0;
        }
        assert_ok(t.ctx, asdic_scene_add_point(r.scene, "sphere", at, 10.0));
        asdic_ping *ping = rig_shoot(&r, 0, false);
        double heard = 0.0;
        for (size_t n = 0; n < ping->bins; n++) {
            /* A box is heard itself, but not where the point is. */
            heard += what == BOX && n < 30 ? 0.0 : ping->intensity_lin[ASDIC_OBJECT][n];
        }
        assert_int_equal(heard > 0.0, what == NOTHING);
        asdic_ping_destroy(&ping);
        asdic_mesh_destroy(&mesh);
        rig_destroy(&r);
    }
}

/* What a point sends back with BOUNDARIES as mirrors, less what comes without it; [bin] of the first beam. */
static double *echoes_of(asdic_vec3 at, double wind_kn, asdic_component c, size_t *bins) {
    double *sum = NULL;
    for (int with = 0; with < 2; with++) {
        ping_rig r = rig_create(&t);
        r.env.wind_speed_kn = wind_kn;
        r.sampling.rays = 1024;
        r.sampling.multipath = ASDIC_MULTIPATH_BOUNDARIES;
        r.sonar.receiver_count = 1;
        r.sonar.transmitter.length_h_m = r.sonar.transmitter.length_v_m = 1e-4;
        r.receivers[0] = r.sonar.transmitter;
        if (with) {
            assert_ok(t.ctx, asdic_scene_add_point(r.scene, "sphere", at, -10.0));
        }
        asdic_ping *ping = rig_shoot(&r, 3, false);
        sum = sum ? sum : calloc(ping->bins, sizeof *sum);
        *bins = ping->bins;
        for (size_t n = 0; n < ping->bins; n++) {
            sum[n] += (with ? 1.0 : -1.0) * ping->intensity_lin[c][n];
        }
        asdic_ping_destroy(&ping);
        rig_destroy(&r);
    }
    return sum;
}

/* Out by each of three ways and back by each: straight, and by way of the point's images. */
static void points_are_heard_over_mirrors(void **state) {
    (void)state;
    static const asdic_vec3 at[] = {{14.0, 3.0, 4.0}, {20.0, -9.0, 10.5}, {3.0, 0.0, 11.0}};
    for (size_t k = 0; k < sizeof at / sizeof *at; k++) {
        const double wind_kn = 2.0 + 0.5 * (double)k;
        ping_rig r = rig_create(&t);
        double c_mps = asdic_environment_sound_speed_mps(&r.env, 7.0);
        double alpha = asdic_environment_absorption_db_per_km(&r.env, r.sonar.frequency_hz, 7.0);
        double lambda = c_mps / r.sonar.frequency_hz, across = hypot(at[k].x, at[k].y);
        const double image_z[3] = {at[k].z, -at[k].z, 24.0 - at[k].z};
        const double rms_m[3] = {0.0, sea_height_rms_m(wind_kn), 0.008};
        double range[3], way_lin[3];
        for (int w = 0; w < 3; w++) {
            range[w] = hypot(across, image_z[w] - 7.0);
            double s = fabs(image_z[w] - 7.0) / range[w];
            double smooth = w == 2 ? fluid_reflection2(s, 1.9, 1.0 / 1.1) : 1.0;
            double g = pow(4.0 * 3.14159265358979 / lambda * rms_m[w] * s, 2.0);
            way_lin[w] = smooth * exp(-g) * pow(range[w], -2.0) *
                         pow(10.0, -0.1 * alpha * (range[w] - 1.0) / 1000.0);
        }
        double worst = 0.0;
        for (int by_mirror = 0; by_mirror < 2; by_mirror++) {
            size_t bins;
            double *got =
                echoes_of(at[k], wind_kn, by_mirror ? ASDIC_MULTIPATH : ASDIC_OBJECT, &bins);
            double *want = calloc(bins, sizeof *want), most = 0.0;
            for (int pair = 0; pair < 9; pair++) {
                int out = pair / 3, home = pair % 3;
                size_t bin = (size_t)(0.5 * (range[out] + range[home]) / r.sonar.bin_length_m);
                if ((pair > 0) == by_mirror && bin < bins) {
                    want[bin] += 0.1 * way_lin[out] * way_lin[home];
                }
            }
            for (size_t n = 0; n < bins; n++) {
                most = fmax(most, want[n]);
            }
            for (size_t n = 0; n < bins; n++) {
                if (want[n] > 1e-6 * most) {
                    worst = fmax(worst, fabs(10.0 * log10(fmax(got[n], 1e-300) / want[n])));
                } else {
                    assert_true(fabs(got[n]) < 1e-5 * most);
                }
            }
            assert_true(most > 0.0);
            free(got);
            free(want);
        }
        print_message("a point over mirrors: off by %.2g dB at most\n", worst);
        assert_true(worst < 1e-3);
        rig_destroy(&r);
    }
}

/* A box at the surface stands in the way by the mirror, not in the straight one. */
static void check_hidden(const asdic_sound_profile *cast, double gradient_per_s) {
    double sums[2][2] = {{0.0}};
    for (int hidden = 0; hidden < 2; hidden++) {
        for (int with = 0; with < 2; with++) {
            ping_rig r = empty_sea();
            r.env.sound_speed_profile = *cast;
            r.env.sound_speed_gradient_per_s = gradient_per_s;
            asdic_mesh *mesh = NULL;
            asdic_pose pose = {.position_m = {10.0, 0.0, hidden ? 1.0 : 30.0}};
            asdic_scene_set_surface(r.scene, true);
            r.sampling.multipath = ASDIC_MULTIPATH_BOUNDARIES;
            r.env.wind_speed_kn = 0.0;
            r.sonar.receiver_count = 1;
            r.sonar.transmitter.length_h_m = r.sonar.transmitter.length_v_m = 1e-4;
            r.receivers[0] = r.sonar.transmitter;
            assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){0.2, 4.0, 3.0}, &mesh));
            assert_ok(t.ctx, asdic_scene_add_object(r.scene, "box", mesh, pose,
                                                    asdic_material_bottom(2.0)));
            if (with) {
                assert_ok(t.ctx, asdic_scene_add_point(r.scene, "sphere",
                                                       (asdic_vec3){20.0, 0.0, 7.0}, 30.0));
            }
            asdic_ping *ping = rig_shoot(&r, 3, false);
            for (size_t n = 0; n < ping->bins; n++) {
                double sign = with ? 1.0 : -1.0;
                sums[hidden][0] += sign * ping->intensity_lin[ASDIC_OBJECT][n];
                sums[hidden][1] += sign * ping->intensity_lin[ASDIC_MULTIPATH][n];
            }
            asdic_ping_destroy(&ping);
            asdic_mesh_destroy(&mesh);
            rig_destroy(&r);
        }
    }
    print_message("by the mirror %.3g and %.3g of the straight echo\n", sums[0][1] / sums[0][0],
                  sums[1][1] / sums[0][0]);
    assert_close(sums[1][0] / sums[0][0], 1.0, 1e-6);
    assert_true(sums[0][1] > 0.1 * sums[0][0] && fabs(sums[1][1]) < 1e-9 * sums[0][0]);
}

/* In still water, in one layer and in three. */
static void mirror_ways_are_hidden(void **state) {
    static const asdic_sound_profile none = {0},
                                     cast = {4, {0, 3, 9, 40}, {1482.0, 1480.0, 1476.0, 1475.0}};
    (void)state;
    check_hidden(&none, 0.0);
    check_hidden(&none, -0.6);
    check_hidden(&cast, 0.0);
}

static void wrong_points_are_refused(void **state) {
    (void)state;
    ping_rig r = empty_sea();
    asdic_vec3 at = {1.0, 2.0, 3.0};
    assert_status(t.ctx, asdic_scene_add_point(r.scene, "", at, 0.0), ASDIC_ERROR_ARGUMENT);
    assert_status(t.ctx, asdic_scene_add_point(r.scene, "x", at, 101.0), ASDIC_ERROR_ARGUMENT);
    assert_status(t.ctx, asdic_scene_add_point(r.scene, "x", at, NAN), ASDIC_ERROR_ARGUMENT);
    at.y = INFINITY;
    assert_status(t.ctx, asdic_scene_add_point(r.scene, "x", at, 0.0), ASDIC_ERROR_ARGUMENT);
    assert_ok(t.ctx, asdic_scene_commit(r.scene));
    at.y = 0.0;
    assert_status(t.ctx, asdic_scene_add_point(r.scene, "x", at, 0.0), ASDIC_ERROR_ARGUMENT);
    assert_contains(asdic_context_error(t.ctx), "committed");
    rig_destroy(&r);
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_meet_the_sonar_equation),
        cmocka_unit_test(pulses_are_cut_at_both_ends),
        cmocka_unit_test(the_range_s_end_changes_no_echo),
        cmocka_unit_test(the_blanking_cuts_pulses_alone),
        cmocka_unit_test(points_have_no_sampling_error),
        cmocka_unit_test(points_are_hidden),
        cmocka_unit_test(points_are_heard_over_mirrors),
        cmocka_unit_test(mirror_ways_are_hidden),
        cmocka_unit_test(wrong_points_are_refused),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
