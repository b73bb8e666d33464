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

typedef struct helper {
    share *of;
    unsigned worker;
    bool is_started;
    pthread_t thread;
} helper;

static void *take_parts(void *user) {
    const helper *h = user;
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
    helper helpers[ASDIC_SHARE_MOST];
    size_t parts = (count + step - 1) / step;
    threads = threads < ASDIC_SHARE_MOST ? threads : ASDIC_SHARE_MOST;
    threads = threads < parts ? threads : (unsigned)parts;
    for (unsigned i = 1; i < threads; i++) {
        helpers[i] = (helper){.of = &s, .worker = i};
        helpers[i].is_started =
            pthread_create(&helpers[i].thread, NULL, take_parts, &helpers[i]) == 0;
    }
    helpers[0] = (helper){.of = &s};
    take_parts(&helpers[0]);
    for (unsigned i = 1; i < threads; i++) {
        if (helpers[i].is_started) {
            pthread_join(helpers[i].thread, NULL);
        }
    }
}
