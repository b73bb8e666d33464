/* First-order multipath: a mirror shows the unfolded scene, what stands in the way hides it, and no
 * more energy leaves a surface than arrives. */
#include "target_rig.h"

#include "kernels/backscatter.h"
#include "kernels/beam.h"
#include "kernels/mirror.h"

static test_device t;

#define PI 3.14159265358979323846
#define DEGREE (PI / 180.0)
#define SIDE_WL 3.0 /* apertures in wavelengths: 17 degrees */
#define FREQUENCY_HZ 100e3
#define SPEED_MPS 1500.0

/* A sonar of medium width in an empty sea; the beam sampler's rays do not depend on the scene. */
static target_rig open_sea(double range_m) {
    target_rig r = target_rig_create(&t, FREQUENCY_HZ, range_m, 0.06 / SIDE_WL);
    r.sampling.multipath = ASDIC_MULTIPATH_FIRST;
    r.sampling.sampler = ASDIC_SAMPLER_BEAM;
    r.sampling.rays = 1 << 19;
    return r;
}

static void add(target_rig *r, asdic_mesh *mesh, asdic_vec3 at, double yaw_deg, double pitch_deg,
                asdic_material material) {
    asdic_pose pose = {.position_m = {at.x, at.y, 100.0 + at.z},
                       .yaw_rad = yaw_deg * DEGREE,
                       .pitch_rad = pitch_deg * DEGREE};
    char name[32];
    snprintf(name, sizeof name, "body%zu", asdic_scene_get_info(r->scene).triangles);
    assert_ok(t.ctx, asdic_scene_add_object(r->scene, name, mesh, pose, material));
    asdic_mesh_destroy(&mesh);
}

static void add_plate(target_rig *r, double width_m, double height_m, asdic_vec3 at, double yaw_deg,
                      asdic_material material) {
    asdic_mesh *mesh = NULL;
    assert_ok(t.ctx, asdic_mesh_plate(t.ctx, width_m, height_m, &mesh));
    add(r, mesh, at, yaw_deg, 0.0, material);
}

/* Air: R = 1; polished. */
static asdic_material mirror(void) {
    return asdic_material_facet(0.0, 0.0, 0.0);
}

static asdic_material sand(void) {
    return asdic_material_bottom(2.0);
}

/* The mean of PINGS pings, in the place of one. */
static asdic_ping *shoot_many(target_rig *r, int pings) {
    asdic_simulator *sim = NULL;
    asdic_ping *ping = NULL;
    r->sonar.receivers = &r->receiver;
    if (!asdic_scene_get_info(r->scene).bvh_nodes) {
        asdic_scene_commit(r->scene);
    }
    assert_ok(t.ctx, asdic_simulator_create(t.ctx, t.device, r->scene, &r->env, &r->sonar,
                                            &r->sampling, 100.0, &sim));
    assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, asdic_simulator_bin_count(sim), &ping));
    double *sums[ASDIC_COMPONENT_COUNT];
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        sums[c] = calloc(ping->bins, sizeof *sums[c]);
    }
    for (int k = 0; k < pings; k++) {
        assert_ok(t.ctx, asdic_simulator_ping(sim, &r->pose, (uint64_t)k, ping));
        assert_int_equal(ping->saturated, 0);
        for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
            for (size_t n = 0; n < ping->bins; n++) {
                sums[c][n] += ping->intensity_lin[c][n] / pings;
            }
        }
    }
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        memcpy(ping->intensity_lin[c], sums[c], ping->bins * sizeof *sums[c]);
        free(sums[c]);
    }
    asdic_simulator_destroy(&sim);
    return ping;
}

static asdic_ping *shoot(target_rig *r) {
    return shoot_many(r, 1);
}

/* Bins that begin from FROM on, before TO. */
static double energy(const asdic_ping *ping, asdic_component component, double from_m,
                     double to_m) {
    double sum = 0.0;
    size_t first = (size_t)ceil(from_m / ping->bin_length_m - 1e-9);
    size_t end = (size_t)ceil(fmin(to_m / ping->bin_length_m, (double)ping->bins) - 1e-9);
    for (size_t n = first; n < end; n++) {
        sum += ping->intensity_lin[component][n];
    }
    return sum;
}

static double db(double lin) {
    return 10.0 * log10(lin);
}

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

static double one_way(const asdic_beam *beam, double x, double y, double z) {
    double d = sqrt(x * x + y * y + z * z), side_wl = beam->length_h_m * FREQUENCY_HZ / SPEED_MPS;
    return beam_pattern_lin(x / d, y / d, z / d, side_wl, side_wl, 0.0);
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

/* --- curved mirrors ------------------------------------------------------------------------ */

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

/* --- boundaries ---------------------------------------------------------------------------- */

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
    /* A perfect mirror scatters nothing itself. */
    assert_true(energy(pings[0], ASDIC_SURFACE, 0.0, INFINITY) == 0.0);
    asdic_ping_destroy(&pings[0]);
    asdic_ping_destroy(&pings[1]);
}

/* The flat scene with every kind of boundary mirror: what is scattered directly falls by the mirror
 * share at every range, exactly, for the same rays. */
static void boundaries_scatter_what_they_do_not_mirror(void **state) {
    (void)state;
    static const asdic_component direct[2] = {ASDIC_SURFACE, ASDIC_BOTTOM};
    double wavelength_m = SPEED_MPS / FREQUENCY_HZ;
    asdic_ping *pings[2];
    for (int mirrors = 0; mirrors < 2; mirrors++) {
        target_rig r = open_sea(40.0);
        r.sampling.multipath = mirrors ? ASDIC_MULTIPATH_BOUNDARIES : ASDIC_MULTIPATH_FIRST;
        r.env.wind_speed_kn = 3.0;
        r.pose.position_m.z = 2.0;
        asdic_scene_set_surface(r.scene, true);
        assert_ok(t.ctx, asdic_scene_set_bottom_plane(r.scene, 4.0, sand()));
        r.sonar.bin_length_m = 0.1;
        pings[mirrors] = shoot(&r);
        target_rig_destroy(&r);
    }
    double sea_g = roughness_parameter(wavelength_m, sea_height_rms_m(3.0));
    double sand_g = roughness_parameter(wavelength_m, 0.008);
    double most = 0.0;
    for (size_t n = 40; n < pings[0]->bins; n++) {
        double s = 2.0 / ((n + 0.5) * 0.1);
        double surface = 1.0 - mirror_share(s, 1.0, sea_g);
        double bottom = 1.0 - mirror_share(s, fluid_reflection2(s, 1.9, 1.0 / 1.1), sand_g);
        assert_true(surface >= 0.0 && surface <= 1.0 && bottom >= 0.0 && bottom <= 1.0);
        const double share[2] = {surface, bottom};
        for (int c = 0; c < 2; c++) {
            const double *before = pings[0]->intensity_lin[direct[c]];
            const double *after = pings[1]->intensity_lin[direct[c]];
            if (before[n] > 1e-4 * before[40]) { /* beneath, single quanta show */
                most = fmax(most, fabs(after[n] / before[n] - share[c]));
            }
        }
    }
    print_message("direct share off by %.2g at most\n", most);
    assert_true(most < 2e-3); /* the share's slope over half a bin */
    assert_true(energy(pings[1], ASDIC_MULTIPATH, 0.0, INFINITY) > 0.0);
    asdic_ping_destroy(&pings[0]);
    asdic_ping_destroy(&pings[1]);
}

/* What a facet sends on and what it scatters into the half space add up to R^2 at most, at every
 * angle, roughness and slope: the lobe by integration over all directions. Monostatic strength
 * sigma(i) scatters, for reciprocal laws that depend on the half-way normal, the energy that facets
 * tilted by i turn: 4 sigma cos^4 dOmega_n, once for every normal n. */
static void no_more_leaves_than_arrives(void **state) {
    (void)state;
    static const double slopes[] = {1e-5, 1e-3, 1e-2, 0.1, 0.5};
    double most = 0.0;
    for (int m = 0; m < 5; m++) {
        double sum = 0.0;
        enum { STEPS = 20000 };
        for (int i = 0; i < STEPS; i++) { /* over slopes tan i = x, area in the slope plane */
            double x = (i + 0.5) / STEPS * 12.0 * sqrt(slopes[m]);
            double cosine = 1.0 / sqrt(1.0 + x * x);
            double lobe = facet_strength_lin(cosine, 1.0, 0.0, slopes[m]);
            sum += 2.0 * PI * x * 12.0 * sqrt(slopes[m]) / STEPS * 4.0 * lobe * pow(cosine, 4.0);
        }
        most = fmax(most, sum);
        assert_close(sum, 1.0, 1e-3);
    }
    for (double g = 0.0; g < 1e4; g = 2.0 * g + 0.01) {
        for (double s = 0.001; s <= 1.0; s += 0.001) {
            double lambert = facet_strength_lin(s, 0.8, g, 1e-9) * PI / (s * s); /* no lobe off 0 */
            double out = mirror_share(s, 0.8, g) + (s < 0.99 ? lambert : 0.0);
            assert_true(out <= 0.8 * (1.0 + 1e-12));
            assert_true(s >= 0.99 || out >= 0.8 * (1.0 - 1e-9));
        }
    }
}

static void boundary_formulas_meet_their_limits(void **state) {
    (void)state;
    /* Normal incidence: the impedances alone. */
    double r = (1.9 * 1.1 - 1.0) / (1.9 * 1.1 + 1.0);
    assert_close(fluid_reflection2(1.0, 1.9, 1.0 / 1.1), r * r, 1e-12);
    assert_close(fluid_reflection2(1.0, 1.9, 1.0 / 1.1), impedance_reflection2(1.9 * 1.1, 1.0),
                 1e-12);
    /* Total reflection below the critical angle, 24.6 degrees, and at grazing incidence. */
    assert_true(fluid_reflection2(sin(24.5 * DEGREE), 1.9, 1.0 / 1.1) == 1.0);
    assert_true(fluid_reflection2(sin(24.8 * DEGREE), 1.9, 1.0 / 1.1) < 0.9);
    assert_close(fluid_reflection2(0.0, 1.5, 1.02), 1.0, 1e-4);
    /* Equal sound speeds: the densities alone, (m - 1) / (m + 1) at any angle. */
    assert_close(fluid_reflection2(0.3, 1.5, 1.0), 0.04, 1e-12);
    /* Total transmission into a slow bottom at the angle of intromission,
     * m sin = sqrt(n^2 - cos^2). */
    double n = 1.02, m = 1.5, sine = sqrt((n * n - 1.0) / (m * m - 1.0));
    assert_close(fluid_reflection2(sine, m, n), 0.0, 1e-12);
    /* A fully developed sea at 10 m/s: significant height 2.14 m. */
    assert_close(4.0 * sea_height_rms_m(10.0 / 0.514444444444444), 2.14, 0.01);
    assert_true(sea_height_rms_m(0.0) == 0.0);
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_flat_mirror_shows_the_unfolded_scene),
        cmocka_unit_test(both_paths_meet_an_integration),
        cmocka_unit_test(every_leg_can_be_hidden),
        cmocka_unit_test(off_is_off),
        cmocka_unit_test(a_curved_mirror_spreads_what_returns),
        cmocka_unit_test(a_calm_surface_shows_the_unfolded_scene),
        cmocka_unit_test(boundaries_scatter_what_they_do_not_mirror),
        cmocka_unit_test(no_more_leaves_than_arrives),
        cmocka_unit_test(boundary_formulas_meet_their_limits),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    test_device_close(&t);
    return failed;
}
