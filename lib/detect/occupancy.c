/*
 * Occupancy: l <- clip(l + llr) per cell (Moravec & Elfes, IEEE ICRA 1985, in log-odds).
 */
#include <asdic/scan.h>

#include "base/context.h"
#include "sim/ring.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>

#define MOST_CELLS ((size_t)1 << 26)
/* Beams steeper than this (84 degrees) tell nothing about the place in the plane. */
#define LEAST_COS 0.1

asdic_vec3 asdic_beam_axis(const asdic_beam *beam, const asdic_pose *pose) {
    asdic_face face = asdic_face_aim(beam, pose, 1.0);
    const double *row = face.world_to_face.m[0];
    return (asdic_vec3){row[0], row[1], row[2]};
}

/* Half-power width of two apertures of the given lengths, m. */
static double width_rad(const asdic_sonar *sonar, double a_m, double b_m, double sound_speed_mps) {
    double wide = 0.886 * sound_speed_mps / (sonar->frequency_hz * hypot(a_m, b_m));
    return wide < 1.0 ? 2.0 * asin(0.5 * wide) : fmin(wide, ASDIC_PI);
}

double asdic_beam_width_rad(const asdic_sonar *sonar, size_t receiver, double sound_speed_mps) {
    return width_rad(sonar, sonar->transmitter.length_h_m, sonar->receivers[receiver].length_h_m,
                     sound_speed_mps);
}

/* The layer of RECEIVER. Beams whose axes lie within one vertical width of each other see the same
 * layer of water. */
static long layer_of(const asdic_sonar *sonar, size_t receiver, double sound_speed_mps,
                     asdic_vec3 axis) {
    double width = width_rad(sonar, sonar->transmitter.length_v_m,
                             sonar->receivers[receiver].length_v_m, sound_speed_mps);
    return lround(atan2(axis.z, hypot(axis.x, axis.y)) / width);
}

/* A ping's evidence by cell, in planes of the map's size: distance from the axis of the nearest
 * beam of a layer, that beam's evidence (NAN: none), the logarithm of the summed likelihood ratios
 * of the layers before, and their number. */
enum { ASIDE, LLR, SUM, LAYERS, PLANES };

static void forget(float *cell, size_t cells) {
    cell[ASIDE * cells] = INFINITY;
    cell[LLR * cells] = NAN;
    cell[SUM * cells] = -INFINITY;
    cell[LAYERS * cells] = 0.0f;
}

asdic_status asdic_occupancy_create(asdic_context *ctx, asdic_vec3 min_m, asdic_vec3 max_m,
                                    double cell_m, double prior, double limit,
                                    asdic_occupancy **out) {
    if (!out) {
        return asdic_fail_null(ctx, __func__);
    }
    *out = NULL;
    double rows = ceil((max_m.x - min_m.x) / cell_m), columns = ceil((max_m.y - min_m.y) / cell_m);
    if (!(cell_m > 0.0) || !(prior > 0.0 && prior < 1.0) || !(limit > 0.0)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "a map of cells of %g m, prior %g, limit %g: all must be above 0, the "
                          "prior below 1",
                          cell_m, prior, limit);
    }
    if (!(rows >= 1.0 && columns >= 1.0 && rows * columns <= (double)MOST_CELLS)) {
        return asdic_fail(
            ctx, ASDIC_ERROR_ARGUMENT,
            "a map of %.0f x %.0f cells of %g m: at most %zu cells; choose larger ones", rows,
            columns, cell_m, MOST_CELLS);
    }
    asdic_occupancy *map = calloc(1, sizeof *map);
    size_t cells = (size_t)rows * (size_t)columns;
    if (!map || !(map->log_odds = malloc((1 + PLANES) * cells * sizeof *map->log_odds))) {
        free(map);
        return asdic_fail_memory(ctx, "a map");
    }
    map->north_m = min_m.x;
    map->east_m = min_m.y;
    map->cell_m = cell_m;
    map->rows = (size_t)rows;
    map->columns = (size_t)columns;
    map->prior_log_odds = log(prior / (1.0 - prior));
    map->limit = limit;
    map->ping = map->log_odds + cells;
    for (size_t i = 0; i < cells; i++) {
        map->log_odds[i] = NAN;
        forget(map->ping + i, cells);
    }
    *out = map;
    return ASDIC_OK;
}

void asdic_occupancy_destroy(asdic_occupancy **map) {
    if (map && *map) {
        free((*map)->log_odds);
        free(*map);
        *map = NULL;
    }
}

/* What a beam covers in the plane. */
typedef struct sector {
    double north_m, east_m;       /* apex */
    double azimuth_rad, half_rad; /* direction, half its width */
    double cos_elevation;         /* of the axis */
    double begin_m, end_m;        /* in the plane */
} sector;

/* Index of the cells along one axis that [LOW, HIGH] touches. */
static void touched(double low_m, double high_m, double from_m, double cell_m, size_t count,
                    size_t *first, size_t *end) {
    double a = floor((low_m - from_m) / cell_m), b = floor((high_m - from_m) / cell_m) + 1.0;
    *first = (size_t)fmin(fmax(a, 0.0), (double)count);
    *end = (size_t)fmin(fmax(b, 0.0), (double)count);
}

/* The box round a sector in the plane. */
static void bound(const sector *s, double low[2], double high[2]) {
    low[0] = high[0] = s->north_m;
    low[1] = high[1] = s->east_m;
    int steps = 16;
    for (int i = 0; i <= steps; i++) { /* the arc lies outside its chord by less than 1 / cos */
        double angle = s->azimuth_rad + s->half_rad * (2.0 * i / steps - 1.0);
        double reach = s->end_m / cos(s->half_rad / steps);
        double at[2] = {s->north_m + reach * cos(angle), s->east_m + reach * sin(angle)};
        for (int k = 0; k < 2; k++) {
            low[k] = fmin(low[k], at[k]);
            high[k] = fmax(high[k], at[k]);
        }
    }
}

/* Cells that a ping touched. */
typedef struct patch {
    size_t row, row_end, column, column_end;
} patch;

static void widen(patch *all, const patch *p) {
    all->row = p->row < all->row ? p->row : all->row;
    all->column = p->column < all->column ? p->column : all->column;
    all->row_end = p->row_end > all->row_end ? p->row_end : all->row_end;
    all->column_end = p->column_end > all->column_end ? p->column_end : all->column_end;
}

/* Ends a layer in the cells of PATCH. */
static void add_layer(asdic_occupancy *map, const patch *p) {
    size_t cells = map->rows * map->columns;
    for (size_t row = p->row; row < p->row_end; row++) {
        for (size_t column = p->column; column < p->column_end; column++) {
            float *cell = map->ping + row * map->columns + column;
            float llr = cell[LLR * cells], sum = cell[SUM * cells];
            if (!isnan(llr)) {
                cell[SUM * cells] = fmaxf(sum, llr) + log1pf(expf(-fabsf(sum - llr)));
                cell[LAYERS * cells] += 1.0f;
            }
            cell[ASIDE * cells] = INFINITY;
            cell[LLR * cells] = NAN;
        }
    }
}

/* Adds the ping's evidence to the cells of PATCH, clips, and clears the evidence. */
static void add_ping(asdic_occupancy *map, const patch *p) {
    size_t cells = map->rows * map->columns;
    for (size_t row = p->row; row < p->row_end; row++) {
        for (size_t column = p->column; column < p->column_end; column++) {
            size_t at = row * map->columns + column;
            float *cell = map->ping + at;
            if (cell[LAYERS * cells] > 0.0f) {
                double before =
                    isnan(map->log_odds[at]) ? map->prior_log_odds : (double)map->log_odds[at];
                double llr = (double)(cell[SUM * cells] - logf(cell[LAYERS * cells]));
                map->log_odds[at] = (float)fmin(fmax(before + llr, -map->limit), map->limit);
            }
            forget(cell, cells);
        }
    }
}

static patch add_sector(asdic_occupancy *map, const sector *s, double bin_m, size_t bins,
                        const double *llr) {
    double low[2], high[2];
    patch p;
    size_t cells = map->rows * map->columns;
    bound(s, low, high);
    touched(low[0], high[0], map->north_m, map->cell_m, map->rows, &p.row, &p.row_end);
    touched(low[1], high[1], map->east_m, map->cell_m, map->columns, &p.column, &p.column_end);
    for (size_t row = p.row; row < p.row_end; row++) {
        double north = map->north_m + ((double)row + 0.5) * map->cell_m - s->north_m;
        for (size_t column = p.column; column < p.column_end; column++) {
            double east = map->east_m + ((double)column + 0.5) * map->cell_m - s->east_m;
            double plane = hypot(north, east);
            double aside = remainder(atan2(east, north) - s->azimuth_rad, 2.0 * ASDIC_PI);
            double bin = floor(plane / s->cos_elevation / bin_m);
            float *cell = map->ping + row * map->columns + column;
            if (fabs(aside) <= s->half_rad && bin < (double)bins && !isnan(llr[(size_t)bin]) &&
                (float)fabs(aside) < cell[ASIDE * cells]) {
                cell[ASIDE * cells] = (float)fabs(aside);
                cell[LLR * cells] = (float)llr[(size_t)bin];
            }
        }
    }
    return p;
}

typedef struct view {
    const asdic_sonar *sonar;
    double sound_speed_mps;
    const asdic_pose *pose;
    size_t bins;
    const double *llr;
} view;

/* Adds the beams of LAYER and returns the cells that they see. *NEXT: the lowest layer above it. */
static patch add_beams(asdic_occupancy *map, const view *v, long layer, long *next) {
    const asdic_sonar *sonar = v->sonar;
    patch all = {.row = map->rows, .column = map->columns};
    *next = LONG_MAX;
    for (size_t b = 0; b < sonar->receiver_count; b++) {
        asdic_vec3 axis = asdic_beam_axis(&sonar->receivers[b], v->pose);
        long own = layer_of(sonar, b, v->sound_speed_mps, axis);
        *next = own > layer && own < *next ? own : *next;
        sector s = {.north_m = v->pose->position_m.x,
                    .east_m = v->pose->position_m.y,
                    .azimuth_rad = atan2(axis.y, axis.x),
                    .half_rad = 0.5 * asdic_beam_width_rad(sonar, b, v->sound_speed_mps),
                    .cos_elevation = hypot(axis.x, axis.y)};
        s.end_m = (double)v->bins * sonar->bin_length_m * s.cos_elevation;
        if (own == layer && s.cos_elevation >= LEAST_COS) {
            patch p = add_sector(map, &s, sonar->bin_length_m, v->bins, v->llr + b * v->bins);
            widen(&all, &p);
        }
    }
    return all;
}

/* An echo comes from one of m layers, each equally likely: the likelihood ratio is the mean of the
 * layers' ratios, also where they are correlated. */
void asdic_occupancy_add(asdic_occupancy *map, const asdic_sonar *sonar, double sound_speed_mps,
                         const asdic_pose *pose, size_t bins, const double *llr) {
    const view v = {sonar, sound_speed_mps, pose, bins, llr};
    patch all = {.row = map->rows, .column = map->columns};
    long next;
    for (long layer = LONG_MIN; layer != LONG_MAX; layer = next) {
        patch p = add_beams(map, &v, layer, &next);
        add_layer(map, &p);
        widen(&all, &p);
    }
    add_ping(map, &all);
}
