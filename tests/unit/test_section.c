/*
 * Beams in an upright plane are drawn as a section: down is down on the page, and starboard or ahead on its right,
 * whichever way the beams are listed.
 */
#include "asserts.h"

#include "base/vec.h"
#include "mission/run/run_section.h"

#include <math.h>

#define MOST 9

static double rad(double deg) {
    return deg * (ASDIC_PI / 180.0);
}

/* COUNT beams at DIRECTIONS, pitch below the level and yaw in degrees. */
static asdic_sonar sonar_of(const double (*directions)[2], size_t count, bool backwards,
                            asdic_beam beams[MOST]) {
    asdic_sonar sonar = asdic_sonar_default();
    for (size_t i = 0; i < count; i++) {
        const double *at = directions[backwards ? count - 1 - i : i];
        beams[i] = (asdic_beam){.pitch_rad = rad(at[0]), .yaw_rad = rad(at[1])};
    }
    sonar.receivers = beams;
    sonar.receiver_count = count;
    return sonar;
}

typedef struct view {
    const char *name;
    size_t count;
    double directions[MOST][2];
    double page_deg[MOST]; /* clockwise from up */
    bool is_starboard, is_reversed;
} view;

static const view sections[] = {
    {"an echo sounder, port to starboard",
     5,
     {{30, -90}, {60, -90}, {90, 0}, {45, 90}, {20, 90}},
     {240, 210, 180, 135, 110},
     true,
     true},
    {"up and down ahead",
     4,
     {{-20, 0}, {0, 0}, {35, 0}, {80, 0}},
     {70, 90, 125, 170},
     false,
     false},
    {"past straight down",
     4,
     {{50, 0}, {90, 0}, {60, 180}, {10, 180}},
     {140, 180, 210, 260},
     false,
     false},
    {"up and down abeam", 3, {{-10, 90}, {5, 90}, {40, 90}}, {80, 95, 130}, true, false},
    {"up and down to port", 3, {{-10, -90}, {5, -90}, {40, -90}}, {280, 265, 230}, true, true},
    {"over the top", 3, {{-60, 0}, {-90, 0}, {-70, 180}}, {30, 0, -20}, false, true},
};

static void sections_lie_as_the_beams_do(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof sections / sizeof *sections; i++) {
        const view *v = &sections[i];
        for (int backwards = 0; backwards < 2; backwards++) {
            asdic_beam beams[MOST];
            asdic_sonar sonar = sonar_of(v->directions, v->count, backwards, beams);
            asdic_section s;
            if (!asdic_section_of(&sonar, &s)) {
                fail_msg("%s is none", v->name);
            }
            assert_int_equal(s.is_starboard, v->is_starboard);
            assert_int_equal(s.is_reversed, v->is_reversed != (backwards == 1));
            double bearing_rad[MOST];
            asdic_section_bearings(&s, &sonar, bearing_rad);
            assert_int_equal(asdic_beam_ahead(&sonar), (v->count - 1) / 2);
            for (size_t b = 0; b < v->count; b++) {
                double page_rad = rad(v->page_deg[backwards ? v->count - 1 - b : b]);
                assert_float_equal(asdic_section_bearing_rad(&s, &beams[b], page_rad), page_rad,
                                   1e-9);
                assert_float_equal(remainder(bearing_rad[b] - page_rad, 2.0 * ASDIC_PI), 0.0, 1e-9);
                assert_true(b < 1 || fabs(bearing_rad[b] - bearing_rad[b - 1]) < ASDIC_PI);
                assert_float_equal(asdic_section_bearing_rad(&s, &beams[b], page_rad - 6.0),
                                   page_rad - 2.0 * ASDIC_PI, 1e-9);
            }
        }
    }
}

static const view others[] = {
    {"two beams", 2, {{30, -90}, {60, -90}}, {0}, false, false},
    {"a level fan", 3, {{0, -30}, {0, 0}, {0, 30}}, {0}, false, false},
    {"a cone", 4, {{70, -50}, {70, -10}, {70, 10}, {70, 50}}, {0}, false, false},
    {"to and fro", 4, {{0, 0}, {20, 0}, {10, 0}, {40, 0}}, {0}, false, false},
    {"twice the same", 4, {{0, 0}, {20, 0}, {20, 0}, {40, 0}}, {0}, false, false},
    {"all alike", 3, {{20, 5}, {20, 5}, {20, 5}}, {0}, false, false},
    {"more than once round",
     6,
     {{-45, 180}, {-45, 0}, {45, 0}, {45, 180}, {-40, 180}, {-40, 0}},
     {0},
     false,
     false},
};

static void the_beam_nearest_ahead_stands_for_others(void **state) {
    (void)state;
    static const double directions[][2] = {{90, 0}, {30, 20}, {0, -40}, {25, 0}, {25, 180}};
    asdic_beam beams[MOST];
    for (size_t count = 1; count <= 5; count++) { /* 90, 35.5, 40, 25 and 155 degrees from ahead */
        static const size_t nearest[] = {0, 1, 1, 3, 3};
        asdic_sonar sonar = sonar_of(directions, count, false, beams);
        assert_int_equal(asdic_beam_ahead(&sonar), nearest[count - 1]);
    }
}

static void other_beams_make_none(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        asdic_beam beams[MOST];
        asdic_sonar sonar = sonar_of(others[i].directions, others[i].count, false, beams);
        asdic_section s;
        if (asdic_section_of(&sonar, &s)) {
            fail_msg("%s is one", others[i].name);
        }
    }
}

/* A fan whose middle looks DEPRESSION below the level, port to starboard. */
static bool is_section_at(double depression_deg) {
    double directions[3][2] = {{0}};
    const double across[] = {-20, 0, 20};
    asdic_beam beams[MOST];
    asdic_section s;
    for (size_t i = 0; i < 3; i++) {
        double x = cos(rad(across[i])) * cos(rad(depression_deg)), y = sin(rad(across[i]));
        double z = cos(rad(across[i])) * sin(rad(depression_deg));
        directions[i][0] = asin(z) / rad(1.0);
        directions[i][1] = atan2(y, x) / rad(1.0);
    }
    asdic_sonar sonar = sonar_of(directions, 3, false, beams);
    return asdic_section_of(&sonar, &s);
}

static void steep_fans_are_sections(void **state) {
    (void)state;
    assert_false(is_section_at(-10));
    assert_false(is_section_at(59));
    assert_true(is_section_at(61));
    assert_true(is_section_at(-85));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sections_lie_as_the_beams_do),
        cmocka_unit_test(other_beams_make_none),
        cmocka_unit_test(the_beam_nearest_ahead_stands_for_others),
        cmocka_unit_test(steep_fans_are_sections),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
