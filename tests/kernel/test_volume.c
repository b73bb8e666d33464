/*
 * The water's own echo where rays pass through layers: beside quadrature that follows rays by itself, through casts
 * that fold rays and spread them, with the sonar in, at and beside what does so.
 */
#include "bent_rig.h"

/* A strong thermocline: 10 degrees in 3 m. */
#define LAKE                                                                                       \
    {                                                                                              \
        4, {0.0, 4.0, 7.0, 12.0}, {                                                                \
            1521.0, 1518.0, 1485.0, 1473.0                                                         \
        }                                                                                          \
    }

typedef struct water_case {
    const char *name;
    double depth_m;
    asdic_sound_profile cast;
    double total_db, volume_db; /* r.m.s. that is allowed */
} water_case;

/* Where caustics pass there are few rays in each: more in the last cases. */
static const water_case cases[] = {
    {"over a thermocline", 7.0, {3, {0, 8, 60}, {1495, 1495, 1443}}, 0.01, 0.02},
    {"inside a thermocline", 7.0, {4, {0, 5, 9, 12}, {1482, 1480, 1471, 1470}}, 0.01, 0.03},
    {"at its knee", 4.0, LAKE, 0.01, 0.02},
    {"below its knee", 4.5, LAKE, 0.01, 0.02},
    {"upward", 7.0, {3, {0, 4, 12}, {1480, 1482, 1490}}, 0.01, 0.02},
    {"above a channel", 5.0, {3, {0, 7, 20}, {1500, 1480, 1500}}, 0.02, 0.03},
    {"at its foot", 7.0, LAKE, 0.1, 0.15},
    {"on a channel's axis", 7.0, {3, {0, 7, 12}, {1490, 1484, 1489}}, 0.05, 0.4},
};

static ping_rig rig_of(const water_case *c, uint32_t rays) {
    ping_rig r = bent_rig(0.0, rays);
    r.pose.position_m.z = c->depth_m;
    r.env.sound_speed_profile = c->cast;
    r.sonar.blanking_m = 0.4 * r.sonar.bin_length_m; /* so that the first bin has water */
    return r;
}

/* Computed once for the functions that ask. */
static asdic_ping *truths[sizeof cases / sizeof *cases];

static const asdic_ping *truth_of(size_t k, const ping_rig *r, const asdic_ping *like) {
    truths[k] = truths[k] ? truths[k] : expected(r, like);
    return truths[k];
}

static int destroy_truths(void **state) {
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        asdic_ping_destroy(&truths[k]);
    }
    return 0;
}

static void water_meets_quadrature(void **state) {
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        ping_rig r = rig_of(&cases[k], 1u << 16);
        asdic_ping *ping = rig_shoot(&r, 0, true);
        const asdic_ping *truth = truth_of(k, &r, ping);
        difference d = compare(ping, truth, ASDIC_TOTAL), v = compare(ping, truth, ASDIC_VOLUME);
        double first_db = asdic_level_db(ping->intensity_lin[ASDIC_VOLUME][0]) -
                          asdic_level_db(truth->intensity_lin[ASDIC_VOLUME][0]);
        print_message("%s: r.m.s. %.4f dB, most %.3f; volume %.4f, most %.3f, first bin %.3f\n",
                      cases[k].name, d.rms_db, d.most_db, v.rms_db, v.most_db, first_db);
        assert_true(d.rms_db < cases[k].total_db && v.rms_db < cases[k].volume_db);
        assert_true(fabs(first_db) < cases[k].volume_db);
        asdic_ping_destroy(&ping);
        rig_destroy(&r);
    }
}

/* Of few rays: where the water is most of the level, steps and the rays left out must show in the stated error. */
static void stated_errors_are_honest(void **state) {
    enum { PINGS = 24 };
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        ping_rig r = rig_of(&cases[k], 16384u);
        asdic_simulator *sim = rig_simulator(&r);
        asdic_ping *ping = NULL;
        double sum = 0.0, count = 0.0;
        assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, asdic_simulator_bin_count(sim), &ping));
        const asdic_ping *truth = truth_of(k, &r, ping);
        for (uint64_t i = 0; i < PINGS; i++) {
            if (i % 4 == 0) {
                assert_ok(t.ctx, asdic_simulator_learn(sim, &r.pose, ASDIC_LEARN_BLOCK * i));
            }
            assert_ok(t.ctx, asdic_simulator_ping(sim, &r.pose,
                                                  ASDIC_LEARN_BLOCK * (i / 4 * 4) + i % 4, ping));
            for (size_t n = 4; n < ping->bins; n++) {
                double off = asdic_level_db(ping->intensity_lin[ASDIC_TOTAL][n]) -
                             asdic_level_db(truth->intensity_lin[ASDIC_TOTAL][n]);
                sum += pow(off / ping->stderr_db[n], 2.0);
                count += 1.0;
            }
        }
        print_message("%s: true over stated error %.2f\n", cases[k].name, sqrt(sum / count));
        assert_true(sqrt(sum / count) > 0.7 && sqrt(sum / count) < 1.3);
        asdic_ping_destroy(&ping);
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
}

/* Millimetres off a channel's axis rays fold more often than their water has steps: it is spread along the way, but not
 * over bins in which nothing else is heard. The mean of pings tells this from chance. */
static void water_beside_an_axis_is_near_its_place(void **state) {
    static const water_case off[] = {{"5 mm above", 6.995, {3, {0, 7, 20}, {1500, 1480, 1500}}},
                                     {"2 mm below", 7.002, {3, {0, 7, 20}, {1500, 1480, 1500}}}};
    enum { PINGS = 4 };
    (void)state;
    for (size_t k = 0; k < sizeof off / sizeof *off; k++) {
        ping_rig r = rig_of(&off[k], 1u << 17);
        asdic_ping *mean = rig_shoot(&r, 0, true), *truth = expected(&r, mean);
        double *total = mean->intensity_lin[ASDIC_TOTAL];
        for (uint64_t i = 1; i < PINGS; i++) {
            asdic_ping *next = rig_shoot(&r, ASDIC_LEARN_BLOCK * i, true);
            for (size_t n = 0; n < mean->bins; n++) {
                total[n] += next->intensity_lin[ASDIC_TOTAL][n];
            }
            asdic_ping_destroy(&next);
        }
        for (size_t n = 0; n < mean->bins; n++) {
            total[n] /= PINGS;
        }
        difference d = compare(mean, truth, ASDIC_TOTAL);
        print_message("%s an axis: r.m.s. %.4f dB, most %.3f\n", off[k].name, d.rms_db, d.most_db);
        assert_true(d.rms_db < 0.06 && d.most_db < 0.5);
        asdic_ping_destroy(&truth);
        asdic_ping_destroy(&mean);
        rig_destroy(&r);
    }
}

/* Many receivers get their water from lists by bins, few from cells: the same but for rounding. */
static void fans_hear_the_same_water(void **state) {
    enum { MANY = 80 };
    (void)state;
    ping_rig r = rig_of(&cases[6], 4096u);
    asdic_beam fan[MANY];
    asdic_ping *ping[2];
    for (int many = 0; many < 2; many++) {
        size_t beams = many ? MANY : 3;
        asdic_simulator *sim = NULL;
        for (size_t b = 0; b < MANY; b++) {
            fan[b] = r.sonar.transmitter;
            fan[b].yaw_rad = (double)b * 0.01;
        }
        r.sonar.receivers = fan;
        r.sonar.receiver_count = beams;
        r.sampling.sampler = ASDIC_SAMPLER_UNIFORM_SPHERE; /* the same rays for both */
        if (!many) {
            assert_ok(t.ctx, asdic_scene_commit(r.scene));
        }
        assert_ok(t.ctx,
                  asdic_simulator_create_with(t.ctx, t.device, r.scene, &r.env, &r.sonar,
                                              &r.sampling, r.pose.position_m.z, &r.layout, &sim));
        assert_ok(t.ctx,
                  asdic_ping_create(t.ctx, beams, asdic_simulator_bin_count(sim), &ping[many]));
        assert_ok(t.ctx, asdic_simulator_ping(sim, &r.pose, 0, ping[many]));
        asdic_simulator_destroy(&sim);
    }
    for (size_t i = 0; i < 3 * ping[0]->bins; i++) {
        double few = ping[0]->intensity_lin[ASDIC_VOLUME][i];
        assert_close(ping[1]->intensity_lin[ASDIC_VOLUME][i], few, 1e-3 * few + 1e-30);
    }
    asdic_ping_destroy(&ping[0]);
    asdic_ping_destroy(&ping[1]);
    rig_destroy(&r);
}

/* What is heard in water of many layers by 32 receivers at once is what three of them hear: everything that a ping has,
 * with mirrors, an object that has moved, a point, and what bins hold. */
static void fans_hear_the_same_through_layers(void **state) {
    enum { MANY = 32, FEW = 3 };
    (void)state;
    asdic_beam fan[MANY];
    asdic_ping *ping[2];
    for (int many = 0; many < 2; many++) {
        ping_rig r = bent_rig(0.0, 4096u);
        asdic_simulator *sim = NULL;
        asdic_mesh *mesh = NULL;
        asdic_pose at = {.position_m = {18.0, 0.0, 7.0}, .yaw_rad = 0.2};
        r.env.sound_speed_profile = (asdic_sound_profile)LAKE;
        for (size_t b = 0; b < MANY; b++) {
            fan[b] = r.sonar.transmitter;
            fan[b].yaw_rad = (double)b * 0.05;
        }
        r.sonar.receivers = fan;
        r.sonar.receiver_count = many ? MANY : FEW;
        r.sampling.sampler = ASDIC_SAMPLER_UNIFORM_SPHERE; /* the same rays for both */
        r.sampling.multipath = ASDIC_MULTIPATH_BOUNDARIES;
        r.sampling.truth = true;
        assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, 2.0, 24, &mesh));
        assert_ok(t.ctx, asdic_scene_add_moving_object(r.scene, "ball", mesh, at,
                                                       asdic_material_facet(45.0, 1e-3, 0.3)));
        asdic_mesh_destroy(&mesh);
        assert_ok(t.ctx,
                  asdic_scene_add_point(r.scene, "point", (asdic_vec3){30.0, 4.0, 9.0}, 0.0));
        assert_ok(t.ctx, asdic_scene_commit(r.scene));
        assert_ok(t.ctx,
                  asdic_simulator_create_with(t.ctx, t.device, r.scene, &r.env, &r.sonar,
                                              &r.sampling, r.pose.position_m.z, &r.layout, &sim));
        assert_ok(t.ctx, asdic_ping_create(t.ctx, r.sonar.receiver_count,
                                           asdic_simulator_bin_count(sim), &ping[many]));
        assert_ok(t.ctx, asdic_ping_add_truth(t.ctx, ping[many]));
        at.position_m.x = 12.0;
        assert_ok(t.ctx, asdic_simulator_move(sim, "ball", &at));
        assert_ok(t.ctx, asdic_simulator_ping(sim, &r.pose, 0, ping[many]));
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
    double sums[ASDIC_COMPONENT_COUNT] = {0.0}, around = 0.0;
    for (size_t i = 0; i < FEW * ping[0]->bins; i++) {
        for (int k = 0; k < ASDIC_COMPONENT_COUNT; k++) {
            double few = ping[0]->intensity_lin[k][i];
            double total = ping[0]->intensity_lin[ASDIC_TOTAL][i];
            assert_close(ping[1]->intensity_lin[k][i], few, 1e-3 * few + 1e-5 * total + 1e-30);
            sums[k] += few;
        }
        for (int path = 0; path < ASDIC_PATH_COUNT; path++) {
            double few = ping[0]->truth->path[path][i];
            assert_close(ping[1]->truth->path[path][i], few, 1e-3);
            around += path == ASDIC_PATH_BY_SURFACE || path == ASDIC_PATH_BY_BOTTOM ? few : 0.0;
        }
    }
    assert_true(sums[ASDIC_OBJECT] > 0.0 && sums[ASDIC_MULTIPATH] > 0.0 && around > 1.0);
    asdic_ping_destroy(&ping[0]);
    asdic_ping_destroy(&ping[1]);
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(water_meets_quadrature),
        cmocka_unit_test(stated_errors_are_honest),
        cmocka_unit_test(water_beside_an_axis_is_near_its_place),
        cmocka_unit_test(fans_hear_the_same_water),
        cmocka_unit_test(fans_hear_the_same_through_layers),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, destroy_truths));
}
