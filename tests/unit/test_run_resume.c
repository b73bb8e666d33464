/*
 * Runs that were stopped, killed or damaged, and what --resume makes of them.
 */
#include "run_rig.h"

#include "de_locale.h"
#include "mission/mission.h"
#include "mission/run/run_facts.h"
#include "out/record.h"

#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <sys/resource.h>
#include <unistd.h>

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

/* An argument selects tests by name. */
int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(interrupted_run_goes_on),
        cmocka_unit_test(interruptions_tell_the_missions_ping),
        cmocka_unit_test(interrupted_while_records_are_checked),
        cmocka_unit_test(interrupted_before_it_replaces),
        cmocka_unit_test(killed_run_goes_on),
        cmocka_unit_test(bad_records_are_named_and_made_again),
        cmocka_unit_test(complete_runs_are_checked),
        cmocka_unit_test(full_disk_loses_nothing),
    };
    if (argc > 1) {
        cmocka_set_test_filter(argv[1]);
    }
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
