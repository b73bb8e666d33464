/* The honest clock: rays fall to the floor, then time is stretched, and rays come back. */
#include "asserts.h"

#include "live/governor.h"

#define PERIOD_S 0.1

/* A machine that takes FIXED_S and so much per ray; returns the rays after COUNT steps. */
static uint32_t run(asdic_governor *g, double fixed_s, double per_ray_s, size_t count) {
    for (size_t i = 0; i < count; i++) {
        double busy_s = fixed_s + per_ray_s * asdic_governor_rays(g);
        asdic_governor_note(g, busy_s, busy_s > PERIOD_S ? busy_s : PERIOD_S);
    }
    return asdic_governor_rays(g);
}

static void a_fast_machine_keeps_its_rays(void **state) {
    (void)state;
    asdic_governor g;
    asdic_governor_init(&g, PERIOD_S, 20000, 2000, true);
    assert_int_equal(run(&g, 0.02, 2e-6, 500), 20000);
    assert_true(asdic_governor_stretch(&g) == 1.0);
}

static void rays_fall_before_time_is_stretched(void **state) {
    (void)state;
    asdic_governor g;
    asdic_governor_init(&g, PERIOD_S, 20000, 2000, true);
    uint32_t rays = run(&g, 0.03, 8e-6, 600); /* 0.19 s with all of them */
    assert_in_range(rays, 2001, 8749);        /* 8750 take the whole period */
    assert_true(0.03 + 8e-6 * rays > 0.5 * PERIOD_S);
    assert_true(asdic_governor_stretch(&g) == 1.0);
    /* Steady: it does not swing between two numbers. */
    assert_int_equal(run(&g, 0.03, 8e-6, 200), rays);
}

static void at_the_floor_time_is_stretched(void **state) {
    (void)state;
    asdic_governor g;
    asdic_governor_init(&g, PERIOD_S, 20000, 2000, true);
    assert_int_equal(run(&g, 0.1, 5e-5, 400), 2000); /* 0.2 s at the floor */
    assert_close(asdic_governor_stretch(&g), 2.0, 0.01);
    assert_int_equal(run(&g, 0.01, 1e-6, 1000), 20000); /* the others have gone home */
    assert_true(asdic_governor_stretch(&g) == 1.0);
}

/* A machine late by far is not watched for three seconds of pings. */
static void a_hopeless_start_is_noticed_soon(void **state) {
    (void)state;
    asdic_governor g;
    asdic_governor_init(&g, PERIOD_S, 100000, 1000, true);
    assert_true(run(&g, 0.0, 1e-5, 8) < 100000);
}

static void without_a_clock_nothing_changes(void **state) {
    (void)state;
    asdic_governor g;
    asdic_governor_init(&g, PERIOD_S, 20000, 2000, false);
    assert_int_equal(run(&g, 0.5, 1e-4, 200), 20000);
    asdic_governor_want(&g, 1000);
    assert_int_equal(asdic_governor_rays(&g), 1000);
}

/* Who asks for fewer rays than the floor has them; who asks for more again has the floor again. */
static void the_floor_outlasts_a_wish_below_it(void **state) {
    (void)state;
    asdic_governor g;
    asdic_governor_init(&g, PERIOD_S, 20000, 2000, true);
    asdic_governor_want(&g, 1000);
    assert_int_equal(run(&g, 0.1, 5e-5, 100), 1000);
    asdic_governor_want(&g, 20000);
    assert_int_equal(run(&g, 0.1, 5e-5, 400), 2000);
}

/* 512 beams keep 80 rays each: time is stretched before the picture breaks into dashes. */
static void the_floor_follows_the_beams(void **state) {
    (void)state;
    asdic_governor g;
    assert_int_equal(asdic_governor_floor(1), 2000);
    assert_int_equal(asdic_governor_floor(512), 40960);
    asdic_governor_init(&g, PERIOD_S, 200000, asdic_governor_floor(512), true);
    assert_int_equal(run(&g, 0.05, 1e-5, 600), 40960);
    assert_true(asdic_governor_stretch(&g) > 2.0);
}

/* Slower and slower machines: first rays fall, with them the bins that are shown, and time is
 * stretched last. Rays for each beam and bin that is shown stay. */
static void bins_are_joined_before_time_is_stretched(void **state) {
    (void)state;
    enum { BEAMS = 512, BINS = 496 };
    static const double per_ray_s[] = {3e-7, 6e-7, 1.2e-6, 4e-6};
    size_t before = 1;
    for (size_t i = 0; i < sizeof per_ray_s / sizeof *per_ray_s; i++) {
        asdic_governor g;
        asdic_governor_init(&g, PERIOD_S, 200000, asdic_governor_floor(BEAMS), true);
        uint32_t rays = run(&g, 0.01, per_ray_s[i], 600);
        size_t joined = asdic_governor_joined(rays, BEAMS, BINS);
        double shown = (double)BEAMS * BINS / (double)joined;
        print_message(
            "%.1g s a ray: %u rays, bins joined %zu, %.2f rays a beam and bin, time x %.2f\n",
            per_ray_s[i], rays, joined, rays / shown, asdic_governor_stretch(&g));
        assert_true(rays / shown > 0.6);
        assert_true(joined >= before && joined <= 4);
        assert_true(asdic_governor_stretch(&g) == 1.0 || rays == asdic_governor_floor(BEAMS));
        assert_true((joined == 1) == (i == 0));
        before = joined;
    }
    assert_int_equal(before, 4); /* 124 bins of 496 */
    assert_int_equal(asdic_governor_joined(100, BEAMS, 149), 1);
    assert_int_equal(asdic_governor_joined(asdic_governor_enough(BEAMS, BINS), BEAMS, BINS), 1);
}

/* A floor above what is wanted is no floor. */
static void the_user_decides(void **state) {
    (void)state;
    asdic_governor g;
    asdic_governor_init(&g, PERIOD_S, 1000, 2000, true);
    assert_int_equal(run(&g, 0.2, 1e-6, 100), 1000);
}

/* COUNT pings that each take SHARE of the period; at which of them the rays change, and to how many. 0: at none. */
static size_t changes_at(double share, uint32_t rays, size_t count, uint32_t *then) {
    asdic_governor g;
    asdic_governor_init(&g, PERIOD_S, 100000, 1000, true);
    g.rays = rays;
    for (size_t i = 1; i <= count; i++) {
        bool changed = asdic_governor_note(&g, share * PERIOD_S, PERIOD_S);
        *then = asdic_governor_rays(&g);
        assert_int_equal(changed, *then != rays);
        if (changed) {
            return i;
        }
    }
    return 0;
}

/* A mission learns every 32 pings; above 95 % rays fall to what takes 80 %, below 50 % they rise, by half at most. */
static void shares_of_a_block_decide(void **state) {
    (void)state;
    static const struct {
        double share;
        uint32_t rays;
        size_t ping;
        uint32_t then;
    } cases[] = {{0.94, 50000, 0, 50000},  {0.96, 50000, 32, 41666},  {0.51, 50000, 0, 50000},
                 {0.49, 50000, 32, 75000}, {0.49, 100000, 0, 100000}, {0.49, 90000, 32, 100000},
                 {1.49, 50000, 32, 26845}, {1.51, 50000, 6, 26490},   {9.00, 50000, 6, 20000},
                 {9.00, 2000, 6, 1000},    {9.00, 1000, 0, 1000}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        uint32_t then = 0;
        assert_int_equal(changes_at(cases[n].share, cases[n].rays, 96, &then), cases[n].ping);
        assert_int_equal(then, cases[n].then);
    }
}

/* Time that passes by a thirtieth too slowly is real time; before the first ping there is none to judge by. */
static void time_is_real_within_3_percent(void **state) {
    (void)state;
    static const double slow[] = {1.0, 1.029, 1.031, 1.5, 0.5};
    for (size_t n = 0; n < sizeof slow / sizeof *slow; n++) {
        asdic_governor g;
        asdic_governor_init(&g, PERIOD_S, 1000, 1000, true);
        assert_true(asdic_governor_stretch(&g) == 1.0);
        asdic_governor_note(&g, 0.0, 0.0); /* after a pause */
        assert_true(asdic_governor_stretch(&g) == 1.0);
        asdic_governor_note(&g, 0.0, 2.0 * PERIOD_S); /* a tenth of what is new */
        assert_close(asdic_governor_stretch(&g), 1.1, 1e-12);
        for (int k = 0; k < 200; k++) {
            asdic_governor_note(&g, 0.0, slow[n] * PERIOD_S);
        }
        bool is_real = n < 2;
        assert_close(asdic_governor_stretch(&g), is_real ? 1.0 : slow[n], is_real ? 0.0 : 1e-8);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_fast_machine_keeps_its_rays),
        cmocka_unit_test(rays_fall_before_time_is_stretched),
        cmocka_unit_test(at_the_floor_time_is_stretched),
        cmocka_unit_test(a_hopeless_start_is_noticed_soon),
        cmocka_unit_test(without_a_clock_nothing_changes),
        cmocka_unit_test(the_floor_outlasts_a_wish_below_it),
        cmocka_unit_test(the_floor_follows_the_beams),
        cmocka_unit_test(bins_are_joined_before_time_is_stretched),
        cmocka_unit_test(the_user_decides),
        cmocka_unit_test(shares_of_a_block_decide),
        cmocka_unit_test(time_is_real_within_3_percent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
