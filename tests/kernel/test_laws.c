/*
 * A law's table on the device and its function on the host meet within 1e-3 dB, from 1e-6 rad to 90
 * degrees: for every law there is, and for functions worse than any law. 77 without a device.
 */
#include "ping_rig.h"

#include "base/vec.h"
#include "scene/scene.h"
#include "sim/model_law.h"

#include <math.h>
#include <stdlib.h>

#define ANGLES 60000
/* -300 dB: less is not told apart. */
#define SILENCE 1e-30

static test_device place;

/* Angles in equal ratios from both ends, and evenly between. */
static double angle(size_t i) {
    double u = (double)(i / 3) / (ANGLES / 3 - 1);
    double small = 1e-6 * pow(0.25 * ASDIC_PI / 1e-6, u);
    return i % 3 == 0 ? small : i % 3 == 1 ? 0.5 * ASDIC_PI - small * small : 1e-6 + u * 1.570795;
}

/* What a law of a file is tried with: angles and levels, with a peak at normal incidence. */
static const double measured[] = {0.5, -48, 5, -40, 10, -29, 30, -22.5, 88, -12, 88.5, -3, 90, -1};

typedef struct compared {
    asdic_law_function *function;
    const void *of;
} compared;

/* Largest deviation in dB of the table AT from what it is made of. */
static double deviation(const compared *c, const asdic_law_words *tables, dev_uint at,
                        unsigned width) {
    double *rad = malloc(2 * ANGLES * sizeof *rad), *lin = rad + ANGLES, most = 0.0;
    assert_non_null(rad);
    for (size_t i = 0; i < ANGLES; i++) {
        rad[i] = fmin(angle(i), 0.5 * ASDIC_PI);
    }
    assert_ok(place.ctx, asdic_law_table_read(place.device, tables, at, width, rad, ANGLES, lin));
    for (size_t i = 0; i < ANGLES; i++) {
        double cosine = sin(0.5 * ASDIC_PI - rad[i]);
        double right = c->function(c->of, sin(rad[i]), cosine * cosine);
        double off = fabs(10.0 * log10(fmax(lin[i], SILENCE) / fmax(right, SILENCE)));
        most = off > most || isnan(off) ? off : most;
    }
    free(rad);
    return most;
}

static void compare(const char *name, const compared *c, const double *knots_deg, size_t knots) {
    static const unsigned widths[] = {1, 8, 16};
    asdic_law_words tables = {0};
    dev_uint at = 0;
    /* Not at word 0, which means none. */
    assert_ok(place.ctx, asdic_law_table_add(place.ctx, c->function, c->of, NULL, 0, &tables, &at));
    assert_ok(place.ctx,
              asdic_law_table_add(place.ctx, c->function, c->of, knots_deg, knots, &tables, &at));
    for (size_t w = 0; w < 3; w++) {
        double off = deviation(c, &tables, at, widths[w]);
        print_message("%-28s width %-2u %.2e dB, %zu kB\n", name, widths[w], off,
                      tables.count / 2 * sizeof(uint32_t) / 1024);
        assert_true(off <= 1e-3);
    }
    free(tables.words);
}

/* --- every law --------------------------------------------------------------------------------- */

static double of_law(const void *of, double sine, double cos2) {
    const asdic_scatterer *s = of;
    asdic_incidence at = asdic_incidence_on_plane(sine, cos2);
    return s->material.law->strength_lin(s, &at);
}

static double of_mirror(const void *of, double sine, double cos2) {
    const asdic_scatterer *s = of;
    (void)cos2;
    return s->material.law->reflected(s, sine);
}

/* The device's formulas are tabulated, too: as functions they are as good as any. */
static void every_law_is_met(void **state) {
    (void)state;
    for (size_t i = 0; i < asdic_law_count(); i++) {
        asdic_material material = asdic_material_of(asdic_law_get(i));
        material.rows = measured;
        material.row_count = sizeof measured / sizeof *measured / 2;
        for (int f = 0; f < 3; f++) {
            asdic_law_water water = {.frequency_hz = 1e4 * pow(10.0, f),
                                     .sound_speed_mps = 1500.0,
                                     .wavelength_m = 0.15 * pow(0.1, f),
                                     .wind_speed_kn = 15.0 * f};
            asdic_scatterer s = asdic_scatterer_at(&material, &water);
            asdic_law_words tables = {0};
            assert_ok(place.ctx, asdic_law_tables_add(place.ctx, &s, &tables));
            compared strength = {of_law, &s}, mirror = {of_mirror, &s};
            double off = deviation(&strength, &tables, s.device.strength, 8);
            double mirrored =
                s.device.reflected ? deviation(&mirror, &tables, s.device.reflected, 8) : 0.0;
            print_message("%-16s %4.0f kHz: strength %.2e dB, reflected %.2e dB, %zu kB\n",
                          material.law->name, water.frequency_hz / 1e3, off, mirrored,
                          tables.count * sizeof(uint32_t) / 1024);
            assert_true(off <= 1e-3);
            assert_true(mirrored <= 1e-3);
            free(tables.words);
        }
    }
}

/* --- APL-UW's laws over their whole domain ------------------------------------------------------ */

/* The table of S and that of its mirror; both within 1e-3 dB of what they are made of, and finite. */
static double domain_deviation(asdic_scatterer *s) {
    asdic_law_words tables = {0};
    assert_ok(place.ctx, asdic_law_tables_add(place.ctx, s, &tables));
    compared strength = {of_law, s}, mirror = {of_mirror, s};
    double off = deviation(&strength, &tables, s->device.strength, 8);
    double mirrored = deviation(&mirror, &tables, s->device.reflected, 8);
    for (size_t i = 0; i <= 900; i++) {
        double rad = 0.1 * (double)i * (ASDIC_PI / 180.0), cosine = sin(0.5 * ASDIC_PI - rad);
        double lin = of_law(s, sin(rad), cosine * cosine), share = of_mirror(s, sin(rad), 0.0);
        assert_true(isfinite(log10(lin)) && isfinite(share) && share >= 0.0 && share <= 1.0);
    }
    free(tables.words);
    return isnan(mirrored) ? mirrored : fmax(off, mirrored);
}

static void apl_laws_are_met_over_their_domain(void **state) {
    (void)state;
    double most[2] = {0.0, 0.0};
    asdic_material bottom = asdic_material_of(asdic_law_find("apl-bottom"));
    asdic_material surface = asdic_material_of(asdic_law_find("apl-surface"));
    for (int f = 0; f <= 3; f++) {
        asdic_law_water water = {.frequency_hz = 1e3 * pow(10.0, f),
                                 .sound_speed_mps = 1500.0,
                                 .wavelength_m = 1.5 * pow(0.1, f)};
        for (int i = -3; i <= 10; i++) { /* three stones, then -1 to 9 phi */
            asdic_material_set(place.ctx, &bottom, "sediment", i < 0 ? i + 4 : NAN);
            asdic_material_set(place.ctx, &bottom, "grain_size_phi", i < 0 ? NAN : i - 1.0);
            asdic_scatterer s = asdic_scatterer_at(&bottom, &water);
            double off = domain_deviation(&s);
            most[0] = off > most[0] || isnan(off) ? off : most[0];
        }
        for (int u = 0; u <= 30; u += 5) {
            water.wind_speed_kn = u * 3600.0 / 1852.0;
            asdic_scatterer s = asdic_scatterer_at(&surface, &water);
            double off = domain_deviation(&s);
            most[1] = off > most[1] || isnan(off) ? off : most[1];
        }
    }
    print_message("apl-bottom %.2e dB, apl-surface %.2e dB\n", most[0], most[1]);
    assert_true(most[0] <= 1e-3);
    assert_true(most[1] <= 1e-3);
}

/* The strength of grain sizes just below and above PHI, dB apart, at most over all angles. */
static double step_db(double phi, double f_hz) {
    asdic_law_water water = {
        .frequency_hz = f_hz, .sound_speed_mps = 1500.0, .wavelength_m = 1500.0 / f_hz};
    asdic_material below = asdic_material_of(asdic_law_find("apl-bottom")), above = below;
    double most = 0.0;
    asdic_material_set(place.ctx, &below, "grain_size_phi", phi - 1e-6);
    asdic_material_set(place.ctx, &above, "grain_size_phi", phi + 1e-6);
    asdic_scatterer a = asdic_scatterer_at(&below, &water), b = asdic_scatterer_at(&above, &water);
    for (int i = 0; i <= 900; i++) {
        double sine = sin(0.1 * i * (ASDIC_PI / 180.0));
        double off = asdic_scatterer_strength(&b, sine) / asdic_scatterer_strength(&a, sine);
        most = fmax(most, fabs(10.0 * log10(off)));
    }
    return most;
}

/* Grain sizes make no leap but those that the handbook's fits make: small at 1 and 5.3 phi, and that of
 * the volume by a factor of 2 at 5.5. */
static void grain_sizes_step_where_the_handbook_does(void **state) {
    (void)state;
    for (double f_hz = 1e4; f_hz < 2e5; f_hz *= 10.0) {
        double most = 0.0;
        for (double phi = -0.9; phi < 8.95; phi += 0.1) {
            bool is_fit =
                fabs(phi - 1.0) < 0.01 || fabs(phi - 5.3) < 0.01 || fabs(phi - 5.5) < 0.01;
            double step = step_db(is_fit ? phi + 0.02 : phi, f_hz);
            most = fmax(most, step);
        }
        print_message("steps at 1, 5.3, 5.5 phi: %.3f, %.3f, %.3f dB, elsewhere %.3f\n",
                      step_db(1.0, f_hz), step_db(5.3, f_hz), step_db(5.5, f_hz), most);
        assert_true(most < 0.05);
        assert_true(step_db(1.0, f_hz) < 0.5 && step_db(5.3, f_hz) < 0.5);
        assert_true(step_db(5.5, f_hz) < 3.0103 && step_db(5.5, f_hz) > 2.5);
    }
}

/* --- nasty functions ---------------------------------------------------------------------------- */

/* A lobe of 10 m2 that reflects in phase, at 1 MHz and 10 m: 1e-5 wide in the squared cosine. */
static double needle(const void *of, double sine, double cos2) {
    (void)of;
    return 3e4 * exp(-cos2 / 1e-5) + 1e-4 * sine;
}

/* 40 dB up and down again within half a degree. */
static double spike(const void *of, double sine, double cos2) {
    (void)of;
    double deg = atan2(sine, sqrt(cos2)) * (180.0 / ASDIC_PI);
    return 1e-4 * pow(10.0, 4.0 * fmax(1.0 - fabs(deg - 30.0) / 0.25, 0.0));
}

/* Lines between levels, every degree another one. */
static double saw(const void *of, double sine, double cos2) {
    (void)of;
    double deg = atan2(sine, sqrt(cos2)) * (180.0 / ASDIC_PI), whole = floor(deg);
    double up = fmod(whole, 2.0) == 0.0 ? deg - whole : 1.0 - (deg - whole);
    return pow(10.0, -3.0 + 0.4 * up);
}

/* The fourth power of the tangent: from -240 dB to more than any float of it squared. */
static double steep(const void *of, double sine, double cos2) {
    (void)of;
    return fmin(1e-3 * pow(sine, 4.0) / fmax(cos2 * cos2, 1e-30), 1e3);
}

/* Lobes of a third of a degree, as of a corrugated plate; with more, the rounding of the angle to single
 * precision alone is 1e-3 dB in the troughs. */
static double ripples(const void *of, double sine, double cos2) {
    (void)of;
    return 1e-2 * sine * (1.1 + cos(2.0 * ASDIC_PI * 200.0 * sqrt(cos2)));
}

/* A critical angle without losses: a root's infinite slope. */
static double critical(const void *of, double sine, double cos2) {
    (void)of;
    double n2 = 0.83 * 0.83, root = sqrt(fmax(n2 - cos2, 0.0));
    double r = (1.9 * sine - root) / (1.9 * sine + root);
    return n2 < cos2 ? 1.0 : r * r + 1e-12;
}

static void functions_worse_than_laws_are_met(void **state) {
    (void)state;
    static const double spike_deg[] = {29.75, 30.0, 30.25};
    const compared functions[] = {{needle, NULL}, {steep, NULL},    {ripples, NULL},
                                  {saw, NULL},    {critical, NULL}, {spike, NULL}};
    static const char *const names[] = {"needle", "steep", "ripples", "saw", "critical", "spike"};
    for (size_t i = 0; i < 6; i++) {
        bool has_knots = functions[i].function == spike;
        compare(names[i], &functions[i], spike_deg, has_knots ? 3 : 0);
    }
}

/* What no float can hold stays finite: nothing, and everything. */
static double nothing(const void *of, double sine, double cos2) {
    (void)of;
    return sine > 0.1 ? 0.0 : cos2 * NAN;
}

static void nothing_is_no_sound(void **state) {
    (void)state;
    asdic_law_words tables = {0};
    dev_uint at = 0;
    double rad[] = {1e-6, 0.05, 0.5, 1.5, 0.5 * ASDIC_PI, 0.0}, lin[6];
    assert_ok(place.ctx, asdic_law_table_add(place.ctx, nothing, NULL, NULL, 0, &tables, &at));
    assert_ok(place.ctx, asdic_law_table_add(place.ctx, nothing, NULL, NULL, 0, &tables, &at));
    assert_ok(place.ctx, asdic_law_table_read(place.device, &tables, at, 8, rad, 6, lin));
    for (size_t i = 0; i < 6; i++) {
        assert_true(lin[i] >= 0.0 && lin[i] < 1e-30);
    }
    assert_ok(place.ctx, asdic_law_table_read(place.device, &tables, 0, 8, rad, 6, lin));
    for (size_t i = 0; i < 6; i++) {
        assert_true(lin[i] == 0.0);
    }
    free(tables.words);
}

/* --- pings --------------------------------------------------------------------------------------- */

/* Sand, the course's surface and a box of rock, by the device's formulas or by tables of them. */
static asdic_ping *shoot(asdic_law laws[2], unsigned multipath, unsigned left_out) {
    ping_rig r = rig_create(&place);
    asdic_mesh *box = NULL;
    asdic_pose pose = {.position_m = {20.0, 0.0, 10.0}};
    asdic_material bottom = asdic_material_bottom(2.0), rock = asdic_material_bottom(4.0);
    asdic_material surface = asdic_material_of(&laws[1]);
    bottom.law = rock.law = &laws[0];
    rig_empty(&r);
    assert_ok(place.ctx, asdic_scene_set_bottom_plane(r.scene, 12.0, bottom));
    assert_ok(place.ctx, asdic_scene_set_surface_law(r.scene, surface));
    assert_ok(place.ctx, asdic_mesh_box(place.ctx, (asdic_vec3){2.0, 4.0, 2.0}, &box));
    assert_ok(place.ctx, asdic_scene_add_object(r.scene, "rock", box, pose, rock));
    r.sampling.multipath = (asdic_multipath)multipath;
    r.sampling.left_out = left_out;
    asdic_ping *ping = rig_shoot(&r, 0, false);
    asdic_mesh_destroy(&box);
    rig_destroy(&r);
    return ping;
}

/* Bins with a ten-thousandth of a component's loudest count: quanta differ with the laws' largest
 * values. */
static double largest_difference(const asdic_ping *a, const asdic_ping *b) {
    double most = 0.0;
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        double loudest = 0.0;
        for (size_t i = 0; i < a->beams * a->bins; i++) {
            loudest = fmax(loudest, a->intensity_lin[c][i]);
        }
        for (size_t i = 0; i < a->beams * a->bins; i++) {
            double x = a->intensity_lin[c][i], y = b->intensity_lin[c][i];
            bool counts = loudest > 0.0 && x > 1e-4 * loudest;
            most = counts ? fmax(most, fabs(10.0 * log10(y / x))) : most;
        }
    }
    return most;
}

static void pings_by_tables_are_pings_by_formulas(void **state) {
    (void)state;
    asdic_law formulas[2] = {*asdic_law_find("searay"), *asdic_law_find("course")};
    asdic_law tables[2] = {formulas[0], formulas[1]};
    tables[0].formula = tables[1].formula = DEV_LAW_TABLE;
    for (unsigned m = ASDIC_MULTIPATH_OFF; m <= ASDIC_MULTIPATH_BOUNDARIES; m++) {
        asdic_ping *right = shoot(formulas, m, 0), *ping = shoot(tables, m, 0);
        double off = largest_difference(right, ping);
        print_message("multipath %u: %.2e dB\n", m, off);
        assert_true(off <= 1e-3);
        asdic_ping_destroy(&right);
        asdic_ping_destroy(&ping);
    }
}

/* A surface that a plan left out is silent and still a mirror. */
static void what_is_left_out_reflects(void **state) {
    (void)state;
    asdic_law formulas[2] = {*asdic_law_find("searay"), *asdic_law_find("course")};
    asdic_law tables[2] = {formulas[0], formulas[1]};
    tables[0].formula = tables[1].formula = DEV_LAW_TABLE;
    unsigned out = 1u << ASDIC_TERM_SURFACE;
    asdic_ping *right = shoot(formulas, ASDIC_MULTIPATH_BOUNDARIES, out);
    asdic_ping *ping = shoot(tables, ASDIC_MULTIPATH_BOUNDARIES, out);
    double multipath = 0.0;
    for (size_t i = 0; i < ping->beams * ping->bins; i++) {
        assert_true(ping->intensity_lin[ASDIC_SURFACE][i] == 0.0);
        multipath += ping->intensity_lin[ASDIC_MULTIPATH][i];
    }
    assert_true(multipath > 0.0);
    assert_true(largest_difference(right, ping) <= 1e-3);
    asdic_ping_destroy(&right);
    asdic_ping_destroy(&ping);
}

/* The expectation of a bottom, by quadrature of the law itself, and its ping agree within five stated
 * errors, for every law of a bottom that the device has as a table. */
static void pings_meet_their_expectation(void **state) {
    (void)state;
    for (size_t l = 0; l < asdic_law_count(); l++) {
        const asdic_law *law = asdic_law_get(l);
        if (law->formula != DEV_LAW_TABLE || !(law->uses & ASDIC_LAW_BOTTOM)) {
            continue;
        }
        ping_rig r = rig_create(&place);
        asdic_material material = asdic_material_of(law);
        material.rows = measured;
        material.row_count = sizeof measured / sizeof *measured / 2;
        asdic_scene_set_bottom(r.scene, &material);
        asdic_flat_scene flat = {.has_surface = true,
                                 .has_bottom = true,
                                 .altitude_m = 5.0,
                                 .depth_m = 7.0,
                                 .bottom = material};
        asdic_ping *ping = rig_shoot(&r, 0, true), *truth = NULL;
        double most_db = 0.0;
        assert_ok(place.ctx, asdic_ping_create(place.ctx, RIG_BEAMS, ping->bins, &truth));
        assert_ok(place.ctx,
                  asdic_expected_compute(place.ctx, &flat, &r.env, &r.sonar, &r.pose, truth));
        for (size_t i = 20; i < ping->bins; i++) { /* the forward beam, beyond the nadir */
            double off = 10.0 * log10(ping->intensity_lin[ASDIC_BOTTOM][i] /
                                      truth->intensity_lin[ASDIC_BOTTOM][i]);
            most_db = fmax(most_db, fabs(off));
        }
        print_message("%s: %.3f dB from its expectation\n", law->name, most_db);
        assert_true(most_db < 0.5);
        asdic_ping_destroy(&truth);
        asdic_ping_destroy(&ping);
        rig_destroy(&r);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_law_is_met),
        cmocka_unit_test(apl_laws_are_met_over_their_domain),
        cmocka_unit_test(grain_sizes_step_where_the_handbook_does),
        cmocka_unit_test(functions_worse_than_laws_are_met),
        cmocka_unit_test(nothing_is_no_sound),
        cmocka_unit_test(pings_by_tables_are_pings_by_formulas),
        cmocka_unit_test(what_is_left_out_reflects),
        cmocka_unit_test(pings_meet_their_expectation),
    };
    place = test_device_open_or_skip();
    return test_device_end(&place, cmocka_run_group_tests(tests, NULL, NULL));
}
