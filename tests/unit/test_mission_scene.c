/*
 * The geometry that a scene file describes, and that of runs which take it from one another.
 */
#include "mission_rig.h"

#include "base/text.h"
#include "mission/mission.h"
#include "scene/scene.h"

#define DEG (3.14159265358979323846 / 180.0)
#define POSE "mission: {pose: {position_m: [0, 0, 3]}}\n"

static asdic_mission *load(workshop *w, const char *rest) {
    char text[4096];
    snprintf(text, sizeof text, SCENE "%s", rest);
    asdic_mission *m = load_text(w, text);
    if (!m) {
        print_error("%s", w->said);
    }
    assert_non_null(m);
    return m;
}

static void assert_box(const asdic_mission *m, size_t object, const double min[3],
                       const double max[3]) {
    const asdic_mission_object *o = asdic_mission_get_object(m, object);
    assert_close(o->min_m.x, min[0], 1e-9);
    assert_close(o->min_m.y, min[1], 1e-9);
    assert_close(o->min_m.z, min[2], 1e-9);
    assert_close(o->max_m.x, max[0], 1e-9);
    assert_close(o->max_m.y, max[1], 1e-9);
    assert_close(o->max_m.z, max[2], 1e-9);
}

/* A box is 12 triangles, a cylinder's axis is east, a plate's normal north; turned, the axes go with it. */
static void shapes_are_where_they_are_put(void **state) {
    workshop *w = *state;
    asdic_mission *m = load(
        w, "bottom: {mesh: floor, position_m: [0, 0, 50], type: mud}\n"
           "objects:\n"
           "  - {name: box, box: {size_m: [2, 4, 6]}, position_m: [10, 20, 30], type: rock}\n"
           "  - {name: turned, box: {size_m: [2, 4, 6]}, position_m: [10, 20, 30],\n"
           "     rotation_deg: [90, 0, 0]}\n"
           "  - {name: sphere, sphere: {radius_m: 2, segments: 8}, position_m: [11, 0, 9]}\n"
           "  - {name: more, sphere: {radius_m: 2, segments: 12}, position_m: [12, 0, 9]}\n"
           "  - {name: pipe, cylinder: {radius_m: 1, length_m: 6, segments: 8}, position_m: [9, 0, "
           "9]}\n"
           "  - {name: plate, plate: {size_m: [4, 2]}, position_m: [7, 8, 9]}\n"
           "  - {name: wedge, mesh: wedge, position_m: [20, 30, 40], rotation_deg: [0, 0, 90]}\n"
           "  - {name: fish, point: -20, position_m: [1, 2, 3]}\n" POSE);
    static const struct {
        const char *name;
        double min_m[3], max_m[3];
    } boxes[] = {
        {"", {-90, -90, 50}, {90, 90, 50}},    {"box", {9, 18, 27}, {11, 22, 33}},
        {"turned", {9, 17, 28}, {11, 23, 32}}, {"sphere", {9, -2, 7}, {13, 2, 11}},
        {"more", {10, -2, 7}, {14, 2, 11}},    {"pipe", {8, -3, 8}, {10, 3, 10}},
        {"plate", {7, 6, 8}, {7, 10, 10}},     {"wedge", {17.8, 30.1, 40.3}, {19.8, 30.4, 40.6}},
        {"fish", {1, 2, 3}, {1, 2, 3}}};
    assert_string_equal(w->said, "");
    assert_int_equal(asdic_mission_object_count(m), 9);
    for (size_t i = 0; i < 9; i++) {
        assert_string_equal(asdic_mission_get_object(m, i)->name, boxes[i].name);
        assert_false(asdic_mission_get_object(m, i)->moves);
        assert_box(m, i, boxes[i].min_m, boxes[i].max_m);
    }
    const asdic_mission_object *o = m->objects;
    assert_int_equal(o[1].mesh.triangles, 12);
    assert_int_equal(o[8].mesh.triangles, 0);
    assert_true(o[4].mesh.triangles > o[3].mesh.triangles);
    assert_close(o[2].pose.roll_rad, 90 * DEG, 1e-12);
    assert_close(asdic_material_get(&o[0].material, "type"), 1, 0);
    assert_close(asdic_material_get(&m->bottom, "type"), 1, 0);
    assert_close(asdic_material_get(&o[1].material, "type"), 4, 0);
    /* Sizes in the scene file are in metres; a file's may be in others, also one of 0.3 m. */
    assert_string_equal(o[1].mesh.hint, "");
    asdic_mission_destroy(&m);
    m = load(w, "bottom: none\nobjects:\n"
                "  - {name: pea, box: {size_m: [0.1, 0.1, 0.1]}, position_m: [9, 0, 9]}\n"
                "  - {name: bean, mesh: bean, position_m: [9, 3, 9]}\n" POSE);
    assert_string_equal(asdic_mission_get_object(m, 0)->mesh.hint, "");
    assert_contains(asdic_mission_get_object(m, 1)->mesh.hint, "0.3 m across");
    assert_int_equal(asdic_mission_scene(m)->has_surface, 1);
    asdic_mission_destroy(&m);
    /* A bottom may be 300 m wide; a body may, but is more likely one of 0.3 m in millimetres. */
    m = load(w, "bottom: {mesh: island, type: sand}\nobjects:\n"
                "  - {name: fish, mesh: island, position_m: [9, 3, 9]}\n"
                "  - {name: wall, box: {size_m: [1, 300, 1]}, position_m: [400, 0, 9]}\n" POSE);
    assert_string_equal(asdic_mission_get_object(m, 0)->mesh.hint, "");
    assert_string_equal(asdic_mission_get_object(m, 1)->mesh.hint,
                        "300 m across: millimetres? (scale 0.001)");
    assert_string_equal(asdic_mission_get_object(m, 2)->mesh.hint, "");
    asdic_mission_destroy(&m);
    m = load(w, "surface: {enabled: false}\nbottom: {depth_m: 12}\n" POSE);
    assert_false(asdic_mission_scene(m)->has_surface);
    assert_close(asdic_scene_get_info(m->scene).bottom_plane_depth_m, 12, 0);
    assert_int_equal(asdic_mission_object_count(m), 0);
    asdic_mission_destroy(&m);
}

/* On a track from (0, 0) at 0 s to (10, 20) at 10 s. Pings without a track of their own begin at 0 s. */
static void moving_objects_are_where_they_are_first(void **state) {
    workshop *w = *state;
    static const char objects[] = "bottom: none\nobjects:\n"
                                  "  - {name: other, point: -20, track: other.csv}\n"
                                  "  - {name: box, box: {size_m: [2, 4, 6]}, track: way.csv}\n"
                                  "  - {name: fish, point: -20, track: way.csv}\n";
    static const double ways_s[] = {0, 2, 5};
    write_track(w, "way.csv", "0,0,0,9,0,0,0\n10,10,20,9,0,0,0\n");
    write_track(w, "other.csv", "0,30,0,9,0,0,0\n10,30,0,9,0,0,0\n");
    for (size_t i = 0; i < 3; i++) {
        char text[600], rows[100];
        double t = ways_s[i];
        snprintf(rows, sizeof rows, "%g,0,0,9,0,0,0\n%g,1,0,9,0,0,0\n", t, t + 0.5);
        write_track(w, "sonar.csv", rows);
        snprintf(text, sizeof text, "%s%s", objects, i ? "mission: {track: sonar.csv}\n" : POSE);
        asdic_mission *m = load(w, text);
        const double fish[] = {t, 2 * t, 9};
        const double min[] = {t - 1, 2 * t - 2, 6}, max[] = {t + 1, 2 * t + 2, 12};
        assert_box(m, 1, min, max);
        assert_box(m, 2, fish, fish);
        assert_true(m->objects[1].moves && m->objects[2].moves);
        asdic_mission_destroy(&m);
    }
}

/* Each material has the rows of its own file; a file that is not there is named where it is given. */
static void materials_read_their_files(void **state) {
    workshop *w = *state;
    write_file(w, "a.csv", "grazing_deg,strength_db\n5,-40\n10,-30\n");
    write_file(w, "b.csv", "grazing_deg,strength_db\n5,-41\n20,-31\n40,-21\n");
    asdic_mission *m = load(w, "bottom: {depth_m: 12, curve: a.csv}\nobjects:\n"
                               "  - {name: o, box: {size_m: [1, 1, 1]}, position_m: [9, 0, 9],\n"
                               "     material: {curve: b.csv}}\n" POSE);
    const asdic_material *rows = &m->objects[0].material;
    assert_int_equal(m->bottom.row_count, 2);
    assert_close(m->bottom.rows[3], -30, 0);
    assert_int_equal(rows->row_count, 3);
    assert_close(rows->rows[5], -21, 0);
    assert_int_equal(m->row_files, 2);
    asdic_mission_destroy(&m);
    static const struct {
        const char *rest, *said;
    } wrong[] = {
        {"bottom: {depth_m: 12, curve: none.csv}\n" POSE, "  [bottom.curve]\n"},
        {"bottom: {grid: none.asc}\n" POSE, "  [bottom.grid.file]\n"},
        {"bottom: {mesh: none.obj}\n" POSE, "  [bottom.mesh.file]\n"},
        {"bottom: none\nobjects:\n"
         "  - {name: o, mesh: none.obj, position_m: [9, 0, 9]}\n" POSE,
         "  [objects[0].mesh.file]\n"},
        {"bottom: none\nobjects:\n  - {name: o, box: {size_m: [1, 1, 1]}, position_m: [9, 0, 9],\n"
         "     material: {curve: none.csv}}\n" POSE,
         "  [objects[0].material.curve]\n"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_contains(said_of(w, wrong[i].rest), wrong[i].said);
        assert_contains(w->said, "none.");
        assert_null(strstr(strchr(w->said, '\n') + 1, "error")); /* once */
    }
}

/* Echoes come from c / (2 ping_rate_hz), of the sound speed where the sonar is at first, however that
 * is said: 20 m down 1490 or 1510 m/s. */
static void range_is_that_of_the_sonars_depth(void **state) {
    workshop *w = *state;
    static const char *const places[] = {
        "pose: {position_m: [0, 0, 20]}", "track: sonar.csv", "waypoints: [[0, 0, 20], [9, 0, 20]]",
        "waypoints: {points_m: [[0, 0, 1], [9, 0, 1]], altitude_m: 80}"};
    write_track(w, "sonar.csv", "0,0,0,20,0,0,0\n1,1,0,20,0,0,0\n");
    for (size_t i = 0; i < 2 * sizeof places / sizeof *places; i++) {
        char text[600];
        bool is_less = i % 2;
        snprintf(
            text, sizeof text,
            "version: 1\nbottom: {depth_m: 100}\nenvironment: {sound_speed_mps: 1500,\n"
            "  sound_speed_gradient_per_s: %s}\nsonar: {frequency_khz: 100, ping_rate_hz: 10,\n"
            "  max_range_m: %s, source_level_db: 0, receivers: [{name: a}]}\nmission: {%s}\n",
            is_less ? "-0.5" : "0.5", is_less ? "74.6" : "75.4", places[i / 2]);
        asdic_mission *m = load_text(w, text);
        assert_int_equal(m == NULL, is_less);
        if (is_less) {
            assert_contains(w->said, "'max_range_m' = 74.6 is more than the 74.5 m");
        }
        asdic_mission_destroy(&m);
    }
}

/* --- runs that take it over --------------------------------------------------------------------- */

static const char DRAWS[] = "mission: {waypoints: {points_m: [[0, 0, 3], [60, 0, 3]]}}\n"
                            "trial: {draws: [{key: '%s', uniform: [%g, %g]}]}\n";

static void write_scene(const workshop *w, const char *rest, const char *key, double from,
                        double to) {
    char text[4096] = SCENE;
    strcat(text, rest);
    snprintf(text + strlen(text), sizeof text - strlen(text), DRAWS, key, from, to);
    write_file(w, "scene.yaml", text);
}

static asdic_mission *load_run(const workshop *w, uint64_t run, asdic_mission *donor) {
    const asdic_draw draw = {.seed = 1, .run = run};
    char path[128];
    asdic_mission *m = NULL;
    snprintf(path, sizeof path, "%s/scene.yaml", w->folder);
    assert_ok(w->ctx, asdic_mission_load_trial(w->ctx, path, NULL, 0, &draw, donor, &m));
    return m;
}

/* What a run takes of the one before: all, the ground, nothing. What it draws is where it says. */
static void runs_take_what_is_the_same(void **state) {
    workshop *w = *state;
    static const char grid[] = "{grid: ground.asc, type: mud, position_m: [0, 0, 3]}\nobjects:\n";
    static const char ball[] =
        "  - {name: a, box: {size_m: [2, 2, 2]}, position_m: [30, 30, 5], type: rock}\n";
    static const char moves[] = "  - {name: b, box: {size_m: [2, 2, 2]}, track: way.csv}\n";
    static const char curve[] = "  - {name: c, box: {size_m: [2, 2, 2]}, position_m: [9, 9, 5], "
                                "material: {curve: a.csv}}\n";
    enum { ALL, GROUND, NOTHING };
    static const struct {
        const char *bottom, *objects, *key;
        int taken;
    } cases[] = {
        {grid, "", "environment.wind_speed_kn", ALL},
        {"{depth_m: 12, type: mud}\nobjects:\n", "", "environment.wind_speed_kn", ALL},
        {grid, "", "objects[0].position_m[0]", GROUND},
        {"{depth_m: 12, type: mud}\nobjects:\n", "", "objects[0].position_m[0]", NOTHING},
        {grid, "", "bottom.position_m[2]", NOTHING},
        {grid, moves, "environment.wind_speed_kn", GROUND},
        {grid, curve, "environment.wind_speed_kn", NOTHING},
    };
    write_file(w, "ground.asc",
               "ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 40\n9 9 9\n9 9 9\n9 9 9\n");
    write_file(w, "a.csv", "grazing_deg,strength_db\n5,-40\n10,-30\n");
    write_track(w, "way.csv", "0,0,0,5,0,0,0\n10,10,20,5,0,0,0\n");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char rest[1024];
        snprintf(rest, sizeof rest, "bottom: %s%s%s", cases[i].bottom, ball, cases[i].objects);
        bool drawn = strstr(cases[i].key, "[0]") != NULL;
        size_t at = cases[i].bottom == grid;
        write_scene(w, rest, cases[i].key, 2, 4);
        asdic_mission *first = load_run(w, 1, NULL), *second;
        const asdic_scene *scene = first->scene;
        size_t count = first->object_count, triangles = first->scene->triangle_count;
        assert_int_equal(count, 1 + at + (*cases[i].objects != '\0'));
        second = load_run(w, 2, first);
        assert_int_equal(second->scene == scene, cases[i].taken != NOTHING);
        assert_int_equal(first->scene == NULL, cases[i].taken != NOTHING);
        assert_int_equal(first->objects == NULL, cases[i].taken == ALL);
        assert_int_equal(second->object_count, count);
        assert_int_equal(second->scene->triangle_count, triangles);
        assert_string_equal(second->objects[at].name, "a");
        assert_string_equal(second->objects[0].name, at ? "" : "a");
        assert_close(asdic_material_get(&second->objects[at].material, "type"), 4, 0);
        assert_close(asdic_material_get(&second->bottom, "type"), 1, 0);
        double x_m = drawn ? atof(asdic_mission_drawn(second, 0).value) : 30;
        assert_close(second->objects[at].pose.position_m.x, x_m, 1e-12);
        assert_close(second->objects[at].min_m.x, x_m - 1, 1e-12);
        asdic_mission_destroy(&first);
        asdic_mission_destroy(&second);
    }
    /* A mission of its own gives nothing. */
    char path[128];
    asdic_mission *own = NULL;
    snprintf(path, sizeof path, "%s/scene.yaml", w->folder);
    assert_ok(w->ctx, asdic_mission_load(w->ctx, path, &own));
    asdic_mission *run = load_run(w, 1, own);
    assert_true(own->scene && own->scene != run->scene);
    asdic_mission_destroy(&own);
    asdic_mission_destroy(&run);
}

/* Another file under the same name, another scale and another direction upward
 * are read anew. */
static void runs_take_no_mesh_that_is_another(void **state) {
    workshop *w = *state;
    static const struct {
        const char *mesh, *more;
        double wide_m, high_m;
    } cases[] = {
        {"v 0 0 0\nv 1 0 0\nv 0 1 4\nf 1 2 3\n", "", 1, 4},
        {NULL, "", 1, 4},
        {"v 0 0 0\nv 2.0 0 0\nv 0 2 4\nf 1 2 3\n", "", 2, 4},
        {NULL, ", scale: 3", 6, 12},
        {"v 0 0 0\nv 2 0 0\nv 0 2 4\nv 5 5 5\nf 1 2 3\nf 1 2 4\n", ", scale: 3", 15, 15},
        {NULL, ", scale: 3, z_up: false", 15, 15},
        {NULL, ", scale: 1, z_up: false", 5, 5},
    };
    asdic_mission *before = NULL;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char rest[400];
        if (cases[i].mesh) {
            write_file(w, "m.obj", cases[i].mesh);
        }
        snprintf(rest, sizeof rest,
                 "bottom: none\nobjects:\n  - {name: a, mesh: {file: m.obj%s}, position_m: [30, "
                 "30, 50], "
                 "type: rock}\n",
                 cases[i].more);
        write_scene(w, rest, "objects[0].position_m[0]", 20, 40);
        asdic_mission *now = load_run(w, i, before);
        const asdic_mission_object *o = asdic_mission_get_object(now, 0);
        assert_close(o->max_m.y - o->min_m.y, cases[i].wide_m, 1e-5);
        assert_close(o->max_m.z - o->min_m.z, cases[i].high_m, 1e-5);
        bool is_up = strstr(cases[i].more, "z_up") == NULL;
        assert_close(is_up ? o->max_m.z : o->min_m.z, 50, 1e-5);
        asdic_mission_destroy(&before);
        before = now;
    }
    asdic_mission_destroy(&before);
}

/* Of one of many runs whose scenes differ in places alone the scene is the first one's; the box is moved, and is a
 * cube over the old one's diagonal, sqrt(1 + 4 + 9) to each side, where the object is turned. */
static void runs_of_many_borrow_their_scene(void **state) {
    workshop *w = *state;
    char path[128], rest[600];
    asdic_mission *runs[3] = {NULL};
    snprintf(path, sizeof path, "%s/scene.yaml", w->folder);
    for (uint64_t i = 0; i < 3; i++) {
        const asdic_draw draw = {.seed = 1, .run = i};
        const asdic_mission *bases[] = {NULL, runs[0], NULL};
        snprintf(rest, sizeof rest,
                 SCENE "bottom: {grid: ground.asc, type: mud}\nobjects:\n"
                       "  - {name: still, point: -10, position_m: [8, 8, 8]}\n"
                       "  - {name: a, box: {size_m: [2, 4, 6]}, position_m: [%d, 20, 5],\n"
                       "     rotation_deg: [0, 0, %d]}\n"
                       "mission: {pose: {position_m: [0, 0, %d]}}\n",
                 30 + (int)i, i == 2 ? 45 : 0, 3 + (int)i);
        write_file(w, "scene.yaml", rest);
        assert_ok(w->ctx, asdic_mission_load_like(w->ctx, path, &draw, bases, 3, false, &runs[i]));
        assert_int_equal(runs[i]->stands_anywhere, 1);
        assert_ptr_equal(runs[i]->base, i ? runs[0] : NULL);
        assert_ptr_equal(runs[i]->scene, runs[0]->scene);
        assert_int_equal(runs[i]->object_count, 3);
        assert_string_equal(runs[i]->objects[0].name, "");
        assert_close(asdic_material_get(&runs[i]->bottom, "type"), 1, 0);
        assert_close(runs[i]->objects[2].pose.position_m.x, 30 + (double)i, 0);
        assert_close(runs[i]->pose.position_m.z, 3 + (double)i, 0);
    }
    const double half = sqrt(14.0);
    const double fish[3] = {8, 8, 8};
    static const double min[2][3] = {{29, 18, 2}, {30, 18, 2}},
                        max[2][3] = {{31, 22, 8}, {32, 22, 8}};
    const double low[3] = {32 - half, 20 - half, 5 - half},
                 high[3] = {32 + half, 20 + half, 5 + half};
    assert_box(runs[0], 2, min[0], max[0]);
    assert_box(runs[1], 2, min[1], max[1]);
    assert_box(runs[2], 2, low, high);
    assert_box(runs[1], 1, fish, fish);
    for (size_t i = 3; i-- > 0;) {
        asdic_mission_destroy(&runs[i]);
    }
}

/* Half a wavelength of 100 kHz at the surface, 5 us long, in water that is faster by 1 m/s a metre: at rest or on the
 * way, as many runs make it and as a recording is written. */
static void an_array_is_of_one_size(void **state) {
    workshop *w = *state;
    static const char *const where[] = {"pose: {position_m: [0, 0, 10]}",
                                        "pose: {position_m: [0, 0, 60]}",
                                        "waypoints: [[0, 0, 60], [9, 0, 60]]"};
    for (size_t i = 0; i < sizeof where / sizeof *where; i++) {
        char text[600], path[128], again[128], track[128];
        const asdic_draw draw = {.seed = 1};
        asdic_mission *m[3] = {NULL};
        snprintf(path, sizeof path, "%s/scene.yaml", w->folder);
        snprintf(again, sizeof again, "%s/again.yaml", w->folder);
        snprintf(track, sizeof track, "%s/track.csv", w->folder);
        snprintf(text, sizeof text,
                 "version: 1\nbottom: {depth_m: 90}\nmission: {%s}\n"
                 "environment: {sound_speed_profile: [[0, 1500], [100, 1600]]}\n"
                 "sonar: {frequency_khz: 100, array: {elements: 8, beams: {count: 2, sector_deg: "
                 "20}}}\n",
                 where[i]);
        write_file(w, "scene.yaml", text);
        assert_ok(w->ctx, asdic_mission_load(w->ctx, path, &m[0]));
        assert_ok(w->ctx, asdic_mission_load_like(w->ctx, path, &draw, NULL, 0, false, &m[1]));
        assert_ok(w->ctx, asdic_mission_write_scene(w->ctx, m[0], again, "track.csv"));
        assert_ok(w->ctx, asdic_mission_write_track(w->ctx, m[0], track));
        assert_ok(w->ctx, asdic_mission_load(w->ctx, again, &m[2]));
        for (size_t k = 0; k < 3; k++) {
            const asdic_sonar *sonar = asdic_mission_sonar(m[k]);
            assert_close(sonar->array.spacing_m, 5e-6 * 1500, 1e-12);
            assert_close(sonar->array.element.length_h_m, 5e-6 * 1500, 1e-12);
            const asdic_beam *receivers = asdic_mission_sonar(m[0])->receivers;
            assert_true(sonar->receivers[0].sensitivity_db == receivers[0].sensitivity_db);
        }
        for (size_t k = 0; k < 3; k++) {
            asdic_mission_destroy(&m[k]);
        }
    }
}

/* A floor of 180 by 180 m at depth 0; a wedge whose corner is off its origin; a bean 0.3 m long;
 * an island 300 m long. */
static int begin_with_meshes(void **state) {
    static const double floor[6][3] = {{-90, -90, 0}, {90, -90, 0}, {90, 90, 0},
                                       {-90, -90, 0}, {90, 90, 0},  {-90, 90, 0}};
    static const double wedge[3][3] = {{0.1, 0.2, 0.3}, {0.4, 0.2, 0.3}, {0.1, 2.2, 0.6}};
    static const double bean[3][3] = {{0, 0, 0}, {0.3, 0, 0}, {0, 0.2, 0.1}};
    static const double island[3][3] = {{0, 0, 9}, {300, 0, 9}, {0, 200, 9}};
    if (begin(state)) {
        return -1;
    }
    add_mesh(*state, "floor", floor, 2);
    add_mesh(*state, "wedge", wedge, 1);
    add_mesh(*state, "bean", bean, 1);
    add_mesh(*state, "island", island, 1);
    return 0;
}

/* What a program does not set is what a scene file does not. */
static void programs_have_the_defaults_of_scenes(void **state) {
    workshop *w = *state;
    asdic_mission *m = load_text(w, "version: 1\nbottom: {depth_m: 12}\n" POSE
                                    "sonar: {frequency_khz: 100, receivers: [{name: a}]}\n");
    assert_non_null(m);
    const asdic_sonar *s = asdic_mission_sonar(m), own = asdic_sonar_default();
    assert_true(s->frequency_hz == own.frequency_hz && s->bandwidth_hz == own.bandwidth_hz);
    assert_true(s->ping_rate_hz == own.ping_rate_hz && isnan(s->max_range_m + own.max_range_m));
    assert_true(s->source_level_db == own.source_level_db && s->blanking_m == own.blanking_m);
    assert_true(s->bin_length_m == own.bin_length_m && s->rear_floor_db == own.rear_floor_db);
    assert_int_equal(s->noise_enabled, own.noise_enabled);
    assert_int_equal(s->noise_directivity, own.noise_directivity);
    assert_true(s->speckle == own.speckle && s->speckle_shape == own.speckle_shape);
    assert_int_equal(s->array.elements, own.array.elements);
    const asdic_beam *const apertures[] = {&s->transmitter, s->receivers};
    for (size_t i = 0; i < 2; i++) {
        const asdic_beam *a = apertures[i], *b = &own.transmitter;
        assert_true(a->length_h_m == b->length_h_m && a->length_v_m == b->length_v_m);
        assert_true(a->pitch_rad == b->pitch_rad && a->yaw_rad == b->yaw_rad);
        assert_true(a->roll_rad == b->roll_rad);
    }
    const asdic_environment *e = asdic_mission_environment(m), water = asdic_environment_default();
    assert_true(e->temperature_degc == water.temperature_degc && e->ph == water.ph);
    assert_true(e->salinity_ppt == water.salinity_ppt && e->wind_speed_kn == water.wind_speed_kn);
    assert_true(e->shipping_density == water.shipping_density && e->variant == water.variant);
    assert_true(e->particle_strength_db == water.particle_strength_db);
    assert_true(e->refraction == water.refraction && isnan(e->max_depth_m + water.max_depth_m));
    assert_true(isnan(e->sound_speed_mps + water.sound_speed_mps));
    assert_true(e->sound_speed_gradient_per_s == water.sound_speed_gradient_per_s);
    assert_int_equal(e->sound_speed_profile.points, water.sound_speed_profile.points);
    const asdic_sampling *r = asdic_mission_sampling(m), rays = asdic_sampling_default();
    assert_true(r->sampler == rays.sampler && r->multipath == rays.multipath);
    assert_true(r->seed == rays.seed && r->coherent == rays.coherent && r->truth == rays.truth);
    asdic_mission_destroy(&m);
}

enum { REFRACTED_BINS = 10 };

/* Levels of bin N, and where echoes come a fortieth of a bin earlier or later. */
static void shifted(const double *lin, size_t n, double out[3]) {
    out[0] = lin[n];
    out[1] = n + 1 < REFRACTED_BINS ? lin[n] + (lin[n + 1] - lin[n]) / 40.0 : lin[n];
    out[2] = n > 0 ? lin[n] + (lin[n - 1] - lin[n]) / 40.0 : lin[n];
}

/* By how much A and B differ in bin N whatever echoes are shifted so, dB. */
static double apart_db(const double *a, const double *b, size_t n) {
    double x[3], y[3], least = INFINITY, most = -INFINITY;
    shifted(a, n, x);
    shifted(b, n, y);
    for (int i = 0; i < 9; i++) {
        double db = 10.0 * log10(x[i / 3] / y[i % 3]);
        least = fmin(least, db);
        most = fmax(most, db);
    }
    return least * most < 0.0 ? 0.0 : fmin(fabs(least), fabs(most));
}

/* By how much totals change at PING where rays follow FORM in place of all layers: of the first, middle and last beam. */
static double change_of(workshop *w, const asdic_mission *m, size_t ping, asdic_refraction form,
                        const double span_m[2]) {
    const asdic_sonar *all = asdic_mission_sonar(m);
    asdic_sonar sonar = *all;
    asdic_beam three[3];
    double worst_db = 0.0;
    sonar.receivers = three;
    sonar.receiver_count = all->receiver_count == 5 ? 3 : 1;
    for (size_t b = 0; b < sonar.receiver_count; b++) {
        three[b] = all->receivers[2 * b];
    }
    asdic_environment env = *asdic_mission_environment(m);
    asdic_flat_scene flat = asdic_mission_flat_scene(m, ping);
    asdic_pose pose = asdic_mission_pose(m, ping, NULL);
    asdic_ping *pings[2];
    env.layer_from_m = span_m[0];
    env.layer_to_m = span_m[1];
    for (int k = 0; k < 2; k++) {
        env.refraction = k == 0 ? ASDIC_REFRACTION_FULL : form;
        assert_ok(w->ctx,
                  asdic_ping_create(w->ctx, sonar.receiver_count, REFRACTED_BINS, &pings[k]));
        assert_ok(w->ctx, asdic_expected_compute(w->ctx, &flat, &env, &sonar, &pose, pings[k]));
    }
    for (size_t i = 0; i < sonar.receiver_count * REFRACTED_BINS; i++) {
        size_t n = i % REFRACTED_BINS;
        const double *a = pings[0]->intensity_lin[ASDIC_TOTAL] + (i - n);
        const double *b = pings[1]->intensity_lin[ASDIC_TOTAL] + (i - n);
        worst_db = a[n] > 0.0 || b[n] > 0.0 ? fmax(worst_db, apart_db(a, b, n)) : worst_db;
    }
    asdic_ping_destroy(&pings[0]);
    asdic_ping_destroy(&pings[1]);
    return worst_db;
}

/* How near what is expected of many places is to what is of one. */
#define QUICK_DB 0.01

/* By what the forms change at the shallowest, deepest, first, middle and last ping, a quarter more for what lies between;
 * the layer is fitted from the shallowest sonar to the deepest bottom, or 10 m about the sonars where there is none. */
static void refraction_is_as_much_as_is_needed(void **state) {
    workshop *w = *state;
#define FAN "{fan: {count: 5, sector_deg: 120, pitch_deg: 10}}"
#define WIDE "{fan: {count: 5, sector_deg: 120, pitch_deg: 10, length_h_m: 20}}"
#define SHALLOW "{track: shallow.csv}"
#define DEEP "{track: deep.csv}"
#define PLACE "{pose: {position_m: [0, 0, 4]}}"
    static const struct {
        const char *profile, *bottom, *receivers, *mission;
        double span_m[2];
        size_t worst[2]; /* pings: straight rays, one layer */
        asdic_refraction needed;
    } cases[] = {
        {"[[0, 1500], [40, 1500]]",
         "{depth_m: 25}",
         FAN,
         PLACE,
         {0, 0},
         {0, 0},
         ASDIC_REFRACTION_OFF},
        {"[[0, 1500], [40, 1500.001]]",
         "{depth_m: 25}",
         FAN,
         PLACE,
         {4, 25},
         {0, 0},
         ASDIC_REFRACTION_OFF},
        {"[[0, 1500], [40, 1470]]",
         "{depth_m: 25}",
         FAN,
         PLACE,
         {4, 25},
         {0, 0},
         ASDIC_REFRACTION_LAYER},
        {"[[0, 1500], [40, 1470]]",
         "{depth_m: 25}",
         "[{name: a}]",
         "{pose: {position_m: [0, 0, 25]}}",
         {15, 25},
         {0, 0},
         ASDIC_REFRACTION_LAYER},
        {"[[0, 1500], [8, 1500], [9, 1480], [40, 1480]]",
         "{depth_m: 25}",
         WIDE,
         PLACE,
         {4, 25},
         {0, 0},
         ASDIC_REFRACTION_FULL},
        {"[[0, 1500], [8, 1500], [9, 1480], [40, 1480]]",
         "{depth_m: 25}",
         FAN,
         PLACE,
         {4, 25},
         {0, 0},
         ASDIC_REFRACTION_FULL},
        {"[[0, 1500], [4.5, 1480], [40, 1480]]",
         "none",
         "[{name: a}]",
         SHALLOW,
         {0, 17},
         {2, 2},
         ASDIC_REFRACTION_FULL},
        {"[[0, 1480], [18, 1480], [20, 1510], [40, 1510]]",
         "none",
         "[{name: a}]",
         DEEP,
         {0, 29},
         {2, 0},
         ASDIC_REFRACTION_FULL},
    };
    write_track(w, "shallow.csv", "0,0,0,7,0,0,0\n1,1,0,6,0,0,0\n2,2,0,4,0,0,0\n3,3,0,5,0,0,0\n");
    write_track(w, "deep.csv", "0,0,0,5,0,0,0\n1,1,0,6,0,0,0\n2,2,0,19,0,0,0\n3,3,0,6,0,0,0\n");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[1024];
        asdic_refraction_plan plan;
        bool bends = cases[i].span_m[1] > 0.0;
        snprintf(text, sizeof text,
                 "version: 1\nenvironment: {sound_speed_profile: %s}\n"
                 "sonar: {frequency_khz: 20, ping_rate_hz: 1, max_range_m: 40, bin_length_m: 4,\n"
                 "  source_level_db: 220, receivers: %s}\nbottom: %s\nmission: %s\n",
                 cases[i].profile, cases[i].receivers, cases[i].bottom, cases[i].mission);
        asdic_mission *m = load_text(w, text);
        assert_non_null(m);
        assert_ok(w->ctx, asdic_mission_refraction(w->ctx, m, &plan));
        assert_int_equal(plan.needed, cases[i].needed);
        assert_close(plan.layer_from_m, cases[i].span_m[0], 1e-9);
        assert_close(plan.layer_to_m, cases[i].span_m[1], 1e-9);
        if (bends) {
            const size_t *at = cases[i].worst;
            const double *span_m = cases[i].span_m;
            double off_db = change_of(w, m, at[0], ASDIC_REFRACTION_OFF, span_m);
            double layer_db = change_of(w, m, at[1], ASDIC_REFRACTION_LAYER, span_m);
            assert_close(plan.off_db, 1.25 * off_db, 1.25 * QUICK_DB);
            assert_close(plan.layer_db, 1.25 * layer_db, 1.25 * QUICK_DB);
            const double changes_db[] = {plan.off_db, plan.layer_db};
            char said[2][32];
            for (int k = 0; k < 2; k++) {
                snprintf(said[k], sizeof said[k],
                         changes_db[k] < 0.001 ? "less than 0.001 dB" : "up to %.3g dB",
                         changes_db[k]);
            }
            snprintf(text, sizeof text,
                     "straight rays would change a level by %s, "
                     "one layer fitted from %g to %g m would change a level by %s",
                     said[0], cases[i].span_m[0], cases[i].span_m[1], said[1]);
            assert_ptr_equal(strstr(plan.reason, text), plan.reason); /* nothing mirrors */
            assert_ok(w->ctx, asdic_mission_refract_as_needed(w->ctx, m));
            assert_int_equal(asdic_mission_environment(m)->refraction, cases[i].needed);
        } else {
            assert_close(plan.off_db + plan.layer_db, 0.0, 0.0);
            assert_contains(plan.reason, "same at all depths");
        }
        for (int form = 0; form <= ASDIC_REFRACTION_OFF; form++) {
            asdic_mission_refract(m, (asdic_refraction)form);
            const asdic_environment *e = asdic_mission_environment(m);
            assert_int_equal(e->refraction, form);
            assert_close(e->layer_from_m, bends ? cases[i].span_m[0] : 4.0, 1e-9);
            assert_close(e->layer_to_m, bends ? cases[i].span_m[1] : 25.0, 1e-9);
        }
        asdic_mission_destroy(&m);
    }
}

static double face_db(double length_wl, double sine) {
    double x = acos(-1.0) * length_wl * sine;
    return 20.0 * log10(sin(x) / x);
}

/* Open water whose expected levels hardly know of a gradient of 0.1 1/s; a point level with the sonar, ACROSS_M
 * away, is seen along a circle of the radius c / (g cos theta), through the upper flanks of faces 0.5 m high. */
static double point_change_db(double across_m) {
    const double speed_mps = 1505.0, gradient_per_s = 0.1, length_wl = 0.5 * 100e3 / speed_mps;
    double elevation = atan(0.5 * gradient_per_s * across_m / speed_mps);
    double faces_db = 2.0 * face_db(length_wl, sin(elevation));
    double spread_db = 40.0 * log10(cos(elevation)); /* S = (across / cos theta)^2, both ways */
    double range_m = speed_mps / gradient_per_s *
                     asinh(gradient_per_s * across_m / (speed_mps * cos(elevation)));
    return fabs(faces_db + spread_db) + 10.0 * log10(1.0 + fabs(across_m - range_m) / 5.0);
}

static void refraction_heeds_objects(void **state) {
    workshop *w = *state;
#define STAYS "{pose: {position_m: [0, 0, 50]}}"
    static const struct {
        const char *object, *mission;
        double across_m; /* 0: nothing to heed */
    } cases[] = {{"point: 10, position_m: [250, 0, 50]", STAYS, 250.0},
                 {"point: 10, position_m: [0, -120, 50]",
                  "{pose: {position_m: [0, 0, 50], yaw_deg: -90}}", 120.0},
                 {"sphere: {radius_m: 1}, position_m: [247.5, 35.27, 50]", STAYS, 250.0},
                 {"point: 10, track: object.csv", "{track: sonar.csv}", 250.0},
                 {"point: 10, position_m: [320, 0, 50]", STAYS, 0.0},
                 {"point: 10, position_m: [10, 0, 50]", STAYS, 0.0}};
    write_track(w, "sonar.csv", "0,0,0,50,0,0,0\n4,0,0,50,0,0,0\n");
    write_track(w, "object.csv", "0,500,0,50,0,0,0\n4,250,0,50,0,0,0\n");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[1024];
        asdic_refraction_plan plan;
        snprintf(text, sizeof text,
                 "version: 1\nenvironment: {sound_speed_profile: [[0, 1500], [1000, 1600]]}\n"
                 "surface: {enabled: false}\nbottom: none\nobjects: [{name: a, %s}]\nmission: %s\n"
                 "sonar: {frequency_khz: 100, ping_rate_hz: 2, max_range_m: 300, bin_length_m: 5,\n"
                 "  transmitter: {length_v_m: 0.5}, receivers: [{length_v_m: 0.5}]}\n",
                 cases[i].object, cases[i].mission);
        asdic_mission *m = load_text(w, text);
        assert_non_null(m);
        assert_ok(w->ctx, asdic_mission_refraction(w->ctx, m, &plan));
        bool heeded = cases[i].across_m > 0.0;
        bool mirrors = strstr(plan.reason, "echoes over mirrors aside, ");
        assert_true(mirrors == (strstr(cases[i].object, "sphere") != NULL));
        double change_db = heeded ? point_change_db(cases[i].across_m) : 0.0;
        assert_int_equal(plan.needed, heeded ? ASDIC_REFRACTION_LAYER : ASDIC_REFRACTION_OFF);
        assert_close(plan.off_db, 1.25 * change_db, 0.01);
        assert_true(plan.layer_db < 0.001);
        asdic_mission_destroy(&m);
    }
}

/* The 32nd of so many points is the only one far away; of 33 every second one is looked at. */
static void of_many_objects_some_are_heeded(void **state) {
    workshop *w = *state;
    for (int count = 32; count <= 33; count++) {
        asdic_text text = {0};
        asdic_refraction_plan plan;
        asdic_text_add(&text,
                       "version: 1\n"
                       "environment: {sound_speed_profile: [[0, 1500], [1000, 1600]]}\n"
                       "surface: {enabled: false}\nbottom: none\nmission: " STAYS "\nobjects:\n");
        for (int i = 0; i < count; i++) {
            asdic_text_format(&text, "  - {point: 10, position_m: [%d, 0, 50]}\n",
                              i == 31 ? 250 : 10);
        }
        asdic_text_add(&text,
                       "sonar: {frequency_khz: 100, ping_rate_hz: 2, max_range_m: 300,\n"
                       "  bin_length_m: 5, transmitter: {length_v_m: 0.5}, receivers: [{}]}\n");
        asdic_mission *m = load_text(w, text.data);
        assert_non_null(m);
        assert_ok(w->ctx, asdic_mission_refraction(w->ctx, m, &plan));
        assert_int_equal(plan.needed, count == 32 ? ASDIC_REFRACTION_LAYER : ASDIC_REFRACTION_OFF);
        asdic_mission_destroy(&m);
        asdic_text_finish(&text);
    }
}

/* Rays that turn away from the surface leave a shadow: 187 m away here, between 2 and 1 m deep. */
static void a_shadow_hides_an_object(void **state) {
    workshop *w = *state;
    for (int across_m = 180; across_m <= 195; across_m += 15) {
        char text[1024];
        asdic_refraction_plan plan;
        snprintf(text, sizeof text,
                 "version: 1\nenvironment: {sound_speed_profile: [[0, 1500], [100, 1450]]}\n"
                 "bottom: none\nobjects: [{name: a, point: 10, position_m: [%d, 0, 1]}]\n"
                 "mission: {pose: {position_m: [0, 0, 2]}}\n"
                 "sonar: {frequency_khz: 100, ping_rate_hz: 2, max_range_m: 300, bin_length_m: 5,\n"
                 "  receivers: [{}]}\n",
                 across_m);
        asdic_mission *m = load_text(w, text);
        assert_non_null(m);
        assert_ok(w->ctx, asdic_mission_refraction(w->ctx, m, &plan));
        assert_int_equal(isinf(plan.off_db) != 0, across_m > 187);
        assert_int_equal(
            strstr(plan.reason, "straight rays would move an object into or out of a shadow") !=
                NULL,
            across_m > 187);
        asdic_mission_destroy(&m);
    }
}

/* The bottom's first echo comes on a bin's edge, a few micrometres nearer by all layers: nothing that a user sees. A degree
 * a metre shifts it by a part of a bin, and more. */
static void an_echo_on_an_edge_is_no_change(void **state) {
    workshop *w = *state;
    static const struct {
        const char *profile;
        double most_db;
        asdic_refraction needed;
    } cases[] = {
        {"[[0, 1490], [3, 1490.05], [9, 1490.1], [20, 1490.3]]", 0.05, ASDIC_REFRACTION_OFF},
        {"[[0, 1490], [6, 1490], [9, 1478], [20, 1478]]", 40.0, ASDIC_REFRACTION_FULL}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[1024];
        asdic_refraction_plan plan;
        snprintf(text, sizeof text,
                 "version: 1\nenvironment: {sound_speed_profile: %s}\n"
                 "bottom: {depth_m: 12, type: sand}\nmission: {pose: {position_m: [0, 0, 7]}}\n"
                 "sonar: {frequency_khz: 750, ping_rate_hz: 15, max_range_m: 12,\n"
                 "  bin_length_m: 0.1, blanking_m: 0.5, source_level_db: 200,\n"
                 "  transmitter: {length_h_m: 0.00097, length_v_m: 0.00507},\n"
                 "  receivers: [{length_h_m: 0.10086, length_v_m: 0.00507}]}\n",
                 cases[i].profile);
        asdic_mission *m = load_text(w, text);
        assert_non_null(m);
        assert_ok(w->ctx, asdic_mission_refraction(w->ctx, m, &plan));
        print_message("%s\n", plan.reason);
        assert_true(plan.off_db <= cases[i].most_db);
        assert_int_equal(plan.needed, cases[i].needed);
        asdic_mission_destroy(&m);
    }
}

static void count_expectations(void *user, const char *what, size_t done, size_t total) {
    size_t *count = user;
    assert_true(done < total);
    *count += strcmp(what, "expected pings") == 0;
}

/* Three forms at each place that is another: a vehicle that flies level and turns has one, of all its pings. */
static void forms_are_compared_once_at_a_place(void **state) {
    workshop *w = *state;
    static const struct {
        const char *track;
        double deep_mps; /* sound speed 40 m deep */
        size_t places, chosen;
        asdic_refraction needed;
    } cases[] = {{"0,0,0,5,0,0,0\n9,9,0,5,0,0,90\n", 1470.0, 1, 3, ASDIC_REFRACTION_LAYER},
                 {"0,0,0,5,0,0,0\n9,9,0,6,0,0,0\n", 1470.0, 3, 7, ASDIC_REFRACTION_LAYER},
                 {"0,0,0,5,0,0,0\n9,9,0,6,0,0,0\n", 1500.001, 3, 6, ASDIC_REFRACTION_OFF}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        asdic_refraction_plan plan;
        size_t count = 0;
        write_track(w, "level.csv", cases[i].track);
        char text[512];
        snprintf(text, sizeof text,
                 "version: 1\nenvironment: {sound_speed_profile: [[0, 1500], [40, %.3f]]}\n"
                 "sonar: {frequency_khz: 20, ping_rate_hz: 1, max_range_m: 40, bin_length_m: 4,\n"
                 "  source_level_db: 220, receivers: " FAN "}\n"
                 "bottom: {depth_m: 25}\nmission: {track: level.csv}\n",
                 cases[i].deep_mps);
        asdic_mission *m = load_text(w, text);
        assert_non_null(m);
        asdic_context_set_progress(w->ctx, count_expectations, &count);
        assert_ok(w->ctx, asdic_mission_refraction(w->ctx, m, &plan));
        asdic_context_set_progress(w->ctx, NULL, NULL);
        assert_int_equal(count, 3 * cases[i].places);
        /* To choose, straight rays are looked at until they are known to be wrong, a layer only then. */
        count = 0;
        asdic_context_set_progress(w->ctx, count_expectations, &count);
        assert_ok(w->ctx, asdic_mission_refract_as_needed(w->ctx, m));
        asdic_context_set_progress(w->ctx, NULL, NULL);
        assert_int_equal(count, cases[i].chosen);
        assert_int_equal(asdic_mission_environment(m)->refraction, cases[i].needed);
        asdic_mission_destroy(&m);
    }
}

/* Rays are counted as over meshes where a file holds facets, of the bottom or of an object; not for what a scene
 * describes itself; else by whether boundaries mirror. */
static void auto_counts_rays_by_the_ground(void **state) {
    workshop *w = *state;
    static const char plane[] = "{depth_m: 50}", ball[] = "{name: b, sphere: {radius_m: 1}",
                      wedge[] = "{name: w, mesh: wedge";
    static const struct {
        const char *bottom, *first, *second;
        asdic_rays_over over;
        const char *multipath;
    } cases[] = {
        {plane, NULL, NULL, ASDIC_OVER_PLANES, "first"},
        {plane, ball, NULL, ASDIC_OVER_PLANES, "off"},
        {plane, ball, NULL, ASDIC_OVER_MIRRORS, "boundaries"},
        {plane, wedge, NULL, ASDIC_OVER_MESHES, "first"},
        {plane, ball, wedge, ASDIC_OVER_MESHES, "boundaries"},
        {"none", wedge, ball, ASDIC_OVER_MESHES, "first"},
        {"{mesh: floor, position_m: [0, 0, 50]}", NULL, NULL, ASDIC_OVER_MESHES, "boundaries"},
        {"{grid: ground.asc, position_m: [0, 0, 3]}", ball, NULL, ASDIC_OVER_MESHES, "first"}};
    write_file(w, "ground.asc",
               "ncols 2\nnrows 2\nxllcorner -90\nyllcorner -90\ncellsize 90\n40 41\n42 43\n");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[1024];
        const char *const objects[] = {cases[i].first, cases[i].second};
        int used =
            snprintf(text, sizeof text,
                     "version: 1\nsonar: {frequency_khz: 100, bin_length_m: 0.05,\n"
                     "  receivers: {fan: {count: 64, sector_deg: 90}}}\n" POSE
                     "sampling: {rays: auto, multipath: %s}\nbottom: %s\n%s",
                     cases[i].multipath, cases[i].bottom, cases[i].first ? "objects:\n" : "");
        for (int k = 0; k < 2 && objects[k]; k++) {
            used += snprintf(text + used, sizeof text - (size_t)used,
                             "  - %s, position_m: [%d, 0, 9]}\n", objects[k], 20 + 9 * k);
        }
        asdic_mission *m = load_text(w, text);
        if (!m) {
            print_error("%s", w->said);
        }
        assert_non_null(m);
        double speed_mps = asdic_environment_sound_speed_mps(asdic_mission_environment(m), 3.0);
        uint32_t rays[ASDIC_OVER_MESHES + 1];
        for (int k = 0; k <= ASDIC_OVER_MESHES; k++) {
            rays[k] = asdic_rays_auto(asdic_mission_sonar(m), speed_mps, (asdic_rays_over)k);
            assert_true(k == 0 || rays[k] > rays[k - 1]);
        }
        assert_int_equal(asdic_mission_ray_forecast(m).rays, rays[cases[i].over]);
        assert_int_equal(asdic_mission_ray_forecast(m).auto_rays, rays[cases[i].over]);
        asdic_mission_destroy(&m);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shapes_are_where_they_are_put),
        cmocka_unit_test(moving_objects_are_where_they_are_first),
        cmocka_unit_test(materials_read_their_files),
        cmocka_unit_test(range_is_that_of_the_sonars_depth),
        cmocka_unit_test(refraction_is_as_much_as_is_needed),
        cmocka_unit_test(refraction_heeds_objects),
        cmocka_unit_test(of_many_objects_some_are_heeded),
        cmocka_unit_test(a_shadow_hides_an_object),
        cmocka_unit_test(an_echo_on_an_edge_is_no_change),
        cmocka_unit_test(forms_are_compared_once_at_a_place),
        cmocka_unit_test(auto_counts_rays_by_the_ground),
        cmocka_unit_test(runs_take_what_is_the_same),
        cmocka_unit_test(runs_take_no_mesh_that_is_another),
        cmocka_unit_test(runs_of_many_borrow_their_scene),
        cmocka_unit_test(an_array_is_of_one_size),
        cmocka_unit_test(programs_have_the_defaults_of_scenes),
    };
    return cmocka_run_group_tests(tests, begin_with_meshes, end);
}
