/* Target strengths of bodies, from whole pings: what Urick's table says. */
#include "target_rig.h"

static test_device t;

#define SPEED_MPS 1500.0
#define PI 3.14159265358979323846
#define AIR 0.0 /* impedance, Mrayl: reflects everything */

typedef enum body { SPHERE, CYLINDER, PLATE, DISC, ELLIPSOID } body;

typedef struct target_case {
    const char *name;
    body body;
    double size_m[3]; /* sphere: radius; cylinder: radius, length; plate: sides; disc: radius;
                         ellipsoid: half-axes */
    unsigned segments;
    double yaw_deg;
    double frequency_hz, range_m; /* to the nearest point */
    double roughness_m, slope_rms;
    double expected_db, tolerance_db;
} target_case;

/* A flat polygon of SEGMENTS corners with the area of a disc, its normal along x. */
static asdic_mesh *disc_mesh(double radius_m, unsigned segments) {
    double *v = malloc(3 * (segments + 1) * sizeof *v);
    uint32_t *f = malloc(3 * segments * sizeof *f);
    double corner_m = radius_m * sqrt(PI / (0.5 * segments * sin(2.0 * PI / segments)));
    v[0] = v[1] = v[2] = 0.0;
    for (unsigned i = 0; i < segments; i++) {
        v[3 * i + 3] = 0.0;
        v[3 * i + 4] = corner_m * cos(2.0 * PI * i / segments);
        v[3 * i + 5] = corner_m * sin(2.0 * PI * i / segments);
        f[3 * i] = 0;
        f[3 * i + 1] = i + 1;
        f[3 * i + 2] = (i + 1) % segments + 1;
    }
    asdic_mesh *mesh = NULL;
    assert_ok(t.ctx, asdic_mesh_from_triangles(t.ctx, v, segments + 1, f, segments, &mesh));
    free(v);
    free(f);
    return mesh;
}

/* A unit sphere stretched along the axes, from the octahedron by halving edges: no poles. */
typedef struct soup {
    double *v;
    uint32_t *f;
    size_t vertices, facets;
    const double *size_m;
} soup;

static uint32_t soup_vertex(soup *s, const double p[3]) {
    double length = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    for (int k = 0; k < 3; k++) {
        s->v[3 * s->vertices + k] = s->size_m[k] * p[k] / length;
    }
    return (uint32_t)s->vertices++;
}

static void soup_split(soup *s, const double a[3], const double b[3], const double c[3],
                       unsigned levels) {
    if (levels == 0) {
        uint32_t *f = s->f + 3 * s->facets++;
        f[0] = soup_vertex(s, a);
        f[1] = soup_vertex(s, b);
        f[2] = soup_vertex(s, c);
        return;
    }
    double ab[3], bc[3], ca[3];
    for (int k = 0; k < 3; k++) {
        ab[k] = 0.5 * (a[k] + b[k]);
        bc[k] = 0.5 * (b[k] + c[k]);
        ca[k] = 0.5 * (c[k] + a[k]);
    }
    soup_split(s, a, ab, ca, levels - 1);
    soup_split(s, b, bc, ab, levels - 1);
    soup_split(s, c, ca, bc, levels - 1);
    soup_split(s, ab, bc, ca, levels - 1);
}

/* Every facet has vertices of its own, as an STL file would give them. */
static asdic_mesh *ellipsoid_mesh(const double size_m[3], unsigned levels) {
    size_t facets = (size_t)8 << (2 * levels);
    soup s = {malloc(9 * facets * sizeof(double)), malloc(3 * facets * sizeof(uint32_t)), 0, 0,
              size_m};
    for (int octant = 0; octant < 8; octant++) {
        double x[3] = {octant & 1 ? -1.0 : 1.0, 0.0, 0.0};
        double y[3] = {0.0, octant & 2 ? -1.0 : 1.0, 0.0};
        double z[3] = {0.0, 0.0, octant & 4 ? -1.0 : 1.0};
        bool flipped = (octant & 1) ^ (octant >> 1 & 1) ^ (octant >> 2 & 1);
        soup_split(&s, x, flipped ? z : y, flipped ? y : z, levels);
    }
    asdic_mesh *mesh = NULL;
    assert_ok(t.ctx, asdic_mesh_from_triangles(t.ctx, s.v, s.vertices, s.f, s.facets, &mesh));
    free(s.v);
    free(s.f);
    return mesh;
}

static asdic_mesh *case_mesh(const target_case *c) {
    asdic_mesh *mesh = NULL;
    switch (c->body) {
    case SPHERE:
        assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, c->size_m[0], c->segments, &mesh));
        break;
    case CYLINDER:
        assert_ok(t.ctx,
                  asdic_mesh_cylinder(t.ctx, c->size_m[0], c->size_m[1], c->segments, &mesh));
        break;
    case PLATE:
        assert_ok(t.ctx, asdic_mesh_plate(t.ctx, c->size_m[0], c->size_m[1], &mesh));
        break;
    case DISC:
        mesh = disc_mesh(c->size_m[0], c->segments);
        break;
    case ELLIPSOID:
        mesh = ellipsoid_mesh(c->size_m, c->segments);
        break;
    }
    return mesh;
}

static double case_extent(const target_case *c) {
    double half = c->body == SPHERE || c->body == DISC ? c->size_m[0]
                  : c->body == CYLINDER                ? 0.5 * c->size_m[1]
                  : c->body == PLATE                   ? 0.5 * fmax(c->size_m[0], c->size_m[1])
                                                       : fmax(c->size_m[1], c->size_m[2]);
    return half;
}

static double case_depth(const target_case *c) {
    return c->body == PLATE || c->body == DISC ? 0.0 : c->size_m[0];
}

static double db(double lin) {
    return 10.0 * log10(lin);
}

static int check_case(const target_case *c) {
    double centre_m = c->range_m + case_depth(c);
    target_rig r = target_rig_create(&t, c->frequency_hz, centre_m, case_extent(c) / c->range_m);
    r.sampling.sampler = ASDIC_SAMPLER_BEAM;
    r.sampling.rays = 1 << 20;
    target_rig_add(&r, case_mesh(c), centre_m, c->yaw_deg * PI / 180.0,
                   asdic_material_facet(AIR, c->roughness_m, c->slope_rms));
    double deviation;
    double energy = target_rig_energy(&r, ASDIC_OBJECT, 4, &deviation);
    double ts = target_rig_strength_db(&r, energy, c->range_m);
    bool good = fabs(ts - c->expected_db) <= c->tolerance_db;
    print_message("%-44s %8.2f %8.2f %+6.2f +- %.2f  (%.1f)%s\n", c->name, c->expected_db, ts,
                  ts - c->expected_db, 4.34 * deviation, c->tolerance_db, good ? "" : "  MISSED");
    target_rig_destroy(&r);
    return !good;
}

static void strengths_of_bodies(void **state) {
    (void)state;
    const double f = 100e3, wl = SPEED_MPS / f;
    const target_case cases[] = {
        {"smooth sphere a 0.5 m, 96 segments", SPHERE, {0.5}, 96, 0, f, 100, 0, 0, db(0.0625), 0.5},
        {"the same, turned by half a segment",
         SPHERE,
         {0.5},
         96,
         1.875,
         f,
         100,
         0,
         0,
         db(0.0625),
         0.5},
        {"smooth sphere a 0.5 m, 24 segments", SPHERE, {0.5}, 24, 0, f, 100, 0, 0, db(0.0625), 0.5},
        {"the same, turned by half a segment",
         SPHERE,
         {0.5},
         24,
         7.5,
         f,
         100,
         0,
         0,
         db(0.0625),
         0.5},
        {"rough sphere a 0.5 m", SPHERE, {0.5}, 96, 0, f, 100, 0.02, 0.1, db(2 * 0.25 / 3), 0.3},
        {"cylinder broadside a 0.25 m, L 1 m",
         CYLINDER,
         {0.25, 1.0},
         96,
         0,
         f,
         300,
         0,
         0,
         db(0.25 / (2 * wl)),
         1.0},
        {"plate 0.3 x 0.3 m, far",
         PLATE,
         {0.3, 0.3},
         0,
         0,
         f,
         100,
         0,
         0,
         db(0.0081 / (wl * wl)),
         0.3},
        {"plate 0.6 x 0.2 m, far",
         PLATE,
         {0.6, 0.2},
         0,
         0,
         f,
         100,
         0,
         0,
         db(0.0144 / (wl * wl)),
         0.3},
        {"plate 4 x 4 m, near", PLATE, {4, 4}, 0, 0, f, 50, 0, 0, db(25.0 * 25.0), 1.0},
        {"disc r 0.2 m, far",
         DISC,
         {0.2},
         32,
         0,
         f,
         100,
         0,
         0,
         db(PI * PI * 0.0016 / (wl * wl)),
         0.3},
        {"ellipsoid 0.5 x 1 x 0.4 m, end on",
         ELLIPSOID,
         {0.5, 1, 0.4},
         5,
         0,
         f,
         200,
         0,
         0,
         db(0.25 * 0.16 / 0.25),
         0.5},
        {"sphere a 0.5 m as an octahedral mesh",
         ELLIPSOID,
         {0.5, 0.5, 0.5},
         5,
         17,
         f,
         100,
         0,
         0,
         db(0.0625),
         0.5},
    };
    int missed = 0;
    print_message("%-44s %8s %8s %6s\n", "target strength, dB", "expected", "measured", "off");
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        missed += check_case(&cases[k]);
    }
    assert_int_equal(missed, 0);
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {cmocka_unit_test(strengths_of_bodies)};
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    test_device_close(&t);
    return failed;
}
