/*
 * The note below a run's pictures says how rough they are, where that is more than one may overlook.
 */
#include "asserts.h"

#include "mission/run/run_picture.h"
#include "out/draw.h"

#include <math.h>
#include <string.h>

static void describe(double rms_db, asdic_render *r) {
    static asdic_run run;
    static asdic_summary summary;
    static asdic_sonar sonar;
    sonar = asdic_sonar_default();
    run.facts.version = "1";
    summary.statistics.errors.rms_db = rms_db;
    *r = (asdic_render){.run = &run, .summary = &summary, .info.sonar = &sonar};
    r->info.sampling = asdic_sampling_default();
    asdic_render_describe(r);
}

static void rough_pictures_say_so(void **state) {
    (void)state;
    asdic_render r;
    describe(2.71, &r);
    assert_contains(r.note, "20,000 rays a ping");
    assert_contains(r.note, "stated error 2.7 dB r.m.s.");
    assert_true(strlen(r.note) + 1 < sizeof r.note);
}

static void fine_ones_say_nothing(void **state) {
    (void)state;
    const double fine_db[] = {0.0, 0.5, 1.0, NAN};
    for (size_t i = 0; i < sizeof fine_db / sizeof *fine_db; i++) {
        asdic_render r;
        describe(fine_db[i], &r);
        assert_null(strstr(r.note, "stated"));
    }
}

/* No rays make a coherent ping, but scatterers. */
static void coherent_pings_are_said_to_be(void **state) {
    (void)state;
    asdic_render r;
    describe(NAN, &r);
    r.info.sampling.coherent = true;
    asdic_render_describe(&r);
    assert_contains(r.note, "coherent, about 20,000 scatterers a ping, seed 1");
    assert_null(strstr(r.note, "sampling"));
}

static void ascopes_tell_which_curves_are_simulated(void **state) {
    (void)state;
    static const struct {
        bool object, multipath;
        const char *parts;
    } cases[] = {{false, false, "by quadrature"},
                 {true, false, "by quadrature; object: simulated"},
                 {false, true, "by quadrature; multipath: simulated"},
                 {true, true, "by quadrature; object, multipath: simulated"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        asdic_render r;
        char note[ASDIC_ASCOPE_NOTE_SIZE];
        describe(NAN, &r);
        asdic_summary summary = *r.summary;
        asdic_run run = *r.run;
        run.facts.bottom = i % 2 ? ASDIC_RUN_BOTTOM_NONE : ASDIC_RUN_BOTTOM_PLANE;
        r.run = &run;
        summary.statistics.has[ASDIC_OBJECT] = cases[i].object;
        summary.statistics.has[ASDIC_MULTIPATH] = cases[i].multipath;
        r.summary = &summary;
        asdic_render_note_ascope(&r, true, note);
        assert_memory_equal(note, r.note, strlen(r.note));
        size_t end = strlen(note) - strlen(cases[i].parts);
        assert_string_equal(note + end, cases[i].parts);
        assert_contains(note, i % 2 ? "expected: no bottom, no" : "expected: flat bottom, no");
        asdic_render_note_ascope(&r, false, note);
        assert_contains(note, "all curves are simulated");
        assert_null(strstr(note, "by quadrature"));
    }
}

static void plans_tell_what_bottom_they_show(void **state) {
    (void)state;
    static const struct {
        const char *bottom;
        size_t columns;
        double depth_m;
        const char *said;
    } cases[] = {{ASDIC_RUN_BOTTOM_MESH, 3, INFINITY, "relief lit from the north-west"},
                 {ASDIC_RUN_BOTTOM_MESH, 0, INFINITY, "no terrain within range"},
                 {ASDIC_RUN_BOTTOM_PLANE, 0, 12.5, "flat bottom at 12.5 m"},
                 {ASDIC_RUN_BOTTOM_NONE, 0, INFINITY, "no bottom"}};
    for (size_t i = 0; i < 2 * sizeof cases / sizeof *cases; i++) {
        bool dashed = i % 2;
        asdic_render r;
        char note[ASDIC_CHART_NOTE_SIZE], wanted[ASDIC_CHART_NOTE_SIZE];
        describe(NAN, &r);
        asdic_run run = *r.run;
        run.facts.bottom = cases[i / 2].bottom;
        r.run = &run;
        const asdic_relief relief = {.columns = cases[i / 2].columns};
        const asdic_seafloor ground = {&relief, cases[i / 2].depth_m};
        const asdic_chart_area areas[] = {{.dashed = false}, {.dashed = dashed}, {.dashed = false}};
        asdic_render_note_chart(&r, &ground, "pings 0, 4", areas, 3, note);
        snprintf(wanted, sizeof wanted,
                 "areas: half-power lobes on the bottom at pings 0, 4%s  \u00b7  %s  \u00b7  %s",
                 dashed ? "  \u00b7  dashed: none within range" : "", cases[i / 2].said, r.note);
        assert_string_equal(note, wanted);
    }
}

/* Notes fill the room that they have, part by part, and no more. */
static void notes_end_where_their_room_does(void **state) {
    (void)state;
    char room[3 * ASDIC_NOTE_SIZE];
    memset(room, '#', sizeof room);
    room[0] = '\0';
    for (size_t i = 0; i < 60; i++) {
        size_t before = strlen(room);
        asdic_draw_note_add(room, "twenty-five bytes of note");
        size_t wanted = before + (i ? strlen(ASDIC_NOTE_PART) : 0) + 25;
        assert_int_equal(strlen(room), wanted < ASDIC_NOTE_SIZE ? wanted : ASDIC_NOTE_SIZE - 1);
    }
    for (size_t i = ASDIC_NOTE_SIZE; i < sizeof room; i++) {
        assert_int_equal(room[i], '#');
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(notes_end_where_their_room_does),
        cmocka_unit_test(rough_pictures_say_so),
        cmocka_unit_test(fine_ones_say_nothing),
        cmocka_unit_test(coherent_pings_are_said_to_be),
        cmocka_unit_test(ascopes_tell_which_curves_are_simulated),
        cmocka_unit_test(plans_tell_what_bottom_they_show),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
