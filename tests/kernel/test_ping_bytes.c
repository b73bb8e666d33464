/* The same bytes however the work on a ping is laid out; others for another seed or ping. */
#include "ping_rig.h"

static test_device t;

static void add_box(ping_rig *r, asdic_material material) {
    asdic_mesh *mesh = NULL;
    assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){4.0, 20.0, 2.0}, &mesh));
    asdic_pose pose = {.position_m = {37.2, 0.0, 11.0}};
    assert_ok(t.ctx, asdic_scene_add_object(r->scene, "box", mesh, pose, material));
    asdic_mesh_destroy(&mesh);
}

/* Work-groups of 1, 8, 64 and 4096, int64 atomics and none, batches. That no kernel needs fp64 or
 * local memory, tests/full/test_lint.py shows. */
static void layout_never_changes_a_byte_of(size_t beams) {
    ping_rig r = rig_create(&t);
    const unsigned plain_width = r.layout.width;
    add_box(&r, asdic_material_facet(45.0, 1e-4, 0.1));
    r.sonar.receiver_count = beams;
    r.sampling.rays = 40000;
    asdic_ping *plain = rig_shoot(&r, 7, true);
    assert_true(asdic_level_db(plain->intensity_lin[ASDIC_OBJECT][70]) > -80.0);
    assert_true(plain->intensity_lin[ASDIC_MULTIPATH][75] > 0.0);
    bool has_int64 = asdic_device_get_info(t.device)->has_int64_atomics;
    static const asdic_layout others[] = {
        {.deposit = ASDIC_DEPOSIT_COLLECT, .local = 1, .batch_slots = 16384},
        {.deposit = ASDIC_DEPOSIT_COLLECT, .local = 8, .batch_slots = 1 << 20, .workers = 1},
        {.deposit = ASDIC_DEPOSIT_COLLECT,
         .local = 8,
         .batch_slots = 1 << 20,
         .workers = 3,
         .threads = 4,
         .thread_cells = 1},
        {.deposit = ASDIC_DEPOSIT_COLLECT, .local = 64, .batch_slots = 20000, .workers = 3},
        {.deposit = ASDIC_DEPOSIT_COLLECT, .local = 4096, .batch_slots = 1 << 20},
        {.deposit = ASDIC_DEPOSIT_ATOMIC32, .local = 4096, .batch_slots = 20000},
        {.deposit = ASDIC_DEPOSIT_ATOMIC32, .local = 8, .batch_slots = 1 << 20},
        {.deposit = ASDIC_DEPOSIT_ATOMIC64, .local = 64, .batch_slots = 32768},
    };
    for (size_t k = 0; k < sizeof others / sizeof *others; k++) {
        if (others[k].deposit == ASDIC_DEPOSIT_ATOMIC64 && !has_int64) {
            continue;
        }
        r.layout = others[k];
        r.layout.width = plain_width;
        asdic_ping *other = rig_shoot(&r, 7, true);
        assert_true(rig_same(plain, other));
        asdic_ping_destroy(&other);
    }
    asdic_ping_destroy(&plain);
    rig_destroy(&r);
}

/* Each of these numbers of beams is added to in a way of its own (collect.cl). */
static void layout_never_changes_a_byte(void **state) {
    (void)state;
    static const size_t beams[] = {1, RIG_BEAMS, RIG_MOST_BEAMS};
    for (size_t k = 0; k < sizeof beams / sizeof *beams; k++) {
        layout_never_changes_a_byte_of(beams[k]);
    }
}

/* How many deposits a ping of R cuts where those of the components in LIFTED are 2^40 times what there is room for. */
static uint64_t cut_of(ping_rig *r, unsigned lifted) {
    asdic_simulator *sim = rig_simulator(r);
    asdic_ping *ping = NULL;
    for (unsigned c = 0; c < DEV_DEPOSIT_COUNT; c++) {
        sim->setup.ping.sums.scale[c] *= lifted >> c & 1u ? 0x1p40f : 1.0f;
    }
    assert_ok(t.ctx, asdic_ping_create(t.ctx, r->sonar.receiver_count,
                                       asdic_simulator_bin_count(sim), &ping));
    assert_ok(t.ctx, asdic_simulator_ping(sim, &r->pose, 7, ping));
    uint64_t cut = ping->saturated;
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    return cut;
}

/* Each deposit that is too large is counted once, of whichever component and however it is added. */
static void what_is_cut_is_counted(void **state) {
    static const int ways[] = {ASDIC_DEPOSIT_COLLECT, ASDIC_DEPOSIT_ATOMIC32,
                               ASDIC_DEPOSIT_ATOMIC64};
    static const size_t beams[] = {1, RIG_BEAMS, RIG_MOST_BEAMS, 1};
    enum { LAYERS = 3 }; /* the last of them, through layers of water */
    enum { RAYS = 2048, EVERY = (1 << DEV_DEPOSIT_COUNT) - 1 };
    (void)state;
    bool has_int64 = asdic_device_get_info(t.device)->has_int64_atomics;
    for (size_t k = 0; k <= LAYERS; k++) {
        ping_rig r = rig_create(&t);
        add_box(&r, asdic_material_facet(45.0, 1e-4, 0.1));
        r.sonar.receiver_count = beams[k];
        r.sampling.rays = RAYS;
        if (k == LAYERS) {
            r.env.sound_speed_profile =
                (asdic_sound_profile){3, {0.0, 6.0, 12.0}, {1500.0, 1502.0, 1495.0}};
        }
        uint64_t first[DEV_DEPOSIT_COUNT];
        for (size_t way = 0; way < (has_int64 && k < LAYERS ? 3 : 2); way++) {
            uint64_t sum = 0;
            r.layout.deposit = ways[way];
            assert_int_equal(cut_of(&r, 0), 0);
            for (unsigned c = 0; c < DEV_DEPOSIT_COUNT; c++) {
                uint64_t cut = cut_of(&r, 1u << c);
                first[c] = way == 0 ? cut : first[c];
                sum += cut;
                assert_in_range(cut, 1, 8 * RAYS * beams[k]);
                assert_int_equal(cut, first[c]);
            }
            assert_int_equal(cut_of(&r, EVERY), sum);
            print_message("%zu beams, way %zu: %llu cut\n", beams[k], way, (unsigned long long)sum);
        }
        rig_destroy(&r);
    }
}

/* The width is fixed per kind of device; across widths only the last bits of functions differ. */
static void widths_agree(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    add_box(&r, asdic_material_bottom(2.0));
    r.sampling.rays = 4096;
    r.layout.width = 8;
    asdic_ping *plain = rig_shoot(&r, 3, false);
    static const unsigned widths[] = {1, 16};
    for (int k = 0; k < 2; k++) {
        r.layout.width = widths[k];
        asdic_ping *other = rig_shoot(&r, 3, false);
        double most = 0.0;
        for (size_t i = 0; i < plain->beams * plain->bins; i++) {
            double a = plain->intensity_lin[ASDIC_TOTAL][i];
            double b = other->intensity_lin[ASDIC_TOTAL][i];
            if (a > 0.0) {
                most = fmax(most, fabs(asdic_level_db(b) - asdic_level_db(a)));
            }
        }
        print_message("width %u against 8: %.2g dB at most\n", widths[k], most);
        assert_true(most < 1e-3);
        asdic_ping_destroy(&other);
    }
    asdic_ping_destroy(&plain);
    rig_destroy(&r);
}

static void pings_depend_on_seed_and_index_alone(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    r.sampling.rays = 1024;
    asdic_ping *a = rig_shoot(&r, 5, false), *b = rig_shoot(&r, 5, false);
    asdic_ping *c = rig_shoot(&r, 6, false);
    r.sampling.seed = 2;
    asdic_ping *d = rig_shoot(&r, 5, false);
    assert_true(rig_same(a, b));
    assert_false(rig_same(a, c));
    assert_false(rig_same(a, d));
    asdic_ping_destroy(&a);
    asdic_ping_destroy(&b);
    asdic_ping_destroy(&c);
    asdic_ping_destroy(&d);
    rig_destroy(&r);
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(layout_never_changes_a_byte),
        cmocka_unit_test(what_is_cut_is_counted),
        cmocka_unit_test(widths_agree),
        cmocka_unit_test(pings_depend_on_seed_and_index_alone),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
