/*
 * Preloaded: positioned reads and writes do half of what is asked, at most 100 bytes, and every third is
 * interrupted before it does anything, as a file system on a network may do.
 */
#include <errno.h>
#include <sys/syscall.h>
#include <unistd.h>

#define MOST_BYTES 100

/* How much this call does; 0: it is interrupted. */
static size_t share(size_t length) {
    static unsigned calls;
    size_t half = (length + 1) / 2;
    if (__atomic_add_fetch(&calls, 1, __ATOMIC_RELAXED) % 3 == 0) {
        errno = EINTR;
        return 0;
    }
    return half < MOST_BYTES ? half : MOST_BYTES;
}

ssize_t pwrite64(int fd, const void *bytes, size_t length, off64_t offset) {
    size_t now = share(length);
    return now > 0 ? syscall(SYS_pwrite64, fd, bytes, now, offset) : -1;
}

ssize_t pread64(int fd, void *bytes, size_t length, off64_t offset) {
    size_t now = share(length);
    return now > 0 ? syscall(SYS_pread64, fd, bytes, now, offset) : -1;
}
