/*
 * Every allocation and every OpenCL call of small jobs fails once, each in a run of its own: the
 * right status, a sentence, nothing lost; and the next try, without a fault, does the same as ever.
 *
 * ASDIC_FAULT_STEP (default 1) takes only every so many-th call of the jobs that use a device.
 */
#include "asserts.h"
#include "test_device.h"

#include <asdic/asdic.h>

#include "base/context.h"
#include "base/file_read.h"
#include "laws/tabulate.h"
#include "live/camera.h"
#include "mission/mission.h"
#include "mission/run/run_chart_data.h"
#include "mission/run/run_files.h"

#include "fault.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[] = "/tmp/asdic-fault-XXXXXX";
static asdic_context *ctx;
static asdic_device **devices;
static size_t device_count;
static long device_step = 1;

static const char *in_folder(const char *name) {
    static char paths[4][256];
    static int turn;
    char *path = paths[turn++ % 4];
    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

static void write_text(const char *name, const char *text) {
    FILE *file = fopen(in_folder(name), "w");
    assert_non_null(file);
    fputs(text, file);
    assert_int_equal(fclose(file), 0);
}

/* ---- jobs ----------------------------------------------------------------------------------- */

typedef asdic_status (*job)(void);

static asdic_status load(const char *name) {
    asdic_mission *mission = NULL;
    asdic_plan plan;
    asdic_status status = asdic_mission_load(ctx, in_folder(name), &mission);
    if ((status == ASDIC_OK) != (mission != NULL)) {
        fail_msg("mission_load: status %d with mission %p", status, (void *)mission);
    }
    if (mission) {
        status = asdic_mission_plan(ctx, mission, &plan);
    }
    asdic_mission_destroy(&mission);
    return status;
}

static asdic_status load_objects(void) {
    return load("objects.yaml");
}

static asdic_status load_track(void) {
    return load("track.yaml");
}

static asdic_status load_mesh(const char *path) {
    asdic_mesh *mesh = NULL;
    asdic_status status = asdic_mesh_load(ctx, path, 1.0, false, &mesh);
    asdic_mesh_destroy(&mesh);
    return status;
}

static asdic_status load_obj(void) {
    return load_mesh(in_folder("m.obj"));
}

static asdic_status load_off(void) {
    return load_mesh(in_folder("m.off"));
}

static asdic_status load_ply(void) {
    return load_mesh(DATA_DIR "/meshes/rocks.ply");
}

static asdic_status load_grid(void) {
    asdic_mesh *mesh = NULL;
    asdic_status status = asdic_mesh_load_grid(ctx, in_folder("g.asc"), true, &mesh);
    asdic_mesh_destroy(&mesh);
    return status;
}

static asdic_status expect(void) {
    asdic_mission *mission = NULL;
    asdic_ping *ping = NULL;
    asdic_status status = asdic_mission_load(ctx, in_folder("small.yaml"), &mission);
    if (status == ASDIC_OK) {
        status = asdic_ping_create(ctx, 1, 4, &ping);
    }
    if (status == ASDIC_OK) {
        asdic_pose pose = asdic_mission_pose(mission, 0, NULL);
        asdic_flat_scene flat = asdic_mission_flat_scene(mission, 0);
        ping->bin_length_m = asdic_mission_sonar(mission)->bin_length_m;
        status = asdic_expected_compute(ctx, &flat, asdic_mission_environment(mission),
                                        asdic_mission_sonar(mission), &pose, ping);
    }
    if (status == ASDIC_OK) {
        status = asdic_expected_write_csv(ctx, in_folder("expected.csv"),
                                          asdic_mission_sonar(mission), ping);
    }
    asdic_ping_destroy(&ping);
    asdic_mission_destroy(&mission);
    return status;
}

static asdic_status open_devices(void) {
    asdic_device **opened = NULL;
    size_t count = 0;
    asdic_status status = asdic_devices_open(ctx, NULL, &opened, &count);
    if ((status == ASDIC_OK) != (opened != NULL && count > 0)) {
        fail_msg("devices_open: status %d with %zu devices", status, count);
    }
    asdic_devices_close(&opened, count);
    return status;
}

/* A mission of two pings, whose pictures and tables are drawn again. */
static asdic_status run_mission(const char *name, bool resume) {
    asdic_mission *mission = NULL;
    asdic_run_options options = asdic_run_options_default();
    asdic_render_options render = asdic_render_options_default();
    options.folder = in_folder(name);
    options.force = !resume;
    options.resume = resume;
    asdic_status status = asdic_mission_load(ctx, in_folder("small.yaml"), &mission);
    if (status == ASDIC_OK) {
        status = asdic_mission_run(ctx, mission, devices, device_count, &options);
    }
    if (status == ASDIC_OK) {
        render.raw = true;
        status = asdic_run_render(ctx, options.folder, &render);
    }
    asdic_mission_destroy(&mission);
    return status;
}

static asdic_status run_small(void) {
    return run_mission("run", false);
}

/* The first ping on new devices: kernels are compiled, or taken from the driver's cache. */
static asdic_status first_ping(void) {
    asdic_mission *mission = NULL;
    asdic_device **opened = NULL;
    asdic_simulator *simulator = NULL;
    asdic_ping *ping = NULL;
    size_t count = 0;
    asdic_status status = asdic_mission_load(ctx, in_folder("small.yaml"), &mission);
    status = status ? status : asdic_devices_open(ctx, NULL, &opened, &count);
    if (status == ASDIC_OK) {
        status = asdic_simulator_create(
            ctx, opened[0], asdic_mission_scene(mission), asdic_mission_environment(mission),
            asdic_mission_sonar(mission), asdic_mission_sampling(mission), 5.0, &simulator);
    }
    if (status == ASDIC_OK) {
        status = asdic_ping_create(ctx, 1, asdic_simulator_bin_count(simulator), &ping);
    }
    if (status == ASDIC_OK) {
        asdic_pose pose = asdic_mission_pose(mission, 0, NULL);
        status = asdic_simulator_ping(simulator, &pose, 0, ping);
    }
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&simulator);
    asdic_devices_close(&opened, count);
    asdic_mission_destroy(&mission);
    return status;
}

/* A picture of the live view. */
static asdic_status shoot(void) {
    static const asdic_shot shot = {.eye_m = {-6.0, 0.0, 4.0}, .range_m = 60.0};
    asdic_mission *mission = NULL;
    asdic_simulator *simulator = NULL;
    asdic_camera *camera = NULL;
    asdic_status status = asdic_mission_load(ctx, in_folder("small.yaml"), &mission);
    if (status == ASDIC_OK) {
        status = asdic_simulator_create(
            ctx, devices[0], asdic_mission_scene(mission), asdic_mission_environment(mission),
            asdic_mission_sonar(mission), asdic_mission_sampling(mission), 5.0, &simulator);
    }
    status = status ? status : asdic_camera_create(ctx, devices[0], 16, 16, &camera);
    status = status ? status : asdic_camera_shoot(camera, simulator, &shot);
    asdic_camera_destroy(&camera);
    asdic_simulator_destroy(&simulator);
    asdic_mission_destroy(&mission);
    return status;
}

/* A ping with truth to points, mirrors and a fan, one of phases, and two models. */
static asdic_status ask_for_all(void) {
    static const char *const facet[] = {"impedance_mrayl=8", "roughness_rms_mm=0.1",
                                        "slope_rms=0.1",     "f_khz=100",
                                        "c_mps=1500",        "grazing_deg=70"};
    double value;
    asdic_status status = asdic_model_evaluate(ctx, devices[0], "rough-facet", facet, 6, &value);
    for (int coherent = 0; coherent < 2 && !status; coherent++) {
        asdic_mission *mission = NULL;
        asdic_simulator *simulator = NULL;
        asdic_ping *ping = NULL;
        status = asdic_mission_load(ctx, in_folder("all.yaml"), &mission);
        if (status == ASDIC_OK) {
            asdic_sampling sampling = *asdic_mission_sampling(mission);
            sampling.coherent = coherent;
            sampling.truth = !coherent;
            status = asdic_simulator_create(
                ctx, devices[0], asdic_mission_scene(mission), asdic_mission_environment(mission),
                asdic_mission_sonar(mission), &sampling, 5.0, &simulator);
        }
        if (status == ASDIC_OK) {
            status = asdic_ping_create(ctx, 32, asdic_simulator_bin_count(simulator), &ping);
        }
        if (status == ASDIC_OK && !coherent) {
            status = asdic_ping_add_truth(ctx, ping);
        }
        if (status == ASDIC_OK) {
            asdic_pose pose = asdic_mission_pose(mission, 0, NULL);
            status = asdic_simulator_ping(simulator, &pose, 0, ping);
        }
        asdic_ping_destroy(&ping);
        asdic_simulator_destroy(&simulator);
        asdic_mission_destroy(&mission);
    }
    return status;
}

static asdic_status merge(void) {
    const char *parts[] = {in_folder("reference")};
    return asdic_run_merge(ctx, parts, 1, in_folder("merged"), true);
}

static asdic_status replay(void) {
    asdic_trial_options options = asdic_trial_options_default();
    asdic_trial_run flown;
    options.scene = in_folder("ideal.yaml");
    options.force = true; /* the same folder again and again */
    return asdic_trial_replay(ctx, NULL, &options, 0, 0, in_folder("replay"), &flown);
}

static asdic_status create_files(void) {
    asdic_mission *mission = NULL;
    asdic_files *files = NULL;
    asdic_status status = asdic_mission_load(ctx, in_folder("small.yaml"), &mission);
    if (status == ASDIC_OK) {
        const asdic_run_facts facts = {.scene_path = "small.yaml",
                                       .scene_hash = asdic_mission_hash(mission),
                                       .version = "0",
                                       .pings_planned = 2,
                                       .beams = 1,
                                       .bins = 4};
        status = asdic_files_create(ctx, folder, &mission->settings, &facts, 5.0, &files);
    }
    assert_true((status == ASDIC_OK) == (files != NULL));
    asdic_files_destroy(&files);
    asdic_mission_destroy(&mission);
    return status;
}

/* With what the scene says of objects, which a run without its scene is without. */
static asdic_status detect(void) {
    asdic_detect_options options = asdic_detect_options_default();
    asdic_detect_report *report = NULL;
    options.force = true;
    asdic_status status = asdic_run_detect(ctx, in_folder("reference"), &options, &report);
    assert_true((status == ASDIC_OK) == (report != NULL));
    asdic_detect_report_destroy(&report);
    return status;
}

/* Whole, or none at all. */
static asdic_status print_schema(void) {
    static char *whole;
    char *schema = asdic_mission_schema();
    if (!whole) {
        whole = schema;
        return ASDIC_OK;
    }
    assert_true(!schema || strcmp(schema, whole) == 0);
    asdic_status status = schema ? ASDIC_OK : asdic_fail_memory(ctx, "a schema");
    free(schema);
    return status;
}

static asdic_status draw_roc(void) {
    asdic_roc_point points[2] = {{.design_pfa = 1e-3}, {.design_pfa = 1.0}};
    asdic_roc_reach reach[2] = {{.range_m = 5.0}, {.range_m = 9.0}};
    asdic_roc roc = {.points = points, .point_count = 2, .reach = reach, .reach_count = 2};
    asdic_roc *rocs[] = {&roc, &roc};
    const char *names[] = {"a", "b"};
    asdic_status status = asdic_roc_draw(ctx, in_folder("roc.png"), "a", names, rocs, 2);
    return status == ASDIC_ERROR_UNSUPPORTED ? ASDIC_OK : status; /* without cairo */
}

static asdic_status read_chart(void) {
    asdic_chart_data data;
    asdic_status status = asdic_chart_data_read(ctx, in_folder("reference"), &data);
    assert_true(status || data.outline_count == 1);
    asdic_chart_data_finish(&data);
    return status;
}

static asdic_status fly(void) {
    const char *values[] = {"20", "21"};
    asdic_trial_options options = asdic_trial_options_default();
    options.scene = in_folder("ideal.yaml");
    options.folder = in_folder("trial");
    options.runs = 2;
    options.variants = (asdic_trial_variants){"bottom.depth_m", values, 2};
    options.force = true;
    return asdic_trial_fly(ctx, NULL, 0, &options);
}

static asdic_status open_trial(void) {
    asdic_trial *trial = NULL;
    asdic_status status = asdic_trial_open(ctx, in_folder("trial"), &trial);
    if (status == ASDIC_OK) {
        assert_int_equal(asdic_trial_variant_count(trial), 2);
        assert_string_equal(asdic_trial_variant_name(trial, 1), "bottom.depth_m = 21");
    }
    asdic_trial_close(&trial);
    return status;
}

/* ---- what must hold ------------------------------------------------------------------------- */

static void assert_same_file(const char *a, const char *b, const char *name) {
    char command[600];
    snprintf(command, sizeof command, "cmp '%s/%s' '%s/%s'", in_folder(a), name, in_folder(b),
             name);
    assert_int_equal(system(command), 0);
}

/* What a failure left behind is finished by a resume, to the same bytes. */
static void resume_to_the_same(void) {
    assert_ok(ctx, run_mission("run", true));
    assert_same_file("reference", "run", "pings.npy");
    assert_same_file("reference", "run", "bins.csv");
}

static bool is_expected(fault_kind kind, asdic_status status) {
    if (kind == FAULT_OPENCL) {
        return status == ASDIC_ERROR_DEVICE || status == ASDIC_ERROR_DEVICE_LOST ||
               status == ASDIC_ERROR_MEMORY;
    }
    return status == ASDIC_ERROR_MEMORY;
}

/* RUN once for each call that it makes, every STEP-th only, which fails, and leaves no object of OpenCL behind. AFTER,
 * if given, must hold after each failure; at most SPARED calls may be ones that it can do without. */
static void fail_each(fault_kind kind, job run, long step, long spared, void (*after)(void)) {
    long failed = 0, done = 0;
    assert_ok(ctx, run());
    const long alive = fault_alive();
    for (long n = 1;; n += step) {
        asdic_fail(ctx, ASDIC_OK, "%s", "");
        fault_arm(kind, n);
        asdic_status status = run();
        if (fault_alive() != alive) {
            fail_msg("call %ld: %ld OpenCL objects more than before", n, fault_alive() - alive);
        }
        if (!fault_disarm()) {
            assert_ok(ctx, status);
            break;
        }
        if (status == ASDIC_OK) {
            done++;
            continue;
        }
        failed++;
        if (!is_expected(kind, status) || !asdic_context_error(ctx)[0]) {
            fail_msg("call %ld: '%s', %s", n, asdic_status_text(status), asdic_context_error(ctx));
        }
        if (after) {
            after();
        }
    }
    print_message("             %ld failed, %ld done without\n", failed, done);
    assert_true(failed > 0);
    assert_true(done <= spared);
}

static void memory_while_loading(void **state) {
    (void)state;
    static const job jobs[] = {load_objects, load_track, load_obj,   load_off, load_ply,
                               load_grid,    expect,     merge,      replay,   create_files,
                               print_schema, draw_roc,   read_chart, fly,      open_trial};
    for (size_t i = 0; i < sizeof jobs / sizeof *jobs; i++) {
        fail_each(FAULT_ALLOCATION, jobs[i], 1, 1, NULL); /* the tree is not trimmed */
    }
}

static void memory_while_detecting(void **state) {
    (void)state;
    /* The tree is not trimmed, and nobody asked for messages whose file has no name. */
    fail_each(FAULT_ALLOCATION, detect, 1, 2, NULL);
}

static void memory_while_opening_devices(void **state) {
    (void)state;
    fail_each(FAULT_ALLOCATION, open_devices, 1, 0, NULL);
}

static void memory_while_running(void **state) {
    (void)state;
    fail_each(FAULT_ALLOCATION, run_small, device_step, 1, resume_to_the_same);
}

static void memory_while_compiling(void **state) {
    (void)state;
    fail_each(FAULT_ALLOCATION, first_ping, device_step, 1, NULL);
}

static void opencl_while_opening_devices(void **state) {
    (void)state;
    /* questions about a device that it does not answer */
    fail_each(FAULT_OPENCL, open_devices, 1, 60, NULL);
}

static void opencl_while_running(void **state) {
    (void)state;
    fail_each(FAULT_OPENCL, run_small, device_step, 40, resume_to_the_same);
}

static void opencl_while_compiling(void **state) {
    (void)state;
    fail_each(FAULT_OPENCL, first_ping, device_step, 100, NULL);
}

/* What is done and what fails leaves no object of OpenCL behind. */
static void devices_are_left_as_they_were(void **state) {
    (void)state;
    static const job jobs[] = {open_devices, run_small, first_ping, shoot, ask_for_all};
    for (size_t i = 0; i < sizeof jobs / sizeof *jobs; i++) {
        assert_ok(ctx, jobs[i]()); /* a device keeps its programs */
        const long alive = fault_alive();
        assert_ok(ctx, jobs[i]());
        assert_int_equal(fault_alive(), alive);
    }
    fail_each(FAULT_OPENCL, shoot, 2 * device_step, 100, NULL);
}

static asdic_status learn_and_ping(asdic_simulator *simulator, const asdic_mission *mission,
                                   asdic_ping *ping) {
    asdic_pose pose = asdic_mission_pose(mission, 0, NULL);
    asdic_status status = asdic_simulator_learn(simulator, &pose, 0);
    return status ? status : asdic_simulator_ping(simulator, &pose, 0, ping);
}

/* What fails half-way leaves no command that could read what the next try writes; that does as ever. */
static void simulators_outlive_failures(void **state) {
    (void)state;
    asdic_mission *mission = NULL;
    asdic_simulator *simulator = NULL;
    asdic_ping *usual = NULL, *ping = NULL;
    long failed = 0;
    assert_ok(ctx, asdic_mission_load(ctx, in_folder("all.yaml"), &mission));
    assert_ok(ctx, asdic_simulator_create(ctx, devices[0], asdic_mission_scene(mission),
                                          asdic_mission_environment(mission),
                                          asdic_mission_sonar(mission),
                                          asdic_mission_sampling(mission), 5.0, &simulator));
    size_t bins = asdic_simulator_bin_count(simulator);
    assert_ok(ctx, asdic_ping_create(ctx, 32, bins, &usual));
    assert_ok(ctx, asdic_ping_create(ctx, 32, bins, &ping));
    assert_ok(ctx, learn_and_ping(simulator, mission, usual));
    for (long n = 1;; n += device_step) {
        fault_arm(FAULT_OPENCL, n);
        asdic_status status = learn_and_ping(simulator, mission, ping);
        if (!fault_disarm()) {
            assert_ok(ctx, status);
            break;
        }
        failed += status != ASDIC_OK;
        if (status && fault_pending()) {
            fail_msg("call %ld failed and left commands: %s", n, asdic_context_error(ctx));
        }
        assert_ok(ctx, learn_and_ping(simulator, mission, ping));
        assert_memory_equal(ping->intensity_lin[ASDIC_TOTAL], usual->intensity_lin[ASDIC_TOTAL],
                            32 * bins * sizeof(double));
    }
    assert_true(failed > 10);
    asdic_ping_destroy(&ping);
    asdic_ping_destroy(&usual);
    asdic_simulator_destroy(&simulator);
    asdic_mission_destroy(&mission);
}

static void threads_while_running(void **state) {
    (void)state;
    fail_each(FAULT_THREAD, run_small, 1, 4, resume_to_the_same);
}

/* The first tables of all, of which none may lie at word 0. */
static asdic_status make_tables(void) {
    const asdic_law_water water = {
        .frequency_hz = 1e5, .sound_speed_mps = 1500.0, .wavelength_m = 0.015};
    asdic_material material = asdic_material_of(asdic_law_find("lambert"));
    asdic_scatterer s = asdic_scatterer_at(&material, &water);
    asdic_law_words tables = {0};
    asdic_status status = asdic_law_tables_add(ctx, &s, &tables);
    free(tables.words);
    return status;
}

static void memory_for_tables(void **state) {
    (void)state;
    fail_each(FAULT_ALLOCATION, make_tables, 1, 0, NULL);
}

static void a_small_file_takes_memory_once(void **state) {
    (void)state;
    char *text = NULL;
    size_t bytes;
    fault_arm(FAULT_ALLOCATION, 2);
    asdic_status status = asdic_file_read(ctx, in_folder("small.yaml"), SIZE_MAX, &text, &bytes);
    assert_false(fault_disarm());
    assert_ok(ctx, status);
    free(text);
}

enum { TRACKED_PINGS = 3, PLOTS = 60 };

static asdic_status track_ping(asdic_tracker *tracker, int ping) {
    asdic_plot_point plots[PLOTS];
    size_t count = ping == 0 ? PLOTS / 2 : PLOTS;
    for (size_t i = 0; i < count; i++) {
        plots[i] = (asdic_plot_point){.north_m = 10.0 * (double)i + 0.2 * ping,
                                      .east_m = -0.1 * ping,
                                      .variance_nn_m2 = 0.04,
                                      .variance_ee_m2 = 0.04};
    }
    return asdic_tracker_update(tracker, ping, plots, count);
}

/* Tracks of a few pings; the NTH allocation in PING fails, after which it is tried again. False if there are fewer. */
static bool track_with_fault(int ping, long nth, asdic_track_state tracks[PLOTS]) {
    asdic_tracker_options options = asdic_tracker_options_default();
    asdic_tracker *tracker = NULL;
    bool came = false;
    size_t count;
    options.confirm = options.of = TRACKED_PINGS; /* each ping counts */
    assert_ok(ctx, asdic_tracker_create(ctx, &options, &tracker));
    for (int k = 0; k < TRACKED_PINGS; k++) {
        fault_arm(FAULT_ALLOCATION, k == ping ? nth : 1000);
        asdic_status status = track_ping(tracker, k);
        if (fault_disarm()) {
            came = true;
            assert_status(ctx, status, ASDIC_ERROR_MEMORY);
            status = track_ping(tracker, k);
        }
        assert_ok(ctx, status);
    }
    const asdic_track_state *found = asdic_tracker_get(tracker, &count);
    assert_int_equal(count, PLOTS);
    memcpy(tracks, found, count * sizeof *tracks);
    asdic_tracker_destroy(&tracker);
    return came;
}

/* A ping without memory may come again, as if nothing had happened. */
static void memory_while_tracking(void **state) {
    (void)state;
    asdic_track_state usual[PLOTS], tracks[PLOTS];
    track_with_fault(-1, 0, usual);
    assert_true(usual[0].confirmed && usual[0].hits == TRACKED_PINGS);
    for (int ping = 0; ping < 2; ping++) {
        long n = 1;
        for (; track_with_fault(ping, n, tracks); n++) {
            for (size_t i = 0; i < PLOTS; i++) {
                const asdic_track_state *a = &usual[i], *b = &tracks[i];
                assert_true(a->id == b->id && a->hits == b->hits && a->age == b->age &&
                            a->confirmed == b->confirmed && a->north_m == b->north_m &&
                            a->east_m == b->east_m && a->sd_north_m == b->sd_north_m);
            }
        }
        assert_true(n > 3);
    }
}

/* ---- set up --------------------------------------------------------------------------------- */

static int set_up(void **state) {
    (void)state;
    write_text("small.yaml",
               "version: 1\nbottom: {depth_m: 12}\n"
               "objects: [{box: {size_m: [1, 1, 1]}, position_m: [8, 0, 6], material: "
               "{impedance_mrayl: 45, roughness_rms_mm: 0, slope_rms: 0}}]\n"
               "sonar: {frequency_khz: 100, ping_rate_hz: 50, bin_length_m: 4, speckle: rayleigh, "
               "receivers: [{name: a}]}\n"
               "mission: {pose: {position_m: [0, 0, 5]}, pings: 2}\n"
               "sampling: {rays: 64}\noutput: {npy: true, images: [waterfall, ascope]}\n");
    write_text(
        "all.yaml",
        "version: 1\nbottom: {depth_m: 12}\n"
        "objects: [{box: {size_m: [1, 1, 1]}, position_m: [8, 0, 6], material: "
        "{impedance_mrayl: 45, roughness_rms_mm: 0, slope_rms: 0}}, "
        "{point: {target_strength_db: -20}, position_m: [9, 1, 5]}]\n"
        "sonar: {frequency_khz: 100, max_range_m: 20, bin_length_m: 1, array: {elements: 8, "
        "spacing_wl: 0.5, element: {length_v_m: 0.05}, beams: {count: 32, sector_deg: 90}}}\n"
        "mission: {pose: {position_m: [0, 0, 5]}}\nsampling: {rays: 256}\n");
    write_text("objects.yaml",
               "version: 1\nbottom: {grid: {file: g.asc, values: depths}, type: mud}\n"
               "objects: [{sphere: {radius_m: 1}, position_m: [8, 0, 6], type: rock}, "
               "{cylinder: {radius_m: 1, length_m: 2}, position_m: [8, 5, 6], type: rock}, "
               "{plate: {size_m: [1, 2]}, position_m: [8, -5, 6], type: rock}, "
               "{mesh: {file: m.obj, scale: 1}, position_m: [9, -5, 6], type: rock}, "
               "{point: {target_strength_db: -20}, position_m: [9, 0, 5]}]\n"
               "sonar: {frequency_khz: 100, receivers: {fan: {count: 16, sector_deg: 90}}}\n"
               "mission: {waypoints: {points_m: [[0, 0, 5], [20, 0, 5]], speed_mps: 2}}\n");
    write_text("ideal.yaml",
               "version: 1\nbottom: {depth_m: 20}\n"
               "sonar: {frequency_khz: 100, ping_rate_hz: 1, speckle: rayleigh, "
               "receivers: [{name: a}]}\n"
               "mission: {waypoints: {points_m: [[0, 0, 10], [9, 0, 10]], speed_mps: 3}}\n"
               "trial: {time_s: 3, ideal: {pd: 0.5}, draws: [{key: 'mission.waypoints.speed_mps', "
               "uniform: [3, 4]}]}\n");
    write_text("track.yaml", "version: 1\nbottom: none\n"
                             "sonar: {frequency_khz: 100, receivers: [{name: a}]}\n"
                             "mission: {track: t.csv}\n");
    write_text("t.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n0,0,0,5,0,0,0\n"
                        "3,6,0,5,0,0,0\n");
    write_text("g.asc", "ncols 3\nnrows 3\nxllcorner -50\nyllcorner -50\ncellsize 50\n"
                        "20 20 20\n20 21 20\n20 20 20\n");
    write_text("m.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
    write_text("m.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    return run_mission("reference", false) == ASDIC_OK ? 0 : -1;
}

static int tear_down(void **state) {
    (void)state;
    char command[300];
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    return system(command);
}

int main(void) {
    const char *step = getenv("ASDIC_FAULT_STEP");
    test_device t = test_device_open_or_skip();
    ctx = t.ctx;
    devices = t.devices;
    device_count = t.count;
    device_step = step ? atol(step) : 1;
    if (!mkdtemp(folder) || device_step < 1) {
        return 1;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(memory_while_loading),
        cmocka_unit_test(memory_while_detecting),
        cmocka_unit_test(memory_while_opening_devices),
        cmocka_unit_test(memory_while_running),
        cmocka_unit_test(memory_while_compiling),
        cmocka_unit_test(opencl_while_opening_devices),
        cmocka_unit_test(opencl_while_running),
        cmocka_unit_test(opencl_while_compiling),
        cmocka_unit_test(devices_are_left_as_they_were),
        cmocka_unit_test(simulators_outlive_failures),
        cmocka_unit_test(threads_while_running),
        cmocka_unit_test(memory_for_tables),
        cmocka_unit_test(a_small_file_takes_memory_once),
        cmocka_unit_test(memory_while_tracking),
    };
    return test_device_end(&t, cmocka_run_group_tests_name("faults", tests, set_up, tear_down));
}
