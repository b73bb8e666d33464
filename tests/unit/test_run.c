/*
 * Running a mission over several devices, some of which fail.
 */
#include "run_rig.h"

#include "de_locale.h"
#include "mission/mission.h"
#include "mission/run/run_facts.h"
#include "mission/run/run_files.h"
#include "out/record.h"

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <unistd.h>

/* The clock goes ON_S when a run's files are written to their end, which takes no time here. */
#define ON_S 1000.0
static double ahead_s;

double __real_asdic_clock_s(void);
double __wrap_asdic_clock_s(void);
asdic_status __real_asdic_files_commit(asdic_files *files, bool is_whole);
asdic_status __wrap_asdic_files_commit(asdic_files *files, bool is_whole);

double __wrap_asdic_clock_s(void) {
    return __real_asdic_clock_s() + ahead_s;
}

asdic_status __wrap_asdic_files_commit(asdic_files *files, bool is_whole) {
    ahead_s += ON_S;
    return __real_asdic_files_commit(files, is_whole);
}

static double number_in(const char *json, const char *key) {
    const char *at = strstr(json, key);
    assert_non_null(at);
    return strtod(at + strlen(key), NULL);
}

static void times_hold_what_the_end_takes(void **state) {
    (void)state;
    size_t length;
    fixture f;
    begin(&f);
    assert_int_equal(run(&f, 1, asdic_run_options_default(), "timed"), ASDIC_OK);
    char *json = read_file("timed", "run.json", &length);
    double write_s = number_in(json, "\"write\": "), whole_s = number_in(json, "\"whole\": ");
    assert_true(write_s >= ON_S && write_s <= whole_s);
    assert_true(whole_s < ON_S + 100.0);
    free(json);
    end(&f);
}

/* Remarks and reasons, wherever the program that runs the mission is at home. */
static void locales_change_no_text(void **state) {
    (void)state;
    size_t length;
    fixture f;
    begin(&f);
    if (!set_german_locale()) {
        end(&f);
        skip();
    }
    asdic_status status = run(&f, 1, asdic_run_options_default(), "german");
    setlocale(LC_ALL, "C");
    assert_int_equal(status, ASDIC_OK);
    char *here = read_file("reference", "run.json", &length),
         *there = read_file("german", "run.json", &length);
    char *text = strstr(here, "\"remarks\""), *other = strstr(there, "\"remarks\"");
    assert_non_null(text);
    assert_non_null(other);
    *strstr(text, "\"time_s\"") = *strstr(other, "\"time_s\"") = 0;
    assert_non_null(strstr(text, "from 7.0 m"));
    assert_string_equal(text, other);
    free(here);
    free(there);
    end(&f);
}

static void devices_do_not_change_a_byte(void **state) {
    (void)state;
    fixture f;
    begin(&f);
    f.devices[1].together = 3;
    f.devices[2].together = ASDIC_LEARN_BLOCK;
    assert_int_equal(run(&f, 3, asdic_run_options_default(), "three"), ASDIC_OK);
    for (int i = 0; i < 3; i++) {
        assert_true(f.devices[i].pings > 0);
    }
    assert_int_equal(f.devices[0].pings + f.devices[1].pings + f.devices[2].pings, PINGS);
    assert_same_files("reference", "three");
    end(&f);
}

static void lost_device_is_replaced(void **state) {
    (void)state;
    /* One device fails at once, one at its first ping, one later; another order each time. */
    for (size_t k = 0; k < 6; k++) {
        char name[16];
        fixture f;
        begin(&f);
        f.devices[k % 3].fails_after = k;
        f.devices[k % 3].together = k / 2; /* fails within a batch */
        f.devices[(k + 1) % 3].refuses = k > 2;
        /* However late it comes to its pings, some are left. */
        f.devices[(k + 1) % 3].after = f.devices[(k + 2) % 3].after = &f.devices[k % 3];
        snprintf(name, sizeof name, "lost%zu", k);
        assert_int_equal(run(&f, 3, asdic_run_options_default(), name), ASDIC_OK);
        assert_same_files("reference", name);
        char expected[64];
        snprintf(expected, sizeof expected, "device 'fake %zu' failed", k % 3);
        assert_non_null(strstr(f.warnings, expected));
        end(&f);
    }
}

static void losing_all_devices_keeps_what_was_done(void **state) {
    (void)state;
    fixture f;
    begin(&f);
    f.devices[0].fails_after = 20;
    f.devices[1].fails_after = 30;
    assert_int_equal(run(&f, 2, asdic_run_options_default(), "dead"), ASDIC_ERROR_DEVICE_LOST);
    assert_non_null(strstr(asdic_context_error(f.ctx), "--resume"));
    /* Pings after the first gap are lost; those before are kept. */
    assert_true(f.reported > 0 && f.reported <= 50);
    assert_state("dead", "interrupted", f.reported);
    assert_no_part("dead");
    f.devices[0].fails_after = f.devices[1].fails_after = SIZE_MAX;
    assert_int_equal(run(&f, 2, (asdic_run_options){.count = SIZE_MAX, .resume = true}, "dead"),
                     ASDIC_OK);
    assert_same_files("reference", "dead");
    assert_state("dead", "complete", PINGS);
    end(&f);
}

static void no_device_leaves_no_folder(void **state) {
    (void)state;
    fixture f;
    begin(&f);
    f.devices[0].refuses = f.devices[1].refuses = true;
    assert_int_equal(run(&f, 2, asdic_run_options_default(), "none"), ASDIC_ERROR_DEVICE);
    assert_int_not_equal(access(in_folder("none"), F_OK), 0);
    end(&f);
}

/* What cannot be meant touches nothing. */
static void what_cannot_be_meant_is_refused(void **state) {
    (void)state;
    const struct {
        asdic_run_options options;
        const char *says;
    } rows[] = {
        {{.count = PINGS + 1},
         "151 pings from ping 0 on go beyond the mission's 150 pings (0..149)"},
        {{.first = 100, .count = 51},
         "51 pings from ping 100 on go beyond the mission's 150 pings"},
        {{.first = 2, .count = SIZE_MAX - 1}, "go beyond the mission's 150 pings"},
        {{.first = PINGS, .count = SIZE_MAX},
         "ping 150 asked for, but the mission has pings 0..149"},
        {{.first = 3}, "a run of no pings from ping 3 on; SIZE_MAX asks for all"},
        {{.count = SIZE_MAX, .force = true, .resume = true}, "give one of them"},
    };
    fixture f;
    begin(&f);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        assert_int_equal(run(&f, 1, rows[i].options, "refused"), ASDIC_ERROR_ARGUMENT);
        assert_contains(asdic_context_error(f.ctx), rows[i].says);
        assert_int_equal(f.devices[0].pings, 0);
    }
    end(&f);
}

static void devices_are_all_there(void **state) {
    (void)state;
    fixture f;
    begin(&f);
    f.pointers[1] = NULL;
    assert_int_equal(run(&f, 3, asdic_run_options_default(), "gap"), ASDIC_ERROR_ARGUMENT);
    assert_contains(asdic_context_error(f.ctx), "a mission, options and a device are needed");
    assert_int_not_equal(access(in_folder("gap"), F_OK), 0);
    end(&f);
}

static void remove_folder(void *user, const asdic_run_progress *progress) {
    char command[256];
    snprintf(command, sizeof command, "rm -r %s", (const char *)user);
    if (progress->pings_done == 20) {
        assert_int_equal(system(command), 0);
    }
}

static void nothing_is_kept_in_a_folder_that_is_gone(void **state) {
    (void)state;
    fixture f;
    begin(&f);
    asdic_run_options options = asdic_run_options_default();
    options.folder = options.user = in_folder("gone");
    options.progress = remove_folder;
    assert_int_equal(asdic_mission_run(f.ctx, f.mission, f.pointers, 1, &options), ASDIC_ERROR_IO);
    assert_contains(asdic_context_error(f.ctx), "has been removed, and with it its pings");
    assert_null(strstr(asdic_context_error(f.ctx), "--resume"));
    end(&f);
}

static void no_background_of_no_kind(void **state) {
    (void)state;
    fixture f;
    begin(&f);
    asdic_detect_options options = asdic_detect_options_default();
    options.background = (asdic_background_source)9;
    assert_int_equal(asdic_run_detect(f.ctx, in_folder("reference"), &options, NULL),
                     ASDIC_ERROR_ARGUMENT);
    assert_string_equal(asdic_context_error(f.ctx), "no background of kind 9");
    end(&f);
}

/* At 0 dB the noise drowns the water's echoes, at 200 dB it does not. */
static void set_level(fixture *f, double source_level_db) {
    f->mission->settings.sonar.source_level_db = source_level_db;
}

/* A run's folder keeps the file's text. Rays and seed are kept beside it. */
static void what_the_text_does_not_say_is_not_run(void **state) {
    (void)state;
    for (int k = 0; k < 4; k++) {
        fixture f;
        begin(&f);
        asdic_choices before = asdic_mission_get_choices(f.mission), choices = before;
        char name[16];
        choices.seed += k == 0;
        choices.rays += k == 0;
        choices.source_level_db += k == 1;
        choices.wind_speed_kn += k == 2;
        choices.bottom.value[0] += k == 3;
        assert_ok(f.ctx, asdic_mission_choose(f.ctx, f.mission, &choices));
        asdic_status status = run(&f, 1, asdic_run_options_default(), k ? "unsaid" : "said");
        assert_int_equal(status, k ? ASDIC_ERROR_UNSUPPORTED : ASDIC_OK);
        assert_int_equal(access(in_folder("unsaid"), F_OK), -1);
        assert_true(k == 0 || strstr(asdic_context_error(f.ctx), "settings or choices"));
        snprintf(name, sizeof name, "said_again_%d", k);
        assert_ok(f.ctx, asdic_mission_choose(f.ctx, f.mission, &before));
        assert_ok(f.ctx, run(&f, 1, asdic_run_options_default(), name));
        end(&f);
    }
}

static void parts_join_to_the_whole(void **state) {
    (void)state;
    fixture f;
    begin(&f);
    asdic_run_options options = asdic_run_options_default();
    options.first = 0;
    options.count = 40;
    assert_int_equal(run(&f, 1, options, "a"), ASDIC_OK);
    options.first = 40;
    options.count = 63;
    assert_int_equal(run(&f, 2, options, "b"), ASDIC_OK);
    options.first = 103;
    options.count = SIZE_MAX;
    assert_int_equal(run(&f, 3, options, "c"), ASDIC_OK);
    const char *parts[] = {in_folder("c"), in_folder("a"), in_folder("b")};
    char whole[256];
    snprintf(whole, sizeof whole, "%s/whole", run_rig_folder);
    assert_int_equal(asdic_run_merge(f.ctx, parts, 3, whole, false), ASDIC_OK);
    assert_same_files("reference", "whole");
    assert_state("whole", "complete", PINGS);
    assert_int_equal(asdic_run_merge(f.ctx, parts, 3, whole, false), ASDIC_ERROR_EXISTS);
    assert_int_equal(asdic_run_merge(f.ctx, parts, 3, whole, true), ASDIC_OK);
    /* A gap, an overlap, another seed, and a result on top of a part are refused. */
    char other[256];
    snprintf(other, sizeof other, "%s/other", run_rig_folder);
    assert_int_equal(asdic_run_merge(f.ctx, parts, 2, other, false), ASDIC_ERROR_INPUT);
    const char *twice[] = {parts[1], parts[1]};
    assert_int_equal(asdic_run_merge(f.ctx, twice, 2, other, false), ASDIC_ERROR_INPUT);
    assert_int_equal(asdic_run_merge(f.ctx, parts, 3, parts[0], true), ASDIC_ERROR_ARGUMENT);
    asdic_mission_sampling(f.mission)->seed = 2;
    options.force = true;
    assert_int_equal(run(&f, 1, options, "c"), ASDIC_OK);
    parts[0] = in_folder("c");
    assert_int_equal(asdic_run_merge(f.ctx, parts, 3, other, false), ASDIC_ERROR_INPUT);
    assert_non_null(strstr(asdic_context_error(f.ctx), "seed"));
    asdic_mission_sampling(f.mission)->seed = 1;
    set_level(&f, 200.0);
    assert_int_equal(run(&f, 1, options, "c"), ASDIC_OK);
    assert_int_equal(asdic_run_merge(f.ctx, parts, 3, other, false), ASDIC_ERROR_INPUT);
    assert_non_null(strstr(asdic_context_error(f.ctx), "differ in their choice of terms"));
    assert_int_not_equal(access(other, F_OK), 0);
    end(&f);
}

/* Sums, errors, times and devices of a run, of the same in two calls, and of its parts joined. */
static void sums_are_of_all_pings(void **state) {
    (void)state;
    static const char *const names[] = {"sum_a", "sum_b", "sum_ab", "sum_on"};
    asdic_run_facts facts[4];
    asdic_arena arena = {0};
    fixture f;
    begin(&f);
    f.devices[0].saturated = 3;
    asdic_run_options options = asdic_run_options_default();
    options.count = 40;
    assert_int_equal(run(&f, 1, options, names[0]), ASDIC_OK);
    assert_non_null(strstr(f.warnings, "120 echoes were too strong"));
    f.warnings[0] = 0;
    options.first = 40;
    options.count = SIZE_MAX;
    f.pointers[0] = &f.devices[1];
    assert_int_equal(run(&f, 1, options, names[1]), ASDIC_OK);
    assert_string_equal(f.warnings, "");
    const char *parts[] = {in_folder(names[0]), in_folder(names[1])};
    assert_int_equal(asdic_run_merge(f.ctx, parts, 2, in_folder(names[2]), false), ASDIC_OK);
    f.pointers[0] = &f.devices[0];
    options.first = 0;
    f.stop_at = 40;
    f.devices[0].delay_us = 1500; /* not done before it is stopped */
    assert_int_equal(run(&f, 1, options, names[3]), ASDIC_ERROR_INTERRUPTED);
    size_t kept = f.reported;
    end(&f);
    begin(&f);
    f.pointers[0] = &f.devices[1];
    options.resume = true;
    assert_int_equal(run(&f, 1, options, names[3]), ASDIC_OK);
    const uint64_t pings[] = {40, PINGS - 40, PINGS, PINGS}, saturated[] = {120, 0, 120, 3 * kept};
    for (size_t i = 0; i < 4; i++) {
        assert_int_equal(asdic_run_facts_read(f.ctx, in_folder(names[i]), &arena, &facts[i]),
                         ASDIC_OK);
        assert_int_equal(facts[i].pings, pings[i]);
        assert_int_equal(facts[i].pings_planned, pings[i]);
        assert_int_equal(facts[i].rays_traced, 1000 * pings[i]);
        assert_int_equal(facts[i].saturated, saturated[i]);
        assert_close(facts[i].errors.worst_db, 0.125, 0);
        assert_int_equal(facts[i].device_count, i < 2 ? 1 : 2);
    }
    const asdic_run_times *a = &facts[0].times, *b = &facts[1].times, *ab = &facts[2].times;
    const double sums_s[][3] = {{a->plan_s, b->plan_s, ab->plan_s},
                                {a->setup_s, b->setup_s, ab->setup_s},
                                {a->simulate_s, b->simulate_s, ab->simulate_s},
                                {a->devices_s, b->devices_s, ab->devices_s},
                                {a->write_s, b->write_s, ab->write_s},
                                {a->pictures_s, b->pictures_s, ab->pictures_s},
                                {a->whole_s, b->whole_s, ab->whole_s}};
    for (size_t i = 0; i < 7; i++) {
        assert_close(sums_s[i][2], sums_s[i][0] + sums_s[i][1], 0.002); /* printed in ms */
    }
    assert_close_relative(facts[2].rays_per_s, 1000.0 * PINGS / ab->simulate_s, 0.1);
    asdic_arena_finish(&arena);
    end(&f);
}

static void folders_are_not_overwritten(void **state) {
    (void)state;
    fixture f;
    begin(&f);
    assert_int_equal(run(&f, 1, asdic_run_options_default(), "reference"), ASDIC_ERROR_EXISTS);
    assert_int_equal(run(&f, 1, asdic_run_options_default(), "scene.yaml"), ASDIC_ERROR_EXISTS);
    assert_int_equal(run(&f, 1, asdic_run_options_default(), "no/such/folder"), ASDIC_ERROR_IO);
    asdic_mission_sampling(f.mission)->seed = 5;
    asdic_run_options resume = {.count = SIZE_MAX, .resume = true};
    assert_int_equal(run(&f, 1, resume, "reference"), ASDIC_ERROR_EXISTS);
    assert_non_null(strstr(asdic_context_error(f.ctx), "seed"));
    asdic_mission_sampling(f.mission)->seed = 1;
    set_level(&f, 200.0);
    assert_int_equal(run(&f, 1, resume, "reference"), ASDIC_ERROR_EXISTS);
    assert_non_null(strstr(asdic_context_error(f.ctx), "another choice of terms"));
    set_level(&f, 0.0);
    resume.count = 3;
    assert_int_equal(run(&f, 1, resume, "reference"), ASDIC_ERROR_EXISTS);
    asdic_run_options beyond = {.first = PINGS, .count = 1};
    assert_int_equal(run(&f, 1, beyond, "beyond"), ASDIC_ERROR_ARGUMENT);
    assert_int_equal(f.devices[0].pings, 0);
    end(&f);
}

/* The library's answer, unless a test says that it was built without cairo. */
static bool is_without_cairo;
bool __real_asdic_picture_annotated(void);
bool __wrap_asdic_picture_annotated(void);
bool __wrap_asdic_picture_annotated(void) {
    return !is_without_cairo && __real_asdic_picture_annotated();
}

static void formats_that_a_build_lacks_are_refused(void **state) {
    (void)state;
    static const struct {
        asdic_picture_format format;
        bool needs_cairo;
    } cases[] = {{ASDIC_PICTURE_BY_NAME, false},
                 {ASDIC_PICTURE_PNG, false},
                 {ASDIC_PICTURE_PDF, true},
                 {ASDIC_PICTURE_SVG, true}};
    fixture f;
    begin(&f);
    assert_int_equal(run(&f, 1, asdic_run_options_default(), "drawn"), ASDIC_OK);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        for (int without = 0; without < 2; without++) {
            asdic_render_options options = asdic_render_options_default();
            options.images = 1u << ASDIC_IMAGE_WATERFALL;
            options.format = cases[i].format;
            is_without_cairo = without;
            bool has = !cases[i].needs_cairo || asdic_picture_annotated();
            asdic_status status = asdic_run_render(f.ctx, in_folder("drawn"), &options);
            is_without_cairo = false;
            assert_int_equal(status, has ? ASDIC_OK : ASDIC_ERROR_UNSUPPORTED);
            assert_true(has || strstr(asdic_context_error(f.ctx), "no PDF or SVG"));
        }
    }
    end(&f);
}

static bool count_frames(void *user, const char *path) {
    assert_non_null(path);
    return ++*(int *)user < 3;
}

/* Frames are one picture of every ping; what shows many pings is none. */
static void frames_are_of_single_pings(void **state) {
    (void)state;
    fixture f;
    int frames = 0;
    begin(&f);
    assert_int_equal(run(&f, 1, asdic_run_options_default(), "framed"), ASDIC_OK);
    asdic_render_options options = asdic_render_options_default();
    char *path = strdup(in_folder("frame.png"));
    /* One that is missing alone, of a run that is there: where to, or who is asked. */
    assert_int_equal(
        asdic_run_render_frames(f.ctx, in_folder("framed"), &options, count_frames, &frames),
        ASDIC_ERROR_ARGUMENT);
    assert_non_null(strstr(asdic_context_error(f.ctx), "an argument that is needed is NULL"));
    assert_int_equal(asdic_run_mosaic(f.ctx, in_folder("framed"), 0.0, &options),
                     ASDIC_ERROR_ARGUMENT);
    assert_non_null(strstr(asdic_context_error(f.ctx), "an argument that is needed is NULL"));
    options.path = path;
    assert_int_equal(asdic_run_render_frames(f.ctx, in_folder("framed"), &options, NULL, &frames),
                     ASDIC_ERROR_ARGUMENT);
    assert_non_null(strstr(asdic_context_error(f.ctx), "an argument that is needed is NULL"));
    for (unsigned images = 1; images < 1u << (ASDIC_IMAGE_PLAN + 2); images++) {
        if (images == 1u << ASDIC_IMAGE_ASCOPE || images == 1u << ASDIC_IMAGE_FAN) {
            continue;
        }
        options.images = images;
        assert_int_equal(
            asdic_run_render_frames(f.ctx, in_folder("framed"), &options, count_frames, &frames),
            ASDIC_ERROR_ARGUMENT);
        assert_non_null(strstr(asdic_context_error(f.ctx), "a frame is the fan or the A-scope"));
    }
    assert_int_equal(frames, 0);
    options.images = 1u << ASDIC_IMAGE_ASCOPE;
    options.beam = "forward";
    if (asdic_picture_annotated()) {
        assert_int_equal(
            asdic_run_render_frames(f.ctx, in_folder("framed"), &options, count_frames, &frames),
            ASDIC_OK);
        assert_int_equal(frames, 3); /* it was told to stop */
        unlink(path);
    }
    free(path);
    const double cells_m[] = {-1.0, NAN, INFINITY};
    for (size_t i = 0; i < 3; i++) {
        options = asdic_render_options_default();
        options.path = in_folder("mosaic.png");
        assert_int_equal(asdic_run_mosaic(f.ctx, in_folder("framed"), cells_m[i], &options),
                         ASDIC_ERROR_ARGUMENT);
        assert_non_null(strstr(asdic_context_error(f.ctx), "a mosaic in cells of"));
    }
    options = asdic_render_options_default();
    options.format = (asdic_picture_format)99;
    assert_int_equal(asdic_run_render(f.ctx, in_folder("framed"), &options), ASDIC_ERROR_ARGUMENT);
    options = asdic_render_options_default();
    options.colormap = ASDIC_COLORMAP_COUNT;
    assert_int_equal(asdic_run_render(f.ctx, in_folder("framed"), &options), ASDIC_ERROR_ARGUMENT);
    end(&f);
}

static void count_profiles(void *user, const char *what, size_t done, size_t total) {
    size_t *count = user;
    assert_true(done < total);
    *count += strcmp(what, "beams") == 0 && done == 0;
}

/* What a plane returns is a function of depth, altitude, roll and pitch. Profiles of beams, which take most of the time,
 * are made once for a vehicle that flies level and turns: of 512 beams they took 15 s a ping. */
static void detection_makes_profiles_once(void **state) {
    (void)state;
    fixture f;
    size_t count = 0;
    begin(&f);
    FILE *file = fopen(in_folder("turns.yaml"), "w");
    fprintf(file,
            "version: 1\n"
            "bottom: {depth_m: 12, type: sand}\n"
            "sonar: {frequency_khz: 100, ping_rate_hz: 2, bin_length_m: 1,\n"
            "  receivers: [{name: forward}, {name: down, pitch_deg: 45}]}\n"
            "mission: {waypoints: {speed_mps: 2, points_m: [[0, 0, 5], [9, 0, 5], [9, 9, 5]]}}\n"
            "output: {images: [], csv: none}\n");
    fclose(file);
    asdic_mission_destroy(&f.mission);
    assert_int_equal(asdic_mission_load(f.ctx, in_folder("turns.yaml"), &f.mission), ASDIC_OK);
    assert_true(asdic_mission_ping_count(f.mission) > 10);
    assert_int_equal(run(&f, 1, asdic_run_options_default(), "turns"), ASDIC_OK);
    asdic_detect_options options = asdic_detect_options_default();
    asdic_context_set_progress(f.ctx, count_profiles, &count);
    assert_int_equal(asdic_run_detect(f.ctx, in_folder("turns"), &options, NULL), ASDIC_OK);
    assert_int_equal(count, 1);
    end(&f);
}

/* An argument selects tests by name. */
int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(times_hold_what_the_end_takes),
        cmocka_unit_test(locales_change_no_text),
        cmocka_unit_test(devices_do_not_change_a_byte),
        cmocka_unit_test(lost_device_is_replaced),
        cmocka_unit_test(losing_all_devices_keeps_what_was_done),
        cmocka_unit_test(no_device_leaves_no_folder),
        cmocka_unit_test(what_cannot_be_meant_is_refused),
        cmocka_unit_test(devices_are_all_there),
        cmocka_unit_test(nothing_is_kept_in_a_folder_that_is_gone),
        cmocka_unit_test(no_background_of_no_kind),
        cmocka_unit_test(what_the_text_does_not_say_is_not_run),
        cmocka_unit_test(parts_join_to_the_whole),
        cmocka_unit_test(sums_are_of_all_pings),
        cmocka_unit_test(folders_are_not_overwritten),
        cmocka_unit_test(formats_that_a_build_lacks_are_refused),
        cmocka_unit_test(frames_are_of_single_pings),
        cmocka_unit_test(detection_makes_profiles_once),
    };
    if (argc > 1) {
        cmocka_set_test_filter(argv[1]);
    }
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
