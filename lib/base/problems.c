#include "problems.h"

#include "context.h"
#include "grow.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* More than a user reads at once; a wrong file (a mesh, a table) makes one for each line. */
#define MOST_REPORTED 100

void asdic_problems_add(asdic_problems *problems, unsigned line, unsigned column,
                        const char *format, ...) {
    problems->total++;
    if (problems->count == MOST_REPORTED) {
        return;
    }
    if (!asdic_grow(&problems->items, problems->count, &problems->capacity,
                    sizeof *problems->items)) {
        problems->out_of_memory = true;
        return;
    }
    asdic_problem *problem = &problems->items[problems->count];
    va_list args;
    va_start(args, format);
    int length = vasprintf(&problem->message, format, args);
    va_end(args);
    if (length < 0) {
        problems->out_of_memory = true;
        return;
    }
    problem->name = problems->name;
    problem->line = line;
    problem->column = column;
    problem->order = problems->count++;
}

static int compare(const void *pa, const void *pb) {
    const asdic_problem *a = pa, *b = pb;
    int by_name = strcmp(a->name ? a->name : "", b->name ? b->name : "");
    if (by_name != 0) {
        return by_name;
    }
    if (a->line != b->line) {
        return a->line < b->line ? -1 : 1;
    }
    if (a->column != b->column) {
        return a->column < b->column ? -1 : 1;
    }
    return a->order < b->order ? -1 : 1;
}

asdic_status asdic_problems_report(asdic_problems *problems, asdic_context *ctx) {
    if (problems->out_of_memory) {
        return asdic_fail_memory(ctx, "the list of errors");
    }
    if (problems->total == 0) {
        return ASDIC_OK;
    }
    qsort(problems->items, problems->count, sizeof *problems->items, compare);
    for (size_t i = 0; i < problems->count; i++) {
        const asdic_problem *p = &problems->items[i];
        if (p->line > 0) {
            asdic_log(ctx, ASDIC_LOG_ERROR, "%s:%u:%u: error: %s", p->name, p->line, p->column,
                      p->message);
        } else {
            asdic_log(ctx, ASDIC_LOG_ERROR, "%s: error: %s", p->name, p->message);
        }
    }
    if (problems->total > problems->count) {
        asdic_log(ctx, ASDIC_LOG_ERROR, "%s: error: %zu more errors are not shown", problems->name,
                  problems->total - problems->count);
    }
    return asdic_fail(ctx, ASDIC_ERROR_INPUT, "%s: %zu error%s", problems->name, problems->total,
                      problems->total == 1 ? "" : "s");
}

asdic_status asdic_problems_fail(asdic_problems *problems, asdic_context *ctx) {
    char more[48] = "";
    if (problems->out_of_memory) {
        return asdic_fail_memory(ctx, "the list of errors");
    }
    if (problems->total == 0) {
        return ASDIC_OK;
    }
    const asdic_problem *first = problems->items;
    if (problems->total > 1) {
        snprintf(more, sizeof more, "; and %zu more error%s", problems->total - 1,
                 problems->total == 2 ? "" : "s");
    }
    return asdic_fail(ctx, ASDIC_ERROR_INPUT, "%s:%u: %s%s", first->name, first->line,
                      first->message, more);
}

void asdic_problems_finish(asdic_problems *problems) {
    for (size_t i = 0; i < problems->count; i++) {
        free(problems->items[i].message);
    }
    free(problems->items);
    *problems = (asdic_problems){.name = problems->name};
}
