/*
 * Leaving a function with the status of a call that failed. Where something must be released on the
 * way, the calls stand in a function of their own and the release in its caller.
 */
#ifndef ASDIC_BASE_TRY_H
#define ASDIC_BASE_TRY_H

#define TRY(call)                                                                                  \
    do {                                                                                           \
        asdic_status try_status = (call);                                                          \
        if (try_status) {                                                                          \
            return try_status;                                                                     \
        }                                                                                          \
    } while (0)

#endif
