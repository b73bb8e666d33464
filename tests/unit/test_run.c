/*
 * Running a mission over several devices, some of which fail.
 */
#include "run_rig.h"

#include "base/clock.h"
#include "de_locale.h"
#include "mission/mission.h"
#include "mission/run/run_elements.h"
#include "mission/run/run_facts.h"
#include "mission/run/run_files.h"
#include "mission/run/run_records.h"
#include "mission/run/run_size.h"
#include "out/record.h"

#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
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

/* What a disk has left; 0: as it is. */
static uint64_t disk_bytes;

int __real_statvfs64(const char *path, struct statvfs *disk);
int __wrap_statvfs64(const char *path, struct statvfs *disk);

int __wrap_statvfs64(const char *path, struct statvfs *disk) {
    int failed = __real_statvfs64(path, disk);
    if (disk_bytes) {
        disk->f_bavail = disk_bytes;
        disk->f_frsize = 1;
    }
    return failed;
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

/* run.json lists each of the first COUNT devices once. */
static void assert_devices(const char *run_name, size_t count) {
    size_t length;
    char *json = read_file(run_name, "run.json", &length);
    char *list = strstr(json, "\"devices\": [");
    assert_non_null(list);
    *strchr(list, ']') = '\0';
    for (size_t i = 0; i < 3; i++) {
        char name[16];
        snprintf(name, sizeof name, "\"fake %zu\"", i);
        const char *first = strstr(list, name);
        assert_true((first != NULL) == (i < count));
        assert_null(first ? strstr(first + 1, name) : NULL);
    }
    free(json);
}

static void interrupted_run_goes_on(void **state) {
    (void)state;
    asdic_run_options resume = {.count = SIZE_MAX, .resume = true};
    for (size_t stop = 0; stop < 90; stop += 40) {
        fixture f;
        begin(&f);
        f.stop_at = stop;
        f.devices[0].delay_us = f.devices[1].delay_us = 1500; /* not done before it is stopped */
        assert_int_equal(run(&f, 2, resume, "stopped"), ASDIC_ERROR_INTERRUPTED);
        assert_state("stopped", "interrupted", f.reported);
        assert_no_part("stopped");
        end(&f);
    }
    fixture f;
    begin(&f);
    assert_devices("stopped", 2);
    assert_int_equal(run(&f, 1, resume, "stopped"), ASDIC_OK);
    assert_devices("stopped", 2); /* those of earlier calls, too */
    assert_same_files("reference", "stopped");
    size_t pings = f.devices[0].pings + f.devices[1].pings;
    assert_int_equal(run(&f, 2, resume, "stopped"), ASDIC_OK); /* nothing left to do */
    assert_int_equal(f.devices[0].pings + f.devices[1].pings, pings);
    end(&f);
}

/* The ping that an interruption's sentence tells is the mission's, also of a part of it. */
static void interruptions_tell_the_missions_ping(void **state) {
    (void)state;
    asdic_run_options part = {.first = 7, .count = 80, .resume = true};
    for (size_t turn = 0; turn < 2; turn++) { /* while pings are made, and before more are */
        fixture f;
        begin(&f);
        f.stop_at = turn == 0 ? 20 : 10;
        f.devices[0].delay_us = 1500;
        assert_int_equal(run(&f, 1, part, "later"), ASDIC_ERROR_INTERRUPTED);
        size_t ping, kept, planned;
        assert_int_equal(sscanf(asdic_context_error(f.ctx),
                                "interrupted at ping %zu; %zu of %zu pings are kept", &ping, &kept,
                                &planned),
                         3);
        assert_int_equal(planned, 80);
        assert_true(kept >= 20 && kept < 80);
        assert_int_equal(ping, 7 + (turn == 0 ? kept : f.reported));
        end(&f);
    }
}

/* An interruption that comes while the records of an earlier call are checked. */
static void interrupted_while_records_are_checked(void **state) {
    (void)state;
    asdic_run_options resume = {.count = SIZE_MAX, .resume = true};
    fixture f;
    begin(&f);
    f.stop_at = 40;
    f.devices[0].delay_us = 1500;
    assert_int_equal(run(&f, 1, resume, "early"), ASDIC_ERROR_INTERRUPTED);
    size_t kept = f.reported;
    end(&f);
    for (int turn = 0; turn < 2; turn++) {
        char sentence[64];
        snprintf(sentence, sizeof sentence, "; %zu of %d pings are kept", kept, PINGS);
        begin(&f);
        asdic_context_interrupt(f.ctx);
        assert_int_equal(run(&f, 1, resume, "early"), ASDIC_ERROR_INTERRUPTED);
        assert_non_null(strstr(asdic_context_error(f.ctx), sentence));
        assert_int_equal(f.devices[0].pings, 0);
        assert_state("early", "interrupted", 0);
        assert_no_part("early");
        end(&f);
    }
    begin(&f);
    assert_int_equal(run(&f, 1, resume, "early"), ASDIC_OK);
    assert_int_equal(f.devices[0].pings, PINGS - kept);
    assert_same_files("reference", "early");
    asdic_context_interrupt(f.ctx);
    assert_int_equal(run(&f, 1, resume, "early"), ASDIC_ERROR_INTERRUPTED);
    assert_state("early", "complete", PINGS);
    assert_no_part("early");
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

/* An interruption from before the run replaces nothing. */
static void interrupted_before_it_replaces(void **state) {
    (void)state;
    fixture f;
    begin(&f);
    assert_int_equal(run(&f, 1, asdic_run_options_default(), "kept"), ASDIC_OK);
    asdic_context_interrupt(f.ctx);
    asdic_run_options force = {.count = SIZE_MAX, .force = true};
    assert_int_equal(run(&f, 1, force, "kept"), ASDIC_ERROR_INTERRUPTED);
    assert_non_null(strstr(asdic_context_error(f.ctx), "/kept' was changed"));
    assert_state("kept", "complete", PINGS);
    assert_same_files("reference", "kept");
    end(&f);
}

/* Makes of a finished run what kill -9 leaves: the state of the beginning, files without their
 * names, SHARE of the records, the last one torn. */
static void undo(const char *run_name, double share) {
    char path[300], part[300];
    size_t length;
    char *json = read_file(run_name, "run.json", &length);
    memcpy(strstr(json, "\"complete\""), "\"running\" ", 10);
    asdic_run_facts_sign(json, length);
    snprintf(path, sizeof path, "%s/%s/run.json", run_rig_folder, run_name);
    FILE *file = fopen(path, "wb");
    fwrite(json, 1, length, file);
    fclose(file);
    free(json);
    snprintf(path, sizeof path, "%s/%s/bins.csv", run_rig_folder, run_name);
    assert_int_equal(unlink(path), 0);
    snprintf(path, sizeof path, "%s/%s/pings.npy", run_rig_folder, run_name);
    snprintf(part, sizeof part, "%s/%s/pings.npy.part", run_rig_folder, run_name);
    assert_int_equal(rename(path, part), 0);
    free(read_file(run_name, "pings.npy.part", &length));
    assert_int_equal(truncate(part, (off_t)(share * (double)length)), 0);
}

static size_t bins_of(fixture *f, const char *run_name) {
    asdic_run *opened;
    assert_int_equal(asdic_run_open(f->ctx, in_folder(run_name), &opened), ASDIC_OK);
    size_t bins = asdic_run_get_info(opened).bins;
    asdic_run_close(&opened);
    return bins;
}

/* Changes one bit of ping PING's record. */
static void flip(const char *run_name, size_t bins, size_t ping, size_t byte) {
    const asdic_record_layout layout = {.beams = BEAMS, .bins = bins};
    size_t length, each = asdic_record_stored_bytes(&layout);
    char path[300], *bytes = read_file(run_name, "pings.npy", &length);
    size_t at = length - (PINGS - ping) * each + byte;
    snprintf(path, sizeof path, "%s/%s/pings.npy", run_rig_folder, run_name);
    FILE *file = fopen(path, "r+b");
    fseek(file, (long)at, SEEK_SET);
    fputc(bytes[at] ^ 0x10, file);
    fclose(file);
    free(bytes);
}

static void killed_run_goes_on(void **state) {
    (void)state;
    const double shares[] = {0.66, 0.999, 1.0, 1e-5}; /* the last one cuts the header */
    asdic_run_options resume = {.count = SIZE_MAX, .resume = true};
    fixture f;
    begin(&f);
    assert_int_equal(run(&f, 1, asdic_run_options_default(), "killed"), ASDIC_OK);
    for (size_t i = 0; i < sizeof shares / sizeof *shares; i++) {
        f.devices[0].pings = 0;
        undo("killed", shares[i]);
        assert_int_equal(run(&f, 1, resume, "killed"), ASDIC_OK);
        assert_close((double)f.devices[0].pings, (1.0 - shares[i]) * PINGS, 2.0);
        assert_same_files("reference", "killed");
        assert_no_part("killed");
    }
    flip("killed", bins_of(&f, "killed"), 3, 12);
    undo("killed", 1.0);
    f.warnings[0] = '\0';
    assert_int_equal(run(&f, 1, resume, "killed"), ASDIC_OK);
    assert_contains(f.warnings, "killed/pings.npy.part' is damaged: ping 3 ");
    assert_same_files("reference", "killed");
    end(&f);
}

static void bad_records_are_named_and_made_again(void **state) {
    (void)state;
    const size_t bad[] = {3, 4, 100};
    asdic_run_options resume = {.count = SIZE_MAX, .resume = true};
    fixture f;
    asdic_run *opened;
    asdic_record record;
    begin(&f);
    assert_int_equal(run(&f, 1, asdic_run_options_default(), "flawed"), ASDIC_OK);
    size_t bins = bins_of(&f, "flawed");
    const asdic_record_layout layout = {.beams = BEAMS, .bins = bins};
    size_t each = asdic_record_stored_bytes(&layout);
    flip("flawed", bins, bad[0], 12);       /* the head */
    flip("flawed", bins, bad[1], each / 2); /* a level */
    flip("flawed", bins, bad[2], each - 1); /* the sum */
    assert_int_equal(asdic_run_open(f.ctx, in_folder("flawed"), &opened), ASDIC_OK);
    for (size_t i = 0; i < PINGS; i++) {
        bool is_bad = i == bad[0] || i == bad[1] || i == bad[2];
        assert_int_equal(asdic_run_read(opened, i, &record), is_bad ? ASDIC_ERROR_INPUT : ASDIC_OK);
        char name[32];
        snprintf(name, sizeof name, "ping %zu is", i);
        assert_true(!is_bad || strstr(asdic_context_error(f.ctx), name));
    }
    asdic_run_close(&opened);
    const char *parts[] = {in_folder("flawed")};
    assert_int_equal(asdic_run_merge(f.ctx, parts, 1, in_folder("wrong"), false),
                     ASDIC_ERROR_INPUT);
    assert_non_null(strstr(asdic_context_error(f.ctx), "ping 3 is"));
    f.devices[0].pings = 0;
    assert_int_equal(run(&f, 1, resume, "flawed"), ASDIC_OK);
    assert_int_equal(f.devices[0].pings, 3);
    assert_same_files("reference", "flawed");
    end(&f);
}

/* A complete run of which something is gone: made from the records, or simulated where those are
 * gone as well. */
static void complete_runs_are_checked(void **state) {
    (void)state;
    static const struct {
        const char *name;
        off_t left; /* bytes; -1: no file */
        size_t simulated;
    } cases[] = {{"bins.csv", 1000, 0},  {"bins.csv", -1, 0},      {"track.csv", 20, 0},
                 {"levels.npy", -1, 0},  {"pings.npy", -1, PINGS}, {"pings.npy", 5000, PINGS - 1},
                 {"pings.npy", 0, PINGS}};
    asdic_run_options resume = {.count = SIZE_MAX, .resume = true};
    fixture f;
    begin(&f);
    assert_int_equal(run(&f, 1, asdic_run_options_default(), "checked"), ASDIC_OK);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char path[300];
        snprintf(path, sizeof path, "%s/checked/%s", run_rig_folder, cases[i].name);
        assert_int_equal(cases[i].left < 0 ? unlink(path) : truncate(path, cases[i].left), 0);
        f.devices[0].pings = 0;
        assert_int_equal(run(&f, 1, resume, "checked"), ASDIC_OK);
        assert_int_equal(f.devices[0].pings, cases[i].simulated);
        assert_same_files("reference", "checked");
        assert_no_part("checked");
    }
    f.devices[0].pings = 0;
    assert_int_equal(run(&f, 1, resume, "checked"), ASDIC_OK);
    assert_int_equal(f.devices[0].pings, 0);
    end(&f);
}

static void full_disk_loses_nothing(void **state) {
    (void)state;
    fixture f;
    begin(&f);
    struct rlimit before, small;
    getrlimit(RLIMIT_FSIZE, &before);
    signal(SIGXFSZ, SIG_IGN);
    small = before;
    small.rlim_cur = 100000;
    setrlimit(RLIMIT_FSIZE, &small);
    asdic_status status = run(&f, 2, asdic_run_options_default(), "full");
    setrlimit(RLIMIT_FSIZE, &before);
    assert_int_equal(status, ASDIC_ERROR_IO);
    assert_non_null(strstr(asdic_context_error(f.ctx), "File too large"));
    assert_true(f.reported > 5 && f.reported < PINGS);
    asdic_run_options resume = {.count = SIZE_MAX, .resume = true};
    assert_int_equal(run(&f, 2, resume, "full"), ASDIC_OK);
    assert_same_files("reference", "full");
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
        assert_close(facts[i].stderr_worst_db, 0.125, 0);
        assert_int_equal(facts[i].device_count, i < 2 ? 1 : 2);
    }
    const asdic_run_times *a = &facts[0].times, *b = &facts[1].times, *ab = &facts[2].times;
    const double sums_s[][3] = {{a->setup_s, b->setup_s, ab->setup_s},
                                {a->simulate_s, b->simulate_s, ab->simulate_s},
                                {a->devices_s, b->devices_s, ab->devices_s},
                                {a->write_s, b->write_s, ab->write_s},
                                {a->pictures_s, b->pictures_s, ab->pictures_s},
                                {a->whole_s, b->whole_s, ab->whole_s}};
    for (size_t i = 0; i < 6; i++) {
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

/* 200 coherent pings, with their pressures or without. */
static asdic_mission *coherent_mission(asdic_context *ctx, bool has_elements) {
    char text[512];
    asdic_mission *mission = NULL;
    snprintf(text, sizeof text,
             "version: 1\nbottom: {depth_m: 12, type: sand}\nsonar: {frequency_khz: 100, "
             "ping_rate_hz: 20, source_level_db: 200,\n"
             "  array: {elements: 64, beams: {count: 3, sector_deg: 30}}}\n"
             "mission: {pose: {position_m: [0, 0, 5]}, pings: 200}\nsampling: {coherent: true}\n"
             "output: {images: [], csv: none, elements: %s}\n",
             has_elements ? "true" : "false");
    const asdic_scene_text scene = {.text = text, .length = strlen(text), .name = "s.yaml"};
    assert_int_equal(asdic_mission_load_text(ctx, &scene, &mission), ASDIC_OK);
    return mission;
}

static void elements_are_of_one_process(void **state) {
    (void)state;
    fixture f;
    begin(&f);
    asdic_mission *m = coherent_mission(f.ctx, true);
    asdic_team team = {.size = 2};
    const asdic_run_options options = {
        .count = SIZE_MAX, .team = &team, .folder = in_folder("shared")};
    assert_int_equal(asdic_mission_run(f.ctx, m, f.pointers, 1, &options), ASDIC_ERROR_UNSUPPORTED);
    assert_non_null(strstr(asdic_context_error(f.ctx), "use --shard"));
    assert_int_not_equal(access(options.folder, F_OK), 0);
    asdic_mission_destroy(&m);
    end(&f);
}

static void sizes_are_told_in_their_own_units(void **state) {
    (void)state;
    static const struct {
        uint64_t bytes;
        const char *text;
    } cases[] = {{0, "0 kB"},
                 {614, "0.614 kB"},
                 {36700, "36.7 kB"},
                 {999499, "999 kB"},
                 {999500, "1 MB"},
                 {614000000, "614 MB"},
                 {15600000000, "15.6 GB"},
                 {UINT64_MAX, "1.84e+04 PB"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[ASDIC_BYTES_TEXT];
        assert_string_equal(asdic_bytes_text(cases[i].bytes, text), cases[i].text);
    }
}

/* The records, truth and elements of a run that goes on are there, and are not written again. */
static void room_is_for_what_is_to_come(void **state) {
    (void)state;
    fixture f;
    begin(&f);
    asdic_mission *m[2] = {coherent_mission(f.ctx, false), coherent_mission(f.ctx, true)};
    uint64_t needed = asdic_mission_run_bytes(m[1], 200);
    uint64_t there = needed - asdic_mission_run_bytes(m[0], 200);
    char says[512], sizes[3][ASDIC_BYTES_TEXT];
    assert_true(there > needed / 2);
    asdic_run_options resume = {.count = SIZE_MAX, .resume = true, .folder = in_folder("room")};
    assert_int_equal(mkdir(resume.folder, 0777), 0);
    fclose(fopen(in_folder("room/run.json"), "w"));
    static const char *const names[] = {"elements.npy",   "elements.npy.part", "truth.npy",
                                        "truth.npy.part", "pings.npy",         "pings.npy.part"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char path[256];
        snprintf(path, sizeof path, "%s/%s", resume.folder, names[i]);
        f.warnings[0] = 0;
        fclose(fopen(path, "w"));
        assert_int_equal(truncate(path, (off_t)there), 0);
        disk_bytes = needed - there;
        assert_int_equal(asdic_run_check_room(f.ctx, m[1], &resume), ASDIC_OK);
        assert_string_equal(f.warnings, "");
        disk_bytes = needed - there - 1;
        assert_int_equal(asdic_run_check_room(f.ctx, m[1], &resume), ASDIC_OK);
        snprintf(says, sizeof says,
                 "'%s' has room for %s, but what is still to be written takes about %s",
                 resume.folder, asdic_bytes_text(disk_bytes, sizes[0]),
                 asdic_bytes_text(needed - there, sizes[1]));
        assert_non_null(strstr(f.warnings, says));
        assert_int_equal(unlink(path), 0);
    }
    resume.resume = false;
    disk_bytes = needed;
    assert_int_equal(asdic_run_check_room(f.ctx, m[1], &resume), ASDIC_OK);
    /* Of all pings, of some and of those that are left; what the sentence says of them. */
    static const struct {
        size_t first, count, pings;
    } parts[] = {{0, SIZE_MAX, 200}, {0, 200, 200}, {150, 20, 20}, {190, 20, 10}, {199, 1, 1}};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        resume.first = parts[i].first;
        resume.count = parts[i].count;
        needed = asdic_mission_run_bytes(m[1], parts[i].pings);
        disk_bytes = needed;
        assert_int_equal(asdic_run_check_room(f.ctx, m[1], &resume), ASDIC_OK);
        disk_bytes = needed - 1;
        assert_int_equal(asdic_run_check_room(f.ctx, m[1], &resume), ASDIC_ERROR_IO);
        snprintf(says, sizeof says,
                 "'%s' has room for %s, but %zu pings of %s take %s; choose another", resume.folder,
                 asdic_bytes_text(disk_bytes, sizes[0]), parts[i].pings,
                 asdic_bytes_text(asdic_mission_ping_bytes(m[1]), sizes[1]),
                 asdic_bytes_text(needed, sizes[2]));
        assert_non_null(strstr(asdic_context_error(f.ctx), says));
        resume.force = true;
        assert_int_equal(asdic_run_check_room(f.ctx, m[1], &resume), ASDIC_OK);
        resume.force = false;
    }
    disk_bytes = 1;
    resume.first = 200;
    assert_int_equal(asdic_run_check_room(f.ctx, m[1], &resume), ASDIC_OK);
    disk_bytes = 0;
    asdic_mission_destroy(&m[0]);
    asdic_mission_destroy(&m[1]);
    end(&f);
}

/* Opens, gives a record where there is none yet, and closes; 0 when each went well. */
static int use_records(asdic_context *ctx, asdic_store_mode mode, bool is_whole) {
    static const asdic_records_shape shape = {
        .name = "r.npy", .dtype = "<f4", .rest = "", .bytes = 4};
    asdic_records *records = NULL;
    float number = 1.5f;
    int bad = asdic_records_open(ctx, in_folder("."), mode, &shape, &records) != ASDIC_OK;
    if (!bad && asdic_records_count(records) == 0) {
        bad |= asdic_records_write(records, 0, &number) != ASDIC_OK;
    }
    if (!bad) {
        number = 0.0f;
        bad |= asdic_records_read(records, 0, &number) != ASDIC_OK || number != 1.5f;
    }
    if (!bad && is_whole) {
        bad |= asdic_records_commit(records) != ASDIC_OK;
    }
    asdic_records_close(&records);
    return bad || fcntl(0, F_GETFD) != -1; /* closed as well */
}

/* Where a program has closed its standard input, the first file that it opens has the number 0. */
static void files_may_have_any_number(void **state) {
    (void)state;
    asdic_run *run_folder = NULL;
    fixture f;
    begin(&f);
    int input = dup(0);
    close(0);
    int bad = use_records(f.ctx, ASDIC_STORE_CREATE, false);
    bad |= use_records(f.ctx, ASDIC_STORE_RESUME, true) << 1;
    bad |= use_records(f.ctx, ASDIC_STORE_READ, false) << 2;
    asdic_status opened = asdic_run_open(f.ctx, in_folder("reference"), &run_folder);
    asdic_run_close(&run_folder);
    if (input >= 0) {
        dup2(input, 0);
        close(input);
    }
    assert_int_equal(bad, 0);
    assert_int_equal(opened, ASDIC_OK);
    assert_int_equal(unlink(in_folder("r.npy")), 0);
    end(&f);
}

/* What a run that goes on finds behind its last ping goes; what it finds before stays. */
static void elements_end_with_the_run(void **state) {
    (void)state;
    fixture f;
    begin(&f);
    for (size_t pings = 1; pings <= 4; pings++) {
        asdic_elements_shape shape = {.pings = 3, .elements = 2, .samples = 1}, kept;
        asdic_elements *elements = NULL;
        float pressure[4] = {0.0f};
        assert_ok(f.ctx, asdic_elements_open(f.ctx, in_folder("."), ASDIC_STORE_CREATE, &shape,
                                             &elements));
        for (size_t i = 0; i < 3; i++) {
            pressure[3] = (float)i;
            assert_ok(f.ctx, asdic_elements_write(elements, i, pressure));
        }
        asdic_elements_close(&elements);
        shape.pings = pings;
        assert_ok(f.ctx, asdic_elements_open(f.ctx, in_folder("."), ASDIC_STORE_RESUME, &shape,
                                             &elements));
        for (size_t i = 0; i < 4; i++) {
            assert_int_equal(asdic_elements_has(elements, i), i < pings && i < 3);
        }
        assert_ok(f.ctx, asdic_elements_read(elements, 0, pressure));
        assert_close(pressure[3], 0.0, 0.0);
        assert_ok(f.ctx, asdic_elements_commit(elements));
        asdic_elements_close(&elements);
        const asdic_settings settings = {.elements = true, .sonar.array.elements = 2};
        assert_ok(f.ctx, asdic_elements_shape_read(f.ctx, in_folder("."), &settings, &kept));
        assert_int_equal(kept.pings, pings < 3 ? pings : 3);
        assert_int_equal(unlink(in_folder(ASDIC_ELEMENTS_NAME)), 0);
    }
    end(&f);
}

/* bins.csv says in text, to the last bit, what pings.npy says in binary. */
static void csv_reads_back_to_the_bit(void **state) {
    (void)state;
    fixture f;
    asdic_run *run_folder;
    asdic_record record;
    size_t length, rows = 0;
    begin(&f);
    assert_int_equal(asdic_run_open(f.ctx, in_folder("reference"), &run_folder), ASDIC_OK);
    asdic_run_info info = asdic_run_get_info(run_folder);
    assert_int_equal(info.beams, BEAMS);
    char *csv = read_file("reference", "bins.csv", &length), *line = csv;
    const char header[] = "ping,time_s,beam,bin,range_m,level_db,bottom_db,surface_db,volume_db,"
                          "object_db,multipath_db,noise_db,stderr_db\n";
    assert_memory_equal(line, header, sizeof header - 1);
    line += sizeof header - 1;
    for (size_t ping = 0; ping < info.pings; ping++) {
        assert_int_equal(asdic_run_read(run_folder, ping, &record), ASDIC_OK);
        assert_int_equal(record.ping, ping);
        for (size_t i = 0; i < BEAMS * info.bins; i++, rows++) {
            size_t beam = i / info.bins, bin = i % info.bins;
            char prefix[64];
            int used =
                snprintf(prefix, sizeof prefix, "%zu,%.15g,%s,%zu,%.15g,", ping, record.time_s,
                         info.sonar->receivers[beam].name, bin, (double)bin + 0.5);
            assert_memory_equal(line, prefix, used);
            line += used;
            for (int c = 0; c <= ASDIC_COMPONENT_COUNT; c++) {
                float stored =
                    c < ASDIC_COMPONENT_COUNT ? record.level_db[c][i] : record.stderr_db[i];
                char *after = line;
                float read = strtof(line, &after);
                assert_true(after == line ? isnan(stored) : read == stored);
                assert_int_equal(*after, c < ASDIC_COMPONENT_COUNT ? ',' : '\n');
                line = after + 1;
            }
        }
    }
    assert_int_equal(line - csv, length);
    assert_int_equal(rows, PINGS * BEAMS * info.bins);
    free(csv);
    asdic_run_close(&run_folder);
    end(&f);
}

static void damaged_folders_are_refused(void **state) {
    (void)state;
    fixture f;
    asdic_run *opened;
    begin(&f);
    assert_int_equal(asdic_run_open(f.ctx, run_rig_folder, &opened), ASDIC_ERROR_INPUT);
    assert_int_equal(asdic_run_open(f.ctx, in_folder("nowhere"), &opened), ASDIC_ERROR_INPUT);
    asdic_run_options options = asdic_run_options_default();
    options.count = 3;
    assert_int_equal(run(&f, 1, options, "damaged"), ASDIC_OK);
    char path[300];
    snprintf(path, sizeof path, "%s/damaged/pings.npy", run_rig_folder);
    assert_int_equal(truncate(path, 2000), 0);
    assert_int_equal(asdic_run_open(f.ctx, in_folder("damaged"), &opened), ASDIC_ERROR_INPUT);
    assert_null(opened);
    size_t length;
    char *json = read_file("damaged", "run.json", &length);
    for (size_t cut = 0; cut < length; cut += 97) { /* never whole: the last cut loses a brace */
        FILE *file = fopen(in_folder("damaged/run.json"), "wb");
        fwrite(json, 1, cut, file);
        fclose(file);
        assert_int_equal(asdic_run_open(f.ctx, in_folder("damaged"), &opened), ASDIC_ERROR_INPUT);
    }
    free(json);
    end(&f);
}

/* Puts TEXT into the place of run.json, with KEY's value WRONG, or called otherwise where that is NULL. */
static void write_facts(const char *run_name, const char *text, const char *key,
                        const char *wrong) {
    char name[64], path[300], *whole = NULL;
    snprintf(name, sizeof name, "\n  \"%s\": ", key);
    const char *at = strstr(text, name);
    assert_non_null(at);
    if (wrong) {
        assert_true(asprintf(&whole, "%.*s%s%s%s", (int)(at - text), text, name, wrong,
                             at + strlen(name) + strcspn(at + strlen(name), ",\n")) > 0);
    } else {
        whole = strdup(text);
        whole[at - text + 4] = 'X';
    }
    asdic_run_facts_sign(whole, strlen(whole));
    snprintf(path, sizeof path, "%s/%s/run.json", run_rig_folder, run_name);
    FILE *file = fopen(path, "wb");
    fwrite(whole, 1, strlen(whole), file);
    fclose(file);
    free(whole);
}

static void assert_lacks(fixture *f, const char *run_name, const char *key) {
    asdic_run *opened;
    char says[80];
    snprintf(says, sizeof says, "run.json' is damaged: no valid %s", key);
    assert_int_equal(asdic_run_open(f->ctx, in_folder(run_name), &opened), ASDIC_ERROR_INPUT);
    assert_null(opened);
    assert_contains(asdic_context_error(f->ctx), says);
}

/* What counts something is a whole number; what every run states is missed by its name, and what runs of other
 * versions do not state is not. */
static void facts_are_read_whole(void **state) {
    (void)state;
    static const char *const counts[] = {"seed",          "rays",  "first_ping",
                                         "pings_planned", "pings", "rays_traced",
                                         "saturated",     "beams", "bins"},
                             *const wrong[] = {"-1", "", "3x", "\"\"", "18446744073709551616"};
    static const char *const needed[][2] = {{"version", "version"},
                                            {"state", "state"},
                                            {"scene", "path"},
                                            {"surface", "surface"},
                                            {"bottom", "bottom"},
                                            {"bottom_law", "bottom_law"},
                                            {"surface_law", "surface_law"},
                                            {"sampler", "sampler"},
                                            {"multipath", "multipath"},
                                            {"bin_length_m", "bin_length_m"},
                                            {"rays_per_s", "rays_per_s"},
                                            {"stderr_db", "median"}};
    static const char *const others[] = {"model_uncertainty_db",
                                         "whole_pings",
                                         "refraction",
                                         "devices",
                                         "remarks",
                                         "terms",
                                         "time_s",
                                         "files",
                                         "pictures"};
    fixture f;
    asdic_run *opened;
    asdic_run_options options = asdic_run_options_default();
    size_t length;
    begin(&f);
    options.count = 3;
    assert_int_equal(run(&f, 1, options, "facts"), ASDIC_OK);
    char *json = read_file("facts", "run.json", &length);
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
            write_facts("facts", json, counts[i], wrong[k]);
            assert_lacks(&f, "facts", counts[i]);
        }
        write_facts("facts", json, counts[i], NULL);
        assert_lacks(&f, "facts", counts[i]);
    }
    for (size_t i = 0; i < sizeof needed / sizeof *needed; i++) {
        write_facts("facts", json, needed[i][0], NULL);
        assert_lacks(&f, "facts", needed[i][1]);
    }
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        write_facts("facts", json, others[i], NULL);
        assert_int_equal(asdic_run_open(f.ctx, in_folder("facts"), &opened), ASDIC_OK);
        asdic_run_close(&opened);
    }
    write_facts("facts", json, "seed", "18446744073709551615");
    assert_int_equal(asdic_run_open(f.ctx, in_folder("facts"), &opened), ASDIC_OK);
    assert_true(asdic_run_get_info(opened).sampling.seed == UINT64_MAX);
    asdic_run_close(&opened);
    free(json);
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
        cmocka_unit_test(interrupted_run_goes_on),
        cmocka_unit_test(interruptions_tell_the_missions_ping),
        cmocka_unit_test(interrupted_while_records_are_checked),
        cmocka_unit_test(interrupted_before_it_replaces),
        cmocka_unit_test(no_background_of_no_kind),
        cmocka_unit_test(killed_run_goes_on),
        cmocka_unit_test(bad_records_are_named_and_made_again),
        cmocka_unit_test(complete_runs_are_checked),
        cmocka_unit_test(full_disk_loses_nothing),
        cmocka_unit_test(what_the_text_does_not_say_is_not_run),
        cmocka_unit_test(parts_join_to_the_whole),
        cmocka_unit_test(sums_are_of_all_pings),
        cmocka_unit_test(folders_are_not_overwritten),
        cmocka_unit_test(elements_are_of_one_process),
        cmocka_unit_test(sizes_are_told_in_their_own_units),
        cmocka_unit_test(room_is_for_what_is_to_come),
        cmocka_unit_test(files_may_have_any_number),
        cmocka_unit_test(elements_end_with_the_run),
        cmocka_unit_test(csv_reads_back_to_the_bit),
        cmocka_unit_test(damaged_folders_are_refused),
        cmocka_unit_test(facts_are_read_whole),
        cmocka_unit_test(formats_that_a_build_lacks_are_refused),
        cmocka_unit_test(frames_are_of_single_pings),
        cmocka_unit_test(detection_makes_profiles_once),
    };
    if (argc > 1) {
        cmocka_set_test_filter(argv[1]);
    }
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
