/* Threads that share nothing but the process, each the first to ask for devices: a driver sets itself up then, and
 * does so once a process, wherefore every round has a process of its own. */
#include "asserts.h"

#include <asdic/device.h>

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#define ROUNDS 6
#define THREADS 4

static pthread_barrier_t start;

/* What the thread's own context was told last, as a number to leave the process with. */
static void *open_devices(void *unused) {
    asdic_context *ctx = NULL;
    asdic_device_info *infos = NULL;
    asdic_device **devices = NULL;
    size_t listed = 0, opened = 0;
    (void)unused;
    pthread_barrier_wait(&start);
    asdic_status status = asdic_context_create(&ctx);
    if (status == ASDIC_OK) {
        status = asdic_device_list(ctx, &infos, &listed);
    }
    if (status == ASDIC_OK) {
        status = asdic_devices_open(ctx, getenv("ASDIC_DEVICE"), &devices, &opened);
    }
    asdic_devices_close(&devices, opened);
    asdic_device_info_free(&infos);
    asdic_context_destroy(&ctx);
    return (void *)(size_t)status;
}

/* The worst status of COUNT threads that begin at once, in a process of their own; -1: it crashed. */
static int open_in(size_t count) {
    pid_t child = fork();
    if (child == 0) {
        pthread_t threads[THREADS];
        size_t worst = 0;
        pthread_barrier_init(&start, NULL, (unsigned)count);
        for (size_t i = 0; i < count; i++) {
            if (pthread_create(&threads[i], NULL, open_devices, NULL) != 0) {
                _exit(ASDIC_ERROR_MEMORY);
            }
        }
        for (size_t i = 0; i < count; i++) {
            void *status = NULL;
            pthread_join(threads[i], &status);
            worst = (size_t)status > worst ? (size_t)status : worst;
        }
        _exit((int)worst);
    }
    int how = -1;
    return child > 0 && waitpid(child, &how, 0) == child && WIFEXITED(how) ? WEXITSTATUS(how) : -1;
}

static void test_threads_open_devices_at_once(void **state) {
    (void)state;
    for (int i = 0; i < ROUNDS; i++) {
        assert_int_equal(open_in(THREADS), ASDIC_OK);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_threads_open_devices_at_once)};
    if (open_in(1) == ASDIC_ERROR_DEVICE) {
        printf("skipped: no OpenCL device was found\n");
        return 77;
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
