/*
 * Target strengths of bodies, from whole pings: what Urick's table says, on the library's primitives
 * and on meshes made elsewhere, by the sampler that knows nothing of objects and by the one that gives
 * them rays of their own.
 */
#include "target_bodies.h"
#include "target_rig.h"

#include "../unit/lathe.h"

static test_device t;

#define PI 3.14159265358979323846
#define AIR 0.0 /* impedance, Mrayl: reflects everything */

typedef enum body {
    SPHERE, /* primitives */
    CYLINDER,
    PLATE,
    ELLIPSOID, /* meshes */
    TUBE,
    CUT_PLATE,
    DISC,
    CAPSULE /* along x: a yaw of 90 degrees shows its side */
} body;

typedef struct target_case {
    const char *name;
    body body;
    double size_m
        [3]; /* sphere, disc: radius; cylinder: radius, length, a capsule's without domes; plate: sides; ellipsoid:
                         half-axes */
    unsigned segments;
    double yaw_deg;
    double frequency_hz, range_m; /* to the nearest point */
    double roughness_m, slope_rms;
    double expected_db, tolerance_db;
} target_case;

/* Domes of BANDS. */
static asdic_mesh *capsule(double radius_m, double length_m, unsigned bands) {
    enum { MOST = 26 };
    ring rings[MOST];
    assert_true(2 * (bands + 1) <= MOST);
    for (unsigned i = 0; i <= bands; i++) {
        double polar = 0.5 * PI * i / bands, x = 0.5 * length_m + radius_m * cos(polar);
        rings[i] = (ring){-x, radius_m * sin(polar)};
        rings[2 * bands + 1 - i] = (ring){x, radius_m * sin(polar)};
    }
    return lathe_mesh(t.ctx, rings, 2 * (bands + 1), 48);
}

static asdic_mesh *case_mesh(const target_case *c) {
    const double *m = c->size_m;
    asdic_mesh *mesh = NULL;
    switch (c->body) {
    case SPHERE:
        assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, m[0], c->segments, &mesh));
        return mesh;
    case CYLINDER:
        assert_ok(t.ctx, asdic_mesh_cylinder(t.ctx, m[0], m[1], c->segments, &mesh));
        return mesh;
    case PLATE:
        assert_ok(t.ctx, asdic_mesh_plate(t.ctx, m[0], m[1], &mesh));
        return mesh;
    case ELLIPSOID:
        return body_ellipsoid(t.ctx, m, c->segments);
    case TUBE:
        return body_tube(t.ctx, m[0], m[1], c->segments, 7);
    case CUT_PLATE:
        return body_plate(t.ctx, m[0], m[1], c->segments);
    case CAPSULE:
        return capsule(m[0], m[1], c->segments);
    default:
        return body_disc(t.ctx, m[0], c->segments);
    }
}

/* A cylinder turned by 90 degrees shows its end. */
static bool end_on(const target_case *c) {
    return c->body == CYLINDER && c->yaw_deg == 90.0;
}

/* Half of what the beam must see evenly. */
static double case_extent(const target_case *c) {
    const double *m = c->size_m;
    switch (c->body) {
    case CYLINDER:
    case TUBE:
        return end_on(c) ? m[0] : 0.5 * m[1];
    case PLATE:
    case CUT_PLATE:
        return 0.5 * fmax(m[0], m[1]);
    case ELLIPSOID:
        return fmax(m[1], m[2]);
    case CAPSULE:
        return m[0] + 0.5 * m[1];
    default:
        return m[0];
    }
}

/* From the nearest point to the centre. */
static double case_depth(const target_case *c) {
    bool flat = c->body == PLATE || c->body == CUT_PLATE || c->body == DISC;
    if (c->body == ELLIPSOID) {
        double yaw = c->yaw_deg * PI / 180.0;
        return hypot(c->size_m[0] * cos(yaw), c->size_m[1] * sin(yaw));
    }
    if (c->body == CAPSULE) {
        return c->size_m[0] + 0.5 * c->size_m[1] * fabs(cos(c->yaw_deg * PI / 180.0));
    }
    return flat ? 0.0 : end_on(c) ? 0.5 * c->size_m[1] : c->size_m[0];
}

typedef struct strength {
    double db, deviation_db;
} strength;

static strength measure(const target_case *c, asdic_sampler sampler, uint32_t rays, int pings) {
    double centre_m = c->range_m + case_depth(c), deviation;
    target_rig r = target_rig_create(&t, c->frequency_hz, centre_m, case_extent(c) / c->range_m);
    r.sampling.sampler = sampler;
    r.sampling.rays = rays;
    target_rig_add(&r, case_mesh(c), centre_m, c->yaw_deg * PI / 180.0,
                   asdic_material_facet(AIR, c->roughness_m, c->slope_rms));
    double energy = target_rig_energy(&r, ASDIC_OBJECT, pings, &deviation);
    strength s = {target_rig_strength_db(&r, energy, c->range_m), 4.34 * deviation};
    target_rig_destroy(&r);
    return s;
}

/* The sampler with rays for objects keeps to the tolerance as it is; the other one's noise is added,
 * three standard errors of it. */
static int check_case(const target_case *c) {
    strength own = measure(c, ASDIC_SAMPLER_ADAPTIVE, 1 << 17, 4);
    strength beam = measure(c, ASDIC_SAMPLER_BEAM, 1 << 18, 4);
    double off = own.db - c->expected_db, off_beam = beam.db - c->expected_db;
    bool good =
        fabs(off) <= c->tolerance_db && fabs(off_beam) <= c->tolerance_db + 3.0 * beam.deviation_db;
    print_message("%-42s %8.2f %8.2f %+6.2f +- %.2f %+7.2f +- %.2f  (%.1f)%s\n", c->name,
                  c->expected_db, own.db, off, own.deviation_db, off_beam, beam.deviation_db,
                  c->tolerance_db, good ? "" : "  MISSED");
    return !good;
}

#define F 100e3

static const target_case smooth[] = {
    {"sphere a 0.5 m", SPHERE, {0.5}, 96, 0, F, 100, 0, 0, -12.04, 0.5},
    {"  turned by half a segment", SPHERE, {0.5}, 96, 1.875, F, 100, 0, 0, -12.04, 0.5},
    {"  of 24 segments", SPHERE, {0.5}, 24, 0, F, 100, 0, 0, -12.04, 0.5},
    {"  of 24, turned by half a segment", SPHERE, {0.5}, 24, 7.5, F, 100, 0, 0, -12.04, 0.5},
    {"  as a mesh", ELLIPSOID, {0.5, 0.5, 0.5}, 5, 17, F, 100, 0, 0, -12.04, 0.5},
    {"sphere a 2 m", SPHERE, {2}, 96, 0, F, 200, 0, 0, 0.0, 0.5},
    {"sphere a 0.03 m, ka 12.6", SPHERE, {0.03}, 96, 0, F, 20, 0, 0, -36.48, 0.5},
    {"ellipsoid 0.5 x 1 x 0.4 m, end on, mesh",
     ELLIPSOID,
     {0.5, 1, 0.4},
     5,
     0,
     F,
     200,
     0,
     0,
     -7.96,
     0.5},
    {"  turned by 30 degrees",
     ELLIPSOID,
     {1, 0.5, 0.4},
     6,
     30,
     F,
     100,
     0,
     0,
     -18.20, /* R1 R2 = (a b c)^2 / h^4, h^2 = (a cos)^2 + (b sin)^2 */
     0.5},
};

static const target_case rough[] = {
    {"rough sphere a 0.5 m", SPHERE, {0.5}, 96, 0, F, 100, 0.02, 0.1, -7.78, 0.3},
    {"  as a mesh", ELLIPSOID, {0.5, 0.5, 0.5}, 5, 17, F, 100, 0.02, 0.1, -7.78, 0.3},
};

static const target_case straight[] = {
    {"cylinder broadside a 0.25 m, L 1 m", CYLINDER, {0.25, 1}, 96, 0, F, 300, 0, 0, 9.21, 1.0},
    {"  as a mesh, a tube cut unevenly", TUBE, {0.25, 1}, 80, 0, F, 300, 0, 0, 9.21, 1.0},
    {"capsule a 0.2 m, barrel 0.3 m, 4 bands",
     CAPSULE,
     {0.2, 0.3},
     4,
     90,
     F,
     200,
     0,
     0,
     -2.22,
     0.5},
    {"  of 6 bands, barrel 0.15 m", CAPSULE, {0.2, 0.15}, 6, 90, F, 200, 0, 0, -8.24, 0.5},
    {"  turned by 10 degrees", CAPSULE, {0.2, 0.3}, 4, 80, F, 200, 0, 0, -20.0, 0.5},
    {"  of 3 bands", CAPSULE, {0.2, 1.0}, 3, 80, F, 200, 0, 0, -20.0, 0.5},
    {"plate 0.3 x 0.3 m, far", PLATE, {0.3, 0.3}, 0, 0, F, 100, 0, 0, 15.56, 0.3},
    {"plate 0.6 x 0.2 m, far", PLATE, {0.6, 0.2}, 0, 0, F, 100, 0, 0, 18.06, 0.3},
    {"  as a mesh, cut unevenly", CUT_PLATE, {0.6, 0.2}, 12, 0, F, 100, 0, 0, 18.06, 0.3},
    {"plate 4 x 4 m, near", PLATE, {4, 4}, 0, 0, F, 50, 0, 0, 27.96, 1.0},
    {"  as a mesh, cut unevenly", CUT_PLATE, {4, 4}, 12, 0, F, 50, 0, 0, 27.96, 1.0},
    {"  at 1 MHz and 100 m, a lobe of 0.06 degrees",
     PLATE,
     {4, 4},
     0,
     0,
     1e6,
     100,
     0,
     0,
     33.98,
     1.0},
    {"disc r 0.2 m, mesh", DISC, {0.2}, 32, 0, F, 100, 0, 0, 18.46, 0.3},
    {"  as the end of a cylinder", CYLINDER, {0.2, 0.5}, 96, 90, F, 100, 0, 0, 18.46, 0.3},
};

static void check_table(const target_case *cases, size_t count) {
    int missed = 0;
    print_message("%-42s %8s %8s %15s %16s\n", "target strength, dB", "expected", "measured",
                  "own rays", "beam sampler");
    for (size_t k = 0; k < count; k++) {
        missed += check_case(&cases[k]);
    }
    assert_int_equal(missed, 0);
}

static void smooth_bodies(void **state) {
    (void)state;
    check_table(smooth, sizeof smooth / sizeof *smooth);
}

static void rough_bodies(void **state) {
    (void)state;
    check_table(rough, sizeof rough / sizeof *rough);
}

/* A rough bowl sends back what a dome does, of facets that far rays meet as well as near ones. */
static void fine_bowls_far_away(void **state) {
    (void)state;
    static const double ranges_m[] = {2000, 5000};
    for (size_t k = 0; k < sizeof ranges_m / sizeof *ranges_m; k++) {
        double strength_db[2], deviation[2];
        for (int is_bowl = 0; is_bowl < 2; is_bowl++) {
            target_rig r = target_rig_create(&t, 10e3, ranges_m[k], 1.0 / ranges_m[k]);
            target_rig_add(&r, body_half_ball(t.ctx, 1.0, 7, is_bowl), ranges_m[k], 0.0,
                           asdic_material_facet(45.0, 0.2, 0.3));
            double energy = target_rig_energy(&r, ASDIC_OBJECT, 8, &deviation[is_bowl]);
            strength_db[is_bowl] = target_rig_strength_db(&r, energy, ranges_m[k]);
            target_rig_destroy(&r);
        }
        double off_db = strength_db[1] - strength_db[0];
        print_message("at %4g m a bowl has %.3f dB, a dome %.3f, known to %.4f\n", ranges_m[k],
                      strength_db[1], strength_db[0], 4.343 * hypot(deviation[0], deviation[1]));
        assert_true(fabs(off_db) < 0.03);
    }
}

static void straight_and_flat_bodies(void **state) {
    (void)state;
    check_table(straight, sizeof straight / sizeof *straight);
}

/* ---- Glints ---- */

#define BEAMS 65
#define NEAREST_M 20.0

/* Of radii of curvature R1 and R2 geometric optics has R1 R2 / 4, each shortened by d / (d + R) by a wave that comes from
 * d away (G. A. Deschamps, "Ray techniques in electromagnetics", Proc. IEEE 60, 1022 (1972)); here d = 20 m. What is straight
 * one way and far longer than sqrt(lambda d) has d there. */
typedef struct glint_case {
    const char *name;
    body body;
    double size_m[3];
    unsigned segments;
    double frequency_hz, expected_db;
} glint_case;

static const glint_case glints[] = {
    {"sphere a 0.1 m, 3 MHz", SPHERE, {0.1}, 96, 3e6, -26.06},
    {"sphere a 1 m, 300 kHz", SPHERE, {1}, 96, 300e3, -6.44},
    {"  1 MHz", SPHERE, {1}, 96, 1e6, -6.44},
    {"  3 MHz", SPHERE, {1}, 96, 3e6, -6.44},
    {"sphere a 3 m, 300 kHz", SPHERE, {3}, 96, 300e3, 2.31},
    {"  1 MHz", SPHERE, {3}, 96, 1e6, 2.31},
    {"  3 MHz", SPHERE, {3}, 96, 3e6, 2.31},
    {"  as a mesh, 8,192 facets", ELLIPSOID, {3, 3, 3}, 5, 3e6, 2.31},
    {"  131,072 facets, 300 kHz", ELLIPSOID, {3, 3, 3}, 7, 300e3, 2.31},
    {"ellipsoid 0.5 x 2 x 1 m, mesh, 3 MHz", ELLIPSOID, {0.5, 2, 1}, 6, 3e6, 4.15},
    {"cylinder a 0.2 m, L 2 m, 1 MHz", CYLINDER, {0.2, 2}, 96, 1e6, -0.04},
    {"  3 MHz", CYLINDER, {0.2, 2}, 96, 3e6, -0.04},
};

/* Errors of pings, dB: their mean, the largest, and the sum of squares over those stated. */
typedef struct glint_errors {
    double mean_db, most_db, squares;
} glint_errors;

static void hear_glint(const glint_case *c, uint64_t seed, int pings, glint_errors *e) {
    target_case as_case = {.body = c->body, .segments = c->segments};
    memcpy(as_case.size_m, c->size_m, sizeof as_case.size_m);
    double centre_m = NEAREST_M + case_depth(&as_case);
    target_rig r = target_rig_create(&t, c->frequency_hz, centre_m, 0.2);
    asdic_beam receivers[BEAMS];
    r.receiver.length_h_m = 25.0 * 1500.0 / c->frequency_hz;
    for (int b = 0; b < BEAMS; b++) {
        receivers[b] = r.receiver;
        receivers[b].yaw_rad = (b - BEAMS / 2) * PI / 180.0;
    }
    r.sonar.receivers = receivers;
    r.sonar.receiver_count = BEAMS;
    r.sonar.bin_length_m = NEAREST_M / 40.5; /* in the middle of a bin */
    r.sampling.rays = 20000;
    r.sampling.seed = seed;
    double turn_rad = c->body == SPHERE ? 0.1 * (double)seed : 0.0;
    target_rig_add(&r, case_mesh(&as_case), centre_m, turn_rad,
                   asdic_material_facet(AIR, 0.0, 0.0));
    asdic_ping *ping = NULL;
    asdic_simulator *sim = NULL;
    assert_ok(t.ctx, asdic_scene_commit(r.scene));
    assert_ok(t.ctx, asdic_simulator_create(t.ctx, t.device, r.scene, &r.env, &r.sonar, &r.sampling,
                                            r.pose.position_m.z, &sim));
    assert_ok(t.ctx, asdic_ping_create(t.ctx, BEAMS, asdic_simulator_bin_count(sim), &ping));
    assert_ok(t.ctx, asdic_simulator_learn(sim, &r.pose, 0));
    for (int k = 0; k < pings; k++) {
        assert_ok(t.ctx, asdic_simulator_ping(sim, &r.pose, (uint64_t)k, ping));
        size_t first = BEAMS / 2 * ping->bins, loudest = first;
        const double *object = ping->intensity_lin[ASDIC_OBJECT];
        double energy = 0.0;
        for (size_t n = first; n < first + ping->bins; n++) {
            energy += object[n];
            loudest = object[n] > object[loudest] ? n : loudest;
        }
        double off_db = target_rig_strength_db(&r, fmax(energy, 1e-30), NEAREST_M) - c->expected_db;
        double over = off_db / fmax((double)ping->stderr_db[loudest], 0.02);
        e->mean_db += off_db;
        e->most_db = fmax(e->most_db, fabs(off_db));
        e->squares += over * over;
    }
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    target_rig_destroy(&r);
}

/* A smooth body sends back all from a spot of some millimetres, which most rays of a fan miss. Every ping hears it, and
 * states how well; 0.02 dB is left to the facets. */
static void a_fan_hears_small_glints(void **state) {
    (void)state;
    enum { SEEDS = 4, PINGS = 2 };
    int missed = 0;
    print_message("%-42s %8s %8s %8s %12s\n", "65 beams", "expected", "mean off", "most off",
                  "true/stated");
    for (size_t k = 0; k < sizeof glints / sizeof *glints; k++) {
        const glint_case *c = &glints[k];
        glint_errors e = {0.0, 0.0, 0.0};
        for (uint64_t seed = 1; seed <= SEEDS; seed++) {
            hear_glint(c, seed, PINGS, &e);
        }
        e.mean_db /= SEEDS * PINGS;
        double over = sqrt(e.squares / (SEEDS * PINGS));
        bool good = fabs(e.mean_db) < 0.2 && e.most_db < 0.5 && over < 3.0;
        print_message("%-42s %8.2f %+8.2f %8.2f %12.2f%s\n", c->name, c->expected_db, e.mean_db,
                      e.most_db, over, good ? "" : "  MISSED");
        missed += !good;
    }
    assert_int_equal(missed, 0);
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(smooth_bodies),
        cmocka_unit_test(rough_bodies),
        cmocka_unit_test(fine_bowls_far_away),
        cmocka_unit_test(straight_and_flat_bodies),
        cmocka_unit_test(a_fan_hears_small_glints),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
