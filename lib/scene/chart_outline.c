/*
 * Objects from above. A mesh may hold many things (boulders): the cells that its triangles touch
 * are marked, and each connected group of cells gets a ring of the places that lie farthest in
 * each of a few directions. A group that bends (a pipeline, a net cage's ring) is halved first,
 * until its parts fill their rings.
 */
#include "chart.h"
#include "scene.h"

#include "base/context.h"
#include "base/grow.h"
#include "base/vec.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Cells along the longer side of an object; fewer when it has many triangles to mark them. */
#define CELLS 128
#define COARSE_CELLS 48
#define MANY_TRIANGLES 100000u
/* A group whose ring is larger than this many times its cells is halved. */
#define MOST_HOLLOW 1.25

typedef struct piece {
    double reach[ASDIC_OUTLINE_SIDES]; /* farthest in each direction so far */
    double at[ASDIC_OUTLINE_SIDES][2]; /* the place that does: north, east */
} piece;

typedef struct charter {
    asdic_context *ctx;
    const asdic_scene *scene;
    const uint32_t *order; /* triangles of the current part */
    size_t order_count;
    double low[2], cell_m; /* north, east */
    size_t cells;
    double unit[ASDIC_OUTLINE_SIDES][2]; /* the directions of rings */
    int32_t label[CELLS * CELLS];        /* -1 empty, 0 marked, else piece number + 1 */
    uint32_t stack[CELLS * CELLS];
    asdic_outline *outlines;
    size_t count, capacity;
} charter;

static void corner_of(const charter *c, uint32_t triangle, int corner, double at[2]) {
    const dev_triangle *t = &c->scene->triangles[triangle];
    const float *v = corner == 0 ? t->v0 : corner == 1 ? t->v1 : t->v2;
    at[0] = c->scene->origin_m.x + (double)v[0];
    at[1] = c->scene->origin_m.y + (double)v[1];
}

static size_t cell_of(const charter *c, int axis, double at) {
    double cell = floor((at - c->low[axis]) / c->cell_m);
    return cell < 0.0 ? 0 : cell >= (double)c->cells ? c->cells - 1 : (size_t)cell;
}

static void lay_grid(charter *c) {
    double high[2] = {-INFINITY, -INFINITY}, at[2];
    c->low[0] = c->low[1] = INFINITY;
    for (size_t i = 0; i < c->order_count; i++) {
        for (int k = 0; k < 3; k++) {
            corner_of(c, c->order[i], k, at);
            for (int axis = 0; axis < 2; axis++) {
                c->low[axis] = fmin(c->low[axis], at[axis]);
                high[axis] = fmax(high[axis], at[axis]);
            }
        }
    }
    c->cells = c->order_count > MANY_TRIANGLES ? COARSE_CELLS : CELLS;
    double side_m = fmax(high[0] - c->low[0], high[1] - c->low[1]);
    c->cell_m = fmax(side_m / (double)c->cells, 1e-9);
    for (size_t i = 0; i < c->cells * c->cells; i++) {
        c->label[i] = -1;
    }
}

static void mark(charter *c) {
    for (size_t i = 0; i < c->order_count; i++) {
        size_t low[2] = {SIZE_MAX, SIZE_MAX}, high[2] = {0, 0};
        for (int k = 0; k < 3; k++) {
            double at[2];
            corner_of(c, c->order[i], k, at);
            for (int axis = 0; axis < 2; axis++) {
                size_t cell = cell_of(c, axis, at[axis]);
                low[axis] = cell < low[axis] ? cell : low[axis];
                high[axis] = cell > high[axis] ? cell : high[axis];
            }
        }
        for (size_t row = low[0]; row <= high[0]; row++) {
            memset(&c->label[row * c->cells + low[1]], 0,
                   (high[1] - low[1] + 1) * sizeof *c->label);
        }
    }
}

/* Gives NUMBER to all cells connected with cell START. */
static void flood(charter *c, size_t start, int32_t number) {
    size_t depth = 0;
    c->stack[depth++] = (uint32_t)start;
    c->label[start] = number;
    while (depth > 0) {
        size_t cell = c->stack[--depth], row = cell / c->cells, column = cell % c->cells;
        for (size_t k = 0; k < 9; k++) { /* cells round it; unsigned wrap fails the test */
            size_t y = row + k / 3 - 1, x = column + k % 3 - 1;
            if (y < c->cells && x < c->cells && c->label[y * c->cells + x] == 0) {
                c->label[y * c->cells + x] = number;
                c->stack[depth++] = (uint32_t)(y * c->cells + x);
            }
        }
    }
}

static void begin_piece(piece *p) {
    for (int k = 0; k < ASDIC_OUTLINE_SIDES; k++) {
        p->reach[k] = -INFINITY;
    }
}

static void reach_out(const charter *c, double north, double east, piece *p) {
    for (int k = 0; k < ASDIC_OUTLINE_SIDES; k++) {
        double reach = north * c->unit[k][0] + east * c->unit[k][1];
        if (reach > p->reach[k]) {
            p->reach[k] = reach;
            p->at[k][0] = north;
            p->at[k][1] = east;
        }
    }
}

/* The area of the ring round P. */
static double ring_area(const piece *p) {
    double twice = 0.0;
    for (int k = 0; k < ASDIC_OUTLINE_SIDES; k++) {
        const double *a = p->at[k], *b = p->at[(k + 1) % ASDIC_OUTLINE_SIDES];
        twice += a[0] * b[1] - a[1] * b[0];
    }
    return 0.5 * twice;
}

/* Parts the cells of group NUMBER, if they fill little of their ring, in two across the longer side: the groups that
 * its halves become have its number and those from *LAST + 1 on, which *LAST counts. Whether it did. */
static bool halve(charter *c, int32_t number, int32_t *last) {
    size_t low[2] = {SIZE_MAX, SIZE_MAX}, high[2] = {0, 0}, held = 0;
    piece ring;
    begin_piece(&ring);
    for (size_t i = 0; i < c->cells * c->cells; i++) {
        if (c->label[i] != number) {
            continue;
        }
        size_t at[2] = {i / c->cells, i % c->cells};
        for (int axis = 0; axis < 2; axis++) {
            low[axis] = at[axis] < low[axis] ? at[axis] : low[axis];
            high[axis] = at[axis] > high[axis] ? at[axis] : high[axis];
        }
        reach_out(c, (double)at[0], (double)at[1], &ring);
        held++;
    }
    if (ring_area(&ring) <= MOST_HOLLOW * (double)held) {
        return false;
    }
    int across = high[1] - low[1] > high[0] - low[0];
    size_t middle = (low[across] + high[across] + 1) / 2;
    bool is_taken = false; /* NUMBER */
    for (int half = 0; half < 2; half++) {
        for (size_t i = 0; i < c->cells * c->cells; i++) {
            bool is_high = (across ? i % c->cells : i / c->cells) >= middle;
            c->label[i] = c->label[i] == number && is_high == (half == 1) ? 0 : c->label[i];
        }
        for (size_t i = 0; i < c->cells * c->cells; i++) {
            if (c->label[i] == 0) {
                flood(c, i, is_taken ? ++*last : number);
                is_taken = true;
            }
        }
    }
    return true;
}

static size_t part_pieces(charter *c) {
    int32_t count = 0;
    for (size_t i = 0; i < c->cells * c->cells; i++) {
        if (c->label[i] == 0) {
            flood(c, i, ++count);
        }
    }
    for (int32_t number = 1; number <= count; number++) {
        while (halve(c, number, &count)) {
        }
    }
    return (size_t)count;
}

static int32_t label_at(const charter *c, const double at[2]) {
    return c->label[cell_of(c, 0, at[0]) * c->cells + cell_of(c, 1, at[1])];
}

static void reach_piece(const charter *c, const double at[2], piece *pieces) {
    int32_t number = label_at(c, at);
    if (number > 0) { /* always, but where rounding left the cells of a triangle */
        reach_out(c, at[0], at[1], &pieces[number - 1]);
    }
}

/* Each corner goes to its piece; a triangle that lies in several, to all, by places half a cell apart. */
static void reach_all(const charter *c, piece *pieces) {
    for (size_t i = 0; i < c->order_count; i++) {
        double corner[3][2], side_m[2][2], most_m = 0.0;
        for (int k = 0; k < 3; k++) {
            corner_of(c, c->order[i], k, corner[k]);
            reach_piece(c, corner[k], pieces);
        }
        int32_t number = label_at(c, corner[0]);
        if (label_at(c, corner[1]) == number && label_at(c, corner[2]) == number) {
            continue;
        }
        for (int k = 0; k < 2; k++) {
            for (int axis = 0; axis < 2; axis++) {
                side_m[k][axis] = corner[k + 1][axis] - corner[0][axis];
                most_m = fmax(most_m, fabs(side_m[k][axis]));
            }
        }
        double steps = ceil(2.0 * most_m / c->cell_m);
        for (double a = 0.0; a <= steps; a++) {
            for (double b = 0.0; a + b <= steps; b++) {
                double u = a / steps, v = b / steps;
                const double at[2] = {corner[0][0] + side_m[0][0] * u + side_m[1][0] * v,
                                      corner[0][1] + side_m[0][1] * u + side_m[1][1] * v};
                reach_piece(c, at, pieces);
            }
        }
    }
}

static asdic_outline *add_outline(charter *c, const char *name) {
    if (!asdic_grow(&c->outlines, c->count, &c->capacity, sizeof *c->outlines)) {
        asdic_fail_memory(c->ctx, "outlines of objects");
        return NULL;
    }
    asdic_outline *outline = &c->outlines[c->count++];
    *outline = (asdic_outline){0};
    memcpy(outline->name, name, sizeof outline->name);
    return outline;
}

static asdic_status add_rings(charter *c, const char *name, const piece *pieces, size_t count) {
    for (size_t i = 0; i < count; i++) {
        if (isinf(pieces[i].reach[0])) { /* cells beside a slanted triangle */
            continue;
        }
        asdic_outline *o = add_outline(c, name);
        if (!o) {
            return ASDIC_ERROR_MEMORY;
        }
        for (int k = 0; k < ASDIC_OUTLINE_SIDES; k++) {
            const double *at = pieces[i].at[k];
            size_t last = o->count - 1;
            bool is_new = o->count == 0 || at[0] != o->north_m[last] || at[1] != o->east_m[last];
            bool is_first = o->count > 0 && at[0] == o->north_m[0] && at[1] == o->east_m[0];
            if (is_new && !is_first) {
                o->north_m[o->count] = at[0];
                o->east_m[o->count++] = at[1];
            }
        }
    }
    return ASDIC_OK;
}

static asdic_status chart_part(charter *c, const char *name) {
    lay_grid(c);
    mark(c);
    size_t count = part_pieces(c);
    piece *pieces = malloc((count + 1) * sizeof *pieces);
    if (!pieces) {
        return asdic_fail_memory(c->ctx, "outlines of objects");
    }
    for (size_t i = 0; i < count; i++) {
        begin_piece(&pieces[i]);
    }
    reach_all(c, pieces);
    asdic_status status = add_rings(c, name, pieces, count);
    free(pieces);
    return status;
}

/* Triangles by part: FIRST[part] to FIRST[part + 1] - 1 of ORDER. */
static void sort_by_part(const asdic_scene *scene, uint32_t *first, uint32_t *order) {
    for (size_t i = 0; i < scene->triangle_count; i++) {
        first[scene->triangles[i].part + 1]++;
    }
    for (size_t p = 0; p < scene->part_count; p++) {
        first[p + 1] += first[p];
    }
    for (size_t i = scene->triangle_count; i-- > 0;) { /* from the end: FIRST moves to its place */
        order[--first[scene->triangles[i].part + 1]] = (uint32_t)i;
    }
    memmove(first, first + 1, scene->part_count * sizeof *first);
    first[scene->part_count] = (uint32_t)scene->triangle_count;
}

asdic_status asdic_chart_outlines(asdic_context *ctx, const asdic_scene *scene, asdic_outline **out,
                                  size_t *count) {
    asdic_status status = ASDIC_OK;
    uint32_t *first = calloc(scene->part_count + 2, sizeof *first);
    uint32_t *order = malloc((scene->triangle_count + 1) * sizeof *order);
    charter *c = malloc(sizeof *c);
    *out = NULL;
    *count = 0;
    if (!first || !order || !c) {
        status = asdic_fail_memory(ctx, "outlines of objects");
        goto done;
    }
    c->ctx = ctx;
    c->scene = scene;
    c->outlines = NULL;
    c->count = c->capacity = 0;
    for (int k = 0; k < ASDIC_OUTLINE_SIDES; k++) {
        double bearing = 2.0 * ASDIC_PI * k / ASDIC_OUTLINE_SIDES;
        c->unit[k][0] = cos(bearing);
        c->unit[k][1] = sin(bearing);
    }
    sort_by_part(scene, first, order);
    for (size_t p = 0; p < scene->part_count && status == ASDIC_OK; p++) {
        c->order = order + first[p];
        c->order_count = first[p + 1] - first[p];
        if (scene->parts[p].kind == DEV_KIND_OBJECT && c->order_count > 0) {
            status = chart_part(c, scene->parts[p].name);
        }
    }
    for (size_t i = 0; i < scene->point_count && status == ASDIC_OK; i++) {
        asdic_outline *o = add_outline(c, scene->points[i].name);
        status = o ? ASDIC_OK : ASDIC_ERROR_MEMORY;
        if (o) {
            o->count = 1;
            o->north_m[0] = scene->points[i].position_m.x;
            o->east_m[0] = scene->points[i].position_m.y;
        }
    }
    if (status != ASDIC_OK) {
        free(c->outlines);
        goto done;
    }
    *out = c->outlines;
    *count = c->count;
done:
    free(c);
    free(order);
    free(first);
    return status;
}
