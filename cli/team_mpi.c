/*
 * Messages by MPI. Sends do not wait: a message is kept until MPI has sent it. Nothing here blocks,
 * because MPI libraries spin while they wait and would take a core from the device.
 */
#include "team.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include <mpi.h>

#define TAG 1

typedef struct message {
    struct message *next;
    MPI_Request request;
    char data[];
} message;

typedef struct post_office {
    asdic_context *ctx;
    asdic_team team;
    message *sent;
    char *received;
    size_t capacity;
} post_office;

/* Frees messages that have been sent. */
static void sweep(post_office *p) {
    for (message **at = &p->sent; *at;) {
        int done = 0;
        MPI_Test(&(*at)->request, &done, MPI_STATUS_IGNORE);
        if (done) {
            message *old = *at;
            *at = old->next;
            free(old);
        } else {
            at = &(*at)->next;
        }
    }
}

static asdic_status send_parcel(void *user, unsigned to, const void *data, size_t bytes) {
    post_office *p = user;
    sweep(p);
    message *new = bytes <= INT_MAX ? malloc(sizeof *new + bytes) : NULL;
    if (!new) {
        return ASDIC_ERROR_MEMORY;
    }
    memcpy(new->data, data, bytes);
    if (MPI_Isend(new->data, (int)bytes, MPI_BYTE, (int)to, TAG, MPI_COMM_WORLD, &new->request) !=
        MPI_SUCCESS) {
        free(new);
        return ASDIC_ERROR_IO;
    }
    new->next = p->sent;
    p->sent = new;
    return ASDIC_OK;
}

static asdic_status take_parcel(void *user, unsigned *from, const void **data, size_t *bytes) {
    post_office *p = user;
    MPI_Status about;
    int arrived = 0, length = 0;
    *data = NULL;
    sweep(p);
    if (MPI_Iprobe(MPI_ANY_SOURCE, TAG, MPI_COMM_WORLD, &arrived, &about) != MPI_SUCCESS) {
        return ASDIC_ERROR_IO;
    }
    if (!arrived) {
        return ASDIC_OK;
    }
    MPI_Get_count(&about, MPI_BYTE, &length);
    if ((size_t)length > p->capacity) {
        char *more = realloc(p->received, (size_t)length);
        if (!more) {
            return ASDIC_ERROR_MEMORY;
        }
        p->received = more;
        p->capacity = (size_t)length;
    }
    if (MPI_Recv(p->received, length, MPI_BYTE, about.MPI_SOURCE, TAG, MPI_COMM_WORLD,
                 MPI_STATUS_IGNORE) != MPI_SUCCESS) {
        return ASDIC_ERROR_IO;
    }
    *from = (unsigned)about.MPI_SOURCE;
    *data = p->received;
    *bytes = (size_t)length;
    return ASDIC_OK;
}

asdic_status cli_mpi_begin(asdic_context *ctx, asdic_team **out) {
    int provided = 0, rank = 0, size = 1;
    *out = NULL;
    /* Several threads call, one at a time. */
    if (MPI_Init_thread(NULL, NULL, MPI_THREAD_SERIALIZED, &provided) != MPI_SUCCESS ||
        provided < MPI_THREAD_SERIALIZED) {
        return ASDIC_ERROR_UNSUPPORTED;
    }
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    post_office *p = size > 1 ? calloc(1, sizeof *p) : NULL;
    if (!p) {
        MPI_Finalize();
        return size > 1 ? ASDIC_ERROR_MEMORY : ASDIC_OK;
    }
    p->ctx = ctx;
    p->team = (asdic_team){.rank = (unsigned)rank,
                           .size = (unsigned)size,
                           .send = send_parcel,
                           .receive = take_parcel,
                           .user = p};
    *out = &p->team;
    return ASDIC_OK;
}

void cli_mpi_end(asdic_team **team) {
    post_office *p = (*team)->user;
    while (p->sent) {
        sweep(p);
    }
    MPI_Finalize();
    free(p->received);
    free(p);
    *team = NULL;
}
