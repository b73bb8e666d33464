/*
 * What a command of the asdic program is made of: one table row per command and per option, from
 * which parsing, --help, man pages and completions are made; and the few calls a command needs.
 *
 * To add a command: write cli/cmd_<name>.c with a `const cli_command cli_<name>_command`, declare
 * it in commands.h, add it to commands.c and to cli/meson.build. A command sees public headers
 * only, prints data on stdout and messages through the calls below, and returns an exit code.
 */
#ifndef ASDIC_CLI_H
#define ASDIC_CLI_H

#include <math.h>
#include <stdio.h>
#include <sys/types.h>

#include <asdic/asdic.h>

/* Leaves a function with the status of a call that failed. Where something must be released on the
 * way, the calls stand in a function of their own and the release in its caller. */
#define TRY(call)                                                                                  \
    do {                                                                                           \
        asdic_status try_status = (call);                                                          \
        if (try_status) {                                                                          \
            return try_status;                                                                     \
        }                                                                                          \
    } while (0)

#define CLI_PI 3.14159265358979323846

/* Degrees of RAD without the last digits of a conversion, as track.csv has them. */
static inline double cli_degrees(double rad) {
    return rint(rad * 180.0 / CLI_PI * 1e9) / 1e9;
}

/* Exit codes. An interrupted command ends with 128 + signal. */
#define CLI_OK 0
#define CLI_FAILED 1 /* while running: input and output, memory, device lost */
#define CLI_USAGE 2
#define CLI_INPUT 3  /* bad input file */
#define CLI_DEVICE 4 /* no usable device, or its compiler refused the kernels */

typedef struct cli_option {
    const char *name; /* without dashes; NULL ends a table */
    char letter;      /* 'o' for -o; 0: none */
    const char *arg;  /* what it takes, as shown ("N", "DIR"); NULL: a flag */
    const char *help; /* half a sentence, no full stop */
} cli_option;

typedef struct cli cli;

/* Bits of cli_command.traits. */
#define CLI_HAS_DEVICE 1u      /* takes --device, see cli_open_devices */
#define CLI_HAS_JSON 2u        /* takes --json */
#define CLI_INTERRUPTIBLE 4u   /* asks asdic_context_interrupted: the first signal only asks */
#define CLI_STOPS_SOON 8u      /* ends soon after a signal, where it stands: nothing is lost */
#define CLI_ANY_NUMBER 0xffffu /* of operands */

typedef struct cli_command {
    const char *name;
    const char *operands; /* as shown: "SCENE.yaml"; "" when there are none */
    unsigned min_operands, max_operands;
    const char *summary;       /* one line, no full stop */
    const char *details;       /* paragraphs, wrapped when printed */
    const char *examples;      /* command lines, one a line */
    const cli_option *options; /* its own; NULL: none */
    unsigned traits;
    int (*run)(cli *c);
} cli_command;

/* ---- what was typed -------------------------------------------------------------------------
 * OPTION is the long name of one of the command's options. The last one given counts. The typed
 * calls leave *OUT alone when the option was not given; a bad value is reported at once and makes
 * cli_bad_usage() true, so that a command fetches everything first and then asks once. */

asdic_context *cli_context(const cli *c);

/* A descriptor for poll that hangs up at the first signal that asks to stop; -1 where there is
 * none. */
int cli_signal_fd(void);

/* A program that this one started, and files of theirs. */
typedef struct cli_helper {
    pid_t child;          /* 0: none */
    const char *files[2]; /* up to the first NULL */
} cli_helper;

/* What ends with the program where a signal ends it where it stands; NULL: nothing any more. */
void cli_signals_helper(const cli_helper *now);
/* Programs of a GROUP of their own, which end then too, as long as they RUN. */
void cli_signals_group(pid_t group, bool runs);
/* In a child that becomes another program: signals as this program found them. */
void cli_signals_as_found(void);
size_t cli_operand_count(const cli *c);
const char *cli_operand(const cli *c, size_t index); /* NULL beyond the last */

bool cli_given(const cli *c, const char *option);
/* --force and --resume, of which one excludes the other. */
void cli_mode(cli *c, bool *force, bool *resume);
const char *cli_text(const cli *c, const char *option); /* NULL when not given */
void cli_number(cli *c, const char *option, double low, double high, double *out);
/* A whole number at TEXT that ends at *END; false where there is none, or one beyond 64 bits. */
bool cli_read_integer(const char *text, uint64_t *out, const char **end);
void cli_integer(cli *c, const char *option, uint64_t low, uint64_t high, uint64_t *out);
/* LOW:HIGH; both must lie in [LIMIT_LOW, LIMIT_HIGH], LOW below HIGH. */
void cli_number_range(cli *c, const char *option, double limit_low, double limit_high, double *low,
                      double *high);
/* FIRST:END as in Python: [first, end); "A" is A:A+1; an omitted side keeps *FIRST or *END. */
void cli_index_range(cli *c, const char *option, uint64_t *first, uint64_t *end);
/* The K-th of N equal parts. */
typedef struct cli_part {
    uint64_t k, n;
} cli_part;

/* K/N with 1 <= K <= N <= 1e9; the whole when it was not given. */
cli_part cli_share(cli *c, const char *option);
/* Narrows [*FIRST, *END) to its PART, which may be empty. */
void cli_take_part(cli_part part, uint64_t *first, uint64_t *end);
/* Of a part without any of the TOTAL things to share, WHAT ("pings"), FOLDER stays empty, which 'merge' passes over; NULL:
 * none is made. Returns the exit code. */
int cli_leave_empty(const cli *c, const char *what, uint64_t total, const char *folder);
bool cli_is_left_empty(const char *folder);
/* What --output names, else "PREFIX_NAME" of the scene "path/NAME.yaml", the first operand, with PART
 * where there are several, and ENDING. To be freed; NULL without memory. */
char *cli_output(const cli *c, const char *prefix, cli_part part, const char *ending);
/* The position of the word among WORDS, which end with NULL. */
void cli_choice(cli *c, const char *option, const char *const *words, int *out);
/* What --colormap names. */
void cli_colormap(cli *c, asdic_colormap *out);
/* KEY=VALUE,VALUE,... of --vary: *KEY, to be freed, which the values share; NULL and one value of NULL
 * when it was not given. False after a report. */
bool cli_vary(cli *c, size_t most, char **key, const char **values, size_t *count);
/* For --target: the names in the order of asdic_target, then NULL. */
extern const char *const cli_target_names[];
bool cli_bad_usage(const cli *c);

/* Whether PATH is the standard output: "-" or "/dev/stdout". */
bool cli_is_stdout(const char *path);

/* Whether a file may be written to PATH: none is there, or the command's --force is given and it is none that an operand
 * is or names; so may NULL, the standard output, pipes and devices. False after a report. */
bool cli_may_write(cli *c, const char *path);

/* Creates FOLDER; *IS_NEW: it was not there. False after a report. */
bool cli_make_folder(const cli *c, const char *folder, bool *is_new);

/* An output file, written as PATH.part and renamed when it is whole. "-" is standard output, of
 * which main tells; pipes and devices are written as they are. */
typedef struct cli_file {
    FILE *stream;
    const char *path;
    char *part; /* NULL: there is none */
} cli_file;

/* False after a report. */
bool cli_file_open(const cli *c, const char *path, cli_file *out);

/* Gives a file its name that IS_WHOLE; another is removed. False after a report. */
bool cli_file_close(const cli *c, cli_file *file, bool is_whole);

/* Bytes of PATH before the ending of its file name, ".png". */
size_t cli_stem(const char *path);

/* Whether the file of OPTION, if that is given, is called as a picture, or has no ending. False after a report. */
bool cli_is_picture(cli *c, const char *option);

/* Whether --picture names a picture's file, and another than that of the table at PATH, which may be NULL. False after a
 * report. */
bool cli_picture_is_apart(cli *c, const char *path);

/* The mission of the first operand, with RAYS a ping in place of what its scene says; 0: as it says. */
asdic_status cli_load_rays(cli *c, uint64_t rays, asdic_mission **out);

/* ---- modules --------------------------------------------------------------------------------
 * Parts of the program that few commands need, each with a library that loads dozens of others. NULL
 * after a message. */
void *cli_module(const cli *c, const char *name, const char *function);

/* ---- devices --------------------------------------------------------------------------------
 * Those of --device, else of the environment's ASDIC_DEVICE, else "auto", PoCL having
 * a folder for compiled kernels. Closed with asdic_devices_close. On failure nothing is open; end with cli_end. */
const char *cli_device(cli *c); /* what to open; NULL: "auto" */
asdic_status cli_open_devices(cli *c, asdic_device ***out, size_t *count);

/* ---- messages -------------------------------------------------------------------------------
 * "error: ..." and "warning: ..." on stderr. */
void cli_error(const cli *c, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* One that --quiet does not silence: the results are others than asked for. */
void cli_warning_always(const cli *c, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void cli_warning(const cli *c, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* What follows a word for COUNT things. */
static inline const char *cli_plural(uint64_t count) {
    return count == 1 ? "" : "s";
}
/* Plain text on stderr, unless --quiet was given. */
void cli_note(const cli *c, const char *format, ...) __attribute__((format(printf, 2, 3)));
bool cli_quiet(const cli *c);

/* A wrong command line: reports it, points at --help, returns CLI_USAGE. */
int cli_usage(cli *c, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* The exit code for STATUS; reports the context's sentence when STATUS is a failure. */
int cli_end(const cli *c, asdic_status status);

/* Seconds since some moment; never goes back. */
double cli_clock_s(void);
/* Seconds that processors have spent on all threads: what one needs, whoever else runs. */
double cli_processor_s(void);

#endif
