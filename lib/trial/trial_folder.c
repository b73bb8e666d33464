#include "trial_folder.h"

#include "base/context.h"
#include "base/file_name.h"
#include "base/try.h"
#include "out/digits.h"
#include "out/file.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *const outcomes[ASDIC_TRIAL_OUTCOMES] = {"clear", "hit", "late", "void",
                                                           "broken"};
static const char *const causes[ASDIC_TRIAL_CAUSES] = {"", "not seen", "seen late",
                                                       "could not turn"};

const char *asdic_trial_outcome_name(asdic_trial_outcome outcome) {
    return outcome < ASDIC_TRIAL_OUTCOMES ? outcomes[outcome] : NULL;
}

const char *asdic_trial_cause_name(asdic_trial_cause cause) {
    return cause < ASDIC_TRIAL_CAUSES ? causes[cause] : NULL;
}

void asdic_trial_facts_finish(trial_facts *facts) {
    free(facts->key);
    free(facts->rule);
    for (size_t i = 0; i < facts->variants; i++) {
        free(facts->values[i]);
    }
    *facts = (trial_facts){.key = NULL};
}

/* --- trial.json -------------------------------------------------------------------------------- */

static void add_number(asdic_text *text, double value) {
    char digits[ASDIC_DIGITS_SIZE];
    asdic_digits_print(digits, "%.9g", value);
    asdic_text_add(text, isfinite(value) ? digits : "null");
}

static void add_key(asdic_text *text, const char *key) {
    asdic_text_format(text, "      \"%s\": ", key);
}

static void add_figure(asdic_text *text, const char *key, const asdic_trial_figure *figure) {
    const double values[3] = {figure->value, figure->low, figure->high};
    add_key(text, key);
    for (int i = 0; i < 3; i++) {
        asdic_text_add(text, i ? ", " : "[");
        add_number(text, values[i]);
    }
    asdic_text_add(text, "],\n");
}

static void add_result(asdic_text *text, const char *name, const asdic_trial_result *r,
                       bool is_first) {
    asdic_text_add(text, is_first ? "    {\n" : ",\n    {\n");
    add_key(text, "name");
    asdic_text_add_json(text, name);
    asdic_text_format(text, ",\n      \"runs\": %llu,\n", (unsigned long long)r->runs);
    for (int i = 0; i < ASDIC_TRIAL_OUTCOMES; i++) {
        asdic_text_format(text, "      \"%s\": %llu,\n", outcomes[i],
                          (unsigned long long)r->outcomes[i]);
    }
    for (int i = 1; i < ASDIC_TRIAL_CAUSES; i++) {
        asdic_text_format(text, "      \"%s\": %llu,\n", causes[i],
                          (unsigned long long)r->causes[i]);
    }
    add_figure(text, "collision", &r->collision);
    add_figure(text, "needless", &r->needless);
    add_figure(text, "needless_per_km", &r->needless_per_km);
    if (!is_first) {
        add_figure(text, "difference", &r->difference);
        add_key(text, "mcnemar");
        add_number(text, r->mcnemar);
        asdic_text_add(text, ",\n");
        add_key(text, "paired_share");
        add_number(text, r->paired_share);
        asdic_text_add(text, ",\n");
    }
    add_key(text, "km");
    add_number(text, r->km);
    asdic_text_add(text, ",\n");
    add_key(text, "least_clearance_m");
    add_number(text, r->least_clearance_m);
    asdic_text_format(text, ",\n      \"pings\": %llu\n    }", (unsigned long long)r->pings);
}

void asdic_trial_print(const trial_facts *f, const asdic_trial_result *results,
                       const char *const *names, asdic_text *text) {
    asdic_text_add(text, "{\n  \"scene\": ");
    asdic_text_add_json(text, f->scene);
    asdic_text_format(
        text,
        ",\n  \"hash\": \"%s\",\n  \"seed\": %llu,\n  \"runs\": %llu,\n"
        "  \"first\": %llu,\n  \"count\": %llu,\n  \"rays\": %lu,\n  \"rule\": \"%s\",\n",
        f->hash, (unsigned long long)f->seed, (unsigned long long)f->runs,
        (unsigned long long)f->first, (unsigned long long)f->count, (unsigned long)f->rays,
        f->rule ? "program" : "scene");
    if (f->rule) {
        asdic_text_add(text, "  \"command\": ");
        asdic_text_add_json(text, f->rule);
        asdic_text_add(text, ",\n");
    }
    if (f->key) {
        asdic_text_add(text, "  \"key\": ");
        asdic_text_add_json(text, f->key);
        asdic_text_add(text, ",\n  \"values\": [");
        for (size_t i = 0; i < f->variants; i++) {
            asdic_text_add(text, i ? ", " : "");
            asdic_text_add_json(text, f->values[i]);
        }
        asdic_text_add(text, "],\n");
    }
    asdic_text_add(text, "  \"variants\": [\n");
    for (size_t i = 0; results && i < f->variants; i++) {
        add_result(text, names[i], &results[i], i == 0);
    }
    asdic_text_add(text, results ? "\n  ]\n}\n" : "  ]\n}\n");
}

/* --- trial.csv --------------------------------------------------------------------------------- */

void asdic_trial_print_header(const asdic_mission *mission, asdic_text *text) {
    asdic_text_add(text, "run,variant,outcome,cause,what,time_s,distance_m,pings,clearance_m,"
                         "manoeuvres,needless,seen_m");
    for (size_t i = 0; asdic_mission_drawn(mission, i).key; i++) {
        asdic_text_format(text, ",%s", asdic_mission_drawn(mission, i).key);
    }
    asdic_text_add(text, "\n");
}

static void add_field(asdic_text *text, double value) {
    char digits[ASDIC_DIGITS_SIZE];
    asdic_digits_print(digits, "%.9g", value);
    asdic_text_format(text, ",%s", isfinite(value) ? digits : "");
}

void asdic_trial_print_row(const asdic_mission *mission, uint64_t run, size_t variant,
                           const asdic_trial_run *r, asdic_text *text) {
    asdic_text_format(text, "%llu,%zu,%s,%s,%s", (unsigned long long)run, variant,
                      outcomes[r->outcome], causes[r->cause], r->what);
    add_field(text, r->time_s);
    add_field(text, r->distance_m);
    asdic_text_format(text, ",%zu", r->pings);
    add_field(text, r->clearance_m);
    asdic_text_format(text, ",%u,%u", r->manoeuvres, r->needless);
    add_field(text, r->seen_m);
    for (size_t i = 0; asdic_mission_drawn(mission, i).key; i++) {
        const char *value = asdic_mission_drawn(mission, i).value;
        asdic_text_add(text, ",");
        if (!strpbrk(value, ",\"\n")) {
            asdic_text_add(text, value);
            continue;
        }
        asdic_text_add(text, "\"");
        for (const char *c = value; *c; c++) {
            asdic_text_add_bytes(text, *c == '"' ? "\"\"" : c, *c == '"' ? 2 : 1);
        }
        asdic_text_add(text, "\"");
    }
    asdic_text_add(text, "\n");
}

/* --- complete ---------------------------------------------------------------------------------- */

/* Gives FOLDER/NAME.part its name. */
static asdic_status settle(asdic_context *ctx, const char *folder, const char *part,
                           const char *name) {
    const asdic_file_name from = asdic_file_in(folder, part), to = asdic_file_in(folder, name);
    return rename(from.text, to.text) == 0 ? ASDIC_OK : asdic_file_fail(ctx, to.text, errno);
}

static asdic_status write_json(asdic_context *ctx, const asdic_trial *trial, const char *path) {
    asdic_text text = {0};
    asdic_trial_print(&trial->facts, trial->results, (const char *const *)trial->names, &text);
    return asdic_file_write_text(ctx, path, &text, "trial.json", false);
}

asdic_status asdic_trial_complete(asdic_context *ctx, asdic_trial *trial, const char *folder) {
    if (asdic_picture_annotated()) {
        TRY(asdic_trial_draw(ctx, trial, asdic_file_in(folder, "trial.png").text));
    }
    TRY(write_json(ctx, trial, asdic_file_in(folder, "trial.json").text));
    /* Last: as long as it has this name, --resume finds all rows. */
    TRY(settle(ctx, folder, "trial.part.csv", "trial.csv"));
    unlink(asdic_file_in(folder, "trial.part.json").text);
    return ASDIC_OK;
}

asdic_status asdic_trial_settle(asdic_context *ctx, const char *folder) {
    asdic_trial *trial = NULL;
    TRY(asdic_trial_read(ctx, folder, true, &trial));
    asdic_status status = asdic_trial_complete(ctx, trial, folder);
    asdic_trial_close(&trial);
    return status;
}

/* --- under way --------------------------------------------------------------------------------- */

static bool is_same_rule(const char *a, const char *b) {
    return a && b ? strcmp(a, b) == 0 : a == b;
}

bool asdic_trial_is_same(const trial_facts *a, const trial_facts *b) {
    return strcmp(a->hash, b->hash) == 0 && a->seed == b->seed && a->runs == b->runs &&
           a->rays == b->rays && is_same_rule(a->rule, b->rule) && a->variants == b->variants;
}

bool asdic_trial_has(const char *folder, const char *name) {
    return access(asdic_file_in(folder, name).text, F_OK) == 0;
}

#define NEXT "trial.part.csv.part" /* which is to become trial.part.csv */

static asdic_status begin(asdic_context *ctx, const char *folder, const asdic_text *facts,
                          const asdic_text *header, const asdic_text *rows, bool goes_on,
                          FILE **out) {
    const asdic_file_name csv = asdic_file_in(folder, "trial.part.csv");
    int fd = asdic_file_open_new(asdic_file_in(folder, NEXT).text, O_WRONLY);
    if (fd < 0) {
        return asdic_file_fail(ctx, csv.text, errno);
    }
    *out = fdopen(fd, "w");
    if (!*out) {
        close(fd);
        return asdic_fail_memory(ctx, "a file");
    }
    if (asdic_file_is_being_written(csv.text)) { /* by another process */
        return asdic_file_fail(ctx, csv.text, EBUSY);
    }
    if (!goes_on && unlink(csv.text) != 0 && errno != ENOENT) {
        return asdic_file_fail(ctx, csv.text, errno); /* rows that FACTS are not of */
    }
    if (fputs(header->data, *out) < 0 || fputs(rows->data ? rows->data : "", *out) < 0 ||
        fflush(*out) != 0) {
        return asdic_file_fail(ctx, csv.text, errno);
    }
    TRY(asdic_file_write_all(ctx, asdic_file_in(folder, "trial.part.json").text, facts->data,
                             facts->length));
    /* Last: a process that is killed before leaves what there was. */
    return settle(ctx, folder, NEXT, "trial.part.csv");
}

asdic_status asdic_trial_begin(asdic_context *ctx, const char *folder, const trial_facts *facts,
                               const asdic_text *header, const asdic_text *rows, bool goes_on,
                               FILE **out) {
    asdic_text text = {0};
    asdic_trial_print(facts, NULL, NULL, &text);
    *out = NULL;
    asdic_status status = text.failed ? asdic_fail_memory(ctx, "a trial")
                                      : begin(ctx, folder, &text, header, rows, goes_on, out);
    if (status && *out) {
        fclose(*out);
        *out = NULL;
        unlink(asdic_file_in(folder, NEXT).text);
    }
    asdic_text_finish(&text);
    return status;
}

asdic_status asdic_trial_end(asdic_context *ctx, const char *folder, FILE **out) {
    bool good = *out && fflush(*out) == 0;
    int error = errno;
    if (good && ferror(*out)) {
        good = false;
        error = EIO;
    }
    if (*out) {
        fclose(*out);
    }
    *out = NULL;
    return good ? ASDIC_OK : asdic_file_fail(ctx, folder, error);
}
