#include "coherence.h"

#include "base/context.h"
#include "base/grow.h"
#include "ring.h"

#include <stdlib.h>
#include <string.h>

/* A direction in which a receiver hears less than this, relative to its loudest direction, is left out. */
#define FAINT 0.02
/* A receiver takes its loudest directions up to this many. One that the transmitter's main lobe does not
 * reach may hear more. */
#define MOST_TAPS 2048
/* Directions are merged where the cosine between what the receivers hear of them is above this. */
#define ALIKE 0.97
/* One-way amplitude of the transmitter below which there is ambient noise instead. */
#define NOISE_FLOOR 1e-3

/* Directions: azimuths times elevations in the transmitter's frame, sines and cosines in steps
 * of half a cell, from -pi and from -pi/2. */
typedef struct grid {
    asdic_face transmitter;
    double across, up; /* extents of a receiver's and the transmitter's apertures, wavelengths */
    size_t azimuths, elevations;
    double *cos_az, *sin_az, *cos_el, *sin_el;
} grid;

/* Part of a grid; each end is one past the last. */
typedef struct block {
    size_t az, az_end, el, el_end;
} block;

/* A direction that a receiver hears. */
typedef struct tap {
    uint64_t direction;
    uint32_t receiver;
    float weight;
} tap;

typedef struct search {
    const grid *g;
    const asdic_face *face; /* of the receiver that is searched for */
    uint32_t receiver;
    double least;
    tap *taps;
    size_t first, count, capacity; /* of TAPS; the receiver's begin at FIRST */
    bool failed;
} search;

static double sinc_of(double x) {
    return fabs(x) < 1e-9 ? 1.0 : sin(ASDIC_PI * x) / (ASDIC_PI * x);
}

/* No less than |sinc| within SLACK of X. */
static double hull(double x, double slack) {
    return 1.0 / fmax(ASDIC_PI * (fabs(x) - slack), 1.0);
}

static asdic_vec3 axis_of(const asdic_face *face) {
    const double *row = face->world_to_face.m[0];
    return (asdic_vec3){row[0], row[1], row[2]};
}

/* FACE in the frame of VIEWER. */
static asdic_face seen_from(const asdic_face *viewer, asdic_face face) {
    asdic_mat3 back;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            back.m[i][k] = viewer->world_to_face.m[k][i];
        }
    }
    face.world_to_face = asdic_mat3_multiply(face.world_to_face, back);
    return face;
}

static double amplitude_of(const asdic_face *face, asdic_vec3 direction) {
    asdic_vec3 v = asdic_mat3_apply(face->world_to_face, direction);
    return v.x > 0.0 ? sinc_of(face->length_h_wl * v.y) * sinc_of(face->length_v_wl * v.z) : 0.0;
}

/* No less than the amplitude of FACE within RADIUS of a direction. */
static double most_of(const asdic_face *face, asdic_vec3 direction, double radius) {
    asdic_vec3 v = asdic_mat3_apply(face->world_to_face, direction);
    double h = hull(face->length_h_wl * v.y, face->length_h_wl * radius);
    return v.x + radius > 0.0 ? h * hull(face->length_v_wl * v.z, face->length_v_wl * radius) : 0.0;
}

static bool is_full(const search *s) {
    return s->failed || s->count - s->first > MOST_TAPS;
}

static void add(search *s, uint64_t direction, double weight) {
    if (asdic_grow(&s->taps, s->count, &s->capacity, sizeof *s->taps)) {
        s->taps[s->count++] = (tap){direction, s->receiver, (float)weight};
    } else {
        s->failed = true;
    }
}

/* Adds the directions of a block; a large block is divided, and only the parts that matter are taken. */
static void visit(search *s, block b) {
    const grid *g = s->g;
    size_t az = b.az + b.az_end, el = b.el + b.el_end; /* its middle, in half cells */
    double half_az = ASDIC_PI * (double)(b.az_end - b.az) / (double)g->azimuths;
    double half_el = 0.5 * ASDIC_PI * (double)(b.el_end - b.el) / (double)g->elevations;
    double wide = half_az * fmin(g->cos_el[el] + half_el, 1.0);
    asdic_vec3 middle = {g->cos_el[el] * g->cos_az[az], g->cos_el[el] * g->sin_az[az],
                         g->sin_el[el]};
    if (b.az_end - b.az == 1 && b.el_end - b.el == 1) {
        double sent = hypot(amplitude_of(&g->transmitter, middle), NOISE_FLOOR);
        double amplitude = sent * amplitude_of(s->face, middle);
        if (fabs(amplitude) >= s->least) {
            add(s, (uint64_t)b.az * g->elevations + b.el, amplitude * sqrt(g->cos_el[el]));
        }
        return;
    }
    double most = fmax(most_of(&g->transmitter, middle, wide + half_el), NOISE_FLOOR) *
                  most_of(s->face, middle, wide + half_el);
    if (most < s->least || is_full(s)) {
        return;
    }
    block first = b, second = b;
    if (b.el_end - b.el == 1 || (b.az_end - b.az > 1 && wide > half_el)) {
        first.az_end = second.az = (b.az + b.az_end) / 2;
    } else {
        first.el_end = second.el = (b.el + b.el_end) / 2;
    }
    visit(s, first);
    visit(s, second);
}

/* Extent of an aperture along the unit vector AXIS, wavelengths. */
static double extent(const asdic_face *face, asdic_vec3 axis) {
    asdic_vec3 v = asdic_mat3_apply(face->world_to_face, axis);
    return face->length_h_wl * fabs(v.y) + face->length_v_wl * fabs(v.z);
}

/* A sum in equal steps is exact for what turns less than once a step: of a_i a_j W, once per
 * extent of receiver and transmitter together. */
static bool lay(grid *g, const asdic_face *faces, size_t count) {
    for (size_t i = 0; i < count; i++) {
        asdic_vec3 axis = axis_of(&faces[i]);
        double level = fmax(hypot(axis.x, axis.y), 1e-9);
        asdic_vec3 side = {-axis.y / level, axis.x / level, 0.0};
        asdic_vec3 top = asdic_vec3_cross(axis, side);
        g->across = fmax(g->across, extent(&faces[i], side) + extent(&g->transmitter, side));
        g->up = fmax(g->up, extent(&faces[i], top) + extent(&g->transmitter, top));
    }
    g->azimuths = (size_t)(2.0 * ASDIC_PI * fmax(g->across, 8.0)) + 4;
    g->elevations = (size_t)(ASDIC_PI * fmax(g->up, 8.0)) + 4;
    size_t az_steps = 2 * g->azimuths + 1, el_steps = 2 * g->elevations + 1;
    g->cos_az = malloc(2 * (az_steps + el_steps) * sizeof *g->cos_az);
    if (!g->cos_az) {
        return false;
    }
    g->sin_az = g->cos_az + az_steps;
    g->cos_el = g->sin_az + az_steps;
    g->sin_el = g->cos_el + el_steps;
    for (size_t k = 0; k < az_steps; k++) {
        double azimuth = ASDIC_PI * ((double)k / (double)g->azimuths - 1.0);
        g->cos_az[k] = cos(azimuth);
        g->sin_az[k] = sin(azimuth);
    }
    for (size_t k = 0; k < el_steps; k++) {
        double elevation = 0.5 * ASDIC_PI * ((double)k / (double)g->elevations - 1.0);
        g->cos_el[k] = cos(elevation);
        g->sin_el[k] = sin(elevation);
    }
    return true;
}

/* Adds what RECEIVER hears. */
static void listen(search *s, const asdic_face *face, size_t receiver) {
    const grid *g = s->g;
    double loud = fmax(fmax(most_of(&g->transmitter, axis_of(face), 0.0), NOISE_FLOOR),
                       most_of(face, axis_of(&g->transmitter), 0.0));
    double sum = 0.0;
    s->face = face;
    s->receiver = (uint32_t)receiver;
    s->first = s->count;
    for (double share = FAINT; share < 1.0; share *= 2.0) {
        s->count = s->first;
        s->least = share * loud;
        visit(s, (block){0, g->azimuths, 0, g->elevations});
        if (!is_full(s)) {
            break;
        }
    }
    for (size_t k = s->first; k < s->count; k++) {
        sum += (double)s->taps[k].weight * (double)s->taps[k].weight;
    }
    for (size_t k = s->first; k < s->count; k++) {
        s->taps[k].weight = (float)((double)s->taps[k].weight / sqrt(sum));
    }
}

static int by_direction(const void *a, const void *b) {
    const tap *x = a, *y = b;
    if (x->direction != y->direction) {
        return x->direction < y->direction ? -1 : 1;
    }
    return x->receiver < y->receiver ? -1 : x->receiver > y->receiver;
}

static int by_receiver(const void *a, const void *b) {
    const tap *x = a, *y = b;
    if (x->receiver != y->receiver) {
        return x->receiver < y->receiver ? -1 : 1;
    }
    return x->direction < y->direction ? -1 : x->direction > y->direction;
}

/* Merges directions above each other that all receivers hear alike, as those of a fan do: where the cosine
 * between what they hear is above ALIKE. Variances add. Returns how many taps are left. POSITION is scratch,
 * one number a receiver: where its tap of the current direction is. */
static size_t gather(tap *taps, size_t count, size_t elevations, size_t *position) {
    size_t at = 0, kept = 0; /* the current direction's taps are from AT to KEPT */
    double square = 0.0;
    for (size_t k = 0, end; k < count; k = end) {
        double product = 0.0, own = 0.0;
        for (end = k; end < count && taps[end].direction == taps[k].direction; end++) {
            size_t p = position[taps[end].receiver];
            double w = (double)taps[end].weight;
            product += p >= at && p < kept ? w * (double)taps[p].weight : 0.0;
            own += w * w;
        }
        bool is_above =
            kept > at && taps[at].direction / elevations == taps[k].direction / elevations;
        bool is_alike = is_above && fabs(product) > ALIKE * sqrt(square * own);
        at = is_alike ? at : kept;
        square = is_alike ? square + own : own;
        for (size_t i = k; i < end; i++) {
            tap t = taps[i];
            size_t p = position[t.receiver];
            if (is_alike && p >= at && p < kept) {
                taps[p].weight = copysignf(hypotf(taps[p].weight, t.weight), taps[p].weight);
                continue;
            }
            t.direction = is_alike ? taps[at].direction : t.direction;
            t.weight = product < 0.0 && is_alike ? -t.weight : t.weight;
            position[t.receiver] = kept;
            taps[kept++] = t;
        }
    }
    return kept;
}

/* Numbers the directions, which are in order, as sources; ALONE marks one that a single receiver hears.
 * Returns how many there are. */
#define ALONE UINT64_MAX
static size_t number(tap *taps, size_t count) {
    size_t sources = 0;
    for (size_t k = 0, end; k < count; k = end) {
        for (end = k + 1; end < count && taps[end].direction == taps[k].direction;) {
            end++;
        }
        for (size_t i = k; i < end; i++) {
            taps[i].direction = end - k > 1 ? sources : ALONE;
        }
        sources += end - k > 1;
    }
    return sources;
}

/* Writes each receiver's taps as a list. What it hears alone is one source, the last of the list. */
static bool list(asdic_coherence *c, tap *taps, size_t count, size_t elevations) {
    size_t room = count + c->receivers, at = 0, k = 0;
    size_t *position = malloc(c->receivers * sizeof *position);
    c->first = calloc(c->receivers + 1, sizeof *c->first);
    c->source = malloc(room * sizeof *c->source);
    c->weight = malloc(room * sizeof *c->weight);
    if (!position || !c->first || !c->source || !c->weight) {
        free(position);
        return false;
    }
    memset(position, 0xff, c->receivers * sizeof *position); /* nowhere */
    qsort(taps, count, sizeof *taps, by_direction);
    count = gather(taps, count, elevations, position);
    c->sources = number(taps, count);
    qsort(taps, count, sizeof *taps, by_receiver);
    free(position);
    for (size_t i = 0; i < c->receivers; i++) {
        double left = 1.0;
        for (; k < count && taps[k].receiver == i; k++) {
            if (taps[k].direction != ALONE) {
                c->source[at] = (uint32_t)taps[k].direction;
                c->weight[at++] = taps[k].weight;
                left -= (double)taps[k].weight * (double)taps[k].weight;
            }
        }
        if (left > 1e-6) {
            c->source[at] = (uint32_t)c->sources++;
            c->weight[at++] = (float)sqrt(left);
        }
        c->first[i + 1] = at;
    }
    return true;
}

asdic_status asdic_coherence_init(asdic_coherence *c, asdic_context *ctx, const asdic_sonar *sonar,
                                  double wavelength_m) {
    size_t count = sonar->receiver_count;
    const asdic_pose pose = {0};
    asdic_face sent = asdic_face_aim(&sonar->transmitter, &pose, wavelength_m);
    asdic_face *faces = calloc(count, sizeof *faces);
    grid g = {.transmitter = sent};
    search s = {.g = &g};
    *c = (asdic_coherence){.receivers = count};
    for (size_t i = 0; faces && i < count; i++) {
        faces[i] = seen_from(&sent, asdic_face_aim(&sonar->receivers[i], &pose, wavelength_m));
    }
    g.transmitter = seen_from(&sent, sent);
    bool good = faces && lay(&g, faces, count);
    for (size_t i = 0; good && i < count && !s.failed; i++) {
        listen(&s, &faces[i], i);
    }
    good = good && !s.failed && list(c, s.taps, s.count, g.elevations);
    free(faces);
    free(g.cos_az);
    free(s.taps);
    if (!good) {
        asdic_coherence_finish(c);
        return asdic_fail_memory(ctx, "what receivers have in common");
    }
    return ASDIC_OK;
}

void asdic_coherence_finish(asdic_coherence *c) {
    free(c->first);
    free(c->source);
    free(c->weight);
    *c = (asdic_coherence){0};
}
