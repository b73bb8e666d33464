/* Formulas and sums in single precision: where digits are lost. */
#include "hard_cases.h"
#include "ping_rig.h"

#include "kernels/formulas.h"
#include "sim/model_table.h"

/* Grazing or incidence angles, the ends and their neighbours included. */
static const double angles_deg[] = {0,  1e-30, 1e-7, 1e-4, 0.01, 0.5,  5,     20,      45,
                                    60, 75,    85,   88.3, 89.5, 89.9, 89.99, 89.9999, 90};
static const double frequencies_khz[] = {0.1, 1, 10, 100, 1000, 3000};

enum { ANGLES = sizeof angles_deg / sizeof *angles_deg, FREQUENCIES = 6, MOST_POINTS = 8192 };

typedef struct points {
    double keys[MOST_POINTS * ASDIC_MODEL_MAX_KEYS], host[MOST_POINTS], device[MOST_POINTS];
    size_t count;
} points;

/* Keys are rounded to what a float holds: the function is tested, not its argument. GCC 12 drops the
 * rounding when it vectorises the plain cast. */
static void add_point(points *p, const double *keys, size_t count) {
    assert_true(p->count < MOST_POINTS);
    for (size_t k = 0; k < count; k++) {
        volatile float rounded = (float)keys[k];
        p->keys[p->count * ASDIC_MODEL_MAX_KEYS + k] = rounded;
    }
    p->count++;
}

static void evaluate(points *p, size_t model) {
    assert_ok(hard_device.ctx,
              asdic_model_evaluate_many(hard_device.ctx, NULL, model, p->keys, p->count, p->host));
    assert_ok(hard_device.ctx, asdic_model_evaluate_many(hard_device.ctx, hard_device.device, model,
                                                         p->keys, p->count, p->device));
}

/* Largest difference in dB of levels above FLOOR_DB; NAN where the device gives none. */
static double worst_db(points *p, size_t model, double floor_db) {
    double worst = 0.0;
    evaluate(p, model);
    for (size_t i = 0; i < p->count; i++) {
        double off = p->device[i] == p->host[i] || (p->host[i] < floor_db && !isnan(p->device[i]))
                         ? 0.0
                         : fabs(p->device[i] - p->host[i]);
        worst = off > worst || isnan(off) ? off : worst;
    }
    free(p);
    return worst;
}

double hard_bottom_law(void) {
    points *p = calloc(1, sizeof *p);
    for (double type = 1.0; type <= 4.0; type += 0.25) {
        for (int k = 0; k < FREQUENCIES * ANGLES; k++) {
            double keys[] = {type, frequencies_khz[k / ANGLES], angles_deg[k % ANGLES]};
            add_point(p, keys, 3);
        }
    }
    return worst_db(p, MODEL_BOTTOM_BACKSCATTER, -300.0);
}

double hard_surface_law(void) {
    points *p = calloc(1, sizeof *p);
    for (double wind = 0.0; wind <= 40.0; wind += 5.0) {
        for (int k = 0; k < FREQUENCIES * ANGLES; k++) {
            double keys[] = {wind, frequencies_khz[k / ANGLES], angles_deg[k % ANGLES], 0.0};
            add_point(p, keys, 4);
        }
    }
    return worst_db(p, MODEL_SURFACE_BACKSCATTER, -300.0);
}

double hard_facet_law(void) {
    static const double slopes[] = {1e-6, 1e-5, 1e-3, 0.1, 0.5};
    static const double roughness_m[] = {0.0, 1e-3, 0.02};
    points *p = calloc(1, sizeof *p);
    for (int k = 0; k < 15 * FREQUENCIES * ANGLES; k++) {
        double keys[] = {angles_deg[k % ANGLES],
                         frequencies_khz[k / ANGLES % FREQUENCIES],
                         1500.0,
                         roughness_m[k / ANGLES / FREQUENCIES % 3],
                         slopes[k / ANGLES / FREQUENCIES / 3],
                         1.0};
        add_point(p, keys, 6);
    }
    return worst_db(p, MODEL_FACET_STRENGTH, -300.0);
}

/* Intensity beside the first eight nulls of a face of ten wavelengths. */
double hard_patterns_beside_nulls(void) {
    points *p = calloc(1, sizeof *p);
    for (int null = 1; null <= 8; null++) {
        for (int side = -1; side <= 1; side += 2) {
            double x = null + side * 1e-4;
            double keys[] = {asin(x / 10.0) / RIG_DEGREE, 0.0, 10.0, 1.0, 1.0};
            add_point(p, keys, 5);
        }
    }
    evaluate(p, MODEL_BEAM_PATTERN);
    double worst = 0.0;
    for (size_t i = 0; i < p->count; i++) {
        worst = fmax(worst, fabs(pow(10.0, 0.1 * p->device[i]) - pow(10.0, 0.1 * p->host[i])));
    }
    free(p);
    return worst;
}

double hard_zero_energy(void) {
    double wrong = asdic_level_db(0.0) != -INFINITY;
    wrong += model_db(beam_pattern_lin(0.8, 0.6, 0.0, 5.0, 1.0, 0.0)) != -INFINITY; /* a null */
    points *p = calloc(1, sizeof *p);
    double behind[] = {180.0, 0.0, 0.05, 0.05, 0.015};
    add_point(p, behind, 5);
    evaluate(p, MODEL_BEAM_PATTERN);
    wrong += (p->host[0] != -INFINITY) + (p->device[0] != -INFINITY);
    free(p);
    ping_rig r = rig_create(&hard_device);
    asdic_ping *ping = rig_shoot(&r, 0, false);
    for (size_t n = 0; n < 10; n++) { /* nothing of the bottom 5 m away, nor of any object */
        wrong += asdic_level_db(ping->intensity_lin[ASDIC_BOTTOM][n]) != -INFINITY;
        wrong += asdic_level_db(ping->intensity_lin[ASDIC_OBJECT][n]) != -INFINITY;
    }
    asdic_ping_destroy(&ping);
    rig_destroy(&r);
    return wrong;
}

double hard_wrong_input(void) {
    static const struct {
        const char *model, *keys[5];
        bool taken;
    } inputs[] = {
        {"sound-speed", {"t_degc=-273", "s_ppt=35", "z_m=0"}, false},
        {"absorption", {"f_khz=-1", "t_degc=10", "s_ppt=35", "z_m=0", "ph=8"}, false},
        {"absorption", {"f_khz=nan", "t_degc=10", "s_ppt=35", "z_m=0", "ph=8"}, false},
        {"absorption", {"f_khz=100", "t_degc=-273", "s_ppt=35", "z_m=0", "ph=8"}, false},
        {"absorption", {"f_khz=100", "t_degc=10", "s_ppt=0", "z_m=0", "ph=8"}, true},
        {"transmission-loss", {"d_m=0", "alpha_db_per_km=30"}, false},
        {"bottom-backscatter", {"type=sand", "f_khz=100", "grazing_deg=90.0001"}, false},
        {"bottom-backscatter", {"type=sand", "f_khz=100", "grazing_deg=0"}, true},
        {"surface-backscatter", {"wind_kn=0", "f_khz=100", "grazing_deg=90"}, true},
        {"noise-sea-state", {"f_khz=100", "wind_kn=0"}, true},
        {"noise-sea-state", {"f_khz=100", "wind_kn=-1"}, false},
    };
    double wrong = 0.0;
    for (size_t i = 0; i < sizeof inputs / sizeof *inputs; i++) {
        size_t keys = 0;
        while (keys < 5 && inputs[i].keys[keys]) {
            keys++;
        }
        double value = NAN;
        bool taken = asdic_model_evaluate(hard_device.ctx, NULL, inputs[i].model, inputs[i].keys,
                                          keys, &value) == ASDIC_OK;
        wrong += taken != inputs[i].taken || (taken && isnan(value));
    }
    return wrong;
}

/* In single precision a sum stops growing at 2^24 equal terms: 0.05 dB are lost after ten million. */
double hard_one_bin(void) {
    ping_rig r = rig_create(&hard_device);
    asdic_flat_scene flat = rig_flat(&r);
    asdic_ping *truth = NULL;
    r.sonar.receiver_count = 1;
    r.sonar.bin_length_m = 37.0;
    r.sonar.blanking_m = 2.0;
    r.sampling.rays = hard_full ? 100000000u : 10000000u;
    asdic_ping *ping = rig_shoot(&r, 0, true);
    assert_ok(hard_device.ctx, asdic_ping_create(hard_device.ctx, 1, ping->bins, &truth));
    assert_ok(hard_device.ctx,
              asdic_expected_compute(hard_device.ctx, &flat, &r.env, &r.sonar, &r.pose, truth));
    double most = 0.0;
    for (size_t n = 0; n < ping->bins; n++) {
        most = fmax(most, fabs(asdic_level_db(ping->intensity_lin[ASDIC_TOTAL][n] /
                                              truth->intensity_lin[ASDIC_TOTAL][n])));
    }
    asdic_ping_destroy(&truth);
    asdic_ping_destroy(&ping);
    rig_destroy(&r);
    return most;
}

static double differing(const asdic_ping *a, const asdic_ping *b) {
    double count = 0.0;
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        for (size_t i = 0; i < a->beams * a->bins; i++) {
            count += a->intensity_lin[c][i] != b->intensity_lin[c][i];
        }
    }
    return count;
}

double hard_same_bytes(void) {
    ping_rig r = rig_create(&hard_device);
    r.sampling.rays = 1000000;
    asdic_ping *first = rig_shoot(&r, 3, true), *again = rig_shoot(&r, 3, true);
    r.layout.deposit = ASDIC_DEPOSIT_ATOMIC32;
    r.layout.local = 8;
    asdic_ping *other = rig_shoot(&r, 3, true);
    double count = differing(first, again) + differing(first, other);
    asdic_ping_destroy(&first);
    asdic_ping_destroy(&again);
    asdic_ping_destroy(&other);
    rig_destroy(&r);
    return count;
}

/* Levels of -300 to -450 dB re 1 uPa, far below the least float. */
double hard_quiet_source(void) {
    ping_rig r = rig_create(&hard_device);
    asdic_ping *loud = rig_shoot(&r, 0, true);
    r.sonar.source_level_db = -300.0;
    asdic_ping *quiet = rig_shoot(&r, 0, true);
    double most = 0.0;
    for (size_t i = 0; i < loud->beams * loud->bins; i++) {
        double a = loud->intensity_lin[ASDIC_TOTAL][i], b = quiet->intensity_lin[ASDIC_TOTAL][i];
        most = a > 0.0 ? fmax(most, fabs(asdic_level_db(b) - asdic_level_db(a) + 300.0)) : most;
    }
    asdic_ping_destroy(&loud);
    asdic_ping_destroy(&quiet);
    rig_destroy(&r);
    return most;
}

/* A polished plate ahead; or the same of water, which hides as much and returns nothing. */
static asdic_ping *beside_plate(ping_rig *r, bool polished, bool with_ball) {
    asdic_mesh *mesh = NULL;
    asdic_pose at = {.position_m = {5.0, 0.0, 7.0}};
    double impedance = polished ? 0.0 : 1025e-6 * asdic_environment_sound_speed_mps(&r->env, 7.0);
    assert_ok(hard_device.ctx, asdic_mesh_plate(hard_device.ctx, 0.5, 0.5, &mesh));
    assert_ok(hard_device.ctx, asdic_scene_add_object(r->scene, "plate", mesh, at,
                                                      asdic_material_facet(impedance, 0.0, 0.0)));
    asdic_mesh_destroy(&mesh);
    if (with_ball) {
        at.position_m = (asdic_vec3){42.6, 20.0, 7.0};
        assert_ok(hard_device.ctx, asdic_mesh_sphere(hard_device.ctx, 0.5, 48, &mesh));
        assert_ok(hard_device.ctx,
                  asdic_scene_add_object(r->scene, "ball", mesh, at, asdic_material_bottom(1.0)));
        asdic_mesh_destroy(&mesh);
    }
    r->sampling.multipath = ASDIC_MULTIPATH_OFF;
    return rig_shoot(r, 0, false);
}

/* What the plate's echo does to the faintest of the others, at least 180 dB below it. */
double hard_dynamic_range(void) {
    static const asdic_component others[] = {ASDIC_BOTTOM, ASDIC_SURFACE, ASDIC_VOLUME};
    asdic_ping *pings[2];
    for (int polished = 0; polished < 2; polished++) {
        ping_rig r = rig_create(&hard_device);
        r.env.particle_strength_db = -155.0;
        pings[polished] = beside_plate(&r, polished, false);
        rig_destroy(&r);
    }
    double most = 0.0, loudest = 0.0, faintest = INFINITY;
    for (size_t i = 0; i < pings[0]->beams * pings[0]->bins; i++) {
        loudest = fmax(loudest, pings[1]->intensity_lin[ASDIC_OBJECT][i]);
        for (int c = 0; c < 3; c++) {
            double a = pings[0]->intensity_lin[others[c]][i];
            double b = pings[1]->intensity_lin[others[c]][i];
            faintest = a > 0.0 ? fmin(faintest, a) : faintest;
            most = a > 0.0 ? fmax(most, fabs(asdic_level_db(b / a))) : most;
        }
    }
    assert_true(asdic_level_db(loudest / faintest) > 180.0);
    asdic_ping_destroy(&pings[0]);
    asdic_ping_destroy(&pings[1]);
    return most;
}

/* A ball of mud in the side lobes, an object like the plate: what shares an accumulator. */
double hard_faint_object(void) {
    asdic_ping *pings[2];
    double energy[2] = {0.0, 0.0};
    for (int polished = 0; polished < 2; polished++) {
        ping_rig r = rig_create(&hard_device);
        r.sonar.receiver_count = 1;
        r.sampling.rays = 1 << 18;
        pings[polished] = beside_plate(&r, polished, true);
        for (size_t n = 90; n < 100; n++) {
            energy[polished] += pings[polished]->intensity_lin[ASDIC_OBJECT][n];
        }
        rig_destroy(&r);
    }
    double loudest = 0.0;
    for (size_t n = 0; n < pings[1]->bins; n++) {
        loudest = fmax(loudest, pings[1]->intensity_lin[ASDIC_OBJECT][n]);
    }
    assert_true(asdic_level_db(loudest / energy[0]) > 110.0);
    asdic_ping_destroy(&pings[0]);
    asdic_ping_destroy(&pings[1]);
    return fabs(asdic_level_db(energy[1] / energy[0]));
}
