/* From the table to getopt_long and back. */
#include "cli_state.h"

#include <getopt.h>
#include <string.h>

/* getopt's value of option I: beyond any letter. */
#define FIRST_VALUE 256

static const cli_option device_option = {"device", 0, "WHICH",
                                         "auto, all, cpu, gpu, acc, P:D[,P:D...] or name:TEXT; "
                                         "default: ASDIC_DEVICE, else auto"};
static const cli_option json_option = {"json", 0, NULL, "print JSON"};
static const cli_option quiet_option = {
    "quiet", 'q', NULL, "print errors only, and where results are others than asked for"};
static const cli_option verbose_option = {"verbose", 'v', NULL,
                                          "tell more; twice: what helps to find faults"};
static const cli_option help_option = {"help", 'h', NULL, "show this help and exit"};

size_t cli_options_of(const cli_command *command, const cli_option *out[CLI_MAX_OPTIONS]) {
    size_t n = 0;
    for (const cli_option *o = command->options; o && o->name; o++) {
        out[n++] = o;
    }
    if (command->traits & CLI_HAS_DEVICE) {
        out[n++] = &device_option;
    }
    if (command->traits & CLI_HAS_JSON) {
        out[n++] = &json_option;
    }
    out[n++] = &quiet_option;
    out[n++] = &verbose_option;
    out[n++] = &help_option;
    return n;
}

void cli_begin(cli *c, asdic_context *ctx, const cli_command *command) {
    memset(c, 0, sizeof *c);
    c->ctx = ctx;
    c->command = command;
    c->option_count = cli_options_of(command, c->options);
}

static void unknown_option(cli *c, const char *typed) {
    const char *names[CLI_MAX_OPTIONS];
    char word[64];
    for (size_t i = 0; i < c->option_count; i++) {
        names[i] = c->options[i]->name;
    }
    snprintf(word, sizeof word, "%.*s", (int)strcspn(typed + 2, "="), typed + 2);
    size_t longer = 0;
    for (size_t i = 0; i < c->option_count; i++) {
        longer += strncmp(names[i], word, strlen(word)) == 0;
    }
    const char *near = cli_nearest(word, names, c->option_count);
    if (longer > 1) {
        cli_usage(c, "option '--%s' is ambiguous", word);
    } else if (near) {
        cli_usage(c, "unknown option '--%s'; did you mean '--%s'?", word, near);
    } else {
        cli_usage(c, "unknown option '--%s'", word);
    }
}

/* Reports an error of getopt_long: a value that an option needs is missing, or one is given that it does not take, or
 * there is no such option. */
static void report_mistake(cli *c, const char *typed) {
    const cli_option *known = NULL;
    if (optopt >= FIRST_VALUE) {
        known = c->options[optopt - FIRST_VALUE];
    }
    for (size_t i = 0; i < c->option_count && !known; i++) {
        if (optopt != 0 && c->options[i]->letter == optopt) {
            known = c->options[i];
        }
    }
    if (known && known->arg) {
        cli_usage(c, "option '--%s' needs a value: %s", known->name, known->arg);
    } else if (known) {
        cli_usage(c, "option '--%s' takes no value", known->name);
    } else if (optopt != 0) {
        cli_usage(c, "unknown option '-%c'", optopt);
    } else {
        unknown_option(c, typed);
    }
}

static void take(cli *c, int result) {
    for (size_t i = 0; i < c->option_count; i++) {
        const cli_option *o = c->options[i];
        if (result == FIRST_VALUE + (int)i || (o->letter && result == o->letter)) {
            c->values[i] = o->arg ? optarg : "";
            if (o == &quiet_option) {
                c->verbosity = -1;
            } else if (o == &verbose_option) {
                c->verbosity = c->verbosity < 0 ? 1 : c->verbosity + (c->verbosity < 2);
            }
        }
    }
}

bool cli_parse(cli *c, int argc, char **argv) {
    struct option rows[CLI_MAX_OPTIONS + 1] = {{0}};
    char letters[2 * CLI_MAX_OPTIONS + 2] = ":"; /* getopt is silent: the words are ours */
    size_t length = 1;
    bool good = true;

    for (size_t i = 0; i < c->option_count; i++) {
        const cli_option *o = c->options[i];
        rows[i].name = o->name;
        rows[i].has_arg = o->arg ? required_argument : no_argument;
        rows[i].val = FIRST_VALUE + (int)i;
        if (o->letter) {
            letters[length++] = o->letter;
            if (o->arg) {
                letters[length++] = ':';
            }
        }
    }
    optind = 0; /* start afresh, glibc's way */
    for (;;) {
        int before = optind > 0 ? optind : 1;
        int result = getopt_long(argc, argv, letters, rows, NULL);
        if (result == -1) {
            break;
        }
        if (result == '?' || result == ':') {
            report_mistake(c, argv[optind > before ? optind - 1 : before]);
            good = false;
            break;
        }
        take(c, result);
    }
    c->operands = argv + optind;
    c->operand_count = (size_t)(argc - optind);
    return good;
}
