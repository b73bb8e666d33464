/*
 * All errors in a file and those that it names, collected and reported in the order of their lines.
 */
#ifndef ASDIC_BASE_PROBLEMS_H
#define ASDIC_BASE_PROBLEMS_H

#include <asdic/context.h>

typedef struct asdic_problem {
    const char *name;      /* of the file, when it was found */
    unsigned line, column; /* from 1; 0: the file as a whole */
    size_t order;          /* in which they were found */
    char *message;
} asdic_problem;

/* Zero-initialised but for NAME. */
typedef struct asdic_problems {
    const char *name; /* the file, as the user gave it; may change from one problem to the next */
    asdic_problem *items;
    size_t count, capacity;
    size_t total; /* found, beyond those kept too */
    bool out_of_memory;
} asdic_problems;

void asdic_problems_add(asdic_problems *problems, unsigned line, unsigned column,
                        const char *format, ...) __attribute__((format(printf, 4, 5)));

/* Logs "NAME:LINE:COLUMN: error: MESSAGE" for each problem, sorted, and answers with the status:
 * ASDIC_OK when there is none, else ASDIC_ERROR_INPUT (or _MEMORY) and a sentence that counts. */
asdic_status asdic_problems_report(asdic_problems *problems, asdic_context *ctx);

/* The same without a log: the sentence is the first problem, and how many there are besides. */
asdic_status asdic_problems_fail(asdic_problems *problems, asdic_context *ctx);

void asdic_problems_finish(asdic_problems *problems);

#endif
