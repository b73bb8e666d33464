#include "format.h"

#include "base/context.h"
#include "base/try.h"

#include <dirent.h>
#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

enum { RECORD = 'r', COMMIT = 'c', DISCARD = 'd' };

/* What the process says once it has opened the file, and after each order. */
typedef struct answer {
    asdic_status status;
    char why[768];
} answer;

typedef struct process {
    asdic_context *ctx;
    char *path;
    pid_t pid;     /* 0: none */
    int socket;    /* to the other one */
    bool is_asked; /* an answer is due */
    void *record;  /* shared, asdic_record_bytes */
    size_t beams, bins;
} process;

/* --- the process that writes -------------------------------------------------------------------- */

/* Nothing that the caller closes stays open here; locks would outlive him. */
static void close_others(int keep) {
    DIR *folder = opendir("/proc/self/fd");
    const struct dirent *entry;
    while (folder && (entry = readdir(folder))) {
        int fd = (int)strtol(entry->d_name, NULL, 10);
        if (fd > STDERR_FILENO && fd != keep && fd != dirfd(folder)) {
            close(fd);
        }
    }
    if (folder) {
        closedir(folder);
    }
}

static void tell(const process *p, asdic_context *ctx, asdic_status status) {
    answer a = {.status = status};
    snprintf(a.why, sizeof a.why, "%s", status ? asdic_context_error(ctx) : "");
    send(p->socket, &a, sizeof a, MSG_NOSIGNAL);
}

/* Follows orders until the last one. Without one, the caller was killed: what is left of the file is as if he had
 * written it himself. */
static void serve(const process *p, const asdic_format *format, const asdic_format_about *about) {
    asdic_context *ctx = NULL; /* the caller's may be locked by a thread that is not here */
    void *file = NULL;
    char order = RECORD;
    asdic_status status = asdic_context_create(&ctx);
    status = status ? status : format->open(ctx, p->path, about, &file);
    tell(p, ctx, status);
    while (!status && order == RECORD && recv(p->socket, &order, 1, 0) == 1) {
        asdic_record record;
        asdic_record_view(p->record, p->beams, p->bins, &record);
        status = order == RECORD   ? format->write(file, &record)
                 : order == COMMIT ? format->commit(&file)
                                   : ASDIC_OK;
        if (status || order == DISCARD) {
            format->discard(&file);
        }
        tell(p, ctx, status);
    }
}

/* --- the caller's ------------------------------------------------------------------------------- */

/* False: an answer is due and does not come. None is due: that all is well. */
static bool receive(process *p, answer *a) {
    ssize_t got = 0;
    *a = (answer){.status = ASDIC_OK};
    if (!p->is_asked) {
        return true;
    }
    p->is_asked = false;
    while ((got = recv(p->socket, a, sizeof *a, MSG_WAITALL)) < 0 && errno == EINTR) {
    }
    return got == sizeof *a;
}

static asdic_status hear(process *p) {
    answer a;
    return !receive(p, &a)
               ? asdic_fail(p->ctx, ASDIC_ERROR_IO,
                            "cannot write '%s': the process that writes it has ended", p->path)
           : a.status ? asdic_fail(p->ctx, a.status, "%s", a.why)
                      : ASDIC_OK;
}

/* One that cannot be given shows as an answer that does not come. */
static void ask(process *p, char order) {
    send(p->socket, &order, 1, MSG_NOSIGNAL);
    p->is_asked = true;
}

static void process_end(process *p) {
    if (p->socket >= 0) {
        close(p->socket);
    }
    while (p->pid > 0 && waitpid(p->pid, NULL, 0) < 0 && errno == EINTR) {
    }
    if (p->record != MAP_FAILED) {
        munmap(p->record, asdic_record_bytes(p->beams, p->bins));
    }
    free(p->path);
    free(p);
}

/* Signals are the caller's to heed, and a size beyond the limit must be an error here, no signal. */
static asdic_status start(process *p, const asdic_format *format, const asdic_format_about *about) {
    int sockets[2];
    sigset_t all, before;
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets) != 0) {
        return asdic_fail(p->ctx, ASDIC_ERROR_IO, "cannot write '%s': %s", p->path,
                          strerror(errno));
    }
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    p->pid = fork();
    if (p->pid == 0) {
        p->socket = sockets[1];
        close(sockets[0]); /* by it the caller's end shows; it may be one of the first three */
        close_others(p->socket);
        serve(p, format, about);
        _exit(0); /* buffers of the caller's and the library's are not for this process to flush */
    }
    int error = errno;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    close(sockets[1]);
    p->socket = sockets[0];
    p->is_asked = true;
    return p->pid > 0
               ? hear(p)
               : asdic_fail(p->ctx, ASDIC_ERROR_MEMORY, "cannot write '%s': no process for it: %s",
                            p->path, strerror(error));
}

asdic_status asdic_format_process_open(asdic_context *ctx, const asdic_format *format,
                                       const char *path, const asdic_format_about *about,
                                       void **out) {
    process *p = *out = calloc(1, sizeof *p);
    if (!p) {
        return asdic_fail_memory(ctx, "a file's process");
    }
    *p = (process){.ctx = ctx,
                   .path = strdup(path),
                   .socket = -1,
                   .beams = about->sonar->receiver_count,
                   .bins = about->bins};
    p->record = mmap(NULL, asdic_record_bytes(p->beams, p->bins), PROT_READ | PROT_WRITE,
                     MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    asdic_status status = p->path && p->record != MAP_FAILED
                              ? start(p, format, about)
                              : asdic_fail_memory(ctx, "a file's process");
    if (status) {
        process_end(p);
        *out = NULL;
    }
    return status;
}

asdic_status asdic_format_process_write(void *file, const asdic_record *record) {
    process *p = file;
    TRY(hear(p));
    asdic_record_copy(record, p->beams, p->bins, p->record);
    ask(p, RECORD);
    return ASDIC_OK;
}

asdic_status asdic_format_process_commit(void **file) {
    process *p = *file;
    asdic_status status = hear(p);
    if (!status) {
        ask(p, COMMIT);
        status = hear(p);
    }
    process_end(p);
    *file = NULL;
    return status;
}

void asdic_format_process_discard(void **file) {
    process *p = *file;
    answer unheard;
    if (p) {
        receive(p, &unheard);
        ask(p, DISCARD);
        receive(p, &unheard);
        process_end(p);
        *file = NULL;
    }
}
