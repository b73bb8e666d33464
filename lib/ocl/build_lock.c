#include "opencl.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/file.h>
#include <time.h>
#include <unistd.h>

/* A process that holds the lock longer hangs; building without the lock beats waiting. */
#define PATIENCE_MS 60000
#define STEP_MS 2

static int open_cache(void) {
    char path[ASDIC_CACHE_SIZE];
    return asdic_cache_folder(path) ? open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC) : -1;
}

int asdic_build_lock(const asdic_device *device) {
    const struct timespec step = {.tv_nsec = STEP_MS * 1000000};
    if (!asdic_driver_is_pocl(&device->info)) {
        return -1;
    }
    int fd = open_cache();
    for (int waited_ms = 0; fd >= 0 && flock(fd, LOCK_EX | LOCK_NB) != 0; waited_ms += STEP_MS) {
        if (errno != EWOULDBLOCK || waited_ms >= PATIENCE_MS) {
            close(fd);
            return -1;
        }
        nanosleep(&step, NULL);
    }
    return fd;
}

void asdic_build_unlock(int lock) {
    if (lock >= 0) {
        close(lock); /* a lock of flock() ends with the last descriptor of its file */
    }
}
