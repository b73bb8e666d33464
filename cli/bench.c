/* The frame of a bench: command line, device, table; medians, shipped scenes, a picture. */
#include "bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double bench_median(double *values, size_t count) {
    if (count == 0) {
        return NAN;
    }
    qsort(values, count, sizeof *values, compare);
    return 0.5 * (values[(count - 1) / 2] + values[count / 2]);
}

void bench_name(const char *path, char *out, size_t size) {
    const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path;
    const char *dot = strrchr(base, '.');
    snprintf(out, size, "%.*s", (int)(dot && dot != base ? dot - base : (long)strlen(base)), base);
}

void bench_find_data(const char *name, char *out, size_t size) {
    /* Beside bin/, beside build/cli/, and below the folder the user is in. */
    static const char *const places[] = {"/../share/asdic/", "/../../data/", "/../../../data/"};
    const char *given = getenv("ASDIC_DATA");
    if (given && given[0]) {
        snprintf(out, size, "%s/%s", given, name);
        return;
    }
    char program[1024];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    program[length > 0 ? length : 0] = '\0';
    char *slash = strrchr(program, '/');
    if (slash) {
        *slash = '\0';
    }
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        snprintf(out, size, "%s%s%s", program, places[i], name);
        if (access(out, R_OK) == 0) {
            return;
        }
    }
    snprintf(out, size, "data/%s", name);
}

size_t bench_scene_count(const bench *b) {
    size_t count = cli_operand_count(b->c) - 1;
    for (size_t i = 0; count == 0 && b->kind->shipped; i++) {
        if (!b->kind->shipped[i]) {
            return i;
        }
    }
    return count;
}

const char *bench_scene_path(const bench *b, size_t index, char *buffer, size_t size) {
    if (cli_operand_count(b->c) > 1) {
        return cli_operand(b->c, index + 1);
    }
    bench_find_data(b->kind->shipped[index], buffer, size);
    return buffer;
}

asdic_status bench_missions(bench *b, asdic_status (*measure)(bench *b, const char *name,
                                                              asdic_mission *mission)) {
    asdic_status status = ASDIC_OK;
    for (size_t i = 0; !status && i < bench_scene_count(b); i++) {
        char buffer[4096], name[ASDIC_NAME_SIZE];
        const char *path = bench_scene_path(b, i, buffer, sizeof buffer);
        asdic_mission *mission = NULL;
        bench_name(path, name, sizeof name);
        status = asdic_mission_load(cli_context(b->c), path, &mission);
        status = status ? status : measure(b, name, mission);
        asdic_mission_destroy(&mission);
    }
    return status;
}

asdic_status bench_interrupted(const bench *b) {
    return asdic_context_interrupted(cli_context(b->c)) ? ASDIC_ERROR_INTERRUPTED : ASDIC_OK;
}

/* PoCL reads the number of its threads when it starts: THREADS, else what the environment says,
 * else OTHERWISE. */
static unsigned limit_threads(uint64_t threads, unsigned otherwise) {
    char text[16];
    const char *limit = getenv("POCL_MAX_PTHREAD_COUNT");
    int before = limit ? atoi(limit) : 0;
    unsigned wanted = threads ? (unsigned)threads : before > 0 ? (unsigned)before : otherwise;
    if (wanted > 0) {
        snprintf(text, sizeof text, "%u", wanted);
        setenv("POCL_MAX_PTHREAD_COUNT", text, 1);
    }
    return wanted;
}

static int measure(bench *b) {
    asdic_device **devices = NULL;
    size_t device_count = 0;
    asdic_status status = cli_open_devices(b->c, &devices, &device_count);
    if (!status) {
        b->device = devices[0];
        const asdic_device_info *device = asdic_device_get_info(b->device);
        bench_say(b, "%s, %u units\n", device->name, device->compute_units);
        b->table = bench_table_create(b->kind->columns);
        status = b->table ? b->kind->run(b) : ASDIC_ERROR_MEMORY;
    }
    if (!status && !bench_table_is_complete(b->table)) {
        status = ASDIC_ERROR_MEMORY;
    }
    int code = cli_end(b->c, status);
    if (!status && b->json) {
        bench_table_json(b);
    }
    if (!status && cli_given(b->c, "output")) {
        code = bench_table_csv(b, cli_text(b->c, "output"));
    }
    bench_table_destroy(b->table);
    asdic_devices_close(&devices, device_count);
    return code;
}

static const bench_kind *find_kind(const bench_kind *kinds, const char *name) {
    while (kinds->name && strcmp(kinds->name, name) != 0) {
        kinds++;
    }
    return kinds;
}

int bench_run(cli *c, const bench_kind *kinds) {
    const bench_kind *kind = find_kind(kinds, cli_operand(c, 0));
    bench b = {.c = c,
               .kind = kind,
               .quick = cli_given(c, "quick"),
               .json = cli_given(c, "json"),
               .picture = cli_text(c, "picture")};
    const char *output = cli_text(c, "output");
    bool is_stdout = output && cli_is_stdout(output);
    size_t operands = cli_operand_count(c) - 1;
    uint64_t threads = 0;
    cli_integer(c, "threads", 1, 64, &threads);
    if (cli_bad_usage(c)) {
        return CLI_USAGE;
    }
    if (!kind->name) {
        return cli_usage(c, "'%s' is no kind of bench", cli_operand(c, 0));
    }
    if (operands < kind->least) {
        return cli_usage(c, "'bench %s' needs a scene", kind->name);
    }
    if (operands > kind->most) {
        return cli_usage(c, "'bench %s' does not take '%s'", kind->name,
                         cli_operand(c, kind->most + 1));
    }
    if (b.picture && !kind->draws) {
        return cli_usage(c, "'bench %s' draws nothing; -o writes a table", kind->name);
    }
    if (b.picture && operands > kind->draws) {
        return cli_usage(c, "a picture shows %zu scenes at most, not %zu; -o writes a table of all",
                         kind->draws, operands);
    }
    if (cli_given(c, "kernel") && !kind->casts) {
        return cli_usage(c, "--kernel is of rays alone; 'bench %s' times what a ping takes",
                         kind->name);
    }
    if (is_stdout && b.json) {
        return cli_usage(c, "-o - and --json are two tables on standard output; give one of them");
    }
    if (!cli_picture_is_apart(c, output)) {
        return CLI_USAGE;
    }
    if (!cli_may_write(c, b.picture) || !cli_may_write(c, output)) {
        return CLI_FAILED;
    }
    b.is_silent = b.json || is_stdout;
    b.threads = limit_threads(threads, kind->threads);
    return measure(&b);
}

static void widen(const double *values, size_t count, double *low, double *high) {
    for (size_t i = 0; i < count; i++) {
        *low = fmin(*low, values[i]);
        *high = fmax(*high, values[i]);
    }
}

asdic_status bench_scaling_picture(const bench *b, const char *title, const char *abscissa,
                                   asdic_series *curves, size_t count) {
    static const uint32_t colors[] = {0x0072b2, 0x009e73, 0xd55e00, 0xcc79a7};
    double low_x = INFINITY, high_x = 0.0, low_y = INFINITY, high_y = 0.0;
    for (size_t i = 0; i < count; i++) {
        widen(curves[i].x, curves[i].count, &low_x, &high_x);
        widen(curves[i].y, curves[i].count, &low_y, &high_y);
        curves[i].rgb = colors[i % (sizeof colors / sizeof colors[0])];
        curves[i].width = 1.5;
    }
    const asdic_plot_axis x = {
        .label = abscissa, .low = 0.7 * low_x, .high = 1.4 * high_x, .logarithmic = true};
    /* whole decades, so that the axis has marks */
    const asdic_plot_axis y = {.label = "time of a ping (ms)",
                               .low = pow(10.0, floor(log10(0.9 * low_y))),
                               .high = pow(10.0, ceil(log10(1.1 * high_y))),
                               .logarithmic = true};
    const asdic_plot panel = {.x = x, .y = y, .series = curves, .series_count = count};
    asdic_picture_options options = asdic_picture_options_default();
    options.title = title;
    return asdic_picture_plot(cli_context(b->c), b->picture, &panel, 1, &options);
}
