#include "run_queue.h"

#include "base/clock.h"
#include "base/context.h"
#include "base/try.h"

#include <stdlib.h>

/* Results that wait to be taken may hold this much memory. */
#define WINDOW_BYTES ((size_t)256 << 20)

static size_t least(size_t a, size_t b) {
    return a < b ? a : b;
}

static size_t most(size_t a, size_t b) {
    return a > b ? a : b;
}

asdic_status asdic_queue_init(asdic_queue *q, asdic_context *ctx, const asdic_queue_size *size) {
    size_t cells = size->beams * size->bins, pings = size->end - size->first;
    size_t bytes = cells * (ASDIC_COMPONENT_COUNT * sizeof(double) + sizeof(float)) +
                   (size_t)asdic_elements_bytes(&size->elements);
    *q = (asdic_queue){.ctx = ctx,
                       .end = size->end,
                       .lock = PTHREAD_MUTEX_INITIALIZER,
                       .changed = PTHREAD_COND_INITIALIZER,
                       .remaining = pings,
                       .fresh = size->first,
                       .taken = size->first};
    q->slot_count =
        least(most(WINDOW_BYTES / bytes, 2 * size->devices), 2 * ASDIC_LEARN_BLOCK * size->devices);
    q->chunk = least(least(q->slot_count / (2 * size->devices), ASDIC_LEARN_BLOCK),
                     most(1, pings / (4 * size->devices)));
    q->slot_count = least(q->slot_count, pings);
    q->slots = calloc(q->slot_count, sizeof *q->slots);
    /* A worker returns the pings that failed and those it has not begun. */
    if (!q->slots || !asdic_queue_reserve(q, 2 * size->own)) {
        return asdic_fail_memory(ctx, "the queue of pings");
    }
    for (size_t i = 0; i < q->slot_count; i++) {
        TRY(asdic_ping_create(ctx, size->beams, size->bins, &q->slots[i].result));
        q->slots[i].result->bin_length_m = size->bin_length_m;
        if (size->elements.elements > 0) {
            TRY(asdic_ping_add_elements(ctx, q->slots[i].result, size->elements.elements,
                                        size->elements.samples));
        }
        if (size->truth) {
            TRY(asdic_ping_add_truth(ctx, q->slots[i].result));
        }
    }
    return ASDIC_OK;
}

void asdic_queue_finish(asdic_queue *q) {
    for (size_t i = 0; q->slots && i < q->slot_count; i++) {
        asdic_ping_destroy(&q->slots[i].result);
    }
    free(q->slots);
    free(q->returned);
    pthread_cond_destroy(&q->changed);
    pthread_mutex_destroy(&q->lock);
}

size_t asdic_queue_room(const asdic_queue *q) {
    return q->taken + q->slot_count;
}

asdic_range asdic_queue_take_returned(asdic_queue *q, size_t most_pings) {
    asdic_range *lowest = NULL;
    size_t room = asdic_queue_room(q);
    for (size_t i = 0; i < q->returned_count; i++) {
        asdic_range *r = &q->returned[i];
        if (r->next < r->end && (!lowest || r->next < lowest->next)) {
            lowest = r;
        }
    }
    if (q->is_stopped || !lowest || lowest->next >= room) {
        return (asdic_range){0, 0};
    }
    asdic_range found = {lowest->next, least(least(lowest->end, room), lowest->next + most_pings)};
    lowest->next = found.end;
    return found;
}

asdic_range asdic_queue_deal(asdic_queue *q) {
    size_t block_end = (q->fresh / ASDIC_LEARN_BLOCK + 1) * ASDIC_LEARN_BLOCK;
    asdic_range range = {q->fresh, least(least(q->fresh + q->chunk, block_end), q->end)};
    q->fresh = range.end;
    return range;
}

bool asdic_queue_reserve(asdic_queue *q, size_t count) {
    size_t capacity = q->returned_capacity + count;
    asdic_range *more = realloc(q->returned, capacity * sizeof *more);
    if (more) {
        q->returned = more;
        q->returned_capacity = capacity;
    }
    return more != NULL;
}

void asdic_queue_return(asdic_queue *q, asdic_range range) {
    q->returned[q->returned_count++] = range;
}

void asdic_queue_note_ready(asdic_queue *q) {
    q->ready_s = q->ready_s > 0.0 ? q->ready_s : asdic_clock_s();
}

void asdic_queue_finish_ping(asdic_queue *q, size_t ping) {
    q->slots[ping % q->slot_count].is_ready = true;
    q->remaining--;
    asdic_queue_note_ready(q);
    pthread_cond_broadcast(&q->changed);
}
