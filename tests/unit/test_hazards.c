/*
 * How near a vehicle comes to things that move, against where all of them are at many times on the way.
 */
#include "dice.h"
#include "mission_rig.h"

#include "base/vec.h"
#include "mission/mission.h"
#include "trial/trial_hazards.h"

#include <math.h>

#define TIMES 200
#define PLACES 65

static asdic_vec3 random_place(uint64_t *state) {
    double x = random_unit(state), y = random_unit(state), z = random_unit(state);
    return (asdic_vec3){40.0 * (x - 0.5), 40.0 * (y - 0.5), 20.0 + 40.0 * (z - 0.5)};
}

/* A barge that stays, a boat that goes fast and one that turns, a fish that swims and one that does not. */
static asdic_mission *sea(workshop *w) {
    write_track(w, "fast.csv", "0,-60,-20,20,0,0,30\n10,100,40,22,0,0,30\n");
    write_track(w, "turns.csv", "0,5,5,15,0,0,0\n10,8,9,25,40,20,170\n");
    write_track(w, "swims.csv", "0,-30,3,12,0,0,0\n10,30,-8,30,0,0,0\n");
    asdic_mission *m = load_text(
        w, SCENE "bottom: {depth_m: 90}\n"
                 "objects:\n"
                 "  - {name: barge, box: {size_m: [9, 3, 2]}, position_m: [-8, 9, 14]}\n"
                 "  - {name: fast, box: {size_m: [6, 1, 2]}, track: fast.csv}\n"
                 "  - {name: turns, box: {size_m: [4, 3, 2]}, track: turns.csv}\n"
                 "  - {name: swims, point: {target_strength_db: -30}, track: swims.csv}\n"
                 "  - {name: sleeps, point: {target_strength_db: -30}, position_m: [9, -9, 28]}\n"
                 "mission: {pose: {position_m: [0, 0, 10]}, pings: 100}\n");
    assert_non_null(m);
    return m;
}

static const char *name_of(const asdic_scene *scene, size_t part) {
    return part == ASDIC_NOTHING      ? ""
           : part < scene->part_count ? scene->parts[part].name
                                      : scene->points[part - scene->part_count].name;
}

/* As they are at TIME_S. */
static void place(const asdic_mission *m, asdic_placement *p, double time_s) {
    const asdic_scene *scene = m->scene;
    for (size_t i = 0; i < m->motion_count; i++) {
        asdic_pose pose = asdic_track_pose(m->motions[i].track, time_s);
        for (size_t k = 0; k < scene->movable_count; k++) {
            if (strcmp(scene->parts[scene->movables[k].part].name, m->motions[i].name) == 0) {
                asdic_placement_move(p, k, &pose);
            }
        }
        for (size_t k = 0; k < scene->point_count; k++) {
            if (strcmp(scene->points[k].name, m->motions[i].name) == 0) {
                p->points[k].position_m = pose.position_m;
            }
        }
    }
}

static void nothing_is_missed_between_two_steps(void **state) {
    workshop *w = *state;
    asdic_mission *m = sea(w);
    asdic_hazards *hazards = NULL;
    asdic_placement *p = NULL;
    assert_ok(w->ctx, asdic_hazards_create(m, &hazards));
    assert_ok(w->ctx, asdic_placement_create(m->scene, &p));
    assert_true(asdic_hazards_move(hazards));
    uint64_t random = 3;
    unsigned of[5] = {0};
    for (int i = 0; i < 120; i++) {
        double from_s = 9.0 * random_unit(&random), to_s = from_s + 0.3;
        asdic_vec3 from = random_place(&random);
        asdic_vec3 along = asdic_vec3_sub(random_place(&random), from);
        asdic_vec3 to = asdic_vec3_add(from, asdic_vec3_scale(along, 0.05));
        asdic_nearest found = asdic_hazards_nearest(hazards, from, to, from_s, to_s, 1e3);
        asdic_nearest seen = {1e3, ASDIC_NOTHING};
        for (int k = 0; k <= TIMES; k++) {
            double t = (double)k / TIMES;
            asdic_vec3 at = asdic_vec3_add(from, asdic_vec3_scale(along, 0.05 * t));
            place(m, p, from_s + t * (to_s - from_s));
            asdic_nearest now =
                asdic_placement_nearest(p, &(asdic_way){at, at}, NULL, seen.distance_m);
            seen = now.distance_m < seen.distance_m ? now : seen;
        }
        /* Between two of the times a boat of 18 m/s goes 26 mm; one that turns by 6 degrees on the way leaves the
         * straight one by a thousandth of how far off it is. */
        double slack_m = 0.015 + 1e-3 * seen.distance_m;
        if (fabs(found.distance_m - seen.distance_m) > slack_m) {
            fail_msg("%d: %.5g m to '%s', by many times %.5g m to '%s'", i, found.distance_m,
                     name_of(m->scene, found.part), seen.distance_m, name_of(m->scene, seen.part));
        }
        static const char *const names[5] = {"barge", "fast", "turns", "swims", "sleeps"};
        for (int k = 0; k < 5; k++) {
            of[k] += strcmp(name_of(m->scene, found.part), names[k]) == 0;
        }
        asdic_nearest within =
            asdic_hazards_nearest(hazards, from, to, from_s, to_s, 0.5 * found.distance_m);
        assert_true(within.part == ASDIC_NOTHING);
        assert_true(within.distance_m == 0.5 * found.distance_m);
    }
    for (int k = 0; k < 5; k++) {
        assert_true(of[k] > 3);
    }
    asdic_placement_destroy(&p);
    asdic_hazards_destroy(&hazards);
    asdic_hazards_destroy(&hazards);
    asdic_mission_destroy(&m);
}

/* The nearest of PLACES on the triangles of PART, or its point, within the sector of LOOK. */
static double ahead_by_search(const asdic_placement *p, size_t part, const asdic_way *look,
                              double sector_rad) {
    const asdic_scene *scene = p->scene;
    asdic_vec3 u = asdic_vec3_sub(look->to_m, look->from_m);
    double best = INFINITY;
    for (size_t i = 0; i <= scene->triangle_count; i++) {
        bool is_point = i == scene->triangle_count;
        const dev_triangle *t = is_point ? NULL : asdic_placement_triangle(p, i);
        if (is_point ? part < scene->part_count : t->part != part) {
            continue;
        }
        for (int k = 0; k < (is_point ? 1 : PLACES * PLACES); k++) {
            double a = (double)(k % PLACES) / (PLACES - 1), b = (double)(k / PLACES) / (PLACES - 1);
            b *= 1.0 - a;
            asdic_vec3 x = {0.0, 0.0, 0.0};
            if (is_point) {
                x = p->points[part - scene->part_count].position_m;
            } else {
                const float *v[3] = {t->v0, t->v1, t->v2};
                double w[3] = {1.0 - a - b, a, b};
                for (int n = 0; n < 3; n++) {
                    x = asdic_vec3_add(
                        x, (asdic_vec3){w[n] * v[n][0], w[n] * v[n][1], w[n] * v[n][2]});
                }
                x = asdic_vec3_add(x, scene->origin_m);
            }
            x = asdic_vec3_sub(x, look->from_m);
            double far_m = asdic_vec3_length(x);
            if (acos(fmax(fmin(asdic_vec3_dot(x, u) / far_m, 1.0), -1.0)) <= sector_rad) {
                best = fmin(best, far_m);
            }
        }
    }
    return best;
}

/* Of each thing, where it is at the moment, what a sector holds: as near as by many places on it. */
static void what_is_ahead_is_found(void **state) {
    workshop *w = *state;
    asdic_mission *m = sea(w);
    asdic_hazards *hazards = NULL;
    asdic_placement *p = NULL;
    assert_ok(w->ctx, asdic_hazards_create(m, &hazards));
    assert_ok(w->ctx, asdic_placement_create(m->scene, &p));
    size_t parts = m->scene->part_count + m->scene->point_count;
    uint64_t random = 5;
    unsigned partly = 0, none = 0;
    for (int i = 0; i < 250; i++) {
        double time_s = 10.0 * random_unit(&random), sector_rad = ASDIC_PI * random_unit(&random);
        asdic_vec3 from = random_place(&random);
        asdic_vec3 u = asdic_vec3_sub(random_place(&random), from);
        u = asdic_vec3_scale(u, 1.0 / asdic_vec3_length(u));
        const asdic_way look = {from, asdic_vec3_add(from, u)};
        place(m, p, time_s);
        for (size_t part = 0; part < parts; part++) {
            double found_m =
                asdic_hazards_ahead(hazards, part, &look, time_s, sector_rad, INFINITY);
            double within_m = 40.0 * random_unit(&random);
            assert_true(asdic_hazards_ahead(hazards, part, &look, time_s, sector_rad, within_m) ==
                        (found_m < within_m ? found_m : INFINITY));
            double less_m = ahead_by_search(p, part, &look, sector_rad - 2e-3);
            double more_m = ahead_by_search(p, part, &look, sector_rad + 2e-3);
            /* Places are at most 0.1 m apart, of a plane or a point that is met at most so much off; a thing may be
             * missed by all of them where its edge alone is ahead. */
            if (!(found_m <= less_m + 1e-3) || (isfinite(found_m) && found_m < more_m - 0.2)) {
                fail_msg("%d: %.6g m to '%s', by search %.6g to %.6g m", i, found_m,
                         name_of(m->scene, part), less_m, more_m);
            }
            partly += isfinite(found_m) && found_m > ahead_by_search(p, part, &look, 4.0) + 0.1;
            none += isinf(found_m);
        }
    }
    assert_true(partly > 10 && none > 100);
    asdic_placement_destroy(&p);
    asdic_hazards_destroy(&hazards);
    asdic_mission_destroy(&m);
}

/* A boat that comes from 27 m on one side to 27 m on the other within a step goes over who is between. */
static void what_passes_within_a_step_is_met(void **state) {
    workshop *w = *state;
    asdic_mission *m = sea(w);
    asdic_hazards *hazards = NULL;
    assert_ok(w->ctx, asdic_hazards_create(m, &hazards));
    asdic_vec3 way = {160.0, 60.0, 2.0}, at = {-60.0, -20.0, 20.0};
    at = asdic_vec3_add(at, asdic_vec3_scale(way, 0.35));
    asdic_nearest found = asdic_hazards_nearest(hazards, at, at, 2.0, 5.0, 20.0);
    assert_true(found.distance_m == 0.0);
    assert_string_equal(name_of(m->scene, found.part), "fast");
    for (double from_s = 2.0; from_s < 5.0; from_s += 2.5) { /* neither before nor after */
        found = asdic_hazards_nearest(hazards, at, at, from_s, from_s + 0.5, 20.0);
        assert_string_not_equal(name_of(m->scene, found.part), "fast");
    }
    asdic_vec3 fish = {0.0, -2.5, 21.0};
    found = asdic_hazards_nearest(hazards, fish, fish, 4.9, 5.1, 1e-3);
    assert_string_equal(name_of(m->scene, found.part), "swims");
    /* Down to the bottom, and through it: */
    asdic_vec3 far_off = {500.0, 0.0, 80.0}, low = {500.0, 0.0, 89.5}, below = {500.0, 0.0, 95.0};
    found = asdic_hazards_nearest(hazards, far_off, low, 0.0, 1.0, 1e3);
    assert_true(fabs(found.distance_m - 0.5) < 1e-9 && found.part == ASDIC_NOTHING);
    assert_true(asdic_hazards_nearest(hazards, far_off, below, 0.0, 1.0, 1e3).distance_m == 0.0);
    /* At the first ping: */
    size_t part = ASDIC_NOTHING;
    assert_true(asdic_hazards_hold(hazards, (asdic_vec3){5.0, 5.0, 15.0}, &part));
    assert_string_equal(name_of(m->scene, part), "turns");
    assert_false(asdic_hazards_hold(hazards, (asdic_vec3){8.0, 9.0, 25.0}, &part));
    asdic_hazards_destroy(&hazards);
    asdic_mission_destroy(&m);
}

/* Whether anything moves in a sea with OBJECT alone. */
static bool moves(workshop *w, const char *object) {
    char text[1024];
    asdic_hazards *hazards = NULL;
    snprintf(text, sizeof text,
             SCENE "bottom: {depth_m: 90}\nobjects: [{name: it, %s}]\n"
                   "mission: {pose: {position_m: [0, 0, 10]}}\n",
             object);
    asdic_mission *m = load_text(w, text);
    assert_non_null(m);
    assert_ok(w->ctx, asdic_hazards_create(m, &hazards));
    bool answer = asdic_hazards_move(hazards);
    asdic_hazards_destroy(&hazards);
    asdic_mission_destroy(&m);
    return answer;
}

static void what_has_a_track_moves(void **state) {
    workshop *w = *state;
    write_track(w, "way.csv", "0,-60,-20,20,0,0,30\n10,100,40,22,0,0,30\n");
    assert_true(moves(w, "box: {size_m: [6, 1, 2]}, track: way.csv"));
    assert_true(moves(w, "point: -30, track: way.csv"));
    assert_false(moves(w, "box: {size_m: [6, 1, 2]}, position_m: [9, 9, 20]"));
    assert_false(moves(w, "point: -30, position_m: [9, 9, 20]"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(nothing_is_missed_between_two_steps, begin, end),
        cmocka_unit_test_setup_teardown(what_is_ahead_is_found, begin, end),
        cmocka_unit_test_setup_teardown(what_passes_within_a_step_is_met, begin, end),
        cmocka_unit_test_setup_teardown(what_has_a_track_moves, begin, end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
