#include "ring_shelf.h"

#include "base/context.h"
#include "base/hash.h"
#include "base/share.h"
#include "base/try.h"

#include <stdlib.h>
#include <string.h>

/* Beams of a thread, some 8 ms each, between looks at whether to stop. */
#define BEAMS_PER_STEP 4

/* The rings of all beams of a sonar at one attitude. */
typedef struct ring_set {
    asdic_ring *rings;
    asdic_ring_profile **profiles;
    size_t count;
} ring_set;

struct asdic_ring_shelf {
    asdic_context *ctx;
    ring_set *sets;
    size_t set_count;
};

asdic_status asdic_ring_shelf_create(asdic_context *ctx, size_t sets, asdic_ring_shelf **out) {
    asdic_ring_shelf *shelf = *out = calloc(1, sizeof *shelf);
    if (shelf) {
        shelf->ctx = ctx;
        shelf->set_count = sets;
        shelf->sets = calloc(sets, sizeof *shelf->sets);
    }
    if (!shelf || !shelf->sets) {
        asdic_ring_shelf_destroy(out);
        return asdic_fail_memory(ctx, "profiles of beams");
    }
    return ASDIC_OK;
}

static void empty(ring_set *set) {
    for (size_t i = 0; set->profiles && i < set->count; i++) {
        asdic_ring_profile_destroy(&set->profiles[i]);
    }
    free(set->profiles);
    free(set->rings);
    *set = (ring_set){.rings = NULL};
}

void asdic_ring_shelf_destroy(asdic_ring_shelf **shelf) {
    if (shelf && *shelf) {
        for (size_t i = 0; (*shelf)->sets && i < (*shelf)->set_count; i++) {
            empty(&(*shelf)->sets[i]);
        }
        free((*shelf)->sets);
        free(*shelf);
        *shelf = NULL;
    }
}

/* Beams in work. */
typedef struct making {
    const asdic_ring *rings;
    asdic_ring_profile **profiles;
} making;

/* Of no memory there is none, and the caller says so: threads share no context's error. */
static void make_profiles(void *user, unsigned worker, size_t first, size_t end) {
    const making *m = user;
    (void)worker;
    for (size_t i = first; i < end; i++) {
        (void)asdic_ring_profile_create(NULL, &m->rings[i], &m->profiles[i]);
    }
}

static asdic_status fill(asdic_ring_shelf *shelf, const asdic_ring *rings, size_t count,
                         ring_set *set) {
    unsigned threads = asdic_processors();
    size_t step = (size_t)threads * BEAMS_PER_STEP;
    asdic_status status = ASDIC_OK;
    empty(set);
    set->rings = malloc(count * sizeof *rings);
    set->profiles = calloc(count, sizeof *set->profiles);
    if (!set->rings || !set->profiles) {
        empty(set);
        return asdic_fail_memory(shelf->ctx, "profiles of beams");
    }
    memcpy(set->rings, rings, count * sizeof *rings);
    set->count = count;
    for (size_t i = 0; i < count && !status; i += step) {
        making m = {set->rings + i, set->profiles + i};
        status = asdic_step(shelf->ctx, "beams", i, count);
        if (!status) {
            asdic_share(threads, count - i < step ? count - i : step, 1, make_profiles, &m);
        }
    }
    for (size_t i = 0; i < count && !status; i++) {
        status = set->profiles[i] ? ASDIC_OK : asdic_fail_memory(shelf->ctx, "profiles of beams");
    }
    if (status) {
        empty(set);
    }
    return status;
}

asdic_status asdic_ring_shelf_take(asdic_ring_shelf *shelf, const asdic_ring *rings, size_t count,
                                   asdic_ring_profile *const **out) {
    size_t bytes = count * sizeof *rings;
    ring_set *set = &shelf->sets[asdic_hash_slot(rings, bytes, shelf->set_count)];
    if (set->count != count || memcmp(set->rings, rings, bytes) != 0) {
        TRY(fill(shelf, rings, count, set));
    }
    *out = set->profiles;
    return ASDIC_OK;
}
