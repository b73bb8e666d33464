/*
 * Draws of a scene's `trial` section.
 *
 *     uniform: [a, b]                   a + (b - a) u
 *     normal: [m, s], within: [a, b]    m + s z, with z from the normal distribution between the
 *                                       bounds: Phi(z) = Phi(za) + u (Phi(zb) - Phi(za))
 *     choice: [x, y, ...]               each as likely; values of any kind, with draws in them
 *
 * u in (0, 1) comes from a counter of seed, run and the key's hash.
 */
#include "scene_draw.h"
#include "scene_keys.h"

#include "base/hash.h"
#include "out/digits.h"
#include "sim/variates.h"

#include "../../../kernels/random.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A distribution cut down to less than this is a mistake. */
#define LEAST_SHARE 1e-9

/* Where numbers are looked at: at both ends, and between, at none that is whole. */
static const double shares[] = {0.0, 1.0, 0.381966011250105};

typedef struct drawer {
    asdic_schema_reader reader;
    const asdic_draw *draw; /* NULL: what may be drawn is looked at: */
    size_t look;            /* 0 .. count_looks - 1: which entries choices give; */
    double share;           /* and of numbers what lies so far from the lower to the upper end */
} drawer;

static bool is_draw(const asdic_yaml_node *node) {
    return asdic_yaml_child(node, "uniform") || asdic_yaml_child(node, "normal") ||
           asdic_yaml_child(node, "choice");
}

/* The draw NODE inside a choice. */
static file_draw read_inner(const asdic_schema_reader *r, asdic_yaml_node *node) {
    file_draw inner = {0};
    asdic_schema_read(&asdic_inner_draw_table, &asdic_inner_draw_table, node, r->arena, r->problems,
                      &inner);
    return inner;
}

/* Of a key, step by step from the outside in. */
static uint64_t hash_text(uint64_t hash, const char *text, size_t length) {
    for (size_t i = 0; i < length; i++) {
        hash = asdic_hash_fold(hash, (unsigned char)text[i]);
    }
    return hash;
}

static uint64_t hash_step(uint64_t hash, const asdic_yaml_node *child) {
    char index[ASDIC_DIGITS_SIZE];
    if (child->key) {
        return hash_text(hash_text(hash, ".", 1), child->key, child->key_length);
    }
    return hash_text(hash_text(hash, "#", 1), index, asdic_digits_natural(index, child->index));
}

static double uniform_of(const drawer *d, uint64_t hash) {
    asdic_variates v = asdic_variates_begin(
        RANDOM_DRAW, d->draw->seed ^ (hash & 0xffffffff00000000u), d->draw->run, (uint32_t)hash);
    return asdic_variates_uniform(&v);
}

/* --- the distributions ------------------------------------------------------------------------ */

static double phi(double z) {
    return 0.5 * erfc(-z * M_SQRT1_2);
}

/* The z between LOW and HIGH below which lies the share U of the normal distribution there: by
 * halving, to the last bit. Above the mean the tail on the other side is used, which has more
 * digits. */
static double normal_between(double low, double high, double u) {
    if (low > 0.0) {
        return -normal_between(-high, -low, 1.0 - u);
    }
    double target = phi(low) + u * (phi(high) - phi(low));
    double a = fmax(low, -40.0), b = fmin(high, 40.0);
    for (int i = 0; i < 64; i++) {
        double middle = 0.5 * (a + b);
        *(phi(middle) < target ? &a : &b) = middle;
    }
    return 0.5 * (a + b);
}

static void draw_number(const drawer *d, const file_draw *file, uint64_t hash,
                        asdic_yaml_node *out) {
    char digits[ASDIC_DIGITS_SIZE];
    double u = d->draw ? uniform_of(d, hash) : 0.0, value;
    bool is_uniform = asdic_yaml_child(file->node, "uniform");
    bool is_cut = asdic_yaml_child(file->node, "within");
    if (!d->draw) { /* of tails without an end the middle, or next to it */
        const double middle[2] = {file->normal[0], file->normal[0] + 1e-6 * file->normal[1]};
        const double *ends = is_uniform ? file->uniform : is_cut ? file->within : middle;
        value = ends[0] + (ends[1] - ends[0]) * d->share;
    } else if (is_uniform) {
        value = file->uniform[0] + u * (file->uniform[1] - file->uniform[0]);
    } else {
        double mean = file->normal[0], sd = file->normal[1];
        value = mean + sd * normal_between(is_cut ? (file->within[0] - mean) / sd : -INFINITY,
                                           is_cut ? (file->within[1] - mean) / sd : INFINITY, u);
    }
    out->kind = ASDIC_YAML_SCALAR;
    out->quoted = false;
    out->first = out->last = NULL;
    out->count = 0;
    out->length = asdic_digits_double(digits, value);
    out->text = asdic_arena_string(d->reader.arena, digits, out->length);
    d->reader.problems->out_of_memory |= !out->text;
}

/* --- values ------------------------------------------------------------------------------------ */

static void take_value(const drawer *d, asdic_yaml_node *from, uint64_t hash, asdic_yaml_node *out);

/* How many looks show each entry of the choices in NODE: those of a map's children are had together. */
static size_t count_looks(const asdic_yaml_node *node) {
    const asdic_yaml_node *choice = asdic_yaml_child(node, "choice");
    size_t looks = choice ? 0 : 1;
    for (const asdic_yaml_node *child = (choice ? choice : node)->first; child;
         child = child->next) {
        size_t own = count_looks(child);
        looks = choice ? looks + own : own > looks ? own : looks;
    }
    return looks;
}

/* What the draw FILE gives. */
static void take_draw(const drawer *d, const file_draw *file, uint64_t hash, asdic_yaml_node *out) {
    if (!file->choice) {
        draw_number(d, file, hash, out);
        return;
    }
    drawer inside = *d;
    asdic_yaml_node *chosen = file->choice->first;
    size_t index = d->draw ? (size_t)(uniform_of(d, hash) * (double)file->choice->count) : 0;
    for (; index > 0; index--) {
        chosen = chosen->next;
    }
    for (size_t looks; !d->draw && chosen->next && inside.look >= (looks = count_looks(chosen));
         chosen = chosen->next) {
        inside.look -= looks;
    }
    take_value(&inside, chosen, hash_step(hash, chosen), out);
}

/* Makes OUT, which keeps its place, what FROM holds, draws in it drawn. */
static void take_value(const drawer *d, asdic_yaml_node *from, uint64_t hash,
                       asdic_yaml_node *out) {
    if (is_draw(from)) {
        file_draw inner = read_inner(&d->reader, from);
        take_draw(d, &inner, hash, out);
        return;
    }
    out->kind = from->kind;
    out->text = from->text;
    out->length = from->length;
    out->quoted = from->quoted && strcmp(from->text, "none") != 0; /* a word, in JSON, too */
    out->first = out->last = NULL;
    out->count = 0;
    for (asdic_yaml_node *child = from->first; child; child = child->next) {
        asdic_yaml_node *copy = asdic_arena_alloc(d->reader.arena, sizeof *copy);
        if (!copy) {
            d->reader.problems->out_of_memory = true;
            return;
        }
        *copy = *child;
        copy->next = NULL;
        take_value(d, child, hash_step(hash, child), copy);
        asdic_yaml_append(out, copy);
    }
}

static bool is_some(const asdic_yaml_node *node, const void *unused) {
    (void)unused;
    return node->kind != ASDIC_YAML_SCALAR || node->quoted || strcmp(node->text, "none") != 0;
}

/* --- all of a run ------------------------------------------------------------------------------ */

static void print_scalar(const asdic_yaml_node *node, asdic_text *text) {
    if (node->quoted) {
        asdic_text_add_json(text, node->text);
    } else {
        asdic_text_add(text, node->length ? node->text : "null");
    }
}

/* Whether KEY lies in a list's entry that was drawn as `none`. */
static bool is_gone(const asdic_drawn *drawn, const char *key) {
    for (size_t i = 0; i < drawn->count; i++) {
        if (strcmp(drawn->items[i].value, "none") == 0 &&
            asdic_scene_key_is_in(key, drawn->items[i].key)) {
            return true;
        }
    }
    return false;
}

/* Whether KEY or a part of it was drawn. */
static bool has_drawn(const asdic_drawn *drawn, const char *key) {
    for (size_t i = 0; i < drawn->count; i++) {
        if (asdic_scene_key_is_in(drawn->items[i].key, key)) {
            return true;
        }
    }
    return false;
}

/* Puts what is set for KEY or, before that is drawn, for a whole that it is in; what is set for KEY itself stands in place
 * of the draw, and is returned. */
static const asdic_setting *set_around(const drawer *d, asdic_yaml_node *root, const char *key,
                                       const asdic_drawn *drawn) {
    const asdic_setting *own = NULL;
    for (size_t i = 0; i < drawn->setting_count; i++) {
        const asdic_setting *set = &drawn->settings[i];
        bool has_turn = asdic_scene_key_turn(set->key) == asdic_scene_key_turn(key);
        if (has_turn && asdic_scene_key_is_in(key, set->key) && !has_drawn(drawn, set->key)) {
            asdic_scene_file_set(root, set, d->reader.arena, d->reader.problems);
        }
        own = strcmp(set->key, key) == 0 ? set : own;
    }
    return own;
}

/* Whether what is set holds KEY, which may then not be there to be drawn: an entry beyond a shorter list. */
static bool is_in_set(const asdic_drawn *drawn, const char *key) {
    for (size_t i = 0; i < drawn->setting_count; i++) {
        if (asdic_scene_key_is_in(key, drawn->settings[i].key)) {
            return true;
        }
    }
    return false;
}

static void remember(const drawer *d, const char *key, const asdic_yaml_node *node,
                     asdic_drawn *drawn) {
    asdic_text text = {0};
    asdic_yaml_print_flow(node, false, print_scalar, &text);
    const char *value = text.data && !text.failed
                            ? asdic_arena_string(d->reader.arena, text.data, text.length)
                            : NULL;
    asdic_text_finish(&text);
    d->reader.problems->out_of_memory |= !value;
    if (value) {
        drawn->items[drawn->count++] = (asdic_setting){key, value};
    }
}

/* The node of KEY in ROOT; without a word where it is not there. */
static asdic_yaml_node *look_for(const drawer *d, asdic_yaml_node *root,
                                 const asdic_yaml_node *key) {
    asdic_problems untold = {0};
    asdic_yaml_node nobody = *key; /* what a problem is told of counts as bad from then on */
    asdic_yaml_node *node =
        asdic_scene_file_find(root, key->text, &nobody, d->reader.arena, &untold);
    d->reader.problems->out_of_memory |= untold.out_of_memory;
    asdic_problems_finish(&untold);
    return node;
}

/* MAY_LACK: the scene's file has the key, so that only a shorter list that is set lacks it. */
static void draw_one(const drawer *d, asdic_yaml_node *root, const file_draw *file, bool may_lack,
                     asdic_drawn *drawn) {
    const char *key = file->key->text;
    const asdic_setting *set = set_around(d, root, key, drawn);
    if (set) {
        drawn->items[drawn->count++] = *set;
        return;
    }
    asdic_yaml_node *node =
        may_lack ? look_for(d, root, file->key)
                 : asdic_scene_file_find(root, key, file->key, d->reader.arena, d->reader.problems);
    if (!node) {
        if (may_lack) {
            drawn->items[drawn->count++] = (asdic_setting){key, ""};
        }
        return;
    }
    node->file = file->node->file;
    node->line = file->node->line;
    node->column = file->node->column;
    take_draw(d, file, hash_text(ASDIC_HASH_BEGIN, key, strlen(key)), node);
    remember(d, key, node, drawn);
}

void asdic_scene_draw_finish(asdic_yaml_node *root, const asdic_drawn *drawn, asdic_arena *arena,
                             asdic_problems *problems) {
    for (size_t i = 0; i < drawn->count; i++) {
        size_t length = strlen(drawn->items[i].key);
        if (strcmp(drawn->items[i].value, "none") == 0 && drawn->items[i].key[length - 1] == ']') {
            size_t list = (size_t)(strrchr(drawn->items[i].key, '[') - drawn->items[i].key);
            char *path = asdic_arena_string(arena, drawn->items[i].key, list);
            asdic_yaml_node *node =
                path ? asdic_scene_file_find(root, path, root, arena, problems) : NULL;
            if (node && node->kind == ASDIC_YAML_LIST) {
                asdic_yaml_filter(node, is_some, NULL);
            }
        }
    }
}

/* All draws of TURN. */
static void draw_all(const drawer *d, asdic_yaml_node *root, const file_trial *trial,
                     asdic_scene_turn turn, asdic_drawn *drawn) {
    const file_draw *draws = trial->draws.items;
    size_t first = drawn->count;
    asdic_setting *items =
        asdic_arena_alloc(d->reader.arena, (first + trial->draws.count + 1) * sizeof *items);
    bool *is_in_file = asdic_arena_alloc(d->reader.arena, trial->draws.count + 1);
    if (!items || !is_in_file) {
        d->reader.problems->out_of_memory = true;
        return;
    }
    for (size_t i = 0; i < first; i++) {
        items[i] = drawn->items[i];
    }
    for (size_t i = 0; i < trial->draws.count; i++) {
        const char *key = draws[i].key->text;
        is_in_file[i] = asdic_scene_key_turn(key) == turn && is_in_set(drawn, key) &&
                        look_for(d, root, draws[i].key);
    }
    drawn->items = items;
    for (size_t i = 0; i < trial->draws.count; i++) {
        const char *key = draws[i].key->text;
        if (asdic_scene_key_turn(key) != turn) {
            continue;
        }
        if (is_gone(drawn, key)) {
            drawn->items[drawn->count++] = (asdic_setting){key, ""};
        } else {
            draw_one(d, root, &draws[i], is_in_file[i], drawn);
        }
    }
}

void asdic_scene_draw(asdic_yaml_node *root, const file_trial *trial, const asdic_draw *draw,
                      asdic_scene_turn turn, asdic_arena *arena, asdic_problems *problems,
                      asdic_drawn *drawn) {
    const drawer d = {.reader = {asdic_scene_table(), arena, problems, NULL, NULL}, .draw = draw};
    if (asdic_scene_node_good(trial->node)) {
        draw_all(&d, root, trial, turn, drawn);
    }
    for (size_t i = 0; root && i < drawn->setting_count; i++) {
        const char *key = drawn->settings[i].key;
        if (asdic_scene_key_turn(key) == turn && !is_gone(drawn, key) && !has_drawn(drawn, key)) {
            asdic_scene_file_set(root, &drawn->settings[i], arena, problems);
        }
    }
}

/* --- names that objects may have --------------------------------------------------------------- */

/* NAME, or what it is chosen from. */
static bool add_name(asdic_names *names, const asdic_yaml_node *name) {
    const asdic_yaml_node *choice = asdic_yaml_child(name, "choice");
    bool good = true;
    for (const asdic_yaml_node *c = choice ? choice->first : NULL; c && good; c = c->next) {
        good = add_name(names, c);
    }
    if (!name || name->kind != ASDIC_YAML_SCALAR || name->length >= ASDIC_NAME_SIZE) {
        return good; /* no name, or one that is refused where it is drawn */
    }
    for (size_t i = 0; i < names->count; i++) {
        if (strcmp(names->items[i], name->text) == 0) {
            return true;
        }
    }
    void *grown = realloc(names->items, (names->count + 1) * sizeof *names->items);
    if (grown) {
        names->items = grown;
        memcpy(names->items[names->count++], name->text, name->length + 1);
    }
    return grown;
}

/* Of OBJECT, or of what it is chosen from. */
static bool add_object(asdic_names *names, const asdic_yaml_node *object) {
    const asdic_yaml_node *choice = asdic_yaml_child(object, "choice");
    bool good = true;
    for (const asdic_yaml_node *c = choice ? choice->first : NULL; c && good; c = c->next) {
        good = add_object(names, c);
    }
    return good && (choice || add_name(names, asdic_yaml_child(object, "name")));
}

/* What is drawn for KEY; NULL: nothing. */
static const asdic_yaml_node *draw_of(const file_trial *trial, const char *key) {
    const file_draw *draws = trial->draws.items;
    for (size_t i = 0; i < trial->draws.count; i++) {
        if (strcmp(draws[i].key->text, key) == 0) {
            return draws[i].node;
        }
    }
    return NULL;
}

static bool add_objects(asdic_names *names, const asdic_yaml_node *list, const file_trial *trial) {
    bool good = true;
    for (const asdic_yaml_node *o = list ? list->first : NULL; o && good; o = o->next) {
        char key[64];
        snprintf(key, sizeof key, "objects[%zu].name", o->index);
        const asdic_yaml_node *name = draw_of(trial, key);
        snprintf(key, sizeof key, "objects[%zu]", o->index);
        const asdic_yaml_node *object = draw_of(trial, key);
        good = name ? add_name(names, name) : add_object(names, object ? object : o);
    }
    return good;
}

bool asdic_scene_draw_names(const asdic_yaml_node *root, const file_trial *trial,
                            asdic_names *names) {
    const asdic_yaml_node *list = asdic_yaml_child(root, "objects");
    if (trial->node && trial->node->bad) {
        return true;
    }
    const asdic_yaml_node *choice = asdic_yaml_child(draw_of(trial, "objects"), "choice");
    bool good = choice || add_objects(names, list, trial);
    for (const asdic_yaml_node *c = choice ? choice->first : NULL; c && good; c = c->next) {
        good = add_objects(names, c, trial);
    }
    return good;
}

/* --- what may be drawn -------------------------------------------------------------------------- */

/* KEY of DRAW, two bounds. */
static bool is_ordered(const file_draw *draw, const char *key, const double pair[2],
                       asdic_problems *problems) {
    asdic_yaml_node *node = asdic_yaml_child(draw->node, key);
    if (node && pair[1] < pair[0]) {
        asdic_yaml_problem(problems, node,
                           "'%s' = [%.15g, %.15g] is empty; give the lower bound first", key,
                           pair[0], pair[1]);
        return false;
    }
    return true;
}

static void check_normal(const file_draw *draw, asdic_problems *problems) {
    asdic_yaml_node *within = asdic_yaml_child(draw->node, "within");
    asdic_yaml_node *normal = asdic_yaml_child(draw->node, "normal");
    double mean = draw->normal[0], sd = draw->normal[1];
    if (within && !normal) {
        asdic_yaml_problem(problems, within, "'within' cuts a 'normal' draw; there is none here");
        return;
    }
    if (normal && !(sd > 0.0)) {
        asdic_yaml_problem(problems, normal, "a standard deviation of %.15g is not above 0", sd);
        return;
    }
    if (!within || !is_ordered(draw, "within", draw->within, problems)) {
        return;
    }
    double low = (draw->within[0] - mean) / sd, high = (draw->within[1] - mean) / sd;
    double share = low > 0.0 ? phi(-low) - phi(-high) : phi(high) - phi(low);
    if (!(share > LEAST_SHARE)) {
        asdic_yaml_problem(problems, within,
                           "'within' = [%.15g, %.15g] leaves %.2g of the distribution with mean "
                           "%.15g and standard deviation %.15g; at least %g is needed",
                           draw->within[0], draw->within[1], share, mean, sd, LEAST_SHARE);
    }
}

static void check_values(asdic_yaml_node *node, const asdic_schema_reader *r);

static void check_draw(const file_draw *draw, const asdic_schema_reader *r) {
    if (!asdic_scene_node_good(draw->node)) {
        return;
    }
    check_normal(draw, r->problems);
    is_ordered(draw, "uniform", draw->uniform, r->problems);
    if (draw->choice && (draw->choice->kind != ASDIC_YAML_LIST || draw->choice->count == 0)) {
        asdic_yaml_problem(r->problems, draw->choice, "'choice' must be a list of values");
    } else if (draw->choice) {
        check_values(draw->choice, r);
    }
}

/* The draws in the children of NODE. */
static void check_values(asdic_yaml_node *node, const asdic_schema_reader *r) {
    for (asdic_yaml_node *child = node->first; child; child = child->next) {
        if (is_draw(child)) {
            file_draw inner = read_inner(r, child);
            check_draw(&inner, r);
        } else {
            check_values(child, r);
        }
    }
}

static void check_key(const file_draw *draw, asdic_problems *problems) {
    asdic_yaml_node *key = draw->key;
    if (!key) {
        return; /* reported as missing */
    }
    if (key->kind != ASDIC_YAML_SCALAR || key->length == 0 || strlen(key->text) != key->length) {
        asdic_yaml_problem(problems, key,
                           "'key' must be the path of a key, as objects[0].position_m");
    } else if (asdic_scene_key_turn(key->text) == ASDIC_TURN_TRIAL) {
        asdic_yaml_problem(problems, key, "a trial cannot draw its own '%s'", key->text);
    } else if (strcmp(key->text, "sampling.seed") == 0) {
        asdic_yaml_problem(problems, key,
                           "'sampling.seed' cannot be drawn: leave it out, rays and speckle are "
                           "others in each run of a trial (by its --seed), and in each frame of a "
                           "data set (by 'sampling: {seed: ...}' and the frame's number)");
    }
}

static bool is_path(const asdic_yaml_node *key) {
    return key && key->kind == ASDIC_YAML_SCALAR && key->length > 0;
}

/* Draw I must not undo one before it: what is drawn whole comes before its parts, and each key once. */
static void check_order(const file_draw *draws, size_t i, asdic_problems *problems) {
    asdic_yaml_node *key = draws[i].key;
    for (size_t k = 0; k < i && is_path(key); k++) {
        const asdic_yaml_node *other = draws[k].key;
        if (is_path(other) && asdic_scene_key_is_in(other->text, key->text)) {
            if (other->length == key->length) {
                asdic_yaml_problem(problems, key, "'%s' is drawn at line %u already; give it once",
                                   key->text, other->line);
            } else {
                asdic_yaml_problem(problems, key,
                                   "'%s' is drawn after its part '%s', which would be lost; list "
                                   "it before",
                                   key->text, other->text);
            }
            return;
        }
    }
}

void asdic_scene_draw_check(const file_trial *trial, asdic_arena *arena, asdic_problems *problems) {
    asdic_yaml_node *hits = asdic_yaml_child(trial->rule.node, "hits");
    if (trial->rule.hits > trial->rule.of && asdic_scene_node_good(hits)) {
        asdic_yaml_problem(problems, hits, "'hits' = %lld is more than 'of' = %lld pings",
                           (long long)trial->rule.hits, (long long)trial->rule.of);
    }
    const asdic_schema_reader r = {asdic_scene_table(), arena, problems, NULL, NULL};
    const file_draw *draws = trial->draws.items;
    for (size_t i = 0; i < trial->draws.count; i++) {
        check_key(&draws[i], problems);
        check_order(draws, i, problems);
        check_draw(&draws[i], &r);
    }
}

/* --- what is drawn, by the scene's tables -------------------------------------------------------- */

/* Whether KEY's value, or KEY itself, hangs on another of the DRAWS than I: that draws a part of it, or what it is in,
 * or the file that the sonar is in. */
static bool hangs(const asdic_list *draws, size_t i, bool is_part) {
    const file_draw *items = draws->items;
    const char *key = items[i].key->text;
    for (size_t k = 0; k < draws->count; k++) {
        const char *other = is_path(items[k].key) ? items[k].key->text : "";
        if (k != i && (is_part ? asdic_scene_key_is_in(other, key)
                               : asdic_scene_key_is_in(key, other) ||
                                     (strcmp(other, "sonar.file") == 0 &&
                                      asdic_scene_key_is_in(key, "sonar")))) {
            return true;
        }
    }
    return false;
}

/* Reads what DRAW gives at one of its ends, if it is a choice of CHOSEN, as the value of KEY; false after a problem. */
static bool check_end(const drawer *d, const file_draw *draw, asdic_yaml_node *chosen,
                      const asdic_key *key) {
    asdic_yaml_node value = *draw->node, scene = {0}, *key_node = draw->key;
    if (d->reader.files) { /* it stands for the scene's, and is not at fault */
        value.parent = &scene;
        value.key = key_node->text;
        value.key_length = key_node->length;
    }
    size_t before = d->reader.problems->total;
    if (chosen) {
        value.line = chosen->line;
        value.column = chosen->column;
        take_value(d, chosen, ASDIC_HASH_BEGIN, &value);
    } else {
        take_draw(d, draw, ASDIC_HASH_BEGIN, &value);
    }
    bool goes = key_node->text[key_node->length - 1] == ']' && !is_some(&value, NULL);
    if (!goes && !d->reader.arena->is_short) { /* an entry that is taken out has no value */
        asdic_schema_read_alone(&d->reader, key, &value);
    }
    return d->reader.problems->total == before;
}

static void check_looks(const asdic_schema_reader *r, const file_draw *draw,
                        asdic_yaml_node *chosen, const asdic_key *key) {
    asdic_arena arena = {0}; /* there may be as many looks as a file has values */
    drawer d = {.reader = {r->root, &arena, r->problems, r->files}};
    size_t looks = chosen ? count_looks(chosen) : 1;
    size_t ends = r->files ? 1 : sizeof shares / sizeof *shares; /* the names of files have one */
    for (bool good = true; (good || r->files) && d.look < looks; d.look++) {
        good = true;
        for (size_t i = 0; i < ends && good; i++) {
            d.share = shares[i];
            good = check_end(&d, draw, chosen, key) && !arena.is_short;
            r->arena->is_short |= arena.is_short;
            asdic_arena_finish(&arena);
        }
    }
}

static void check_ends(const asdic_schema_reader *r, const file_draw *draw, const asdic_key *key) {
    if (!draw->choice && key->type == ASDIC_KEY_INTEGER) {
        asdic_yaml_problem(r->problems, draw->node,
                           "'%s' is a whole number, of which a 'choice' can be given; others are "
                           "drawn between them",
                           key->name);
        return;
    }
    asdic_yaml_node *chosen = draw->choice ? draw->choice->first : NULL;
    do {
        check_looks(r, draw, chosen, key);
        chosen = chosen ? chosen->next : NULL;
    } while (chosen);
}

void asdic_scene_draw_check_values(const file_trial *trial, asdic_yaml_node *root,
                                   asdic_arena *arena, asdic_problems *problems) {
    const asdic_schema_reader r = {asdic_scene_table(), arena, problems, NULL, NULL};
    const file_draw *draws = trial->draws.items;
    for (size_t i = 0; i < trial->draws.count; i++) {
        asdic_yaml_node *name = draws[i].key;
        asdic_key key;
        if (!is_path(name) || name->bad || !asdic_schema_find(&r, name->text, name, &key)) {
            continue;
        }
        if (root && !hangs(&trial->draws, i, false)) {
            asdic_scene_file_find(root, name->text, name, NULL, problems);
        }
        /* What a file is to bring is not there yet. */
        bool is_whole = asdic_scene_key_turn(name->text) != ASDIC_TURN_INCLUDES ||
                        (key.type != ASDIC_KEY_MAP && key.type != ASDIC_KEY_CURVE);
        if (is_whole && asdic_scene_node_good(draws[i].node) && !hangs(&trial->draws, i, true)) {
            check_ends(&r, &draws[i], &key);
        }
    }
}

void asdic_scene_draw_name_files(const file_trial *trial, asdic_arena *arena,
                                 const asdic_file_taker *files) {
    asdic_problems untold = {0}; /* what lacks keys that are drawn apart names files all the same */
    const asdic_schema_reader r = {asdic_scene_table(), arena, &untold, files, NULL};
    const file_draw *draws = trial->draws.items;
    for (size_t i = 0; i < trial->draws.count; i++) {
        asdic_yaml_node name = *draws[i].key;
        asdic_key key;
        if (draws[i].choice && asdic_schema_find(&r, name.text, &name, &key)) {
            check_ends(&r, &draws[i], &key);
        }
    }
    asdic_problems_finish(&untold);
}
