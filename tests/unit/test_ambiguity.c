/* Of which meshes it is remarked that nobody can tell plates from a round body. */
#include "lathe.h"
#include "mission_rig.h"

#include "base/vec.h"
#include "mission/mission.h"

#include <time.h>

/* Adds MESH as that which scenes know as "body". */
static void set_body(workshop *w, asdic_mesh *mesh) {
    for (size_t i = 0; i < w->mesh_count; i++) {
        asdic_mesh *before = (asdic_mesh *)w->meshes[i].mesh;
        asdic_mesh_destroy(&before);
    }
    w->meshes[0] = (asdic_named_mesh){.name = "body", .mesh = mesh};
    w->mesh_count = 1;
}

/* The remarks on edges, a line each, of the mission whose OBJECTS are heard at 100 kHz. */
static const char *remarks_of(workshop *w, const char *objects) {
    static char said[4 * ASDIC_REMARK_SIZE];
    char text[2048];
    snprintf(text, sizeof text,
             SCENE "bottom: {depth_m: 30}\nmission: {pose: {position_m: [0, 0, 10]}}\nobjects:\n%s",
             objects);
    asdic_mission *m = load_text(w, text);
    if (!m) {
        print_error("%s\n%s", asdic_context_error(w->ctx), w->said);
    }
    assert_non_null(m);
    asdic_remarks remarks = asdic_mission_remarks(m);
    said[0] = '\0';
    for (size_t i = 0; i < remarks.count; i++) {
        if (strstr(remarks.text[i], " edges of up to ")) {
            strcat(strcat(said, remarks.text[i]), "\n");
        }
    }
    asdic_mission_destroy(&m);
    return said;
}

/* What is said of the body with these KEYS, of smooth steel. */
#define BODY(keys)                                                                                 \
    "  - {name: it, mesh: {file: body}, position_m: [20, 0, 10], " keys                            \
    "material: {impedance_mrayl: 45, roughness_rms_mm: 0.1, slope_rms: 0.01}}\n"

static const ring drum[] = {{-0.5, 0.5}, {0.5, 0.5}};

/* By Urick 1983, table 9.1, a smooth square plate of width b sends back 2 b turn / lambda times what the arc in its place
 * does, that is turn / sqrt(pi m) of a lobe exp(-tan^2 / m), m = lambda^2 / (4 pi area), to which its slope adds. */
static void drums_may_be_of_plates(void **state) {
    workshop *w = *state;
    set_body(w, lathe_mesh(w->ctx, drum, 2, 11));
    const char *said = remarks_of(w, BODY());
    print_message("%s", said);
    assert_contains(said, "objects: 'it' has 11 edges of up to 32.7 degrees where plates may ");
    assert_contains(said, "; default round below 35, 'crease_deg: 0' all plates, 50 all round\n");
    double db = atof(strstr(said, " be cut: ") + 9);
    const double pi = 3.14159265358979323846, turn = 2.0 * pi / 11.0, width_m = sin(0.5 * turn);
    double lobe = 0.01 * 0.01 + 0.015 * 0.015 / (4.0 * pi * width_m);
    assert_close(db, 10.0 * log10(turn / sqrt(pi * lobe)), 0.3);
    assert_string_equal(remarks_of(w, BODY("crease_deg: 0, ")), "");
    assert_string_equal(remarks_of(w, BODY("crease_deg: 50, ")), "");
    /* Once a mesh. */
    said = remarks_of(w, BODY() "  - {name: other, mesh: {file: body}, position_m: [30, 5, 10], "
                                "rotation_deg: [0, 20, 30], material: steel}\n");
    assert_ptr_equal(strchr(said, '\n') + 1, said + strlen(said));
    /* One that is rough, or known to be round, says nothing of the next. */
    assert_contains(
        remarks_of(w, "  - {name: rough, mesh: {file: body}, position_m: [30, 5, 10], type: rock}\n"
                      "  - {name: known, mesh: {file: body}, position_m: [40, 5, 10], crease_deg: "
                      "0}\n" BODY()),
        "objects: 'it' has 11 edges ");
    /* What is rough scatters to all sides, and a plate of half a wavelength as well. */
    assert_string_equal(remarks_of(w, "  - {name: it, mesh: {file: body}, position_m: [20, 0, 10], "
                                      "material: {preset: concrete, roughness_rms_mm: 20}}\n"),
                        "");
    assert_string_equal(remarks_of(w, "  - {name: it, mesh: {file: body}, position_m: [20, 0, 10], "
                                      "type: rock}\n"),
                        "");
    /* Edges of exactly 20 degrees count, all of them. */
    set_body(w, lathe_mesh(w->ctx, drum, 2, 18));
    assert_contains(remarks_of(w, BODY()), "objects: 'it' has 18 edges of up to 20 degrees where ");
    static const ring pipe[] = {{-0.012, 0.012}, {0.012, 0.012}};
    set_body(w, lathe_mesh(w->ctx, pipe, 2, 11));
    assert_string_equal(remarks_of(w, BODY()), "");
    /* A cylinder is known to be one. */
    assert_string_equal(
        remarks_of(w, "  - {name: it, cylinder: {radius_m: 0.5, length_m: 1, segments: 11}, "
                      "position_m: [20, 0, 10], material: {roughness_rms_mm: 0.1}}\n"),
        "");
}

/* What a scene of COUNT copies of "body", each turned otherwise, takes to be remarked on, as instructions do: processor
 * time, the least of three. */
static double remarks_s(workshop *w, int count) {
    char text[8192];
    size_t used =
        (size_t)snprintf(text, sizeof text,
                         SCENE "bottom: {depth_m: 30}\nmission: {pose: {position_m: [0, 0, 10]}}\n"
                               "objects:\n");
    for (int i = 0; i < count; i++) {
        used += (size_t)snprintf(text + used, sizeof text - used,
                                 "  - {name: it%d, mesh: {file: body}, position_m: [%d, 0, 10], "
                                 "rotation_deg: [0, 0, %d], material: steel}\n",
                                 i, 20 + 3 * i, 7 * i);
    }
    asdic_mission *m = load_text(w, text);
    assert_non_null(m);
    double least_s = INFINITY;
    for (int i = 0; i < 3; i++) {
        asdic_remarks remarks = {.count = 0};
        clock_t began = clock();
        asdic_mission_remark_ambiguity(m, 1500.0, &remarks);
        least_s = fmin(least_s, (double)(clock() - began) / CLOCKS_PER_SEC);
        assert_int_equal(remarks.count, 0);
    }
    asdic_mission_destroy(&m);
    return least_s;
}

/* Copies cost no search. */
static void copies_are_searched_once(void **state) {
    workshop *w = *state;
    asdic_mesh *mesh = NULL;
    assert_ok(w->ctx, asdic_mesh_sphere(w->ctx, 0.5, 64, &mesh));
    set_body(w, mesh);
    double one_s = remarks_s(w, 1), many_s = remarks_s(w, 12);
    print_message("1 mesh %.4f s, 12 copies %.4f s\n", one_s, many_s);
    assert_true(many_s < 3 * one_s);
}

/* Domes of two bands, which lean alike off 45 degrees and part by TURN_DEG: the crease angle cuts them. */
static double dome_turn_deg(workshop *w, double turn_deg) {
    const double r = 0.2, half = r * sqrt(0.5), lean = 0.5 * (90.0 - turn_deg) * ASDIC_PI / 180.0;
    const double side = -0.5 - (r - half) / tan(lean), pole = side - half * tan(lean);
    const ring capsule[] = {{pole, 0.0}, {side, half},  {-0.5, r},
                            {0.5, r},    {-side, half}, {-pole, 0.0}};
    set_body(w, lathe_mesh(w->ctx, capsule, 6, 24));
    const char *said = remarks_of(w, BODY());
    print_message("%s", said);
    if (said[0]) {
        assert_contains(said, "objects: 'it' has 48 ");
    }
    return said[0] ? atof(strstr(said, "up to ") + 6) : 0.0;
}

/* Beyond 50 degrees nothing is round. */
static void domes_may_be_of_two_bands(void **state) {
    workshop *w = *state;
    assert_close(dome_turn_deg(w, 45.0), 45.0, 1.0);
    assert_close(dome_turn_deg(w, 49.0), 49.0, 1.0);
    assert_close(dome_turn_deg(w, 52.0), 0.0, 0.0);
}

/* Whatever else is flat or round for certain. */
static void other_meshes_are_certain(void **state) {
    workshop *w = *state;
    static const ring cube[] = {{-0.5, 0.5}, {0.5, 0.5}};
    static const ring chamfered[] = {{-0.5, 0.4}, {-0.4, 0.5}, {0.4, 0.5}, {0.5, 0.4}};
    static const ring gently[] = {{-0.5, 0.4}, {-0.3, 0.5}, {0.3, 0.5}, {0.5, 0.4}};
    static const ring bottle[] = {{0.0, 0.04},   {0.005, 0.045}, {0.2, 0.045},
                                  {0.23, 0.015}, {0.29, 0.015},  {0.3, 0.012}};
    static const struct {
        const ring *rings;
        uint32_t count, sides;
    } bodies[] = {{cube, 2, 4},    {chamfered, 4, 4}, {gently, 4, 4},
                  {cube, 2, 6},    {cube, 2, 24},     {cube, 2, 48},
                  {bottle, 6, 24}, {bottle, 6, 32},   {chamfered, 4, 32}};
    for (size_t i = 0; i < sizeof bodies / sizeof *bodies; i++) {
        set_body(w, lathe_mesh(w->ctx, bodies[i].rings, bodies[i].count, bodies[i].sides));
        assert_string_equal(remarks_of(w, BODY()), "");
    }
    asdic_mesh *mesh = NULL;
    assert_ok(w->ctx, asdic_mesh_sphere(w->ctx, 0.5, 64, &mesh));
    set_body(w, mesh);
    assert_string_equal(remarks_of(w, BODY()), "");
    static const char *const files[] = {"terrain", "rocks", "rough"};
    for (size_t i = 0; i < 3; i++) {
        char objects[600];
        snprintf(objects, sizeof objects,
                 "  - {name: it, mesh: {file: %s/meshes/%s.ply}, position_m: [30, 0, 20], "
                 "material: {impedance_mrayl: 45, roughness_rms_mm: 0.1, slope_rms: 0.01}}\n",
                 DATA_DIR, files[i]);
        assert_string_equal(remarks_of(w, objects), "");
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(drums_may_be_of_plates),
        cmocka_unit_test(copies_are_searched_once),
        cmocka_unit_test(domes_may_be_of_two_bands),
        cmocka_unit_test(other_meshes_are_certain),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
