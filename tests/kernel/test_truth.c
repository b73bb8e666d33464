/*
 * What bins hold: shares that sum to one, the same bytes however the work is laid out, and levels that do not
 * change. An object's energy is told apart by silencing all others, which changes no ray; shares and depressions
 * of two spheres are summed anew here, over rays of this file's own. With the argument "full" more kinds of kernels are laid
 * out and asked as GPUs have them.
 */
#include "ping_rig.h"

#include <string.h>

#define OBJECTS 4
#define FAN 512
/* dB of Lambert's law: an object that counts, and one that only stands in the way. */
#define LOUD -10.0
#define SILENT -100.0

static test_device t;
static bool full;
static asdic_beam fan[FAN];

/* A kind of scene. */
typedef struct kind {
    const char *name;
    size_t beams;
    asdic_multipath multipath;
    double gradient_per_s;
    double bandwidth_hz; /* 10 kHz: a bin holds whole pulses */
    bool layers, moves, mesh_bottom, points;
} kind;

static asdic_material lambert(double db) {
    asdic_material m = asdic_material_of(asdic_law_find("lambert"));
    assert_ok(t.ctx, asdic_material_set(t.ctx, &m, "lambert_db", db));
    return m;
}

static asdic_material steel(void) {
    return asdic_material_facet(45.0, 1e-3, 0.3);
}

/* A sphere, a box, a plate and a fine mesh, several in one bin, one in front of another. LOUD_ONE: the only one
 * that is heard; 0: all. Object 4 mirrors where there is multipath. */
static void add_objects(ping_rig *r, const kind *k, int loud_one) {
    static const asdic_vec3 at[OBJECTS] = {
        {25.0, -3.0, 10.5}, {25.5, 4.0, 9.0}, {24.0, 0.5, 4.0}, {27.0, 1.0, 8.0}};
    for (int i = 0; i < OBJECTS; i++) {
        char name[] = {'o', 'b', (char)('1' + i), 0};
        asdic_mesh *mesh = NULL;
        assert_ok(t.ctx, i == 0   ? asdic_mesh_sphere(t.ctx, 1.0, 16, &mesh)
                         : i == 1 ? asdic_mesh_box(t.ctx, (asdic_vec3){1.0, 2.0, 3.0}, &mesh)
                         : i == 2 ? asdic_mesh_cylinder(t.ctx, 0.5, 3.0, 16, &mesh)
                                  : asdic_mesh_sphere(t.ctx, 1.5, 64, &mesh));
        asdic_pose pose = {.position_m = at[i], .yaw_rad = 0.3};
        asdic_material m = lambert(loud_one == 0 || loud_one == i + 1 ? LOUD : SILENT);
        m = i == 3 && k->multipath && !k->layers ? steel() : m;
        assert_ok(t.ctx, k->moves && i % 2 == 0
                             ? asdic_scene_add_moving_object(r->scene, name, mesh, pose, m)
                             : asdic_scene_add_object(r->scene, name, mesh, pose, m));
        asdic_mesh_destroy(&mesh);
    }
    if (k->points) {
        assert_ok(t.ctx,
                  asdic_scene_add_point(r->scene, "point", (asdic_vec3){25.0, 1.5, 6.0},
                                        loud_one == 0 || loud_one == OBJECTS + 1 ? -10.0 : -150.0));
    }
}

static ping_rig make_rig(const kind *k, int loud_one) {
    ping_rig r = rig_create(&t);
    r.sonar.noise_enabled = true;
    r.sonar.source_level_db = 180.0;
    r.sonar.bandwidth_hz = k->bandwidth_hz;
    r.sonar.max_range_m = 45.0;
    r.sonar.receiver_count = k->beams;
    r.sampling.multipath = k->multipath;
    r.env.sound_speed_gradient_per_s = k->gradient_per_s;
    if (k->layers) {
        r.env.sound_speed_profile =
            (asdic_sound_profile){3, {0.0, 6.0, 12.0}, {1500.0, 1502.0, 1495.0}};
        r.env.refraction = ASDIC_REFRACTION_FULL;
    }
    if (k->mesh_bottom) {
        asdic_mesh *mesh = NULL;
        assert_ok(t.ctx, asdic_mesh_plate(t.ctx, 200.0, 200.0, &mesh));
        asdic_pose pose = {.position_m = {0.0, 0.0, 11.9}, .pitch_rad = 90.0 * RIG_DEGREE};
        assert_ok(t.ctx, asdic_scene_add_bottom(r.scene, mesh, pose, asdic_material_bottom(2.0)));
        asdic_mesh_destroy(&mesh);
    }
    add_objects(&r, k, loud_one);
    return r;
}

/* A ping of R, where movers have moved; with truth or without. */
static asdic_ping *shoot(ping_rig *r, const kind *k, bool truth) {
    asdic_simulator *sim = NULL;
    asdic_ping *ping = NULL;
    r->sampling.truth = truth;
    r->sonar.receivers = k->beams > RIG_MOST_BEAMS ? fan : r->receivers;
    asdic_scene_commit(r->scene); /* a second time it changes nothing */
    assert_ok(t.ctx,
              asdic_simulator_create_with(t.ctx, t.device, r->scene, &r->env, &r->sonar,
                                          &r->sampling, r->pose.position_m.z, &r->layout, &sim));
    assert_ok(t.ctx, asdic_ping_create(t.ctx, k->beams, asdic_simulator_bin_count(sim), &ping));
    if (truth) {
        assert_ok(t.ctx, asdic_ping_add_truth(t.ctx, ping));
    }
    for (int i = 0; i < OBJECTS && k->moves; i += 2) {
        char name[] = {'o', 'b', (char)('1' + i), 0};
        const asdic_pose to = {.position_m = {26.0, i - 1.0, 8.0}, .yaw_rad = 1.0};
        assert_ok(t.ctx, asdic_simulator_move(sim, name, &to));
    }
    assert_ok(t.ctx, asdic_simulator_ping(sim, &r->pose, 3, ping));
    asdic_simulator_destroy(&sim);
    return ping;
}

static const kind kinds[] = {
    {"nine beams, moving", 9, ASDIC_MULTIPATH_FIRST, 0.0, 10e3, .moves = true, .points = true},
    {"a long pulse", 3, ASDIC_MULTIPATH_BOUNDARIES, 0.0, 400.0, .points = true},
    {"one layer, mesh bottom", 3, ASDIC_MULTIPATH_OFF, -0.8, 10e3, .mesh_bottom = true},
    {"two layers", 3, ASDIC_MULTIPATH_OFF, 0.0, 10e3, .layers = true},
    {"fan", FAN, ASDIC_MULTIPATH_OFF, 0.0, 10e3, .points = true},
    {"fan, mirrors, moving", FAN, ASDIC_MULTIPATH_BOUNDARIES, 0.0, 400.0, .moves = true},
};
#define KINDS (sizeof kinds / sizeof *kinds)

/* --- sums and objects ------------------------------------------------------------------------- */

static void check_sums(const asdic_ping *p) {
    for (size_t n = 0; n < p->beams * p->bins; n++) {
        const asdic_ping_truth *h = p->truth;
        double sum = 0.0, total = p->intensity_lin[ASDIC_TOTAL][n];
        for (int path = 0; path < ASDIC_PATH_COUNT; path++) {
            sum += (double)h->path[path][n];
        }
        assert_close(sum, 1.0, 1e-5);
        assert_close(h->path[ASDIC_PATH_NOISE][n], p->intensity_lin[ASDIC_NOISE][n] / total, 1e-6);
        double around = h->path[ASDIC_PATH_BY_SURFACE][n] + h->path[ASDIC_PATH_BY_BOTTOM][n] +
                        (double)h->path[ASDIC_PATH_BY_OBJECT][n];
        assert_close(around, p->intensity_lin[ASDIC_MULTIPATH][n] / total, 1e-6);
        assert_true(h->object_share[n] <= p->intensity_lin[ASDIC_OBJECT][n] / total + 1e-6);
        /* The strongest is the strongest. */
        double most = h->object_share[n];
        int who = h->object[n];
        for (int c = ASDIC_BOTTOM; c <= ASDIC_NOISE; c++) {
            double share = c == ASDIC_OBJECT ? 0.0 : p->intensity_lin[c][n] / total;
            who = share > most + 1e-6 ? -c : who;
            most = fmax(most, share);
        }
        assert_close(h->share[n], most, 1e-6);
        if (who != h->strongest[n]) { /* as strong as another */
            int c = -h->strongest[n];
            double share = c < 0 ? (double)h->object_share[n] : p->intensity_lin[c][n] / total;
            assert_close(share, most, 2e-6);
        }
    }
}

/* The shares of every object, where it is the strongest, from pings in which it is the only one. */
static void an_object_is_told_apart(void **state) {
    (void)state;
    for (size_t i = 0; i < KINDS; i++) {
        const kind *k = &kinds[i];
        ping_rig r = make_rig(k, 0);
        asdic_ping *all = shoot(&r, k, true), *alone[OBJECTS + 1] = {NULL};
        int objects = OBJECTS + k->points;
        check_sums(all);
        rig_destroy(&r);
        for (int o = 0; o < objects; o++) {
            ping_rig one = make_rig(k, o + 1);
            alone[o] = shoot(&one, k, true);
            rig_destroy(&one);
        }
        bool mirrors = k->multipath && !k->layers; /* object 4 is loud in all of them */
        size_t seen[OBJECTS + 2] = {0}, shared = 0, strongest = 0;
        for (size_t n = 0; n < all->beams * all->bins; n++) {
            double total = all->intensity_lin[ASDIC_TOTAL][n], most = 0.0, sum = 0.0;
            double steel_lin = mirrors ? alone[3]->intensity_lin[ASDIC_OBJECT][n] : 0.0;
            int who = 0;
            for (int o = 0; o < objects; o++) {
                double e = alone[o]->intensity_lin[ASDIC_OBJECT][n] - (o == 3 ? 0.0 : steel_lin);
                who = e > most ? o + 1 : who;
                most = fmax(most, e);
                sum += e;
            }
            if (most < 1e-4 * total) {
                continue;
            }
            shared += most < 0.8 * sum;
            assert_close(all->truth->object_share[n], most / total, 1e-3 * sum / total + 1e-6);
            if (most > 0.51 * sum) {
                assert_int_equal(all->truth->object[n], who);
                seen[who]++;
            }
        }
        for (int o = 0; o < objects; o++) {
            strongest += seen[o + 1] > 0;
            asdic_ping_destroy(&alone[o]);
        }
        assert_true(strongest >= 2 && shared > 0);
        asdic_ping_destroy(&all);
    }
}

/* --- bytes ------------------------------------------------------------------------------------ */

static bool same_truth(const asdic_ping *a, const asdic_ping *b) {
    size_t cells = a->beams * a->bins;
    const asdic_ping_truth *x = a->truth, *y = b->truth;
    bool same = memcmp(x->strongest, y->strongest, cells * sizeof *x->strongest) == 0 &&
                memcmp(x->object, y->object, cells * sizeof *x->object) == 0 &&
                memcmp(x->share, y->share, cells * sizeof *x->share) == 0 &&
                memcmp(x->object_share, y->object_share, cells * sizeof *x->share) == 0 &&
                memcmp(x->depression_rad, y->depression_rad, cells * sizeof *x->share) == 0;
    for (int p = 0; p < ASDIC_PATH_COUNT; p++) {
        same = same && memcmp(x->path[p], y->path[p], cells * sizeof *x->share) == 0;
    }
    return same;
}

static void layouts_and_levels_agree(void **state) {
    (void)state;
    /* Many kernels: few beams, and fans. */
    for (size_t i = 0; i < KINDS; i += i ? 1 : KINDS - (full ? 2 : 1)) {
        const kind *k = &kinds[i];
        ping_rig r = make_rig(k, 0);
        const asdic_layout usual = r.layout;
        if (i == 0) { /* from the other side */
            r.pose.position_m.x = 50.0;
            r.pose.yaw_rad = 180.0 * RIG_DEGREE;
        }
        asdic_ping *plain = shoot(&r, k, false), *truth = shoot(&r, k, true);
        assert_true(rig_same(plain, truth));
        const asdic_layout others[] = {
            {usual.width, ASDIC_DEPOSIT_COLLECT, 1, 1, usual.batch_slots, usual.ping_batch_slots, 1,
             1},
            {usual.width, ASDIC_DEPOSIT_COLLECT, 8, 3, 5000, 1, 2, 1},
            {usual.width, ASDIC_DEPOSIT_ATOMIC32, 4, 2, usual.batch_slots, 1, 5, 1},
        };
        for (size_t o = 0; o < 3 && usual.deposit == ASDIC_DEPOSIT_COLLECT; o++) {
            r.layout = others[o];
            asdic_ping *other = shoot(&r, k, true);
            if (!same_truth(truth, other)) {
                print_error("%s: layout %zu gives other bytes\n", k->name, o);
            }
            assert_true(same_truth(truth, other));
            asdic_ping_destroy(&other);
        }
        r.layout = usual;
        r.sampling.kernel = ASDIC_RAY_KERNEL_SCALAR;
        asdic_ping *other = shoot(&r, k, true);
        assert_true(same_truth(truth, other));
        asdic_ping_destroy(&other);
        asdic_ping_destroy(&plain);
        asdic_ping_destroy(&truth);
        rig_destroy(&r);
    }
}

static void check_near(const float *a, const float *b, size_t cells) {
    for (size_t n = 0; n < cells; n++) {
        assert_true(isnan(a[n]) == isnan(b[n]));
        assert_true(isnan(a[n]) || fabsf(a[n] - b[n]) < 1e-3f);
    }
}

/* A GPU's form of the fan: one receiver a work-item. */
static void one_receiver_a_work_item_is_told_the_same(void **state) {
    (void)state;
    for (size_t i = KINDS - (full ? 2 : 1); i < KINDS; i++) {
        const kind *k = &kinds[i];
        ping_rig r = make_rig(k, 0);
        asdic_ping *wide = shoot(&r, k, true);
        r.layout.width = 1;
        asdic_ping *narrow = shoot(&r, k, true);
        const asdic_ping_truth *x = wide->truth, *y = narrow->truth;
        size_t cells = wide->beams * wide->bins, others = 0;
        check_sums(narrow);
        check_near(x->share, y->share, cells);
        check_near(x->object_share, y->object_share, cells);
        check_near(x->depression_rad, y->depression_rad, cells);
        for (int p = 0; p < ASDIC_PATH_COUNT; p++) {
            check_near(x->path[p], y->path[p], cells);
        }
        for (size_t n = 0; n < cells; n++) {
            others += x->object[n] != y->object[n] && x->object_share[n] > 1e-3f;
        }
        assert_true(others <= cells / 1000);
        asdic_ping_destroy(&wide);
        asdic_ping_destroy(&narrow);
        rig_destroy(&r);
    }
}

/* Every width of a row of cells: work-items of their own cells against atomics; batches of other sizes of a fan. */
static void any_number_of_beams_is_told(void **state) {
    static const size_t beams[] = {1, 2, 3, 4, 5, 8, 17};
    (void)state;
    for (size_t i = 0; i < sizeof beams / sizeof *beams; i++) {
        const kind k = {
            .beams = beams[i], .multipath = ASDIC_MULTIPATH_FIRST, .bandwidth_hz = 10e3};
        ping_rig r = make_rig(&k, 0);
        asdic_ping *p = shoot(&r, &k, true);
        check_sums(p);
        for (size_t n = 0; n < p->beams * p->bins; n++) {
            double echo = 0.0;
            for (int c = ASDIC_BOTTOM; c < ASDIC_NOISE; c++) {
                echo += c == ASDIC_VOLUME ? 0.0 : p->intensity_lin[c][n];
            }
            assert_int_equal(isfinite(p->truth->depression_rad[n]), echo > 0.0);
        }
        if (r.layout.deposit == ASDIC_DEPOSIT_COLLECT) {
            r.layout.deposit = ASDIC_DEPOSIT_ATOMIC32;
            r.layout.batch_slots = 5000;
            r.layout.ping_batch_slots = 1;
            asdic_ping *other = shoot(&r, &k, true);
            assert_true(same_truth(p, other));
            asdic_ping_destroy(&other);
        }
        asdic_ping_destroy(&p);
        rig_destroy(&r);
    }
}

/* --- spheres, summed here --------------------------------------------------------------------- */

#define SPHERES 2
static const asdic_vec3 center_m[SPHERES] = {{19.9, -1.0, 10.0}, {20.1, 1.5, 4.5}};
static const double radius_m[SPHERES] = {1.2, 0.8};

static double sinc(double x) {
    return fabs(x) < 1e-9 ? 1.0 : sin(3.14159265358979323846 * x) / (3.14159265358979323846 * x);
}

/* One-way gain of BEAM, which is not rolled, in waves of WAVELENGTH_M. */
static double gain(const asdic_beam *beam, double wavelength_m, const double u[3]) {
    double cy = cos(beam->yaw_rad), sy = sin(beam->yaw_rad), cp = cos(beam->pitch_rad),
           sp = sin(beam->pitch_rad);
    double along = cy * u[0] + sy * u[1];
    double vy = cy * u[1] - sy * u[0], vz = cp * u[2] - sp * along;
    double g =
        sinc(beam->length_h_m / wavelength_m * vy) * sinc(beam->length_v_m / wavelength_m * vz);
    return cp * along + sp * u[2] > 0.0 ? g * g : 0.0;
}

/* Sums of energy, and of energy by sine of depression, of sphere S in a beam's bin, over a lattice of rays round
 * the sphere's centre. */
static void sum_sphere(int s, const asdic_beam *sent, const asdic_beam *heard, double wavelength_m,
                       size_t bin, double sums[2]) {
    const double z = 7.0, c[3] = {center_m[s].x, center_m[s].y, center_m[s].z - z};
    const double far = sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]), r = radius_m[s];
    const int steps = 1200;
    double w[3] = {c[0] / far, c[1] / far, c[2] / far}, level = hypot(w[0], w[1]);
    double e[3] = {-w[1] / level, w[0] / level, 0.0};
    double f[3] = {-w[2] * e[1], w[2] * e[0], w[0] * e[1] - w[1] * e[0]};
    double edge = 1.001 * r / sqrt(far * far - r * r);
    sums[0] = sums[1] = 0.0;
    for (int i = 0; i < steps * steps; i++) {
        double a = edge * (2.0 * (i % steps + 0.5) / steps - 1.0);
        double b = edge * (2.0 * ((double)(i / steps) + 0.5) / steps - 1.0);
        double length = sqrt(1.0 + a * a + b * b), u[3], along = 0.0;
        for (int k = 0; k < 3; k++) {
            u[k] = (w[k] + a * e[k] + b * f[k]) / length;
            along += u[k] * c[k];
        }
        double under = r * r - (far * far - along * along);
        if (under <= 0.0) {
            continue;
        }
        double d = along - sqrt(under), n = 0.0;
        for (int k = 0; k < 3; k++) {
            n -= u[k] * (d * u[k] - c[k]) / r;
        }
        if ((size_t)(d / 0.5) == bin) { /* Lambert: sin^2 over the sine of the facet's slant */
            double energy = gain(sent, wavelength_m, u) * gain(heard, wavelength_m, u) * n /
                            (length * length * length * d * d);
            sums[0] += energy * edge * edge;
            sums[1] += energy * edge * edge * u[2];
        }
    }
}

static void spheres_are_as_summed_by_hand(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    rig_empty(&r);
    asdic_scene_set_surface(r.scene, false);
    for (int s = 0; s < SPHERES; s++) {
        asdic_mesh *mesh = NULL;
        asdic_pose pose = {.position_m = center_m[s]};
        assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, radius_m[s], 512, &mesh));
        assert_ok(t.ctx, asdic_scene_add_object(r.scene, s ? "upper" : "lower", mesh, pose,
                                                lambert(LOUD)));
        asdic_mesh_destroy(&mesh);
    }
    const kind k = {.beams = 3};
    r.sampling.rays = 1 << 20;
    r.sampling.multipath = ASDIC_MULTIPATH_OFF;
    asdic_ping *p = shoot(&r, &k, true);
    double wavelength_m = asdic_environment_sound_speed_mps(&r.env, 7.0) / 100e3;
    for (size_t bin = 37; bin < 40; bin++) {
        for (size_t b = 0; b < 3; b++) {
            double sums[SPHERES][2], near = 1e-30;
            for (int s = 0; s < SPHERES; s++) {
                sum_sphere(s, &r.sonar.transmitter, &r.receivers[b], wavelength_m, bin, sums[s]);
                near = fmax(near, sums[s][0]);
            }
            double total = sums[0][0] + sums[1][0], sine = (sums[0][1] + sums[1][1]) / total;
            size_t at = b * p->bins + bin;
            double heard = p->intensity_lin[ASDIC_OBJECT][at];
            if (total < 1e-9) {
                continue;
            }
            assert_true(heard > 0.0);
            double objects = heard / p->intensity_lin[ASDIC_TOTAL][at];
            assert_close(p->truth->object_share[at] / objects, near / total, 0.01);
            assert_int_equal(p->truth->object[at], sums[0][0] > sums[1][0] ? 1 : 2);
            assert_close(p->truth->depression_rad[at], asin(sine), 0.002);
        }
    }
    asdic_ping_destroy(&p);
    rig_destroy(&r);
}

/* Sixteen equal beams over a flat bottom 5 m below: what comes from D metres away comes from asin(5 / D) below. */
static void fans_tell_depressions(void **state) {
    enum { BEAMS = 16 };
    const kind k = {.beams = BEAMS};
    (void)state;
    ping_rig r = rig_create(&t);
    asdic_scene_set_surface(r.scene, false);
    r.env.particle_strength_db = -200.0;
    r.sonar.max_range_m = 45.0;
    r.sonar.receiver_count = BEAMS;
    r.sampling.multipath = ASDIC_MULTIPATH_OFF;
    asdic_beam others[BEAMS];
    memcpy(others, fan, sizeof others);
    for (int b = 0; b < BEAMS; b++) {
        fan[b] = r.sonar.transmitter;
    }
    asdic_ping *p = shoot(&r, &k, true);
    memcpy(fan, others, sizeof others);
    size_t told = 0;
    for (size_t n = 0; n < p->beams * p->bins; n++) {
        double near_m = (double)(n % p->bins) * r.sonar.bin_length_m;
        double far_m = near_m + r.sonar.bin_length_m,
               depression = (double)p->truth->depression_rad[n];
        if (near_m < 6.0 || far_m > 40.0 || !(p->intensity_lin[ASDIC_BOTTOM][n] > 0.0)) {
            continue;
        }
        told++;
        assert_true(depression > asin(5.0 / far_m) - 0.01 &&
                    depression < asin(5.0 / near_m) + 0.01);
    }
    assert_true(told > BEAMS * 60);
    asdic_ping_destroy(&p);
    rig_destroy(&r);
}

/* A ball of a millimetre beside one that glints, ahead and 17 degrees below, without mirrors and with: its rays are worth a
 * small part of a quantum each, and it is heard from where it is all the same. */
static void faint_objects_keep_their_depression(void **state) {
    (void)state;
    static const double ball_m[] = {0.3, 0.001};
    for (int i = 0; i < 4; i++) {
        const kind k = {.beams = 3,
                        .bandwidth_hz = 10e3,
                        .multipath = i / 2 ? ASDIC_MULTIPATH_FIRST : ASDIC_MULTIPATH_OFF};
        const asdic_vec3 at[] = {{20.15, 0.0, 2.0}, {25.15, 0.0, i % 2 ? 14.7 : 7.0}};
        ping_rig r = rig_create(&t);
        rig_empty(&r);
        asdic_scene_set_surface(r.scene, false);
        for (int s = 0; s < 2; s++) {
            asdic_mesh *mesh = NULL;
            assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, ball_m[s], 64, &mesh));
            assert_ok(t.ctx, asdic_scene_add_object(r.scene, s ? "faint" : "loud", mesh,
                                                    (asdic_pose){.position_m = at[s]},
                                                    asdic_material_facet(0.0, 0.0, 0.0)));
            asdic_mesh_destroy(&mesh);
        }
        r.env.particle_strength_db = -200.0;
        r.sonar.transmitter.length_h_m = r.sonar.transmitter.length_v_m = 0.004;
        r.sampling.multipath = k.multipath;
        r.sampling.rays = 200000;
        for (size_t b = 0; b < k.beams; b++) {
            r.receivers[b] = r.sonar.transmitter;
        }
        asdic_ping *p = shoot(&r, &k, true);
        size_t told = 0;
        for (size_t n = 0; n < p->bins; n++) {
            if (p->truth->object[n] == 2) {
                double wanted = atan2(at[1].z - 7.0, at[1].x);
                print_message("multipath %d: from %.4f rad below, %.4f expected\n", i / 2,
                              (double)p->truth->depression_rad[n], wanted);
                assert_close(p->truth->depression_rad[n], wanted, i / 2 ? 0.15 : 0.06);
                told++;
            }
        }
        assert_true(told > 0);
        asdic_ping_destroy(&p);
        rig_destroy(&r);
    }
}

/* A rig of points alone, in bins of BIN_M. */
static ping_rig rig_of_points(double bin_m) {
    ping_rig r = rig_create(&t);
    rig_empty(&r);
    r.env.wind_speed_kn = 0.0;
    r.env.particle_strength_db = -200.0;
    r.sonar.bin_length_m = bin_m;
    return r;
}

/* A point below a calm surface: what goes out straight and comes home by the surface, and what goes the other
 * way round, are in one bin; or all ways are. Each counts by the gains it goes out and comes home with. */
static void points_arrive_from_the_mean_of_their_ways(void **state) {
    (void)state;
    static const struct {
        double bin_m, sonar_z, x, z;
    } cases[] = {{0.05, 3.0, 15.0, 7.0}, {0.5, 1.0, 60.0, 1.5}, {0.05, 7.0, 20.0, 3.0}};
    const kind k = {.beams = 3, .multipath = ASDIC_MULTIPATH_BOUNDARIES};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ping_rig r = rig_of_points(cases[i].bin_m);
        double rise[2] = {cases[i].z - cases[i].sonar_z, -cases[i].z - cases[i].sonar_z};
        r.pose.position_m.z = cases[i].sonar_z;
        r.sampling.multipath = k.multipath;
        r.sonar.transmitter.length_v_m = 0.02;
        r.sonar.transmitter.pitch_rad = 10.0 * RIG_DEGREE;
        const asdic_vec3 at = {cases[i].x, 0.0, cases[i].z};
        assert_ok(t.ctx, asdic_scene_add_point(r.scene, "point", at, -10.0));
        asdic_ping *p = shoot(&r, &k, true);
        double c_mps = asdic_environment_sound_speed_mps(&r.env, r.pose.position_m.z);
        double wavelength_m = c_mps / r.sonar.frequency_hz;
        double alpha = asdic_environment_absorption_db_per_km(&r.env, r.sonar.frequency_hz,
                                                              r.pose.position_m.z);
        for (size_t b = 0; b < k.beams; b++) {
            for (size_t n = 0; n < p->bins; n++) {
                double sum = 0.0, moment = 0.0;
                for (int way = 0; way < 4; way++) {
                    double out_m = hypot(at.x, rise[way / 2]), home_m = hypot(at.x, rise[way % 2]);
                    const double out[] = {at.x / out_m, 0.0, rise[way / 2] / out_m},
                                 home[] = {at.x / home_m, 0.0, rise[way % 2] / home_m};
                    double range_m = 0.5 * (out_m + home_m);
                    double energy = gain(&r.sonar.transmitter, wavelength_m, out) *
                                    gain(&r.receivers[b], wavelength_m, home) *
                                    pow(10.0, -2e-4 * alpha * range_m) /
                                    (out_m * out_m * home_m * home_m);
                    bool is_here = (size_t)(range_m / cases[i].bin_m) == n;
                    sum += is_here ? energy : 0.0;
                    moment += is_here ? energy * home[2] : 0.0;
                }
                if (sum > 0.0) {
                    double depression = (double)p->truth->depression_rad[b * p->bins + n];
                    print_message("beam %zu, bin %zu: from %.5f rad, by hand %.5f\n", b, n,
                                  depression, asin(moment / sum));
                    assert_close(depression, asin(moment / sum), 1e-4);
                }
            }
        }
        asdic_ping_destroy(&p);
        rig_destroy(&r);
    }
}

/* Rays of a channel bring a point's echo in many bins, and a long pulse into each other's: all are its own. */
static void a_point_has_all_of_its_echoes(void **state) {
    (void)state;
    const kind k = {.beams = 3, .bandwidth_hz = 400.0};
    ping_rig r = rig_of_points(0.05);
    asdic_scene_set_surface(r.scene, false);
    r.env.sound_speed_profile =
        (asdic_sound_profile){4, {0.0, 3.0, 7.0, 12.0}, {1500, 1490, 1480, 1486}};
    r.env.refraction = ASDIC_REFRACTION_FULL;
    r.sonar.bandwidth_hz = k.bandwidth_hz;
    r.sonar.max_range_m = 250.0;
    r.sonar.ping_rate_hz = 2.0;
    const asdic_vec3 at = {200.0, 0.0, 7.0};
    assert_ok(t.ctx, asdic_scene_add_point(r.scene, "point", at, 40.0));
    asdic_ping *p = shoot(&r, &k, true);
    size_t told = 0;
    for (size_t n = 0; n < p->beams * p->bins; n++) {
        double all = p->intensity_lin[ASDIC_OBJECT][n], total = p->intensity_lin[ASDIC_TOTAL][n];
        if (all > 0.0) {
            assert_close(p->truth->object_share[n], all / total, 1e-6);
            told++;
        }
    }
    assert_true(told > 0);
    asdic_ping_destroy(&p);
    rig_destroy(&r);
}

/* --- paths, and who may ask ------------------------------------------------------------------- */

/* Where only one thing mirrors, all multipath is by way of it; a point is heard over boundaries, too. */
static void mirrors_are_told_apart(void **state) {
    (void)state;
    for (int mirror = ASDIC_PATH_BY_SURFACE; mirror <= ASDIC_PATH_BY_OBJECT; mirror++) {
        const kind k = {
            "",
            3,
            mirror == ASDIC_PATH_BY_OBJECT ? ASDIC_MULTIPATH_FIRST : ASDIC_MULTIPATH_BOUNDARIES,
            0.0,
            10e3,
            .points = false};
        ping_rig r = rig_create(&t);
        rig_empty(&r);
        asdic_scene_set_surface(r.scene, mirror == ASDIC_PATH_BY_SURFACE);
        if (mirror != ASDIC_PATH_BY_SURFACE) {
            assert_ok(t.ctx,
                      asdic_scene_set_bottom_plane(r.scene, 12.0, asdic_material_bottom(2.0)));
        }
        r.env.wind_speed_kn = 0.0;
        r.sampling.multipath = k.multipath;
        bool by_object = mirror == ASDIC_PATH_BY_OBJECT;
        add_objects(&r, &(kind){.multipath = by_object, .points = !by_object}, 0);
        asdic_ping *p = shoot(&r, &k, true);
        double most = 0.0;
        for (size_t n = 0; n < p->beams * p->bins; n++) {
            double share = p->intensity_lin[ASDIC_MULTIPATH][n] / p->intensity_lin[ASDIC_TOTAL][n];
            for (int path = ASDIC_PATH_BY_SURFACE; share > 0.0 && path < ASDIC_PATH_NOISE; path++) {
                assert_close(p->truth->path[path][n], path == mirror ? share : 0.0, 1e-6);
            }
            most = fmax(most, p->intensity_lin[ASDIC_MULTIPATH][n]);
        }
        assert_true(most > 0.0);
        asdic_ping_destroy(&p);
        rig_destroy(&r);
    }
}

/* Of a pulse that reaches beyond the last bin the rest is lost, and what is heard arrives from where the point is. */
static void a_pulse_at_the_end_arrives_from_its_object(void **state) {
    (void)state;
    const kind k = {.name = "a long pulse", .beams = 3, .bandwidth_hz = 100.0};
    ping_rig r = make_rig(&k, 0);
    rig_empty(&r);
    asdic_scene_set_surface(r.scene, false);
    const asdic_vec3 at = {42.0, 0.0, 7.0 + 12.0};
    assert_ok(t.ctx, asdic_scene_add_point(r.scene, "point", at, 20.0));
    asdic_ping *p = shoot(&r, &k, true);
    for (size_t n = p->bins - 6; n < p->bins; n++) {
        assert_close(p->truth->depression_rad[n], atan2(12.0, 42.0), 1e-5);
        assert_int_equal(p->truth->strongest[n], 1);
    }
    asdic_ping_destroy(&p);
    rig_destroy(&r);
}

static void a_simulator_without_truth_says_so(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    r.sampling.rays = 64;
    asdic_simulator *sim = rig_simulator(&r);
    asdic_ping *ping = NULL;
    assert_ok(t.ctx, asdic_ping_create(t.ctx, 3, asdic_simulator_bin_count(sim), &ping));
    assert_ok(t.ctx, asdic_ping_add_truth(t.ctx, ping));
    assert_ok(t.ctx, asdic_ping_add_truth(t.ctx, ping));
    assert_status(t.ctx, asdic_ping_add_truth(t.ctx, NULL), ASDIC_ERROR_ARGUMENT);
    assert_status(t.ctx, asdic_simulator_ping(sim, &r.pose, 0, ping), ASDIC_ERROR_ARGUMENT);
    assert_contains(asdic_context_error(t.ctx), "made without");
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
    assert_string_equal(asdic_path_name(ASDIC_PATH_BY_BOTTOM), "by_bottom");
    assert_string_equal(asdic_path_name(ASDIC_PATH_COUNT), "?");
}

int main(int argc, char **argv) {
    full = argc == 2 && strcmp(argv[1], "full") == 0;
    t = test_device_open_or_skip();
    for (int b = 0; b < FAN; b++) {
        fan[b] = (asdic_beam){.yaw_rad = (b - 0.5 * (FAN - 1)) * 0.2 * RIG_DEGREE,
                              .length_h_m = 0.4,
                              .length_v_m = 0.03};
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_object_is_told_apart),
        cmocka_unit_test(layouts_and_levels_agree),
        cmocka_unit_test(one_receiver_a_work_item_is_told_the_same),
        cmocka_unit_test(any_number_of_beams_is_told),
        cmocka_unit_test(spheres_are_as_summed_by_hand),
        cmocka_unit_test(faint_objects_keep_their_depression),
        cmocka_unit_test(fans_tell_depressions),
        cmocka_unit_test(points_arrive_from_the_mean_of_their_ways),
        cmocka_unit_test(a_point_has_all_of_its_echoes),
        cmocka_unit_test(mirrors_are_told_apart),
        cmocka_unit_test(a_pulse_at_the_end_arrives_from_its_object),
        cmocka_unit_test(a_simulator_without_truth_says_so),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
