/*
 * ESRI ASCII grids.
 */
#include "mesh_rig.h"

#include <locale.h>
#include <stdio.h>

static mesh_rig rig;

static asdic_mesh *load(bool values_are_depth) {
    asdic_mesh *mesh = NULL;
    asdic_status status = asdic_mesh_load_grid(rig.ctx, rig.path, values_are_depth, &mesh);
    if (status != ASDIC_OK) {
        print_error("%s\n", asdic_context_error(rig.ctx));
    }
    assert_int_equal(status, ASDIC_OK);
    return mesh;
}

static void refuse(const char *text, const char *part) {
    asdic_mesh *mesh = NULL;
    mesh_rig_write(&rig, "g.asc", text);
    assert_int_equal(asdic_mesh_load_grid(rig.ctx, rig.path, true, &mesh), ASDIC_ERROR_INPUT);
    assert_null(mesh);
    if (!strstr(asdic_context_error(rig.ctx), part)) {
        print_error("'%s' lacks '%s'\n", asdic_context_error(rig.ctx), part);
    }
    assert_non_null(strstr(asdic_context_error(rig.ctx), part));
    assert_non_null(strstr(asdic_context_error(rig.ctx), rig.path));
}

/* Altitude at (x, y) of a scene whose bottom is MESH, seen from the surface. */
static double depth_at(const asdic_mesh *mesh, double x_m, double y_m) {
    asdic_scene *scene;
    asdic_pose here = {.yaw_rad = 0.0};
    assert_int_equal(asdic_scene_create(rig.ctx, &scene), ASDIC_OK);
    assert_int_equal(asdic_scene_add_bottom(scene, mesh, here, asdic_material_bottom(2)), ASDIC_OK);
    assert_int_equal(asdic_scene_commit(scene), ASDIC_OK);
    double depth = asdic_scene_altitude_m(scene, (asdic_vec3){x_m, y_m, 0.0});
    asdic_scene_destroy(&scene);
    return depth;
}

static void rows_run_south(void **state) {
    (void)state;
    mesh_rig_write(&rig, "g.asc",
                   "ncols 3\nnrows 2\nxllcorner 500000\nyllcorner 4500000\n"
                   "cellsize 10\nNODATA_value -9999\n11 12 13\n21 22 23\n");
    asdic_mesh *mesh = load(true);
    asdic_mesh_info info = asdic_mesh_get_info(mesh);
    assert_int_equal(info.triangles, 4);
    assert_close(info.min_m.x, 4500005.0, 0.0);
    assert_close(info.max_m.x, 4500015.0, 0.0);
    assert_close(info.min_m.y, 500005.0, 0.0);
    assert_close(info.max_m.y, 500025.0, 0.0);
    assert_close(depth_at(mesh, 4500015.0, 500005.0), 11.0, 1e-4); /* north-west */
    assert_close(depth_at(mesh, 4500005.0, 500025.0), 23.0, 1e-4); /* south-east */
    assert_close(depth_at(mesh, 4500010.0, 500015.0), 17.0, 1e-4); /* linear between */
    asdic_mesh_destroy(&mesh);
}

/* A ridge from north to south between two slopes: each facet has its own corners. */
static void facets_are_of_their_corners(void **state) {
    (void)state;
    mesh_rig_write(&rig, "g.asc",
                   "ncols 3\nnrows 2\nxllcenter 0\nyllcenter 0\ncellsize 1\n"
                   "10 20 10\n10 20 10\n");
    asdic_mesh *mesh = load(true);
    for (double north_m = 0.1; north_m < 1.0; north_m += 0.2) {
        for (double east_m = 0.15; east_m < 2.0; east_m += 0.2) {
            assert_close(depth_at(mesh, north_m, east_m), 20.0 - 10.0 * fabs(east_m - 1.0), 1e-4);
        }
    }
    asdic_mesh_destroy(&mesh);
}

static void heights_and_other_headers(void **state) {
    (void)state;
    mesh_rig_write(&rig, "g.asc",
                   "NCOLS 2\r\nNROWS 2\r\nXLLCENTER 0.5\r\nYLLCENTER -0.5\r\n"
                   "dx        0.250000000000\r\ndy        2.000000000000\r\n-4 -4\r\n-5 -5\r\n");
    asdic_mesh *mesh = load(false);
    asdic_mesh_info info = asdic_mesh_get_info(mesh);
    assert_close(info.min_m.y, 0.5, 0.0);
    assert_close(info.max_m.y, 0.75, 0.0);
    assert_close(info.min_m.x, -0.5, 0.0);
    assert_close(info.max_m.x, 1.5, 0.0);
    assert_close(depth_at(mesh, 1.5, 0.6), 4.0, 1e-5);
    assert_close(depth_at(mesh, -0.5, 0.6), 5.0, 1e-5);
    asdic_mesh_destroy(&mesh);
}

/* As editors of Windows save it. */
static void a_mark_of_utf8_is_passed_over(void **state) {
    (void)state;
    mesh_rig_write(&rig, "g.asc",
                   "\xef\xbb\xbfncols 2\r\nnrows 2\r\nxllcorner 0\r\nyllcorner 0\r\n"
                   "cellsize 1\r\n1 2\r\n3 4\r\n");
    asdic_mesh *mesh = load(true);
    assert_close(depth_at(mesh, 1.5, 1.5), 2.0, 1e-6); /* the north-eastern corner */
    asdic_mesh_destroy(&mesh);
    refuse("\xef\xbb\xbf", "header");
}

/* Cells of a second of arc over 20 m of depth; and of 20 m. */
static void degrees_are_hinted_at(void **state) {
    (void)state;
    static const char *const sizes[] = {"0.000277777777778", "20"};
    for (int i = 0; i < 2; i++) {
        char text[256];
        snprintf(text, sizeof text,
                 "ncols 3\nnrows 3\nxllcorner 9.5\nyllcorner 43.5\ncellsize %s\n"
                 "10 12 14\n16 18 20\n22 25 30\n",
                 sizes[i]);
        mesh_rig_write(&rig, "g.asc", text);
        asdic_mesh *mesh = load(true);
        assert_string_equal(asdic_mesh_get_info(mesh).hint,
                            i ? ""
                              : "0.000556 m wide, but 20 m high: degrees? (metres are needed)");
        asdic_mesh_destroy(&mesh);
    }
}

static void holes(void **state) {
    (void)state;
    /* GDAL writes the marker with other digits in the header than in the rows */
    mesh_rig_write(&rig, "g.asc",
                   "ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 1\n"
                   "NODATA_value  -3.4028234663852886e+38\n"
                   "1 1 1\n1 -3.40282346639e+38 1\n1 1 nan\n");
    asdic_mesh *mesh = load(true);
    /* three corners of the quads round the middle are left, two of the one with the NAN */
    assert_int_equal(asdic_mesh_get_info(mesh).triangles, 3);
    assert_int_equal(asdic_mesh_get_info(mesh).vertices, 7);
    assert_true(isinf(depth_at(mesh, 1.5, 1.5)));
    assert_close(depth_at(mesh, 2.4, 0.6), 1.0, 1e-6);
    asdic_mesh_destroy(&mesh);
}

/* -9999 is the format's marker where the header has none, and a number where it has another. */
static void holes_have_a_marker_without_a_header(void **state) {
    (void)state;
    static const char *const headers[] = {"", "NODATA_value -1\n"};
    for (size_t i = 0; i < sizeof headers / sizeof *headers; i++) {
        char text[256];
        snprintf(text, sizeof text,
                 "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n%s"
                 "1 1 1\n1 1 -9999\n",
                 headers[i]);
        mesh_rig_write(&rig, "g.asc", text);
        asdic_mesh *mesh = load(true);
        assert_int_equal(asdic_mesh_get_info(mesh).vertices, i == 0 ? 5 : 6);
        assert_close(asdic_mesh_get_info(mesh).min_m.z, i == 0 ? 1.0 : -9999.0, 0.0);
        asdic_mesh_destroy(&mesh);
    }
}

static void holes_may_be_no_numbers(void **state) {
    (void)state;
    static const char *const markers[] = {"nan", "-nan", "NaN"};
    for (size_t i = 0; i < sizeof markers / sizeof *markers; i++) {
        char text[256];
        snprintf(text, sizeof text,
                 "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value %s\n"
                 "1 1 1\n1 1 %s\n",
                 markers[i], markers[i]);
        mesh_rig_write(&rig, "g.asc", text);
        asdic_mesh *mesh = load(true);
        assert_int_equal(asdic_mesh_get_info(mesh).vertices, 5);
        asdic_mesh_destroy(&mesh);
    }
}

#define HEAD "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n"

/* What is wrong with the header as a whole has no line. */
static void refusals(void **state) {
    (void)state;
    refuse("", "empty");
    refuse(HEAD, "header");
    refuse(HEAD "1 2\n3\n", "row 1, column 1");
    refuse(HEAD "1 2\n3 x\n", ":7: row 1, column 1");
    refuse(HEAD "1 2\n3 inf\n", ":7: row 1, column 1");
    refuse(HEAD "1 2\n3 4\n5\n", ":8: more than 4 values");
    refuse("ncols 100000\nnrows 100000\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n",
           "g.asc: 100000 x 100000 values do not fit");
    refuse("ncols 1e300\nnrows 1e300\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n",
           "g.asc: 1e+300 x 1e+300 values do not fit");
    refuse("ncols -2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n3 4\n",
           "g.asc: ncols -2");
    refuse("ncols 2.5\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n3 4\n",
           "g.asc: ncols 2.5");
    refuse("ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\n1 2\n3 4\n",
           "g.asc: a cell of nan x nan is no cell; cellsize");
    refuse("ncols 2\nnrows 2\nxllcorner 0\ncellsize 1\n1 2\n3 4\n",
           "g.asc: xllcorner and yllcorner");
    refuse("ncols two\nnrows 2\n", ":1: 'ncols'");
    refuse("431200.00 5984300.00 -12.5\n431202.00 5984300.00 -12.6\n",
           "g.asc:1: no header of an ESRI ASCII grid");
    refuse("CDF\1", "g.asc: netCDF grids");
    refuse(HEAD "NODATA_value 7\n7 7\n7 7\n",
           "g.asc: 0 of 4 cells have a value, and no three that meet");
    refuse(HEAD "7 7\n7,5 7\n", ":7: row 1, column 0 is no finite number: 7,5; decimals stand");
}

static void locale_does_not_matter(void **state) {
    (void)state;
    if (!setlocale(LC_ALL, "de_DE.UTF-8") && !setlocale(LC_ALL, "fr_FR.UTF-8")) {
        skip();
    }
    mesh_rig_write(&rig, "g.asc",
                   "ncols 2\nnrows 2\nxllcorner 0.5\nyllcorner 0\ncellsize 0.5\n"
                   "1.5 1.5\n1.5 1.5\n");
    asdic_mesh *mesh = load(true);
    setlocale(LC_ALL, "C");
    assert_close(asdic_mesh_get_info(mesh).min_m.z, 1.5, 0.0);
    assert_close(asdic_mesh_get_info(mesh).min_m.y, 0.75, 0.0);
    asdic_mesh_destroy(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_run_south),
        cmocka_unit_test(facets_are_of_their_corners),
        cmocka_unit_test(heights_and_other_headers),
        cmocka_unit_test(a_mark_of_utf8_is_passed_over),
        cmocka_unit_test(degrees_are_hinted_at),
        cmocka_unit_test(holes),
        cmocka_unit_test(holes_have_a_marker_without_a_header),
        cmocka_unit_test(holes_may_be_no_numbers),
        cmocka_unit_test(refusals),
        cmocka_unit_test(locale_does_not_matter),
    };
    mesh_rig_open(&rig);
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    mesh_rig_close(&rig);
    return failed;
}
