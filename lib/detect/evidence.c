#include "evidence.h"

#include "base/context.h"
#include "base/grow.h"
#include "base/try.h"
#include "law.h"
#include "sim/ring.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>

/* Beams steeper than this (84 degrees) tell nothing about the place in the plane. */
#define LEAST_COS 0.1
/* The edges of an arc, in half-power heights from its axis: 7 dB down. They are no steeper, rad. */
#define EDGE 0.75
#define STEEPEST 1.5
/* Directions in a beam's width; the least gain of a beam that is asked, re its axis, and how many
 * widths from the axis that is at most. */
#define PER_WIDTH 4.0
#define LEAST_GAIN 0.03
/* An axis on which a beam hears less, re the most where it is asked, is in a null of the transmitter. */
#define NULL_GAIN 0.25
#define MOST_WIDTHS 1.5
/* The least gain behind a face: gains are divided by each other. */
#define LEAST_REAR 1e-6
/* In K speckle likelihood ratios are tabled by strength re the background: from, in steps of, how many. */
#define FIRST_DB (-12.0)
#define STEP_DB 4.0
#define STRENGTHS 16
/* Echoes as strong re the background are explained elsewhere, so many at one range. */
#define STRONG_LIN 30.0
#define MOST_ECHOES 8

typedef struct ear {
    asdic_face face;
    asdic_vec3 axis;
    double azimuth_rad, elevation_rad, width_rad, height_rad, weight;
    double axis_lin; /* two-way pattern on the axis, see reference_lin */
    long arc;
    bool is_asked;
} ear;

/* A ping being read. */
typedef struct reader {
    const asdic_look *look;
    asdic_evidence *out;
    asdic_face transmitter;
    ear *ears;
    asdic_background law;
    asdic_k_table *k_table; /* of the law, or NULL */
    double rear_lin;        /* one-way gain behind a face */
    double snr_lin;         /* of the weakest object looked for */
    double *extra_lin;      /* by beam: explained echoes, at the range in work */
    double *table;     /* by beam: STRENGTHS ln of ratios at that range, or NAN; K speckle only */
    bool *is_frozen;   /* headings near an echo that is explained elsewhere */
    size_t loudest;    /* the beam whose echo is in work, where one is strong; else SIZE_MAX */
    bool *is_compared; /* by beam: whether those that hear the headings of the loudest include it */
} reader;

static double two_way(const reader *r, size_t beam, asdic_vec3 towards) {
    return asdic_face_gain(&r->transmitter, towards, r->rear_lin) *
           asdic_face_gain(&r->ears[beam].face, towards, r->rear_lin);
}

static asdic_vec3 direction(double azimuth_rad, double elevation_rad) {
    double level = cos(elevation_rad);
    return (asdic_vec3){level * cos(azimuth_rad), level * sin(azimuth_rad), sin(elevation_rad)};
}

/* Of azimuths, each less than a turn from 0. */
static double apart(double a_rad, double b_rad) {
    double off = fabs(a_rad - b_rad);
    return off > ASDIC_PI ? fabs(2.0 * ASDIC_PI - off) : off;
}

asdic_hearing_range asdic_evidence_range(const asdic_sonar *sonar, size_t receiver, asdic_vec3 axis,
                                         double sound_speed_mps) {
    double level = hypot(axis.x, axis.y);
    double edge_rad = EDGE * asdic_beam_height_rad(sonar, receiver, sound_speed_mps);
    double flattest_rad = fmax(atan2(fabs(axis.z), level) - edge_rad, 0.0);
    return (asdic_hearing_range){.plane_share = level >= LEAST_COS ? cos(flattest_rad) : 0.0,
                                 .aside_rad =
                                     (MOST_WIDTHS + 0.5 / PER_WIDTH) *
                                     asdic_beam_width_rad(sonar, receiver, sound_speed_mps)};
}

/* --- beams ------------------------------------------------------------------------------------ */

/* What gains of BEAM refer to: its two-way pattern on its axis, or, where that looks into a null of the
 * transmitter, the most where it is asked. */
static double reference_lin(const reader *r, size_t beam) {
    const ear *e = &r->ears[beam];
    double axis_lin = two_way(r, beam, e->axis), most_lin = axis_lin;
    for (double widths = -MOST_WIDTHS; widths <= MOST_WIDTHS; widths += 1.0 / PER_WIDTH) {
        double azimuth_rad = e->azimuth_rad + widths * e->width_rad;
        most_lin = fmax(most_lin, two_way(r, beam, direction(azimuth_rad, e->elevation_rad)));
    }
    return axis_lin < NULL_GAIN * most_lin ? most_lin : axis_lin;
}

static void find_ears(reader *r) {
    const asdic_look *look = r->look;
    const asdic_sonar *sonar = look->sonar;
    double wavelength_m = look->sound_speed_mps / sonar->frequency_hz;
    r->transmitter = asdic_face_aim(&sonar->transmitter, &look->pose, wavelength_m);
    for (size_t b = 0; b < sonar->receiver_count; b++) {
        ear *e = &r->ears[b];
        e->face = asdic_face_aim(&sonar->receivers[b], &look->pose, wavelength_m);
        const double *row = e->face.world_to_face.m[0];
        e->axis = (asdic_vec3){row[0], row[1], row[2]};
        double level = hypot(row[0], row[1]);
        e->azimuth_rad = atan2(row[1], row[0]);
        e->elevation_rad = atan2(row[2], level);
        e->width_rad = asdic_beam_width_rad(sonar, b, look->sound_speed_mps);
        e->height_rad = asdic_beam_height_rad(sonar, b, look->sound_speed_mps);
        e->arc = lround(e->elevation_rad / e->height_rad);
        e->is_asked = level >= LEAST_COS;
        e->axis_lin = reference_lin(r, b);
    }
    for (size_t b = 0; b < sonar->receiver_count; b++) {
        double sum = 0.0;
        ear *e = &r->ears[b];
        for (size_t k = 0; k < sonar->receiver_count; k++) {
            bool is_near = apart(e->azimuth_rad, r->ears[k].azimuth_rad) < 4.0 * e->width_rad;
            sum += k == b    ? 1.0
                   : is_near ? asdic_face_gain(&e->face, r->ears[k].axis, r->rear_lin)
                             : 0.0;
        }
        e->weight = 1.0 / sum;
    }
}

/* --- directions ------------------------------------------------------------------------------- */

static asdic_status add_hearing(asdic_context *ctx, asdic_evidence *f, asdic_hearing hearing) {
    if (!asdic_grow(&f->hearings, f->hearing_count, &f->hearing_room, sizeof *f->hearings)) {
        return asdic_fail_memory(ctx, "an occupancy map");
    }
    f->hearings[f->hearing_count++] = hearing;
    return ASDIC_OK;
}

/* The beam of ARC nearest to AZIMUTH_RAD, if it hears as far. */
static const ear *nearest(const reader *r, long arc, double azimuth_rad) {
    const ear *best = NULL;
    double least = INFINITY;
    for (size_t b = 0; b < r->look->sonar->receiver_count; b++) {
        const ear *e = &r->ears[b];
        double aside = apart(e->azimuth_rad, azimuth_rad) / e->width_rad;
        if (e->is_asked && e->arc == arc && aside <= MOST_WIDTHS && aside < least) {
            least = aside;
            best = e;
        }
    }
    return best;
}

/* Finds the beams that hear H, which is at AZIMUTH_RAD on an arc; the best of them becomes the first. */
static asdic_status hear(asdic_context *ctx, reader *r, double azimuth_rad, asdic_heading *h) {
    asdic_evidence *f = r->out;
    asdic_vec3 towards = direction(azimuth_rad, h->elevation_rad);
    double best = 0.0;
    h->hearing = f->hearing_count;
    for (size_t b = 0; b < r->look->sonar->receiver_count; b++) {
        const ear *e = &r->ears[b];
        if (!e->is_asked || apart(e->azimuth_rad, azimuth_rad) > MOST_WIDTHS * e->width_rad) {
            continue;
        }
        double lin = two_way(r, b, towards), share = lin / e->axis_lin;
        if (share < LEAST_GAIN) {
            continue;
        }
        TRY(add_hearing(ctx, f, (asdic_hearing){b, lin / e->axis_lin, e->weight}));
        if (share > best) {
            asdic_hearing first = f->hearings[h->hearing];
            f->hearings[h->hearing] = f->hearings[f->hearing_count - 1];
            f->hearings[f->hearing_count - 1] = first;
            best = share;
        }
    }
    h->hearing_count = f->hearing_count - h->hearing;
    for (size_t i = 0; i < h->hearing_count; i++) {
        asdic_hearing *g = &f->hearings[h->hearing + i];
        double first_lin = r->ears[f->hearings[h->hearing].beam].axis_lin;
        g->gain_lin *= r->ears[g->beam].axis_lin / first_lin;
    }
    return ASDIC_OK;
}

/* The lowest arc above ARC. */
static long next_arc(const reader *r, long arc) {
    long next = LONG_MAX;
    for (size_t b = 0; b < r->look->sonar->receiver_count; b++) {
        long own = r->ears[b].arc;
        next = r->ears[b].is_asked && own > arc && own < next ? own : next;
    }
    return next;
}

static double slope(double elevation_rad) {
    return tan(fmin(fmax(elevation_rad, -STEEPEST), STEEPEST));
}

static asdic_status find_headings(asdic_context *ctx, reader *r) {
    asdic_evidence *f = r->out;
    double narrowest = 2.0 * ASDIC_PI;
    for (size_t b = 0; b < r->look->sonar->receiver_count; b++) {
        narrowest = fmin(narrowest, r->ears[b].width_rad);
    }
    for (long arc = next_arc(r, LONG_MIN); arc != LONG_MAX; arc = next_arc(r, arc)) {
        f->arcs++;
    }
    f->azimuths = (size_t)ceil(2.0 * ASDIC_PI * PER_WIDTH / narrowest);
    f->step_rad = 2.0 * ASDIC_PI / (double)f->azimuths;
    f->headings = calloc(f->arcs * f->azimuths + 1, sizeof *f->headings);
    if (!f->headings) {
        return asdic_fail_memory(ctx, "an occupancy map");
    }
    asdic_heading *h = f->headings;
    for (long arc = next_arc(r, LONG_MIN); arc != LONG_MAX; arc = next_arc(r, arc)) {
        for (size_t k = 0; k < f->azimuths; k++, h++) {
            double azimuth = f->step_rad * (double)k;
            const ear *e = nearest(r, arc, azimuth);
            if (e) {
                h->elevation_rad = e->elevation_rad;
                h->half_height_rad = 0.5 * e->height_rad;
                h->width_rad = e->width_rad;
                h->slope = slope(e->elevation_rad);
                h->slope_low = slope(e->elevation_rad - EDGE * e->height_rad);
                h->slope_high = slope(e->elevation_rad + EDGE * e->height_rad);
                TRY(hear(ctx, r, azimuth, h));
            }
        }
    }
    return ASDIC_OK;
}

/* --- evidence --------------------------------------------------------------------------------- */

/* Whether anything is known of BEAM at BIN. */
static bool is_known(const reader *r, size_t beam, size_t bin) {
    double mean = r->look->background_lin[beam * r->look->bins + bin];
    return mean > 0.0 && isfinite(mean);
}

/* K speckle only: forgets the ratios of all strengths of BEAM. */
static void empty_table(reader *r, size_t beam) {
    for (size_t q = 0; r->law.shape <= ASDIC_SHAPE_MAX && q < STRENGTHS; q++) {
        r->table[beam * STRENGTHS + q] = NAN;
    }
}

/* K speckle only: ln of the ratio of BEAM at BIN for strength Q over its background and what was
 * explained, which has no texture. Most strengths are never asked for. */
static double tabled(const reader *r, size_t beam, size_t bin, size_t q) {
    const asdic_look *look = r->look;
    size_t cell = beam * look->bins + bin;
    double *table = r->table + beam * STRENGTHS;
    if (!isnan(table[q])) {
        return table[q];
    }
    double mean = look->background_lin[cell], extra = r->extra_lin[beam];
    double noise = look->noise_lin ? look->noise_lin[cell] : 0.0;
    asdic_background law = r->law;
    law.mean_lin = mean + extra;
    law.noise_share = fmin(fmax((noise + extra) / law.mean_lin, 0.0), 1.0);
    double target_lin = mean * pow(10.0, 0.1 * (FIRST_DB + STEP_DB * (double)q));
    table[q] = asdic_k_table_llr(r->k_table, &law, target_lin, look->intensity_lin[cell]);
    return table[q];
}

/* ln of the ratio of BEAM at BIN for an echo of ECHO_LIN: that of asdic_detect_llr for independent
 * looks, where speckle is Rayleigh. */
static double ratio_of(const reader *r, size_t beam, size_t bin, double echo_lin) {
    size_t cell = beam * r->look->bins + bin;
    double mean = r->look->background_lin[cell];
    if (r->law.shape > ASDIC_SHAPE_MAX) {
        double rest = mean + r->extra_lin[beam], snr = echo_lin / rest;
        double x = r->look->intensity_lin[cell] / rest;
        return (double)r->law.looks * (x * snr / (1.0 + snr) - log(1.0 + snr));
    }
    double at = fmin((10.0 * log10(echo_lin / mean) - FIRST_DB) / STEP_DB, STRENGTHS - 1.000001);
    if (at < 0.0) { /* in proportion to the echo */
        return tabled(r, beam, bin, 0) * pow(10.0, 0.1 * STEP_DB * at);
    }
    size_t q = (size_t)at;
    double low = tabled(r, beam, bin, q);
    return low + (at - (double)q) * (tabled(r, beam, bin, q + 1) - low);
}

static asdic_vec3 direction_of(const reader *r, const asdic_heading *h) {
    size_t azimuth = (size_t)(h - r->out->headings) % r->out->azimuths;
    return direction(r->out->step_rad * (double)azimuth, h->elevation_rad);
}

/* The same of all beams that are compared, by their patterns at H, side lobes included: of directions that
 * each ask their own beams the one that asks one more of a strong echo would win, however ill it fits. */
static double ratio_compared(const reader *r, const asdic_heading *h, size_t bin,
                             double strength_lin) {
    asdic_vec3 towards = direction_of(r, h);
    double axis_lin = r->ears[r->out->hearings[h->hearing].beam].axis_lin, sum = 0.0;
    for (size_t b = 0; b < r->look->sonar->receiver_count; b++) {
        if (r->is_compared[b] && is_known(r, b, bin)) {
            double echo_lin = strength_lin * two_way(r, b, towards) / axis_lin;
            sum += r->ears[b].weight * ratio_of(r, b, bin, echo_lin);
        }
    }
    return sum;
}

/* The same of all beams of H, for an object that the best of them would hear with STRENGTH_LIN on its
 * axis. */
static double ratio_for(const reader *r, const asdic_heading *h, size_t bin, double strength_lin) {
    const asdic_hearing *g = r->out->hearings + h->hearing;
    double sum = 0.0;
    if (r->loudest != SIZE_MAX) {
        return ratio_compared(r, h, bin, strength_lin);
    }
    for (size_t i = 0; i < h->hearing_count; i++, g++) {
        if (is_known(r, g->beam, bin)) {
            sum += g->weight * ratio_of(r, g->beam, bin, strength_lin * g->gain_lin);
        }
    }
    return sum;
}

/* The strength that the loudest beam of H suggests; 0: none is louder than what is known. */
static double loudness(const reader *r, const asdic_heading *h, size_t bin) {
    const asdic_hearing *g = r->out->hearings + h->hearing;
    double most = 0.0, strength = 0.0;
    for (size_t i = 0; i < h->hearing_count; i++, g++) {
        size_t cell = g->beam * r->look->bins + bin;
        double mean = r->look->background_lin[cell];
        double echo = r->look->intensity_lin[cell] - mean - r->extra_lin[g->beam];
        if (is_known(r, g->beam, bin) && echo > most * mean) {
            most = echo / mean;
            strength = echo / g->gain_lin;
        }
    }
    return strength;
}

/* What an object of the detector's strength would be heard with by the beam that hears H best. */
static double faintest(const reader *r, const asdic_heading *h, size_t bin) {
    size_t beam = r->out->hearings[h->hearing].beam;
    return r->snr_lin * r->look->background_lin[beam * r->look->bins + bin];
}

/* ln of the ratio at heading H and BIN. */
static double read_heading(const reader *r, const asdic_heading *h, size_t bin) {
    if (h->hearing_count == 0 || !is_known(r, r->out->hearings[h->hearing].beam, bin)) {
        return NAN;
    }
    double least = faintest(r, h, bin), strength = loudness(r, h, bin);
    double faint = ratio_for(r, h, bin, least);
    if (!(strength > least)) {
        return faint;
    }
    double loud = ratio_for(r, h, bin, strength) - log(strength / least);
    return fmax(faint, loud) + log1p(exp(-fabs(faint - loud))) - log(2.0);
}

static bool hears(const reader *r, const asdic_heading *h, size_t beam) {
    const asdic_hearing *g = r->out->hearings + h->hearing, *end = g + h->hearing_count;
    while (g < end && g->beam != beam) {
        g++;
    }
    return g < end;
}

/* Whether heading I is read in this round: of a strong echo those that its loudest beam hears. */
static bool is_read(const reader *r, size_t i) {
    const asdic_heading *h = &r->out->headings[i];
    return !r->is_frozen[i] && h->hearing_count > 0 &&
           (r->loudest == SIZE_MAX || hears(r, h, r->loudest));
}

/* Finds the loudest beam at BIN, if its echo is strong, and the beams by which its headings are compared: all
 * that hear one of them. */
static size_t find_loudest(reader *r, size_t bin) {
    const asdic_evidence *f = r->out;
    size_t loudest = SIZE_MAX;
    double most = 0.0;
    for (size_t b = 0; b < r->look->sonar->receiver_count; b++) {
        size_t cell = b * r->look->bins + bin;
        double rest = r->look->background_lin[cell] + r->extra_lin[b];
        double echo = r->look->intensity_lin[cell] - rest;
        if (r->ears[b].is_asked && is_known(r, b, bin) && echo > fmax(STRONG_LIN * rest, most)) {
            most = echo;
            loudest = b;
        }
        r->is_compared[b] = false;
    }
    for (size_t i = 0; i < f->arcs * f->azimuths && loudest != SIZE_MAX; i++) {
        const asdic_heading *h = &f->headings[i];
        size_t heard = hears(r, h, loudest) ? h->hearing_count : 0;
        for (size_t k = 0; k < heard; k++) {
            r->is_compared[f->hearings[h->hearing + k].beam] = true;
        }
    }
    return loudest;
}

/* Explains what an object at heading BEST sends to all beams, and keeps what was read near it. */
static void explain(reader *r, size_t best, size_t bin) {
    asdic_evidence *f = r->out;
    const asdic_heading *h = &f->headings[best];
    const asdic_hearing *g = &f->hearings[h->hearing];
    double azimuth = f->step_rad * (double)(best % f->azimuths);
    asdic_vec3 towards = direction_of(r, h);
    double strength = loudness(r, h, bin),
           excess = f->ratio[best * f->bins + bin] - ASDIC_RATIO_MOST_LN;
    for (size_t b = 0; b < r->look->sonar->receiver_count; b++) {
        double echo = strength * two_way(r, b, towards) / r->ears[g->beam].axis_lin;
        r->extra_lin[b] += (1.0 + 1.0 / sqrt((double)r->law.looks)) * echo; /* itself a sample */
        empty_table(r, b);
    }
    for (size_t i = 0; i < f->arcs * f->azimuths; i++) {
        const asdic_heading *o = &f->headings[i];
        double own = f->step_rad * (double)(i % f->azimuths);
        if (is_read(r, i) && apart(own, azimuth) <= h->width_rad &&
            fabs(o->elevation_rad - h->elevation_rad) <= 2.0 * h->half_height_rad) {
            f->ratio[i * f->bins + bin] -= fmax(excess, 0.0);
            r->is_frozen[i] = true;
        }
    }
}

/* Reads the headings of a round. The best of them, if its echo is strong; else SIZE_MAX. */
static size_t read_headings(reader *r, size_t bin) {
    asdic_evidence *f = r->out;
    size_t best = SIZE_MAX;
    double most = 0.0;
    for (size_t i = 0; i < f->arcs * f->azimuths; i++) {
        if (!is_read(r, i)) {
            continue;
        }
        double ln = read_heading(r, &f->headings[i], bin);
        f->ratio[i * f->bins + bin] = ln;
        if (ln > most) {
            most = ln;
            best = i;
        }
    }
    const asdic_heading *h = best == SIZE_MAX ? NULL : &f->headings[best];
    bool is_strong = h && loudness(r, h, bin) * r->snr_lin >= STRONG_LIN * faintest(r, h, bin);
    return is_strong ? best : SIZE_MAX;
}

static void read_bin(reader *r, size_t bin) {
    asdic_evidence *f = r->out;
    size_t headings = f->arcs * f->azimuths;
    for (size_t i = 0; i < headings; i++) {
        r->is_frozen[i] = false;
    }
    for (size_t b = 0; b < r->look->sonar->receiver_count; b++) {
        r->extra_lin[b] = 0.0;
        empty_table(r, b);
    }
    for (int round = 0; round <= MOST_ECHOES; round++) {
        r->loudest = round < MOST_ECHOES ? find_loudest(r, bin) : SIZE_MAX;
        size_t best = r->loudest != SIZE_MAX ? read_headings(r, bin) : SIZE_MAX;
        if (best == SIZE_MAX) { /* no strong echo is left, or none that its headings explain */
            r->loudest = SIZE_MAX;
            best = read_headings(r, bin);
        }
        if (best == SIZE_MAX) {
            break;
        }
        explain(r, best, bin);
    }
    for (size_t i = 0; i < headings; i++) {
        double *ratio = &f->ratio[i * f->bins + bin];
        if (f->headings[i].hearing_count > 0 && !isnan(*ratio)) {
            *ratio = exp(fmin(*ratio, ASDIC_RATIO_MOST_LN));
        }
    }
}

/* --- all -------------------------------------------------------------------------------------- */

static asdic_status read_ping(asdic_context *ctx, reader *r) {
    const asdic_look *look = r->look;
    find_ears(r);
    TRY(find_headings(ctx, r));
    size_t headings = r->out->arcs * r->out->azimuths;
    r->is_frozen = calloc(headings + look->sonar->receiver_count, sizeof *r->is_frozen);
    r->out->ratio = malloc((headings * look->bins + 1) * sizeof *r->out->ratio);
    if (!r->is_frozen || !r->out->ratio) {
        return asdic_fail_memory(ctx, "an occupancy map");
    }
    r->is_compared = r->is_frozen + headings;
    for (size_t n = 0; n < look->bins; n++) {
        read_bin(r, n);
    }
    return ASDIC_OK;
}

asdic_status asdic_evidence_create(asdic_context *ctx, const asdic_look *look,
                                   asdic_k_table *k_table, asdic_evidence *out) {
    size_t beams = look->sonar->receiver_count;
    reader r = {.look = look,
                .out = out,
                .k_table = k_table,
                .rear_lin = fmax(pow(10.0, 0.1 * look->sonar->rear_floor_db), LEAST_REAR),
                .snr_lin = pow(10.0, 0.1 * look->snr_db)};
    *out = (asdic_evidence){.bins = look->bins};
    r.law = asdic_background_of(look->sonar, look->sound_speed_mps, 1.0, 0.0);
    r.ears = calloc(beams, sizeof *r.ears);
    r.extra_lin = calloc(beams * (1 + STRENGTHS), sizeof *r.extra_lin);
    asdic_status status =
        r.ears && r.extra_lin ? ASDIC_OK : asdic_fail_memory(ctx, "an occupancy map");
    if (status == ASDIC_OK) {
        r.table = r.extra_lin + beams;
        status = read_ping(ctx, &r);
    }
    free(r.ears);
    free(r.extra_lin);
    free(r.is_frozen);
    if (status) {
        asdic_evidence_finish(out);
    }
    return status;
}

void asdic_evidence_finish(asdic_evidence *f) {
    free(f->headings);
    free(f->hearings);
    free(f->ratio);
    *f = (asdic_evidence){0};
}
