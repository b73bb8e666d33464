#include "surface.h"

#include "base/context.h"
#include "base/try.h"
#include "base/vec.h"

#include "bend.h"
#include "patch.h"

#include <stdlib.h>
#include <string.h>

/* A surface that bends this much more one way than the other is straight the other way: an ellipsoid fourteen times as
 * long as thick is not yet. */
#define STRAIGHT 5e-3
/* One facet tells its smaller curvature badly beside a much larger one: then it is the mean of all around. Beside
 * straight facets, slender ones are straight as well: those at a pipe's ends have few around. */
#define SLENDER 0.1
/* Straight the same way: within five degrees. */
#define PARALLEL 0.996
/* Corners of one surface have one normal. */
#define SAME_NORMAL (1.0 - 1e-12)

typedef struct straights {
    asdic_surface *surface;
    const asdic_vec3 *normals;
    asdic_bend *bends;
    double *areas_m2;
    asdic_vec3 *axes; /* along which a facet is slender; 0: none, or measured */
    uint32_t *queue;
} straights;

static bool is_flat(const asdic_surface *s, uint32_t facet) {
    return s->facets[facet].corner_normals[0] == DEV_FLAT;
}

/* Whether the facets that have corners A and B at one vertex are of one surface there. */
static bool go_on(const straights *s, uint32_t a, uint32_t b) {
    return !is_flat(s->surface, b / 3) &&
           asdic_vec3_dot(s->normals[a], s->normals[b]) > SAME_NORMAL;
}

/* The bend of FACET and all around that go on from it. */
static asdic_bend mean_bend(const straights *s, uint32_t facet) {
    const asdic_surface *surface = s->surface;
    asdic_bend sum = {.u = s->bends[facet].u, .v = s->bends[facet].v};
    double area_m2 = 0.0;
    for (uint32_t corner = 3 * facet; corner < 3 * facet + 3; corner++) {
        asdic_corners around = asdic_surface_around(surface, surface->vertex[corner]);
        for (uint32_t i = 0; i < around.count; i++) {
            uint32_t at = around.at[i];
            if (go_on(s, corner, at)) {
                double weight = s->areas_m2[at / 3];
                asdic_bend_add(&sum, weight, &s->bends[at / 3]);
                area_m2 += weight;
            }
        }
    }
    for (int k = 0; k < 3 && area_m2 > 0.0; k++) {
        sum.x[k] /= area_m2;
    }
    return sum;
}

/* Radius of FACET, and the way in which it is straight or slender. */
static void find_radius(straights *s, uint32_t facet) {
    asdic_principal p = asdic_bend_principal(&s->bends[facet]);
    if (p.least < SLENDER * p.most) {
        asdic_bend mean = mean_bend(s, facet);
        p = asdic_bend_principal(&mean);
    }
    bool straight = p.least <= STRAIGHT * p.most;
    s->surface->facets[facet].radius_m = straight ? 0.0f : (float)(1.0 / p.least);
    if (p.least < SLENDER * p.most) {
        s->axes[facet] = p.straightest;
    }
}

/* The length, squared, of what goes on straight from SEED; a strip's variance along its length L is L^2 / 12. */
static void measure(straights *s, uint32_t seed) {
    const asdic_surface *surface = s->surface;
    asdic_vec3 axis = s->axes[seed], origin = asdic_surface_corner(surface, 3 * (size_t)seed);
    size_t head = 0, tail = 0;
    double area = 0.0, first = 0.0, second = 0.0;
    s->queue[tail++] = seed;
    s->axes[seed] = (asdic_vec3){0.0, 0.0, 0.0};
    while (head < tail) {
        uint32_t facet = s->queue[head++];
        double x[3], weight = s->areas_m2[facet];
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t corner = 3 * facet + k;
            asdic_corners around = asdic_surface_around(surface, surface->vertex[corner]);
            x[k] =
                asdic_vec3_dot(axis, asdic_vec3_sub(asdic_surface_corner(surface, corner), origin));
            for (uint32_t i = 0; i < around.count; i++) {
                uint32_t at = around.at[i], other = at / 3;
                if (fabs(asdic_vec3_dot(axis, s->axes[other])) > PARALLEL && go_on(s, corner, at)) {
                    s->axes[other] = (asdic_vec3){0.0, 0.0, 0.0};
                    s->queue[tail++] = other;
                }
            }
        }
        double sum = x[0] + x[1] + x[2];
        area += weight;
        first += weight * sum / 3.0;
        second += weight * (x[0] * x[0] + x[1] * x[1] + x[2] * x[2] + sum * sum) / 12.0;
    }
    double mean = area > 0.0 ? first / area : 0.0;
    double length2 = area > 0.0 ? 12.0 * (second / area - mean * mean) : 0.0;
    for (size_t i = 0; i < tail; i++) {
        uint32_t facet = s->queue[i];
        dev_triangle *t = &surface->facets[facet];
        double own = asdic_patch_width(&surface->patches[surface->patch[facet]], axis);
        t->flat_m2 = (float)fmax(own * own, length2);
        t->radius_m = 0.0f;
    }
}

asdic_status asdic_surface_find_straight(asdic_context *ctx, asdic_surface *surface,
                                         const asdic_vec3 *normals) {
    size_t count = surface->count;
    straights s = {.surface = surface,
                   .normals = normals,
                   .bends = malloc(count * sizeof *s.bends),
                   .areas_m2 = malloc(count * sizeof *s.areas_m2),
                   .axes = calloc(count, sizeof *s.axes),
                   .queue = malloc(count * sizeof *s.queue)};
    bool has_room = s.bends && s.areas_m2 && s.axes && s.queue;
    for (uint32_t facet = 0; has_room && facet < count; facet++) {
        if (!is_flat(surface, facet)) {
            s.bends[facet] = asdic_bend_of(surface, facet, normals + 3 * (size_t)facet);
            s.areas_m2[facet] = asdic_surface_area(surface, facet);
        }
    }
    for (uint32_t facet = 0; has_room && facet < count; facet++) {
        if (!is_flat(surface, facet)) {
            find_radius(&s, facet);
        }
    }
    for (uint32_t facet = 0; has_room && facet < count; facet++) {
        if (surface->facets[facet].radius_m == 0.0f &&
            asdic_vec3_dot(s.axes[facet], s.axes[facet]) > 0.0) {
            measure(&s, facet);
        }
    }
    free(s.bends);
    free(s.areas_m2);
    free(s.axes);
    free(s.queue);
    return has_room ? ASDIC_OK : asdic_fail_memory(ctx, "the curvature of an object");
}
