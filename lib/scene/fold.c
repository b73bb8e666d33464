#include "fold.h"

#include "../base/context.h"
#include "../base/grow.h"
#include "../base/vec.h"

#include <stdlib.h>
#include <string.h>

/* A turn goes on where the next is alike to this ratio, by itself or by length: chords of a circle turn by half the sum of
 * their lengths over its radius, and the first and the last of a fillet by half as much as those within. */
#define ALIKE 6.0
/* A chord of a circle turns by half of its own arc and half of its neighbour's. What turns over an edge by the half of its
 * neighbour alone bends less than so much of it: a wall between fillets, a barrel between domes. */
#define STRAIGHT (1.0 / 6.0)
/* Of less, patches that are level to ASDIC_SAME_PLANE do not tell it. */
#define LEAST_TURN (20.0 * ASDIC_SAME_PLANE)
/* A facet so much narrower than what it bevels stands for a rounded edge. */
#define BEVEL_RATIO 4.0
/* What lies at a patch's far side is farther away than this share of its width, more than the middle of what is beside. */
#define FAR_SIDE 0.6
/* It turns ahead, not aside: cosine of the angle between. */
#define AHEAD 0.5
/* A patch with more neighbours is a floor; whether they turn on is not asked. */
#define MOST_FOLDS 2048

/* What is known of a fold while its patch is the present one. */
typedef struct sight {
    asdic_vec3 sum_m; /* of the vertices shared */
    asdic_vec3 turn;
    uint32_t last; /* vertex */
} sight;

/* Facets by their patch, and what is found on the way. */
typedef struct folding {
    asdic_surface *s;
    uint32_t *first, *members; /* of each patch */
    uint32_t *place;           /* by patch: its fold beside the present one */
    uint32_t *seen;            /* by vertex: the patch that saw it last */
    sight *sights;             /* of the present patch' folds */
    size_t count, room, sight_room;
    bool joined; /* vertices lie on edges of others, who do not share them */
} folding;

static uint32_t size_of(const folding *f, uint32_t patch) {
    return f->first[patch + 1] - f->first[patch];
}

static void sort_members(folding *f) {
    const asdic_surface *s = f->s;
    for (uint32_t i = 0; i < s->count; i++) {
        f->first[s->patch[i] + 1]++;
    }
    for (uint32_t i = 0; i < s->count; i++) {
        f->first[i + 1] += f->first[i];
    }
    for (uint32_t i = 0; i < s->count; i++) {
        f->members[f->first[s->patch[i]]++] = i;
    }
    memmove(f->first + 1, f->first, s->count * sizeof *f->first);
    f->first[0] = 0;
}

/* Room for one fold more than there are, of which the present patch' begin at BEGIN. */
static bool make_room(folding *f, uint32_t begin) {
    return asdic_grow(&f->s->folds, f->count, &f->room, sizeof *f->s->folds) &&
           asdic_grow(&f->sights, f->count - begin, &f->sight_room, sizeof *f->sights);
}

/* The fold from the present patch, whose folds begin at BEGIN, to OTHER; NULL without room. */
static asdic_fold *fold_to(folding *f, uint32_t begin, uint32_t other) {
    uint32_t at = f->place[other];
    if (at >= begin && at < f->count && f->s->folds[at].patch == other) {
        return &f->s->folds[at];
    }
    if (!make_room(f, begin)) {
        return NULL;
    }
    f->place[other] = (uint32_t)f->count;
    f->sights[f->count - begin] = (sight){.last = UINT32_MAX};
    f->s->folds[f->count] = (asdic_fold){.patch = other, .beyond = INFINITY};
    return &f->s->folds[f->count++];
}

/* Adds VERTEX of PATCH to the folds with all that touch it there. */
static bool fold_vertex(folding *f, uint32_t patch, uint32_t facet, uint32_t vertex) {
    const asdic_surface *s = f->s;
    asdic_corners around = asdic_surface_around(s, vertex);
    uint32_t begin = s->first_fold[patch];
    asdic_vec3 own = asdic_surface_normal(s, facet), p = asdic_surface_corner(s, vertex);
    for (uint32_t i = 0; i < around.count; i++) {
        uint32_t next = around.at[i] / 3, other = s->patch[next];
        if (other == patch || (size_of(f, patch) == 1 && size_of(f, other) == 1) ||
            asdic_vec3_dot(own, asdic_surface_normal(s, next)) < s->crease_cosine) {
            continue;
        }
        asdic_fold *fold = fold_to(f, begin, other);
        if (!fold) {
            return false;
        }
        sight *seen = &f->sights[f->place[other] - begin];
        if (seen->last != vertex) {
            seen->sum_m = asdic_vec3_add(seen->sum_m, p);
            seen->last = vertex;
            fold->shared++;
        }
    }
    return true;
}

asdic_vec3 asdic_fold_turn(const asdic_surface *s, uint32_t patch, uint32_t other) {
    asdic_vec3 own = asdic_patch_normal(s, patch), next = asdic_patch_normal(s, other);
    return asdic_vec3_sub(next, asdic_vec3_scale(own, asdic_vec3_dot(own, next)));
}

static void find_beside(folding *f, uint32_t patch, bool *has_room) {
    asdic_surface *s = f->s;
    uint32_t begin = s->first_fold[patch] = (uint32_t)f->count;
    for (uint32_t i = f->first[patch]; i < f->first[patch + 1]; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t vertex = s->vertex[3 * (size_t)f->members[i] + k];
            if (f->seen[vertex] != patch) {
                f->seen[vertex] = patch;
                *has_room = *has_room && fold_vertex(f, patch, f->members[i], vertex);
            }
        }
    }
    f->count = f->count - begin > MOST_FOLDS ? begin : f->count;
    for (size_t i = begin; i < f->count; i++) {
        asdic_vec3 origin = asdic_surface_corner(s, 3 * (size_t)s->patches[patch].facet);
        asdic_fold *fold = &s->folds[i];
        sight *seen = &f->sights[i - begin];
        asdic_vec3 at = asdic_vec3_scale(seen->sum_m, 1.0 / fold->shared);
        at = asdic_vec3_sub(at, origin);
        fold->at_m[0] = (float)at.x;
        fold->at_m[1] = (float)at.y;
        fold->at_m[2] = (float)at.z;
        seen->turn = asdic_fold_turn(s, patch, fold->patch);
    }
}

/* How PATCH turns over a fold, and how far it reaches across it. */
typedef struct across {
    asdic_vec3 way; /* unit; 0: it does not turn */
    double sine, width;
} across;

static across across_of(const asdic_surface *s, uint32_t patch, asdic_vec3 turn) {
    across a = {.sine = asdic_vec3_length(turn)};
    if (a.sine > 0.0) {
        a.way = asdic_vec3_scale(turn, 1.0 / a.sine);
        a.width = asdic_patch_reach(s, patch, a.way);
    }
    return a;
}

/* Whether FAR lies at the far side of a patch from its FOLD, that it turns over by A. */
static bool is_far(const across *a, const asdic_fold *fold, const asdic_fold *far) {
    double apart = a->way.x * ((double)far->at_m[0] - (double)fold->at_m[0]) +
                   a->way.y * ((double)far->at_m[1] - (double)fold->at_m[1]) +
                   a->way.z * ((double)far->at_m[2] - (double)fold->at_m[2]);
    return fabs(apart) >= FAR_SIDE * a->width;
}

/* How much a TURN is along A; 0: it is aside. */
static double turn_along(const across *a, asdic_vec3 turn) {
    double along = fabs(asdic_vec3_dot(turn, a->way));
    return along >= AHEAD * asdic_vec3_length(turn) ? along : 0.0;
}

static bool alike(double a, double b) {
    return a <= ALIKE * b && b <= ALIKE * a;
}

/* Rate of FOLD of PATCH, and the least at the far side where that is of its kind. */
static void measure_fold(folding *f, uint32_t patch, asdic_fold *fold) {
    const asdic_surface *s = f->s;
    uint32_t begin = s->first_fold[patch];
    across a = across_of(s, patch, f->sights[fold - s->folds - begin].turn);
    if (!(a.sine > 0.0)) {
        return;
    }
    double rate = 2.0 * a.sine / (a.width + asdic_patch_reach(s, fold->patch, a.way));
    fold->rate = (float)rate;
    for (uint32_t j = begin; j < f->count; j++) {
        const asdic_fold *far = &s->folds[j];
        double turn = is_far(&a, fold, far) ? turn_along(&a, f->sights[j - begin].turn) : 0.0;
        if (!(turn > 0.0)) {
            continue;
        }
        double there = 2.0 * turn / (a.width + asdic_patch_reach(s, far->patch, a.way));
        if (alike(turn, a.sine) || alike(there, rate)) {
            fold->beyond = fminf(fold->beyond, (float)there);
        }
    }
}

static asdic_fold *find_fold(const asdic_surface *s, uint32_t patch, uint32_t other) {
    for (uint32_t i = s->first_fold[patch]; i < s->first_fold[patch + 1]; i++) {
        if (s->folds[i].patch == other) {
            return &s->folds[i];
        }
    }
    return NULL;
}

/* Whether both patches of a fold, BACK from beyond (NULL: none), have an edge in common. On one that is cut apart the
 * vertices of one alone may lie. */
static bool is_edge(const asdic_fold *own, const asdic_fold *back) {
    return back && (own->shared > 1 || back->shared > 1);
}

/* Whether OWN's patch and that beyond, whose fold BACK is, both turn on, and the latter no faster. */
static bool is_amid(const asdic_fold *own, const asdic_fold *back) {
    return own->beyond < INFINITY && back->beyond < INFINITY &&
           back->beyond <= (float)ALIKE * own->rate;
}

/* Whether PATCH turns on, amid others, at the side far from FOLD. */
static bool turns_on(const asdic_surface *s, uint32_t patch, const asdic_fold *fold) {
    across a = across_of(s, patch, asdic_fold_turn(s, patch, fold->patch));
    for (uint32_t j = s->first_fold[patch]; j < s->first_fold[patch + 1]; j++) {
        const asdic_fold *far = &s->folds[j], *back = find_fold(s, far->patch, patch);
        if (is_edge(far, back) && is_amid(far, back) && is_far(&a, fold, far) &&
            turn_along(&a, asdic_fold_turn(s, patch, far->patch)) > 0.0) {
            return true;
        }
    }
    return false;
}

/* Whether all that turns over OWN, the fold of a patch that reaches A across it, is the arc of the patch beyond, as its far
 * side has it. BACK: from there. */
static bool is_tangent(const asdic_surface *s, const across *a, const asdic_fold *own,
                       const asdic_fold *back) {
    double next = asdic_patch_reach(s, own->patch, a->way), arc = (double)back->beyond * next;
    return a->sine > LEAST_TURN && back->beyond < INFINITY &&
           fabs((double)own->rate * (a->width + next) - arc) <
               STRAIGHT * a->width * (double)back->beyond;
}

/* Whether PATCH is straight between what turns at its FOLD and at its far side, if anything does. */
static bool is_wall(const asdic_surface *s, uint32_t patch, const asdic_fold *fold) {
    const asdic_fold *back = find_fold(s, fold->patch, patch);
    if (!is_edge(fold, back) || !(fold->rate > 0.0f)) {
        return false;
    }
    across a = across_of(s, patch, asdic_fold_turn(s, patch, fold->patch));
    bool wall = is_tangent(s, &a, fold, back);
    for (uint32_t j = s->first_fold[patch]; wall && j < s->first_fold[patch + 1]; j++) {
        const asdic_fold *far = &s->folds[j], *home = find_fold(s, far->patch, patch);
        wall = !is_edge(far, home) || !is_far(&a, fold, far) ||
               !(turn_along(&a, asdic_fold_turn(s, patch, far->patch)) > 0.0) ||
               is_tangent(s, &a, far, home);
    }
    return wall;
}

/* Whether PATCH keeps flat towards FOLD: three facets or fewer, one after another, are faces that meet at blunt edges,
 * unless the one amid is narrow: a bevel. */
static bool keeps_flat(const asdic_surface *s, uint32_t patch, const asdic_fold *fold) {
    const asdic_fold *back = find_fold(s, fold->patch, patch);
    if (!is_edge(fold, back) || !(fold->rate > 0.0f)) {
        return false;
    }
    if (fold->straight) {
        return true;
    }
    if (is_amid(fold, back)) {
        return false;
    }
    if (back->beyond < INFINITY) {
        return back->beyond > (float)ALIKE * fold->rate || !turns_on(s, fold->patch, back);
    }
    if (fold->beyond == INFINITY) {
        return true;
    }
    across a = across_of(s, patch, asdic_fold_turn(s, patch, fold->patch));
    return BEVEL_RATIO * a.width > asdic_patch_reach(s, fold->patch, a.way) &&
           !turns_on(s, patch, fold);
}

static bool find_all(folding *f) {
    asdic_surface *s = f->s;
    bool has_room = true;
    sort_members(f);
    for (uint32_t patch = 0; patch < s->count; patch++) {
        find_beside(f, patch, &has_room);
        for (size_t i = s->first_fold[patch]; has_room && i < f->count; i++) {
            if (f->joined || s->folds[i].shared > 1) { /* else it is no edge */
                measure_fold(f, patch, &s->folds[i]);
            }
        }
    }
    s->first_fold[s->count] = (uint32_t)f->count;
    for (uint32_t patch = 0; has_room && patch < s->count; patch++) {
        for (uint32_t i = s->first_fold[patch]; i < s->first_fold[patch + 1]; i++) {
            s->folds[i].straight = is_wall(s, patch, &s->folds[i]);
            s->folds[i].ends = keeps_flat(s, patch, &s->folds[i]);
            s->patches[patch].ends |= s->folds[i].ends;
        }
    }
    return has_room;
}

asdic_status asdic_surface_find_folds(asdic_context *ctx, asdic_surface *s) {
    size_t count = s->count;
    folding f = {.s = s,
                 .first = calloc(count + 2, sizeof *f.first),
                 .members = malloc(count * sizeof *f.members),
                 .place = malloc(count * sizeof *f.place),
                 .seen = malloc(3 * count * sizeof *f.seen),
                 .joined = s->first[3 * count] > 3 * count};
    s->first_fold = malloc((count + 1) * sizeof *s->first_fold);
    bool has_room = f.first && f.members && f.place && f.seen && s->first_fold;
    if (has_room) {
        memset(f.place, 0xff, count * sizeof *f.place); /* beyond every fold */
        memset(f.seen, 0xff, 3 * count * sizeof *f.seen);
        has_room = find_all(&f);
    }
    free(f.first);
    free(f.members);
    free(f.place);
    free(f.seen);
    free(f.sights);
    return has_room ? ASDIC_OK : asdic_fail_memory(ctx, "the folds of an object");
}

bool asdic_fold_is_straight(const asdic_surface *s, uint32_t patch, uint32_t other) {
    const asdic_fold *fold = find_fold(s, patch, other);
    return fold && fold->straight;
}

bool asdic_fold_parts(const asdic_surface *s, uint32_t patch, uint32_t other) {
    const asdic_fold *fold = find_fold(s, patch, other);
    return fold && (fold->ends || !is_edge(fold, find_fold(s, other, patch)));
}
