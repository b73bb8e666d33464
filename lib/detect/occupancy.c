/*
 * Occupancy: log-odds of an object in the cells of a map (Moravec & Elfes, IEEE ICRA 1985; Elfes,
 * Computer 22 (6), 46 (1989)). The step of a cell is in scan.h.
 */
#include <asdic/scan.h>

#include "base/context.h"
#include "base/try.h"
#include "base/widest.h"
#include "evidence.h"
#include "hidden.h"
#include "sim/ring.h"

#include <math.h>
#include <stdlib.h>

#define MOST_CELLS ((size_t)1 << 26)

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

double asdic_beam_height_rad(const asdic_sonar *sonar, size_t receiver, double sound_speed_mps) {
    return width_rad(sonar, sonar->transmitter.length_v_m, sonar->receivers[receiver].length_v_m,
                     sound_speed_mps);
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
            "a map of %.9g x %.9g cells of %g m: at most %zu cells; choose larger ones", rows,
            columns, cell_m, MOST_CELLS);
    }
    asdic_occupancy *map = calloc(1, sizeof *map);
    size_t cells = (size_t)rows * (size_t)columns;
    if (!map || !(map->log_odds = malloc(4 * cells * sizeof *map->log_odds))) {
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
    map->floor_depth_m = map->log_odds + cells;
    map->part[ASDIC_OCCUPANCY_FLOOR] = map->floor_depth_m + cells;
    map->part[ASDIC_OCCUPANCY_WATER] = map->part[ASDIC_OCCUPANCY_FLOOR] + cells;
    for (size_t i = 0; i < cells; i++) {
        map->log_odds[i] = map->floor_depth_m[i] = NAN;
        map->part[0][i] = map->part[1][i] = -INFINITY;
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

/* --- a ping ----------------------------------------------------------------------------------- */

/* A cell that is heard: its azimuth in steps, its distance in the plane. */
typedef struct spot {
    size_t cell, azimuth;
    double plane_m,
        half_m; /* ... and half its length along that, where it is longer than a bin; else 0 */
    double rate[ASDIC_OCCUPANCY_PARTS]; /* -ln(1 - p), by the map so far */
} spot;

/* Places in a cell at which an object may be, by index of heading and bin together, and the share of
 * objects that are there; the rest of these is not heard. */
typedef struct place {
    size_t at;
    double share;
} place;

/* A ping's evidence, and what the map says of the cells of each heading and bin. */
typedef struct update {
    asdic_occupancy *map;
    const asdic_look *look;
    asdic_evidence seen;
    spot *spots;
    size_t spot_count;
    double *rate;       /* their sum over the cells of [heading * bins + bin] */
    double *empty;      /* probability that all cells of headings within a beam's width are empty */
    double *mean;       /* of the likelihood ratios over these */
    size_t most_ranges; /* of a cell that is longer than a bin, at most */
    place *places;      /* of the spot in hand, with room for those of all arcs */
    size_t place_count;
    double *column_m; /* by bin, of the column in hand: what of its height is heard there; else 0 */
    size_t first, beyond; /* ... in these bins */
} update;

static void add_place(update *u, size_t heading, double bin, double share) {
    size_t at = heading * u->seen.bins + (size_t)fmin(bin, (double)u->seen.bins - 1.0);
    if (bin < (double)u->seen.bins && !isnan(u->seen.ratio[at])) {
        u->places[u->place_count++] = (place){at, share};
    }
}

static double floor_below(const update *u, const spot *s) {
    double floor_m = (double)u->map->floor_depth_m[s->cell];
    return isnan(floor_m) ? (double)INFINITY : floor_m - u->look->pose.position_m.z;
}

/* Bins that a cell is long; 1 where it is no longer than one. */
static double ranges_of(const update *u, const spot *s) {
    double count = ceil(2.0 * s->half_m / u->look->sonar->bin_length_m);
    return fmin(fmax(count, 1.0), (double)u->most_ranges);
}

/* On the floor: in the arc that is nearest in elevation, if that hears it. */
static void add_on_floor(update *u, const spot *s) {
    const asdic_evidence *f = &u->seen;
    double below = floor_below(u, s), slope = below / s->plane_m, least = INFINITY;
    size_t best = 0;
    for (size_t a = 0; a < f->arcs && isfinite(slope); a++) {
        const asdic_heading *h = &f->headings[a * f->azimuths + s->azimuth];
        double off = fabs(slope - h->slope);
        if (h->hearing_count > 0 && slope > h->slope_low && slope < h->slope_high && off < least) {
            least = off;
            best = a * f->azimuths + s->azimuth;
        }
    }
    if (least < INFINITY) {
        double count = ranges_of(u, s);
        for (double i = 0.5; i < count; i += 1.0) {
            double plane_m = s->plane_m + (2.0 * i / count - 1.0) * s->half_m;
            double range_m = sqrt(plane_m * plane_m + below * below);
            add_place(u, best, range_m / u->look->sonar->bin_length_m, 1.0 / count);
        }
    }
}

/* Water between LOW_M and HIGH_M re the sonar, which holds SHARE of the objects of its column. */
typedef struct water {
    double plane_m, low_m, high_m, share;
} water;

/* The length that [FROM, TO] and [LOW, HIGH] have in common. */
static inline double overlap(double from, double to, double low, double high) {
    double least = from > low ? from : low, most = to < high ? to : high;
    return most > least ? most - least : 0.0;
}

static inline double above_plane_m(double range_m, double plane_m) {
    double square = range_m * range_m - plane_m * plane_m;
    return sqrt(square > 0.0 ? square : 0.0);
}

/* Adds the heights at which the bins [FIRST, END) hear W. */
WIDEST static void hear_bins(const water *w, double bin_m, size_t first, size_t end,
                             double *restrict column_m) {
    for (size_t n = first; n < end; n++) {
        double from = above_plane_m((double)n * bin_m, w->plane_m);
        double to = above_plane_m((double)(n + 1) * bin_m, w->plane_m);
        column_m[n] += w->share * (overlap(from, to, w->low_m, w->high_m) +
                                   overlap(-to, -from, w->low_m, w->high_m));
    }
}

/* Each bin hears what of W lies at its range, and none is left out. What is shorter than a bin is taken at its
 * middle height. */
static void hear_water(update *u, const water *w) {
    double bin_m = u->look->sonar->bin_length_m, low_m = w->low_m, high_m = w->high_m;
    double least_m = low_m * high_m < 0.0 ? 0.0 : fmin(fabs(low_m), fabs(high_m));
    double most_m = fmax(fabs(low_m), fabs(high_m)), bins = (double)u->seen.bins;
    double near_m = hypot(w->plane_m, least_m), far_m = hypot(w->plane_m, most_m);
    bool is_short = far_m - near_m < bin_m;
    double at_m = is_short ? hypot(w->plane_m, 0.5 * (least_m + most_m)) : near_m;
    if (at_m / bin_m >= bins) {
        return;
    }
    size_t first = (size_t)(at_m / bin_m), end = first + 1;
    if (is_short) {
        u->column_m[first] += w->share * (high_m - low_m);
    } else {
        end = (size_t)fmin(floor(far_m / bin_m) + 1.0, bins);
        hear_bins(w, bin_m, first, end, u->column_m);
    }
    u->first = first < u->first ? first : u->first;
    u->beyond = end > u->beyond ? end : u->beyond;
}

/* A column of water between LOW_M and HIGH_M re the sonar, over all distances of a long cell. */
static void add_column(update *u, size_t heading, const spot *s, double low_m, double high_m) {
    double count = ranges_of(u, s);
    u->first = SIZE_MAX;
    u->beyond = 0;
    for (double i = 0.5; i < count; i += 1.0) {
        double plane_m = fmax(s->plane_m + (2.0 * i / count - 1.0) * s->half_m, 0.0);
        hear_water(u, &(water){plane_m, low_m, high_m, 1.0 / count});
    }
    for (size_t n = u->first; n < u->beyond; n++) {
        if (u->column_m[n] > 0.0) {
            add_place(u, heading, (double)n, u->column_m[n]);
            u->column_m[n] = 0.0;
        }
    }
}

/* In the water: in each arc the part of its height between surface and floor, of all the water there
 * where that is known. */
static void add_in_water(update *u, const spot *s) {
    const asdic_evidence *f = &u->seen;
    double above = u->look->depth_m, below = floor_below(u, s), heard_m = 0.0;
    for (size_t a = 0; a < f->arcs; a++) {
        const asdic_heading *h = &f->headings[a * f->azimuths + s->azimuth];
        double low = fmax(s->plane_m * h->slope_low, -above);
        double high = fmin(s->plane_m * h->slope_high, below);
        if (h->hearing_count == 0 || low >= high) {
            continue;
        }
        heard_m += high - low;
        add_column(u, a * f->azimuths + s->azimuth, s, low, high);
    }
    double all_m = isfinite(above + below) ? fmax(heard_m, above + below) : heard_m;
    for (size_t i = 0; i < u->place_count; i++) {
        u->places[i].share /= all_m;
    }
}

static void find_places(update *u, const spot *s, int part) {
    u->place_count = 0;
    (part == ASDIC_OCCUPANCY_FLOOR ? add_on_floor : add_in_water)(u, s);
}

/* -ln(1 - p), to 1e-9: most cells are empty, and their series is quick. */
static double rate_of(double log_odds) {
    double odds = exp(log_odds);
    return odds < 1e-3 ? odds * (1.0 - odds * (0.5 - odds / 3.0)) : log1p(odds);
}

/* Tells the places of a spot what the map says of its cell. */
static void tell_places(update *u, const spot *s, int part) {
    find_places(u, s, part);
    for (size_t i = 0; i < u->place_count; i++) {
        u->rate[u->places[i].at] += s->rate[part] * u->places[i].share;
    }
}

/* Tells a cell what its places say: ln of their mean, where what is not heard says nothing. */
static void tell_cell(update *u, const spot *s, int part) {
    find_places(u, s, part);
    double sum = 0.0, share = 0.0;
    for (size_t i = 0; i < u->place_count; i++) {
        const place *p = &u->places[i];
        double own = s->rate[part] * p->share; /* not among the others */
        double others = own < 1e-5 ? 1.0 + own : exp(own);
        double empty = fmin(u->empty[p->at] * others, 1.0);
        double ratio = u->seen.ratio[p->at], mean = u->mean[p->at], full = 1.0 - empty;
        double both = ratio > 1.0 && mean > 1.0 ? fmax(ratio, mean) : ratio * mean;
        sum += p->share * (empty * ratio + full * both) / (empty + full * mean);
        share += p->share;
    }
    if (u->place_count > 0) {
        float *log_odds = &u->map->part[part][s->cell];
        double limit = u->map->limit;
        double after = (double)*log_odds + log(sum + fmax(1.0 - share, 0.0));
        *log_odds = (float)fmin(fmax(after, -limit), limit);
        u->map->log_odds[s->cell] = 0.0f; /* looked at */
    }
}

/* A cell holds an object where one of its parts does: 1 + odds are the product of theirs. */
static void join_parts(update *u, const spot *s) {
    asdic_occupancy *map = u->map;
    if (!isnan(map->log_odds[s->cell])) {
        double a = exp((double)map->part[0][s->cell]), b = exp((double)map->part[1][s->cell]);
        map->log_odds[s->cell] = (float)fmin(fmax(log(a + b + a * b), -map->limit), map->limit);
    }
}

/* Whether a beam of any arc hears each azimuth, and the box round what they hear: least and greatest
 * north and east, re the sonar. */
static void find_box(const asdic_evidence *f, double reach_m, bool *is_heard, double box[4]) {
    for (size_t i = 0; i < f->arcs * f->azimuths; i++) {
        is_heard[i % f->azimuths] |= f->headings[i].hearing_count > 0;
    }
    for (size_t k = 0; k < f->azimuths; k++) {
        for (int side = -1; side <= 1 && is_heard[k]; side += 2) {
            double azimuth = f->step_rad * ((double)k + 0.5 * side);
            double north = reach_m * cos(azimuth), east = reach_m * sin(azimuth);
            box[0] = fmin(box[0], north);
            box[1] = fmax(box[1], north);
            box[2] = fmin(box[2], east);
            box[3] = fmax(box[3], east);
        }
    }
}

/* The cells of a map's side from FROM_M on that [LOW_M, HIGH_M] touches. */
static void touched(double low_m, double high_m, double from_m, double cell_m, size_t count,
                    size_t *first, size_t *end) {
    double a = floor((low_m - from_m) / cell_m), b = floor((high_m - from_m) / cell_m) + 1.0;
    *first = (size_t)fmin(fmax(a, 0.0), (double)count);
    *end = (size_t)fmin(fmax(b, 0.0), (double)count);
}

/* A cell that is seen for the first time: objects are as likely on the floor, where that is known, as in
 * the water. */
static void begin_cell(asdic_occupancy *map, size_t cell) {
    bool has_floor = !isnan(map->floor_depth_m[cell]);
    double prior = 1.0 / (1.0 + exp(-map->prior_log_odds)), half = 0.5 * prior;
    double log_odds = has_floor ? log(half / (1.0 - half)) : map->prior_log_odds;
    map->part[ASDIC_OCCUPANCY_WATER][cell] = (float)log_odds;
    map->part[ASDIC_OCCUPANCY_FLOOR][cell] = has_floor ? (float)log_odds : -INFINITY;
}

/* Half a cell's length along its azimuth, NORTH_M and EAST_M from the sonar. Cells no longer than bins leave none out
 * that are taken at their centres: 0. */
static double half_length_m(const update *u, double north_m, double east_m) {
    double cell_m = u->map->cell_m, plane_m = hypot(north_m, east_m);
    bool is_long = cell_m > u->look->sonar->bin_length_m * (1.0 + 1e-9) && plane_m > 0.0;
    return is_long ? 0.5 * cell_m * (fabs(north_m) + fabs(east_m)) / plane_m : 0.0;
}

static asdic_status find_spots(asdic_context *ctx, update *u) {
    const asdic_occupancy *map = u->map;
    const asdic_evidence *f = &u->seen;
    asdic_vec3 from = u->look->pose.position_m;
    double reach = (double)u->look->bins * u->look->sonar->bin_length_m, box[4] = {0};
    bool *is_heard = calloc(f->azimuths, sizeof *is_heard);
    if (!is_heard) {
        return asdic_fail_memory(ctx, "an occupancy map");
    }
    find_box(f, reach, is_heard, box);
    size_t row, row_end, column, column_end;
    touched(from.x + box[0], from.x + box[1], map->north_m, map->cell_m, map->rows, &row, &row_end);
    touched(from.y + box[2], from.y + box[3], map->east_m, map->cell_m, map->columns, &column,
            &column_end);
    u->spots = malloc(((row_end - row) * (column_end - column) + 1) * sizeof *u->spots);
    for (; row < row_end && u->spots; row++) {
        double north = map->north_m + ((double)row + 0.5) * map->cell_m - from.x;
        for (size_t c = column; c < column_end; c++) {
            double east = map->east_m + ((double)c + 0.5) * map->cell_m - from.y;
            double plane = sqrt(north * north + east * east);
            if (plane <= reach) {
                double at = atan2(east, north) / f->step_rad;
                size_t k = (size_t)lround(at + (double)f->azimuths) % f->azimuths;
                size_t cell = row * map->columns + c;
                if (is_heard[k]) {
                    if (isnan(map->log_odds[cell])) {
                        begin_cell(u->map, cell);
                    }
                    u->spots[u->spot_count++] = (spot){
                        cell,
                        k,
                        plane,
                        half_length_m(u, north, east),
                        {rate_of((double)map->part[0][cell]), rate_of((double)map->part[1][cell])}};
                }
            }
        }
    }
    free(is_heard);
    return u->spots ? ASDIC_OK : asdic_fail_memory(ctx, "an occupancy map");
}

/* Sums rates, and ratios weighted by them, over the headings within a beam's width. */
static void join_neighbours(update *u) {
    const asdic_evidence *f = &u->seen;
    for (size_t i = 0; i < f->arcs * f->azimuths; i++) {
        const asdic_heading *h = &f->headings[i];
        long wide = lround(h->width_rad / f->step_rad);
        long most = ((long)f->azimuths - 1) / 2;
        wide = wide > most ? most : wide;
        for (size_t n = 0; n < f->bins && h->hearing_count > 0; n++) {
            double rate = 0.0, weighted = 0.0;
            for (long k = -wide; k <= wide; k++) {
                size_t first = i - i % f->azimuths;
                size_t azimuth = (i % f->azimuths + f->azimuths + (size_t)k) % f->azimuths;
                size_t at = (first + azimuth) * f->bins + n;
                if (u->rate[at] > 0.0) {
                    rate += u->rate[at];
                    weighted += u->rate[at] * f->ratio[at];
                }
            }
            u->empty[i * f->bins + n] = exp(-rate);
            u->mean[i * f->bins + n] = rate > 0.0 ? weighted / rate : 1.0;
        }
    }
}

static asdic_status add(asdic_context *ctx, asdic_k_table *k_table, update *u) {
    TRY(asdic_evidence_create(ctx, u->look, k_table, &u->seen));
    TRY(asdic_evidence_hide(ctx, u->look, k_table, &u->seen));
    TRY(find_spots(ctx, u));
    size_t count = u->seen.arcs * u->seen.azimuths * u->seen.bins;
    u->rate = calloc(3 * count + 1, sizeof *u->rate);
    double across = ceil(sqrt(2.0) * u->map->cell_m / u->look->sonar->bin_length_m);
    u->most_ranges = (size_t)fmin(across, (double)u->seen.bins);
    u->places = malloc((u->seen.arcs * u->seen.bins + 1) * sizeof *u->places);
    u->column_m = calloc(u->seen.bins, sizeof *u->column_m);
    if (!u->rate || !u->places || !u->column_m) {
        return asdic_fail_memory(ctx, "an occupancy map");
    }
    u->empty = u->rate + count;
    u->mean = u->empty + count;
    for (size_t i = 0; i < u->spot_count; i++) {
        tell_places(u, &u->spots[i], ASDIC_OCCUPANCY_FLOOR);
        tell_places(u, &u->spots[i], ASDIC_OCCUPANCY_WATER);
    }
    join_neighbours(u);
    for (size_t i = 0; i < u->spot_count; i++) {
        tell_cell(u, &u->spots[i], ASDIC_OCCUPANCY_FLOOR);
        tell_cell(u, &u->spots[i], ASDIC_OCCUPANCY_WATER);
        join_parts(u, &u->spots[i]);
    }
    return ASDIC_OK;
}

asdic_status asdic_occupancy_add_tabled(asdic_context *ctx, asdic_occupancy *map,
                                        const asdic_look *look, asdic_k_table *k_table) {
    if (!map || !look || !look->sonar || !look->intensity_lin || !look->background_lin) {
        return asdic_fail_null(ctx, __func__);
    }
    TRY(asdic_sonar_check(ctx, look->sonar));
    const asdic_pose *at = &look->pose;
    if (!isfinite(at->position_m.x + at->position_m.y + at->position_m.z) ||
        !isfinite(at->roll_rad + at->pitch_rad + at->yaw_rad)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "a look from a pose that is not finite");
    }
    if (!(look->sound_speed_mps >= 100.0 && look->sound_speed_mps <= 1e4) || look->bins == 0 ||
        isnan(look->depth_m) || !isfinite(look->snr_db)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "a look at %zu bins in water of %g m/s, %g m deep, for objects of %g dB",
                          look->bins, look->sound_speed_mps, look->depth_m, look->snr_db);
    }
    update u = {.map = map, .look = look};
    asdic_status status = add(ctx, k_table, &u);
    free(u.spots);
    free(u.rate);
    free(u.places);
    free(u.column_m);
    asdic_evidence_finish(&u.seen);
    return status;
}

asdic_status asdic_occupancy_add(asdic_context *ctx, asdic_occupancy *map, const asdic_look *look) {
    return asdic_occupancy_add_tabled(ctx, map, look, NULL);
}
