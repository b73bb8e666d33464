/*
 * What asdic roc says of its curves, and numbers with bounds as JSON.
 */
#ifndef ASDIC_CLI_ROC_PRINT_H
#define ASDIC_CLI_ROC_PRINT_H

#include "json.h"

#include <asdic/asdic.h>

#define ROC_MOST_VARIANTS 8

/* The variants of one call; the first is what the others are compared with. */
typedef struct roc_variants {
    size_t count;
    const char *names[ROC_MOST_VARIANTS];
    asdic_roc *rocs[ROC_MOST_VARIANTS];
    asdic_estimate differences[ROC_MOST_VARIANTS]; /* of the area from the first's */
} roc_variants;

void roc_print_table(const roc_variants *v);
void roc_print_json(const roc_variants *v);

/* "KEY": {"low": ..., "high": ...}, and with "value" */
void json_band(json *j, const char *key, asdic_band band);
void json_estimate(json *j, const char *key, asdic_estimate e);

#endif
