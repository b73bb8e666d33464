/* Typed arguments as values. The program never leaves the "C" locale, so strtod is safe. */
#include "cli_state.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

asdic_context *cli_context(const cli *c) {
    return c->ctx;
}

size_t cli_operand_count(const cli *c) {
    return c->operand_count;
}

const char *cli_operand(const cli *c, size_t index) {
    return index < c->operand_count ? c->operands[index] : NULL;
}

const char *cli_text(const cli *c, const char *option) {
    for (size_t i = 0; i < c->option_count; i++) {
        if (strcmp(c->options[i]->name, option) == 0) {
            return c->values[i];
        }
    }
    abort(); /* the command asks for an option that its table lacks */
}

bool cli_given(const cli *c, const char *option) {
    return cli_text(c, option) != NULL;
}

void cli_mode(cli *c, bool *force, bool *resume) {
    *force = cli_given(c, "force");
    *resume = cli_given(c, "resume");
    if (*force && *resume) {
        cli_usage(c, "--force starts afresh and --resume goes on; give one of them");
    }
}

bool cli_bad_usage(const cli *c) {
    return c->bad_usage;
}

bool cli_is_stdout(const char *path) {
    return strcmp(path, "-") == 0 || strcmp(path, "/dev/stdout") == 0;
}

bool cli_may_write(cli *c, const char *path) {
    struct stat st;
    if (!path || cli_is_stdout(path) || stat(path, &st) != 0 || !S_ISREG(st.st_mode)) {
        return true;
    }
    for (size_t i = 0; i < c->operand_count; i++) {
        if (asdic_scene_reads(c->operands[i], path)) {
            cli_error(c, "'%s' is '%s', or a file that it names; choose another file", path,
                      c->operands[i]);
            return false;
        }
    }
    if (!cli_given(c, "force")) {
        cli_error(c, "'%s' exists; --force overwrites it", path);
    }
    return cli_given(c, "force");
}

size_t cli_stem(const char *path) {
    const char *name = strrchr(path, '/'), *dot = strrchr(name ? name : path, '.');
    return dot ? (size_t)(dot - path) : strlen(path);
}

bool cli_is_picture(cli *c, const char *option) {
    static const char *const endings[] = {"", ".png", ".pdf", ".svg"};
    const char *path = cli_text(c, option), *ending = path ? path + cli_stem(path) : "";
    for (size_t i = 0; i < sizeof endings / sizeof *endings; i++) {
        if (strcasecmp(ending, endings[i]) == 0) {
            return true;
        }
    }
    cli_usage(c, "--%s %s: a picture is a file in .png, .pdf or .svg", option, path);
    return false;
}

bool cli_picture_is_apart(cli *c, const char *path) {
    const char *picture = cli_text(c, "picture");
    if (picture && (cli_is_stdout(picture) || (path && strcmp(picture, path) == 0))) {
        cli_usage(c, "--picture %s: a picture goes to a file of its own", picture);
        return false;
    }
    return cli_is_picture(c, "picture");
}

static void bad(cli *c, const char *option, const char *expected) {
    cli_error(c, "option '--%s': '%s' is not %s", option, cli_text(c, option), expected);
    c->bad_usage = true;
}

/* A finite number at TEXT that ends at *END. */
static bool read_number(const char *text, double *out, const char **end) {
    char *stop;
    if (isspace((unsigned char)text[0])) {
        return false;
    }
    *out = strtod(text, &stop);
    *end = stop;
    return stop != text && isfinite(*out);
}

bool cli_read_integer(const char *text, uint64_t *out, const char **end) {
    char *stop;
    if (!isdigit((unsigned char)text[0])) {
        return false;
    }
    errno = 0;
    *out = strtoull(text, &stop, 10);
    *end = stop;
    return errno == 0;
}

void cli_number(cli *c, const char *option, double low, double high, double *out) {
    const char *text = cli_text(c, option), *end;
    double value;
    char expected[96];
    if (!text) {
        return;
    }
    if (!read_number(text, &value, &end) || *end != '\0' || value < low || value > high) {
        snprintf(expected, sizeof expected, "a number in [%g, %g]", low, high);
        bad(c, option, expected);
        return;
    }
    *out = value;
}

void cli_integer(cli *c, const char *option, uint64_t low, uint64_t high, uint64_t *out) {
    const char *text = cli_text(c, option), *end;
    uint64_t value;
    char expected[96];
    if (!text) {
        return;
    }
    if (!cli_read_integer(text, &value, &end) || *end != '\0' || value < low || value > high) {
        snprintf(expected, sizeof expected, "a whole number in [%llu, %llu]",
                 (unsigned long long)low, (unsigned long long)high);
        bad(c, option, expected);
        return;
    }
    *out = value;
}

void cli_number_range(cli *c, const char *option, double limit_low, double limit_high, double *low,
                      double *high) {
    const char *text = cli_text(c, option), *end;
    double a, b;
    char expected[128];
    if (!text) {
        return;
    }
    if (!read_number(text, &a, &end) || *end != ':' || !read_number(end + 1, &b, &end) ||
        *end != '\0' || a >= b || a < limit_low || b > limit_high) {
        snprintf(expected, sizeof expected, "LOW:HIGH with %g <= LOW < HIGH <= %g", limit_low,
                 limit_high);
        bad(c, option, expected);
        return;
    }
    *low = a;
    *high = b;
}

void cli_index_range(cli *c, const char *option, uint64_t *first, uint64_t *end) {
    const char *text = cli_text(c, option);
    uint64_t a = *first, b = *end;
    bool good = true;
    if (!text) {
        return;
    }
    if (*text != ':') {
        good = cli_read_integer(text, &a, &text);
        if (good && *text == '\0') {
            b = a + 1;
        }
    }
    if (good && *text == ':') {
        text++;
        if (*text != '\0') {
            good = cli_read_integer(text, &b, &text);
        }
    }
    if (!good || *text != '\0' || a >= b) {
        bad(c, option, "FIRST:END with FIRST < END, counted from 0, END left out");
        return;
    }
    *first = a;
    *end = b;
}

/* Of a share: as many as there are pings or runs at most. Their product with these fits 64 bits. */
#define MOST_SHARES 1000000000u

cli_part cli_share(cli *c, const char *option) {
    const char *text = cli_text(c, option), *end;
    cli_part part = {1, 1};
    if (text && (!cli_read_integer(text, &part.k, &end) || *end != '/' ||
                 !cli_read_integer(end + 1, &part.n, &end) || *end != '\0' || part.k < 1 ||
                 part.k > part.n || part.n > MOST_SHARES)) {
        bad(c, option, "K/N with 1 <= K <= N <= 1000000000");
        return (cli_part){1, 1};
    }
    return part;
}

void cli_take_part(cli_part part, uint64_t *first, uint64_t *end) {
    uint64_t all = *end - *first;
    *end = *first + all * part.k / part.n;
    *first += all * (part.k - 1) / part.n;
}

char *cli_output(const cli *c, const char *prefix, cli_part part, const char *ending) {
    const char *given = cli_text(c, "output");
    char *name = given ? strdup(given) : asdic_scene_name(cli_operand(c, 0)), *out = NULL;
    char which[48] = "";
    if (given || !name) {
        return name;
    }
    if (part.n > 1) {
        snprintf(which, sizeof which, "_%llu_of_%llu", (unsigned long long)part.k,
                 (unsigned long long)part.n);
    }
    int length = asprintf(&out, "%s_%s%s%s", prefix, name, which, ending);
    free(name);
    return length < 0 ? NULL : out;
}

const char *const cli_target_names[] = {"swerling0", "swerling1", "swerling3", "swerling2", NULL};

void cli_choice(cli *c, const char *option, const char *const *words, int *out) {
    const char *text = cli_text(c, option);
    char expected[256] = "one of";
    size_t count = 0;
    if (!text) {
        return;
    }
    for (; words[count]; count++) {
        if (strcmp(words[count], text) == 0) {
            *out = (int)count;
            return;
        }
        size_t length = strlen(expected);
        snprintf(expected + length, sizeof expected - length, "%s %s", count ? "," : "",
                 words[count]);
    }
    const char *near = cli_nearest(text, words, count);
    if (near) {
        size_t length = strlen(expected);
        snprintf(expected + length, sizeof expected - length, "; did you mean '%s'?", near);
    }
    bad(c, option, expected);
}

void cli_colormap(cli *c, asdic_colormap *out) {
    const char *maps[ASDIC_COLORMAP_COUNT + 1] = {0};
    int map = (int)*out;
    for (int i = 0; i < ASDIC_COLORMAP_COUNT; i++) {
        maps[i] = asdic_colormap_name((asdic_colormap)i);
    }
    cli_choice(c, "colormap", maps, &map);
    *out = (asdic_colormap)map;
}

asdic_status cli_load_rays(cli *c, uint64_t rays, asdic_mission **out) {
    char digits[24];
    snprintf(digits, sizeof digits, "%llu", (unsigned long long)rays);
    const asdic_setting chosen = {"sampling.rays", digits};
    return asdic_mission_load_with(cli_context(c), cli_operand(c, 0), &chosen, rays ? 1 : 0, out);
}

const char *cli_device(cli *c) {
    const char *selector = cli_text(c, "device");
    asdic_kernel_cache_prepare(cli_context(c));
    return selector ? selector : getenv("ASDIC_DEVICE");
}

asdic_status cli_open_devices(cli *c, asdic_device ***out, size_t *count) {
    return asdic_devices_open(c->ctx, cli_device(c), out, count);
}

/* Behind the value at TEXT: commas in a list or map are its own. */
static char *end_of_value(char *text) {
    char *end = text;
    for (int depth = 0; *end && (depth > 0 || *end != ','); end++) {
        depth += (*end == '[' || *end == '{') - (*end == ']' || *end == '}');
        if (!end[1] && depth > 0) { /* no list, but a name */
            return text + strcspn(text, ",");
        }
    }
    return end;
}

bool cli_vary(cli *c, size_t most, char **key, const char **values, size_t *count) {
    const char *text = cli_text(c, "vary");
    *count = text ? 0 : 1;
    *key = NULL;
    if (!text) {
        return true;
    }
    char *whole = *key = strdup(text), *next = whole ? strchr(whole, '=') : NULL;
    if (!next || next == whole || next[1] == 0) {
        cli_usage(c, "option '--vary': '%s' is not KEY=VALUE,VALUE,...", text);
        return false;
    }
    *next++ = 0;
    while (next) {
        char *value = next, *end = end_of_value(value);
        next = *end ? end + 1 : NULL;
        *end = 0;
        if (*value == 0 || *count == most) {
            cli_usage(c, "option '--vary': 1 to %zu values, none of them empty", most);
            return false;
        }
        values[(*count)++] = value;
    }
    return true;
}
