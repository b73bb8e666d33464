/*
 * Missions to run on fake simulators, which stand in for the real ones by the linker's --wrap, so that
 * order, loss and interruption can be arranged.
 */
#ifndef TESTS_UNIT_RUN_RIG_H
#define TESTS_UNIT_RUN_RIG_H

#include "asserts.h"

#include "base/context.h"

#include <asdic/asdic.h>

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#define PINGS 150
#define BEAMS 2

struct asdic_device {
    asdic_device_info info;
    bool refuses;                 /* to create a simulator */
    size_t fails_after;           /* pings */
    atomic_bool is_lost;          /* it failed */
    struct asdic_device *after;   /* pings begin when that one is lost; NULL: at once */
    size_t together;              /* pings that it takes at once; 0: one */
    unsigned delay_us, saturated; /* a ping */
    size_t pings, learnt;         /* counted */
};

typedef struct fixture {
    asdic_context *ctx;
    asdic_mission *mission;
    asdic_device devices[3], *pointers[3];
    size_t stop_at; /* interrupt when so many pings are done */
    size_t reported;
    char warnings[1024];
} fixture;

/* A folder of the test's own, made by set_up, with scene.yaml and the run "reference". */
extern char run_rig_folder[];
char *in_folder(const char *name); /* valid for three more calls; not for several threads */

void begin(fixture *f);
void end(fixture *f);

/* Runs on the first DEVICES devices into the folder NAME. */
asdic_status run(fixture *f, size_t devices, asdic_run_options options, const char *name);

char *read_file(const char *run_name, const char *name, size_t *length);
void assert_same_files(const char *a, const char *b);
void assert_state(const char *run_name, const char *state, size_t pings);
void assert_no_part(const char *run_name); /* every file of a folder is whole */

int set_up(void **state);
int tear_down(void **state);

#endif
