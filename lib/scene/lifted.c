#include "lifted.h"

#include "base/context.h"
#include "base/try.h"
#include "moving.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What the chord of a lifted edge may leave out, m. */
#define CHORD 2e-3
/* Pieces that few large triangles may make; from there on edges may be longer. */
#define MOST_PIECES 4e6

/* Lifted triangles: one for each of the first triangles of the scene, then further pieces of those, whose ids are
 * in PARENTS. */
typedef struct pieces {
    const asdic_scene *scene;
    dev_triangle *triangles;
    uint32_t *parents;
    size_t scene_count, count, capacity;
    const dev_layer *layers;
    size_t layer_count;
    double bend_per_m, shift_m, longest2_m2; /* of the layer in hand */
    double least2_m2;                        /* no edge needs to be shorter */
} pieces;

/* Corners in double: halves of an edge have the same bits in both of its triangles. */
typedef struct corners {
    double v[3][3];
} corners;

static double edge2(const corners *c, int i) {
    const double *a = c->v[i], *b = c->v[(i + 1) % 3];
    double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
    return x * x + y * y + z * z;
}

static corners corners_of(const dev_triangle *t) {
    corners c;
    for (int k = 0; k < 3; k++) {
        c.v[0][k] = t->v0[k];
        c.v[1][k] = t->v1[k];
        c.v[2][k] = t->v2[k];
    }
    return c;
}

static bool is_long(const pieces *p, const corners *c) {
    return edge2(c, 0) > p->longest2_m2 || edge2(c, 1) > p->longest2_m2 ||
           edge2(c, 2) > p->longest2_m2;
}

static void place(const pieces *p, const corners *c, dev_triangle *t) {
    float *to[3] = {t->v0, t->v1, t->v2};
    for (int i = 0; i < 3; i++) {
        to[i][0] = (float)c->v[i][0];
        to[i][1] = (float)c->v[i][1];
        to[i][2] = (float)((double)asdic_lifted_z(p->bend_per_m, c->v[i]) + p->shift_m);
    }
}

static asdic_status append(pieces *p, size_t parent, const corners *c) {
    if (p->count == p->capacity) {
        size_t capacity = p->capacity + p->capacity / 2 + 64;
        dev_triangle *triangles = realloc(p->triangles, capacity * sizeof *triangles);
        p->triangles = triangles ? triangles : p->triangles;
        uint32_t *parents = realloc(p->parents, (capacity - p->scene_count) * sizeof *parents);
        p->parents = parents ? parents : p->parents;
        if (!triangles || !parents) {
            return asdic_fail_memory(p->scene->ctx, "a scene for bent rays");
        }
        p->capacity = capacity;
    }
    p->triangles[p->count] = p->triangles[parent];
    p->parents[p->count - p->scene_count] = (uint32_t)parent;
    place(p, c, &p->triangles[p->count++]);
    return ASDIC_OK;
}

/* Halves the long edges of a piece of PARENT. Whether an edge is halved depends on its ends alone, so that
 * neighbours share all corners. The first piece takes the parent's own place. */
static asdic_status divide(pieces *p, size_t parent, const corners *c, bool *first) {
    if (!is_long(p, c)) {
        if (*first) {
            *first = false;
            place(p, c, &p->triangles[parent]);
            return ASDIC_OK;
        }
        return append(p, parent, c);
    }
    int longest = edge2(c, 0) >= edge2(c, 1) ? 0 : 1;
    longest = edge2(c, 2) > edge2(c, longest) ? 2 : longest;
    corners half[2] = {*c, *c};
    for (int k = 0; k < 3; k++) {
        double middle = 0.5 * (c->v[longest][k] + c->v[(longest + 1) % 3][k]);
        half[0].v[(longest + 1) % 3][k] = middle;
        half[1].v[longest][k] = middle;
    }
    TRY(divide(p, parent, &half[0], first));
    return divide(p, parent, &half[1], first);
}

static void enter_layer(pieces *p, const dev_layer *layer) {
    p->bend_per_m = layer->bend_per_m;
    p->shift_m = layer->shift_m;
    p->longest2_m2 = fmax(8.0 * CHORD / fmax(fabs(p->bend_per_m), 1e-30), p->least2_m2);
}

static bool reaches(const corners *c, const dev_layer *layer) {
    double low = fmin(fmin(c->v[0][2], c->v[1][2]), c->v[2][2]);
    double high = fmax(fmax(c->v[0][2], c->v[1][2]), c->v[2][2]);
    return high >= (double)layer->top_m - ASDIC_LAYER_OVERLAP_M &&
           low <= (double)layer->bottom_m + ASDIC_LAYER_OVERLAP_M;
}

static double twice_area_m2(const corners *c) {
    double a[3], b[3];
    for (int k = 0; k < 3; k++) {
        a[k] = c->v[1][k] - c->v[0][k];
        b[k] = c->v[2][k] - c->v[0][k];
    }
    return hypot(hypot(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2]),
                 a[0] * b[1] - a[1] * b[0]);
}

/* Lets edges be longer where large triangles, of those from BEGIN to END, would make too many pieces in all layers. */
static void limit_pieces(pieces *p, size_t begin, size_t end) {
    double sum = 0.0;
    p->least2_m2 = 0.0;
    for (size_t i = begin; i < end; i++) {
        corners c = corners_of(&p->scene->triangles[i]);
        for (size_t k = 0; k < p->layer_count; k++) {
            enter_layer(p, &p->layers[k]);
            sum += is_long(p, &c) && reaches(&c, &p->layers[k]) ? twice_area_m2(&c) : 0.0;
        }
    }
    /* Pieces have from a quarter to half of the square of their longest edge. */
    p->least2_m2 = 4.0 * sum / MOST_PIECES;
}

/* The first COUNT triangles of SCENE; those from FIRST on are to be lifted. */
static asdic_status begin_pieces(pieces *p, const asdic_scene *scene, size_t first, size_t count,
                                 const dev_layer *layers, size_t layer_count) {
    *p = (pieces){.scene = scene,
                  .triangles = malloc((count + 64) * sizeof *p->triangles),
                  .parents = malloc(64 * sizeof *p->parents),
                  .scene_count = count,
                  .count = count,
                  .capacity = count + 64,
                  .layers = layers,
                  .layer_count = layer_count};
    if (!p->triangles || !p->parents) {
        return asdic_fail_memory(scene->ctx, "a scene for bent rays");
    }
    memcpy(p->triangles + first, scene->triangles + first, (count - first) * sizeof *p->triangles);
    return ASDIC_OK;
}

static void finish_pieces(pieces *p) {
    free(p->triangles);
    free(p->parents);
}

static asdic_status lift_triangles(pieces *p, size_t begin, size_t end) {
    const asdic_scene *scene = p->scene;
    limit_pieces(p, begin, end);
    for (size_t i = begin; i < end; i++) {
        corners c = corners_of(&scene->triangles[i]);
        bool first = true;
        if (scene->parts[scene->triangles[i].part].moves) {
            place(p, &c, &p->triangles[i]);
        } else {
            for (size_t k = 0; k < p->layer_count; k++) {
                if (reaches(&c, &p->layers[k])) {
                    enter_layer(p, &p->layers[k]);
                    TRY(divide(p, i, &c, &first));
                }
            }
        }
    }
    return ASDIC_OK;
}

/* The blocks of BVH, over pieces, get the ids of the scene's triangles. */
static void name_parents(const pieces *p, asdic_bvh *bvh) {
    for (size_t b = 0; b < bvh->block_count; b++) {
        uint32_t *ids = bvh->blocks[b].id;
        for (int lane = 0; lane < DEV_LEAF_TRIANGLES && ids[lane] != ~0u; lane++) {
            ids[lane] =
                ids[lane] < p->scene_count ? ids[lane] : p->parents[ids[lane] - p->scene_count];
        }
    }
}

/* Builds LIFTED's hierarchy. */
static asdic_status build(asdic_scene *lifted, const pieces *p) {
    dev_triangle *own = lifted->triangles;
    lifted->triangles = p->triangles;
    lifted->triangle_count = p->count;
    asdic_status status = asdic_scene_assemble(lifted);
    lifted->triangles = own;
    lifted->triangle_count = p->scene_count;
    if (!status) {
        name_parents(p, &lifted->bvh);
    }
    return status;
}

/* Whether what lifts triangles is the same. */
static bool is_lifted_in(const asdic_ground *ground, const dev_layer *layers, size_t count) {
    bool is = ground->layers && ground->layer_count == count;
    for (size_t i = 0; is && i < count; i++) {
        const dev_layer *a = &ground->layers[i], *b = &layers[i];
        is = a->top_m == b->top_m && a->bottom_m == b->bottom_m && a->bend_per_m == b->bend_per_m &&
             a->shift_m == b->shift_m;
    }
    return is;
}

/* Lifts what SCENE keeps of its ground, unless it is lifted in these layers. */
static asdic_status need_ground(const asdic_scene *scene, const dev_layer *layers,
                                size_t layer_count) {
    asdic_ground *ground = scene->ground;
    size_t count = scene->ground_count;
    asdic_bvh bvh = {.root = DEV_EMPTY};
    pieces p;
    if (is_lifted_in(ground, layers, layer_count)) {
        return ASDIC_OK;
    }
    asdic_status status = begin_pieces(&p, scene, 0, count, layers, layer_count);
    status = status ? status : lift_triangles(&p, 0, count);
    status = status ? status
                    : asdic_bvh_build(scene->ctx, p.triangles, NULL, p.count, scene->threads, &bvh);
    dev_layer *kept = status ? NULL : malloc(layer_count * sizeof *kept);
    if (kept) {
        name_parents(&p, &bvh);
        memcpy(kept, layers, layer_count * sizeof *kept);
        asdic_bvh_finish(&ground->lifted);
        free(ground->layers);
        ground->lifted = bvh;
        ground->layers = kept;
        ground->layer_count = layer_count;
    } else {
        asdic_bvh_finish(&bvh);
    }
    finish_pieces(&p);
    return status ? status : kept ? ASDIC_OK : asdic_fail_memory(scene->ctx, "a lifted bottom");
}

/* Lifts all that SCENE does not keep lifted, and builds LIFTED's hierarchy. */
static asdic_status lift_all(const asdic_scene *scene, const dev_layer *layers, size_t layer_count,
                             asdic_scene *lifted) {
    size_t ground = scene->ground_count, count = scene->triangle_count;
    asdic_ground kept;
    pieces p;
    lifted->ground = NULL;
    if (scene->ground && ground > 0) {
        TRY(need_ground(scene, layers, layer_count));
        kept.bvh = scene->ground->lifted;
        lifted->ground = &kept;
    }
    asdic_status status =
        begin_pieces(&p, scene, lifted->ground ? ground : 0, count, layers, layer_count);
    if (!status && !lifted->ground) {
        status = lift_triangles(&p, 0, ground);
    }
    status = status ? status : lift_triangles(&p, ground, count);
    status = status ? status : build(lifted, &p);
    finish_pieces(&p);
    lifted->ground = NULL; /* a view is not reopened */
    return status;
}

/* In how many layers an object that moves can be at a time. */
static size_t count_copies(const asdic_scene *scene, const dev_layer *layers, size_t layer_count) {
    double high = 2.0 * ASDIC_LAYER_OVERLAP_M;
    size_t most = 1;
    for (size_t i = 0; i < scene->movable_count; i++) {
        high = fmax(high,
                    2.0 * (scene->parts[scene->movables[i].part].radius_m + ASDIC_LAYER_OVERLAP_M));
    }
    for (size_t i = 0; i < layer_count; i++) {
        size_t count = 1;
        while (i + count < layer_count &&
               (double)layers[i + count].top_m <= (double)layers[i].bottom_m + high) {
            count++;
        }
        most = count > most ? count : most;
    }
    return most;
}

static asdic_status fill(const asdic_scene *scene, const dev_layer *layers, size_t layer_count,
                         double bend_per_m, asdic_scene *lifted) {
    size_t movables = scene->movable_count;
    *lifted = *scene;
    lifted->bend_per_m = bend_per_m;
    lifted->bvh = (asdic_bvh){.root = DEV_EMPTY};
    lifted->copies = count_copies(scene, layers, layer_count);
    lifted->movable_count = movables * lifted->copies;
    lifted->movables = calloc(lifted->movable_count + 1, sizeof *lifted->movables);
    if (!lifted->movables) {
        return asdic_fail_memory(scene->ctx, "a scene for bent rays");
    }
    for (size_t i = 0; i < lifted->movable_count; i++) {
        lifted->movables[i] = scene->movables[i / lifted->copies];
    }
    if (!scene->ground) {
        return lift_all(scene, layers, layer_count, lifted);
    }
    pthread_mutex_lock(&scene->ground->lock);
    asdic_status status = lift_all(scene, layers, layer_count, lifted);
    pthread_mutex_unlock(&scene->ground->lock);
    return status;
}

static asdic_status lift(const asdic_scene *scene, const dev_layer *layers, size_t count,
                         double bend_per_m, asdic_scene **out) {
    *out = calloc(1, sizeof **out);
    if (!*out) {
        return asdic_fail_memory(scene->ctx, "a scene for bent rays");
    }
    asdic_status status = fill(scene, layers, count, bend_per_m, *out);
    if (status) {
        asdic_scene_unlift(out);
    }
    return status;
}

asdic_status asdic_scene_lift(const asdic_scene *scene, double bend_per_m, asdic_scene **out) {
    const dev_layer all = {-INFINITY, INFINITY, (float)bend_per_m, 0.0f, 1};
    return lift(scene, &all, 1, all.bend_per_m, out);
}

asdic_status asdic_scene_lift_layers(const asdic_scene *scene, const dev_layer *layers,
                                     size_t count, asdic_scene **out) {
    TRY(lift(scene, layers, count, 0.0, out));
    (*out)->layers = layers;
    (*out)->layer_count = count;
    return ASDIC_OK;
}

void asdic_scene_unlift(asdic_scene **lifted) {
    if (lifted && *lifted) {
        free((*lifted)->movables);
        asdic_bvh_finish(&(*lifted)->bvh);
        free(*lifted);
        *lifted = NULL;
    }
}
