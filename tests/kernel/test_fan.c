/* Many receivers against the quadrature: fans of every size, apertures that are not a whole number of
 * wavelengths, pitch and roll. */
#include "ping_rig.h"

#include <string.h>

static test_device t;

enum { MOST_BEAMS = 1024, MOST_COMPARED = 16 };

static asdic_beam beams[MOST_BEAMS];

typedef struct fan_case {
    size_t beams;
    double sector_deg, khz;
    double length_h_wl, length_v_wl, sender_h_wl, sender_v_wl;
    double pitch_deg, roll_deg; /* of the vehicle */
    double aim_deg;             /* of the array: downwards */
    bool cone;                  /* each beam at the same depression, not in the array's plane */
    uint32_t rays;
} fan_case;

/* No surface or bottom lies in a null of its apertures. More rays where errors would come near what is allowed. */
static const fan_case fans[] = {
    {256, 32, 100, 50.3, 3.36, 3.36, 3.36, 0, 0, 0, false, 300000},
    {256, 32, 100, 50.3, 3.36, 3.36, 3.36, -2, 0, 0, false, 300000},
    {2, 5, 100, 20.8, 0.74, 3.36, 3.36, 0, 0, 0, false, 300000},
    {5, 40, 100, 8.1, 2.2, 3.36, 3.36, 0, 5, 0, false, 300000},
    {16, 60, 100, 26.9, 1.34, 2.0, 1.34, 3, 0, 0, false, 300000},
    {17, 90, 120, 16.1, 8.1, 1.6, 8.1, 0, -12, 0, false, 300000},
    {64, 150, 100, 20.2, 0.5, 0.67, 0.5, 5, 7, 0, false, 300000},
    {96, 120, 300, 70.5, 12.1, 1.0, 12.1, -8, 3, 0, false, 300000},
    {256, 130, 450, 60.4, 10.6, 1.2, 10.6, 0, 10, 0, false, 1000000},
    {512, 130, 450, 75.5, 10.1, 1.1, 10.1, 10, 0, 0, false, 1000000},
    {1024, 100, 300, 100.7, 6.0, 1.2, 6.0, 0, 0, 0, false, 300000},
    {32, 30, 100, 13.4, 20.1, 6.7, 20.1, -5, -5, 0, false, 300000},
    {48, 120, 200, 30.7, 3.4, 0.9, 3.4, 0, 4, 10, false, 1000000},
    {48, 120, 200, 30.7, 3.4, 0.9, 3.4, 0, 4, 10, true, 1000000},
};

static ping_rig rig_of(const fan_case *f) {
    ping_rig r = rig_create(&t);
    double c_mps = asdic_environment_sound_speed_mps(&r.env, r.pose.position_m.z);
    double wavelength_m = c_mps / (1e3 * f->khz), aim = f->aim_deg * RIG_DEGREE;
    r.sonar.frequency_hz = 1e3 * f->khz;
    r.sonar.ping_rate_hz = 20.0;
    r.sonar.transmitter.length_h_m = f->sender_h_wl * wavelength_m;
    r.sonar.transmitter.length_v_m = f->sender_v_wl * wavelength_m;
    r.sonar.transmitter.pitch_rad = aim;
    r.pose.pitch_rad = f->pitch_deg * RIG_DEGREE;
    r.pose.roll_rad = f->roll_deg * RIG_DEGREE;
    for (size_t b = 0; b < f->beams; b++) {
        double bearing = f->sector_deg * (((double)b + 0.5) / (double)f->beams - 0.5) * RIG_DEGREE;
        beams[b] = r.sonar.transmitter;
        beams[b].length_h_m = f->length_h_wl * wavelength_m;
        beams[b].length_v_m = f->length_v_wl * wavelength_m;
        beams[b].yaw_rad = bearing;
        if (!f->cone) { /* the plane of a pitched array, from its axes */
            double x = cos(bearing) * cos(aim), y = sin(bearing), z = cos(bearing) * sin(aim);
            beams[b].yaw_rad = atan2(y, x);
            beams[b].pitch_rad = asin(z);
            beams[b].roll_rad = atan2(-sin(bearing) * sin(aim), cos(aim));
        }
    }
    r.sonar.receivers = beams;
    r.sonar.receiver_count = f->beams;
    r.sampling.rays = f->rays;
    return r;
}

static asdic_simulator *simulator_of(ping_rig *r) {
    asdic_simulator *sim = NULL;
    if (!asdic_scene_get_info(r->scene).bvh_nodes) {
        asdic_scene_commit(r->scene);
    }
    assert_ok(t.ctx,
              asdic_simulator_create_with(t.ctx, t.device, r->scene, &r->env, &r->sonar,
                                          &r->sampling, r->pose.position_m.z, &r->layout, &sim));
    return sim;
}

static asdic_ping *shoot(ping_rig *r, bool learn) {
    asdic_simulator *sim = simulator_of(r);
    asdic_ping *ping = rig_ping(r, sim);
    if (learn) {
        assert_ok(t.ctx, asdic_simulator_learn(sim, &r->pose, 0));
    }
    assert_ok(t.ctx, asdic_simulator_ping(sim, &r->pose, 0, ping));
    assert_int_equal(ping->saturated, 0);
    asdic_simulator_destroy(&sim);
    return ping;
}

/* What the beams of WHICH should hold. */
static asdic_ping *truth_of(const ping_rig *r, const size_t *which, size_t count, size_t bins) {
    asdic_beam picked[MOST_COMPARED];
    asdic_sonar few = r->sonar;
    asdic_flat_scene flat = rig_flat(r);
    asdic_ping *truth = NULL;
    for (size_t k = 0; k < count; k++) {
        picked[k] = r->sonar.receivers[which[k]];
    }
    few.receivers = picked;
    few.receiver_count = count;
    assert_ok(t.ctx, asdic_ping_create(t.ctx, count, bins, &truth));
    assert_ok(t.ctx, asdic_expected_compute(t.ctx, &flat, &r->env, &few, &r->pose, truth));
    return truth;
}

typedef struct difference {
    double rms_db, over_stated, mean_db; /* mean: the largest of a bin over its beams */
} difference;

/* Of all bins within 70 dB of the loudest, of beams spread over the fan. */
static difference compare(const ping_rig *r, const asdic_ping *ping) {
    size_t which[MOST_COMPARED] = {0},
           count = ping->beams < MOST_COMPARED ? ping->beams : MOST_COMPARED;
    for (size_t k = 0; k < count; k++) {
        which[k] = count > 1 ? k * (ping->beams - 1) / (count - 1) : 0;
    }
    asdic_ping *truth = truth_of(r, which, count, ping->bins);
    const double *should = truth->intensity_lin[ASDIC_TOTAL];
    double loudest = 0.0, squares = 0.0, ratios = 0.0, n = 0.0;
    difference d = {0};
    for (size_t i = 0; i < count * ping->bins; i++) {
        loudest = fmax(loudest, should[i]);
    }
    for (size_t bin = 1; bin < ping->bins; bin++) {
        double sum = 0.0, heard = 0.0;
        for (size_t k = 0; k < count; k++) {
            size_t cell = which[k] * ping->bins + bin;
            double level = should[k * ping->bins + bin];
            if (level > 1e-7 * loudest) {
                double off =
                    asdic_level_db(ping->intensity_lin[ASDIC_TOTAL][cell]) - asdic_level_db(level);
                double ratio = off / ping->stderr_db[cell];
                squares += off * off;
                ratios += ratio * ratio;
                n += 1.0;
                sum += off;
                heard += 1.0;
            }
        }
        d.mean_db = heard > 0.0 ? fmax(d.mean_db, fabs(sum / heard)) : d.mean_db;
    }
    d.rms_db = sqrt(squares / n);
    d.over_stated = sqrt(ratios / n);
    asdic_ping_destroy(&truth);
    return d;
}

static void fans_meet_the_quadrature(void **state) {
    (void)state;
    for (size_t k = 0; k < sizeof fans / sizeof *fans; k++) {
        const fan_case *f = &fans[k];
        ping_rig r = rig_of(f);
        asdic_ping *ping = shoot(&r, true);
        difference d = compare(&r, ping);
        print_message("%4zu beams over %3.0f degrees, L_V %4.1f, pitch %3g, roll %3g, aimed %2g%s: "
                      "RMS %.4f dB, over stated %.2f, mean over beams %.4f dB at most\n",
                      f->beams, f->sector_deg, f->length_v_wl, f->pitch_deg, f->roll_deg,
                      f->aim_deg, f->cone ? " (cone)" : "", d.rms_db, d.over_stated, d.mean_db);
        assert_true(d.mean_db < 0.05);
        assert_true(d.over_stated > 0.7 && d.over_stated < 1.35);
        assert_true(d.rms_db < 0.04);
        asdic_ping_destroy(&ping);
        rig_destroy(&r);
    }
}

/* Few rays of a narrow transmitter that looks beyond the fan: beams hear it by their side lobes. */
static void a_transmitter_beside_the_fan_is_heard(void **state) {
    (void)state;
    static const fan_case fan = {64, 30, 21.6, 36.8, 0.9, 15.4, 5.1, 0, 0, 30, true, 20000};
    ping_rig r = rig_of(&fan);
    r.sonar.transmitter.yaw_rad = -20.0 * RIG_DEGREE;
    asdic_ping *ping = shoot(&r, true);
    difference d = compare(&r, ping);
    print_message("beside the fan: RMS %.3f dB, over stated %.2f\n", d.rms_db, d.over_stated);
    assert_true(d.over_stated > 0.7 && d.over_stated < 1.35 && d.rms_db < 0.5);
    asdic_ping_destroy(&ping);
    rig_destroy(&r);
}

/* Beams far apart share the rays of a sector, most of which go between them. */
static void rays_for_beams_apart_suffice(void **state) {
    (void)state;
    static const fan_case fan = {20, 136, 120, 35.0, 7.4, 0.8, 1.4, -4, 0, 0, false, 0};
    ping_rig r = rig_of(&fan);
    r.sonar.bin_length_m = 0.1;
    r.sampling.rays =
        asdic_rays_auto(&r.sonar, asdic_environment_sound_speed_mps(&r.env, r.pose.position_m.z),
                        ASDIC_OVER_PLANES);
    asdic_ping *ping = shoot(&r, true);
    difference d = compare(&r, ping);
    print_message("beams apart, %u rays: RMS %.3f dB, over stated %.2f\n", r.sampling.rays,
                  d.rms_db, d.over_stated);
    assert_true(d.over_stated > 0.7 && d.over_stated < 1.35 && d.rms_db < 0.5);
    asdic_ping_destroy(&ping);
    rig_destroy(&r);
}

/* As loud behind as ahead: rays have a window on either side. */
static void echoes_from_behind_are_heard(void **state) {
    (void)state;
    static const fan_case fan = {24, 60, 100, 8.3, 1.3, 1.1, 1.3, -5, 4, 0, false, 300000};
    ping_rig r = rig_of(&fan);
    r.sonar.rear_floor_db = 0.0;
    asdic_ping *ping = shoot(&r, true);
    difference d = compare(&r, ping);
    print_message("as loud behind: RMS %.4f dB, over stated %.2f, mean %.4f dB\n", d.rms_db,
                  d.over_stated, d.mean_db);
    assert_true(d.rms_db < 0.3 && d.mean_db < 0.6 && d.over_stated > 0.7 && d.over_stated < 1.35);
    asdic_ping_destroy(&ping);
    rig_destroy(&r);
}

static void errors_fall_as_rays_grow(void **state) {
    (void)state;
    double rms_db[2];
    for (int k = 0; k < 2; k++) {
        ping_rig r = rig_of(&fans[0]);
        r.sampling.rays = k ? 640000 : 40000;
        asdic_ping *ping = shoot(&r, true);
        rms_db[k] = compare(&r, ping).rms_db;
        asdic_ping_destroy(&ping);
        rig_destroy(&r);
    }
    print_message("RMS %.4f dB with 40,000 rays, %.4f with 640,000\n", rms_db[0], rms_db[1]);
    assert_true(rms_db[1] < 0.2 * rms_db[0]);
}

/* Receivers of many sizes that look up, down and askew share no axis. */
static void any_receivers_meet_the_quadrature(void **state) {
    (void)state;
    enum { COUNT = 40 };
    ping_rig r = rig_of(&fans[4]);
    r.sampling.rays = 300000;
    for (size_t b = 0; b < COUNT; b++) {
        beams[b] = r.sonar.transmitter;
        beams[b].length_h_m *= 1.0 + (double)(b % 5);
        beams[b].length_v_m *= 1.0 + 0.5 * (double)(b % 3);
        beams[b].yaw_rad = (-40.0 + 2.0 * (double)b) * RIG_DEGREE;
        beams[b].pitch_rad = (-20.0 + 7.0 * (double)(b % 7)) * RIG_DEGREE;
        beams[b].roll_rad = 15.0 * (double)(b % 4) * RIG_DEGREE;
    }
    r.sonar.receiver_count = COUNT;
    asdic_ping *ping = shoot(&r, true);
    difference d = compare(&r, ping);
    print_message("RMS %.4f dB, over stated %.2f, mean %.4f dB\n", d.rms_db, d.over_stated,
                  d.mean_db);
    assert_true(d.rms_db < 0.1 && d.mean_db < 0.1 && d.over_stated > 0.7 && d.over_stated < 1.35);
    asdic_ping_destroy(&ping);
    rig_destroy(&r);
}

/* The energy of a beam's bins of COMPONENT from 8 m on, each made as loud as the others. */
static double energy_of(const asdic_ping *ping, asdic_component component, size_t beam) {
    double sum = 0.0;
    for (size_t n = 16; n < ping->bins; n++) {
        sum += ping->intensity_lin[component][beam * ping->bins + n] * pow((double)n, 3.0);
    }
    return sum;
}

/* Faces all round that leak backwards, sender and receivers each by themselves: few, many about one axis, and many
 * unlike ones. Rays go everywhere, so that nothing is aimed. */
static void faces_leak_backwards(void **state) {
    (void)state;
    static const size_t counts[] = {4, 16, 16};
    static const asdic_component parts[] = {ASDIC_BOTTOM, ASDIC_SURFACE, ASDIC_VOLUME};
    for (int k = 0; k < 3; k++) {
        const fan_case f = {counts[k],      360,  100,    1.3, 0.7, 0.6, 0.5, 12, -25,
                            k == 1 ? 0 : 5, true, 1 << 18};
        size_t which[16];
        ping_rig r = rig_of(&f);
        r.sonar.rear_floor_db = -7.0;
        r.sampling.sampler = ASDIC_SAMPLER_UNIFORM_SPHERE;
        for (size_t b = 0; b < counts[k]; b++) {
            beams[b].pitch_rad += k == 2 ? 0.1 * (double)b : 0.0;
            beams[b].roll_rad += k == 2 ? 0.3 * (double)b : 0.0;
            which[b] = b;
        }
        asdic_ping *ping = shoot(&r, false), *truth = truth_of(&r, which, counts[k], ping->bins);
        double most_db = 0.0;
        for (size_t b = 0; b < counts[k]; b++) {
            for (int p = 0; p < 3; p++) {
                double ratio = energy_of(ping, parts[p], b) / energy_of(truth, parts[p], b);
                most_db = fmax(most_db, fabs(asdic_level_db(ratio)));
            }
        }
        print_message("%zu faces all round: %.3f dB off at most\n", counts[k], most_db);
        assert_true(most_db < 0.3);
        asdic_ping_destroy(&truth);
        asdic_ping_destroy(&ping);
        rig_destroy(&r);
    }
}

static void add_ball(ping_rig *r) {
    asdic_mesh *mesh = NULL;
    assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, 0.5, 24, &mesh));
    asdic_pose pose = {.position_m = {25.0, 8.0, 9.0}};
    assert_ok(t.ctx, asdic_scene_add_object(r->scene, "ball", mesh, pose,
                                            asdic_material_facet(45.0, 1e-3, 0.2)));
    asdic_mesh_destroy(&mesh);
    assert_ok(t.ctx, asdic_scene_commit(r->scene));
}

/* Echoes and mirror paths of a ball: as the same beams hear them when they are few. */
static void many_hear_what_few_hear(void **state) {
    (void)state;
    enum { FEW = 8, FIRST = 38 };
    const fan_case f = {64, 90, 450, 40.3, 5.2, 1.1, 5.2, 4, 6, 0, false, 200000};
    ping_rig r = rig_of(&f);
    add_ball(&r);
    asdic_ping *many = shoot(&r, false);
    memmove(beams, beams + FIRST, FEW * sizeof *beams);
    r.sonar.receiver_count = FEW;
    r.sonar.receivers = beams;
    /* The rays of a sector, so that both have the same. */
    asdic_ping *few = shoot(&r, false);
    static const asdic_component parts[] = {ASDIC_OBJECT, ASDIC_MULTIPATH};
    for (size_t p = 0; p < 2; p++) {
        double loudest = 0.0, sum_many = 0.0, sum_few = 0.0;
        for (size_t i = 0; i < few->beams * few->bins; i++) {
            double a = many->intensity_lin[parts[p]][FIRST * many->bins + i];
            double b = few->intensity_lin[parts[p]][i];
            loudest = fmax(loudest, b);
            sum_many += a;
            sum_few += b;
        }
        double off_db = asdic_level_db(sum_many) - asdic_level_db(sum_few);
        print_message("%s: %.4f dB off in all\n", p ? "mirror paths" : "ball", off_db);
        assert_true(loudest > 0.0 && fabs(off_db) < (p ? 0.3 : 0.02));
    }
    asdic_ping_destroy(&many);
    asdic_ping_destroy(&few);
    rig_destroy(&r);
}

static void layout_never_changes_a_byte(void **state) {
    (void)state;
    const fan_case f = {150, 90, 450, 40.3, 5.2, 1.1, 5.2, 4, 6, 0, false, 200000};
    ping_rig r = rig_of(&f);
    add_ball(&r);
    asdic_ping *plain = shoot(&r, true);
    r.layout.local = 8;
    r.layout.batch_slots = 16384;
    r.layout.threads = 5;
    r.layout.thread_cells = 1;
    asdic_ping *other = shoot(&r, true);
    assert_true(rig_same(plain, other));
    asdic_ping_destroy(&plain);
    asdic_ping_destroy(&other);
    rig_destroy(&r);
}

/* A GPU's form: one receiver a work-item. As between kinds of devices, levels differ by 1e-3 dB at most. */
static void one_receiver_a_work_item_hears_the_same(void **state) {
    (void)state;
    const fan_case f = {150, 90, 450, 40.3, 5.2, 1.1, 5.2, 4, 6, 0, false, 20000};
    for (int mirrors = 0; mirrors < 2; mirrors++) {
        ping_rig r = rig_of(&f);
        r.sampling.multipath = mirrors ? ASDIC_MULTIPATH_FIRST : ASDIC_MULTIPATH_OFF;
        add_ball(&r);
        asdic_ping *wide = shoot(&r, false);
        r.layout.width = 1;
        r.layout.local = 64;
        asdic_ping *narrow = shoot(&r, false);
        double most_db = 0.0;
        for (size_t i = 0; i < wide->beams * wide->bins; i++) {
            double a = wide->intensity_lin[ASDIC_TOTAL][i];
            double b = narrow->intensity_lin[ASDIC_TOTAL][i];
            assert_true((a > 0.0) == (b > 0.0));
            most_db = a > 0.0 ? fmax(most_db, fabs(10.0 * log10(a / b))) : most_db;
        }
        print_message("one receiver against 16: %.2g dB at most\n", most_db);
        assert_true(most_db < 1e-3);
        asdic_ping_destroy(&wide);
        asdic_ping_destroy(&narrow);
        rig_destroy(&r);
    }
}

/* What a ping held before leaves nothing behind, whatever the scene lacks. */
static void used_pings_hold_what_fresh_ones_do(void **state) {
    (void)state;
    static const size_t counts[] = {5, 64, 67};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        const fan_case f = {counts[i], 90, 450, 40.3, 5.2, 1.1, 5.2, 4, 6, 0, false, 20000};
        ping_rig r = rig_of(&f);
        r.sampling.multipath = ASDIC_MULTIPATH_OFF;
        add_ball(&r);
        asdic_simulator *sim = simulator_of(&r);
        size_t bins = asdic_simulator_bin_count(sim), cells = counts[i] * bins;
        asdic_ping *fresh, *used;
        assert_ok(t.ctx, asdic_ping_create(t.ctx, counts[i], bins, &fresh));
        assert_ok(t.ctx, asdic_ping_create(t.ctx, counts[i], bins, &used));
        for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
            for (size_t n = 0; n < cells; n++) {
                used->intensity_lin[c][n] = n % 3 == 0 ? NAN : 7.0;
            }
        }
        assert_ok(t.ctx, asdic_simulator_ping(sim, &r.pose, 3, fresh));
        assert_ok(t.ctx, asdic_simulator_ping(sim, &r.pose, 3, used));
        assert_true(rig_same(fresh, used));
        for (size_t n = 0; n < cells; n++) {
            assert_true(used->intensity_lin[ASDIC_MULTIPATH][n] == 0.0);
        }
        asdic_ping_destroy(&fresh);
        asdic_ping_destroy(&used);
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fans_meet_the_quadrature),
        cmocka_unit_test(a_transmitter_beside_the_fan_is_heard),
        cmocka_unit_test(rays_for_beams_apart_suffice),
        cmocka_unit_test(echoes_from_behind_are_heard),
        cmocka_unit_test(errors_fall_as_rays_grow),
        cmocka_unit_test(any_receivers_meet_the_quadrature),
        cmocka_unit_test(faces_leak_backwards),
        cmocka_unit_test(many_hear_what_few_hear),
        cmocka_unit_test(layout_never_changes_a_byte),
        cmocka_unit_test(one_receiver_a_work_item_hears_the_same),
        cmocka_unit_test(used_pings_hold_what_fresh_ones_do),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
