/* What a mission writes for the chart of its run: outlines, routes, depths. */
#include "mission_files_rig.h"

#include "mission/mission.h"
#include "mission/run/run_chart_data.h"

#include <malloc.h>

/* A point's outline is a point, and there is none behind it. */
static void outlines_are_as_many_as_objects(void **state) {
    workshop *w = *state;
    mallopt(M_PERTURB, 90);
    asdic_mission *m =
        load_text(w, SCENE FLAT POSE "objects: [{name: p, point: 0, position_m: [9, 1, 5]}]\n");
    assert_non_null(m);
    assert_ok(w->ctx, asdic_chart_data_write(w->ctx, m, w->folder));
    assert_string_equal(content_of(w, "objects.csv"), "object,outline,x_m,y_m\np,0,9.000,1.000\n");
    asdic_mission_destroy(&m);
    mallopt(M_PERTURB, 0);
}

/* A floor that slopes both ways: its depth, to a millimetre, in the middle of each cell that lies on it and within reach
 * of a ping, from the north-western one on. Cells are a tenth of a metre, 440 from south to north. */
static void terrain_is_that_in_reach(void **state) {
    workshop *w = *state;
    char text[2048];
    size_t used = (size_t)snprintf(text, sizeof text,
                                   "ncols 2\nnrows 41\nxllcenter -1\nyllcenter -40\n"
                                   "cellsize 2\n");
    for (int row = 0; row < 41; row++) {
        double deep_m = 12.5 - 0.0371 * (40.0 - 2.0 * row);
        used += (size_t)snprintf(text + used, sizeof text - used, "%.4f %.4f\n", deep_m - 0.013,
                                 deep_m + 0.013);
    }
    write_file(w, "slope.asc", text);
    write_track(w, "north.csv", "0,0,0,5,0,0,0\n2,4,0,5,0,0,0\n");
    asdic_mission *m = load_text(
        w, "version: 1\nbottom: {grid: {file: slope.asc, values: depths}, type: mud}\n"
           "sonar: {frequency_khz: 100, ping_rate_hz: 1, bin_length_m: 0.5, max_range_m: 20, "
           "receivers: [{name: a}]}\nmission: {track: north.csv}\n");
    assert_non_null(m);
    unlink(path_of(w, "objects.csv")); /* of another test */
    assert_ok(w->ctx, asdic_chart_data_write(w->ctx, m, w->folder));
    assert_int_not_equal(access(path_of(w, "objects.csv"), F_OK), 0);
    assert_int_not_equal(access(path_of(w, "routes.csv"), F_OK), 0);
    FILE *file = fopen(path_of(w, "terrain.asc"), "r");
    assert_non_null(file);
    static const char *const header[] = {"ncols         20\n",  "nrows         440\n",
                                         "xllcorner     -1\n",  "yllcorner     -20\n",
                                         "cellsize      0.1\n", "NODATA_value  -9999\n"};
    for (size_t i = 0; i < sizeof header / sizeof *header; i++) {
        assert_non_null(fgets(text, sizeof text, file));
        assert_string_equal(text, header[i]);
    }
    for (int row = 0; row < 440; row++) {
        for (int column = 0; column < 20; column++) {
            char digits[32], end;
            assert_int_equal(fscanf(file, "%31[0-9.]%c", digits, &end), 2);
            assert_int_equal(end, column == 19 ? '\n' : ' ');
            assert_string_equal(digits + strlen(digits) - 4, strchr(digits, '.'));
            double north_m = 24.0 - 0.1 * (row + 0.5), east_m = -1.0 + 0.1 * (column + 0.5);
            assert_close(strtod(digits, NULL), 12.5 - 0.0371 * north_m + 0.013 * east_m, 5.1e-4);
        }
    }
    assert_int_equal(fgetc(file), EOF);
    assert_int_equal(fclose(file), 0);
    asdic_mission_destroy(&m);
}

/* Of a route every so many-th ping, 512 at most, and the last. */
static void routes_are_thinned_out(void **state) {
    workshop *w = *state;
    static const struct {
        double time_s;
        size_t pings, every, rows;
    } ways[] = {
        {2.5, 251, 1, 251}, {5.11, 512, 1, 512}, {5.12, 513, 2, 257}, {20.01, 2002, 4, 502}};
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        char rows[256], text[512];
        snprintf(rows, sizeof rows, "0,0,0,5,0,0,0\n%.17g,4,0,5,0,0,0\n", ways[i].time_s);
        write_track(w, "own.csv", rows);
        snprintf(rows, sizeof rows, "0,10,-5,5,0,0,-20\n%.17g,40,5,5,0,0,70\n", ways[i].time_s);
        write_track(w, "boat.csv", rows);
        snprintf(text, sizeof text,
                 "version: 1\n" FLAT "objects:\n"
                 "  - {name: still, point: -20, position_m: [9, 1, 5]}\n"
                 "  - {name: boat, box: {size_m: [1, 1, 1]}, track: boat.csv}\n"
                 "sonar: {frequency_khz: 100, ping_rate_hz: 100, max_range_m: 5, "
                 "receivers: [{name: a}]}\nmission: {track: own.csv}\n");
        asdic_mission *m = load_text(w, text);
        assert_non_null(m);
        assert_int_equal(asdic_mission_ping_count(m), ways[i].pings);
        assert_ok(w->ctx, asdic_chart_data_write(w->ctx, m, w->folder));
        FILE *file = fopen(path_of(w, "routes.csv"), "r");
        assert_non_null(file);
        assert_non_null(fgets(text, sizeof text, file));
        assert_string_equal(text, "object,time_s,x_m,y_m,yaw_deg\n");
        size_t count = 0, last = ways[i].pings - 1;
        for (; fgets(text, sizeof text, file); count++) {
            double time_s, x_m, y_m, yaw_deg;
            size_t ping = count * ways[i].every < last ? count * ways[i].every : last;
            double share = (double)ping / (100.0 * ways[i].time_s);
            assert_int_equal(sscanf(text, "boat,%lf,%lf,%lf,%lf\n", &time_s, &x_m, &y_m, &yaw_deg),
                             4);
            assert_close(time_s, 0.01 * (double)ping, 1e-9);
            assert_close(x_m, 10.0 + 30.0 * share, 5.1e-4);
            assert_close(y_m, -5.0 + 10.0 * share, 5.1e-4);
            assert_close(yaw_deg, -20.0 + 90.0 * share, 5.1e-4);
        }
        assert_int_equal(count, ways[i].rows);
        assert_int_equal(fclose(file), 0);
        asdic_mission_destroy(&m);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(outlines_are_as_many_as_objects),
        cmocka_unit_test(terrain_is_that_in_reach),
        cmocka_unit_test(routes_are_thinned_out),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
