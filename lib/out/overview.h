/*
 * The strongest echo of each ping and beam, and its range. Pings and beams too many for a page are
 * grouped, each group showing the strongest of its levels, so that memory does not grow with their
 * number and nothing strong is lost.
 */
#ifndef ASDIC_OUT_OVERVIEW_H
#define ASDIC_OUT_OVERVIEW_H

#include <asdic/output.h>

#define ASDIC_OVERVIEW_MAX_ROWS 1000
#define ASDIC_OVERVIEW_MAX_COLUMNS 600

typedef struct asdic_overview {
    size_t pings, beams, bins;
    double bin_length_m;
    size_t ping_group, beam_group, rows, columns;
    size_t added;     /* pings */
    double *shown_db; /* [rows * columns], with the gain; NAN: no energy */
    double *range_m;  /* of the bin's centre */
    double *gain_db;  /* by bin, 0 until it is set */
} asdic_overview;

asdic_status asdic_overview_init(asdic_context *ctx, size_t pings, size_t beams, size_t bins,
                                 double bin_length_m, asdic_overview *out);
void asdic_overview_finish(asdic_overview *overview);

/* An echo stands at least so much above the noise. */
#define ASDIC_OVERVIEW_ABOVE_NOISE_DB 10.0
/* And so much, and its sampling error, out of its neighbourhood. */
#define ASDIC_OVERVIEW_ABOVE_REST_DB 0.5

/* A time-varied gain that counts in what is strongest; before the first ping. */
void asdic_overview_set_gain(asdic_overview *overview, double db_per_decade, double db_per_m);

/* The next ping, LEVELS_DB[beam * bins + bin], its noise, NAN where there is none, and its sampling
 * errors, NAN where they are not known. */
void asdic_overview_add(asdic_overview *overview, const float *levels_db, const float *noise_db,
                        const float *stderr_db);

/* The window of the levels shown, rounded outwards to 10 dB; 0..10 without levels. */
void asdic_overview_window(const asdic_overview *overview, double *low_db, double *high_db);

/* NAMES of the beams; the time of ping n is FIRST_TIME_S + n PING_PERIOD_S, period 0: pings
 * count. */
typedef struct asdic_overview_axes {
    const char *const *names; /* NULL: beams are numbered */
    double first_time_s, ping_period_s;
} asdic_overview_axes;

asdic_status asdic_draw_overview(asdic_context *ctx, const char *path,
                                 const asdic_overview *overview, const asdic_overview_axes *axes,
                                 const asdic_picture_options *options);

#endif
