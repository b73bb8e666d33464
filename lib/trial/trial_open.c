/*
 * A trial from the disk, and its figures.
 */
#include "trial_folder.h"

#include "base/context.h"
#include "base/file_name.h"
#include "base/file_read.h"
#include "base/number.h"
#include "base/problems.h"
#include "base/try.h"
#include "mission/scene_file/yaml_tree.h"

#include "../../kernels/detection.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LEVEL 0.95
#define TAIL (0.5 * (1.0 - LEVEL))
/* Runs whose spread is taken to be that of independent events, beside those that were flown. */
#define MORE_RUNS 3.0
#define MOST_BYTES ((size_t)1 << 32)

/* --- figures ----------------------------------------------------------------------------------- */

static bool counts(const trial_row *row) {
    return row->flown.outcome < ASDIC_TRIAL_VOID;
}

/* A bound of the mean of a Poisson variate that was EVENTS, 1 or more (Garwood, Biometrika 28, 437
 * (1936)). */
static double poisson_bound(double events, bool upper) {
    double low = 0.0, high = events + 12.0 * sqrt(events) + 30.0;
    for (int i = 0; i < 60; i++) {
        double middle = 0.5 * (low + high), below = poisson_below(events + upper, middle);
        bool is_beyond = upper ? below < TAIL : 1.0 - below > TAIL;
        *(is_beyond ? &high : &low) = middle;
    }
    return 0.5 * (low + high);
}

/* Needless manoeuvres over kilometres, a ratio of sums: its variance is that of the runs' residuals
 * (Cochran, Sampling Techniques, 3rd ed. (1977), equation (6.4)). EACH is that over the variance of
 * independent events, of which there are then as many fewer or more; few runs tell little of a spread
 * below theirs, which some more are taken to have. Of none at all the upper bound is that of a Poisson
 * law, -ln(0.025) events. */
static asdic_trial_figure rate_of(const asdic_trial *t, size_t variant, double events, double km,
                                  double runs) {
    double rate = km > 0.0 ? events / km : NAN, squares = 0.0;
    if (events == 0.0) {
        return (asdic_trial_figure){rate, 0.0, -log(TAIL) / km};
    }
    for (size_t i = 0; i < t->row_count; i++) {
        const asdic_trial_run *r = &t->rows[i].flown;
        if (t->rows[i].variant == variant && counts(&t->rows[i])) {
            double off = r->needless - rate * r->distance_m / 1000.0;
            squares += off * off;
        }
    }
    if (runs < 2.0) {
        return (asdic_trial_figure){rate, 0.0, INFINITY};
    }
    double each = squares * runs / (runs - 1.0) / events;
    each = fmax(each, (each * (runs - 1.0) + MORE_RUNS) / (runs - 1.0 + MORE_RUNS));
    double independent = fmax(round(events / each), 1.0);
    return (asdic_trial_figure){rate, rate * poisson_bound(independent, false) / independent,
                                rate * poisson_bound(independent, true) / independent};
}

static void count_variant(asdic_trial *t, size_t variant) {
    asdic_trial_result *out = &t->results[variant];
    uint64_t events = 0, with = 0;
    *out = (asdic_trial_result){.least_clearance_m = INFINITY,
                                .mcnemar = NAN,
                                .paired_share = NAN,
                                .difference = {NAN, NAN, NAN}};
    for (size_t i = 0; i < t->row_count; i++) {
        const asdic_trial_run *r = &t->rows[i].flown;
        if (t->rows[i].variant != variant) {
            continue;
        }
        out->outcomes[r->outcome]++;
        out->causes[r->cause]++;
        if (counts(&t->rows[i])) {
            out->runs++;
            out->pings += r->pings;
            out->km += r->distance_m / 1000.0;
            out->least_clearance_m = fmin(out->least_clearance_m, r->clearance_m);
            events += r->needless;
            with += r->needless > 0;
        }
    }
    out->collision = asdic_trial_share(out->outcomes[ASDIC_TRIAL_HIT], out->runs, LEVEL);
    out->needless = asdic_trial_share(with, out->runs, LEVEL);
    out->needless_per_km = rate_of(t, variant, (double)events, out->km, (double)out->runs);
}

/* VARIANT against the first, over the runs that both flew. */
static void compare(asdic_trial *t, size_t variant) {
    asdic_trial_result *out = &t->results[variant];
    uint64_t pairs = 0, both = 0, first = 0, second = 0;
    for (size_t i = 0; i + t->facts.variants <= t->row_count; i += t->facts.variants) {
        const trial_row *a = &t->rows[i], *b = &t->rows[i + variant];
        if (!counts(a) || !counts(b)) {
            continue;
        }
        bool hit_a = a->flown.outcome == ASDIC_TRIAL_HIT;
        bool hit_b = b->flown.outcome == ASDIC_TRIAL_HIT;
        pairs++;
        both += hit_a && hit_b;
        first += hit_b && !hit_a;
        second += hit_a && !hit_b;
    }
    out->difference = asdic_trial_paired(first, second, pairs, LEVEL);
    out->mcnemar = asdic_trial_mcnemar(first, second);
    if (pairs > 0) {
        double n = (double)pairs, d = out->difference.value;
        double a = (double)(both + second) / n, b = (double)(both + first) / n;
        double apart = a * (1.0 - a) + b * (1.0 - b);
        out->paired_share = apart > 0.0 ? ((double)(first + second) / n - d * d) / apart : NAN;
    }
}

/* --- reading ----------------------------------------------------------------------------------- */

static asdic_status damaged(asdic_context *ctx, const char *path, const char *why) {
    return asdic_fail(ctx, ASDIC_ERROR_INPUT, "%s: %s; fly the trial again with --force", path,
                      why);
}

/* What is wrong with PATH, by the STATUS of reading it. */
static asdic_status tell(asdic_context *ctx, asdic_status status, const char *path,
                         const char *why) {
    return status == ASDIC_ERROR_MEMORY ? asdic_fail_memory(ctx, path)
           : status                     ? damaged(ctx, path, why)
                                        : ASDIC_OK;
}

static uint64_t whole_number(const asdic_yaml_node *root, const char *key) {
    const asdic_yaml_node *node = asdic_yaml_child(root, key);
    return node && node->kind == ASDIC_YAML_SCALAR ? strtoull(node->text, NULL, 10) : 0;
}

static void copy_text(const asdic_yaml_node *root, const char *key, char *out, size_t size) {
    const asdic_yaml_node *node = asdic_yaml_child(root, key);
    if (node && node->kind == ASDIC_YAML_SCALAR) {
        snprintf(out, size, "%s", node->text);
    }
}

static asdic_status take_facts(const asdic_yaml_node *root, trial_facts *f) {
    const asdic_yaml_node *key = asdic_yaml_child(root, "key");
    const asdic_yaml_node *values = asdic_yaml_child(root, "values");
    const asdic_yaml_node *rule = asdic_yaml_child(root, "rule");
    const asdic_yaml_node *command = asdic_yaml_child(root, "command");
    bool is_program = rule && rule->text && strcmp(rule->text, "program") == 0;
    *f = (trial_facts){.seed = whole_number(root, "seed"),
                       .runs = whole_number(root, "runs"),
                       .first = whole_number(root, "first"),
                       .count = whole_number(root, "count"),
                       .rays = (uint32_t)whole_number(root, "rays")};
    copy_text(root, "scene", f->scene, sizeof f->scene);
    copy_text(root, "hash", f->hash, sizeof f->hash);
    f->key = key && key->text ? strdup(key->text) : NULL;
    f->rule = is_program ? strdup(command && command->text ? command->text : "") : NULL;
    f->variants = key ? 0 : 1;
    bool is_there = (f->key || !key || !key->text) && (f->rule || !is_program);
    for (const asdic_yaml_node *v = values ? values->first : NULL;
         key && v && f->variants < ASDIC_TRIAL_MOST_VARIANTS; v = v->next) {
        f->values[f->variants] = strdup(v->text ? v->text : "");
        is_there &= f->values[f->variants++] != NULL;
    }
    bool is_good = (!key || key->text) && f->variants > 0 && f->runs > 0 && f->hash[0];
    return !is_there ? ASDIC_ERROR_MEMORY : is_good ? ASDIC_OK : ASDIC_ERROR_INPUT;
}

static asdic_status read_facts(asdic_context *ctx, const char *path, trial_facts *out) {
    char *text = NULL;
    size_t bytes = 0;
    asdic_arena arena = {0};
    asdic_problems problems = {.name = path};
    asdic_yaml_node *root = NULL;
    TRY(asdic_file_read(ctx, path, 16 << 20, &text, &bytes));
    asdic_status status = !asdic_yaml_read(text, bytes, &arena, &problems, &root)
                              ? ASDIC_ERROR_MEMORY
                          : root && problems.total == 0 ? take_facts(root, out)
                                                        : ASDIC_ERROR_INPUT;
    free(text);
    asdic_problems_finish(&problems);
    asdic_arena_finish(&arena);
    return tell(ctx, status, path, "this is no trial.json");
}

static int find_word(const char *word, const char *(*name)(int), int count) {
    for (int i = 0; i < count; i++) {
        if (strcmp(name(i), word) == 0) {
            return i;
        }
    }
    return -1;
}

static const char *outcome_name(int i) {
    return asdic_trial_outcome_name((asdic_trial_outcome)i);
}

static const char *cause_name(int i) {
    return asdic_trial_cause_name((asdic_trial_cause)i);
}

/* A field of the row, cut out of it; the draws behind the last that is read may hold commas. */
static char *cut(char **at) {
    char *field = *at, *end = field + strcspn(field, ",");
    *at = end + (*end != '\0');
    *end = '\0';
    return field;
}

static bool read_row(char *line, trial_row *row) {
    char *field[12];
    for (int i = 0; i < 12; i++) {
        field[i] = cut(&line);
    }
    int outcome = find_word(field[2], outcome_name, ASDIC_TRIAL_OUTCOMES);
    int cause = find_word(field[3], cause_name, ASDIC_TRIAL_CAUSES);
    *row = (trial_row){.run = strtoull(field[0], NULL, 10),
                       .variant = strtoull(field[1], NULL, 10),
                       .flown = {.outcome = (asdic_trial_outcome)outcome,
                                 .cause = (asdic_trial_cause)cause,
                                 .time_s = strtod(field[5], NULL),
                                 .distance_m = strtod(field[6], NULL),
                                 .pings = strtoull(field[7], NULL, 10),
                                 .clearance_m = *field[8] ? strtod(field[8], NULL) : INFINITY,
                                 .manoeuvres = (unsigned)strtoul(field[9], NULL, 10),
                                 .needless = (unsigned)strtoul(field[10], NULL, 10),
                                 .seen_m = *field[11] ? strtod(field[11], NULL) : NAN}};
    snprintf(row->flown.what, sizeof row->flown.what, "%s", field[4]);
    return outcome >= 0 && cause >= 0;
}

/* The rows of TEXT behind its header, which must be those that the facts ask for, one after the other. */
static asdic_status take_rows(asdic_trial *t, const char *text) {
    size_t lines = 0;
    for (const char *c = text; *c; c++) {
        lines += *c == '\n';
    }
    if (lines == 0) {
        return ASDIC_ERROR_INPUT;
    }
    const char *rows = strchr(text, '\n') + 1;
    t->rows = calloc(lines, sizeof *t->rows);
    t->header = strndup(text, (size_t)(rows - text));
    t->body = strdup(rows);
    char *copy = strdup(rows), *at = copy;
    if (!t->rows || !t->header || !t->body || !copy) {
        free(copy);
        return ASDIC_ERROR_MEMORY;
    }
    bool good = true;
    for (char *end; good && (end = strchr(at, '\n')); at = end + 1) {
        trial_row *row = &t->rows[t->row_count];
        *end = '\0';
        good = read_row(at, row) && row->run == t->facts.first + t->row_count / t->facts.variants &&
               row->variant == t->row_count % t->facts.variants;
        t->row_count += good;
    }
    if (good) {
        t->body[at - copy] = '\0'; /* what is behind the last whole row */
    }
    free(copy);
    return good ? ASDIC_OK : ASDIC_ERROR_INPUT;
}

static bool name_variants(asdic_trial *t) {
    const trial_facts *f = &t->facts;
    for (size_t i = 0; i < f->variants; i++) {
        int length = f->key ? asprintf(&t->names[i], "%s = %s", f->key, f->values[i])
                            : asprintf(&t->names[i], "%s", f->scene);
        if (length < 0) {
            t->names[i] = NULL;
            return false;
        }
    }
    return true;
}

static asdic_status read_all(asdic_context *ctx, const char *folder, bool part, asdic_trial *t) {
    const asdic_file_name csv = asdic_file_in(folder, part ? "trial.part.csv" : "trial.csv");
    char *text = NULL;
    size_t bytes = 0;
    TRY(read_facts(ctx, asdic_file_in(folder, part ? "trial.part.json" : "trial.json").text,
                   &t->facts));
    TRY(asdic_file_read(ctx, csv.text, MOST_BYTES, &text, &bytes));
    asdic_status status =
        tell(ctx, take_rows(t, text), csv.text, "its rows are not those of the trial");
    free(text);
    TRY(status);
    return part || t->row_count == t->facts.count * t->facts.variants
               ? ASDIC_OK
               : damaged(ctx, csv.text, "rows are missing");
}

asdic_status asdic_trial_read(asdic_context *ctx, const char *folder, bool part,
                              asdic_trial **out) {
    asdic_trial *t = *out = calloc(1, sizeof *t);
    if (!t) {
        return asdic_fail_memory(ctx, "a trial");
    }
    t->ctx = ctx;
    locale_t before = asdic_c_locale_enter();
    asdic_status status = read_all(ctx, folder, part, t);
    asdic_c_locale_leave(before);
    if (!status && !name_variants(t)) {
        status = asdic_fail_memory(ctx, "a trial");
    }
    for (size_t v = 0; !status && v < t->facts.variants; v++) {
        count_variant(t, v);
        if (v > 0) {
            compare(t, v);
        }
    }
    if (status) {
        asdic_trial_close(out);
    }
    return status;
}

asdic_status asdic_trial_open(asdic_context *ctx, const char *folder, asdic_trial **out) {
    if (!ASDIC_PLACE(out) || !folder) {
        return asdic_fail_null(ctx, __func__);
    }
    return asdic_trial_read(ctx, folder, false, out);
}

void asdic_trial_close(asdic_trial **trial) {
    if (!trial || !*trial) {
        return;
    }
    asdic_trial *t = *trial;
    asdic_trial_facts_finish(&t->facts);
    for (size_t i = 0; i < ASDIC_TRIAL_MOST_VARIANTS; i++) {
        free(t->names[i]);
    }
    free(t->rows);
    free(t->header);
    free(t->body);
    free(t);
    *trial = NULL;
}

bool asdic_trial_is_in(const char *folder) {
    return folder && asdic_trial_has(folder, "trial.json");
}

size_t asdic_trial_variant_count(const asdic_trial *trial) {
    return trial ? trial->facts.variants : 0;
}

const char *asdic_trial_variant_name(const asdic_trial *trial, size_t variant) {
    return trial && variant < trial->facts.variants ? trial->names[variant] : NULL;
}

asdic_trial_result asdic_trial_get(const asdic_trial *trial, size_t variant) {
    return trial && variant < trial->facts.variants ? trial->results[variant]
                                                    : (asdic_trial_result){0};
}
