#include "aim.h"

#include "ring.h"

#include <string.h>

/* Scale of the heavy-tailed densities, in wavelengths per aperture: close to the half-power
 * half-width of a two-way pattern, 0.32 lambda / L. */
#define LOBE_WIDTH 0.3
/* Share of the beam sampler's rays that ignores the beams, so that side lobes are never starved. The
 * adaptive sampler's tails cover all azimuths in front by themselves; measured on the paper's
 * first scenario, a share of 0.1 costs it a factor of two in error. */
#define WIDE_SHARE 0.1
/* Sine of the slope from which a beam's second ridge gets lobes. */
#define STEEP 0.5
/* A ridge farther in azimuth from the transmitter's axis looks aside. Of two such that are taken for one, the
 * cosine between their axes is at least SAME_AXIS. */
#define ASIDE_RAD (ASDIC_PI / 3.0)
#define SAME_AXIS 0.9998
/* A transmitter with a lobe narrower than this that looks beyond the sector gets a lobe of its own.
 * A wide one sends into the sector as well: a second lobe would only thin the sector's lattice. */
#define NARROW_RAD 0.1
/* How far a sector's lobe reaches beyond the outermost beams, in wavelengths per aperture: past their first
 * two nulls and side lobes. */
#define SECTOR_MARGIN 2.5
/* Rays, next to each other in elevation, that a footprint in range spans. */
#define FOOTPRINT_RAYS 4.0

dev_beam asdic_aim_beam(const asdic_beam *beam, const asdic_pose *pose, double wavelength_m) {
    asdic_face face = asdic_face_aim(beam, pose, wavelength_m);
    dev_beam out = {.length_h_wl = (float)face.length_h_wl, .length_v_wl = (float)face.length_v_wl};
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 3; column++) {
            out.rows[3 * row + column] = (float)face.world_to_face.m[row][column];
        }
    }
    return out;
}

void asdic_aim_side(const dev_beam *beam, bool vertical, float side[3]) {
    double length_wl = vertical ? beam->length_v_wl : beam->length_h_wl;
    for (int i = 0; i < 3; i++) {
        side[i] = (float)(ASDIC_PI * length_wl * beam->rows[(vertical ? 6 : 3) + i]);
    }
}

static double wrap(double phi) {
    return phi - 2.0 * ASDIC_PI * floor(phi / (2.0 * ASDIC_PI) + 0.5);
}

/* A lobe without preference: all directions in front of the transmitter, or all directions. */
static dev_lobe wide_lobe(const dev_beam *transmitter, bool rear) {
    dev_lobe lobe = {.scale_h = DEV_EVEN_SCALE, .scale_v = DEV_EVEN_SCALE};
    memcpy(lobe.rows, transmitter->rows, sizeof lobe.rows);
    lobe.beta_rad = (float)(atan2(transmitter->rows[1], transmitter->rows[0]) - ASDIC_PI / 2.0);
    lobe.side = 1.0f;
    lobe.limit_rad = (float)(rear ? ASDIC_PI : ASDIC_PI / 2.0);
    return lobe;
}

static dev_lobe beam_lobe(const dev_beam *beam) {
    dev_lobe lobe = {.scale_h = (float)(LOBE_WIDTH / beam->length_h_wl),
                     .scale_v = (float)(LOBE_WIDTH / beam->length_v_wl),
                     .limit_rad = (float)(ASDIC_PI / 2.0)};
    memcpy(lobe.rows, beam->rows, sizeof lobe.rows);
    return lobe;
}

/* Azimuth ridge of a beam: where the direction cosine along its horizontal (ACROSS false) or
 * vertical side is zero, and with it that side's pattern 1. */
static dev_lobe ridge_lobe(const dev_beam *beam, bool across) {
    const float *row = beam->rows + (across ? 6 : 3);
    double horizontal = hypot(row[0], row[1]);
    double length_wl = across ? beam->length_v_wl : beam->length_h_wl;
    dev_lobe lobe = {.limit_rad = -1.0f};
    memcpy(lobe.rows, beam->rows, sizeof lobe.rows);
    asdic_aim_side(beam, !across, lobe.along);
    lobe.scale_h = (float)(LOBE_WIDTH / fmax(horizontal * length_wl, 1e-3));
    lobe.beta_rad = (float)atan2(row[1], row[0]);
    lobe.tilt = (float)(row[2] / fmax(horizontal, 1e-6));
    double heading = atan2(beam->rows[1], beam->rows[0]);
    double plus = fabs(wrap(lobe.beta_rad + ASDIC_PI / 2.0 - heading));
    lobe.side = plus <= ASDIC_PI / 2.0 ? 1.0f : -1.0f;
    return lobe;
}

static double along(const float *a, const float *b) {
    return (double)a[0] * b[0] + (double)a[1] * b[1] + (double)a[2] * b[2];
}

/* Whether two lobes look the same way with much the same width: then one is enough. Of lobes that look aside
 * the edges of both fronts matter, and so where their apertures' axes point. */
static bool same_lobe(asdic_sampler sampler, const dev_lobe *a, const dev_lobe *b) {
    double width = fmin(a->scale_h, b->scale_h), ratio = a->scale_h / b->scale_h;
    if (ratio > 1.5 || ratio < 1.0 / 1.5) {
        return false;
    }
    if (sampler == ASDIC_SAMPLER_BEAM) {
        double heights = a->scale_v / b->scale_v;
        double dx = a->rows[0] - b->rows[0], dy = a->rows[1] - b->rows[1],
               dz = a->rows[2] - b->rows[2];
        double dr = fabs(a->rows[3] - b->rows[3]) + fabs(a->rows[5] - b->rows[5]);
        width = fmin(width, fmin(a->scale_v, b->scale_v));
        return heights < 1.5 && heights > 1.0 / 1.5 && sqrt(dx * dx + dy * dy + dz * dz) < width &&
               dr < 0.1;
    }
    return fabs(wrap(a->beta_rad - b->beta_rad)) < width && fabs(a->tilt - b->tilt) < width &&
           a->side == b->side && (!b->aside || along(a->rows, b->rows) > SAME_AXIS);
}

/* Where a ridge crosses the horizontal. */
static double azimuth_of(const dev_lobe *ridge) {
    return ridge->beta_rad + ridge->side * ASDIC_PI / 2.0;
}

static void add_lobe(asdic_sampler sampler, dev_lobe lobe, dev_lobe *lobes, unsigned *count) {
    if (*count > 0) { /* the first is the transmitter's */
        double ahead = atan2(lobes[0].rows[1], lobes[0].rows[0]);
        lobe.aside = fabs(wrap(azimuth_of(&lobe) - ahead)) > ASIDE_RAD;
    }
    for (unsigned j = 0; j < *count; j++) {
        if (same_lobe(sampler, &lobes[j], &lobe)) {
            return;
        }
    }
    if (*count < DEV_MAX_LOBES) {
        lobes[(*count)++] = lobe;
    }
}

/* How long a beam's horizontal or vertical side is along azimuths, in wavelengths. */
static double along_azimuth(const dev_beam *beam, bool vertical) {
    const float *row = beam->rows + (vertical ? 6 : 3);
    return hypot(row[0], row[1]) * (vertical ? beam->length_v_wl : beam->length_h_wl);
}

/* The ridge of the side that is longer, and so narrower, in azimuth: it leads the way. */
static dev_lobe leading_ridge(const dev_beam *beam) {
    return ridge_lobe(beam, along_azimuth(beam, true) > along_azimuth(beam, false));
}

static void add_beam(asdic_sampler sampler, const dev_beam *beam, dev_lobe *lobes,
                     unsigned *count) {
    if (sampler == ASDIC_SAMPLER_BEAM) {
        add_lobe(sampler, beam_lobe(beam), lobes, count);
        return;
    }
    add_lobe(sampler, leading_ridge(beam), lobes, count);
    /* A rolled or steep beam has its other ridge in reach too. */
    double along_h = along_azimuth(beam, false), along_v = along_azimuth(beam, true);
    if (fmin(along_h, along_v) > STEEP * fmax(along_h, along_v)) {
        add_lobe(sampler, ridge_lobe(beam, along_v <= along_h), lobes, count);
    }
}

static double heading_of(const dev_beam *beam) {
    return atan2(beam->rows[1], beam->rows[0]);
}

/* Many receivers, beam sampler: lobes at evenly picked ones, wide enough to overlap. */
static void add_picked(const dev_beam *receivers, size_t receiver_count, dev_lobe *lobes,
                       unsigned *count) {
    double first = heading_of(&receivers[0]);
    double widest = 0.0;
    for (size_t r = 1; r < receiver_count; r++) {
        widest = fmax(widest, fabs(wrap(heading_of(&receivers[r]) - first)));
    }
    for (size_t a = 0; a < ASDIC_AIMS_MOST; a++) {
        dev_lobe lobe = beam_lobe(&receivers[a * (receiver_count - 1) / (ASDIC_AIMS_MOST - 1)]);
        lobe.scale_h = (float)fmax(lobe.scale_h, widest / ASDIC_AIMS_MOST);
        lobes[(*count)++] = lobe;
    }
}

/* Many receivers, adaptive sampler: even over the sector that they span, which keeps the lattice in
 * one piece unless the transmitter looks elsewhere. */
static void add_sector(const dev_beam *transmitter, const dev_beam *receivers,
                       size_t receiver_count, dev_lobe *lobes, unsigned *count) {
    dev_lobe ridge = ridge_lobe(&receivers[0], false), lobe = ridge;
    double at = 0.0, least = 0.0, most = 0.0, scale = ridge.scale_h, first = azimuth_of(&ridge);
    lobe.most_tilt = ridge.tilt;
    for (size_t r = 1; r < receiver_count; r++) {
        double before = azimuth_of(&ridge);
        ridge = ridge_lobe(&receivers[r], false);
        at += wrap(azimuth_of(&ridge) - before);
        scale = fmax(scale, ridge.scale_h);
        if (at < least) {
            least = at;
            lobe.tilt = ridge.tilt;
        }
        if (at > most) {
            most = at;
            lobe.most_tilt = ridge.tilt;
        }
    }
    lobe.beta_rad = (float)(first + 0.5 * (least + most) - lobe.side * ASDIC_PI / 2.0);
    lobe.margin_rad = (float)(SECTOR_MARGIN / LOBE_WIDTH * scale);
    lobe.scale_h = DEV_EVEN_SCALE;
    lobe.limit_rad = (float)fmin(0.5 * (most - least), ASDIC_PI);
    lobes[(*count)++] = lobe;
    dev_lobe sender = leading_ridge(transmitter);
    double off = fabs(wrap(azimuth_of(&sender) - azimuth_of(&lobe)));
    if (sender.scale_h < NARROW_RAD && off > lobe.limit_rad) {
        lobes[(*count)++] = sender;
    }
}

/* Lobes of the transmitter and all receivers that look different ways. False: too many of them. */
static bool add_each(asdic_sampler sampler, const dev_beam *beams, size_t receiver_count,
                     dev_lobe *lobes, unsigned *count) {
    for (size_t b = 0; b <= receiver_count; b++) {
        add_beam(sampler, &beams[b], lobes, count);
        if (receiver_count > ASDIC_AIMS_MOST && *count > ASDIC_AIMS_MOST) {
            *count = 0;
            return false;
        }
    }
    *count = *count > DEV_MAX_LOBES - 1 ? DEV_MAX_LOBES - 1 : *count;
    return true;
}

unsigned asdic_aim_lobes(asdic_sampler sampler, const dev_beam *beams, size_t receiver_count,
                         bool rear, dev_lobe *lobes) {
    unsigned count = 0;
    bool each = add_each(sampler, beams, receiver_count, lobes, &count);
    if (!each && sampler == ASDIC_SAMPLER_ADAPTIVE) {
        add_sector(beams, beams + 1, receiver_count, lobes, &count);
    } else if (!each) {
        add_picked(beams + 1, receiver_count, lobes, &count);
    }
    double wide = sampler == ASDIC_SAMPLER_BEAM || rear ? WIDE_SHARE : 0.0;
    for (unsigned j = 0; j < count; j++) {
        lobes[j].share = (float)((1.0 - wide) / count);
    }
    if (wide > 0.0) {
        lobes[count] = wide_lobe(&beams[0], rear);
        lobes[count++].share = (float)wide;
    }
    float begin = 0.0f;
    for (unsigned j = 0; j < count; j++) {
        lobes[j].share_begin = begin;
        begin += lobes[j].share;
    }
    return count;
}

static double envelope(const dev_beam *beam, asdic_vec3 u) {
    const float *y = beam->rows + 3, *z = beam->rows + 6;
    double h = ASDIC_PI * beam->length_h_wl * (y[0] * u.x + y[1] * u.y + y[2] * u.z);
    double v = ASDIC_PI * beam->length_v_wl * (z[0] * u.x + z[1] * u.y + z[2] * u.z);
    return 1.0 / ((1.0 + h * h) * (1.0 + v * v));
}

double asdic_aim_envelope(const dev_beam *beams, size_t receiver_count, asdic_vec3 towards) {
    double best = 0.0;
    for (size_t b = 1; b <= receiver_count; b++) {
        best = fmax(best, envelope(&beams[b], towards));
    }
    return envelope(&beams[0], towards) * best;
}

double asdic_aim_footprint_rays(const dev_lobe *lobe) {
    double widths = 2.0 * SECTOR_MARGIN * (lobe->limit_rad + lobe->margin_rad) / lobe->margin_rad;
    return lobe->margin_rad > 0.0f ? fmax(widths, FOOTPRINT_RAYS) : FOOTPRINT_RAYS;
}
