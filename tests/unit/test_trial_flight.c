/*
 * A trial that is flown: kept, gone on with and begun anew; workers, one of which fails; a run that is flown again.
 */
#include "trial_rig.h"

#include "lib/base/context.h"
#include "lib/trial/trial_run.h"

#include <fcntl.h>
#include <math.h>
#include <stdatomic.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>

/* The rows in the folder "kept". */
static const char *kept_rows(void) {
    static char text[2000];
    char path[200];
    snprintf(path, sizeof path, "%s/kept/trial.csv", folder);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    assert_int_equal(fclose(file), 0);
    return text;
}

/* A whole trial, or a part of one, is replaced by --force alone, gone on with by --resume alone, and then the same. */
static void a_trial_is_kept_or_gone_on_with(void **state) {
    (void)state;
    char path[240], first[2000], begun[2000];
    asdic_trial_options options = flight_to("kept", 3);
    options.variants.count = 2; /* of no key */
    assert_status(ctx, asdic_trial_fly(ctx, NULL, 0, &options), ASDIC_ERROR_ARGUMENT);
    options.variants = (asdic_trial_variants){.key = "seed", .count = 1};
    assert_status(ctx, asdic_trial_fly(ctx, NULL, 0, &options), ASDIC_ERROR_ARGUMENT);
    options.variants.key = NULL;
    options.first = 1, options.count = 3; /* runs 1 to 3 of 0 to 2 */
    assert_status(ctx, asdic_trial_fly(ctx, NULL, 0, &options), ASDIC_ERROR_ARGUMENT);
    assert_contains(asdic_context_error(ctx), "a trial of 3 runs has no run 3");
    options.first = 0, options.count = UINT64_MAX;
    options.force = options.resume = true;
    assert_status(ctx, asdic_trial_fly(ctx, NULL, 0, &options), ASDIC_ERROR_ARGUMENT);
    options.force = options.resume = false;
    assert_ok(ctx, asdic_trial_fly(ctx, NULL, 0, &options));
    snprintf(first, sizeof first, "%s", kept_rows());
    assert_status(ctx, asdic_trial_fly(ctx, NULL, 0, &options), ASDIC_ERROR_EXISTS);
    assert_contains(asdic_context_error(ctx), "/kept' holds a trial; --force replaces it");
    assert_string_equal(kept_rows(), first);
    options.resume = true;
    assert_ok(ctx, asdic_trial_fly(ctx, NULL, 0, &options));
    assert_string_equal(kept_rows(), first);
    options.seed++;
    assert_status(ctx, asdic_trial_fly(ctx, NULL, 0, &options), ASDIC_ERROR_EXISTS);
    assert_contains(asdic_context_error(ctx), "/kept holds another trial");
    assert_string_equal(kept_rows(), first);
    options.seed--;
    options.resume = false;
    options.force = true;
    for (int k = 0; k < 2; k++) { /* another, and the first again */
        options.runs = k ? 3 : 4;
        assert_ok(ctx, asdic_trial_fly(ctx, NULL, 0, &options));
        assert_int_equal(strcmp(kept_rows(), first) == 0, k);
    }
    options.force = false;
    /* As if stopped after its second row. */
    char *end_of_row = first;
    for (int line = 0; line < 3; line++) {
        end_of_row = strchr(end_of_row, '\n') + 1;
    }
    snprintf(begun, sizeof begun, "%.*s", (int)(end_of_row - first), first);
    for (int force = 0; force < 2; force++) {
        char json[240];
        snprintf(path, sizeof path, "%s/trial.json", options.folder);
        snprintf(json, sizeof json, "%s/trial.part.json", options.folder);
        assert_int_equal(rename(path, json), 0);
        snprintf(path, sizeof path, "%s/trial.csv", options.folder);
        assert_int_equal(unlink(path), 0);
        write_file("kept/trial.part.csv", begun, "");
        assert_status(ctx, asdic_trial_fly(ctx, NULL, 0, &options), ASDIC_ERROR_EXISTS);
        assert_contains(asdic_context_error(ctx), "/kept' holds a trial that was stopped; --resume "
                                                  "goes on, --force begins anew");
        options.force = force;
        options.resume = !force;
        assert_ok(ctx, asdic_trial_fly(ctx, NULL, 0, &options));
        assert_string_equal(kept_rows(), first);
        snprintf(path, sizeof path, "%s/trial.part.csv", options.folder);
        assert_int_not_equal(access(path, F_OK), 0);
        options.force = options.resume = false;
    }
}

/* Rows that another process is writing stay its own, and what it says they are. */
static void another_keeps_its_trial(void **state) {
    (void)state;
    char path[220], text[4000] = "";
    asdic_trial_options options = flight_to("whole", 2);
    mkdir(options.folder, 0777);
    write_file("whole/trial.part.json", facts, "  ]\n}\n");
    write_file("whole/trial.part.csv", header, rows);
    snprintf(path, sizeof path, "%s/trial.part.csv", options.folder);
    int fd = open(path, O_RDONLY);
    assert_int_equal(flock(fd, LOCK_EX | LOCK_NB), 0);
    options.force = true;
    assert_status(ctx, asdic_trial_fly(ctx, NULL, 0, &options), ASDIC_ERROR_IO);
    assert_contains(asdic_context_error(ctx), "another process is writing it just now");
    close(fd);
    snprintf(path, sizeof path, "%s/trial.part.json", options.folder);
    FILE *file = fopen(path, "r");
    text[fread(text, 1, sizeof text - 1, file)] = 0;
    fclose(file);
    assert_contains(text, "c0ffee");
}

/* Two runs of OPTIONS in the place of others: the second begins before the first fails, and fails after it. */
static bool both_fail;
static atomic_bool second_began, first_fails;
static atomic_uint by_others; /* runs of workers but the first */

static void wait_ms(long ms) {
    nanosleep(&(struct timespec){.tv_nsec = ms * 1000000}, NULL);
}

asdic_status __real_asdic_trial_run_one(asdic_eye *eye, const asdic_trial_job *job,
                                        asdic_trial_run *out, char why[ASDIC_TRIAL_WHY]);
asdic_status __wrap_asdic_trial_run_one(asdic_eye *eye, const asdic_trial_job *job,
                                        asdic_trial_run *out, char why[ASDIC_TRIAL_WHY]);
asdic_status __wrap_asdic_trial_run_one(asdic_eye *eye, const asdic_trial_job *job,
                                        asdic_trial_run *out, char why[ASDIC_TRIAL_WHY]) {
    by_others += job->worker > 0;
    if (!both_fail) {
        return __real_asdic_trial_run_one(eye, job, out, why);
    }
    if (job->run == 1) {
        second_began = true;
        for (int i = 0; i < 1000 && !first_fails; i++) {
            wait_ms(10);
        }
        wait_ms(200); /* until that is known */
        return asdic_fail(eye->lookout.ctx, ASDIC_ERROR_DEVICE, "the second");
    }
    for (int i = 0; i < 100 && !second_began; i++) { /* never on one processor */
        wait_ms(10);
    }
    first_fails = true;
    return asdic_fail(eye->lookout.ctx, ASDIC_ERROR_INPUT, "the first");
}

/* What failed first ends a trial, and is told: others may fail because of it. */
static void the_first_failure_is_told(void **state) {
    (void)state;
    asdic_trial_options options = flight_to("whole", 2);
    options.force = true;
    both_fail = true;
    assert_status(ctx, asdic_trial_fly(ctx, NULL, 0, &options), ASDIC_ERROR_INPUT);
    assert_string_equal(asdic_context_error(ctx), "the first");
    both_fail = false;
}

/* A sonar that is ideal flies as many runs at a time as there are devices, though it needs none. */
static void one_device_is_one_worker(void **state) {
    (void)state;
    asdic_device *devices[1] = {NULL};
    asdic_trial_options options = flight_to("whole", 200);
    options.force = true;
    by_others = 0;
    assert_ok(ctx, asdic_trial_fly(ctx, devices, 1, &options));
    assert_int_equal(by_others, 0);
}

/* A run of a trial is flown again where everything that it needs is named. */
static void a_run_again_needs_all_it_asks_for(void **state) {
    (void)state;
    asdic_trial_options options = flight_to("again", 2), none = options;
    const char *again = options.folder;
    asdic_trial_run flown = {.time_s = NAN};
    none.scene = NULL;
    const struct {
        const asdic_trial_options *options;
        size_t variant;
        const char *folder;
        asdic_trial_run *out;
    } wrong[] = {{NULL, 0, again, &flown},
                 {&none, 0, again, &flown},
                 {&options, 0, NULL, &flown},
                 {&options, 0, again, NULL},
                 {&options, 1, again, &flown}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_status(ctx,
                      asdic_trial_replay(ctx, NULL, wrong[i].options, 0, wrong[i].variant,
                                         wrong[i].folder, wrong[i].out),
                      ASDIC_ERROR_ARGUMENT);
        assert_contains(asdic_context_error(ctx), "needs its scene, one of its variants");
        assert_true(access(again, F_OK) != 0);
    }
    assert_ok(ctx, asdic_trial_replay(ctx, NULL, &options, 1, 0, again, &flown));
    assert_close(flown.time_s, 3.0, 1e-9);
    assert_close(flown.distance_m, 9.0, 1e-6);
}

/* Only a sonar that is ideal needs none, and no rule can ask for its pings. */
static void what_pings_needs_a_device(void **state) {
    (void)state;
    char heard[1000];
    asdic_trial_options options = flight_to("again", 2);
    const asdic_trial_rule rule = {.name = "never asked"};
    asdic_trial_run flown;
    options.force = true;
    for (int has_rule = 0; has_rule < 2; has_rule++) {
        for (int is_ideal = 0; is_ideal < 2; is_ideal++) {
            const char *at = strstr(empty, ", ideal");
            snprintf(heard, sizeof heard, "%.*s}\n", (int)(at - empty), empty);
            write_file("empty.yaml", is_ideal ? empty : heard, "");
            options.rule = has_rule ? &rule : NULL;
            const char *why = is_ideal ? "makes no pings" : "that pings needs a device";
            if (has_rule || !is_ideal) {
                assert_status(ctx, asdic_trial_fly(ctx, NULL, 0, &options), ASDIC_ERROR_ARGUMENT);
                assert_contains(asdic_context_error(ctx), why);
                assert_status(ctx,
                              asdic_trial_replay(ctx, NULL, &options, 0, 0, options.folder, &flown),
                              ASDIC_ERROR_ARGUMENT);
                assert_contains(asdic_context_error(ctx), why);
            }
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(another_keeps_its_trial),
        cmocka_unit_test(the_first_failure_is_told),
        cmocka_unit_test(a_trial_is_kept_or_gone_on_with),
        cmocka_unit_test(one_device_is_one_worker),
        cmocka_unit_test(a_run_again_needs_all_it_asks_for),
        cmocka_unit_test(what_pings_needs_a_device),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
