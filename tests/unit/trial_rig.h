/*
 * A trial of two variants and 40 runs, of which four are there, in a folder of the test's own; and a scene to fly.
 */
#ifndef ASDIC_TESTS_TRIAL_RIG_H
#define ASDIC_TESTS_TRIAL_RIG_H

#include "asserts.h"
#include "test_context.h"

#include "lib/trial/trial_folder.h"

#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char folder[] = "/tmp/asdic-trial-XXXXXX";

static const char facts[] =
    "{\n  \"scene\": \"reef\",\n  \"hash\": \"c0ffee\",\n  \"seed\": 11,\n"
    "  \"runs\": 40,\n  \"first\": 7,\n  \"count\": 4,\n  \"rays\": 2048,\n"
    "  \"rule\": \"program\",\n  \"command\": \"rule.py --quick\",\n  \"key\": \"sonar.beam\",\n"
    "  \"values\": [\"a\", \"b\"],\n  \"variants\": [\n";
static const char header[] = "run,variant,outcome,cause,what,time_s,distance_m,pings,clearance_m,"
                             "manoeuvres,needless,seen_m,depth_m\n";
/* Two variants of runs 7 to 10; behind the last field that is read, a draw. */
static const char rows[] = "7,0,hit,seen late,rock,10.5,100,21,0.25,3,1,12.5,30\n"
                           "7,1,clear,,,11.5,200,22,4.5,4,0,,30\n"
                           "8,0,clear,,,12.5,300,23,5.5,5,2,,31\n"
                           "8,1,hit,not seen,bottom,13.5,400,24,0.125,6,0,,31\n"
                           "9,0,hit,could not turn,rock,14.5,500,25,0.0625,7,0,2.5,\"a,b\"\n"
                           "9,1,clear,,,15.5,600,26,,8,0,,\"a,b\"\n"
                           "10,0,void,,rock,16.5,700,27,8.5,9,15,,33\n"
                           "10,1,late,,,17.5,800,28,9.5,10,0,,33\n";

/* Two runs without a device, of a vehicle that meets nothing. */
static const char empty[] =
    "version: 1\nbottom: {depth_m: 20}\n"
    "sonar: {frequency_khz: 100, ping_rate_hz: 1, speckle: rayleigh, receivers: [{name: a}]}\n"
    "mission: {waypoints: {points_m: [[0, 0, 10], [9, 0, 10]], speed_mps: 3}}\n"
    "trial: {time_s: 3, ideal: {pd: 0.5}}\n";

static inline void write_file(const char *name, const char *text, const char *more) {
    char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    fprintf(file, "%s%s", text, more);
    assert_int_equal(fclose(file), 0);
}

static inline asdic_trial *open_trial(void) {
    asdic_trial *trial = NULL;
    write_file("trial.json", facts, "  ]\n}\n");
    write_file("trial.csv", header, rows);
    assert_ok(ctx, asdic_trial_open(ctx, folder, &trial));
    return trial;
}

/* WHOLE with WORD, where it is there, replaced by OTHER. */
static inline void replace(const char *whole, const char *word, const char *other,
                           char text[1000]) {
    const char *found = strstr(whole, word);
    int length = snprintf(text, 1000, "%.*s%s%s", found ? (int)(found - whole) : 0, whole,
                          found ? other : "", found ? found + strlen(word) : whole);
    assert_true(length < 1000);
}

/* RUNS of the scene EMPTY, to be flown into FOLDER/NAME; paths are valid until the next call. */
static inline asdic_trial_options flight_to(const char *name, uint64_t runs) {
    static char scene[200], whole[200];
    asdic_trial_options options = asdic_trial_options_default();
    write_file("empty.yaml", empty, "");
    snprintf(scene, sizeof scene, "%s/empty.yaml", folder);
    snprintf(whole, sizeof whole, "%s/%s", folder, name);
    options.scene = scene;
    options.folder = whole;
    options.runs = runs;
    return options;
}

static inline int remove_one(const char *path, const struct stat *about, int kind,
                             struct FTW *place) {
    (void)about, (void)kind, (void)place;
    return remove(path);
}

static inline int begin(void **state) {
    return !mkdtemp(folder) || context_begin(state);
}

static inline int end(void **state) {
    return nftw(folder, remove_one, 8, FTW_DEPTH | FTW_PHYS) + context_end(state);
}

#endif
