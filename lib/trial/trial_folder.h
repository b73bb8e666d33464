/*
 * A trial on the disk: what was flown, and a row for each run and variant. While it is being flown
 * they are trial.part.csv and trial.part.json; rows are appended as they come, in order.
 */
#ifndef ASDIC_TRIAL_TRIAL_FOLDER_H
#define ASDIC_TRIAL_TRIAL_FOLDER_H

#include <asdic/trial.h>

#include "base/text.h"

#include <asdic/output.h>

#include <stdio.h>

/* What a trial is, apart from who flew it. */
typedef struct trial_facts {
    char scene[ASDIC_NAME_SIZE];
    char hash[65]; /* of the scene as variants change it, and of what is drawn */
    char *key;     /* that varies; NULL: none */
    char *values[ASDIC_TRIAL_MOST_VARIANTS];
    size_t variants;
    uint64_t seed, runs, first, count;
    uint32_t rays;
    char *rule; /* name of that in place of the scene's; NULL: the scene's */
} trial_facts;

typedef struct trial_row {
    uint64_t run;
    size_t variant;
    asdic_trial_run flown;
} trial_row;

struct asdic_trial {
    asdic_context *ctx;
    trial_facts facts;
    trial_row *rows; /* by run, then by variant */
    size_t row_count;
    asdic_trial_result results[ASDIC_TRIAL_MOST_VARIANTS];
    char *names[ASDIC_TRIAL_MOST_VARIANTS];
    char *header, *body; /* of trial.csv, as it is */
};

void asdic_trial_facts_finish(trial_facts *facts);

/* The facts, with the results when there are any, as trial.json has them. */
void asdic_trial_print(const trial_facts *facts, const asdic_trial_result *results,
                       const char *const *names, asdic_text *text);

/* The header of trial.csv for draws of MISSION, and the row of a run of it. */
void asdic_trial_print_header(const asdic_mission *mission, asdic_text *text);
void asdic_trial_print_row(const asdic_mission *mission, uint64_t run, size_t variant,
                           const asdic_trial_run *flown, asdic_text *text);

/* Reads what is in FOLDER, of a trial under way when PART; ASDIC_ERROR_INPUT when there is none, or
 * it is damaged. A last row that was cut is left out of one under way. */
asdic_status asdic_trial_read(asdic_context *ctx, const char *folder, bool part, asdic_trial **out);

/* Writes trial.json and trial.png of TRIAL, whose rows are complete, and gives all files their
 * names. */
asdic_status asdic_trial_complete(asdic_context *ctx, asdic_trial *trial, const char *folder);

/* Opens trial.part.csv, for OUT, with HEADER and ROWS in it; and closes it. Where it GOES_ON these
 * are the rows of the file of that name, which stays there until the new one holds them. */
asdic_status asdic_trial_begin(asdic_context *ctx, const char *folder, const trial_facts *facts,
                               const asdic_text *header, const asdic_text *rows, bool goes_on,
                               FILE **out);
asdic_status asdic_trial_end(asdic_context *ctx, const char *folder, FILE **out);

/* Completes the trial under way in FOLDER. */
asdic_status asdic_trial_settle(asdic_context *ctx, const char *folder);

/* Whether both are parts of one trial. */
bool asdic_trial_is_same(const trial_facts *a, const trial_facts *b);

/* Whether FOLDER has a file NAME. */
bool asdic_trial_has(const char *folder, const char *name);

/* trial_picture.c */
asdic_status asdic_trial_draw(asdic_context *ctx, const asdic_trial *trial, const char *path);

#endif
