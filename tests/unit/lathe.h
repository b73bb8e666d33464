/* Bodies of facets round an axis. */
#ifndef ASDIC_TESTS_LATHE_H
#define ASDIC_TESTS_LATHE_H

#include "asserts.h"

#include <asdic/asdic.h>

#include <stdlib.h>
#include <string.h>

typedef struct ring {
    double x_m, radius_m;
} ring;

/* COUNT rings of SIDES corners about x, closed by caps. */
static inline asdic_mesh *lathe_mesh(asdic_context *ctx, const ring *rings, uint32_t count,
                                     uint32_t sides) {
    uint32_t ends = count * sides, facets = 0;
    double *v = calloc(3 * (ends + 2), sizeof *v);
    uint32_t *f = malloc(6 * ends * sizeof *f);
    assert_true(v && f);
    for (uint32_t i = 0; i < ends; i++) {
        uint32_t level = i / sides, next = i % sides + 1 < sides ? i + 1 : i + 1 - sides;
        double angle = 2.0 * 3.14159265358979323846 * (i % sides + 0.5) / sides;
        v[3 * i] = rings[level].x_m;
        v[3 * i + 1] = rings[level].radius_m * cos(angle);
        v[3 * i + 2] = rings[level].radius_m * sin(angle);
        if (level == 0 || level + 1 == count) {
            const uint32_t cap[] = {level ? i : next, level ? next : i, ends + (level > 0)};
            memcpy(f + 3 * facets++, cap, sizeof cap);
        }
        if (level + 1 < count) {
            const uint32_t two[] = {i, next, next + sides, i, next + sides, i + sides};
            memcpy(f + 3 * facets, two, sizeof two);
            facets += 2;
        }
    }
    v[3 * ends] = rings[0].x_m;
    v[3 * ends + 3] = rings[count - 1].x_m;
    asdic_mesh *mesh;
    assert_ok(ctx, asdic_mesh_from_triangles(ctx, v, ends + 2, f, facets, &mesh));
    free(v);
    free(f);
    return mesh;
}

#endif
