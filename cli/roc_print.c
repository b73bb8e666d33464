#include "roc_print.h"

#include <math.h>
#include <string.h>

#define BACKGROUND_SIZE 96

static void print_rates(const asdic_roc *roc) {
    printf("\n%-12s %12s %12s %25s\n", "P_FA design", "threshold", "P_FA", "99 % bounds");
    for (size_t i = 0; i < roc->point_count; i++) {
        const asdic_roc_point *p = &roc->points[i];
        double decade = log10(p->design_pfa);
        if (fabs(decade - round(decade)) < 1e-6 && p->design_pfa < 0.5) {
            printf("%-12.0e %9.2f dB %12.4e %12.4e..%.4e\n", p->design_pfa, p->threshold_db,
                   p->pfa.value, p->pfa.low, p->pfa.high);
        }
    }
}

/* What the scattering laws leave open. */
static void print_model(const roc_variants *v) {
    for (size_t i = 0; i < v->count; i++) {
        const asdic_roc *r = v->rocs[i];
        if (isnan(r->model_pd.low)) {
            continue;
        }
        printf("%s: P_D %.4f..%.4f over the error of the scattering laws", v->names[i],
               r->model_pd.low, r->model_pd.high);
        asdic_band paired = asdic_roc_compare_model(v->rocs[0], r);
        if (i > 0 && !isnan(paired.low)) {
            printf("; less the first's, with the same error, %+.4f..%+.4f", paired.low,
                   paired.high);
        }
        printf("\n");
    }
}

/* The P_FA of each variant, where they differ. */
static void print_pfa(const roc_variants *v) {
    double first = v->rocs[0]->pfa;
    bool differ = false;
    printf("P_D at P_FA = %g", first);
    for (size_t i = 1; i < v->count; i++) {
        differ = differ || v->rocs[i]->pfa != first;
    }
    for (size_t i = 1; i < v->count && differ; i++) {
        printf(", %g", v->rocs[i]->pfa);
    }
    printf("; %zu draws each, %.2f s per million\n", v->rocs[0]->trials, v->rocs[0]->draw_s);
}

static void describe_background(const asdic_roc *roc, char text[BACKGROUND_SIZE]) {
    if (roc->background_error_db == 0.0) {
        snprintf(text, BACKGROUND_SIZE, "background: what is expected over a plane");
    } else {
        snprintf(text, BACKGROUND_SIZE,
                 "background: the rest of one simulated ping, standard error %.2g dB",
                 roc->background_error_db);
    }
}

/* The background of each variant, where they differ. */
static void print_background(const roc_variants *v) {
    char texts[ROC_MOST_VARIANTS][BACKGROUND_SIZE];
    bool differ = false;
    for (size_t i = 0; i < v->count; i++) {
        describe_background(v->rocs[i], texts[i]);
        differ = differ || strcmp(texts[i], texts[0]) != 0;
    }
    for (size_t i = 0; i < (differ ? v->count : 1); i++) {
        printf("%s%s%s\n", differ ? v->names[i] : "", differ ? ": " : "", texts[i]);
    }
}

void roc_print_table(const roc_variants *v) {
    int wide = 8;
    for (size_t i = 0; i < v->count; i++) {
        int length = snprintf(NULL, 0, "%s", v->names[i]);
        wide = length > wide ? length : wide;
    }
    printf("%-*s %-12s %9s %9s %8s %20s %8s %8s %19s %8s%s\n", wide, "variant", "beam", "range",
           "snr", "P_D", "99 % bounds", "closed", "area", "99 % bounds", "closed",
           v->count > 1 ? "  area - first's" : "");
    for (size_t i = 0; i < v->count; i++) {
        const asdic_roc *r = v->rocs[i];
        printf("%-*s %-12s %7.2f m %6.2f dB %8.4f %11.4f..%.4f %8.4f %8.5f %10.5f..%.5f %8.5f",
               wide, v->names[i], r->beam, r->range_m, r->snr_db, r->pd.value, r->pd.low,
               r->pd.high, r->closed_pd, r->area.value, r->area.low, r->area.high, r->closed_area);
        if (i > 0) {
            const asdic_estimate *d = &v->differences[i];
            printf("  %+.5f (%+.5f..%+.5f)", d->value, d->low, d->high);
        }
        printf("\n");
    }
    print_pfa(v);
    print_background(v);
    print_model(v);
    if (v->count == 1) {
        print_rates(v->rocs[0]);
    }
}

void json_band(json *j, const char *key, asdic_band band) {
    json_open(j, key, '{');
    json_number(j, "low", band.low);
    json_number(j, "high", band.high);
    json_close(j);
}

void json_estimate(json *j, const char *key, asdic_estimate e) {
    json_open(j, key, '{');
    json_number(j, "value", e.value);
    json_number(j, "low", e.low);
    json_number(j, "high", e.high);
    json_close(j);
}

static void print_points(json *j, const asdic_roc *r) {
    json_open(j, "curve", '[');
    for (size_t i = 0; i < r->point_count; i++) {
        const asdic_roc_point *p = &r->points[i];
        json_open(j, NULL, '{');
        json_number(j, "design_pfa", p->design_pfa);
        json_number(j, "threshold_db", p->threshold_db);
        json_estimate(j, "pfa", p->pfa);
        json_estimate(j, "pd", p->pd);
        json_number(j, "closed_pd", p->closed_pd);
        json_band(j, "model_pd", p->model_pd);
        json_close(j);
    }
    json_close(j);
}

void roc_print_json(const roc_variants *v) {
    json j = json_begin(stdout);
    json_open(&j, NULL, '[');
    for (size_t i = 0; i < v->count; i++) {
        const asdic_roc *r = v->rocs[i];
        json_open(&j, NULL, '{');
        json_text(&j, "variant", v->names[i]);
        json_text(&j, "beam", r->beam);
        json_integer(&j, "bin", r->bin);
        json_number(&j, "range_m", r->range_m);
        json_number(&j, "background_db", r->background_db);
        json_number(&j, "background_error_db", r->background_error_db);
        json_number(&j, "target_db", r->target_db);
        json_number(&j, "snr_db", r->snr_db);
        json_number(&j, "target_strength_db", r->target_strength_db);
        json_integer(&j, "looks", r->background.looks);
        json_number(&j, "pfa", r->pfa);
        json_estimate(&j, "pd", r->pd);
        json_number(&j, "closed_pd", r->closed_pd);
        json_number(&j, "background_uncertainty_db", r->background_uncertainty_db);
        json_number(&j, "target_uncertainty_db", r->target_uncertainty_db);
        json_band(&j, "model_pd", r->model_pd);
        if (i > 0) {
            json_band(&j, "model_pd_difference", asdic_roc_compare_model(v->rocs[0], r));
        }
        json_estimate(&j, "area", r->area);
        json_number(&j, "closed_area", r->closed_area);
        if (i > 0) {
            json_estimate(&j, "area_difference", v->differences[i]);
        }
        json_integer(&j, "trials", r->trials);
        json_number(&j, "seconds_per_million", r->draw_s);
        print_points(&j, r);
        json_close(&j);
    }
    json_close(&j);
}
