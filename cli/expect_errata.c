#include "expect_errata.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define COMPONENTS 4
static const asdic_component components[COMPONENTS] = {ASDIC_BOTTOM, ASDIC_SURFACE, ASDIC_VOLUME,
                                                       ASDIC_NOISE};

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* "+13.02 [+0.00, +15.74]" of the bins where RIGHT has energy; "-" when nothing changes. */
static void describe(const asdic_ping *right, const asdic_ping *wrong, asdic_component component,
                     double *work, char *text, size_t size) {
    size_t count = 0;
    bool changed = false;
    for (size_t n = 0; n < right->bins; n++) {
        double before = right->intensity_lin[component][n];
        if (before > 0.0) {
            work[count] = asdic_level_db(wrong->intensity_lin[component][n] / before);
            changed = changed || fabs(work[count]) >= 0.0005;
            count++;
        }
    }
    if (!changed) {
        snprintf(text, size, "-");
        return;
    }
    qsort(work, count, sizeof *work, ascending);
    double median = 0.5 * (work[(count - 1) / 2] + work[count / 2]);
    snprintf(text, size, "%+.3f [%+.3f, %+.3f]", median, work[0], work[count - 1]);
}

static void print_row(const char *number, const char *words, const asdic_ping *right,
                      const asdic_ping *wrong, double *work) {
    char text[64];
    printf("%-4s %s\n     ", number, words);
    for (int k = 0; k < COMPONENTS; k++) {
        describe(right, wrong, components[k], work, text, sizeof text);
        printf("%-29s", text);
    }
    printf("\n");
}

/* Narrows SCENE to one receiver: the one named by --beam, else the first. */
static bool choose_beam(cli *c, const expect_scene *scene, asdic_sonar *one) {
    const char *name = cli_text(c, "beam");
    *one = scene->sonar;
    for (size_t b = 0; name && b < scene->sonar.receiver_count; b++) {
        if (strcmp(scene->sonar.receivers[b].name, name) == 0) {
            one->receivers += b;
            one->receiver_count = 1;
            return true;
        }
    }
    one->receiver_count = 1;
    return !name;
}

static asdic_status print_table(cli *c, const expect_scene *scene, const asdic_sonar *sonar,
                                asdic_ping *right, asdic_ping *wrong, double *work) {
    asdic_context *ctx = cli_context(c);
    asdic_environment env = scene->env;
    env.variant = ASDIC_VARIANT_CORRECTED;
    asdic_status status =
        asdic_expected_compute(ctx, &scene->flat, &env, sonar, &scene->pose, right);
    if (status == ASDIC_OK) {
        printf("Beam '%s': median [least, largest] change of level, dB, over its bins.\n\n"
               "no.  printed, for what is right\n     %-29s%-29s%-29s%-29s\n",
               sonar->receivers[0].name, "bottom", "surface", "volume", "noise");
    }
    for (size_t i = 0; status == ASDIC_OK && i < asdic_erratum_count(); i++) {
        const asdic_erratum *e = asdic_erratum_get(i);
        char number[16], words[256];
        status = asdic_expected_erratum(ctx, i, &scene->flat, &env, sonar, &scene->pose, wrong);
        snprintf(number, sizeof number, "%u", e->number);
        snprintf(words, sizeof words, "%s: %s, for %s", e->where, e->printed, e->right);
        if (status == ASDIC_OK) {
            print_row(number, words, right, wrong, work);
        }
    }
    env.variant = ASDIC_VARIANT_PRINTED;
    if (status == ASDIC_OK) {
        status = asdic_expected_compute(ctx, &scene->flat, &env, sonar, &scene->pose, wrong);
    }
    if (status == ASDIC_OK) {
        print_row("all", "everything that --variant printed puts back", right, wrong, work);
    }
    return status;
}

int expect_errata(cli *c, const expect_scene *scene) {
    asdic_context *ctx = cli_context(c);
    asdic_ping *right = NULL, *wrong = NULL;
    asdic_sonar sonar;
    if (!choose_beam(c, scene, &sonar)) {
        return cli_usage(c, "the scene has no receiver '%s'", cli_text(c, "beam"));
    }
    double *work = malloc(scene->bins * sizeof *work);
    asdic_status status = work ? ASDIC_OK : ASDIC_ERROR_MEMORY;
    if (status == ASDIC_OK) {
        status = asdic_ping_create(ctx, 1, scene->bins, &right);
    }
    if (status == ASDIC_OK) {
        status = asdic_ping_create(ctx, 1, scene->bins, &wrong);
    }
    if (status == ASDIC_OK) {
        status = print_table(c, scene, &sonar, right, wrong, work);
    }
    asdic_ping_destroy(&right);
    asdic_ping_destroy(&wrong);
    free(work);
    return cli_end(c, status);
}
