/*
 * What the kinds of `asdic bench` share: the frame that runs one, its table, clocks, shipped
 * scenes.
 *
 * A kind is one row: its columns, and a function that measures and adds rows. The frame reads the
 * command line, opens the device, prints rows as they come, and writes JSON and CSV of the same
 * columns. tests/bench/ has a second program with kinds of its own on the same frame.
 */
#ifndef ASDIC_CLI_BENCH_H
#define ASDIC_CLI_BENCH_H

#include "cli.h"

#define BENCH_MOST_DRAWN 8 /* scenes in the picture of errors */

typedef struct bench_column {
    const char *key;     /* in JSON and CSV */
    const char *heading; /* on the screen; NULL: not shown there */
    int width;           /* there; text stands on the left */
    int digits;          /* behind the point */
    double scale;        /* from the value to what the screen shows; 0 is 1 */
} bench_column;

/* A text, or where that is NULL a number; NAN: there is none. */
typedef struct bench_cell {
    const char *text;
    double number;
} bench_cell;

#define BENCH_TEXT(t) ((bench_cell){.text = (t)})
#define BENCH_NUMBER(x) ((bench_cell){.number = (double)(x)})

typedef struct bench_table bench_table;

/* A measurement under way. */
typedef struct bench {
    cli *c;
    asdic_device *device;
    const struct bench_kind *kind;
    bench_table *table;
    bool quick, json;
    bool is_silent;      /* standard output is for JSON or CSV alone */
    unsigned threads;    /* of the device; 0: as many as it likes */
    const char *picture; /* NULL: none */
} bench;

typedef struct bench_kind {
    const char *name;
    const bench_column *columns; /* end with a key of NULL */
    asdic_status (*run)(bench *b);
    const char *const *shipped; /* scenes taken where none is named, then NULL; NULL: none */
    unsigned least, most;       /* operands */
    unsigned threads;           /* of the device unless --threads is given; 0: as it likes */
    size_t draws;               /* scenes that --picture shows at most; 0: none is drawn */
    bool casts;                 /* rays alone: takes --kernel */
} bench_kind;

/* Runs the kind that operand 0 names; KINDS end with a name of NULL. Returns an exit code. */
int bench_run(cli *c, const bench_kind *kinds);

/* How many scenes there are, and the path of one: operands, else what is shipped. */
size_t bench_scene_count(const bench *b);
const char *bench_scene_path(const bench *b, size_t index, char *buffer, size_t size);

/* Loads one scene after the other and measures it. */
asdic_status bench_missions(bench *b, asdic_status (*measure)(bench *b, const char *name,
                                                              asdic_mission *mission));

/* Prints the next row, a cell for each column, and keeps it. */
void bench_add(bench *b, const bench_cell *cells);
/* A line below the rows, on the screen alone. */
void bench_say(const bench *b, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* ASDIC_ERROR_INTERRUPTED after a signal. */
asdic_status bench_interrupted(const bench *b);

/* Sorts VALUES; NAN of none. */
double bench_median(double *values, size_t count);

/* "path/NAME.yaml" to "NAME". */
void bench_name(const char *path, char *out, size_t size);

/* A shipped scene or mesh ("scenes/bench_flat.yaml"): in the folder that the environment's
 * ASDIC_DATA names, in the installed share/asdic, or in the source tree's data; where it is
 * nowhere, the last place looked at. */
void bench_find_data(const char *name, char *out, size_t size);

/* CURVES (at most 4; x, y in ms a ping, count and label are given) over two logarithmic axes. */
asdic_status bench_scaling_picture(const bench *b, const char *title, const char *abscissa,
                                   asdic_series *curves, size_t count);

/* The kinds of `asdic bench`. */
asdic_status bench_error(bench *b);
asdic_status bench_honest(bench *b);
asdic_status bench_loop(bench *b);
asdic_status bench_pings(bench *b);
asdic_status bench_rays(bench *b);
extern const bench_column bench_error_columns[], bench_honest_columns[], bench_loop_columns[],
    bench_pings_columns[], bench_rays_columns[];

/* ---- the table, for the frame --------------------------------------------------------------- */

bench_table *bench_table_create(const bench_column *columns); /* NULL without memory */
void bench_table_destroy(bench_table *t);
bool bench_table_is_complete(const bench_table *t);

/* All rows on stdout. */
void bench_table_json(const bench *b);
/* All rows in a file; an exit code. */
int bench_table_csv(const bench *b, const char *path);

#endif
