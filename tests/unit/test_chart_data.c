/*
 * What a run keeps for its chart: outlines, routes, depths.
 */
#include "asserts.h"
#include "test_context.h"

#include "lib/base/vec.h"
#include "lib/mission/run/run_chart_data.h"

#include <asdic/asdic.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void routes_are_the_runs(void **state) {
    (void)state;
    /* North 10 m in 10 s, then east 10 m in 10 s, turning from 350 to 20 degrees in the second leg. */
    const double turn_rad = ASDIC_PI / 180.0;
    asdic_route_point points[] = {
        {0, 0, 0, -10 * turn_rad}, {10, 10, 0, 350 * turn_rad}, {20, 10, 10, 20 * turn_rad}};
    asdic_route route = {.name = "boat", .points = points, .count = 3};
    /* 2 m round its place at the first ping, from its bow on; a rock elsewhere. */
    enum { SIDES = ASDIC_OUTLINE_SIDES };
    asdic_outline outlines[] = {{.name = "rock", .count = 1, .north_m = {5}, .east_m = {5}},
                                {.name = "boat", .count = SIDES}};
    for (int k = 0; k < SIDES; k++) {
        outlines[1].north_m[k] = 2.0 * cos((-10 + 15 * k) * turn_rad);
        outlines[1].east_m[k] = 2.0 * sin((-10 + 15 * k) * turn_rad);
    }
    asdic_chart_data data = {.routes = &route,
                             .route_count = 1,
                             .points = points,
                             .outlines = outlines,
                             .outline_count = 2};
    asdic_chart_data_cut(&data, 5.0, 15.0);
    assert_int_equal(data.route_count, 1);
    assert_int_equal(route.count, 3);
    const double expected[3][3] = {{5, 5, 0}, {10, 10, 0}, {15, 10, 5}};
    for (int i = 0; i < 3; i++) {
        assert_close(route.points[i].time_s, expected[i][0], 0);
        assert_close(route.points[i].north_m, expected[i][1], 1e-12);
        assert_close(route.points[i].east_m, expected[i][2], 1e-12);
    }
    assert_close(outlines[0].north_m[0], 5.0, 0);
    for (int k = 0; k < SIDES; k++) {
        assert_close(outlines[1].north_m[k], 10.0 + 2.0 * cos((5 + 15 * k) * turn_rad), 1e-12);
        assert_close(outlines[1].east_m[k], 5.0 + 2.0 * sin((5 + 15 * k) * turn_rad), 1e-12);
    }
    /* One ping is no way to go. */
    asdic_chart_data_cut(&data, 15.0, 15.0);
    assert_int_equal(data.route_count, 0);
}

/* From its first time to its last, and from before to behind them, a route is whole. */
static void routes_are_cut_beyond_their_ends(void **state) {
    (void)state;
    for (double beyond_s = 0.0; beyond_s < 6.0; beyond_s += 5.0) {
        asdic_route_point points[] = {{0, 1, 2, 0.1}, {10, 3, 4, 0.2}, {20, 5, 6, 0.3}};
        asdic_route route = {.name = "boat", .points = points, .count = 3};
        asdic_chart_data data = {.routes = &route, .route_count = 1, .points = points};
        asdic_chart_data_cut(&data, -beyond_s, 20.0 + beyond_s);
        assert_int_equal(route.count, 3);
        for (size_t i = 0; i < 3; i++) {
            double time_s = 10.0 * (double)i + ((double)i - 1.0) * beyond_s;
            assert_close(points[i].time_s, time_s, 0.0);
            assert_close(points[i].north_m, 1.0 + 2.0 * (double)i, 0.0);
            assert_close(points[i].east_m, 2.0 + 2.0 * (double)i, 0.0);
            assert_close(points[i].yaw_rad, 0.1 + 0.1 * (double)i, 1e-15);
        }
    }
}

static void write_kept(const char *folder, const char *name, const char *text) {
    char path[64];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

/* What a run kept: a corner a line, where a new number begins an outline; a point a line, where a new name begins a
 * route; depths from the north-western cell on. */
static void kept_charts_are_read(void **state) {
    (void)state;
    char folder[] = "/tmp/asdic-chart-XXXXXX", command[64];
    assert_non_null(mkdtemp(folder));
    write_kept(folder, "objects.csv",
               "object,outline,x_m,y_m\nrock,0,1,2\nrock,0,3,4\nbox,1,5,6\nbox,2,7,8\n"
               "box,2,9,10\nbox,2,11,12\n");
    write_kept(folder, "routes.csv",
               "object,time_s,x_m,y_m,yaw_deg\nboat,0,1,2,90\nboat,1,3,4,-90\nboa,0,5,6,0\n"
               "boat,0,7,8,180\nboat,2,9,10,180");
    write_kept(folder, "terrain.asc",
               "ncols 3\nnrows 2\nxllcorner -5\nyllcorner 7.5\ncellsize 2\n"
               "NODATA_value -9999\n1 2 3\n4 -9999 6\n");
    asdic_chart_data data;
    assert_int_equal(asdic_chart_data_read(ctx, folder, &data), ASDIC_OK);
    static const struct {
        const char *name;
        size_t count;
    } outlines[] = {{"rock", 2}, {"box", 1}, {"box", 3}},
      routes[] = {{"boat", 2}, {"boa", 1}, {"boat", 2}};
    double next = 1.0;
    assert_int_equal(data.outline_count, 3);
    for (size_t i = 0; i < 3; i++) {
        const asdic_outline *o = &data.outlines[i];
        assert_string_equal(o->name, outlines[i].name);
        assert_int_equal(o->count, outlines[i].count);
        for (size_t k = 0; k < o->count; k++) {
            assert_close(o->north_m[k], next++, 0.0);
            assert_close(o->east_m[k], next++, 0.0);
        }
    }
    static const double times_s[] = {0, 1, 0, 0, 2}, yaws_deg[] = {90, -90, 0, 180, 180};
    size_t point = 0;
    next = 1.0;
    assert_int_equal(data.route_count, 3);
    for (size_t i = 0; i < 3; i++) {
        const asdic_route *r = &data.routes[i];
        assert_string_equal(r->name, routes[i].name);
        assert_int_equal(r->count, routes[i].count);
        for (size_t k = 0; k < r->count; k++, point++) {
            assert_close(r->points[k].time_s, times_s[point], 0.0);
            assert_close(r->points[k].north_m, next++, 0.0);
            assert_close(r->points[k].east_m, next++, 0.0);
            assert_close(r->points[k].yaw_rad, yaws_deg[point] * ASDIC_PI / 180.0, 1e-12);
        }
    }
    const asdic_relief *relief = &data.relief;
    assert_true(relief->columns == 3 && relief->rows == 2 && relief->cell_m == 2.0);
    assert_true(relief->west_m == -5.0 && relief->south_m == 7.5);
    for (size_t i = 0; i < 6; i++) {
        double depth_m = (double)relief->depth_m[i];
        assert_true(i == 4 ? isnan(depth_m) : depth_m == (double)(i + 1));
    }
    asdic_chart_data_finish(&data);
    snprintf(command, sizeof command, "rm -r %s", folder);
    assert_int_equal(system(command), 0);
}

/* Outlines have up to 24 corners, in files of any version. */
static void outlines_of_24_corners_are_read(void **state) {
    (void)state;
    char folder[] = "/tmp/asdic-chart-XXXXXX", command[64];
    assert_non_null(mkdtemp(folder));
    for (size_t corners = 24; corners <= 25; corners++) {
        char text[1024] = "object,outline,x_m,y_m\n";
        for (size_t k = 0; k < corners; k++) {
            snprintf(text + strlen(text), sizeof text - strlen(text), "rock,0,%zu,1\n", k);
        }
        write_kept(folder, "objects.csv", text);
        asdic_chart_data data;
        assert_int_equal(asdic_chart_data_read(ctx, folder, &data),
                         corners > 24 ? ASDIC_ERROR_INPUT : ASDIC_OK);
        if (corners <= 24) {
            assert_int_equal(data.outlines[0].count, corners);
            asdic_chart_data_finish(&data);
        }
    }
    snprintf(command, sizeof command, "rm -r %s", folder);
    assert_int_equal(system(command), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(routes_are_the_runs),
        cmocka_unit_test(routes_are_cut_beyond_their_ends),
        cmocka_unit_test(kept_charts_are_read),
        cmocka_unit_test(outlines_of_24_corners_are_read),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
