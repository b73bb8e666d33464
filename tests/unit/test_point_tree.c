/* Points near a segment, by a tree and one by one. */
#include "smooth_rig.h"

#include "scene/point_tree.h"

typedef struct near_segment {
    const asdic_point_search *search;
    size_t count;
} near_segment;

static void count_near(void *caller, const asdic_point_place *point) {
    near_segment *near = caller;
    asdic_vec3 way = near->search->way_m, p = asdic_vec3_sub(point->at_m, near->search->from_m);
    double along = asdic_vec3_dot(p, way) / asdic_vec3_dot(way, way);
    asdic_vec3 aside = asdic_vec3_sub(p, asdic_vec3_scale(way, along));
    near->count +=
        along >= 0.0 && along <= 1.0 && asdic_vec3_length(aside) <= near->search->reach_m;
}

/* Points of a lattice share coordinates; segments go along its axes, and askew. */
static void a_tree_meets_all_points_near_a_segment(void **state) {
    (void)state;
    enum { SIDE = 15, POINTS = SIDE * SIDE * SIDE, SEGMENTS = 300 };
    asdic_point_place points[POINTS];
    size_t met = 0;
    for (uint32_t i = 0; i < POINTS; i++) {
        points[i] = (asdic_point_place){{i % SIDE, i / SIDE % SIDE, i / SIDE / SIDE}, i};
    }
    asdic_point_tree_plant(points, POINTS);
    for (uint32_t i = 0; i < SEGMENTS; i++) {
        double way[3], step = i % 2 ? 1.0 : 0.0;
        for (uint32_t k = 0; k < 3; k++) {
            way[k] = i % 3 == k ? 9.0 * jitter(7 * i + k) : step * 20.0 * jitter(7 * i + k);
        }
        asdic_point_search search = {.from_m = {i % 13, i % 11, i % 7},
                                     .way_m = {way[0], way[1], way[2]},
                                     .reach_m = i % 5 * 0.4,
                                     .meet = count_near};
        near_segment tree = {.search = &search}, all = tree;
        search.caller = &tree;
        asdic_point_tree_search(points, POINTS, &search);
        for (size_t k = 0; k < POINTS; k++) {
            count_near(&all, &points[k]);
        }
        assert_int_equal(tree.count, all.count);
        met += all.count;
    }
    assert_true(met > SEGMENTS);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tree_meets_all_points_near_a_segment),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
