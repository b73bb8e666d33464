/*
 * What a caller may always do: destroy what was never made, ask about nothing, and name folders
 * that are yet to be made; and what keeps two writers of one file apart.
 */
#include "asserts.h"
#include "test_context.h"

#include "out/file.h"

#include <asdic/asdic.h>

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#define NONE_IS_DESTROYED(type, destroy)                                                           \
    do {                                                                                           \
        type *none = NULL;                                                                         \
        destroy(NULL);                                                                             \
        destroy(&none);                                                                            \
        assert_null(none);                                                                         \
    } while (0)

static void none_is_destroyed(void **state) {
    (void)state;
    NONE_IS_DESTROYED(asdic_context, asdic_context_destroy);
    NONE_IS_DESTROYED(asdic_detect_report, asdic_detect_report_destroy);
    NONE_IS_DESTROYED(asdic_device_info, asdic_device_info_free);
    NONE_IS_DESTROYED(asdic_loop, asdic_loop_destroy);
    NONE_IS_DESTROYED(asdic_mesh, asdic_mesh_destroy);
    NONE_IS_DESTROYED(asdic_mission, asdic_mission_destroy);
    NONE_IS_DESTROYED(asdic_ping, asdic_ping_destroy);
    NONE_IS_DESTROYED(asdic_simulator, asdic_simulator_destroy);
    NONE_IS_DESTROYED(asdic_caster, asdic_caster_destroy);
    NONE_IS_DESTROYED(asdic_roc, asdic_roc_destroy);
    NONE_IS_DESTROYED(asdic_ros, asdic_ros_destroy);
    NONE_IS_DESTROYED(asdic_run, asdic_run_close);
    NONE_IS_DESTROYED(asdic_scan, asdic_scan_destroy);
    NONE_IS_DESTROYED(asdic_occupancy, asdic_occupancy_destroy);
    NONE_IS_DESTROYED(asdic_tracker, asdic_tracker_destroy);
    NONE_IS_DESTROYED(asdic_scene, asdic_scene_destroy);
    NONE_IS_DESTROYED(asdic_trial, asdic_trial_close);
    NONE_IS_DESTROYED(asdic_view, asdic_view_destroy);
    asdic_devices_close(NULL, 0);
    asdic_device **devices = NULL;
    asdic_devices_close(&devices, 0);
    assert_null(devices);
}

/* What is behind the last of a kind has no name. */
static void kinds_end(void **state) {
    (void)state;
    assert_null(asdic_trial_outcome_name(ASDIC_TRIAL_OUTCOMES));
    assert_null(asdic_trial_cause_name(ASDIC_TRIAL_CAUSES));
    assert_null(asdic_colormap_name(ASDIC_COLORMAP_COUNT));
    assert_null(asdic_refraction_name((asdic_refraction)(ASDIC_REFRACTION_OFF + 1)));
    assert_string_equal(asdic_path_name(ASDIC_PATH_COUNT), "?");
    assert_string_equal(asdic_phase_name(ASDIC_PHASE_COUNT), "?");
}

static void no_mission_has_no_phase_and_no_size(void **state) {
    (void)state;
    char reason[80] = "";
    assert_false(asdic_mission_needs_phase(NULL, reason, sizeof reason));
    assert_string_equal(reason, "there is no mission");
    assert_int_equal(asdic_mission_run_bytes(NULL, 7), 0);
    assert_int_equal(asdic_mission_ping_bytes(NULL), 0);
    assert_false(asdic_mission_leaves_csv_out(NULL));
}

/* A sonar and a point, both DEPTH_M deep and 100 m apart, at 6 kHz of bandwidth. */
static bool interferes(double depth_m, double wind_kn, const char *surface, char reason[120]) {
    char text[700];
    int length = snprintf(
        text, sizeof text,
        "{\"version\": 1, \"environment\": {\"sound_speed_mps\": 1500, \"wind_speed_kn\": %g},\n"
        " \"bottom\": {\"depth_m\": 60}, \"surface\": {\"enabled\": %s},\n"
        " \"objects\": [{\"name\": \"buoy\", \"point\": {\"target_strength_db\": 0},\n"
        "  \"position_m\": [100, 0, %g]}],\n"
        " \"sonar\": {\"frequency_khz\": 100, \"bandwidth_khz\": 6, \"ping_rate_hz\": 5, "
        "\"source_level_db\": 0,\n"
        "  \"receivers\": [{\"name\": \"forward\"}]},\n"
        " \"mission\": {\"pose\": {\"position_m\": [0, 0, %g]}}}\n",
        wind_kn, surface, depth_m, depth_m);
    const asdic_scene_text scene = {.text = text, .length = (size_t)length, .name = "memory"};
    asdic_mission *mission = NULL;
    assert_int_equal(asdic_mission_load_text(ctx, &scene, &mission), ASDIC_OK);
    bool needs = asdic_mission_needs_phase(mission, reason, 120);
    asdic_mission_destroy(&mission);
    return needs;
}

/* By way of the surface it is 2 d^2 / R farther, by the images' geometry, where d is much less than
 * R: as long as a cell of 0.5 x 1500 m/s / 6 kHz = 0.125 m at 2.5 m, where the next cell begins. A rough
 * surface leaves no image. */
static void a_target_and_its_image_interfere_within_a_cell(void **state) {
    (void)state;
    char reason[120];
    assert_true(interferes(2.47, 0, "true", reason));
    assert_non_null(strstr(reason, "'buoy' and its image"));
    assert_false(interferes(2.5, 0, "true", reason));
    assert_non_null(strstr(reason, "nothing here interferes"));
    assert_false(interferes(2.2, 0, "false", reason));
    assert_false(interferes(2.2, 30, "true", reason));
}

/* Whether FOLDER has as much room as what WHERE names, give or take what others write meanwhile. */
static bool has_room_of(const char *folder, const char *where) {
    struct statvfs disk;
    assert_int_equal(statvfs(where, &disk), 0);
    double there = (double)disk.f_bavail * (double)disk.f_frsize;
    double told = (double)asdic_disk_free_bytes(folder);
    return told > 0.5 * there - 1e9 && told < 2.0 * there + 1e9;
}

static void room_is_that_of_the_nearest_folder(void **state) {
    (void)state;
    assert_true(has_room_of("/", "/"));
    assert_true(has_room_of("/none-here", "/"));
    assert_true(has_room_of("/none-here/nor/here", "/"));
    assert_true(has_room_of("none-here", "."));
    assert_true(has_room_of("none-here/nor/here", "."));
    assert_true(asdic_disk_free_bytes(NULL) == UINT64_MAX);
    assert_true(asdic_disk_free_bytes("") == UINT64_MAX);
}

/* Locks belong to what is open: this process's second descriptor is as good as another process. */
static void a_file_in_writing_is_locked(void **state) {
    (void)state;
    char path[] = "/tmp/asdic-callers-XXXXXX";
    int made = mkstemp(path);
    assert_true(made >= 0);
    close(made);
    int writes = asdic_file_open_new(path, O_WRONLY);
    int other = open(path, O_WRONLY);
    assert_true(writes >= 0 && other >= 0);
    assert_int_equal(flock(other, LOCK_EX | LOCK_NB), -1);
    assert_int_equal(errno, EWOULDBLOCK);
    assert_int_equal(asdic_file_open_new(path, O_WRONLY), -1);
    assert_int_equal(errno, EBUSY);
    close(writes);
    assert_int_equal(flock(other, LOCK_EX | LOCK_NB), 0);
    close(other);
    unlink(path);
}

#define WRITERS 4

typedef struct race {
    pthread_barrier_t begin, end;
    const char *path;
    atomic_int winners, wrong;
} race;

static void *open_at_once(void *user) {
    race *r = user;
    pthread_barrier_wait(&r->begin);
    int fd = asdic_file_open_new(r->path, O_WRONLY);
    atomic_fetch_add(&r->wrong, fd < 0 && errno != EBUSY);
    pthread_barrier_wait(&r->end); /* who has it keeps it until all have tried */
    struct stat opened, named;
    if (fd >= 0) {
        bool is_there =
            fstat(fd, &opened) == 0 && stat(r->path, &named) == 0 && named.st_ino == opened.st_ino;
        atomic_fetch_add(&r->winners, 1);
        atomic_fetch_add(&r->wrong, !is_there);
        close(fd);
    }
    return NULL;
}

/* Of several at once one, whether a writer that is gone has left the file or there is none. */
static void one_of_many_writers_has_the_file(void **state) {
    (void)state;
    char path[] = "/tmp/asdic-callers-XXXXXX";
    int left = mkstemp(path);
    assert_true(left >= 0);
    close(left);
    for (int round = 0; round < 500; round++) {
        race r = {.path = path};
        pthread_t threads[WRITERS];
        pthread_barrier_init(&r.begin, NULL, WRITERS);
        pthread_barrier_init(&r.end, NULL, WRITERS);
        for (size_t i = 0; i < WRITERS; i++) {
            assert_int_equal(pthread_create(&threads[i], NULL, open_at_once, &r), 0);
        }
        for (size_t i = 0; i < WRITERS; i++) {
            pthread_join(threads[i], NULL);
        }
        assert_int_equal(r.winners, 1);
        assert_int_equal(r.wrong, 0);
        pthread_barrier_destroy(&r.begin);
        pthread_barrier_destroy(&r.end);
        if (round % 2) {
            unlink(path);
        }
    }
    unlink(path);
}

/* Swerling III over four looks: 1F1(2; 4; c) = 6 ((c - 2) e^c + c + 2) / c^3, as its power series
 * shows term by term; with snr the target's mean to the background's, w = 1 + 2 snr and
 * c = 4 z (w - 1) / w, the ratio of densities at the intensity z is 1F1 / w^2. */
static void likelihood_of_swerling_3_in_closed_form(void **state) {
    (void)state;
    const asdic_background none = {.mean_lin = 1.0, .looks = 4, .shape = INFINITY};
    for (double snr = 0.5; snr < 100.0; snr *= 3.0) {
        for (double z = 1.0; z < 300.0; z *= 1.7) {
            double w = 1.0 + 2.0 * snr, c = 4.0 * z * (w - 1.0) / w;
            double exact =
                c + log(6.0 * (c - 2.0 + (c + 2.0) * exp(-c)) / (c * c * c)) - 2.0 * log(w);
            assert_close(asdic_detect_llr(&none, ASDIC_TARGET_SWERLING3, snr, z), exact, 1e-9);
        }
    }
}

/* Before any part is opened, and in the name of the function that was called. */
static void joins_of_no_parts_or_no_folder_are_refused(void **state) {
    (void)state;
    static const struct {
        asdic_status (*merge)(asdic_context *, const char *const *, size_t, const char *, bool);
        const char *name;
    } joins[] = {{asdic_run_merge, "asdic_run_merge: "},
                 {asdic_dataset_merge, "asdic_dataset_merge: "},
                 {asdic_trial_merge, "asdic_trial_merge: "}};
    const char *const parts[] = {"/nonexistent", "/nonexistent", NULL};
    const struct {
        const char *const *parts;
        size_t count;
        const char *folder;
    } rows[] = {{NULL, 1, "/nonexistent/whole"},
                {parts, 0, "/nonexistent/whole"},
                {parts, 2, NULL},
                {parts, 3, "/nonexistent/whole"},
                {parts + 2, 1, "/nonexistent/whole"}};
    for (size_t k = 0; k < sizeof joins / sizeof *joins; k++) {
        for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
            assert_status(ctx,
                          joins[k].merge(ctx, rows[i].parts, rows[i].count, rows[i].folder, false),
                          ASDIC_ERROR_ARGUMENT);
            assert_contains(asdic_context_error(ctx), joins[k].name);
        }
    }
    assert_status(ctx, asdic_dataset_merge(ctx, parts, 2, "/nonexistent/whole", false),
                  ASDIC_ERROR_INPUT);
}

/* The same of frames that no set has. */
static void frames_beyond_a_set_are_refused(void **state) {
    (void)state;
    static int none; /* no device is asked */
    asdic_device *device = (asdic_device *)(void *)&none;
    const size_t rows[][3] = {{4, 0, 5}, {4, 4, SIZE_MAX}, {4, 2, 2}, {0, 0, SIZE_MAX}};
    asdic_dataset_options o = asdic_dataset_options_default();
    o.folder = "/nonexistent/set";
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        o.frames = rows[i][0], o.first = rows[i][1], o.end = rows[i][2];
        assert_status(ctx, asdic_dataset_make(ctx, "/nonexistent/scene", device, &o),
                      ASDIC_ERROR_ARGUMENT);
        assert_contains(asdic_context_error(ctx), "are no part of a set of ");
    }
}

/* Calls that return a status say so of each argument that is NULL. */
static void arguments_of_nothing_are_refused(void **state) {
    (void)state;
    const char *const keys[] = {"f_khz=100", NULL};
    const asdic_setting nameless = {NULL, "1"}, worthless = {"sonar.frequency_khz", NULL};
    asdic_mission *m = NULL;
    double value;
    assert_status(ctx, asdic_material_find_impedance(ctx, "steel", NULL), ASDIC_ERROR_ARGUMENT);
    assert_status(ctx, asdic_model_evaluate(ctx, NULL, "absorption", keys, 2, &value),
                  ASDIC_ERROR_ARGUMENT);
    const char *scene = DATA_DIR "/scenes/scenario2.yaml";
    assert_status(ctx, asdic_mission_load_with(ctx, scene, &nameless, 1, &m), ASDIC_ERROR_ARGUMENT);
    assert_status(ctx, asdic_mission_load_with(ctx, scene, &worthless, 1, &m),
                  ASDIC_ERROR_ARGUMENT);
    assert_null(m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(none_is_destroyed),
        cmocka_unit_test(arguments_of_nothing_are_refused),
        cmocka_unit_test(kinds_end),
        cmocka_unit_test(no_mission_has_no_phase_and_no_size),
        cmocka_unit_test(a_target_and_its_image_interfere_within_a_cell),
        cmocka_unit_test(room_is_that_of_the_nearest_folder),
        cmocka_unit_test(a_file_in_writing_is_locked),
        cmocka_unit_test(one_of_many_writers_has_the_file),
        cmocka_unit_test(joins_of_no_parts_or_no_folder_are_refused),
        cmocka_unit_test(frames_beyond_a_set_are_refused),
        cmocka_unit_test(likelihood_of_swerling_3_in_closed_form),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
