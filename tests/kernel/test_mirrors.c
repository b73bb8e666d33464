/* First-order multipath: a mirror, flat, curved or the sea itself, shows the unfolded scene. */
#include "multipath_rig.h"

#include "laws/scatterer.h"

#include "kernels/backscatter.h"
#include "kernels/target.h"

/* A mirror 10 m ahead, turned by YAW, shows a sphere that lies behind the sonar's face. Without
 * the mirror and with the sphere at its image, the direct echo must be the same. */
static void a_flat_mirror_shows_the_unfolded_scene(void **state) {
    (void)state;
    static const double yaws_deg[] = {0.0, 5.0, -7.0};
    print_message("%28s %10s %10s %8s\n", "flat mirror, dB", "mirrored", "unfolded", "off");
    for (int k = 0; k < 3; k++) {
        double yaw = yaws_deg[k] * DEGREE, nx = cos(yaw), ny = sin(yaw);
        asdic_vec3 ball = {-8.0, 0.4, 0.3};
        double toward = 2.0 * ((10.0 - ball.x) * nx - ball.y * ny);
        asdic_vec3 image = {ball.x + toward * nx, ball.y + toward * ny, ball.z};
        asdic_ping *pings[2];
        for (int unfolded = 0; unfolded < 2; unfolded++) {
            target_rig r = open_sea(40.0);
            asdic_mesh *mesh = NULL;
            assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, 1.5, 96, &mesh));
            add(&r, mesh, unfolded ? image : ball, unfolded ? 180.0 + 2.0 * yaws_deg[k] : 0.0, 0.0,
                sand());
            if (!unfolded) {
                add_plate(&r, 40.0, 40.0, (asdic_vec3){10.0, 0.0, 0.0}, yaws_deg[k], mirror());
            }
            pings[unfolded] = shoot(&r);
            target_rig_destroy(&r);
        }
        double most = 0.0;
        for (size_t n = 0; n < pings[0]->bins; n++) {
            double a = pings[0]->intensity_lin[ASDIC_MULTIPATH][n];
            double b = pings[1]->intensity_lin[ASDIC_OBJECT][n];
            assert_int_equal(a > 0.0, b > 0.0);
            most = a > 0.0 ? fmax(most, fabs(db(a) - db(b))) : most;
        }
        double a = energy(pings[0], ASDIC_MULTIPATH, 0.0, INFINITY);
        double b = energy(pings[1], ASDIC_OBJECT, 0.0, INFINITY);
        print_message("%20s %4.0f deg %10.4f %10.4f %+8.4f, in a bin %.4f\n", "turned by",
                      yaws_deg[k], db(a), db(b), db(a / b), most);
        assert_true(b > 0.0);
        assert_close(db(a), db(b), 1e-3);
        assert_true(most < 0.02);
        asdic_ping_destroy(&pings[0]);
        asdic_ping_destroy(&pings[1]);
    }
}

/* From the origin along U over a sphere of RADIUS at (CENTRE, 0, 0) to the plane x = WALL; false
 * where the ray misses. POINT is in the plane, *SIN_WALL its grazing. */
static bool over_sphere(double centre_m, double radius_m, double wall_m, const double u[3],
                        double point[3], double *path_m, double *sin_wall) {
    double along = centre_m * u[0], miss2 = centre_m * centre_m - along * along;
    if (along <= 0.0 || miss2 >= radius_m * radius_m) {
        return false;
    }
    double d1 = along - sqrt(radius_m * radius_m - miss2);
    double hit[3] = {d1 * u[0], d1 * u[1], d1 * u[2]};
    double n[3] = {(hit[0] - centre_m) / radius_m, hit[1] / radius_m, hit[2] / radius_m};
    double cosine = u[0] * n[0] + u[1] * n[1] + u[2] * n[2];
    double v[3] = {u[0] - 2 * cosine * n[0], u[1] - 2 * cosine * n[1], u[2] - 2 * cosine * n[2]};
    double d2 = (wall_m - hit[0]) / v[0];
    if (d2 <= 0.0) {
        return false;
    }
    for (int k = 0; k < 3; k++) {
        point[k] = hit[k] + d2 * v[k];
    }
    *path_m = d1 + d2;
    *sin_wall = fabs(v[0]);
    return true;
}

static void direction(double across, double down, double u[3]) {
    double ahead = sqrt(1.0 - across * across - down * down);
    u[0] = ahead;
    u[1] = across;
    u[2] = down;
}

/* The same-way echo of a white wall behind the sonar in a sphere before it: rays on a fine grid, and
 * the spreading of each from where its neighbours arrive. FLAT: as if it spread like a flat mirror's. */
static double integrate_sphere(const target_rig *r, double centre_m, double radius_m, double wall_m,
                               bool flat) {
    enum { STEPS = 400 };
    double gain = bottom_gain(2.0, FREQUENCY_HZ / 1e3), peak = bottom_peak(2.0);
    double alpha = asdic_environment_absorption_db_per_km(&r->env, FREQUENCY_HZ, 100.0);
    double k = alpha * log(10.0) / 1e4, limit = radius_m / centre_m, sum = 0.0;
    double step = 2.0 * limit / STEPS, h = 1e-6;
    for (int i = 0; i < STEPS; i++) {
        for (int j = 0; j < STEPS; j++) {
            double across = (i + 0.5) * step - limit, down = (j + 0.5) * step - limit;
            double u[3], p[3][3], path_m, sin_wall, other_m, other_sin;
            direction(across, down, u);
            if (!over_sphere(centre_m, radius_m, wall_m, u, p[0], &path_m, &sin_wall)) {
                continue;
            }
            double solid_angle = step * step / u[0], spread = path_m * path_m;
            direction(across + h, down, u);
            bool met = over_sphere(centre_m, radius_m, wall_m, u, p[1], &other_m, &other_sin);
            direction(across, down + h, u);
            met = met && over_sphere(centre_m, radius_m, wall_m, u, p[2], &other_m, &other_sin);
            if (!met || path_m > 59.0) {
                continue;
            }
            direction(across, down, u);
            if (!flat) { /* cross-section of the tube at the wall per solid angle at the sonar */
                double area = fabs((p[1][1] - p[0][1]) * (p[2][2] - p[0][2]) -
                                   (p[1][2] - p[0][2]) * (p[2][1] - p[0][1]));
                spread = area * sin_wall / (h * h / u[0]);
            }
            double b = one_way(&r->receiver, u[0], u[1], u[2]);
            double s = bottom_backscatter_lin(gain, peak, 2.0, sin_wall);
            sum += solid_angle * b * b * s / sin_wall / spread * exp(-2.0 * k * (path_m - 1.0));
        }
    }
    return sum;
}

static void a_curved_mirror_spreads_what_returns(void **state) {
    (void)state;
    const double centre_m = 12.0, radius_m = 2.0, wall_m = -6.0;
    target_rig r = open_sea(40.0);
    r.sampling.rays = 1 << 21;
    asdic_mesh *mesh = NULL;
    assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, radius_m, 96, &mesh));
    add(&r, mesh, (asdic_vec3){centre_m, 0.0, 0.0}, 0.0, 0.0, mirror());
    add_plate(&r, 400.0, 400.0, (asdic_vec3){wall_m, 0.0, 0.0}, 0.0, sand());
    asdic_ping *ping = shoot(&r);
    double got = energy(ping, ASDIC_MULTIPATH, 0.0, INFINITY);
    double expected = integrate_sphere(&r, centre_m, radius_m, wall_m, false);
    double flat = integrate_sphere(&r, centre_m, radius_m, wall_m, true);
    print_message(
        "sphere as mirror: %.2f dB, integrated %.2f; with a flat mirror's spreading %.2f\n",
        db(got), db(expected), db(flat));
    assert_close(db(got), db(expected), 0.3);
    assert_true(db(flat) - db(expected) > 10.0);
    asdic_ping_destroy(&ping);
    target_rig_destroy(&r);
}

/* A calm surface shows a ball, 25 m ahead and hidden by a screen, at its image above the water. */
static void a_calm_surface_shows_the_unfolded_scene(void **state) {
    (void)state;
    asdic_ping *pings[2];
    for (int unfolded = 0; unfolded < 2; unfolded++) {
        target_rig r = open_sea(40.0);
        r.env.wind_speed_kn = 0.0;
        r.sampling.multipath = ASDIC_MULTIPATH_BOUNDARIES;
        r.pose.position_m.z = 3.0;
        asdic_scene_set_surface(r.scene, !unfolded);
        asdic_mesh *mesh = NULL;
        assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, 1.5, 96, &mesh));
        add(&r, mesh, (asdic_vec3){25.0, 0.5, unfolded ? -105.0 : -95.0}, 0.0, 0.0, sand());
        if (!unfolded) {
            add_plate(&r, 6.0, 3.0, (asdic_vec3){15.0, 0.5, -95.6}, 0.0, sand());
        }
        pings[unfolded] = shoot(&r);
        target_rig_destroy(&r);
    }
    double most = 0.0;
    for (size_t n = 40; n < pings[0]->bins; n++) { /* beyond the screen and its image */
        double a = pings[0]->intensity_lin[ASDIC_MULTIPATH][n];
        double b = pings[1]->intensity_lin[ASDIC_OBJECT][n];
        assert_int_equal(a > 0.0, b > 0.0);
        most = a > 0.0 ? fmax(most, fabs(db(a) - db(b))) : most;
    }
    print_message("calm surface: %.2f dB, unfolded %.2f; in a bin %.4f off\n",
                  db(energy(pings[0], ASDIC_MULTIPATH, 20.0, INFINITY)),
                  db(energy(pings[1], ASDIC_OBJECT, 20.0, INFINITY)), most);
    assert_true(energy(pings[1], ASDIC_OBJECT, 20.0, INFINITY) > 0.0 && most < 0.02);
    assert_true(energy(pings[0], ASDIC_OBJECT, 20.0, INFINITY) == 0.0);
    asdic_ping_destroy(&pings[0]);
    asdic_ping_destroy(&pings[1]);
}

/* What a smooth ball of RADIUS_M, OUT_M and BACK_M away from both ends, returns where its normal lies midway between
 * ways TURN_RAD apart: the tube of rays after Deschamps (1972). */
static double ball_lin(double radius_m, double out_m, double back_m, double turn_rad) {
    double c = cos(0.5 * turn_rad);
    double rho1 = 1.0 / (1.0 / out_m + 2.0 / (radius_m * c));
    double rho2 = 1.0 / (1.0 / out_m + 2.0 * c / radius_m);
    return rho1 * rho2 / ((rho1 + back_m) * (rho2 + back_m)) / (out_m * out_m);
}

/* A polished ball below a calm surface glints midway between the straight way and that over the surface; beside a wall,
 * which it mirrors as well as that mirrors it, no louder. */
static void a_polished_ball_glints_over_a_mirror(void **state) {
    (void)state;
    const double radius_m = 1.5, depth_m = 3.0, ahead_m = 12.0;
    /* At high frequencies the glint of a ball without slopes is too small for so many rays. */
    static const double frequency_hz[] = {30e3, 300e3}, slope_rms[] = {0.0, 0.1};
    /* The normal's elevation: both ways are as far from it. */
    double low = 0.0, high = 0.5 * PI, out_m = 0.0, back_m = 0.0, turn = 0.0;
    for (int i = 0; i < 60; i++) {
        double e = 0.5 * (low + high);
        double x = ahead_m - radius_m * cos(e), up = radius_m * sin(e);
        double to_image = atan2(2.0 * depth_m - up, x), to_sonar = atan2(-up, x);
        out_m = hypot(2.0 * depth_m - up, x);
        back_m = hypot(up, x);
        turn = to_image - to_sonar;
        *(to_image - e > e - to_sonar ? &low : &high) = e;
    }
    for (int k = 0; k < 4; k++) {
        bool wall = k >= 2;
        target_rig r = open_sea(20.0);
        double alpha = asdic_environment_absorption_db_per_km(&r.env, frequency_hz[k % 2], depth_m);
        r.env.wind_speed_kn = 0.0;
        r.sonar.frequency_hz = frequency_hz[k % 2];
        r.sonar.transmitter.length_h_m = r.sonar.transmitter.length_v_m = 1e-4;
        r.receiver = r.sonar.transmitter;
        r.sampling.multipath = ASDIC_MULTIPATH_BOUNDARIES;
        r.sampling.sampler = ASDIC_SAMPLER_ADAPTIVE;
        r.sampling.rays = 1 << 20;
        r.pose.position_m.z = depth_m;
        r.sonar.bin_length_m = 0.1;
        asdic_scene_set_surface(r.scene, !wall);
        if (wall) {
            add_plate(&r, 60.0, 60.0, (asdic_vec3){ahead_m, depth_m, depth_m - 100.0}, 90.0,
                      mirror());
        }
        asdic_mesh *mesh = NULL;
        assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, radius_m, 128, &mesh));
        add(&r, mesh, (asdic_vec3){ahead_m, 0.0, depth_m - 100.0}, 0.0, 0.0,
            asdic_material_facet(0.0, 0.0, slope_rms[k % 2]));
        asdic_ping *ping = shoot_many(&r, 4);
        double middle = 0.5 * (out_m + back_m), same = hypot(2.0 * depth_m, ahead_m) - radius_m;
        double got = energy(ping, ASDIC_MULTIPATH, 0.0, 0.5 * (middle + same));
        double twice = energy(ping, ASDIC_MULTIPATH, 0.5 * (middle + same), INFINITY);
        double want = 2.0 * ball_lin(radius_m, out_m, back_m, turn) *
                      pow(10.0, -0.2e-3 * alpha * (middle - 1.0));
        double want_twice =
            ball_lin(radius_m, same, same, 0.0) * pow(10.0, -0.2e-3 * alpha * (same - 1.0));
        print_message("%g kHz: %.2f dB, %.2f expected; there and back over the mirror %.2f, %.2f\n",
                      1e-3 * frequency_hz[k % 2], db(got), db(want), db(twice), db(want_twice));
        assert_close(db(got), db(want), 0.3);
        assert_close(db(twice), db(want_twice), 0.3);
        asdic_ping_destroy(&ping);
        target_rig_destroy(&r);
    }
}

/* A sonar that is alike to all sides near its axis, SINE of the angle below which it looks up to a calm surface; 0: none. */
static target_rig far_sonar(double range_m, double sine) {
    target_rig r = target_rig_create(&t, FREQUENCY_HZ, 1.2 * range_m, 0.06);
    r.sampling.multipath = sine > 0.0 ? ASDIC_MULTIPATH_BOUNDARIES : ASDIC_MULTIPATH_FIRST;
    r.sampling.rays = 1 << 17;
    r.env.wind_speed_kn = 0.0;
    r.pose.pitch_rad = asin(sine);
    r.pose.position_m.z = sine > 0.0 ? range_m * sine : 100.0;
    asdic_scene_set_surface(r.scene, sine > 0.0);
    return r;
}

/* What R hears by way of mirrors, as a target strength at RANGE_M. */
static double mirrored_db(target_rig *r, double range_m) {
    asdic_ping *ping = shoot(r);
    double strength_db =
        target_rig_strength_db(r, energy(ping, ASDIC_MULTIPATH, 0.0, INFINITY), range_m);
    asdic_ping_destroy(&ping);
    return strength_db;
}

/* Two ways of an aperture of AREA_M2, as energies. */
static double two_ways_db(double area_m2) {
    return db(2.0 * plate_strength_lin(area_m2, SPEED_MPS / FREQUENCY_HZ));
}

/* An upright plate just beneath a calm surface, looked up at under an angle: over the surface it returns what its height
 * covers of the wave, A cos i. */
static void a_plate_below_calm_water_is_seen_slanting(void **state) {
    (void)state;
    const double side_m = 0.2, range_m = 120.0;
    for (double angle_deg = 30.0; angle_deg < 61.0; angle_deg += 15.0) {
        double sine = sin(angle_deg * DEGREE), cosine = cos(angle_deg * DEGREE);
        target_rig r = far_sonar(range_m, sine);
        add_plate(&r, side_m, side_m,
                  (asdic_vec3){range_m * cosine, 0.0, 0.5 * side_m + 1e-3 - 100.0}, 0.0, mirror());
        double got_db = mirrored_db(&r, range_m), want_db = two_ways_db(side_m * side_m * cosine);
        print_message("plate at %g degrees: %.2f dB, %.2f expected\n", angle_deg, got_db, want_db);
        assert_close(got_db, want_db, 0.3);
        target_rig_destroy(&r);
    }
}

/* Two plates of HEIGHT_M that meet at a right angle, the first of which is seen under ANGLE_DEG to its normal: what comes
 * back over both is as wide as the wave that both cover, met by way of either. */
static void plates_at_a_right_angle_return_as_one_aperture(void **state) {
    (void)state;
    static const struct {
        double angle_deg, width_m[2];
    } cases[] = {{45.0, {0.3, 0.3}}, {30.0, {0.3, 0.3}}, {20.0, {0.3, 0.3}}, {45.0, {0.3, 2.0}}};
    const double range_m = 100.0, height_m = 0.3;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        target_rig r = far_sonar(range_m, 0.0);
        double least_m = INFINITY;
        for (int p = 0; p < 2; p++) {
            double side = p ? -1.0 : 1.0, width_m = cases[k].width_m[p];
            double angle_deg = p ? 90.0 - cases[k].angle_deg : cases[k].angle_deg;
            double x = -sin(angle_deg * DEGREE), y = side * cos(angle_deg * DEGREE);
            add_plate(&r, width_m, height_m,
                      (asdic_vec3){range_m + 0.5 * width_m * x, 0.5 * width_m * y, 0.0},
                      atan2(y, x) / DEGREE - 90.0, mirror());
            least_m = fmin(least_m, width_m * fabs(y));
        }
        double got_db = mirrored_db(&r, range_m), want_db = two_ways_db(least_m * height_m);
        print_message("plates of %g and %g m at %g degrees: %.2f dB, %.2f expected\n",
                      cases[k].width_m[0], cases[k].width_m[1], cases[k].angle_deg, got_db,
                      want_db);
        assert_close(got_db, want_db, 0.5);
        target_rig_destroy(&r);
    }
}

/* A small ball 30 m ahead, as deep as the sonar, in calm water: few rays hear it by way of the surface, too, as loud as
 * Lambert's sphere is by the angle between both ways, where rays are straight and where they bend. */
static void a_small_ball_is_heard_over_a_calm_surface(void **state) {
    (void)state;
    const double depth_m = 10.0, ahead_m = 30.0, over_m = hypot(ahead_m, 2.0 * depth_m);
    const double turn = atan2(2.0 * depth_m, ahead_m);
    for (int bent = 0; bent < 2; bent++) {
        target_rig r = open_sea(45.0);
        r.env.wind_speed_kn = 0.0;
        r.env.sound_speed_gradient_per_s = bent ? -0.3 : 0.0;
        r.sonar.transmitter.length_h_m = r.sonar.transmitter.length_v_m = 1e-4;
        r.receiver = r.sonar.transmitter;
        r.sampling.multipath = ASDIC_MULTIPATH_BOUNDARIES;
        r.sampling.sampler = ASDIC_SAMPLER_ADAPTIVE;
        r.sampling.rays = 20000;
        r.pose.position_m.z = depth_m;
        asdic_scene_set_surface(r.scene, true);
        asdic_mesh *mesh = NULL;
        assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, 0.1, 32, &mesh));
        asdic_material lambert = asdic_material_of(asdic_law_find("lambert"));
        assert_ok(t.ctx, asdic_material_set(t.ctx, &lambert, "lambert_db", -5.0));
        add(&r, mesh, (asdic_vec3){ahead_m, 0.0, depth_m - 100.0}, 0.0, 0.0, lambert);
        double alpha = asdic_environment_absorption_db_per_km(&r.env, FREQUENCY_HZ, depth_m);
        double loss_db = 20.0 * log10(over_m / ahead_m) + 1e-3 * alpha * (over_m - ahead_m);
        double want = 10.0 * log10(2.0 * (sin(turn) + (PI - turn) * cos(turn)) / PI) - loss_db;
        asdic_ping *ping = shoot(&r);
        double direct = energy(ping, ASDIC_OBJECT, 0.0, INFINITY);
        double once = db(energy(ping, ASDIC_MULTIPATH, 31.5, 34.5) / direct);
        double twice = db(energy(ping, ASDIC_MULTIPATH, 34.5, INFINITY) / direct);
        print_message("rays %s: over the surface once %.2f dB, %.2f expected; twice %.2f, %.2f\n",
                      bent ? "bend" : "straight", once, want, twice, -2.0 * loss_db);
        assert_close(once, want, 0.2);
        assert_close(twice, -2.0 * loss_db, 0.2);
        asdic_ping_destroy(&ping);
        target_rig_destroy(&r);
    }
}

/* A body of which rays see a ball, RADIUS_M about CENTRE, or, with none, the plane through CENTRE across FACING. */
typedef struct shape {
    asdic_vec3 centre_m, facing;
    double radius_m;
} shape;

/* Takes the ray from AT along U over a shape; false: past it. */
static bool bounce_off(const shape *s, double at[3], double u[3]) {
    const double c[3] = {s->centre_m.x, s->centre_m.y, s->centre_m.z};
    double n[3] = {s->facing.x, s->facing.y, s->facing.z}, along = 0.0, far2 = 0.0, d = 0.0;
    for (int k = 0; k < 3; k++) {
        along += (c[k] - at[k]) * u[k];
        far2 += (c[k] - at[k]) * (c[k] - at[k]);
    }
    if (s->radius_m > 0.0) {
        double miss2 = far2 - along * along, radius2 = s->radius_m * s->radius_m;
        d = along - sqrt(fmax(radius2 - miss2, 0.0));
        if (miss2 > radius2) {
            return false;
        }
    } else {
        double down = 0.0;
        for (int k = 0; k < 3; k++) {
            d += (c[k] - at[k]) * n[k];
            down += u[k] * n[k];
        }
        d /= down;
    }
    double cosine = 0.0;
    for (int k = 0; k < 3; k++) {
        at[k] += d * u[k];
        n[k] = s->radius_m > 0.0 ? (at[k] - c[k]) / s->radius_m : n[k];
        cosine += u[k] * n[k];
    }
    for (int k = 0; k < 3; k++) {
        u[k] -= 2.0 * cosine * n[k];
    }
    return d > 0.0;
}

/* By how much the ray over COUNT shapes, which leaves the origin (ACROSS, DOWN) off its axis, passes it in the end. */
static bool pass_origin(const shape *const *over, int count, double across, double down,
                        double miss[2], double *path_m) {
    double at[3] = {0.0, 0.0, 0.0}, u[3];
    direction(across, down, u);
    *path_m = 0.0;
    for (int k = 0; k < count; k++) {
        double before[3] = {at[0], at[1], at[2]};
        if (!bounce_off(over[k], at, u)) {
            return false;
        }
        *path_m += hypot(hypot(at[0] - before[0], at[1] - before[1]), at[2] - before[2]);
    }
    double home = -(at[0] * u[0] + at[1] * u[1] + at[2] * u[2]);
    *path_m += home;
    double level = hypot(u[0], u[1]);
    double side[3] = {-u[1] / level, u[0] / level, 0.0};
    double top[3] = {-u[2] * u[0] / level, -u[2] * u[1] / level, level};
    miss[0] = miss[1] = 0.0;
    for (int k = 0; k < 3; k++) {
        miss[0] += (at[k] + home * u[k]) * side[k];
        miss[1] += (at[k] + home * u[k]) * top[k];
    }
    return home > 0.0;
}

/* What comes back over COUNT shapes with SHARE of every direction: one over the tube of a steradian. */
static double glint_lin(const shape *const *over, int count, double alpha_db_per_km) {
    enum { SCAN = 1200 };
    const shape *first = over[0];
    double least = INFINITY, x = 0.0, y = 0.0, path_m = 0.0, miss[2], by[2][2];
    double ahead = hypot(hypot(first->centre_m.x, first->centre_m.y), first->centre_m.z);
    double reach = (first->radius_m > 0.0 ? first->radius_m : 1.0) / ahead;
    for (int i = 0; i < SCAN * SCAN; i++) {
        double across = first->centre_m.y / ahead + reach * (2.0 * (i % SCAN) / SCAN - 1.0);
        double down = first->centre_m.z / ahead + reach * (2.0 * (i / SCAN) / SCAN - 1.0);
        if (pass_origin(over, count, across, down, miss, &path_m) &&
            hypot(miss[0], miss[1]) < least) {
            least = hypot(miss[0], miss[1]);
            x = across;
            y = down;
        }
    }
    double all = 1.0;
    for (int i = 0; i < 20; i++) {
        const double h = 1e-7;
        double near[2], at[2];
        assert_true(pass_origin(over, count, x, y, at, &path_m));
        for (int k = 0; k < 2; k++) {
            assert_true(
                pass_origin(over, count, x + (k ? 0.0 : h), y + (k ? h : 0.0), near, &path_m));
            by[k][0] = (near[0] - at[0]) / h;
            by[k][1] = (near[1] - at[1]) / h;
        }
        all = by[0][0] * by[1][1] - by[0][1] * by[1][0];
        x += (by[1][0] * at[1] - by[1][1] * at[0]) / all;
        y += (by[0][1] * at[0] - by[0][0] * at[1]) / all;
        least = hypot(at[0], at[1]);
    }
    assert_true(least < 1e-6);
    double ahead_cos = sqrt(1.0 - x * x - y * y);
    return 1.0 / (fabs(all) * ahead_cos) * pow(10.0, -1e-4 * alpha_db_per_km * (path_m - 2.0));
}

/* Two smooth bodies show each other, by spots that one of a thousand of the rays to either meets: across, both ways
 * round, and there and back over each. In every ping, and where the sonar has gone on since it learnt. */
static void smooth_bodies_show_each_other(void **state) {
    (void)state;
    const double slope_rms = 0.01;
    static const struct {
        const char *what;
        shape a, b;
        double aside_m;
    } cases[] = {
        {"balls",
         {{14.0, -1.0, 0.5}, {0.0, 0.0, 0.0}, 0.6},
         {{16.0, 2.0, -0.5}, {0.0, 0.0, 0.0}, 0.4},
         0.0},
        {"balls, 1 m aside",
         {{14.0, -1.0, 0.5}, {0.0, 0.0, 0.0}, 0.6},
         {{16.0, 2.0, -0.5}, {0.0, 0.0, 0.0}, 0.4},
         1.0},
        {"ball and plate",
         {{14.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 0.5},
         {{16.1, 3.2, 0.3}, {0.8, 0.6, 0.0}, 0.0},
         0.0},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        target_rig r = open_sea(30.0);
        double alpha = asdic_environment_absorption_db_per_km(&r.env, FREQUENCY_HZ, 100.0);
        r.sonar.transmitter.length_h_m = r.sonar.transmitter.length_v_m = 1e-4;
        r.receiver = r.sonar.transmitter;
        r.sampling.sampler = ASDIC_SAMPLER_ADAPTIVE;
        r.sampling.rays = 20000;
        for (int b = 0; b < 2; b++) {
            const shape *s = b ? &cases[k].b : &cases[k].a;
            asdic_vec3 at = {s->centre_m.x, s->centre_m.y + cases[k].aside_m, s->centre_m.z};
            asdic_mesh *mesh = NULL;
            if (s->radius_m > 0.0) {
                assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, s->radius_m, 96, &mesh));
                add(&r, mesh, at, 0.0, 0.0, asdic_material_facet(0.0, 0.0, slope_rms));
            } else {
                add_plate(&r, 4.0, 4.0, at, atan2(s->facing.y, s->facing.x) / DEGREE,
                          asdic_material_facet(0.0, 0.0, slope_rms));
            }
        }
        const shape *a = &cases[k].a, *b = &cases[k].b;
        const shape *const ab[] = {a, b}, *const aba[] = {a, b, a}, *const bab[] = {b, a, b};
        double want =
            2.0 * glint_lin(ab, 2, alpha) + glint_lin(aba, 3, alpha) + glint_lin(bab, 3, alpha);
        asdic_simulator *sim = NULL;
        asdic_ping *ping = NULL;
        r.sonar.receivers = &r.receiver;
        assert_ok(t.ctx, asdic_scene_commit(r.scene));
        assert_ok(t.ctx, asdic_simulator_create(t.ctx, t.device, r.scene, &r.env, &r.sonar,
                                                &r.sampling, 100.0, &sim));
        assert_ok(t.ctx, asdic_simulator_learn(sim, &r.pose, 0));
        assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, asdic_simulator_bin_count(sim), &ping));
        r.pose.position_m.y += cases[k].aside_m;
        double least = INFINITY, most = -INFINITY, mean = 0.0;
        enum { PINGS = 16 };
        for (int n = 0; n < PINGS; n++) {
            assert_ok(t.ctx, asdic_simulator_ping(sim, &r.pose, (uint64_t)n, ping));
            double got = energy(ping, ASDIC_MULTIPATH, 0.0, INFINITY);
            least = fmin(least, got);
            most = fmax(most, got);
            mean += got / PINGS;
        }
        print_message("%s: %.2f dB, %.2f expected; single pings %+.2f to %+.2f\n", cases[k].what,
                      db(mean), db(want), db(least / want), db(most / want));
        assert_close(db(mean), db(want), 0.3);
        assert_true(db(least / want) > -1.0 && db(most / want) < 1.0);
        asdic_ping_destroy(&ping);
        asdic_simulator_destroy(&sim);
        target_rig_destroy(&r);
    }
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_flat_mirror_shows_the_unfolded_scene),
        cmocka_unit_test(a_curved_mirror_spreads_what_returns),
        cmocka_unit_test(a_calm_surface_shows_the_unfolded_scene),
        cmocka_unit_test(a_polished_ball_glints_over_a_mirror),
        cmocka_unit_test(a_plate_below_calm_water_is_seen_slanting),
        cmocka_unit_test(plates_at_a_right_angle_return_as_one_aperture),
        cmocka_unit_test(smooth_bodies_show_each_other),
        cmocka_unit_test(a_small_ball_is_heard_over_a_calm_surface),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
