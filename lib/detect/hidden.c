#include "hidden.h"

#include "base/context.h"
#include "law.h"

#include <math.h>
#include <stdlib.h>

/* An object in a bin, before its echo is heard; that it hides the bins behind it; that a shadow ends with a bin. */
#define OBJECT 0.01
#define HIDES 0.5
#define ENDS 0.02
/* Directions in which no object is as likely as this hide nothing. */
#define LEAST_OBJECT 0.1
/* A shadow holds noise and, by side lobes and edges, 5, 10, 15 or 20 dB less of the rest: one as likely as another. */
#define FAINTER 4
#define FAINTER_LIN 0.31622776601683794
/* Where noise is nearly all there is, shadows look like the rest. */
#define LEAST_CLUTTER 1e-3

/* A bin of a direction. */
typedef struct dusk {
    double begins; /* probability that an object before it hides it */
    double before; /* that it lies in a shadow, by the bins before it */
    double hidden; /* the same by its own level as well, then by all */
} dusk;

/* Likelihood of what was heard in CELL by its shadow, re that by its background. */
static double shadow_ratio(const asdic_look *look, asdic_background law, asdic_k_table *k_table,
                           size_t cell) {
    double mean_lin = look->background_lin[cell], sum = 0.0;
    double noise_lin = look->noise_lin ? look->noise_lin[cell] : 0.0;
    double clutter_lin = mean_lin - noise_lin;
    if (!(clutter_lin > LEAST_CLUTTER * mean_lin) || !isfinite(mean_lin)) {
        return 1.0;
    }
    law.mean_lin = mean_lin;
    law.noise_share = noise_lin / mean_lin;
    for (int k = 0; k < FAINTER; k++) {
        clutter_lin *= FAINTER_LIN;
        asdic_background shadow = law;
        shadow.mean_lin = noise_lin + clutter_lin;
        shadow.noise_share = noise_lin / shadow.mean_lin;
        double ln = asdic_k_table_ratio(k_table, &shadow, &law, look->intensity_lin[cell]);
        sum += isnan(ln) ? 1.0 : exp(fmin(ln, ASDIC_RATIO_MOST_LN)); /* unknown: says nothing */
    }
    return sum / FAINTER;
}

static double object_in(double ratio) {
    return isnan(ratio) ? 0.0 : ratio * OBJECT / (1.0 - OBJECT + ratio * OBJECT);
}

/* Forwards along a direction that BEAM hears best. */
static void enter(const asdic_look *look, const asdic_background *law, asdic_k_table *k_table,
                  size_t beam, dusk *bins) {
    double hidden = 0.0;
    for (size_t n = 0; n < look->bins; n++) {
        dusk *d = &bins[n];
        d->before = d->hidden = hidden * (1.0 - ENDS) + (1.0 - hidden) * d->begins;
        if (d->before > 0.0) {
            double both = d->before * shadow_ratio(look, *law, k_table, beam * look->bins + n);
            d->hidden = both / (both + 1.0 - d->before);
        }
        hidden = d->hidden;
    }
}

/* ... and backwards: what comes after a bin tells of it as well (Rauch, Tung & Striebel, AIAA J. 3, 1445 (1965), of two
 * states). */
static void leave(size_t count, dusk *bins) {
    for (size_t n = count - 1; n-- > 0;) {
        const dusk *next = &bins[n + 1];
        double stays = next->before > 0.0 ? (1.0 - ENDS) * next->hidden / next->before : 0.0;
        double ends = next->before < 1.0 ? ENDS * (1.0 - next->hidden) / (1.0 - next->before) : 0.0;
        bins[n].hidden *= stays + ends;
    }
}

static void hide(const asdic_look *look, const asdic_background *law, asdic_k_table *k_table,
                 const asdic_evidence *f, size_t heading, dusk *bins) {
    double *ratio = f->ratio + heading * f->bins, most = 0.0;
    bins[0].begins = 0.0;
    for (size_t n = 1; n < f->bins; n++) {
        double object = object_in(ratio[n - 1]);
        bins[n].begins = HIDES * object;
        most = fmax(most, object);
    }
    if (most < LEAST_OBJECT) {
        return;
    }
    enter(look, law, k_table, f->hearings[f->headings[heading].hearing].beam, bins);
    leave(f->bins, bins);
    for (size_t n = 0; n < f->bins; n++) {
        ratio[n] = (1.0 - bins[n].hidden) * ratio[n] + bins[n].hidden; /* as exact for huge ones */
    }
}

asdic_status asdic_evidence_hide(asdic_context *ctx, const asdic_look *look, asdic_k_table *k_table,
                                 asdic_evidence *f) {
    const asdic_background law = asdic_background_of(look->sonar, look->sound_speed_mps, 1.0, 0.0);
    dusk *bins = malloc(f->bins * sizeof *bins);
    if (!bins) {
        return asdic_fail_memory(ctx, "an occupancy map");
    }
    for (size_t i = 0; i < f->arcs * f->azimuths; i++) {
        if (f->headings[i].hearing_count > 0) {
            hide(look, &law, k_table, f, i, bins);
        }
    }
    free(bins);
    return ASDIC_OK;
}
