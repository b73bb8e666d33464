/*
 * First-order multipath in water that bends rays: over flat boundaries against fans of rays by Runge-Kutta steps, and
 * over curved objects through layers that hardly differ against one layer and against straight rays; with the argument
 * "full" also as on a GPU.
 */
#include "bent_rig.h"

#include "layer_steps.h"

#include "laws/scatterer.h"
#include "scene/scene.h"

#include <string.h>

static bool full;

/* ---- The reference ---- */

#define FAN 6001
#define STEP 2e-4

/* Where a ray is on its first two boundaries. */
typedef struct landing {
    bool there, on_bottom;
    double across_m, time_s, length_m, sine; /* of its grazing angle */
} landing;

typedef struct fan_ray {
    double elevation;
    landing first, second;
} fan_ray;

/* The ray AT, in the water, to the next boundary; it goes on from there as its image. */
static landing land(const asdic_environment *env, traced *at, double *time_s, double latest_s) {
    for (; *time_s < latest_s;) {
        double h = STEP, least = 0.0;
        traced next = step(env, at, h);
        bool out = next.z < 0.0 || next.z > DEPTH;
        if (out || crosses(env, at->z, next.z)) {
            for (int i = 0; i < 40; i++) {
                double middle = 0.5 * (least + h);
                next = step(env, at, middle);
                bool beyond = next.z < 0.0 || next.z > DEPTH || crosses(env, at->z, next.z);
                *(beyond ? &h : &least) = middle;
            }
            h += 1e-14;
            next = step(env, at, h);
            out = next.z < 0.0 || next.z > DEPTH;
        }
        *time_s += h;
        *at = next;
        if (out) {
            landing l = {true, next.z > DEPTH, next.r, *time_s, next.length, fabs(sin(next.angle))};
            at->z = l.on_bottom ? DEPTH - 1e-12 : 1e-12;
            at->angle = -at->angle;
            return l;
        }
    }
    return (landing){.there = false};
}

static fan_ray *make_fan(const asdic_environment *env, double depth, double latest_s) {
    fan_ray *fan = calloc(FAN, sizeof *fan);
    assert_non_null(fan);
    for (int i = 0; i < FAN; i++) {
        double x = 2.0 * ((double)i + 0.5) / FAN - 1.0;
        fan[i].elevation = 1.5705 * x * fabs(x);
        traced at = {0.0, depth, fan[i].elevation, 0.0};
        double time_s = 0.0;
        fan[i].first = land(env, &at, &time_s, latest_s);
        if (fan[i].first.there) {
            fan[i].second = land(env, &at, &time_s, latest_s);
        }
    }
    return fan;
}

/* What the reference knows beside rays: laws, which have tests of their own. */
typedef struct reference {
    const asdic_environment *env;
    asdic_scatterer bottom, surface;
    double depth_m, c0_mps, np_per_m, bin_m;
    size_t bins;
    double *level;
} reference;

static double mirrored_by(const asdic_scatterer *s, double sine) {
    return s->material.law->reflected(s, sine);
}

static double scattered_by(const reference *r, bool bottom, double sine) {
    return asdic_scatterer_strength(bottom ? &r->bottom : &r->surface, sine);
}

/* Cross-section of the tube of one steradian where the middle one of three rays lands. */
static double tube_of(double e0, double e, double e1, const landing *a, const landing *at,
                      const landing *b) {
    double slope = (b->across_m - a->across_m) / (e1 - e0);
    return at->across_m * fabs(slope) * at->sine / cos(e);
}

/* Energy that comes evenly from ranges NEAR to FAR. */
static void deposit(reference *r, double near, double far, double energy) {
    double a = fmin(near, far) / r->bin_m, b = fmax(near, far) / r->bin_m;
    for (size_t n = (size_t)a; n < r->bins && (double)n < b; n++) {
        double inside = fmin(b, (double)n + 1.0) - fmax(a, (double)n);
        r->level[n] += energy * inside / fmax(b - a, 1e-12);
    }
}

/* The ray of FAN that lands first where AT is; its tube in *TUBE. */
static bool find_direct(const fan_ray *fan, const landing *at, landing *out, double *tube) {
    for (int i = 1; i + 2 < FAN; i++) {
        const landing *a = &fan[i].first, *b = &fan[i + 1].first;
        bool same = a->there && b->there && a->on_bottom == at->on_bottom &&
                    b->on_bottom == at->on_bottom && fan[i - 1].first.there &&
                    fan[i - 1].first.on_bottom == at->on_bottom;
        if (!same || (a->across_m > at->across_m) == (b->across_m > at->across_m)) {
            continue;
        }
        double share = (at->across_m - a->across_m) / (b->across_m - a->across_m);
        out->time_s = a->time_s + share * (b->time_s - a->time_s);
        out->length_m = a->length_m + share * (b->length_m - a->length_m);
        out->sine = a->sine + share * (b->sine - a->sine);
        landing middle = *at;
        middle.sine = out->sine;
        double e = fan[i].elevation + share * (fan[i + 1].elevation - fan[i].elevation);
        *tube = tube_of(fan[i].elevation, e, fan[i + 1].elevation, a, &middle, b);
        return true;
    }
    return false;
}

/* Both echoes of ray I: the way over the mirror twice, and once with the straight way, in both orders. The face looks
 * on half of all azimuths. */
static void add_ray(reference *r, const fan_ray *fan, int i) {
    const landing *o = &fan[i].first, *a = &fan[i - 1].second, *x = &fan[i].second,
                  *b = &fan[i + 1].second;
    if (!a->there || !x->there || !b->there || a->on_bottom != x->on_bottom ||
        b->on_bottom != x->on_bottom || fan[i - 1].first.on_bottom != o->on_bottom ||
        fan[i + 1].first.on_bottom != o->on_bottom) {
        return;
    }
    double e = fan[i].elevation, e0 = fan[i - 1].elevation, e1 = fan[i + 1].elevation;
    double ring = 3.14159265358979323846 * cos(e) * 0.5 * (e1 - e0);
    double q = speed_of(r->env, x->on_bottom ? DEPTH : 0.0) / r->c0_mps;
    double mu = mirrored_by(o->on_bottom ? &r->bottom : &r->surface, o->sine);
    double s_in = scattered_by(r, x->on_bottom, x->sine), tube = tube_of(e0, e, e1, a, x, b);
    double same = mu * mu * s_in * ring / x->sine * q * q / tube *
                  exp(-2.0 * r->np_per_m * (x->length_m - 1.0));
    double half = 0.25 * r->c0_mps * (b->time_s - a->time_s), range = r->c0_mps * x->time_s;
    deposit(r, range - half, range + half, same);
    landing direct;
    double tube_direct;
    if (find_direct(fan, x, &direct, &tube_direct)) {
        double s_out = scattered_by(r, x->on_bottom, direct.sine);
        double length = 0.5 * (x->length_m + direct.length_m);
        double cross = 2.0 * mu * sqrt(s_in * s_out) * ring / x->sine * q * q / tube_direct *
                       exp(-2.0 * r->np_per_m * (length - 1.0));
        /* Of the straight way as much changes as of the bent one, nearly. */
        double middle = 0.5 * (range + r->c0_mps * direct.time_s);
        deposit(r, middle - half, middle + half, cross);
    }
}

static double *refer(const ping_rig *rig, const asdic_environment *env, size_t bins) {
    asdic_water_column water =
        asdic_water_column_at(&rig->env, &rig->sonar, rig->pose.position_m.z);
    asdic_law_water in = asdic_water_column_laws(&water, &rig->env, &rig->sonar);
    reference r = {.env = env,
                   .bottom = asdic_scatterer_at(&rig->scene->materials[0], &in),
                   .surface = asdic_scatterer_at(&rig->scene->surface, &in),
                   .depth_m = rig->pose.position_m.z,
                   .c0_mps = speed_of(env, rig->pose.position_m.z),
                   .np_per_m = water.absorption_np_per_m,
                   .bin_m = rig->sonar.bin_length_m,
                   .bins = bins,
                   .level = calloc(bins, sizeof(double))};
    assert_non_null(r.level);
    fan_ray *fan = make_fan(env, r.depth_m, 1.05 * (double)bins * r.bin_m / r.c0_mps);
    for (int i = 1; i + 1 < FAN; i++) {
        add_ray(&r, fan, i);
    }
    free(fan);
    return r.level;
}

/* ---- Tests ---- */

static void boundaries_mirror_as_steps_say(void **state) {
    static const struct {
        const char *name;
        double gradient_per_s;
        asdic_sound_profile cast;
        double depth_m;
    } cases[] = {
        {"one layer, -0.4 1/s", -0.4, {2, {0.0, 100.0}, {1490.0, 1450.0}}, 7.0},
        {"one layer, 0.4 1/s", 0.4, {2, {0.0, 100.0}, {1490.0, 1530.0}}, 7.0},
        {"eight layers",
         0.0,
         {8,
          {0.0, 1.5, 3.0, 4.5, 6.0, 7.5, 9.0, 12.0},
          {1490.0, 1489.8, 1489.0, 1487.0, 1484.5, 1483.0, 1482.2, 1482.0}},
         7.0},
        {"thermocline", 0.0, {4, {0.0, 5.0, 9.0, 12.0}, {1482.0, 1480.0, 1471.0, 1470.0}}, 8.0},
    };
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        ping_rig r = bent_rig(cases[k].gradient_per_s, 1u << 17);
        asdic_environment env = r.env;
        env.sound_speed_profile = cases[k].cast;
        if (cases[k].gradient_per_s == 0.0) {
            r.env.sound_speed_profile = cases[k].cast;
        } else {
            r.env.sound_speed_mps = 1490.0;
        }
        r.env.wind_speed_kn = 1.0;
        r.pose.position_m.z = cases[k].depth_m;
        r.sonar.bin_length_m = 1.0;
        r.sonar.rear_floor_db = -INFINITY;
        r.sonar.transmitter.length_h_m = r.sonar.transmitter.length_v_m = 1e-4;
        r.receivers[0] = r.sonar.transmitter;
        r.sampling.multipath = ASDIC_MULTIPATH_BOUNDARIES;
        asdic_ping *ping = rig_shoot(&r, 0, true);
        double *level = refer(&r, &env, ping->bins), sum = 0.0, most = 0.0, count = 0.0;
        for (size_t n = 0; n + 1 < ping->bins; n++) {
            double got = ping->intensity_lin[ASDIC_MULTIPATH][n];
            if (n >= 14) {
                double off = fabs(10.0 * log10(got / level[n]));
                sum += off * off;
                most = fmax(most, off);
                count += 1.0;
            }
        }
        print_message("%s: multipath r.m.s. %.3f dB, most %.3f\n", cases[k].name, sqrt(sum / count),
                      most);
        assert_true(sqrt(sum / count) < 0.05 && most < 0.25);
        free(level);
        asdic_ping_destroy(&ping);
        rig_destroy(&r);
    }
}

/* A ball, a plate and the boundaries as mirrors. */
static ping_rig mirror_rig(uint32_t rays) {
    ping_rig r = bent_rig(0.0, rays);
    asdic_mesh *mesh = NULL;
    asdic_pose ball = {.position_m = {11.0, -2.0, 9.0}}, plate = {{13.0, 3.0, 8.0}, 0.1, 0.2, 0.7};
    r.sampling.multipath = ASDIC_MULTIPATH_BOUNDARIES;
    r.sonar.bin_length_m = 1.0;
    assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, 1.5, 24, &mesh));
    assert_ok(t.ctx, asdic_scene_add_object(r.scene, "ball", mesh, ball,
                                            asdic_material_facet(45.0, 1e-3, 0.1)));
    asdic_mesh_destroy(&mesh);
    assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){2.0, 4.0, 6.0}, &mesh));
    assert_ok(t.ctx, asdic_scene_add_object(r.scene, "plate", mesh, plate,
                                            asdic_material_facet(45.0, 1e-3, 0.1)));
    asdic_mesh_destroy(&mesh);
    return r;
}

/* Layers whose gradients differ by 1e-6 1/s, in whose middle objects are, are one. */
static void layers_alike_mirror_as_one(void **state) {
    static const double gradients[] = {0.0, 0.4, -0.4};
    (void)state;
    for (int k = 0; k < 3; k++) {
        asdic_ping *pings[2];
        for (int layers = 0; layers < 2; layers++) {
            ping_rig r = mirror_rig(1u << 16);
            double g = gradients[k], off = 1e-6;
            r.env.sound_speed_mps = 1490.0;
            r.env.sound_speed_gradient_per_s = layers ? 0.0 : g;
            if (layers) {
                r.layout.width = full && k == 1 ? 1 : r.layout.width;
                r.env.sound_speed_profile =
                    (asdic_sound_profile){5,
                                          {0.0, 4.0, 7.5, 10.0, 100.0},
                                          {1490.0, 1490.0 + 4.0 * g + off, 1490.0 + 7.5 * g - off,
                                           1490.0 + 10.0 * g + off, 1490.0 + 100.0 * g}};
            }
            pings[layers] = rig_shoot(&r, 0, true);
            rig_destroy(&r);
        }
        difference d = compare(pings[1], pings[0], ASDIC_MULTIPATH);
        print_message("%4.1f 1/s: multipath through layers r.m.s. %.4f dB off one, most %.3f\n",
                      gradients[k], d.rms_db, d.most_db);
        assert_true(d.rms_db < 0.03 && d.most_db < 0.2);
        assert_true(pings[0]->intensity_lin[ASDIC_MULTIPATH][30] > 0.0);
        asdic_ping_destroy(&pings[0]);
        asdic_ping_destroy(&pings[1]);
    }
}

/* A cast of 60 points over a box and beside a mast behind the sonar, which keeps the layers' triangles apart: there
 * a tracer's coordinates are large. A slanting face is heard by way of the boundaries as in water that does not bend
 * sound, and does not hide itself. */
static void many_layers_mirror_as_none(void **state) {
    (void)state;
    double sum[2] = {0.0, 0.0};
    for (int layers = 0; layers < 2; layers++) {
        ping_rig r = bent_rig(0.0, 1u << 15);
        asdic_mesh *mesh = NULL;
        const asdic_pose at = {.position_m = {35.0, 0.0, 8.0}, .pitch_rad = 0.7};
        const asdic_pose behind = {.position_m = {-30.0, 0.0, 0.0}};
        asdic_sound_profile *cast = &r.env.sound_speed_profile;
        r.env.sound_speed_mps = 1490.0;
        r.env.wind_speed_kn = 2.0;
        r.sampling.multipath = ASDIC_MULTIPATH_BOUNDARIES;
        for (int i = 0; layers && i < 60; i++) {
            cast->depth_m[i] = 0.1 * i;
            cast->sound_speed_mps[i] = 1490.0 + 1e-5 * (i % 2);
        }
        cast->points = layers ? 60 : 0;
        assert_ok(t.ctx, asdic_scene_set_bottom_plane(r.scene, DEPTH, asdic_material_bottom(2.0)));
        assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){4.0, 8.0, 4.0}, &mesh));
        assert_ok(t.ctx,
                  asdic_scene_add_object(r.scene, "box", mesh, at, asdic_material_bottom(2.0)));
        asdic_mesh_destroy(&mesh);
        assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){1.0, 1.0, 120.0}, &mesh));
        assert_ok(t.ctx, asdic_scene_add_object(r.scene, "mast", mesh, behind,
                                                asdic_material_bottom(2.0)));
        asdic_mesh_destroy(&mesh);
        asdic_ping *ping = rig_shoot(&r, 0, true);
        for (size_t n = 0; n < ping->bins; n++) {
            sum[layers] += ping->intensity_lin[ASDIC_MULTIPATH][n];
        }
        asdic_ping_destroy(&ping);
        rig_destroy(&r);
    }
    print_message("multipath through 60 layers %.3f dB off\n", 10.0 * log10(sum[1] / sum[0]));
    assert_true(sum[0] > 0.0);
    assert_close(sum[1] / sum[0], 1.0, 0.01);
}

/* A bar near the surface at 40 m, in water that bends sound down: the arc to it from a sonar as deep would rise by
 * 40^2 / (8 400) = 0.5 m, out of the water. It is heard by way of the bottom, out and back, but not across.
 * The bottom sends nothing back but to its nadir; what the surface does is there without the bar, too. */
static void shadows_are_heard_by_mirrors_alone(void **state) {
    (void)state;
    double across[2] = {0.0}, same[2] = {0.0};
    for (int with = 0; with < 2; with++) {
        ping_rig r = bent_rig(0.0, 1u << 18);
        asdic_mesh *mesh = NULL;
        const asdic_pose at = {.position_m = {40.0, 0.0, 0.3}};
        r.env.sound_speed_mps = 1500.0;
        r.env.sound_speed_gradient_per_s = -1500.0 / 400.0;
        r.env.wind_speed_kn = 0.0;
        r.pose.position_m.z = 0.3;
        r.sonar.transmitter.length_h_m = r.sonar.transmitter.length_v_m = 1e-4;
        r.receivers[0] = r.sonar.transmitter;
        r.sampling.multipath = ASDIC_MULTIPATH_BOUNDARIES;
        assert_ok(t.ctx, asdic_scene_set_bottom_plane(r.scene, DEPTH,
                                                      asdic_material_facet(45.0, 0.0, 0.0)));
        assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){0.1, 10.0, 0.4}, &mesh));
        if (with) {
            assert_ok(t.ctx,
                      asdic_scene_add_object(r.scene, "bar", mesh, at, asdic_material_bottom(2.0)));
        }
        asdic_mesh_destroy(&mesh);
        asdic_ping *ping = rig_shoot(&r, 0, false);
        for (size_t n = 0; n < ping->bins; n++) { /* sqrt(40^2 + 23.4^2) = 46.3, twice or with 40 */
            double range_m = ((double)n + 0.5) * ping->bin_length_m;
            double got = ping->intensity_lin[ASDIC_MULTIPATH][n];
            across[with] += range_m > 41.0 && range_m < 45.5 ? got : 0.0;
            same[with] += range_m > 45.5 && range_m < 49.0 ? got : 0.0;
        }
        asdic_ping_destroy(&ping);
        rig_destroy(&r);
    }
    double heard = same[1] - same[0];
    print_message("across %.2g of what is heard by way of the bottom alone\n",
                  (across[1] - across[0]) / heard);
    assert_true(heard > 0.5 * same[1]);
    assert_close((across[1] - across[0]) / heard, 0.0, 2e-3);
}

int main(int argc, char **argv) {
    full = argc == 2 && strcmp(argv[1], "full") == 0;
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(boundaries_mirror_as_steps_say),
        cmocka_unit_test(layers_alike_mirror_as_one),
        cmocka_unit_test(many_layers_mirror_as_none),
        cmocka_unit_test(shadows_are_heard_by_mirrors_alone),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
