/* What reaches the program itself: the command line, its words between line ends; the device
 * selector; the lines that `asdic serve` is sent. */
#include "targets.h"

#include "cli/cli_state.h"
#include "cli/commands.h"
#include "cli/serve.h"
#include "ocl/opencl.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_WORDS 64

/* Reads every value that was given in every way there is. */
static void read_values(cli *c) {
    static const char *const words[] = {"adaptive", "beam", "uniform-sphere", NULL};
    double a = 0.0, b = 0.0;
    uint64_t m = 0, n = UINT64_MAX;
    int choice = 0;
    for (size_t i = 0; i < c->option_count; i++) {
        const char *name = c->options[i]->name;
        cli_number(c, name, -1e9, 1e9, &a);
        cli_integer(c, name, 1, UINT64_MAX, &m);
        cli_number_range(c, name, -1e9, 1e9, &a, &b);
        cli_index_range(c, name, &m, &n);
        cli_share(c, name);
        cli_choice(c, name, words, &choice);
    }
    for (size_t i = 0; i < cli_operand_count(c); i++) {
        if (!cli_operand(c, i)) {
            abort();
        }
    }
}

static void select_devices(asdic_context *ctx, const char *selector) {
    asdic_listed list[3];
    size_t chosen[3], count = 0;
    memset(list, 0, sizeof list);
    for (unsigned i = 0; i < 3; i++) {
        list[i].info.platform = i / 2;
        list[i].info.device = i % 2;
        list[i].info.usable = i != 1;
        strcpy(list[i].info.name, "A GPU");
    }
    if (asdic_listed_select(ctx, list, 3, selector, chosen, &count) == ASDIC_OK &&
        (count == 0 || count > 3)) {
        abort();
    }
}

void fuzz_arguments(const uint8_t *data, size_t size) {
    asdic_context *ctx = NULL;
    char *text = calloc(size + 1, 1), *words[MOST_WORDS + 1] = {NULL};
    int count = 0;
    if (!text || asdic_context_create(&ctx) != ASDIC_OK) {
        free(text);
        return;
    }
    if (size > 0) {
        memcpy(text, data, size);
    }
    char *rest = text;
    for (char *word; count < MOST_WORDS && (word = strsep(&rest, "\n"));) {
        words[count++] = word;
    }
    const cli_command *command = cli_find_command(words[0]);
    cli c;
    cli_begin(&c, ctx, command ? command : &cli_run_command);
    cli_report_begin(&c);
    if (!command) {
        cli_unknown_command(&c, words[0]);
    }
    if (cli_parse(&c, count, words)) {
        read_values(&c);
    }
    select_devices(ctx, words[count - 1]);
    asdic_context_destroy(&ctx);
    free(text);
}

void fuzz_serve(const uint8_t *data, size_t size) {
    serve_reader reader = serve_reader_begin();
    char *text = calloc(size + 1, 1), *rest = text;
    if (text && size > 0) {
        memcpy(text, data, size);
    }
    for (char *line; text && (line = strsep(&rest, "\n"));) {
        serve_request request;
        char why[SERVE_WHY_SIZE] = "";
        serve_line kind = serve_read_line(&reader, line, strlen(line), &request, why);
        if ((kind == SERVE_BAD) != (why[0] != '\0') || reader.fields > SERVE_MAX_FIELDS ||
            (kind == SERVE_POSE &&
             !(isfinite(request.pose.position_m.z) && isfinite(request.pose.yaw_rad)))) {
            abort();
        }
    }
    free(text);
}
