#include "tabulate.h"

#include "base/context.h"
#include "base/grow.h"
#include "base/try.h"
#include "base/vec.h"

#include "../../kernels/law_table.h"

#include <stdlib.h>
#include <string.h>

/* A leaf's error in log2, 4e-4 dB: what is left of 1e-3 dB is for single precision. */
#define TOLERANCE (4e-4 * 0.33219280948873623)
/* Where it is compared, besides its ends and middle. */
#define PROBES 8
/* Less than this, -360 dB, is this. */
#define FLOOR 1e-36
/* Of a function without end of kinks. */
#define LEAVES_MOST 65536u

static float as_float(uint32_t bits) {
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

static uint32_t as_bits(double value) {
    float rounded = (float)value;
    uint32_t bits;
    memcpy(&bits, &rounded, sizeof bits);
    return bits;
}

typedef struct builder {
    asdic_law_function *function;
    const void *of;
    asdic_law_words *out;
    uint32_t leaves;
    size_t first; /* word of the first leaf */
    bool failed;
} builder;

/* LAW_KEYS itself is normal incidence. */
static double log2_at(const builder *b, double key) {
    double sine, cos2;
    if (key >= LAW_KEYS) {
        sine = 1.0;
        cos2 = 0.0;
    } else if (key < LAW_KEY_TURN) {
        uint32_t whole = (uint32_t)key;
        double low = as_float(LAW_SINE_LEAST + whole), high = as_float(LAW_SINE_LEAST + whole + 1u);
        sine = low + (key - whole) * (high - low);
        cos2 = (1.0 - sine) * (1.0 + sine);
    } else {
        uint32_t whole = (uint32_t)(key - LAW_KEY_TURN);
        double low = as_float(LAW_COS2_TURN - whole), high = as_float(LAW_COS2_TURN - whole - 1u);
        cos2 = low + (key - LAW_KEY_TURN - whole) * (high - low);
        sine = sqrt(1.0 - cos2);
    }
    double value = b->function(b->of, sine, cos2);
    return log2(value > FLOOR ? value : FLOOR); /* NAN, too */
}

static void push(asdic_law_words *out, uint32_t word, bool *failed) {
    if (asdic_grow(&out->words, out->count, &out->capacity, sizeof *out->words)) {
        out->words[out->count++] = word;
    } else {
        *failed = true;
    }
}

/* One leaf from key BEGIN to END, or, where it errs, two of half the length. */
static void add_leaves(builder *b, uint32_t begin, uint32_t end) {
    double width = end - begin, y0 = log2_at(b, begin), y1 = log2_at(b, end);
    double middle = log2_at(b, begin + 0.5 * width);
    double c2 = 2.0 * (y0 + y1 - 2.0 * middle) / (width * width);
    double c1 = (y1 - y0) / width - c2 * width, most = 0.0;
    for (int i = 1; i < 2 * PROBES; i++) {
        double d = width * i / (2 * PROBES);
        most = fmax(most, fabs(y0 + d * (c1 + d * c2) - log2_at(b, begin + d)));
    }
    if (most > TOLERANCE && end - begin > 1 && b->leaves < LEAVES_MOST) {
        uint32_t half = begin + (end - begin) / 2;
        add_leaves(b, begin, half);
        add_leaves(b, half, end);
        return;
    }
    push(b->out, begin, &b->failed);
    push(b->out, as_bits(y0), &b->failed);
    push(b->out, as_bits(c1), &b->failed);
    push(b->out, as_bits(c2), &b->failed);
    b->leaves++;
}

/* The key of a grazing angle. */
static uint32_t key_of(double grazing_deg) {
    double sine = sin(grazing_deg * (ASDIC_PI / 180.0)),
           cosine = cos(grazing_deg * (ASDIC_PI / 180.0));
    if (sine < 0.75) {
        uint32_t bits = as_bits(fmax(sine, as_float(LAW_SINE_LEAST)));
        return bits - LAW_SINE_LEAST;
    }
    uint32_t bits = as_bits(fmin(fmax(cosine * cosine, as_float(LAW_COS2_LEAST)), 0.4375));
    return LAW_KEY_TURN + LAW_COS2_TURN - bits;
}

asdic_status asdic_law_table_add(asdic_context *ctx, asdic_law_function *function, const void *of,
                                 const double *knots_deg, size_t count, asdic_law_words *out,
                                 dev_uint *at) {
    builder b = {.function = function, .of = of, .out = out};
    size_t index = out->count, knot = 0;
    for (uint32_t i = 0; i < LAW_LEAVES_AT; i++) {
        push(out, 0, &b.failed);
    }
    for (uint32_t bucket = 0; bucket < LAW_BUCKETS && !b.failed; bucket++) {
        uint32_t begin = bucket << LAW_BUCKET_BITS, end = (bucket + 1u) << LAW_BUCKET_BITS;
        out->words[index + bucket] = b.leaves;
        while (begin < end) {
            while (knot < count && key_of(knots_deg[knot]) <= begin) {
                knot++;
            }
            uint32_t next = knot < count ? key_of(knots_deg[knot]) : end;
            next = next < end ? next : end;
            add_leaves(&b, begin, next);
            begin = next;
        }
    }
    if (b.failed) {
        return asdic_fail_memory(ctx, "the table of a scattering law");
    }
    out->words[index + LAW_BUCKETS] = b.leaves;
    *at = (dev_uint)index;
    return ASDIC_OK;
}

static double strength(const void *of, double sine, double cos2) {
    const asdic_scatterer *s = of;
    asdic_incidence at = asdic_incidence_on_plane(sine, cos2);
    return s->material.law->strength_lin(s, &at);
}

static double reflected(const void *of, double sine, double cos2) {
    const asdic_scatterer *s = of;
    (void)cos2;
    return s->material.law->reflected(s, sine);
}

asdic_status asdic_law_tables_add(asdic_context *ctx, asdic_scatterer *s, asdic_law_words *out) {
    const asdic_law *law = s->material.law;
    size_t count = asdic_scatterer_knots(s);
    if (out->count == 0) { /* no table lies at word 0 */
        bool failed = false;
        push(out, 0, &failed);
        if (failed) {
            return asdic_fail_memory(ctx, "the table of a scattering law");
        }
    }
    double *knots_deg = malloc((count + 1) * sizeof *knots_deg);
    if (!knots_deg) {
        return asdic_fail_memory(ctx, "the angles of a scattering law");
    }
    for (size_t i = 0; i < count; i++) {
        knots_deg[i] = asdic_scatterer_knot_deg(s, i);
    }
    asdic_status status = s->silent ? ASDIC_OK
                                    : asdic_law_table_add(ctx, strength, s, knots_deg, count, out,
                                                          &s->device.strength);
    free(knots_deg);
    TRY(status);
    return law->reflected
               ? asdic_law_table_add(ctx, reflected, s, NULL, 0, out, &s->device.reflected)
               : ASDIC_OK;
}

asdic_status asdic_law_tables(asdic_context *ctx, asdic_scatterer *scatterers, size_t count,
                              asdic_law_words *out) {
    size_t words = sizeof(dev_material) / sizeof(uint32_t);
    bool failed = false;
    for (size_t i = 0; i < count * words; i++) {
        push(out, 0, &failed);
    }
    if (failed) {
        return asdic_fail_memory(ctx, "materials");
    }
    for (size_t i = 0; i < count; i++) {
        const asdic_law *law = scatterers[i].material.law;
        if (law && law->formula == DEV_LAW_TABLE) {
            TRY(asdic_law_tables_add(ctx, &scatterers[i], out));
        }
        memcpy(out->words + i * words, &scatterers[i].device, sizeof(dev_material));
    }
    return ASDIC_OK;
}
