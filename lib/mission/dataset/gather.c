#include "gather.h"

#include "base/context.h"
#include "base/file_name.h"
#include "base/file_read.h"
#include "base/text.h"
#include "base/try.h"
#include "labelled.h"
#include "mission/run/run_folder.h"
#include "out/file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SET "dataset.json"
static const char *const summaries[] = {SET, "manifest.jsonl", "classes.txt",
                                        "polar/annotations.json", "bearing/annotations.json"};
#define SUMMARIES (sizeof summaries / sizeof *summaries)

/* A name has six digits for its number. */
#define MOST_FRAMES 1000000u

/* Where SET, the text of a dataset.json, says how many frames there are; NULL: nowhere. */
static const char *count_in(const char *set) {
    static const char key[] = "\"frames\":";
    const char *at = strstr(set, key);
    return at ? at + strlen(key) : NULL;
}

/* How many; 0: it does not say. */
static size_t frames_of(const char *set) {
    const char *count = count_in(set);
    size_t frames = count ? strtoull(count, NULL, 10) : 0;
    return frames <= MOST_FRAMES ? frames : 0;
}

bool asdic_dataset_is_in(const char *folder) {
    return folder && access(asdic_file_in(folder, SET).text, F_OK) == 0;
}

static asdic_status read_set(asdic_context *ctx, const char *folder, char **text, size_t *length) {
    return asdic_file_read(ctx, asdic_file_in(folder, SET).text, ASDIC_FRAME_MOST_BYTES, text,
                           length);
}

/* Removes what a set wrote into FOLDER: its frames, by their records, and the files about all. */
static asdic_status clear(asdic_context *ctx, const char *folder) {
    char *text = NULL;
    size_t length = 0;
    TRY(read_set(ctx, folder, &text, &length));
    size_t frames = frames_of(text);
    free(text);
    for (size_t k = 0; k < frames; k++) {
        asdic_frame_remove(folder, k);
    }
    for (size_t i = 0; i < SUMMARIES; i++) {
        unlink(asdic_file_in(folder, summaries[i]).text);
    }
    return ASDIC_OK;
}

asdic_status asdic_dataset_check(asdic_context *ctx, const asdic_dataset_options *options) {
    const char *folder = options->folder;
    if (strlen(folder) > 4000) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "the folder's name is too long");
    }
    if (asdic_folder_has_run(folder)) {
        return asdic_fail(ctx, ASDIC_ERROR_EXISTS, "'%s' holds a run; give another folder", folder);
    }
    if (asdic_dataset_is_in(folder) && !options->force && !options->resume) {
        return asdic_fail(ctx, ASDIC_ERROR_EXISTS,
                          "'%s' holds a data set; --resume goes on with it, --force replaces it",
                          folder);
    }
    return ASDIC_OK;
}

asdic_status asdic_dataset_enter(asdic_context *ctx, const asdic_dataset_options *options,
                                 DIR **lock) {
    const char *folder = options->folder;
    TRY(asdic_folder_hold(ctx, folder, lock));
    TRY(asdic_dataset_check(ctx, options)); /* another process may have been quicker */
    if (asdic_dataset_is_in(folder) && options->force) {
        TRY(clear(ctx, folder));
    }
    for (size_t i = 0; i < ASDIC_FRAME_FOLDERS; i++) {
        TRY(asdic_folder_make(ctx, asdic_file_in(folder, asdic_frame_folders[i].name).text));
    }
    return ASDIC_OK;
}

/* Whether the sets that A and B are about differ at most in their number of frames. */
static bool are_alike(const char *a, const char *b) {
    static const char digits[] = "0123456789";
    const char *in_a = count_in(a), *in_b = count_in(b);
    return in_a && in_b && in_a - a == in_b - b && strncmp(a, b, (size_t)(in_a - a)) == 0 &&
           strcmp(in_a + strspn(in_a, digits), in_b + strspn(in_b, digits)) == 0;
}

/* Frames of another part than OPTIONS' would stay, and be in no file about all: of COUNT there may be. */
static asdic_status refuse_others(asdic_context *ctx, const asdic_dataset_options *options,
                                  size_t count) {
    for (size_t k = 0; k < count; k++) {
        asdic_file_name record = asdic_frame_path(options->folder, "frames", k, "txt");
        bool is_other = k < options->first || k >= options->end;
        if (is_other && access(record.text, F_OK) == 0) {
            return asdic_fail(
                ctx, ASDIC_ERROR_EXISTS,
                "'%s' holds frame %zu, which is not of the part to be resumed, frames "
                "%zu to %zu; resume it with its own --shard, or give another folder",
                options->folder, k, options->first, options->end - 1);
        }
    }
    return ASDIC_OK;
}

asdic_status asdic_dataset_begin(asdic_context *ctx, const asdic_dataset_options *options,
                                 const char *text) {
    const asdic_file_name path = asdic_file_in(options->folder, SET);
    char *there = NULL;
    size_t length = 0;
    if (!asdic_dataset_is_in(options->folder)) {
        return asdic_file_write_all(ctx, path.text, text, strlen(text));
    }
    TRY(read_set(ctx, options->folder, &there, &length));
    size_t frames = frames_of(there);
    bool alike = strlen(there) == length && are_alike(there, text);
    free(there);
    if (!alike) {
        return asdic_fail(ctx, ASDIC_ERROR_EXISTS,
                          "'%s' holds a data set of another scene, seed or other options; it "
                          "cannot be resumed, --force replaces it",
                          options->folder);
    }
    if (frames > options->frames) {
        return asdic_fail(ctx, ASDIC_ERROR_EXISTS,
                          "'%s' holds %zu frames; --resume makes none fewer, --force replaces them",
                          options->folder, frames);
    }
    TRY(refuse_others(ctx, options, frames));
    return frames < options->frames ? asdic_file_write_all(ctx, path.text, text, strlen(text))
                                    : ASDIC_OK;
}

/* --- the files about all frames --------------------------------------------------------------- */

typedef struct gatherer {
    asdic_context *ctx;
    const asdic_dataset_options *options;
    asdic_text manifest, images[ASDIC_FORM_COUNT], annotations[ASDIC_FORM_COUNT];
    size_t ids[ASDIC_FORM_COUNT];
    size_t voids;
    char why[256]; /* the first of them is one */
    char *set;     /* dataset.json */
} gatherer;

/* Width and height from a PNG's header. */
static asdic_status read_size(asdic_context *ctx, const char *path, unsigned size[2]) {
    unsigned char head[24];
    FILE *file = fopen(path, "rbe");
    bool good = file && fread(head, 1, sizeof head, file) == sizeof head;
    if (file) {
        fclose(file);
    }
    for (int k = 0; good && k < 2; k++) {
        const unsigned char *b = head + 16 + 4 * k;
        size[k] = (unsigned)b[0] << 24 | (unsigned)b[1] << 16 | (unsigned)b[2] << 8 | b[3];
    }
    return good
               ? ASDIC_OK
               : asdic_fail(ctx, ASDIC_ERROR_INPUT,
                            "'%s' is missing or no picture; remove the frame's record and --resume",
                            path);
}

/* Counts a frame whose LINE of the manifest says why it is void, last. */
static void count_void(gatherer *g, size_t index, const char *line) {
    static const char key[] = "\"void\":\"";
    const char *why = strstr(line, key);
    if (g->voids++ == 0 && why) {
        why += strlen(key);
        snprintf(g->why, sizeof g->why, "frame %zu, %.*s", index, (int)strcspn(why, "\""), why);
    }
}

static void take_line(gatherer *g, const char *line, size_t length) {
    int form = line[0] == 'P' ? ASDIC_FORM_POLAR : ASDIC_FORM_BEARING;
    if (line[0] == 'S') { /* sizes */
        return;
    }
    if (line[0] == 'M' || line[0] == 'V') {
        asdic_text_add_bytes(&g->manifest, line + 1, length - 1);
        asdic_text_add(&g->manifest, "\n");
        return;
    }
    asdic_text *to = &g->annotations[form];
    asdic_text_format(to, "%s{\"id\":%zu,", g->ids[form] ? ",\n" : "", g->ids[form] + 1);
    asdic_text_add_bytes(to, line + 1, length - 1);
    g->ids[form]++;
}

static asdic_status take_frame(gatherer *g, size_t index) {
    char *text = NULL;
    size_t length = 0;
    TRY(asdic_file_read(g->ctx, asdic_frame_path(g->options->folder, "frames", index, "txt").text,
                        ASDIC_FRAME_MOST_BYTES, &text, &length));
    for (char *line = text, *end; (end = strchr(line, '\n')) != NULL; line = end + 1) {
        take_line(g, line, (size_t)(end - line));
    }
    bool is_void = text[0] == 'V';
    if (is_void) {
        count_void(g, index, text);
    }
    free(text);
    for (int form = 0; form < ASDIC_FORM_COUNT && !is_void; form++) {
        unsigned size[2] = {0, 0};
        const asdic_file_name sub = asdic_file_in(asdic_form_names[form], "images"),
                              image = asdic_frame_path(g->options->folder, sub.text, index, "png");
        TRY(read_size(g->ctx, image.text, size));
        asdic_text_format(&g->images[form],
                          "%s{\"id\":%zu,\"file_name\":\"images/%06zu.png\",\"width\":%u,"
                          "\"height\":%u}",
                          g->images[form].length ? ",\n" : "", index, index, size[0], size[1]);
    }
    return ASDIC_OK;
}

/* The names in dataset.json's list of classes, one after the other; NULL behind the last. */
static const char *next_class(const char *at, char name[256]) {
    size_t n = 0;
    while (*at == ',' || *at == '[') {
        at++;
    }
    if (*at != '"') {
        return NULL;
    }
    for (at++; *at && *at != '"' && n < 255; at++) {
        name[n++] = *at;
    }
    name[n] = 0;
    return at + 1;
}

static const char *classes_of(const gatherer *g) {
    const char *at = strstr(g->set, "\"classes\":");
    return at ? at + strlen("\"classes\":") : "";
}

static asdic_status write_text(gatherer *g, const char *name, asdic_text *text) {
    return asdic_file_write_text(g->ctx, asdic_file_in(g->options->folder, name).text, text,
                                 "a data set", false);
}

static asdic_status write_coco(gatherer *g, int form) {
    char path[64], name[256];
    asdic_text text = {0};
    const char *at = classes_of(g);
    asdic_text_format(&text,
                      "{\"info\":{\"description\":\"simulated sonar frames\",\"side_lobes\":%s},\n"
                      "\"categories\":[",
                      strstr(g->set, "\"side_lobes\":false") ? "false"
                                                             : "true"); /* older sets do not say */
    for (size_t k = 1; (at = next_class(at, name)) != NULL; k++) {
        asdic_text_format(&text, "%s{\"id\":%zu,\"name\":\"%s\"}", k > 1 ? "," : "", k, name);
    }
    asdic_text_add(&text, "],\n\"images\":[");
    asdic_text_add_bytes(&text, g->images[form].data, g->images[form].length);
    asdic_text_add(&text, "],\n\"annotations\":[");
    asdic_text_add_bytes(&text, g->annotations[form].data, g->annotations[form].length);
    asdic_text_add(&text, "]}\n");
    text.failed |= g->images[form].failed || g->annotations[form].failed;
    snprintf(path, sizeof path, "%s/annotations.json", asdic_form_names[form]);
    return write_text(g, path, &text);
}

static asdic_status gather(gatherer *g) {
    char name[256];
    asdic_text classes = {0};
    const asdic_dataset_options *o = g->options;
    for (size_t k = o->first; k < o->end; k++) {
        TRY(take_frame(g, k));
    }
    for (const char *at = classes_of(g); (at = next_class(at, name)) != NULL;) {
        asdic_text_format(&classes, "%s\n", name);
    }
    TRY(write_text(g, "classes.txt", &classes));
    TRY(write_text(g, "manifest.jsonl", &g->manifest));
    TRY(write_coco(g, ASDIC_FORM_POLAR));
    TRY(write_coco(g, ASDIC_FORM_BEARING));
    if (g->voids > 0) {
        asdic_log(g->ctx, ASDIC_LOG_WARNING,
                  "%s: remark: %zu of %zu frames %s void, without pictures and labels: %s",
                  o->folder, g->voids, o->end - o->first, g->voids == 1 ? "is" : "are", g->why);
    }
    return ASDIC_OK;
}

asdic_status asdic_dataset_gather(asdic_context *ctx, const asdic_dataset_options *options) {
    gatherer g = {.ctx = ctx, .options = options};
    size_t length = 0;
    asdic_status status = read_set(ctx, options->folder, &g.set, &length);
    status = status ? status : gather(&g);
    asdic_text_finish(&g.manifest);
    for (int form = 0; form < ASDIC_FORM_COUNT; form++) {
        asdic_text_finish(&g.images[form]);
        asdic_text_finish(&g.annotations[form]);
    }
    free(g.set);
    return status;
}

/* --- joining parts ---------------------------------------------------------------------------- */

static asdic_status copy(asdic_context *ctx, const char *from, const char *to) {
    char *bytes = NULL;
    size_t length = 0;
    TRY(asdic_file_read(ctx, from, ASDIC_FRAME_MOST_BYTES, &bytes, &length));
    asdic_status status = asdic_file_write_soon(ctx, to, bytes, length);
    free(bytes);
    return status;
}

/* The first of PARTS that has frame INDEX. */
static asdic_status find_part(asdic_context *ctx, const char *const *parts, size_t count,
                              size_t index, const char **out) {
    for (size_t p = 0; p < count; p++) {
        if (access(asdic_frame_path(parts[p], "frames", index, "txt").text, F_OK) == 0) {
            *out = parts[p];
            return ASDIC_OK;
        }
    }
    return asdic_fail(ctx, ASDIC_ERROR_INPUT, "frame %zu is in none of the parts", index);
}

/* The files that frame INDEX has, a void one its record alone; that comes last. */
static asdic_status copy_frame(asdic_context *ctx, const char *part, const char *out,
                               size_t index) {
    for (size_t i = ASDIC_FRAME_FOLDERS; i-- > 0;) {
        const asdic_frame_folder *sub = &asdic_frame_folders[i];
        const asdic_file_name from = asdic_frame_path(part, sub->name, index, sub->extension);
        const asdic_file_name to = asdic_frame_path(out, sub->name, index, sub->extension);
        if (sub->extension && access(from.text, F_OK) == 0) {
            TRY(copy(ctx, from.text, to.text));
        } else if (sub->extension) {
            unlink(to.text);
        }
    }
    return ASDIC_OK;
}

/* All frames must be there, and in other folders than OUT, before what is in OUT is replaced. */
static asdic_status check_parts(asdic_context *ctx, const char *const *parts, size_t count,
                                const char *out, size_t frames) {
    for (size_t p = 0; p < count; p++) {
        if (asdic_file_is_same(parts[p], out)) {
            return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                              "'%s' is one of the parts to be joined; choose another folder", out);
        }
    }
    for (size_t k = 0; k < frames; k++) {
        const char *found = NULL;
        TRY(find_part(ctx, parts, count, k, &found));
        TRY(asdic_frame_check(ctx, found, k));
    }
    return ASDIC_OK;
}

static asdic_status merge(asdic_context *ctx, const char *const *parts, size_t count,
                          asdic_dataset_options *o, const char *set, DIR **lock) {
    for (size_t p = 1; p < count; p++) {
        char *other = NULL;
        size_t length = 0;
        TRY(read_set(ctx, parts[p], &other, &length));
        bool same = strcmp(other, set) == 0;
        free(other);
        if (!same) {
            return asdic_fail(ctx, ASDIC_ERROR_INPUT,
                              "'%s' and '%s' are parts of different data sets", parts[0], parts[p]);
        }
    }
    o->frames = o->end = frames_of(set);
    if (o->frames == 0) {
        return asdic_fail(ctx, ASDIC_ERROR_INPUT,
                          "'%s/dataset.json' does not say how many frames there are", parts[0]);
    }
    TRY(check_parts(ctx, parts, count, o->folder, o->frames));
    TRY(asdic_dataset_enter(ctx, o, lock));
    TRY(asdic_dataset_begin(ctx, o, set)); /* first: what a full disk leaves says what it is of */
    for (size_t k = 0; k < o->frames; k++) {
        const char *part = NULL;
        TRY(find_part(ctx, parts, count, k, &part));
        TRY(copy_frame(ctx, part, o->folder, k));
    }
    return asdic_dataset_gather(ctx, o);
}

asdic_status asdic_dataset_merge(asdic_context *ctx, const char *const *parts, size_t count,
                                 const char *out_folder, bool force) {
    TRY(asdic_folder_check_parts(ctx, __func__, parts, count, out_folder));
    char *set = NULL;
    size_t length = 0;
    asdic_dataset_options o = asdic_dataset_options_default();
    o.folder = out_folder;
    o.force = force;
    TRY(read_set(ctx, parts[0], &set, &length));
    DIR *lock = NULL;
    asdic_status status = merge(ctx, parts, count, &o, set, &lock);
    if (lock) {
        closedir(lock);
    }
    free(set);
    return status;
}
