#include "truth.h"

#include "base/context.h"
#include "base/grow.h"
#include "base/share.h"
#include "base/try.h"
#include "base/vec.h"
#include "base/widest.h"
#include "pulse.h"
#include "ring.h"
#include "truth_shares.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TILE ASDIC_TRUTH_BEAMS
/* An echo may lie in a bin next to that of its range; and rounding. */
#define ROOM_BINS 2.0

/* Receivers of a row of cells, rounded up to the vectors that kernels add; of a fan those of a tile. */
static size_t columns_of(const asdic_simulator *sim) {
    size_t beams = sim->setup.sonar.receiver_count, width = sim->setup.layout.width;
    if (sim->fan.many) {
        return DEV_FAN_TILE;
    }
    return width == 8 && beams <= 4 ? 4 : (beams + width - 1) / width * width;
}

/* Doubles that a thread needs for telling a tile. */
static size_t work_of(const asdic_simulator *sim) {
    return (5 * TILE + 1) * sim->setup.bins;
}

asdic_status asdic_truth_init(asdic_simulator *sim) {
    asdic_truth_rows *t = &sim->truth;
    const asdic_scene *scene = sim->setup.scene;
    if (!sim->setup.sampling.truth) {
        return asdic_buffer_create(sim->device, 0, NULL, &t->table_buffer);
    }
    t->rows = DEV_TRUTH_OBJECTS + scene->part_count;
    t->columns = columns_of(sim);
    if (t->rows > DEV_TRUTH_MOST_ROWS || scene->object_count > INT16_MAX) {
        return asdic_fail(
            sim->ctx, ASDIC_ERROR_ARGUMENT,
            "truth tells at most %d objects with a shape and %d in all apart, and the "
            "scene has %zu; leave objects or 'truth' out",
            DEV_TRUTH_MOST_ROWS - DEV_TRUTH_OBJECTS - 1, INT16_MAX, scene->object_count);
    }
    size_t pings = sim->setup.ping_batch;
    t->table = calloc(pings * t->rows, sizeof *t->table);
    t->work = calloc(sim->setup.threads * work_of(sim), sizeof *t->work);
    if (!t->table || !t->work) {
        return asdic_fail_memory(sim->ctx, "what bins hold");
    }
    return asdic_buffer_create(sim->device, pings * t->rows * sizeof *t->table, NULL,
                               &t->table_buffer);
}

void asdic_truth_finish(asdic_simulator *sim) {
    asdic_truth_rows *t = &sim->truth;
    asdic_buffer_destroy(&t->table_buffer);
    asdic_buffer_destroy(&t->cell_buffer);
    free(t->table);
    free(t->work);
    free(t->points);
    free(t->point_lin);
}

/* --- before and after the rays ---------------------------------------------------------------- */

/* Copies of a cell: collect.cl's work-items have one each, which the host adds; or of a fan its tiles. */
static size_t copies(const asdic_simulator *sim) {
    if (sim->fan.many) {
        return sim->fan.tiles;
    }
    bool collects = sim->setup.layout.deposit == ASDIC_DEPOSIT_COLLECT;
    return collects ? sim->setup.ping.sums.blocks / 2 : 1;
}

static size_t cell_bytes(const asdic_simulator *sim) {
    return sim->fan.many ? sizeof(float) : sizeof(int64_t);
}

/* The bins that direct echoes of PART may fall into: all where rays bend, none of the bottom. */
static dev_truth_row part_row(const asdic_simulator *sim, const asdic_part *part,
                              const asdic_pose *pose) {
    double bins = (double)sim->setup.bins, bin_m = sim->setup.sonar.bin_length_m;
    if (part->kind != DEV_KIND_OBJECT || sim->setup.components <= DEV_DEPOSIT_OBJECT) {
        return (dev_truth_row){0};
    }
    if (sim->setup.bend_per_m != 0.0 || sim->setup.layer_count > 0) {
        return (dev_truth_row){.high = (dev_uint)sim->setup.bins};
    }
    double range_m = asdic_vec3_length(asdic_vec3_sub(part->center_m, pose->position_m));
    double low = floor((range_m - part->radius_m) / bin_m) - ROOM_BINS;
    double high = ceil((range_m + part->radius_m) / bin_m) + ROOM_BINS;
    return (dev_truth_row){.low = (dev_uint)fmin(fmax(low, 0.0), bins),
                           .high = (dev_uint)fmin(fmax(high, 0.0), bins)};
}

/* The rows of SHOT to TABLE; the cells that they take. */
static size_t place_rows(const asdic_simulator *sim, const asdic_ping_shot *shot,
                         dev_truth_row *table) {
    const asdic_truth_rows *t = &sim->truth;
    bool boundaries = asdic_simulator_boundaries_mirror(sim);
    dev_uint bins = (dev_uint)sim->setup.bins;
    size_t cells = 0;
    /* A fan's depressions lie among its results. */
    table[DEV_TRUTH_DEPRESSION] = (dev_truth_row){.high = sim->fan.many ? 0 : bins};
    table[DEV_TRUTH_BY_SURFACE] = table[DEV_TRUTH_BY_BOTTOM] =
        (dev_truth_row){.high = boundaries ? bins : 0};
    for (size_t r = 0; r < t->rows; r++) {
        if (r >= DEV_TRUTH_OBJECTS) {
            table[r] = part_row(sim, &sim->placement->parts[r - DEV_TRUTH_OBJECTS], &shot->pose);
        }
        table[r].cell = (dev_uint)cells;
        cells += table[r].high - table[r].low;
    }
    return cells;
}

/* Depressions of all components are summed in one scale, twice the coarsest of those that there are: what comes from
 * straight ahead then counts one for one. */
static void scale_depressions(const asdic_simulator *sim, dev_sums *sums) {
    float least = FLT_MAX / 2.0f; /* nothing echoes */
    for (size_t c = 0; c < sim->setup.components; c++) {
        bool echoes = c != DEV_DEPOSIT_VOLUME && (sums->present & 1u << c);
        least = echoes ? fminf(least, sums->scale[c]) : least;
    }
    for (size_t c = 0; c < sim->setup.components; c++) {
        sums->truth_ratio[c] = c == DEV_DEPOSIT_VOLUME ? 0.0f : 2.0f * least / sums->scale[c];
    }
}

/* Room for CELLS of a receiver, of all pings and copies. */
static asdic_status make_room(asdic_simulator *sim, size_t cells) {
    asdic_truth_rows *t = &sim->truth;
    t->bytes = cells * t->columns * cell_bytes(sim);
    if (t->cell_buffer && t->cells && t->bytes <= asdic_buffer_bytes(t->cell_buffer)) {
        return ASDIC_OK;
    }
    size_t room = t->bytes + t->bytes / 4;
    asdic_buffer_destroy(&t->cell_buffer);
    TRY(asdic_buffer_create(sim->device, room, NULL, &t->cell_buffer));
    t->cells = asdic_buffer_memory(t->cell_buffer);
    return t->cells ? ASDIC_OK : asdic_fail_memory(sim->ctx, "what bins hold");
}

asdic_status asdic_truth_begin(asdic_simulator *sim, size_t count, asdic_ping *const *out) {
    asdic_truth_rows *t = &sim->truth;
    size_t cells = 0;
    t->asked = false;
    t->bytes = t->point_count = 0;
    for (size_t k = 0; k < count && t->rows > 0; k++) {
        t->asked |= out[k]->truth != NULL;
    }
    for (size_t k = 0; k < count; k++) {
        dev_sums *sums = &sim->shots[k].ping->sums;
        sums->truth_rows = t->asked ? (dev_uint)t->rows : 0;
        if (t->asked) {
            size_t own = place_rows(sim, &sim->shots[k], t->table + k * t->rows);
            sums->truth_columns = (dev_uint)t->columns;
            sums->truth_first = (dev_uint)cells;
            sums->truth_cells = (dev_uint)own;
            scale_depressions(sim, sums);
            cells += own;
        }
    }
    if (!t->asked) {
        return ASDIC_OK;
    }
    TRY(make_room(sim, cells * copies(sim)));
    /* The host changes the table again only for later shots, when it has what these became. */
    TRY(asdic_buffer_send(t->table_buffer, count * t->rows * sizeof *t->table, t->table));
    return asdic_buffer_zero(t->cell_buffer, t->bytes);
}

asdic_status asdic_truth_fetch(asdic_simulator *sim) {
    asdic_truth_rows *t = &sim->truth;
    return t->asked && !sim->fan.many ? asdic_buffer_read(t->cell_buffer, 0, t->bytes, t->cells)
                                      : ASDIC_OK;
}

static asdic_status make_point_room(asdic_simulator *sim) {
    asdic_truth_rows *t = &sim->truth;
    size_t row_bytes = sim->setup.sonar.receiver_count * sizeof *t->point_lin;
    size_t room = t->point_room, rows = t->point_room;
    if (!asdic_grow(&t->points, t->point_count, &room, sizeof *t->points) ||
        !asdic_grow(&t->point_lin, t->point_count, &rows, row_bytes)) {
        return asdic_fail_memory(sim->ctx, "what points send back");
    }
    t->point_room = room;
    return ASDIC_OK;
}

/* What comes to one bin in one way from one point, and arrives from one direction, is one row. */
asdic_status asdic_truth_point_row(asdic_simulator *sim, asdic_truth_point what, double **row) {
    asdic_truth_rows *t = &sim->truth;
    size_t beams = sim->setup.sonar.receiver_count, k = t->point_count;
    *row = NULL;
    if (!t->asked) {
        return ASDIC_OK;
    }
    while (k > 0 && t->points[k - 1].point == what.point &&
           (t->points[k - 1].bin != what.bin || t->points[k - 1].by != what.by ||
            t->points[k - 1].down != what.down)) {
        k--;
    }
    if (k == 0 || t->points[k - 1].point != what.point) {
        TRY(make_point_room(sim));
        k = ++t->point_count;
        t->points[k - 1] = what;
        memset(&t->point_lin[(k - 1) * beams], 0, beams * sizeof *t->point_lin);
    }
    *row = &t->point_lin[(k - 1) * beams];
    return ASDIC_OK;
}

/* --- a tile of beams -------------------------------------------------------------------------- */

/* Beams that are told together: the device's cells lie beam by beam. */
typedef struct telling {
    asdic_simulator *sim;
    const asdic_ping_shot *shot;
    asdic_ping *out;
    size_t nth, beam, beams; /* from which one on, how many */
    size_t wide;             /* bins of a beam as rays fill them: the margin, too */
    double source_lin, speed_mps;
    double axis_lin[TILE];  /* the beams' gains */
    bool smears;            /* the pulse */
    double *work, *scratch; /* the thread's */
} telling;

static void take_floats(const float *restrict cells, const double *restrict axis_lin, size_t beams,
                        double worth, double *restrict to, size_t stride) {
    for (size_t b = 0; b < beams; b++) {
        to[b * stride] = (double)cells[b] * axis_lin[b] * worth;
    }
}

/* The energies of ROW to ENERGY, [beam][bin], whose bins beyond the row stay as they are: a quantum is worth
 * UNIT times the bin's loss. */
static void gather(const telling *to, size_t row, double unit, double *energy) {
    const asdic_truth_rows *t = &to->sim->truth;
    const dev_sums *sums = &to->shot->ping->sums;
    dev_truth_row r = t->table[to->nth * t->rows + row];
    size_t each = copies(to->sim), before = (size_t)sums->truth_first * each + r.cell;
    for (size_t n = r.low; n < r.high; n++) {
        size_t cell = before + n - r.low;
        double worth = unit * to->shot->loss[n];
        if (to->sim->fan.many) {
            cell += to->beam / DEV_FAN_TILE * sums->truth_cells;
            take_floats((const float *)t->cells + cell * DEV_FAN_TILE + to->beam % DEV_FAN_TILE,
                        to->axis_lin, to->beams, worth, energy + n, to->wide);
            continue;
        }
        const int64_t *from = (const int64_t *)t->cells + cell * t->columns + to->beam;
        for (size_t b = 0; b < to->beams; b++) {
            int64_t quanta = 0;
            for (size_t k = 0; k < each; k++) {
                quanta += from[k * sums->truth_cells * t->columns + b];
            }
            energy[b * to->wide + n] = (double)quanta * to->axis_lin[b] * worth;
        }
    }
}

static void smear(const telling *to, double *energy) {
    for (size_t b = 0; b < to->beams && to->smears; b++) {
        asdic_pulse_smear_row(&to->sim->setup.sonar, to->speed_mps, to->scratch, to->out->bins,
                              to->wide - to->out->bins, energy + b * to->wide);
    }
}

WIDEST static void take_stronger(const double *restrict energy, int16_t number, size_t count,
                                 double *restrict most, int16_t *restrict who) {
    for (size_t n = 0; n < count; n++) {
        bool more = energy[n] > most[n];
        most[n] = more ? energy[n] : most[n];
        who[n] = more ? number : who[n];
    }
}

/* Compares ENERGY of object NUMBER, in the bins of ROW, with MOST, and clears it. */
static void compare(const telling *to, unsigned number, dev_truth_row row, double *energy,
                    double *most) {
    size_t bins = to->out->bins;
    if (to->smears) {
        smear(to, energy);
        row.low = 0;
        row.high = (dev_uint)bins;
    }
    for (size_t b = 0; b < to->beams; b++) {
        size_t at = b * to->wide + row.low, count = row.high - row.low;
        take_stronger(energy + at, (int16_t)number, count, most + at,
                      to->out->truth->object + (to->beam + b) * bins + row.low);
        memset(energy + at, 0, (count + to->wide - bins) * sizeof *energy);
    }
}

/* WEIGHT times what row K of points gives to ENERGY, [beam][bin]. */
static void add_point(const telling *to, size_t k, double weight, double *energy) {
    const asdic_truth_rows *t = &to->sim->truth;
    const double *from = t->point_lin + k * to->out->beams + to->beam;
    for (size_t b = 0; b < to->beams; b++) {
        energy[b * to->wide + t->points[k].bin] += weight * from[b];
    }
}

/* What the point of row K gives directly, in one bin or more, to ENERGY; the next point's first row. */
static size_t gather_point(const telling *to, size_t k, dev_truth_row *row, double *energy) {
    const asdic_truth_rows *t = &to->sim->truth;
    size_t point = t->points[k].point;
    *row = (dev_truth_row){.low = (dev_uint)to->out->bins};
    for (; k < t->point_count && t->points[k].point == point; k++) {
        dev_uint bin = (dev_uint)t->points[k].bin;
        if (t->points[k].by == ASDIC_PATH_DIRECT) {
            add_point(to, k, 1.0, energy);
            row->low = bin < row->low ? bin : row->low;
            row->high = bin < row->high ? row->high : bin + 1;
        }
    }
    return k;
}

/* The strongest object of every bin, and its energy to MOST, which is 0; ENERGY is 0 before and after. */
static void find_objects(const telling *to, double *energy, double *most) {
    const asdic_truth_rows *t = &to->sim->truth;
    const asdic_scene *scene = to->sim->setup.scene;
    size_t bins = to->out->bins;
    double unit = to->source_lin / to->shot->ping->sums.scale[DEV_DEPOSIT_OBJECT];
    int16_t *who = to->out->truth->object + to->beam * bins;
    memset(who, 0, to->beams * bins * sizeof *who);
    for (size_t i = 0; i < scene->part_count; i++) {
        dev_truth_row row = t->table[to->nth * t->rows + DEV_TRUTH_OBJECTS + i];
        if (row.low < row.high) {
            gather(to, DEV_TRUTH_OBJECTS + i, unit, energy);
            compare(to, scene->parts[i].number, row, energy, most);
        }
    }
    for (size_t k = 0; k < t->point_count;) {
        unsigned number = scene->points[t->points[k].point].number;
        dev_truth_row row;
        k = gather_point(to, k, &row, energy);
        if (row.low < row.high) {
            compare(to, number, row, energy, most);
        }
    }
}

WIDEST static void weigh_floats(const float *restrict sums, const double *restrict loss,
                                double unit, size_t bins, double *restrict moment) {
    for (size_t n = 0; n < bins; n++) {
        moment[n] = (double)sums[n] * unit * loss[n];
    }
}

/* What comes from points by way of BY to ENERGY, [beam][bin]. */
static void add_points_by(const telling *to, asdic_path by, double *energy) {
    const asdic_truth_rows *t = &to->sim->truth;
    for (size_t k = 0; k < t->point_count; k++) {
        if (t->points[k].by == by) {
            add_point(to, k, 1.0, energy);
        }
    }
}

/* What asdic_truth_share tells depressions from, to MOMENT, [beam][bin]. */
static void gather_moments(const telling *to, double *moment) {
    const asdic_truth_rows *t = &to->sim->truth;
    const dev_sums *device = &to->shot->ping->sums;
    double scale =
        (double)device->scale[DEV_DEPOSIT_BOTTOM] * device->truth_ratio[DEV_DEPOSIT_BOTTOM];
    const asdic_beam_fan *fan = &to->sim->fan;
    for (size_t b = 0; b < to->beams && fan->many; b++) {
        weigh_floats(
            asdic_beam_fan_row(fan, to->shot->sums, to->beam + b, to->sim->setup.components),
            to->shot->loss, to->source_lin / scale * to->axis_lin[b], to->wide,
            moment + b * to->wide);
    }
    gather(to, DEV_TRUTH_DEPRESSION, to->source_lin / scale, moment);
    for (size_t k = 0; k < t->point_count; k++) {
        add_point(to, k, ASDIC_TRUTH_MIDDLE * (1.0 + t->points[k].down), moment);
    }
    smear(to, moment);
}

/* What a beam of OUT holds of each component. */
static void find_parts(const telling *to, size_t first, asdic_holdings *h) {
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        h->part[c] = to->out->intensity_lin[c] + first;
    }
    for (int c = 0; c < DEV_DEPOSIT_COUNT; c++) {
        bool points = c == DEV_DEPOSIT_OBJECT && to->sim->truth.point_count > 0;
        if (!(to->shot->ping->sums.present & 1u << c) && !points) {
            h->part[asdic_component_of[c]] = h->none;
        }
    }
}

/* Of the work the first tile is 0 before and after, and the last row always. */
static void tell_tile(const telling *to) {
    size_t bins = to->out->bins, wide = to->wide, tile = TILE * wide;
    const asdic_truth_rows *t = &to->sim->truth;
    const asdic_ping_truth *truth = to->out->truth;
    double *most = to->work + tile, *by_surface = most + tile, *by_bottom = by_surface + tile,
           *moment = by_bottom + tile, *none = moment + tile;
    double unit = to->source_lin / to->shot->ping->sums.scale[DEV_DEPOSIT_MULTIPATH];
    bool boundaries = t->table[to->nth * t->rows + DEV_TRUTH_BY_SURFACE].high;
    if (boundaries) {
        gather(to, DEV_TRUTH_BY_SURFACE, unit, by_surface);
        gather(to, DEV_TRUTH_BY_BOTTOM, unit, by_bottom);
        add_points_by(to, ASDIC_PATH_BY_SURFACE, by_surface);
        add_points_by(to, ASDIC_PATH_BY_BOTTOM, by_bottom);
        smear(to, by_surface);
        smear(to, by_bottom);
    }
    memset(most, 0, to->beams * wide * sizeof(double));
    find_objects(to, to->work, most);
    gather_moments(to, moment);
    for (size_t b = 0; b < to->beams; b++) {
        size_t first = (to->beam + b) * bins;
        asdic_holdings h = {.by_surface = boundaries ? by_surface + b * wide : NULL,
                            .by_bottom = by_bottom + b * wide,
                            .most = most + b * wide,
                            .moment = moment + b * wide,
                            .none = none};
        find_parts(to, first, &h);
        asdic_truth_share(&h, bins, truth, first);
    }
}

static bool is_smeared(const asdic_simulator *sim, const asdic_ping_shot *shot) {
    return sim->setup.margin > 0 ||
           asdic_pulse_smears(&sim->setup.sonar, shot->water.sound_speed_mps);
}

/* Tells the beams of OUT, which is what SHOT became, from BEAM on: as many as go together. */
static void tell_beams(asdic_simulator *sim, const asdic_ping_shot *shot, unsigned worker,
                       size_t beam, asdic_ping *out) {
    size_t left = out->beams - beam;
    telling to = {.sim = sim,
                  .shot = shot,
                  .out = out,
                  .nth = (size_t)(shot - sim->shots),
                  .beam = beam,
                  .beams = left < TILE ? left : TILE,
                  .wide = sim->setup.bins,
                  .source_lin = asdic_simulator_source_lin(sim, &shot->water),
                  .speed_mps = shot->water.sound_speed_mps,
                  .work = sim->truth.work + worker * work_of(sim),
                  .scratch = sim->host.scratch + worker * asdic_pulse_scratch(sim->setup.bins)};
    for (size_t b = 0; b < to.beams; b++) {
        to.axis_lin[b] = asdic_beam_axis_lin(&sim->setup.sonar.receivers[beam + b]);
    }
    to.smears = is_smeared(sim, shot);
    tell_tile(&to);
}

/* Whether what bins hold changes after the levels of SHOT. */
static bool is_late(const asdic_simulator *sim, const asdic_ping_shot *shot) {
    return sim->setup.scene->point_count > 0 || is_smeared(sim, shot);
}

void asdic_truth_tell(asdic_simulator *sim, const asdic_ping_shot *shot, unsigned worker,
                      size_t beam, asdic_ping *out) {
    if (sim->truth.asked && out->truth && !is_late(sim, shot)) {
        tell_beams(sim, shot, worker, beam, out);
    }
}

typedef struct late {
    asdic_simulator *sim;
    const asdic_ping_shot *shot;
    asdic_ping *out;
} late;

static void tell_late(void *user, unsigned worker, size_t first, size_t end) {
    const late *l = user;
    (void)end;
    tell_beams(l->sim, l->shot, worker, first, l->out);
}

void asdic_truth_end(asdic_simulator *sim, size_t nth, asdic_ping *out) {
    late l = {sim, &sim->shots[nth], out};
    if (sim->truth.asked && out->truth && is_late(sim, l.shot)) {
        asdic_share(sim->setup.threads, out->beams, TILE, tell_late, &l);
    }
    sim->truth.point_count = 0;
}
