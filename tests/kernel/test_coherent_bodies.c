/* What only phase shows: lobes of plates and cylinders, and a point's interference with its image. */
#include "coherent_rig.h"

#include "base/vec.h"
#include "laws/scatterer.h"

#include <complex.h>

static test_device t;

#define RANGE_M (53.5 * 0.75) /* the middle of a bin of 0.75 m */

static double sinc(double x) {
    return fabs(x) < 1e-9 ? 1.0 : sin(0.5 * TURN * x) / (0.5 * TURN * x);
}

/* A pulse much longer than a body, and small apertures. */
static ping_rig long_pulse(void) {
    ping_rig r = empty_array(&t);
    r.sonar.bandwidth_hz = 1000.0;
    r.sonar.bin_length_m = 0.75;
    r.sonar.transmitter.length_h_m = r.sonar.transmitter.length_v_m = 1e-4;
    r.sonar.array.elements = 3;
    r.sonar.array.element.length_h_m = r.sonar.array.element.length_v_m = 1e-4;
    r.sampling.rays = 50000;
    return r;
}

/* 10 log10 of what the middle element hears, re a point of 0 dB at RANGE_M. */
static double strength_db(const ping_rig *r, const asdic_ping *ping, double range_m) {
    double alpha = asdic_environment_absorption_db_per_km(&r->env, 100e3, 7.0);
    const float *p = array_at(ping, 1, (size_t)(range_m / ping->sample_m));
    return 10.0 * log10((double)p[0] * p[0] + (double)p[1] * p[1]) + 40.0 * log10(range_m) +
           2.0 * (range_m - 1.0) * alpha / 1000.0;
}

/* Physical optics on the true shape, in double, near field included: the sum over the lit surface of
 * cos i exp(-2 i k r) dS / lambda (Urick 1983, table 9.1, has its limits far away and near the main lobe). */
typedef struct optics {
    double yaw; /* of the body, about its middle */
    double away_m, aside_m;
    double wide_wl; /* of the transmitter */
    double re, im;
} optics;

/* Adds the area DS at P with the normal N, both in the body's frame. */
static void add_area(optics *o, asdic_vec3 p, asdic_vec3 n, double ds) {
    double c = cos(o->yaw), s = sin(o->yaw);
    asdic_vec3 at = {o->away_m + c * p.x - s * p.y, o->aside_m + s * p.x + c * p.y, p.z};
    asdic_vec3 normal = {c * n.x - s * n.y, s * n.x + c * n.y, n.z};
    double r = asdic_vec3_length(at), slant = -asdic_vec3_dot(at, normal) / r;
    if (slant > 0.0) {
        double turn = TURN * fmod(2.0 * r / WAVELENGTH_M, 1.0), spread = pow(o->away_m / r, 2.0);
        double sent = spread * slant * sinc(o->wide_wl * at.y / r);
        o->re += sent * cos(turn) * ds / WAVELENGTH_M;
        o->im -= sent * sin(turn) * ds / WAVELENGTH_M;
    }
}

enum { FINE = 400 };

/* A box's faces in front and at its sides. */
static void add_box(optics *o, asdic_vec3 size) {
    for (int i = 0; i < FINE; i++) {
        double u = (i + 0.5) / FINE - 0.5;
        for (int j = 0; j < FINE; j++) {
            double v = size.z * ((j + 0.5) / FINE - 0.5);
            add_area(o, (asdic_vec3){-0.5 * size.x, u * size.y, v}, (asdic_vec3){-1.0, 0.0, 0.0},
                     size.y * size.z / (FINE * FINE));
            for (int side = -1; side <= 1; side += 2) {
                add_area(o, (asdic_vec3){u * size.x, side * 0.5 * size.y, v},
                         (asdic_vec3){0.0, side, 0.0}, size.x * size.z / (FINE * FINE));
            }
        }
    }
}

/* A cylinder about the y axis, its ends closed. */
static void add_cylinder(optics *o, double radius, double length) {
    for (int i = 0; i < FINE; i++) {
        for (int j = 0; j < 2 * FINE; j++) {
            double turn = TURN * (j + 0.5) / (2 * FINE), x = cos(turn), z = sin(turn);
            double u = (i + 0.5) / FINE, r = radius * u;
            add_area(o, (asdic_vec3){radius * x, length * (u - 0.5), radius * z},
                     (asdic_vec3){x, 0.0, z}, TURN * radius * length / (2 * FINE * FINE));
            for (int side = -1; side <= 1; side += 2) {
                add_area(o, (asdic_vec3){r * x, side * 0.5 * length, r * z},
                         (asdic_vec3){0.0, side, 0.0}, TURN * radius * r / (2 * FINE * FINE));
            }
        }
    }
}

enum { LOBES = 12 };

/* Turns MESH, of the extent LENGTH_M, towards its lobes; SIZE is that of a box, or RADIUS that of a cylinder. The first
 * lobes are compared with the closed form as well: the pattern of a line, and PEAK_DB. The box may lie DOWN below the
 * horizontal: it is then turned upwards, which is the same to a sonar that looks everywhere. */
static void compare_lobes(const asdic_mesh *mesh, asdic_vec3 size, double radius, double peak_db,
                          double down) {
    ping_rig r = long_pulse();
    asdic_material rigid = asdic_material_facet(200.0, 0.0, 0.0);
    double away_m = RANGE_M + (radius > 0.0 ? radius : 0.5 * size.x);
    asdic_pose pose = {.position_m = {away_m * cos(down), 0.0, 7.0 + away_m * sin(down)}};
    assert_ok(t.ctx, asdic_scene_add_moving_object(r.scene, "body", mesh, pose, rigid));
    asdic_simulator *sim = rig_simulator(&r);
    double water = 1e-6 * 1025.0 * 1500.0;
    double reflection_db = 20.0 * log10((200.0 - water) / (200.0 + water));
    double worst = 0.0, worst_closed = 0.0;
    for (int lobe = 0; lobe <= LOBES;
         lobe++) { /* lobe 0 is the main one; others peak near n + 1/2 */
        double x = lobe == 0 ? 0.0 : lobe + 0.5, sine = x * WAVELENGTH_M / (2.0 * size.y);
        *(down != 0.0 ? &pose.pitch_rad : &pose.yaw_rad) = asin(sine) - down; /* bow down */
        assert_ok(t.ctx, asdic_simulator_move(sim, "body", &pose));
        asdic_ping *ping = array_shoot(&r, sim, 0);
        optics o = {.yaw = asin(sine), .away_m = away_m};
        if (radius > 0.0) {
            add_cylinder(&o, radius, size.y);
        } else {
            add_box(&o, size);
        }
        double closed =
            peak_db + 20.0 * log10(fabs(sinc(x)) * sqrt(1.0 - sine * sine)) + reflection_db;
        double expected = 20.0 * log10(hypot(o.re, o.im)) + reflection_db;
        double level = strength_db(&r, ping, RANGE_M);
        print_message("lobe %d: %.2f dB, physical optics %.2f dB, closed form %.2f dB\n", lobe,
                      level, expected, closed);
        worst = fmax(worst, fabs(level - expected));
        worst_closed = fmax(worst_closed, lobe <= 6 ? fabs(level - closed) : 0.0);
        asdic_ping_destroy(&ping);
    }
    print_message("off physical optics by %.2f dB, off the closed form by %.2f dB\n", worst,
                  worst_closed);
    assert_true(worst < 0.5 && worst_closed < 0.5);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

static void a_plate_has_its_lobes(void **state) {
    (void)state;
    const asdic_vec3 size = {0.002, 0.2, 0.2};
    asdic_mesh *mesh = NULL;
    assert_ok(t.ctx, asdic_mesh_box(t.ctx, size, &mesh));
    compare_lobes(mesh, size, 0.0, 20.0 * log10(size.y * size.z / WAVELENGTH_M), 0.0);
    asdic_mesh_destroy(&mesh);
    /* The far side of a sheet is not heard through the near one. */
    const asdic_vec3 sheet = {0.0005, 0.2, 0.2};
    print_message("a sheet, 60 degrees below\n");
    assert_ok(t.ctx, asdic_mesh_box(t.ctx, sheet, &mesh));
    compare_lobes(mesh, sheet, 0.0, 20.0 * log10(size.y * size.z / WAVELENGTH_M),
                  60.0 * RIG_DEGREE);
    asdic_mesh_destroy(&mesh);
}

static void a_cylinder_has_its_lobes(void **state) {
    (void)state;
    const double radius = 0.1, length = 0.25;
    asdic_mesh *mesh = NULL;
    assert_ok(t.ctx, asdic_mesh_cylinder(t.ctx, radius, length, 256, &mesh));
    compare_lobes(mesh, (asdic_vec3){0.0, length, 0.0}, radius,
                  10.0 * log10(radius * length * length / (2.0 * WAVELENGTH_M)), 0.0);
    asdic_mesh_destroy(&mesh);
}

/* A plate that reaches over the zero between a transmitter's lobes, whose signs differ: its parts cancel. */
static void a_plate_is_heard_by_two_lobes(void **state) {
    (void)state;
    static const double aside_m[] = {0.34, 0.38, 0.4, 0.42};
    const asdic_vec3 size = {0.002, 0.2, 0.2};
    const double water = 1e-6 * 1025.0 * 1500.0;
    const double reflection_db = 20.0 * log10((200.0 - water) / (200.0 + water));
    ping_rig r = long_pulse();
    asdic_mesh *mesh = NULL;
    r.sonar.transmitter.length_h_m = 100.0 * WAVELENGTH_M; /* zeros 0.4 m aside */
    asdic_pose pose = {.position_m = {RANGE_M + 0.5 * size.x, 0.0, 7.0}};
    assert_ok(t.ctx, asdic_mesh_box(t.ctx, size, &mesh));
    assert_ok(t.ctx, asdic_scene_add_moving_object(r.scene, "plate", mesh, pose,
                                                   asdic_material_facet(200.0, 0.0, 0.0)));
    asdic_simulator *sim = rig_simulator(&r);
    double worst = 0.0;
    for (int i = 0; i < 4; i++) {
        pose.position_m.y = aside_m[i];
        assert_ok(t.ctx, asdic_simulator_move(sim, "plate", &pose));
        asdic_ping *ping = array_shoot(&r, sim, 0);
        optics o = {.away_m = pose.position_m.x, .aside_m = aside_m[i], .wide_wl = 100.0};
        add_box(&o, size);
        double expected = 20.0 * log10(hypot(o.re, o.im)) + reflection_db;
        double level = strength_db(&r, ping, RANGE_M);
        print_message("%g m aside: %.2f dB, physical optics %.2f dB\n", aside_m[i], level,
                      expected);
        worst = fmax(worst, fabs(level - expected));
        asdic_ping_destroy(&ping);
    }
    assert_true(worst < 0.5);
    asdic_simulator_destroy(&sim);
    asdic_mesh_destroy(&mesh);
    rig_destroy(&r);
}

/* A ball of the facets that a remark of the scene file asks for, 20 wavelengths of radius: as loud from every side, a half
 * of its radius, less what the wave's own curvature takes. */
static void a_ball_is_as_loud_from_everywhere(void **state) {
    (void)state;
    const double radius = 0.3, turns_deg[3][3] = {{0, 0, 0}, {10, 20, 30}, {0, 1.9, 1.9}};
    ping_rig r = long_pulse();
    asdic_mesh *mesh = NULL;
    assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, radius, 210, &mesh));
    asdic_pose pose = {.position_m = {RANGE_M + radius, 0.0, 7.0}};
    assert_ok(t.ctx, asdic_scene_add_moving_object(r.scene, "ball", mesh, pose,
                                                   asdic_material_facet(200.0, 0.0, 0.0)));
    asdic_simulator *sim = rig_simulator(&r);
    double water = 1e-6 * 1025.0 * 1500.0, worst = 0.0;
    double expected = 20.0 * log10(0.5 * radius * RANGE_M / (RANGE_M + radius) * (200.0 - water) /
                                   (200.0 + water));
    for (int i = 0; i < 3; i++) {
        pose.roll_rad = turns_deg[i][0] * RIG_DEGREE;
        pose.pitch_rad = turns_deg[i][1] * RIG_DEGREE;
        pose.yaw_rad = turns_deg[i][2] * RIG_DEGREE;
        assert_ok(t.ctx, asdic_simulator_move(sim, "ball", &pose));
        asdic_ping *ping = array_shoot(&r, sim, 0);
        double level = strength_db(&r, ping, RANGE_M);
        print_message("ball: %.2f dB, closed form %.2f dB\n", level, expected);
        worst = fmax(worst, fabs(level - expected));
        asdic_ping_destroy(&ping);
    }
    assert_true(worst < 0.3);
    asdic_simulator_destroy(&sim);
    asdic_mesh_destroy(&mesh);
    rig_destroy(&r);
}

/* Scatterers of a fine ball, where coordinates reach as far as a plate that is OFF_M away and not heard. */
static unsigned long long scatterers_of_ball(double off_m) {
    ping_rig r = long_pulse();
    asdic_mesh *ball = NULL, *plate = NULL;
    asdic_pose pose = {.position_m = {6.0, 0.4, 7.0}}, far = {.position_m = {off_m, 0.0, 7.0}};
    assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, 0.3, 256, &ball));
    assert_ok(t.ctx, asdic_mesh_plate(t.ctx, 1.0, 1.0, &plate));
    assert_ok(t.ctx, asdic_scene_add_object(r.scene, "ball", ball, pose,
                                            asdic_material_facet(200.0, 0.0, 0.0)));
    assert_ok(t.ctx, asdic_scene_add_object(r.scene, "plate", plate, far,
                                            asdic_material_facet(200.0, 0.0, 0.0)));
    asdic_simulator *sim = rig_simulator(&r);
    asdic_ping *ping = array_shoot(&r, sim, 0);
    unsigned long long rays = ping->rays;
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    asdic_mesh_destroy(&plate);
    asdic_mesh_destroy(&ball);
    rig_destroy(&r);
    return rays;
}

/* Where coordinates are so large that neighbours differ by no more than their rounding, the facets of a ball are no plane. */
static void a_ball_is_no_plane(void **state) {
    (void)state;
    unsigned long long near = scatterers_of_ball(1000.0), far = scatterers_of_ball(6000.0);
    print_message("ball: %llu scatterers, %llu of coarser coordinates\n", near, far);
    assert_in_range(far, near - near / 20, near + near / 20);
}

/* Lloyd's mirror: a point under a smooth surface, heard straight and by way of the surface, both ways, by faces of these
 * heights: in tall ones' side lobes the image has another sign. */
static void hold_fringes(double sent_m, double heard_m) {
    double worst = 0.0, least = INFINITY, most = -INFINITY;
    for (int i = 0; i < 24; i++) {
        ping_rig r = long_pulse();
        asdic_scene_set_surface(r.scene, true);
        r.env.wind_speed_kn = 0.0;
        r.sampling.multipath = ASDIC_MULTIPATH_BOUNDARIES;
        r.sampling.left_out = 1u << ASDIC_TERM_SURFACE | 1u << ASDIC_TERM_BOTTOM;
        r.pose.position_m.z = 1.5;
        r.sonar.transmitter.length_v_m = sent_m;
        r.sonar.array.element.length_v_m = heard_m;
        /* Images in a bottom far below come later; its law is not the surface's. */
        assert_ok(t.ctx, asdic_scene_set_bottom_plane(r.scene, 60.0, asdic_material_bottom(2.0)));
        double depth = 0.6 + 0.03 * i, own = 1.5, across = RANGE_M;
        asdic_vec3 at = {across, 0.0, depth};
        assert_ok(t.ctx, asdic_scene_add_point(r.scene, "p", at, 0.0));
        asdic_simulator *sim = rig_simulator(&r);
        asdic_ping *ping = array_shoot(&r, sim, 0);
        double direct = hypot(across, depth - own), image = hypot(across, depth + own);
        double alpha = asdic_environment_absorption_db_per_km(&r.env, 100e3, 7.0) * log(10.0) / 2e4;
        double a = exp(-alpha * (direct - 1.0)) / direct, b = exp(-alpha * (image - 1.0)) / image;
        double phase = TURN * (image - direct) / WAVELENGTH_M; /* the surface turns the sign */
        double down = (depth - own) / direct / WAVELENGTH_M,
               up = (depth + own) / image / WAVELENGTH_M;
        double complex turned = b * cexp(-I * phase);
        double expected =
            20.0 * log10(cabs(a * sinc(sent_m * down) - turned * sinc(sent_m * up)) *
                         cabs(a * sinc(heard_m * down) - turned * sinc(heard_m * up)));
        const float *p = array_at(ping, 1, (size_t)(direct / ping->sample_m));
        double level = 10.0 * log10((double)p[0] * p[0] + (double)p[1] * p[1]);
        least = fmin(least, expected);
        most = fmax(most, expected);
        worst =
            expected > -40.0 * log10(RANGE_M) - 30.0 ? fmax(worst, fabs(level - expected)) : worst;
        asdic_ping_destroy(&ping);
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
    print_message("faces %g and %g m high: fringes of %.0f dB: off by %.3f dB\n", sent_m, heard_m,
                  most - least, worst);
    assert_true(most - least > (sent_m > 0.1 ? 5.0 : 20.0));
    assert_true(worst < 0.2);
}

static void a_point_interferes_with_its_image(void **state) {
    (void)state;
    hold_fringes(1e-4, 1e-4);
    hold_fringes(0.36, 0.05);
    hold_fringes(0.05, 0.36);
    hold_fringes(0.36, 0.36);
}

/* R of a fluid bottom for waves exp(i (w t - k x)), its size from LAW, which roughness makes less. */
static double complex reflection(const asdic_scatterer *law, const double *fluid, double sine) {
    double complex kappa = (1.0 - I * fluid[2]) / fluid[1];
    double complex through = csqrt(kappa * kappa - (1.0 - sine * sine));
    through = cimag(through) > 0.0 ? -through : through; /* fades downwards */
    double complex r = (fluid[0] * sine - through) / (fluid[0] * sine + through);
    return sqrt(law->material.law->reflected(law, sine)) * r / cabs(r);
}

/* A point, far louder than the bottom below, over sand and a smooth sediment with losses: at grazing angles that they
 * reflect all of, and steeper. */
static void a_bottom_turns_the_phase(void **state) {
    (void)state;
    static const double fluid[2][4] = {{1.9, 1.1, 0.0}, {1.7, 1.15, 0.03, 1e-6}};
    static const double across_m[] = {40.0, 14.0}, own_m[] = {2.0, 8.0}, from_m[] = {0.3, 0.05};
    double worst = 0.0, least = INFINITY, most = -INFINITY;
    asdic_material bottom[2] = {asdic_material_bottom(2.0),
                                asdic_material_of(asdic_law_find("apl-bottom"))};
    static const char *const keys[] = {"density_ratio", "sound_speed_ratio", "loss_ratio",
                                       "spectral_strength_cm4"};
    assert_ok(t.ctx, asdic_material_set(t.ctx, &bottom[1], "grain_size_phi", 1.5));
    for (int k = 0; k < 4; k++) {
        assert_ok(t.ctx, asdic_material_set(t.ctx, &bottom[1], keys[k], fluid[1][k]));
    }
    for (int i = 0; i < 48; i++) {
        int law = i % 2, steep = i / 2 % 2;
        ping_rig r = long_pulse();
        r.sampling.multipath = ASDIC_MULTIPATH_BOUNDARIES;
        double own = own_m[steep], above = from_m[steep] * (1.0 + 0.1 * (i / 4));
        double depth = r.pose.position_m.z + own, across = across_m[steep];
        assert_ok(t.ctx, asdic_scene_set_bottom_plane(r.scene, depth, bottom[law]));
        asdic_vec3 at = {across, 0.0, depth - above};
        assert_ok(t.ctx, asdic_scene_add_point(r.scene, "p", at, 80.0));
        asdic_simulator *sim = rig_simulator(&r);
        asdic_ping *ping = array_shoot(&r, sim, 0);
        double direct = hypot(across, own - above), image = hypot(across, own + above);
        double alpha = asdic_environment_absorption_db_per_km(&r.env, 100e3, 7.0) * log(10.0) / 2e4;
        asdic_law_water water = {100e3, 1500.0, WAVELENGTH_M, 0.0};
        asdic_scatterer scatterer = asdic_scatterer_at(&bottom[law], &water);
        double complex one_way = exp(-alpha * (direct - 1.0)) / direct +
                                 reflection(&scatterer, fluid[law], (own + above) / image) *
                                     exp(-alpha * (image - 1.0)) / image *
                                     cexp(-I * TURN * (image - direct) / WAVELENGTH_M);
        double expected = 80.0 + 40.0 * log10(cabs(one_way) * direct);
        const float *p = array_at(ping, 1, (size_t)(direct / ping->sample_m));
        double level = 10.0 * log10((double)p[0] * p[0] + (double)p[1] * p[1]);
        least = fmin(least, expected);
        most = fmax(most, expected);
        worst = fmax(worst, fabs(level + 40.0 * log10(direct) - expected));
        asdic_ping_destroy(&ping);
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
    print_message("over bottoms fringes of %.0f dB: off by %.3f dB\n", most - least, worst);
    assert_true(most - least > 20.0);
    assert_true(worst < 0.2);
}

/* A level plate between sonar and surface is seen from below, and its image from above: out by one way and back by
 * the other nothing is heard. */
static void nothing_goes_through_a_plate(void **state) {
    (void)state;
    /* Straight, sqrt(10^2 + 4^2); one of each; by the image, sqrt(10^2 + 10^2). */
    double ways[2][3] = {{0.0}};
    for (int with = 0; with < 2; with++) {
        ping_rig r = empty_array(&t);
        asdic_mesh *mesh = NULL;
        const asdic_pose pose = {.position_m = {10.0, 0.0, 3.0}, .pitch_rad = 90.0 * RIG_DEGREE};
        asdic_scene_set_surface(r.scene, true);
        r.env.wind_speed_kn = 0.0;
        r.sampling.multipath = ASDIC_MULTIPATH_BOUNDARIES;
        r.sampling.left_out = 1u << ASDIC_TERM_VOLUME;
        assert_ok(t.ctx, asdic_mesh_plate(t.ctx, 0.5, 0.5, &mesh));
        if (with) {
            assert_ok(t.ctx, asdic_scene_add_object(r.scene, "plate", mesh, pose,
                                                    asdic_material_bottom(2.0)));
        }
        asdic_simulator *sim = rig_simulator(&r);
        asdic_ping *ping = array_shoot(&r, sim, 0);
        for (size_t n = 0; n < ping->samples; n++) {
            double range_m = ((double)n + 0.5) * ping->sample_m;
            const float *p = array_at(ping, 1, n);
            ways[with][range_m < 11.5   ? 0
                       : range_m < 13.5 ? 1
                                        : 2] += (double)p[0] * p[0] + (double)p[1] * p[1];
        }
        asdic_ping_destroy(&ping);
        asdic_simulator_destroy(&sim);
        asdic_mesh_destroy(&mesh);
        rig_destroy(&r);
    }
    double by_image = ways[1][2] - ways[0][2];
    print_message("both ways %.2g of what is heard by the image\n",
                  (ways[1][1] - ways[0][1]) / by_image);
    assert_true(ways[1][0] > ways[0][0] && by_image > 0.5 * ways[1][2]);
    assert_close((ways[1][1] - ways[0][1]) / by_image, 0.0, 1e-3);
}

/* A point just below the skin of a body, as one that lies on it may be, is heard; one deeper is not. */
static void a_point_on_a_wall_is_heard(void **state) {
    (void)state;
    for (int deep = 0; deep < 2; deep++) {
        ping_rig r = long_pulse();
        asdic_mesh *mesh = NULL;
        const asdic_pose wall = {.position_m = {RANGE_M, 0.0, 7.0}};
        const asdic_vec3 at = {RANGE_M + (deep ? 8e-3 : 2e-3), 0.0, 7.0};
        asdic_material quiet = asdic_material_of(asdic_law_find("lambert"));
        assert_ok(t.ctx, asdic_material_set(t.ctx, &quiet, "lambert_db", -100.0));
        assert_ok(t.ctx, asdic_mesh_plate(t.ctx, 0.5, 0.5, &mesh));
        assert_ok(t.ctx, asdic_scene_add_object(r.scene, "wall", mesh, wall, quiet));
        assert_ok(t.ctx, asdic_scene_add_point(r.scene, "p", at, 0.0));
        asdic_simulator *sim = rig_simulator(&r);
        asdic_ping *ping = array_shoot(&r, sim, 0);
        assert_true(deep ? strength_db(&r, ping, RANGE_M) < -40.0
                         : fabs(strength_db(&r, ping, RANGE_M)) < 0.5);
        asdic_ping_destroy(&ping);
        asdic_simulator_destroy(&sim);
        asdic_mesh_destroy(&mesh);
        rig_destroy(&r);
    }
}

/* A smooth wall far from the direction that it mirrors in, where little is left of what its parts send, has its lobes however
 * few rays are asked for. */
static void a_wall_turned_away_is_as_quiet_as_it_is(void **state) {
    (void)state;
    const asdic_vec3 size = {0.002, 0.6, 0.6};
    const double water = 1e-6 * 1025.0 * 1500.0, away_m = RANGE_M + 0.5 * size.x;
    asdic_mesh *mesh = NULL;
    double worst = 0.0;
    unsigned long long most = 0;
    assert_ok(t.ctx, asdic_mesh_box(t.ctx, size, &mesh));
    for (int i = 0; i < 12; i++) {
        ping_rig r = long_pulse();
        r.sampling.rays = i % 2 ? 1000 : 20000;
        r.sampling.left_out = 1u << ASDIC_TERM_VOLUME;
        double sine = (16.5 + 2.0 * (i / 2)) * WAVELENGTH_M / (2.0 * size.y);
        asdic_pose pose = {.position_m = {away_m, 0.0, 7.0}, .yaw_rad = asin(sine)};
        assert_ok(t.ctx, asdic_scene_add_object(r.scene, "wall", mesh, pose,
                                                asdic_material_facet(200.0, 0.0, 0.0)));
        asdic_simulator *sim = rig_simulator(&r);
        asdic_ping *ping = array_shoot(&r, sim, 0);
        optics o = {.yaw = pose.yaw_rad, .away_m = away_m};
        add_box(&o, size);
        double expected = 20.0 * log10(hypot(o.re, o.im) * (200.0 - water) / (200.0 + water));
        double level = strength_db(&r, ping, RANGE_M);
        print_message("%u rays, sine %.3f: %.2f dB, physical optics %.2f dB\n", r.sampling.rays,
                      sine, level, expected);
        worst = fmax(worst, fabs(level - expected));
        most = ping->rays > most ? ping->rays : most;
        asdic_ping_destroy(&ping);
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
    print_message("off by %.2f dB, %llu scatterers at most\n", worst, most);
    assert_true(worst < 0.2 && most < 100000);
    asdic_mesh_destroy(&mesh);
}

/* A smooth wall takes far fewer scatterers than one a quarter of a wavelength. */
static void a_wall_has_few_scatterers(void **state) {
    (void)state;
    ping_rig r = long_pulse();
    asdic_mesh *mesh = NULL;
    asdic_pose pose = {.position_m = {40.0, 0.0, 7.0}};
    r.sampling.left_out = 1u << ASDIC_TERM_VOLUME;
    assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){0.01, 1.0, 1.0}, &mesh));
    assert_ok(t.ctx, asdic_scene_add_object(r.scene, "wall", mesh, pose,
                                            asdic_material_facet(200.0, 0.0, 0.0)));
    asdic_simulator *sim = rig_simulator(&r);
    asdic_ping *ping = array_shoot(&r, sim, 0);
    print_message("%llu scatterers\n", (unsigned long long)ping->rays);
    assert_in_range(ping->rays, 100, 20000);
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    asdic_mesh_destroy(&mesh);
    rig_destroy(&r);
}

/* A sonar in a closed body, as in a tank, hears its wall: the mirror image of the transmitter, twice as far away. */
static void a_tank_is_heard_from_within(void **state) {
    (void)state;
    const double away_m = 1.5, water = 1e-6 * 1025.0 * 1500.0;
    ping_rig r = long_pulse();
    asdic_mesh *mesh = NULL;
    asdic_pose pose = {.position_m = {0.0, 0.0, 7.0}};
    r.sampling.left_out = 1u << ASDIC_TERM_VOLUME;
    r.sonar.max_range_m = 2.25;
    assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){2.0 * away_m, 6.0, 6.0}, &mesh));
    assert_ok(t.ctx, asdic_scene_add_object(r.scene, "tank", mesh, pose,
                                            asdic_material_facet(200.0, 0.0, 0.0)));
    asdic_simulator *sim = rig_simulator(&r);
    asdic_ping *ping = array_shoot(&r, sim, 0);
    double level = strength_db(&r, ping, away_m);
    double expected = 20.0 * log10(0.5 * away_m * (200.0 - water) / (200.0 + water));
    print_message("tank: %.2f dB, by its image %.2f dB\n", level, expected);
    assert_close(level, expected, 0.3);
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    asdic_mesh_destroy(&mesh);
    rig_destroy(&r);
}

/* A wall, by its middle and attitude, before a sonar at the origin. */
typedef struct wall {
    double wide_m, high_m;
    asdic_vec3 at_m;
    double yaw, pitch;
    size_t elements;
    double wide_wl; /* of the transmitter */
} wall;

enum { PICKED = 3 };

/* What SPOT of the wall's surface, DU by DV along the unit vectors U and V, adds to the pressure at Y on the line. */
static void add_spot(const ping_rig *r, const asdic_vec3 *spot, const asdic_vec3 axes[3], double du,
                     double dv, double y, const asdic_ping *ping, double complex *sum) {
    double pulse_m = 750.0 / r->sonar.bandwidth_hz;
    double alpha = asdic_environment_absorption_db_per_km(&r->env, 100e3, 7.0) * log(10.0) / 2e4;
    asdic_vec3 to = {spot->x, spot->y - y, spot->z};
    double out = asdic_vec3_length(*spot), back = asdic_vec3_length(to), both = out + back;
    asdic_vec3 mean = asdic_vec3_scale(
        asdic_vec3_add(asdic_vec3_scale(*spot, 1.0 / out), asdic_vec3_scale(to, 1.0 / back)), 0.5);
    double size = fabs(asdic_vec3_dot(mean, axes[2])) / (WAVELENGTH_M * out * back) * du * dv *
                  exp(-alpha * (both - 2.0)) *
                  sinc(r->sonar.transmitter.length_h_m / WAVELENGTH_M * spot->y / out) *
                  sinc(2.0 * du * asdic_vec3_dot(mean, axes[0]) / WAVELENGTH_M) *
                  sinc(2.0 * dv * asdic_vec3_dot(mean, axes[1]) / WAVELENGTH_M);
    double complex phase = size * cexp(-I * TURN * fmod(both / WAVELENGTH_M, 1.0));
    double from = (0.5 * both - PULSE_REACH * pulse_m) / ping->sample_m - 0.5;
    for (size_t n = (size_t)ceil(fmax(from, 0.0)); n < ping->samples; n++) {
        double off_m = 0.5 * both - ((double)n + 0.5) * ping->sample_m;
        if (off_m < -PULSE_REACH * pulse_m) {
            break;
        }
        double step_m = 1e-6 * pulse_m, rise = pulse_at(off_m + step_m, 1.0 / pulse_m) -
                                               pulse_at(off_m - step_m, 1.0 / pulse_m);
        double complex band = I * rise / (2.0 * step_m) * WAVELENGTH_M / (2.0 * TURN);
        sum[n] += phase * (pulse_at(off_m, 1.0 / pulse_m) + band);
    }
}

/* What a wall is made of: SQUARES by SQUARES of two triangles, whose corners within are MOVED by a share of them, or NEEDLES from
 * a corner to the far sides. */
typedef struct tiling {
    uint32_t squares;
    double moved;
    uint32_t needles;
    bool two_sided; /* each triangle once more, wound the other way */
} tiling;

enum { MOST_SQUARES = 250, MOST_FACETS = 2 * MOST_SQUARES * MOST_SQUARES };

typedef struct facets {
    double vertices[3 * (MOST_SQUARES + 1) * (MOST_SQUARES + 1)];
    uint32_t corners[3 * MOST_FACETS];
    size_t vertex_count, count;
} facets;

/* At shares U and V of a wall. */
static void add_vertex(facets *all, const wall *w, double u, double v) {
    double *at = &all->vertices[3 * all->vertex_count++];
    at[0] = 0.0;
    at[1] = w->wide_m * (u - 0.5);
    at[2] = w->high_m * (v - 0.5);
}

static void add_facet(facets *all, uint32_t a, uint32_t b, uint32_t c) {
    const uint32_t own[3] = {a, b, c};
    memcpy(&all->corners[3 * all->count++], own, sizeof own);
}

static void add_squares(facets *all, const wall *w, const tiling *of) {
    uint32_t n = of->squares;
    for (uint32_t i = 0; i < (n + 1) * (n + 1); i++) {
        uint32_t x = i % (n + 1), y = i / (n + 1);
        random4 draw = random_draw(i, 0, 0, RANDOM_SCATTERER, 1, 2);
        double u = 2.0 * random_uniform(draw.v[0]) - 1.0, v = 2.0 * random_uniform(draw.v[1]) - 1.0;
        add_vertex(all, w, (x + (x % n ? of->moved * u : 0.0)) / n,
                   (y + (y % n ? of->moved * v : 0.0)) / n);
    }
    for (uint32_t i = 0; i < n * n; i++) {
        uint32_t a = i / n * (n + 1) + i % n, b = a + n + 1;
        add_facet(all, a, b, a + 1);
        add_facet(all, a + 1, b, b + 1);
    }
}

static void add_needles(facets *all, const wall *w, uint32_t needles) {
    add_vertex(all, w, 0.0, 0.0);
    for (uint32_t i = 0; i <= needles; i++) {
        add_vertex(all, w, 1.0, (double)i / needles);
    }
    add_vertex(all, w, 0.0, 1.0);
    for (uint32_t i = 0; i <= needles; i++) {
        add_facet(all, 0, i + 1, i + 2);
    }
}

/* NULL: a plate. */
static asdic_mesh *mesh_of(const wall *w, const tiling *of) {
    static facets all;
    asdic_mesh *mesh = NULL;
    if (!of) {
        assert_ok(t.ctx, asdic_mesh_plate(t.ctx, w->wide_m, w->high_m, &mesh));
        return mesh;
    }
    all.vertex_count = all.count = 0;
    if (of->needles > 0) {
        add_needles(&all, w, of->needles);
    } else {
        add_squares(&all, w, of);
    }
    for (size_t i = 0, count = all.count; of->two_sided && i < count; i++) {
        const uint32_t *own = &all.corners[3 * i];
        add_facet(&all, own[0], own[2], own[1]);
    }
    assert_ok(t.ctx, asdic_mesh_from_triangles(t.ctx, all.vertices, all.vertex_count, all.corners,
                                               all.count, &mesh));
    return mesh;
}

/* Holds elements at both ends and in the middle against the sum over an eighth of a wavelength of the wall each, in double;
 * returns the scatterers of the ping. */
static unsigned long long hold_wall(const wall *w, const tiling *of, double *worst_db,
                                    double *worst) {
    const double cell = WAVELENGTH_M / 8.0, water = 1e-6 * 1025.0 * 1500.0;
    const double reflection = (200.0 - water) / (200.0 + water);
    ping_rig r = long_pulse();
    asdic_mesh *mesh = mesh_of(w, of);
    r.sonar.bandwidth_hz = 10e3;
    r.sonar.bin_length_m = 0.075;
    r.sonar.array.elements = w->elements;
    r.sonar.transmitter.length_h_m = fmax(w->wide_wl * WAVELENGTH_M, 1e-4);
    r.sampling.left_out = 1u << ASDIC_TERM_VOLUME;
    asdic_pose pose = {.position_m = {w->at_m.x, w->at_m.y, 7.0 + w->at_m.z},
                       .yaw_rad = w->yaw,
                       .pitch_rad = w->pitch};
    assert_ok(t.ctx, asdic_scene_add_object(r.scene, "wall", mesh, pose,
                                            asdic_material_facet(200.0, 0.0, 0.0)));
    asdic_simulator *sim = rig_simulator(&r);
    asdic_ping *ping = array_shoot(&r, sim, 0);
    asdic_mat3 m = asdic_mat3_of(&pose);
    const asdic_vec3 axes[3] = {{m.m[0][1], m.m[1][1], m.m[2][1]},
                                {m.m[0][2], m.m[1][2], m.m[2][2]},
                                {m.m[0][0], m.m[1][0], m.m[2][0]}};
    size_t picked[PICKED] = {0, w->elements / 2, w->elements - 1};
    for (int i = 0; i < PICKED; i++) {
        double y = ((double)picked[i] - 0.5 * (double)(w->elements - 1)) * 0.5 * WAVELENGTH_M;
        double complex *sum = calloc(ping->samples, sizeof *sum);
        double peak = 0.0, off = 0.0, off_db = 0.0;
        assert_non_null(sum);
        size_t across = (size_t)ceil(w->wide_m / cell), up = (size_t)ceil(w->high_m / cell);
        double du = w->wide_m / (double)across, dv = w->high_m / (double)up;
        for (size_t a = 0; a < across; a++) {
            for (size_t b = 0; b < up; b++) {
                double u = ((double)a + 0.5) * du - 0.5 * w->wide_m;
                double v = ((double)b + 0.5) * dv - 0.5 * w->high_m;
                asdic_vec3 spot =
                    asdic_vec3_add(w->at_m, asdic_vec3_add(asdic_vec3_scale(axes[0], u),
                                                           asdic_vec3_scale(axes[1], v)));
                add_spot(&r, &spot, axes, du, dv, y, ping, sum);
            }
        }
        double unit = reflection * pow(10.0, r.sonar.source_level_db / 20.0);
        for (size_t n = 0; n < ping->samples; n++) {
            const float *p = array_at(ping, picked[i], n);
            double level = hypot((double)p[0], (double)p[1]) / unit, due = cabs(sum[n]);
            off = fmax(off, cabs(p[0] / unit + I * (p[1] / unit) - sum[n]));
            off_db = due > peak ? 20.0 * log10(level / due) : off_db;
            peak = fmax(peak, due);
        }
        print_message("element %zu: peak %.2f dB, off by %.3f dB, samples by %.4f of it\n",
                      picked[i], 20.0 * log10(peak), off_db, off / peak);
        *worst = fmax(*worst, off / peak);
        *worst_db = fmax(*worst_db, fabs(off_db));
        free(sum);
    }
    unsigned long long rays = ping->rays;
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    asdic_mesh_destroy(&mesh);
    rig_destroy(&r);
    return rays;
}

/* Large smooth walls, aside of the direction that they mirror in and across it, far from small arrays and near long ones. Over a
 * band of a tenth of the carrier each frequency has its own wavelength in what it returns of an area. */
static void a_wall_is_the_sum_over_its_area(void **state) {
    (void)state;
    static const wall aside[] = {
        {2.0, 2.0, {8.0, 0.0, 0.0}, 30.0 * RIG_DEGREE, 0.0, 3},
        {2.0, 2.0, {8.0, 0.0, 0.0}, 30.0 * RIG_DEGREE, 10.0 * RIG_DEGREE, 96},
        {2.0, 2.0, {6.0, -1.0, 0.4}, 15.0 * RIG_DEGREE, 5.0 * RIG_DEGREE, 96},
        {3.0, 0.5, {5.0, 2.0, 0.4}, -30.0 * RIG_DEGREE, 0.0, 64},
    };
    static const wall across[] = {
        {2.0, 2.0, {8.0, 0.5, 0.3}, 12.0 * RIG_DEGREE, 3.0 * RIG_DEGREE, 3},
        {2.0, 2.0, {8.0, 0.0, 0.0}, 5.0 * RIG_DEGREE, 0.0, 3},
        {2.0, 2.0, {8.0, 0.0, 0.0}, 0.0, 0.0, 3},
        {0.9, 0.6, {2.0, 0.0, 0.0}, 4.0 * RIG_DEGREE, 3.0 * RIG_DEGREE, 96},
    };
    double worst_db = 0.0, worst = 0.0, worst_across = 0.0;
    unsigned long long most = 0;
    for (size_t i = 0; i < sizeof aside / sizeof *aside; i++) {
        unsigned long long rays = hold_wall(&aside[i], NULL, &worst_db, &worst);
        most = rays > most ? rays : most;
    }
    for (size_t i = 0; i < sizeof across / sizeof *across; i++) {
        unsigned long long rays = hold_wall(&across[i], NULL, &worst_db, &worst_across);
        most = rays > most ? rays : most;
    }
    print_message("peaks off by %.3f dB, samples by %.4f of the peak, %.4f where a wall mirrors; "
                  "%llu scatterers at most\n",
                  worst_db, worst, worst_across, most);
    assert_true(worst_db < 0.02 && worst < 0.012 && worst_across < 0.012);
    assert_in_range(most, 1000, 10000);
}

/* Its ends where the lobes of a large face change from one wavelength to the next, as its beam looks past them. */
static void a_wall_reaches_into_side_lobes(void **state) {
    (void)state;
    static const wall w = {0.6, 0.3, {2.0, 0.0, 0.0}, 30.0 * RIG_DEGREE, 0.0, 16, 20.0};
    double worst_db = 0.0, worst = 0.0;
    hold_wall(&w, NULL, &worst_db, &worst);
    assert_true(worst_db < 0.15 && worst < 0.05);
}

/* However many triangles it is made of, it takes about as many scatterers: they have no edges of their own. Cells
 * of 133 to 0.27 wavelengths. */
static void a_wall_of_many_triangles_is_as_loud(void **state) {
    (void)state;
    static const wall large = {2.0, 2.0, {8.0, 0.0, 0.0}, 25.0 * RIG_DEGREE, 10.0 * RIG_DEGREE, 16};
    static const wall small = {1.0, 1.0, {6.0, 0.4, 0.2}, 25.0 * RIG_DEGREE, 10.0 * RIG_DEGREE, 16};
    static const struct {
        const wall *wall;
        tiling of;
    } cases[] = {
        {&large, {.squares = 1}},
        {&large, {.squares = 5}},
        {&large, {.squares = 50}},
        {&small, {.squares = 45, .moved = 0.25}},
        {&small, {.squares = 80, .moved = 0.25}},
        {&small, {.squares = 150}},
        {&small, {.squares = 250}},
        {&small, {.needles = 200}},
        {&small, {.needles = 20000}},
        {&small, {.squares = 60, .moved = 0.25, .two_sided = true}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double worst_db = 0.0, worst = 0.0;
        const tiling *of = &cases[i].of;
        unsigned long long rays = hold_wall(cases[i].wall, of, &worst_db, &worst);
        print_message("%u squares, moved by %g, %u needles, %llu scatterers: peaks off by %.3f dB, "
                      "samples by %.4f\n",
                      of->squares, of->moved, of->needles, rays, worst_db, worst);
        assert_true(worst_db < 0.02 && worst < 0.012);
        assert_in_range(rays, 300, of->needles > 1000 ? 25000 : 2500);
    }
}

/* Edge-on, nothing of it is seen from the middle of the array: it is quiet to every element, and finite. */
static void a_plate_edge_on_is_quiet(void **state) {
    (void)state;
    static const double vertices[] = {-0.0015, 0.0, -1.0, 0.0015,  0.0, -1.0,
                                      0.0015,  0.0, 1.0,  -0.0015, 0.0, 1.0};
    static const uint32_t corners[] = {0, 1, 2, 0, 2, 3};
    double peak[2] = {0.0, 0.0};
    for (int facing = 0; facing < 2; facing++) {
        ping_rig r = long_pulse();
        asdic_mesh *mesh = NULL;
        r.sonar.array.elements = 8;
        r.sampling.left_out = 1u << ASDIC_TERM_VOLUME;
        asdic_pose pose = {.position_m = {6.0, 0.0, 7.0}, .yaw_rad = facing ? 0.25 * TURN : 0.0};
        assert_ok(t.ctx, asdic_mesh_from_triangles(t.ctx, vertices, 4, corners, 2, &mesh));
        assert_ok(t.ctx, asdic_scene_add_object(r.scene, "plate", mesh, pose,
                                                asdic_material_facet(200.0, 0.0, 0.0)));
        asdic_simulator *sim = rig_simulator(&r);
        asdic_ping *ping = array_shoot(&r, sim, 0);
        for (size_t e = 0; e < r.sonar.array.elements; e++) {
            for (size_t n = 0; n < ping->samples; n++) {
                const float *p = array_at(ping, e, n);
                assert_true(isfinite(p[0]) && isfinite(p[1]));
                peak[facing] = fmax(peak[facing], hypot((double)p[0], (double)p[1]));
            }
        }
        asdic_ping_destroy(&ping);
        asdic_simulator_destroy(&sim);
        asdic_mesh_destroy(&mesh);
        rig_destroy(&r);
    }
    print_message("edge-on %.1f dB of what it is facing\n", 20.0 * log10(peak[0] / peak[1]));
    assert_true(peak[0] < 0.01 * peak[1]);
}

/* A wall that goes on below the bottom is the part above it, as is one that ends there. */
static void a_wall_ends_at_the_bottom(void **state) {
    (void)state;
    asdic_ping *pings[2];
    for (int ends = 0; ends < 2; ends++) {
        ping_rig r = long_pulse();
        asdic_mesh *mesh = NULL;
        double high_m = ends ? 1.0 : 2.0;
        const asdic_pose pose = {.position_m = {8.0, 0.0, 8.0 - 0.5 * high_m + (ends ? 0.0 : 1.0)},
                                 .yaw_rad = 30.0 * RIG_DEGREE};
        r.sonar.bandwidth_hz = 10e3;
        r.sonar.bin_length_m = 0.075;
        r.sampling.left_out = 1u << ASDIC_TERM_VOLUME | 1u << ASDIC_TERM_BOTTOM;
        assert_ok(t.ctx, asdic_scene_set_bottom_plane(r.scene, 8.0, asdic_material_bottom(2.0)));
        assert_ok(t.ctx, asdic_mesh_plate(t.ctx, 2.0, high_m, &mesh));
        assert_ok(t.ctx, asdic_scene_add_object(r.scene, "wall", mesh, pose,
                                                asdic_material_facet(200.0, 0.0, 0.0)));
        asdic_simulator *sim = rig_simulator(&r);
        pings[ends] = array_shoot(&r, sim, 0);
        print_message("%llu scatterers\n", (unsigned long long)pings[ends]->rays);
        asdic_simulator_destroy(&sim);
        asdic_mesh_destroy(&mesh);
        rig_destroy(&r);
    }
    double peak = 0.0, off = 0.0;
    for (size_t n = 0; n < pings[0]->samples; n++) {
        const float *p = array_at(pings[0], 1, n), *q = array_at(pings[1], 1, n);
        peak = fmax(peak, hypot((double)q[0], (double)q[1]));
        off = fmax(off, hypot((double)(p[0] - q[0]), (double)(p[1] - q[1])));
    }
    print_message("samples apart by %.4f of the peak\n", off / peak);
    assert_true(peak > 0.0 && off < 0.01 * peak);
    asdic_ping_destroy(&pings[0]);
    asdic_ping_destroy(&pings[1]);
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tank_is_heard_from_within),
        cmocka_unit_test(a_wall_has_few_scatterers),
        cmocka_unit_test(a_wall_turned_away_is_as_quiet_as_it_is),
        cmocka_unit_test(a_wall_is_the_sum_over_its_area),
        cmocka_unit_test(a_wall_reaches_into_side_lobes),
        cmocka_unit_test(a_wall_of_many_triangles_is_as_loud),
        cmocka_unit_test(a_plate_edge_on_is_quiet),
        cmocka_unit_test(a_wall_ends_at_the_bottom),
        cmocka_unit_test(a_plate_has_its_lobes),
        cmocka_unit_test(a_cylinder_has_its_lobes),
        cmocka_unit_test(a_plate_is_heard_by_two_lobes),
        cmocka_unit_test(a_ball_is_as_loud_from_everywhere),
        cmocka_unit_test(a_ball_is_no_plane),
        cmocka_unit_test(a_point_interferes_with_its_image),
        cmocka_unit_test(a_bottom_turns_the_phase),
        cmocka_unit_test(nothing_goes_through_a_plate),
        cmocka_unit_test(a_point_on_a_wall_is_heard),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
