/*
 * Point targets in water that bends rays: echoes beside closed forms and beside Runge-Kutta steps, and what hides
 * them.
 */
#include "bent_rig.h"

#include "kernels/mirror.h"
#include "layer_steps.h"
#include "one_layer.h"

#define PI 3.14159265358979

/* A point's echo against the closed forms by the ends of a ray (lift.h), which no ping takes. */
static void points_echo_over_the_arc(void **state) {
    (void)state;
    for (int k = 0; k < 6; k++) {
        const double g = k % 2 ? 0.9 : -0.9;
        ping_rig r = bent_rig(g, 1024u);
        const asdic_vec3 at = {25.0 + 8.0 * k, 4.0 * k, 2.0 + 1.5 * k};
        r.sonar.transmitter.length_h_m = r.sonar.transmitter.length_v_m = 1e-4;
        r.receivers[0] = r.sonar.transmitter;
        assert_ok(t.ctx, asdic_scene_add_point(r.scene, "point", at, 10.0));
        asdic_ping *ping = rig_shoot(&r, 0, false);
        double c0 = asdic_environment_sound_speed_mps(&r.env, r.pose.position_m.z), bend = g / c0;
        triple apart = {at.x, at.y, at.z - r.pose.position_m.z};
        double d = sqrt(dot3(apart, apart)), n1 = 1.0 + bend * apart.z;
        double range = lift_time(bend, d, 1.0, n1), spread = lift_spread(bend, d, 1.0, n1);
        /* Horizontal part of the direction, from that of the lifted ray, which is straight. */
        triple lifted = lift_point(bend, apart);
        double level = hypot(lifted.x, lifted.y) / sqrt(dot3(lifted, lifted));
        double alpha = asdic_environment_absorption_db_per_km(&r.env, r.sonar.frequency_hz,
                                                              r.pose.position_m.z);
        double db = 10.0 - 40.0 * log10(spread) -
                    2.0 * (lift_length(bend, d, 1.0, level) - 1.0) * alpha * 1e-3;
        size_t bin = (size_t)(range / r.sonar.bin_length_m);
        assert_close(asdic_level_db(ping->intensity_lin[ASDIC_OBJECT][bin]), db, 5e-4);
        asdic_ping_destroy(&ping);
        rig_destroy(&r);
    }
}

/* In water that hardly bends, points at the sonar's own depth, on the bottom, in the surface and on a layer's
 * plane are heard as in water that does not. */
static void points_lie_on_planes(void **state) {
    static const asdic_vec3 at[] = {{14.0, 0.0, 7.0}, {9.0, -11.0, 7.0}, {14.0, 0.0, 12.0},
                                    {14.0, 3.0, 0.0}, {8.0, 2.0, 9.0},   {3.0, 0.0, 10.0},
                                    {20.0, 0.0, 12.0}};
    (void)state;
    for (size_t k = 0; k < sizeof at / sizeof *at; k++) {
        double db[2];
        for (int layered = 0; layered < 2; layered++) {
            ping_rig r = bent_rig(0.0, 256u);
            r.sonar.transmitter.length_h_m = r.sonar.transmitter.length_v_m = 1e-4;
            r.receivers[0] = r.sonar.transmitter;
            r.env.sound_speed_mps = layered ? NAN : 1500.0;
            if (layered) {
                r.env.sound_speed_profile =
                    (asdic_sound_profile){3, {0.0, 9.0, 12.0}, {1500.0, 1500.0, 1499.99}};
            }
            assert_ok(t.ctx, asdic_scene_add_point(r.scene, "point", at[k], 10.0));
            asdic_ping *ping = rig_shoot(&r, 0, false);
            double sum = 0.0;
            for (size_t n = 0; n < ping->bins; n++) {
                sum += ping->intensity_lin[ASDIC_OBJECT][n];
            }
            db[layered] = asdic_level_db(sum);
            asdic_ping_destroy(&ping);
            rig_destroy(&r);
        }
        assert_close(db[1], db[0], 0.01);
    }
}

/* Casts in which one ray or several go to a point: out by each and back by each, against Runge-Kutta steps. */
static void points_echo_through_layers(void **state) {
    static const struct {
        const char *name;
        asdic_sound_profile cast;
        double from_m, to_m, across_m;
    } cases[] = {
        {"thermocline", {4, {0.0, 5.0, 9.0, 12.0}, {1482.0, 1480.0, 1471.0, 1470.0}}, 7.0, 4.0, 31},
        {"foot", {4, {0.0, 4.0, 7.0, 20.0}, {1490.0, 1489.0, 1455.0, 1456.0}}, 7.5, 6.9, 44},
        {"knee", {3, {0.0, 8.0, 60.0}, {1495.0, 1495.0, 1443.0}}, 8.0, 11.0, 45},
        {"channel", {4, {0.0, 3.0, 7.0, 12.0}, {1500.0, 1490.0, 1480.0, 1486.0}}, 6.0, 8.0, 62},
        {"axis", {4, {0.0, 3.0, 7.0, 12.0}, {1500.0, 1490.0, 1480.0, 1486.0}}, 7.0, 6.9, 68}};
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        ping_rig r = bent_rig(0.0, 1024u);
        double across = cases[k].across_m, worst = 0.0;
        asdic_vec3 at = {0.8 * across, 0.6 * across, cases[k].to_m};
        stepped_ray rays[8];
        r.env.sound_speed_profile = cases[k].cast;
        r.pose.position_m.z = cases[k].from_m;
        r.sonar.transmitter.length_h_m = r.sonar.transmitter.length_v_m = 1e-4;
        r.receivers[0] = r.sonar.transmitter;
        if (k % 2) {
            asdic_scene_destroy(&r.scene);
            r.scene = bottom_of_two_triangles();
        }
        assert_ok(t.ctx, asdic_scene_add_point(r.scene, "point", at, 10.0));
        asdic_ping *ping = rig_shoot(&r, 0, false);
        int count = stepped_rays(&r.env, cases[k].from_m, cases[k].to_m, across, rays, 8);
        double *level = calloc(ping->bins, sizeof *level);
        double c0 = speed_of(&r.env, cases[k].from_m);
        double alpha = asdic_environment_absorption_db_per_km(&r.env, r.sonar.frequency_hz,
                                                              r.pose.position_m.z);
        for (int i = 0; i < count * count; i++) {
            const stepped_ray *a = &rays[i / count], *b = &rays[i % count];
            double held_a = 1e-2 * pow(c0 * a->time_s, 2.0),
                   held_b = 1e-2 * pow(c0 * b->time_s, 2.0);
            double length = 0.5 * (a->length_m + b->length_m);
            double db = 10.0 - 10.0 * log10(fmax(a->spread_m2, held_a)) -
                        10.0 * log10(fmax(b->spread_m2, held_b)) - 2e-3 * alpha * (length - 1.0);
            size_t bin = (size_t)(0.5 * c0 * (a->time_s + b->time_s) / r.sonar.bin_length_m);
            level[bin] += pow(10.0, 0.1 * db);
        }
        for (size_t n = 0; n < ping->bins; n++) {
            double got = ping->intensity_lin[ASDIC_OBJECT][n];
            assert_true((got > 0.0) == (level[n] > 0.0));
            worst = fmax(worst, got > 0.0 ? fabs(10.0 * log10(got / level[n])) : 0.0);
        }
        print_message("%s: %d rays to the point, %.2g dB\n", cases[k].name, count, worst);
        assert_true(count > 0 && worst < 2e-3);
        free(level);
        asdic_ping_destroy(&ping);
        rig_destroy(&r);
    }
}

/* CAST, of which the last point lies DEPTH deep, and below it its image; UPSIDE_DOWN: of the cast turned over, so that
 * what the surface mirrors is seen. */
static asdic_sound_profile unfolded(const asdic_sound_profile *cast, bool upside_down) {
    asdic_sound_profile out = {2 * cast->points - 1, {0}, {0}};
    for (size_t i = 0; i < cast->points; i++) {
        size_t from = upside_down ? cast->points - 1 - i : i;
        double z = upside_down ? DEPTH - cast->depth_m[from] : cast->depth_m[from];
        out.depth_m[i] = z;
        out.depth_m[out.points - 1 - i] = 2.0 * DEPTH - z;
        out.sound_speed_mps[i] = out.sound_speed_mps[out.points - 1 - i] =
            cast->sound_speed_mps[from];
    }
    return out;
}

/* The ray by way of the surface (1), the bottom (2) or neither (0), which is the only one, and the share of its energy
 * that comes by. */
static stepped_ray only_ray(const asdic_environment *env, int by, double from_m, double to_m,
                            double across_m, double lambda_m, double *share) {
    asdic_environment water = *env;
    stepped_ray rays[8];
    if (by > 0) {
        water.sound_speed_profile = unfolded(&env->sound_speed_profile, by == 1);
    }
    double from = by == 1 ? DEPTH - from_m : from_m;
    double to = by == 1 ? DEPTH + to_m : by == 2 ? 2.0 * DEPTH - to_m : to_m;
    assert_int_equal(stepped_rays(&water, from, to, across_m, rays, 8), 1);
    double cosine = cos(rays[0].elevation) * speed_of(&water, DEPTH) / speed_of(&water, from);
    double s = sqrt(1.0 - cosine * cosine), rms_m = by == 1 ? sea_height_rms_m(1.0) : 0.008;
    double g = pow(4.0 * 3.14159265358979 / lambda_m * rms_m * s, 2.0);
    *share = by == 0 ? 1.0 : exp(-g) * (by == 2 ? fluid_reflection2(s, 1.9, 1.0 / 1.1) : 1.0);
    return rays[0];
}

/* Boundaries as mirrors of water that bends rays, in one layer and in three. */
static void points_are_heard_over_mirrors(void **state) {
    static const struct {
        asdic_sound_profile cast;
        double to_m, across_m;
    } cases[] = {{{2, {0.0, DEPTH}, {1480.0, 1471.6}}, 9.0, 27.3},
                 {{4, {0.0, 5.0, 9.0, DEPTH}, {1482.0, 1480.0, 1471.0, 1470.0}}, 8.0, 25.2}};
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        double *got[2] = {NULL, NULL}, worst = 0.0;
        size_t bins = 0;
        ping_rig r = {0};
        for (int with = 0; with < 2; with++) {
            r = bent_rig(0.0, 1024u);
            r.env.wind_speed_kn = 1.0;
            r.sampling.multipath = ASDIC_MULTIPATH_BOUNDARIES;
            r.sonar.transmitter.length_h_m = r.sonar.transmitter.length_v_m = 1e-4;
            r.receivers[0] = r.sonar.transmitter;
            const double *speed = cases[k].cast.sound_speed_mps;
            r.env.sound_speed_mps = speed[0];
            r.env.sound_speed_gradient_per_s =
                cases[k].cast.points == 2 ? (speed[1] - speed[0]) / DEPTH : 0.0;
            if (cases[k].cast.points > 2) {
                r.env.sound_speed_profile = cases[k].cast;
            }
            if (with) {
                assert_ok(t.ctx, asdic_scene_add_point(r.scene, "point",
                                                       (asdic_vec3){0.6 * cases[k].across_m,
                                                                    0.8 * cases[k].across_m,
                                                                    cases[k].to_m},
                                                       10.0));
            }
            asdic_ping *ping = rig_shoot(&r, 0, false);
            bins = ping->bins;
            for (int c = 0; c < 2; c++) {
                got[c] = got[c] ? got[c] : calloc(bins, sizeof *got[c]);
                for (size_t n = 0; n < bins; n++) {
                    got[c][n] += (with ? 1.0 : -1.0) *
                                 ping->intensity_lin[c ? ASDIC_MULTIPATH : ASDIC_OBJECT][n];
                }
            }
            asdic_ping_destroy(&ping);
            rig_destroy(&r);
        }
        const double from_m = r.pose.position_m.z;
        r.env.sound_speed_profile = cases[k].cast; /* for steps */
        double c0 = speed_of(&r.env, from_m), lambda = c0 / r.sonar.frequency_hz, share[3];
        double alpha = asdic_environment_absorption_db_per_km(&r.env, r.sonar.frequency_hz, from_m);
        double *want[2] = {calloc(bins, sizeof **want), calloc(bins, sizeof **want)};
        stepped_ray way[3];
        for (int by = 0; by < 3; by++) {
            way[by] =
                only_ray(&r.env, by, from_m, cases[k].to_m, cases[k].across_m, lambda, &share[by]);
        }
        for (int pair = 0; pair < 9; pair++) {
            int out = pair / 3, home = pair % 3;
            const stepped_ray *a = &way[out], *b = &way[home];
            double length = 0.5 * (a->length_m + b->length_m);
            size_t bin = (size_t)(0.5 * c0 * (a->time_s + b->time_s) / r.sonar.bin_length_m);
            want[pair > 0][bin] += 10.0 * share[out] * share[home] / (a->spread_m2 * b->spread_m2) *
                                   pow(10.0, -0.2e-3 * alpha * (length - 1.0));
        }
        for (size_t i = 0; i < 2 * bins; i++) {
            double w = want[i / bins][i % bins], g = got[i / bins][i % bins];
            assert_true(w > 0.0 || fabs(g) < 1e-12);
            worst = fmax(worst, w > 1e-9 ? fabs(10.0 * log10(fmax(g, 1e-300) / w)) : 0.0);
        }
        print_message("over mirrors: shares %.3g and %.3g, %.2g dB\n", share[1], share[2], worst);
        assert_true(worst < 5e-3);
        for (int c = 0; c < 2; c++) {
            free(got[c]);
            free(want[c]);
        }
    }
}

/* Where rays cross, the gain of each way is held to 20 dB over straight spreading: an echo by one ray there and back
 * stays within 40 dB, and those of all pairs of six rays within 36 times that. */
static void caustics_are_held(void **state) {
    (void)state;
    ping_rig r = bent_rig(0.0, 1024u);
    asdic_ping *ping = NULL;
    double most_db = -INFINITY;
    r.pose.position_m.z = 7.5;
    r.env.sound_speed_profile =
        (asdic_sound_profile){4, {0.0, 3.0, 7.0, 12.0}, {1500.0, 1490.0, 1480.0, 1486.0}};
    r.sonar.transmitter.length_h_m = r.sonar.transmitter.length_v_m = 1e-4;
    r.receivers[0] = r.sonar.transmitter;
    assert_ok(t.ctx, asdic_scene_add_point(r.scene, "point", (asdic_vec3){10.0, 0.0, 7.0}, 0.0));
    asdic_simulator *sim = rig_simulator(&r);
    assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, asdic_simulator_bin_count(sim), &ping));
    double alpha =
        asdic_environment_absorption_db_per_km(&r.env, r.sonar.frequency_hz, r.pose.position_m.z);
    for (int i = 0; i < 60; i++) {
        double x = 10.0 + i, sum = 0.0;
        asdic_pose at = {.position_m = {x, 0.0, 7.0}};
        assert_ok(t.ctx, asdic_simulator_move(sim, "point", &at));
        assert_ok(t.ctx, asdic_simulator_ping(sim, &r.pose, 0, ping));
        for (size_t n = 0; n < ping->bins; n++) {
            sum += ping->intensity_lin[ASDIC_OBJECT][n];
        }
        assert_true(isfinite(sum) && sum > 0.0);
        double straight_db = -40.0 * log10(x) - 2e-3 * alpha * (x - 1.0);
        most_db = fmax(most_db, 10.0 * log10(sum) - straight_db);
    }
    print_message("a point along a channel: at most %.1f dB above straight spreading\n", most_db);
    assert_true(most_db > 10.0 && most_db < 40.0 + 10.0 * log10(36.0));
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

/* The sum of a matte ball's echoes, of four pings. */
static double ball_lin(const asdic_sound_profile *cast, asdic_vec3 at, double radius_m) {
    ping_rig r = bent_rig(0.0, 16384u);
    asdic_mesh *mesh = NULL;
    double sum = 0.0;
    r.env.sound_speed_mps = cast ? NAN : 1480.0;
    if (cast) {
        r.env.sound_speed_profile = *cast;
    }
    r.pose.position_m.z = at.z;
    r.sonar.transmitter.length_h_m = r.sonar.transmitter.length_v_m = 1e-4;
    r.receivers[0] = r.sonar.transmitter;
    assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, radius_m, 32, &mesh));
    assert_ok(t.ctx, asdic_scene_add_object(r.scene, "ball", mesh, (asdic_pose){.position_m = at},
                                            asdic_material_facet(45.0, 0.03, 0.3)));
    asdic_mesh_destroy(&mesh);
    for (uint64_t i = 0; i < 4; i++) {
        asdic_ping *ping = rig_shoot(&r, i, false);
        for (size_t n = 0; n < ping->bins; n++) {
            sum += ping->intensity_lin[ASDIC_OBJECT][n];
        }
        asdic_ping_destroy(&ping);
    }
    rig_destroy(&r);
    return sum;
}

/* Adds SENT to LEVELS of slices from -1 to 1, evenly between A and B. */
static void spread_over(double *levels, int slices, double a, double b, double sent) {
    double top = 0.5 * slices * (1.0 + fmin(a, b)), bottom = 0.5 * slices * (1.0 + fmax(a, b));
    for (int k = (int)fmax(floor(top), 0.0); k < slices && k < bottom; k++) {
        levels[k] += sent * (fmin(bottom, k + 1.0) - fmax(top, k)) / (bottom - top);
    }
}

/* On the axis of a channel a ball is met by many rays, and what each brings goes home by all of them: it sends by the mean
 * over its section of the square of what comes in, here in 64 slices, as rays' own squares have no finite mean. Beside a
 * fan by Runge-Kutta steps. A matte ball counts its section's places by the cosine of incidence. */
static void balls_in_a_channel_send_home_by_all_rays(void **state) {
    enum { FAN = 8001, SLICES = 64 };
    static const asdic_sound_profile cast = {4, {0.0, 3.0, 7.0, 12.0}, {1500, 1490, 1480, 1486}};
    static const struct {
        double from_m, across_m, radius_m;
    } cases[] = {{7.0, 60.0, 0.25}, {7.0, 40.0, 0.15}, {6.0, 70.0, 0.2}};
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const double across = cases[k].across_m, a = cases[k].radius_m;
        asdic_vec3 at = {0.8 * across, 0.6 * across, cases[k].from_m};
        asdic_environment env = asdic_environment_default();
        env.sound_speed_profile = cast;
        double level[SLICES] = {0.0}, before = NAN, square = 0.0, time_s, step = 0.5 / (FAN - 1);
        for (int i = 0; i < FAN; i++) {
            double elevation = (i - FAN / 2) * step;
            traced end = trace_across(&env, at.z, elevation, across, 2e-4, &time_s);
            double up = (end.z - at.z) / a, sent = cos(elevation) * step * across;
            if (fabs(up - before) > 0.0) {
                spread_over(level, SLICES, before, up, sent * SLICES / (2.0 * a));
            }
            before = up;
        }
        for (int i = 0; i < SLICES; i++) {
            double up = 2.0 * (i + 0.5) / SLICES - 1.0, inside = 0.75 * (1.0 - up * up);
            square += level[i] * level[i] * inside * 2.0 / SLICES;
        }
        double rise_db = 10.0 * log10(ball_lin(&cast, at, a) / ball_lin(NULL, at, a));
        double fan_db = 10.0 * log10(square);
        print_message("a ball of %.2f m %.0f m off in a channel: %.2f dB above straight rays; by a "
                      "fan %.2f\n",
                      a, across, rise_db, fan_db);
        assert_close(rise_db, fan_db, 0.5);
    }
}

/* What stands between is met by the legs of the rays to a point, in the layers that they are in; what stands aside or
 * behind it is not. */
static void points_hide_behind_objects(void **state) {
    static const asdic_vec3 boxes[] = {{20.0, 0.0, 6.25}, {20.0, 4.0, 6.25}, {43.0, 0.0, 5.5}};
    (void)state;
    for (int k = 0; k < 3; k++) {
        ping_rig r = bent_rig(0.0, 1024u);
        asdic_mesh *mesh = NULL;
        r.env.sound_speed_profile =
            (asdic_sound_profile){4, {0.0, 5.0, 9.0, 12.0}, {1482.0, 1480.0, 1471.0, 1470.0}};
        assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){0.5, 5.0, 1.0}, &mesh));
        asdic_pose at = {.position_m = boxes[k]};
        assert_ok(t.ctx,
                  asdic_scene_add_object(r.scene, "box", mesh, at, asdic_material_bottom(2.0)));
        asdic_mesh_destroy(&mesh);
        assert_ok(t.ctx,
                  asdic_scene_add_point(r.scene, "point", (asdic_vec3){40.0, 0.0, 5.5}, 10.0));
        asdic_ping *ping = rig_shoot(&r, 0, false);
        size_t bin = (size_t)(40.0 / r.sonar.bin_length_m);
        double level = 0.0;
        for (size_t n = bin - 2; n < bin + 2; n++) {
            level += ping->intensity_lin[ASDIC_OBJECT][n];
        }
        assert_true((level > 0.0) == (k > 0));
        asdic_ping_destroy(&ping);
        rig_destroy(&r);
    }
}

/* In water of one gradient the ray to a point as deep as the sonar is an arc that rises or sags by
 * across^2 |g| / (8 c): 0.5 m at 40 m where g / c is 0.0025 1/m. A point is heard unless that arc leaves the water. */
static void points_hide_behind_planes(void **state) {
    static const struct {
        double bend_per_m, depth_m;
        bool heard;
    } cases[] = {{-0.0025, 0.6, true},  {-0.0025, 0.4, false},  {0.0025, 0.4, true},
                 {0.0025, 11.4, true},  {0.0025, 11.6, false},  {-0.0025, 11.6, true},
                 {-0.0025, 0.51, true}, {-0.0025, 0.49, false}, {0.0025, 11.49, true},
                 {0.0025, 11.51, false}};
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        ping_rig r = bent_rig(0.0, 256u);
        double g = 1480.0 * cases[k].bend_per_m, z = cases[k].depth_m, sum = 0.0;
        r.env.sound_speed_mps = 1480.0 - g * z; /* at the surface */
        r.env.sound_speed_gradient_per_s = g;
        r.pose.position_m.z = z;
        assert_ok(t.ctx, asdic_scene_add_point(r.scene, "point", (asdic_vec3){40.0, 0.0, z}, 10.0));
        asdic_ping *ping = rig_shoot(&r, 0, false);
        for (size_t n = 0; n < ping->bins; n++) {
            sum += ping->intensity_lin[ASDIC_OBJECT][n];
        }
        assert_true((sum > 0.0) == cases[k].heard);
        asdic_ping_destroy(&ping);
        rig_destroy(&r);
    }
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_echo_over_the_arc),
        cmocka_unit_test(points_lie_on_planes),
        cmocka_unit_test(points_echo_through_layers),
        cmocka_unit_test(caustics_are_held),
        cmocka_unit_test(balls_in_a_channel_send_home_by_all_rays),
        cmocka_unit_test(points_hide_behind_objects),
        cmocka_unit_test(points_hide_behind_planes),
        cmocka_unit_test(points_are_heard_over_mirrors),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
