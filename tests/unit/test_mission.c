/*
 * A mission through the public calls: what a program gets from a scene file.
 */
#include "asserts.h"

#include <asdic/asdic.h>

#include "damage.h"
#include "de_locale.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#define DEG (3.14159265358979323846 / 180.0)

typedef struct workshop {
    asdic_context *ctx;
    char folder[64];
} workshop;

static void write_file(const workshop *w, const char *name, const char *text) {
    char path[128];
    snprintf(path, sizeof path, "%s/%s", w->folder, name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    assert_int_equal(fclose(file), 0);
}

static int begin(void **state) {
    workshop *w = calloc(1, sizeof *w);
    if (!w || asdic_context_create(&w->ctx) != ASDIC_OK) {
        return -1;
    }
    snprintf(w->folder, sizeof w->folder, "/tmp/asdic-mission-XXXXXX");
    *state = w;
    return mkdtemp(w->folder) ? 0 : -1;
}

static int end(void **state) {
    workshop *w = *state;
    char command[128];
    snprintf(command, sizeof command, "rm -r %s", w->folder);
    int failed = system(command);
    asdic_context_destroy(&w->ctx);
    free(w);
    return failed;
}

/* A slope: 10 m deep at x = 0, 20 m at x = 100; north up to 100 m. As a mesh that has z down. */
static const char SLOPE[] = "v 0 -50 10\nv 100 -50 20\nv 100 50 20\nv 0 50 10\nf 1 2 3\nf 1 3 4\n";

/* Writes slope.obj; where asdic was built without OpenMesh, which reads it, the test ends. */
static void need_slope(const workshop *w) {
    char path[128];
    asdic_mesh *mesh = NULL;
    write_file(w, "slope.obj", SLOPE);
    snprintf(path, sizeof path, "%s/slope.obj", w->folder);
    if (asdic_mesh_load(w->ctx, path, 1.0, false, &mesh) == ASDIC_ERROR_UNSUPPORTED) {
        skip();
    }
    asdic_mesh_destroy(&mesh);
}

/* The scene of BOTTOM and MISSION, two lines of YAML. */
static asdic_mission *load(const workshop *w, const char *bottom, const char *mission) {
    char text[3000], path[128];
    snprintf(text, sizeof text,
             "version: 1\nbottom: %s\nmission: %s\n"
             "sonar: {frequency_khz: 100, ping_rate_hz: 4, receivers: [{name: a}, {}]}\n",
             bottom, mission);
    write_file(w, "scene.yaml", text);
    snprintf(path, sizeof path, "%s/scene.yaml", w->folder);
    asdic_mission *m = NULL;
    if (asdic_mission_load(w->ctx, path, &m) != ASDIC_OK) {
        print_error("%s\n", asdic_context_error(w->ctx));
    }
    assert_non_null(m);
    assert_string_equal(asdic_mission_path(m), path);
    assert_string_equal(asdic_mission_text(m), text);
    return m;
}

/* Keeps the first line that is logged. */
static void keep_first(void *user, asdic_log_level level, const char *message) {
    char *kept = user;
    (void)level;
    if (*kept == 0) {
        snprintf(kept, 512, "%s", message);
    }
}

/* The error of loading a scene whose bottom has LAW by the file numbers.csv, "" for none. */
static void load_law(const workshop *w, const asdic_law *law, asdic_mission **m, char error[512]) {
    asdic_law_info info = asdic_law_get_info(law);
    char text[1024], path[128];
    size_t k = 0;
    while (!info.model->keys[k].columns) {
        k++;
    }
    snprintf(text, sizeof text,
             "version: 1\nbottom: {depth_m: 12, %s: numbers.csv}\nmission: {pose: {position_m: [0, "
             "0, 7]}}\n"
             "sonar: {frequency_khz: 100, ping_rate_hz: 4, receivers: [{name: a}]}\n",
             info.model->keys[k].name);
    write_file(w, "scene.yaml", text);
    snprintf(path, sizeof path, "%s/scene.yaml", w->folder);
    *error = 0;
    asdic_context_set_log(w->ctx, ASDIC_LOG_ERROR, keep_first, error);
    asdic_mission_load(w->ctx, path, m);
    asdic_context_set_log(w->ctx, ASDIC_LOG_ERROR, NULL, NULL);
}

static bool has_file(const asdic_law *law) {
    asdic_law_info info = asdic_law_get_info(law);
    bool found = false;
    for (size_t k = 0; k < info.model->key_count; k++) {
        found |= info.model->keys[k].columns != NULL;
    }
    return found && info.uses & ASDIC_LAW_BOTTOM;
}

/* Every law that reads a file reads it beside the scene file, and names its lines in errors. */
static void laws_read_their_files(void **state) {
    const workshop *w = *state;
    static const struct {
        const char *text, *error;
    } wrong[] = {
        {"grazing_deg,strength_db\n5,-40\n10,-30x\n",
         "numbers.csv:3:4: error: 'strength_db' = -30x"},
        {"grazing_deg,strength_db\n5,-40\n5,-30\n",
         "numbers.csv:3:1: error: 'grazing_deg' = 5 is not more than 5"},
        {"grazing_deg,strength_db\n5,-40\n95,-30\n",
         "numbers.csv:3:1: error: 'grazing_deg' = 95 is out"},
        {"grazing_deg,strength_db\n5,-400\n",
         "numbers.csv:2:3: error: 'strength_db' = -400 is out"},
        {"grazing,strength_db\n5,-40\n", "numbers.csv:1:1: error: missing column 'grazing_deg'"}};
    for (size_t l = 0; l < asdic_law_count(); l++) {
        asdic_mission *m = NULL;
        char error[512];
        for (size_t i = 0; has_file(asdic_law_get(l)) && i < sizeof wrong / sizeof *wrong; i++) {
            write_file(w, "numbers.csv", wrong[i].text);
            load_law(w, asdic_law_get(l), &m, error);
            assert_contains(error, wrong[i].error);
            assert_null(m);
        }
        if (has_file(asdic_law_get(l))) {
            write_file(w, "numbers.csv", "strength_db,grazing_deg\n-40,5\n-30,10\n");
            load_law(w, asdic_law_get(l), &m, error);
            assert_string_equal(error, "");
            asdic_flat_scene flat = asdic_mission_flat_scene(m, 0);
            assert_ptr_equal(flat.bottom.law, asdic_law_get(l));
            assert_int_equal(flat.bottom.row_count, 2);
            assert_close(flat.bottom.rows[3], -30, 0);
            asdic_mission_destroy(&m);
        }
    }
}

/* The remarks on water where the sound speed has PROFILE over a bottom BOTTOM_M deep, a line each, as
 * heard from DEPTH_M as far as 187 m. */
static char *water_remarks(const workshop *w, double bottom_m, const char *profile,
                           double depth_m) {
    static char said[4 * ASDIC_REMARK_SIZE];
    char bottom[300], mission[100];
    snprintf(bottom, sizeof bottom, "{depth_m: %g}\nenvironment: {sound_speed_profile: %s}",
             bottom_m, profile);
    snprintf(mission, sizeof mission, "{pose: {position_m: [0, 0, %g]}}", depth_m);
    asdic_mission *m = load(w, bottom, mission);
    asdic_remarks remarks = asdic_mission_remarks(m);
    said[0] = '\0';
    for (size_t i = 0; i < remarks.count; i++) {
        if (strncmp(remarks.text[i], "water: ", 7) == 0) {
            strcat(strcat(said, remarks.text[i] + 7), "\n");
        }
    }
    asdic_mission_destroy(&m);
    return said;
}

/* The mission whose sonar has KEYS, and its remark that has the WORDS; NULL: it has none. */
static asdic_mission *with_sonar(const workshop *w, const char *keys, const char *words,
                                 const char **said) {
    char text[600], path[128];
    snprintf(text, sizeof text,
             "version: 1\nbottom: {depth_m: 12}\nmission: {pose: {position_m: [0, 0, 5]}}\n"
             "sonar: {frequency_khz: 300, %s}\n",
             keys);
    write_file(w, "scene.yaml", text);
    snprintf(path, sizeof path, "%s/scene.yaml", w->folder);
    asdic_mission *m = NULL;
    assert_int_equal(asdic_mission_load(w->ctx, path, &m), ASDIC_OK);
    static asdic_remarks remarks;
    remarks = asdic_mission_remarks(m);
    *said = NULL;
    for (size_t k = 0; k < remarks.count; k++) {
        bool is_it = strstr(remarks.text[k], words) != NULL;
        assert_false(is_it && *said);
        *said = is_it ? remarks.text[k] : *said;
    }
    return m;
}

/* A source level of 0 dB is one. */
static void source_levels_that_are_given_get_no_remark(void **state) {
    const workshop *w = *state;
    static const struct {
        const char *keys;
        bool remarked;
    } cases[] = {{"receivers: [{name: a}]", true},
                 {"source_level_db: 0, receivers: [{name: a}]", false},
                 {"source_level_db: 200, receivers: [{name: a}]", false}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *said;
        asdic_mission *m = with_sonar(w, cases[i].keys, "'source_level_db'", &said);
        assert_int_equal(said != NULL, cases[i].remarked);
        asdic_mission_destroy(&m);
    }
}

/* A transmitter that nobody gave is 5 cm wide, 10 wavelengths at 300 kHz: it sends to few beams of a
 * wide fan. */
static void receivers_to_which_nothing_is_sent_get_a_remark(void **state) {
    const workshop *w = *state;
    static const struct {
        const char *keys, *said;
    } cases[] = {
        {"receivers: {fan: {count: 64, sector_deg: 90, length_h_m: 0.1, length_v_m: 0.02}}",
         "48 of 64 receivers look where 'transmitter' sends less than a hundredth of what it sends "
         "ahead: it is 10.1 wavelengths wide and 10.1 high"},
        {"transmitter: {length_h_m: 0.003, length_v_m: 0.02}, "
         "receivers: {fan: {count: 64, sector_deg: 90, length_h_m: 0.1, length_v_m: 0.02}}",
         NULL},
        {"receivers: {fan: {count: 64, sector_deg: 20, length_h_m: 0.1, length_v_m: 0.02}}", NULL},
        {"transmitter: {yaw_deg: 90}, receivers: [{yaw_deg: 90}]", NULL},
        {"transmitter: {yaw_deg: 180}, receivers: [{name: a}]", "1 of 1 receivers look where"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *said;
        asdic_mission *m = with_sonar(w, cases[i].keys, "receivers look where", &said);
        assert_int_equal(said != NULL, cases[i].said != NULL);
        if (said) {
            assert_contains(said, cases[i].said);
        }
        asdic_mission_destroy(&m);
    }
}

/* Of many remarks on laws the first ones are kept, and all others. */
static void remarks_are_as_many_as_there_is_room(void **state) {
    const workshop *w = *state;
    for (int balls = ASDIC_MOST_REMARKS - 1; balls <= ASDIC_MOST_REMARKS + 1; balls++) {
        char bottom[2000];
        int used = snprintf(bottom, sizeof bottom,
                            "{depth_m: 12}\nenvironment: {sound_speed_profile: [[0, 1540], [10, "
                            "1490], [12, 1500]]}\nobjects:");
        for (int i = 0; i < balls; i++) { /* a density beyond the law's, another one each */
            used += snprintf(bottom + used, sizeof bottom - (size_t)used,
                             "\n  - {sphere: {radius_m: 0.2}, position_m: [%d, 0, 5], material: "
                             "{sediment: medium_sand, density_ratio: %g}}",
                             9 + i, 3.1 + 0.1 * i);
        }
        asdic_mission *m = load(w, bottom, "{pose: {position_m: [0, 0, 10]}}");
        asdic_remarks remarks = asdic_mission_remarks(m);
        assert_int_equal(remarks.count, ASDIC_MOST_REMARKS);
        int laws = 0;
        while (laws < ASDIC_MOST_REMARKS && strstr(remarks.text[laws], "outside the validity")) {
            laws++;
        }
        assert_true(laws > 0 && strstr(remarks.text[laws], "water: ") == remarks.text[laws]);
        assert_non_null(strstr(remarks.text[ASDIC_MOST_REMARKS - 1], "no 'source_level_db'"));
        asdic_mission_destroy(&m);
    }
}

/* Where the speed changes by G a metre from C0 to C1 at a plane, the ray that grazes it leaves with cos = C0 / C1 and
 * meets it at sqrt(C1^2 - C0^2) / G: beyond is shadow, and flatter rays turn. */
static void rays_that_turn_are_remarked(void **state) {
    const workshop *w = *state;
    static const char rays[] = "rays of the first ping that leave between %g and %g degrees "
                               "below the horizontal %s\n";
    static const char turn[] = "turn before they end";
    static const char trapped[] = "turn back and forth: trapped in a channel";
    static const struct {
        const char *profile, *plane;
        double c0, c1, least_deg, most_deg; /* negative: above the horizontal */
    } cases[] = {{"[[0, 1486], [12, 1510]]", "bottom", 1500, 1510, 0.0, 6.6},
                 {"[[0, 1514], [12, 1490]]", "surface", 1500, 1514, -7.8, 0.0}};
    char expected[200], plane[20], *said;
    for (size_t i = 0; i < 2; i++) {
        double reach_m, c0 = cases[i].c0, c1 = cases[i].c1;
        said = water_remarks(w, 12, cases[i].profile, 7.0);
        assert_int_equal(
            sscanf(said, "no ray of the first ping reaches the %19s beyond %lf m: a shadow begins",
                   plane, &reach_m),
            2);
        assert_string_equal(plane, cases[i].plane);
        assert_close(reach_m, sqrt(c1 * c1 - c0 * c0) / 2.0,
                     0.06); /* the last ray that is cast; %.4g */
        snprintf(expected, sizeof expected, rays, cases[i].least_deg, cases[i].most_deg, turn);
        assert_string_equal(strchr(said, '\n') + 1, expected);
    }
    /* 20 m above the bottom, near the end of the range of 187.5 m: straight rays reach it 186.4 m away. */
    assert_non_null(strstr(water_remarks(w, 27, "[[0, 1486], [27, 1540]]", 7.0),
                           "reaches the bottom beyond 174."));
    /* A channel about 10 m, where rays up to acos(1490 / 1500) stay. */
    static const char channel[] = "[[0, 1540], [10, 1490], [12, 1500]]";
    snprintf(expected, sizeof expected, rays, -6.6, 6.6, trapped);
    assert_non_null(strstr(water_remarks(w, 12, channel, 10.0), expected));
    /* Of less than 0.009 rad of elevations nothing is said: here 0.0088, then 0.0093. */
    assert_null(strstr(water_remarks(w, 12, "[[0, 1486], [12, 1510]]", 11.971), "rays of"));
    assert_non_null(
        strstr(water_remarks(w, 12, "[[0, 1486], [12, 1510]]", 11.967), "between 0 and 0.5 "));
    /* Straight rays, or hardly bent: nothing. */
    assert_string_equal(water_remarks(w, 12, "[[0, 1500], [12, 1500]]", 7.0), "");
    assert_string_equal(water_remarks(w, 12, "[[0, 1500], [12, 1500.001]]", 7.0), "");
    /* Nor of planes that straight rays too reach less far, and none beyond 187 m. */
    static const double away_m[] = {60, 84, 90, 95, 200};
    for (size_t i = 0; i < sizeof away_m / sizeof *away_m; i++) {
        static const char even[] = "[[0, 1500], [300, 1500.9]]";
        assert_string_equal(water_remarks(w, 7 + away_m[i], even, 7.0), "");
        assert_string_equal(water_remarks(w, away_m[i] + 7, even, away_m[i]), "");
    }
}

/* What the sources of the laws state: of the handbook 3 dB where a sediment's relief and volume are given,
 * 5 for its name, 10 for stones; for the sea 5 dB below 8 m/s of wind, 15.55 kn, and 4 above; of others
 * nothing. */
static void laws_leave_open_what_their_sources_state(void **state) {
    const workshop *w = *state;
    static const char pose[] = "{pose: {position_m: [0, 0, 2]}}";
#define BALL(name, material)                                                                       \
    "  - {name: " name ", sphere: {radius_m: 0.2}, position_m: [9, 0, 5], material: {" material    \
    "}}\n"
    static const struct {
        const char *bottom;
        double bottom_db, surface_db, object_db;
    } cases[] = {
        {"none\nenvironment: {wind_speed_kn: 15.5}", NAN, NAN, NAN},
        {"{depth_m: 12, lambert_db: -20}\nenvironment: {wind_speed_kn: 15.5}\nsurface: {law: apl}",
         NAN, 5, NAN},
        {"{depth_m: 12, sediment: medium_sand}\nenvironment: {wind_speed_kn: 15.6}\n"
         "surface: {law: apl}",
         5, 4, NAN},
        {"{depth_m: 12, sediment: medium_sand, spectral_strength_cm4: 0.004, volume_ratio: 0.002}\n"
         "surface: {law: apl, enabled: false}",
         3, NAN, NAN},
        {"{depth_m: 12, sediment: rock}\nobjects:\n  - {name: fish, point: 0, position_m: [9, 0, "
         "5]}\n",
         10, NAN, NAN},
        {"{depth_m: 12}\nobjects:\n" BALL("a", "sediment: rock") BALL("b", "lambert_db: -20")
             BALL("c", "sediment: clay"),
         NAN, NAN, 10},
        {"{depth_m: 12}\nobjects:\n" BALL("a", "lambert_db: -20") BALL("b", "sediment: clay"), NAN,
         NAN, 5},
        {"{mesh: {file: slope.obj, z_up: false}, sediment: rock}", 10, NAN, NAN},
        {"{depth_m: 12, sediment: rough_rock}", 10, NAN, NAN},
        {"{depth_m: 12, sediment: cobble}", 10, NAN, NAN},
        {"{depth_m: 12, sediment: sandy_gravel}", 5, NAN, NAN},
        {"{depth_m: 12, sediment: sandy_gravel, volume_ratio: 0.002}", 5, NAN, NAN},
        {"{depth_m: 12, sediment: clay, spectral_strength_cm4: 0.004}", 5, NAN, NAN},
    };
#undef BALL
    asdic_uncertainty none = asdic_mission_uncertainty(NULL);
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        assert_true(isnan(none.db[c]));
    }
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        if (strstr(cases[i].bottom, "slope.obj")) {
            need_slope(w);
        }
        asdic_mission *m = load(w, cases[i].bottom, pose);
        asdic_uncertainty u = asdic_mission_uncertainty(m);
        for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
            double right_db = c == ASDIC_BOTTOM    ? cases[i].bottom_db
                              : c == ASDIC_SURFACE ? cases[i].surface_db
                              : c == ASDIC_OBJECT  ? cases[i].object_db
                                                   : NAN;
            assert_true(u.db[c] == right_db || (isnan(u.db[c]) && isnan(right_db)));
        }
        asdic_mission_destroy(&m);
    }
}

static const char no_phase[] = "nothing here interferes";

/* Whether M needs phase, and for which REASON; M ends. */
static void check_phase(asdic_mission *m, const char *reason) {
    char said[200];
    bool needs = asdic_mission_needs_phase(m, said, sizeof said);
    assert_contains(said, reason);
    assert_int_equal(needs, reason != no_phase);
    asdic_mission_destroy(&m);
    assert_false(asdic_mission_needs_phase(NULL, said, sizeof said));
}

/* A ball half a metre deep, seen from 2 m with cells of 75 mm: its image is 2 / range m behind it. */
static void phase_is_needed_where_echoes_interfere(void **state) {
    const workshop *w = *state;
    static const char smooth[] = "'ball' is smooth";
    static const char image[] = "'ball' and its image in the surface are in one cell";
    static const struct {
        const char *surface, *material;
        double x_m, wind_kn;
        const char *reason;
    } cases[] = {
        {"", "impedance_mrayl: 45, slope_rms: 0", 20, 0, smooth},
        {"", "impedance_mrayl: 45, slope_rms: 0.1", 20, 0, no_phase},
        {"", "impedance_mrayl: 45, slope_rms: 0", 900, 0, no_phase}, /* out of range */
        /* 4 k^2 s^2 is 0.7 and 1.6: at 1 a share of exp(-1) of the echo has kept its phase. */
        {"", "slope_rms: 0, impedance_mrayl: 45, roughness_rms_mm: 1", 20, 0, smooth},
        {"", "slope_rms: 0, impedance_mrayl: 45, roughness_rms_mm: 1.5", 20, 0, no_phase},
        {"", "lambert_db: -20", 26, 0, no_phase},
        {"", "lambert_db: -20", 27.5, 0, image},
        {"", "lambert_db: -20", -27.5, 0, image},
        {"", "lambert_db: -20", 900, 0, no_phase},
        {"surface: {enabled: false}\n", "lambert_db: -20", 27.5, 0, no_phase},
        /* The sea's 4 k^2 s^2 is 114 and 130, of which the angle, 5.2 degrees, leaves 0.94 and 1.07. */
        {"", "lambert_db: -20", 27.5, 3.0, image},
        {"", "lambert_db: -20", 27.5, 3.1, no_phase},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char bottom[400];
        snprintf(
            bottom, sizeof bottom,
            "{depth_m: 12}\nenvironment: {sound_speed_mps: 1500, wind_speed_kn: %g}\n%sobjects:\n"
            "  - {name: ball, sphere: {radius_m: 0.2}, position_m: [%g, 0, 0.5], material: {%s}}",
            cases[i].wind_kn, cases[i].surface, cases[i].x_m, cases[i].material);
        asdic_mission *m = load(w, bottom, "{pose: {position_m: [0, 0, 2]}}");
        check_phase(m, cases[i].reason);
    }
}

/* A beam at the sine u has a grating lobe at u - 1 / spacing, where that is above -1. As a cone it lies h out of the
 * array's plane at the bearing whose sine is u / cos(h); it is 0.443 / 16 / cos(bearing) wide to either side, and heard
 * where 0.443 is the sine of h times the wavelengths of the taller of two apertures, on from where the other looks. */
static void phase_is_needed_where_an_array_is_more_than_an_aperture(void **state) {
    const workshop *w = *state;
    static const char grating[] = "grating lobes";
    static const char shaded[] = "a shaded array";
    static const struct {
        const char *array, *transmitter, *reason;
    } cases[] = {
        {"spacing_wl: 0.5, beams: {count: 90, sector_deg: 120}", "", no_phase},
        {"spacing_wl: 0.5, beams: {count: 90, sector_deg: 120}, shading: hann", "", shaded},
        /* One beam straight ahead: at 1 wavelength the lobes lie along the line. */
        {"spacing_wl: 0.99, beams: {count: 1, sector_deg: 60}", "", no_phase},
        {"spacing_wl: 1.01, beams: {count: 1, sector_deg: 60}", "", grating},
        /* The outer of two beams look 30 degrees aside: 1 / 1.5 wavelengths. */
        {"spacing_wl: 0.66, beams: {count: 2, sector_deg: 120}", "", no_phase},
        {"spacing_wl: 0.675, beams: {count: 2, sector_deg: 120}", "", grating},
        {"spacing_wl: 0.66, beams: {count: 2, sector_deg: 120}, yaw_deg: 70, pitch_deg: 40",
         "yaw_deg: 70, pitch_deg: 40", no_phase},
        {"spacing_wl: 0.675, beams: {count: 2, sector_deg: 120}, yaw_deg: 70, roll_deg: 50", "",
         grating},
        {"spacing_wl: 1.5, beams: {count: 2, sector_deg: 120}, shading: hann", "", grating},
        /* Both apertures a wavelength high: h is 26.3 degrees; the other way round, one of them 2.5: 10.2. */
        {"spacing_wl: 0.5, beams: {count: 2, sector_deg: 120}, element: {length_v_m: 0.015}",
         "length_v_m: 0.015", "lies up to 3.9 degrees beside"},
        {"spacing_wl: 0.5, beams: {count: 2, sector_deg: 120}, element: {length_v_m: 0.0375}",
         "length_v_m: 0.015", no_phase},
        {"spacing_wl: 0.5, beams: {count: 2, sector_deg: 120}, element: {length_v_m: 0.015}",
         "length_v_m: 0.0375", no_phase},
        /* The transmitter looks 30 degrees down: h is 40.2 degrees; the same of an array that looks up. */
        {"spacing_wl: 0.5, beams: {count: 2, sector_deg: 120}, element: {length_v_m: 0.0375}",
         "pitch_deg: -30, length_v_m: 0.03", "lies up to 10.9 degrees beside"},
        {"spacing_wl: 0.5, beams: {count: 2, sector_deg: 120}, pitch_deg: 30, shading: hann, "
         "element: {length_v_m: 0.0375}",
         "length_v_m: 0.03", "lies up to 10.9 degrees beside"},
        {"spacing_wl: 0.5, beams: {count: 2, sector_deg: 120}", "pitch_deg: -80",
         "lies up to 60 degrees beside"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[1000], path[128];
        snprintf(text, sizeof text,
                 "version: 1\nbottom: {depth_m: 12}\nmission: {pose: {position_m: [0, 0, 2]}}\n"
                 "environment: {sound_speed_mps: 1500}\n"
                 "sonar: {frequency_khz: 100, transmitter: {%s}, array: {elements: 32, %s}}\n",
                 cases[i].transmitter, cases[i].array);
        write_file(w, "scene.yaml", text);
        snprintf(path, sizeof path, "%s/scene.yaml", w->folder);
        asdic_mission *m = NULL;
        assert_int_equal(asdic_mission_load(w->ctx, path, &m), ASDIC_OK);
        check_phase(m, cases[i].reason);
    }
}

/* A bin has two rows, one for each beam, and each begins with its beam's name: a character more is a byte more. */
static void names_of_beams_count_in_tables(void **state) {
    const workshop *w = *state;
    uint64_t bytes[3];
    for (int i = 0; i < 3; i++) {
        char text[400], path[128];
        asdic_mission *m = NULL;
        snprintf(text, sizeof text,
                 "version: 1\nbottom: {depth_m: 12}\nmission: {pose: {position_m: [0, 0, 7]}}\n"
                 "sonar: {frequency_khz: 100, max_range_m: 50, bin_length_m: 0.5, receivers: "
                 "[{name: a%s}, {name: b%s}]}\noutput: {csv: long}\n",
                 i == 1 ? "123456789" : "", i == 2 ? "123456789" : "");
        write_file(w, "scene.yaml", text);
        snprintf(path, sizeof path, "%s/scene.yaml", w->folder);
        assert_ok(w->ctx, asdic_mission_load(w->ctx, path, &m));
        bytes[i] = asdic_mission_ping_bytes(m);
        asdic_mission_destroy(&m);
    }
    assert_close((double)(bytes[1] - bytes[0]), 900, 1);
    assert_close((double)(bytes[2] - bytes[0]), 900, 1);
}

static void flat_bottom_and_rest(void **state) {
    const workshop *w = *state;
    asdic_mission *m = load(w, "{depth_m: 12, type: 2.5}",
                            "{pose: {position_m: [1, 2, 7], yaw_deg: 90}, pings: 3}");
    double time_s = -1;
    assert_int_equal(asdic_mission_ping_count(m), 3);
    asdic_pose pose = asdic_mission_pose(m, 2, &time_s);
    assert_close(time_s, 0.5, 0);
    assert_close(pose.position_m.y, 2, 0);
    assert_close(pose.yaw_rad, 90 * DEG, 1e-15);
    asdic_flat_scene flat = asdic_mission_flat_scene(m, 0);
    assert_true(flat.has_surface && flat.has_bottom);
    assert_close(flat.altitude_m, 5, 0);
    assert_close(flat.depth_m, 7, 0);
    assert_close(asdic_material_get(&flat.bottom, "type"), 2.5, 0);
    assert_int_equal(asdic_mission_object_count(m), 0);
    assert_null(asdic_mission_get_object(m, 0));
    const asdic_sonar *sonar = asdic_mission_sonar(m);
    assert_int_equal(sonar->receiver_count, 2);
    assert_string_equal(sonar->receivers[1].name, "001");
    assert_int_equal(strlen(asdic_mission_hash(m)), 64);
    assert_int_equal(asdic_sonar_check(w->ctx, sonar), ASDIC_OK);
    assert_int_equal(asdic_environment_check(w->ctx, asdic_mission_environment(m)), ASDIC_OK);
    assert_int_equal(asdic_mission_sampling(m)->rays, 20000);
    assert_int_equal(asdic_mission_output(m)->images, 31);
    assert_close(asdic_mission_detector(m)->pfa, 1e-3, 0);
    asdic_mission_destroy(&m);
    assert_null(m);
}

static void sloping_bottom_and_track(void **state) {
    const workshop *w = *state;
    need_slope(w);
    write_file(w, "t.csv",
               "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n"
               "1000,10,0,5,0,0,350\n"
               "1001,90,0,5,0,0,10\n");
    asdic_mission *m =
        load(w, "{mesh: {file: slope.obj, z_up: false}, type: rock}", "{track: t.csv}");
    double time_s = -1;
    assert_int_equal(asdic_mission_ping_count(m), 5);
    asdic_pose pose = asdic_mission_pose(m, 2, &time_s);
    assert_close(time_s, 1000.5, 0);
    assert_close(pose.position_m.x, 50, 1e-9);
    assert_close(sin(pose.yaw_rad), 0, 1e-9);
    for (size_t i = 0; i < 5; i++) {
        double depth_m = 10 + (10 + 20.0 * (double)i) / 10;
        asdic_flat_scene flat = asdic_mission_flat_scene(m, i);
        assert_true(flat.has_bottom);
        assert_close(flat.altitude_m, depth_m - 5, 1e-5);
        assert_close(asdic_material_get(&flat.bottom, "type"), 4, 0);
    }
    assert_int_equal(asdic_mission_object_count(m), 1);
    const asdic_mission_object *bottom = asdic_mission_get_object(m, 0);
    assert_string_equal(bottom->name, "");
    assert_close(bottom->max_m.z, 20, 0);
    assert_int_equal(bottom->mesh.open_edges, 4);
    asdic_mission_destroy(&m);
}

static void open_water(void **state) {
    const workshop *w = *state;
    asdic_mission *m = load(w, "none", "{pose: {position_m: [0, 0, 0]}}");
    asdic_flat_scene flat = asdic_mission_flat_scene(m, 0);
    assert_true(flat.has_surface);
    assert_false(flat.has_bottom);
    asdic_mission_destroy(&m);
}

static void placed_meshes_have_their_box(void **state) {
    const workshop *w = *state;
    need_slope(w);
    /* North, east, down: a quarter turn to starboard sends north to east. */
    asdic_mission *m = load(w,
                            "{mesh: {file: slope.obj, z_up: false, scale: 0.5}, "
                            "position_m: [7, 8, 9], rotation_deg: [0, 0, 90]}",
                            "{pose: {position_m: [7, 20, 3]}}");
    const asdic_mission_object *bottom = asdic_mission_get_object(m, 0);
    assert_close(bottom->min_m.x, 7 - 25, 1e-9);
    assert_close(bottom->max_m.x, 7 + 25, 1e-9);
    assert_close(bottom->min_m.y, 8, 1e-9);
    assert_close(bottom->max_m.y, 8 + 50, 1e-9);
    assert_close(bottom->min_m.z, 9 + 5, 1e-9);
    assert_close(bottom->max_m.z, 9 + 10, 1e-9);
    /* 12 m along the slope of half size: 5 + 12 / 10 deep, less 9 m of shift. */
    assert_close(asdic_mission_flat_scene(m, 0).altitude_m, 9 + 5 + 1.2 - 3, 1e-5);
    asdic_mission_destroy(&m);
}

/* Of a vertex that no triangle has, a box knows nothing. */
static void stray_vertices_are_in_no_box(void **state) {
    const workshop *w = *state;
    need_slope(w);
    char text[sizeof SLOPE + 32];
    snprintf(text, sizeof text, "%sv 900 -900 -90\n", SLOPE);
    write_file(w, "stray.obj", text);
    asdic_mission *m = load(w, "{mesh: {file: stray.obj, z_up: false}, position_m: [7, 0, 0]}",
                            "{pose: {position_m: [7, 20, 3]}}");
    const asdic_mission_object *bottom = asdic_mission_get_object(m, 0);
    assert_close(bottom->max_m.x - bottom->min_m.x, bottom->mesh.max_m.x - bottom->mesh.min_m.x,
                 1e-9);
    assert_close(bottom->min_m.x, 7 + bottom->mesh.min_m.x, 1e-9);
    assert_close(bottom->min_m.y, bottom->mesh.min_m.y, 1e-9);
    assert_close(bottom->min_m.z, bottom->mesh.min_m.z, 1e-9);
    asdic_mission_destroy(&m);
}

static void decimal_comma_changes_nothing(void **state) {
    const workshop *w = *state;
    if (!set_german_locale()) {
        skip();
    }
    asdic_mission *m = load(w, "{depth_m: 12.25}", "{pose: {position_m: [0, 0, 7.5]}}");
    assert_close(asdic_mission_flat_scene(m, 0).altitude_m, 4.75, 0);
    asdic_mission_destroy(&m);
    char *schema = asdic_mission_schema();
    assert_non_null(strstr(schema, "\"minimum\": 0.1, \"maximum\": 1000"));
    free(schema);
    char comma[16];
    snprintf(comma, sizeof comma, "%.1f", 0.5);
    assert_string_equal(comma, "0,5"); /* the caller's locale is as it was */
    setlocale(LC_ALL, "C");
}

/* Files that are wrong in any way are answered, and what is accepted can be asked. */
static void damaged_missions_are_answered(void **state) {
    const workshop *w = *state;
    static const char scene[] =
        "version: 1\n"
        "bottom: {mesh: {file: slope.obj, z_up: false}, position_m: [0, 0, 1]}\n"
        "objects:\n"
        "  - {mesh: slope.obj, position_m: [1, 2, 3], type: rock}\n"
        "  - {cylinder: {radius_m: 1, length_m: 2, segments: 9}, position_m: [10, 2, 3]}\n"
        "sonar: {frequency_khz: 100, receivers: {fan: {count: 9, sector_deg: 90}}}\n"
        "mission: {waypoints: [[1, 1, 5], [20, 0, 5], [20, 9, 7]]}\n";
    char path[128], text[2 * sizeof scene + 512];
    uint32_t random = 88675123;
    size_t good = 0, bad = 0;
    snprintf(path, sizeof path, "%s/damaged.yaml", w->folder);
    need_slope(w);
    for (int i = 0; i < 1500; i++) {
        asdic_mission *m = NULL;
        size_t size = damage(scene, sizeof scene - 1, &random, text);
        FILE *file = fopen(path, "wb");
        assert_non_null(file);
        assert_int_equal(fwrite(text, 1, size, file), size);
        fclose(file);
        asdic_status status = asdic_mission_load(w->ctx, path, &m);
        good += status == ASDIC_OK;
        bad += status == ASDIC_ERROR_INPUT;
        assert_int_equal(m != NULL, status == ASDIC_OK);
        if (m) {
            asdic_flat_scene flat = asdic_mission_flat_scene(m, asdic_mission_ping_count(m) - 1);
            assert_true(flat.altitude_m >= 0 && flat.depth_m >= 0);
            assert_int_equal(asdic_sonar_check(w->ctx, asdic_mission_sonar(m)), ASDIC_OK);
            assert_int_equal(asdic_environment_check(w->ctx, asdic_mission_environment(m)),
                             ASDIC_OK);
        }
        asdic_mission_destroy(&m);
    }
    assert_int_equal(good + bad, 1500);
    assert_true(good > 20 && bad > 500);
}

/* The slope from memory, as from its file: the same altitudes, and the same triangles. */
static void scenes_in_memory(void **state) {
    static const char text[] =
        "{\"version\": 1, \"bottom\": {\"mesh\": {\"file\": \"slope\"}, \"type\": \"sand\"},\n"
        " \"sonar\": {\"frequency_khz\": 100, \"bandwidth_khz\": 10, \"ping_rate_hz\": 10,\n"
        "  \"source_level_db\": 0, \"receivers\": [{\"name\": \"forward\"}]},\n"
        " \"mission\": {\"pose\": {\"position_m\": [50, 0, 5]}}}\n";
    static const double corners[] = {0, -50, 10, 100, -50, 20, 100, 50, 20, 0, 50, 10};
    static const uint32_t indices[] = {0, 1, 2, 0, 2, 3};
    const workshop *w = *state;
    asdic_mesh *mesh = NULL;
    assert_int_equal(asdic_mesh_from_triangles(w->ctx, corners, 4, indices, 2, &mesh), ASDIC_OK);
    const asdic_named_mesh named = {.name = "slope", .mesh = mesh};
    asdic_scene_text scene = {.text = text,
                              .length = sizeof text - 1,
                              .name = "memory",
                              .meshes = &named,
                              .mesh_count = 1};
    asdic_mission *m = NULL;
    assert_int_equal(asdic_mission_load_text(w->ctx, &scene, &m), ASDIC_OK);
    asdic_mesh_destroy(&mesh); /* it was copied */
    assert_close(asdic_mission_flat_scene(m, 0).altitude_m, 10.0, 1e-12);
    assert_string_equal(asdic_mission_path(m), "memory");
    assert_string_equal(asdic_mission_text(m), text);
    assert_int_equal(asdic_mission_get_object(m, 0)->mesh.triangles, 2);
    asdic_mission_destroy(&m);

    scene.mesh_count = 0; /* a file then, which is not there */
    assert_int_equal(asdic_mission_load_text(w->ctx, &scene, &m), ASDIC_ERROR_INPUT);
    assert_null(m);
    scene.name = NULL;
    assert_int_equal(asdic_mission_load_text(w->ctx, &scene, &m), ASDIC_ERROR_ARGUMENT);
    scene.name = "memory";
    scene.length = SIZE_MAX;
    assert_int_equal(asdic_mission_load_text(w->ctx, &scene, &m), ASDIC_ERROR_INPUT);
    assert_int_equal(asdic_mission_load_text(w->ctx, NULL, &m), ASDIC_ERROR_ARGUMENT);
}

static void levels_of_a_ping(void **state) {
    const workshop *w = *state;
    asdic_ping *ping = NULL;
    float level_db[2] = {0};
    assert_int_equal(asdic_ping_create(w->ctx, 1, 2, &ping), ASDIC_OK);
    ping->intensity_lin[ASDIC_NOISE][1] = 1e5;
    assert_int_equal(asdic_ping_levels(ping, ASDIC_NOISE, level_db), ASDIC_OK);
    assert_true(isnan(level_db[0]));
    assert_close(level_db[1], 50.0, 1e-5);
    assert_int_equal(asdic_ping_levels(ping, ASDIC_COMPONENT_COUNT, level_db),
                     ASDIC_ERROR_ARGUMENT);
    asdic_ping_destroy(&ping);
}

static void misuse_is_answered(void **state) {
    const workshop *w = *state;
    asdic_mission *m = (asdic_mission *)1;
    assert_int_equal(asdic_mission_load(w->ctx, NULL, &m), ASDIC_ERROR_ARGUMENT);
    assert_null(m);
    assert_int_equal(asdic_mission_load(w->ctx, "x", NULL), ASDIC_ERROR_ARGUMENT);
    assert_int_equal(asdic_mission_load(w->ctx, "/nonexistent/a.yaml", &m), ASDIC_ERROR_INPUT);
    assert_string_equal(asdic_context_error(w->ctx),
                        "/nonexistent/a.yaml: cannot open: No such file or directory");
    asdic_mission_destroy(NULL);
    asdic_mission_destroy(&m);
}

/* Rays that end on the bottom, on the surface and nowhere, of the last plot. */
static size_t ends[3];

/* A sonar at 35 m over a bottom at 68 m in water of 1490 m/s, of 1500 m/s from 9 m upwards. */
static void check_ray(const asdic_series *s, double angle_rad, double range_m) {
    size_t last = s->count - 1;
    double length_m = 0.0, upper_rad = acos(fmin(cos(angle_rad) * 1500.0 / 1490.0, 1.0));
    assert_close(s->x[0], 0.0, 0.0);
    assert_close(s->y[0], -35.0, 1e-9);
    for (size_t i = 1; i <= last; i++) {
        double dx = s->x[i] - s->x[i - 1], dy = fabs(s->y[i] - s->y[i - 1]);
        assert_true(hypot(dx, dy) < range_m / 100.0); /* it looks curved */
        length_m += hypot(dx, dy);
        if (fmax(s->y[i], s->y[i - 1]) < -18.001) {
            assert_close(dy, dx * tan(angle_rad), 1e-6);
        } else if (fmin(s->y[i], s->y[i - 1]) > -8.999) { /* by Snell's law */
            assert_close(dy, dx * tan(upper_rad), 1e-6);
        }
    }
    size_t end = s->rgb == 0x8c510a ? 0 : s->rgb == 0x2166ac ? 1 : 2;
    ends[end]++;
    if (end < 2) {
        assert_close(s->y[last], end == 0 ? -68.0 : 0.0, 1e-6);
        assert_true(length_m < range_m * 1500.0 / 1490.0);
    } else { /* when the last bin is heard */
        assert_true(s->y[last] > -68.0 && s->y[last] < 0.0);
        assert_true(length_m > 0.9999 * range_m && length_m < range_m * 1500.0 / 1490.0);
    }
}

static bool is_channel;

asdic_status __wrap_asdic_picture_plot(asdic_context *ctx, const char *path,
                                       const asdic_plot *panels, size_t panel_count,
                                       const asdic_picture_options *options);
asdic_status __wrap_asdic_picture_plot(asdic_context *ctx, const char *path,
                                       const asdic_plot *panels, size_t panel_count,
                                       const asdic_picture_options *options) {
    (void)ctx;
    (void)path;
    (void)options;
    assert_int_equal(panel_count, 1);
    assert_int_equal(panels->series_count, 41 + 2); /* surface and bottom */
    if (is_channel) { /* to the last bin, however many layers are entered on the way */
        const asdic_series *s = &panels->series[20 + 7];
        assert_true(s->count > 400);
        assert_true(s->x[s->count - 1] > 0.97 * panels->x.high);
        return ASDIC_OK;
    }
    for (int i = 0; i < 41; i++) {
        check_ray(&panels->series[i], fabs(i - 20.0) * DEG, panels->x.high);
    }
    for (size_t i = 41; i < 43; i++) {
        const asdic_series *s = &panels->series[i];
        assert_int_equal(s->count, 2);
        assert_true(s->x[0] == 0.0 && s->x[1] == panels->x.high);
        assert_true(s->y[0] == (i == 41 ? 0.0 : -68.0) && s->y[1] == s->y[0]);
    }
    assert_true(panels->y.low < -68.0 && panels->y.high > 0.0);
    return ASDIC_OK;
}

/* A ray that leaves at 7 degrees passes through 28 layers again and again. */
static void rays_in_a_channel_are_drawn_to_their_end(void **state) {
    const workshop *w = *state;
    char rest[1500] =
        "{pose: {position_m: [0, 0, 35]}}\nenvironment: {sound_speed_profile: [[0, 1490]";
    for (int i = -14; i <= 14; i++) {
        snprintf(rest + strlen(rest), sizeof rest - strlen(rest), ", [%.3f, %.1f]",
                 35.0 + 0.025 * i, 1476.0 + abs(i) + 0.2 * (i & 1));
    }
    snprintf(rest + strlen(rest), sizeof rest - strlen(rest), ", [68, 1490]]}");
    asdic_mission *m = load(w, "{depth_m: 68}", rest);
    is_channel = true;
    assert_int_equal(asdic_mission_draw_rays(w->ctx, m, 0, "rays.png"), ASDIC_OK);
    is_channel = false;
    asdic_mission_destroy(&m);
}

/* Heard to 186 m: rays end on the bottom from 10.2 degrees down on, 33 m / sin, and on the surface from 11.7 up on:
 * 17, 9 and 9 m over the sines of 11.7, 10.7 and 9.7 degrees, their angles there, add up to that. */
static void drawn_rays_obey_snell(void **state) {
    const workshop *w = *state;
    asdic_mission *m =
        load(w, "{depth_m: 68}",
             "{pose: {position_m: [0, 0, 35]}}\n"
             "environment: {sound_speed_profile: [[0, 1500], [9, 1500], [18, 1490], [68, 1490]]}");
    ends[0] = ends[1] = ends[2] = 0;
    assert_int_equal(asdic_mission_draw_rays(w->ctx, m, 0, "rays.png"), ASDIC_OK);
    assert_true(ends[0] == 10 && ends[1] == 9 && ends[2] == 22);
    assert_status(w->ctx,
                  asdic_mission_draw_rays(w->ctx, m, asdic_mission_ping_count(m), "rays.png"),
                  ASDIC_ERROR_ARGUMENT);
    asdic_mission_destroy(&m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_of_beams_count_in_tables),
        cmocka_unit_test(flat_bottom_and_rest),
        cmocka_unit_test(sloping_bottom_and_track),
        cmocka_unit_test(open_water),
        cmocka_unit_test(placed_meshes_have_their_box),
        cmocka_unit_test(stray_vertices_are_in_no_box),
        cmocka_unit_test(decimal_comma_changes_nothing),
        cmocka_unit_test(damaged_missions_are_answered),
        cmocka_unit_test(scenes_in_memory),
        cmocka_unit_test(levels_of_a_ping),
        cmocka_unit_test(misuse_is_answered),
        cmocka_unit_test(laws_read_their_files),
        cmocka_unit_test(source_levels_that_are_given_get_no_remark),
        cmocka_unit_test(receivers_to_which_nothing_is_sent_get_a_remark),
        cmocka_unit_test(remarks_are_as_many_as_there_is_room),
        cmocka_unit_test(rays_that_turn_are_remarked),
        cmocka_unit_test(phase_is_needed_where_echoes_interfere),
        cmocka_unit_test(phase_is_needed_where_an_array_is_more_than_an_aperture),
        cmocka_unit_test(laws_leave_open_what_their_sources_state),
        cmocka_unit_test(drawn_rays_obey_snell),
        cmocka_unit_test(rays_in_a_channel_are_drawn_to_their_end),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
