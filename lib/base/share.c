#include "share.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <unistd.h>

unsigned asdic_processors(void) {
    cpu_set_t own;
    long count = sched_getaffinity(0, sizeof own, &own) == 0 ? CPU_COUNT(&own)
                                                             : sysconf(_SC_NPROCESSORS_ONLN);
    return count > 0 ? (unsigned)count : 1;
}

typedef struct share {
    void (*work)(void *user, unsigned worker, size_t first, size_t end);
    void *user;
    size_t count, step;
    atomic_size_t next;
} share;

typedef struct hand {
    share *of;
    unsigned worker;
    bool is_started;
    pthread_t thread;
} hand;

static void *take_parts(void *user) {
    const hand *h = user;
    share *s = h->of;
    for (;;) {
        size_t first = atomic_fetch_add(&s->next, s->step);
        if (first >= s->count) {
            return NULL;
        }
        size_t left = s->count - first;
        s->work(s->user, h->worker, first, first + (left < s->step ? left : s->step));
    }
}

void asdic_share(unsigned threads, size_t count, size_t step,
                 void (*work)(void *user, unsigned worker, size_t first, size_t end), void *user) {
    share s = {.work = work, .user = user, .count = count, .step = step};
    hand hands[ASDIC_SHARE_MOST];
    size_t parts = (count + step - 1) / step;
    threads = threads < ASDIC_SHARE_MOST ? threads : ASDIC_SHARE_MOST;
    threads = threads < parts ? threads : (unsigned)parts;
    for (unsigned i = 1; i < threads; i++) {
        hands[i] = (hand){.of = &s, .worker = i};
        hands[i].is_started = pthread_create(&hands[i].thread, NULL, take_parts, &hands[i]) == 0;
    }
    hands[0] = (hand){.of = &s};
    take_parts(&hands[0]);
    for (unsigned i = 1; i < threads; i++) {
        if (hands[i].is_started) {
            pthread_join(hands[i].thread, NULL);
        }
    }
}
