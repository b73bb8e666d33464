/*
 * Scalars and lists of scalars: from text to value, or a report.
 */
#include "schema.h"

#include "base/number.h"
#include "base/words.h"

#include <asdic/common.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

/* More words than any key has. */
#define MAX_WORDS 32

/* NODE's key and value for a message: "'frequency_khz' = 9000", cut when long, control characters
 * replaced. */
static const char *show(const asdic_key *key, const asdic_yaml_node *node, char *buffer,
                        size_t size) {
    const size_t longest = 40;
    if (node->kind != ASDIC_YAML_SCALAR) {
        snprintf(buffer, size, "'%s' is %s, which", key->name,
                 node->kind == ASDIC_YAML_LIST ? "a list" : "a map");
        return buffer;
    }
    if (node->length == 0 && !node->quoted) {
        snprintf(buffer, size, "'%s' has no value; it", key->name);
        return buffer;
    }
    const char *quote = node->quoted ? "\"" : "";
    size_t length = asdic_words_cut(node->text, node->length, longest);
    int at = snprintf(buffer, size, "'%s' = %s", key->name, quote);
    for (size_t i = 0; i < length; i++) {
        unsigned char c = (unsigned char)node->text[i];
        buffer[at++] = (char)(c < 0x20 || c == 0x7f ? '?' : c);
    }
    snprintf(buffer + at, size - (size_t)at, "%s%s", length < node->length ? "..." : "", quote);
    return buffer;
}

/* "mud, sand, gravel": the words of KEY. */
static void list_words(const asdic_key *key, asdic_text *text) {
    for (const asdic_word *word = key->words; word && word->name; word++) {
        asdic_text_format(text, "%s%s", word == key->words ? "" : ", ", word->name);
    }
}

const asdic_word *asdic_schema_word(const asdic_key *key, const asdic_yaml_node *node) {
    if (node->kind != ASDIC_YAML_SCALAR || strlen(node->text) != node->length) {
        return NULL;
    }
    /* YAML 1.1 reads a plain off as the boolean false, and so do its converters to JSON. */
    bool is_off = !node->quoted && strcmp(node->text, "false") == 0;
    for (const asdic_word *word = key->words; word && word->name; word++) {
        if (strcmp(word->name, node->text) == 0 || (is_off && strcmp(word->name, "off") == 0)) {
            return word;
        }
    }
    return NULL;
}

/* The word of KEY that NODE may be a slip of, or NULL. */
static const char *nearest_word(const asdic_key *key, const asdic_yaml_node *node) {
    const char *names[MAX_WORDS] = {0};
    size_t count = 0;
    for (const asdic_word *word = key->words; word && word->name && count < MAX_WORDS; word++) {
        names[count++] = word->name;
    }
    bool is_scalar = node->kind == ASDIC_YAML_SCALAR;
    size_t nearest = is_scalar ? asdic_words_nearest(node->text, names, count) : count;
    return nearest < count ? names[nearest] : NULL;
}

bool asdic_schema_is_near(const asdic_key *key, const asdic_yaml_node *node) {
    return nearest_word(key, node) != NULL;
}

#define WANTED_SIZE 128

/* "a whole number in [1, 64] deg": what KEY takes but for words. */
static const char *name_number(const asdic_key *key, char wanted[WANTED_SIZE]) {
    int digits = asdic_key_digits(key);
    if (key->min == key->max) {
        snprintf(wanted, WANTED_SIZE, "%.*g", digits, key->min);
        return wanted;
    }
    snprintf(wanted, WANTED_SIZE, "a %snumber in [%.*g, %.*g]%s%s",
             key->type == ASDIC_KEY_INTEGER ? "whole " : "", digits, key->min, digits, key->max,
             key->unit ? " " : "", key->unit ? key->unit : "");
    return wanted;
}

/* NODE is none of KEY's words, nor a number where that would do. */
static void report_no_word(const asdic_schema_reader *r, const asdic_key *key,
                           asdic_yaml_node *node) {
    char shown[192];
    asdic_text words = {0};
    list_words(key, &words);
    if (key->type == ASDIC_KEY_NUMBER || key->type == ASDIC_KEY_INTEGER) {
        char wanted[WANTED_SIZE];
        asdic_text_format(&words, " or %s", name_number(key, wanted));
    }
    bool scalar = node->kind == ASDIC_YAML_SCALAR;
    const char *nearest = nearest_word(key, node);
    asdic_yaml_problem(r->problems, node, "%s %s %s%s%s%s", show(key, node, shown, sizeof shown),
                       scalar && (node->length || node->quoted) ? "is not one of"
                                                                : "must be one of",
                       words.data ? words.data : "", nearest ? "; did you mean '" : "",
                       nearest ? nearest : "", nearest ? "'?" : "");
    asdic_text_finish(&words);
}

/* The word of KEY that NODE is, or NULL after a report. */
static const asdic_word *read_word(const asdic_schema_reader *r, const asdic_key *key,
                                   asdic_yaml_node *node) {
    const asdic_word *word = asdic_schema_word(key, node);
    if (!word) {
        report_no_word(r, key, node);
    }
    return word;
}

static void report_type(const asdic_schema_reader *r, const asdic_key *key, asdic_yaml_node *node,
                        const char *wanted) {
    char shown[192];
    const char *joint = node->kind != ASDIC_YAML_SCALAR || (node->length == 0 && !node->quoted)
                            ? " must be "
                            : " is not ";
    asdic_yaml_problem(r->problems, node, "%s%s%s", show(key, node, shown, sizeof shown), joint,
                       wanted);
}

/* Whether NODE can be what is WANTED: no list, no map, not empty and not in quotes. IS_FIT: it would do without. */
static bool is_plain(const asdic_schema_reader *r, const asdic_key *key, asdic_yaml_node *node,
                     const char *wanted, bool is_fit) {
    char shown[192];
    if (node->kind != ASDIC_YAML_SCALAR || (node->length == 0 && !node->quoted)) {
        report_type(r, key, node, wanted);
        return false;
    }
    if (node->quoted) {
        asdic_yaml_problem(r->problems, node, "%s is text, not %s%s",
                           show(key, node, shown, sizeof shown), wanted,
                           is_fit ? "; leave out the quotes" : "");
        return false;
    }
    return true;
}

static void report_range(const asdic_schema_reader *r, const asdic_key *key,
                         asdic_yaml_node *node) {
    char shown[192];
    int digits = asdic_key_digits(key);
    asdic_yaml_problem(r->problems, node, "%s is out of range [%.*g, %.*g]%s%s",
                       show(key, node, shown, sizeof shown), digits, key->min, digits, key->max,
                       key->unit ? " " : "", key->unit ? key->unit : "");
}

/* WHY says what NODE is not. */
static void report_number(const asdic_schema_reader *r, const asdic_key *key, asdic_yaml_node *node,
                          const char *why) {
    char shown[192], wanted[WANTED_SIZE];
    asdic_yaml_problem(r->problems, node, "%s %s; give %s", show(key, node, shown, sizeof shown),
                       why, name_number(key, wanted));
}

/* A number, or of an INTEGER a whole one; or a word that stands for it. False: neither was read. */
static bool read_number(const asdic_schema_reader *r, const asdic_key *key, asdic_yaml_node *node,
                        double *out) {
    char wanted[WANTED_SIZE];
    bool is_whole = key->type == ASDIC_KEY_INTEGER;
    double value = NAN;
    int64_t whole = 0;
    const asdic_word *word = asdic_schema_word(key, node);
    if (word) {
        *out = word->value;
        return true;
    }
    const char *why = node->kind != ASDIC_YAML_SCALAR
                          ? (is_whole ? "is not a whole number" : "is not a number")
                      : is_whole ? asdic_integer_parse(node->text, node->length, &whole)
                                 : asdic_number_parse(node->text, node->length, &value);
    value = is_whole ? (double)whole : value; /* exact: none is read beyond 2^53 */
    if ((is_whole || !key->words) && !is_plain(r, key, node, name_number(key, wanted), !why)) {
        return false;
    }
    if (key->words && (why || node->quoted)) {
        report_no_word(r, key, node);
    } else if (why) {
        report_number(r, key, node, why);
    } else if (!(value >= key->min && value <= key->max)) {
        report_range(r, key, node);
    } else {
        *out = value;
        return true;
    }
    return false;
}

static void read_integer(const asdic_schema_reader *r, const asdic_key *key, asdic_yaml_node *node,
                         int64_t *out) {
    double value;
    if (read_number(r, key, node, &value)) {
        *out = (int64_t)value;
    }
}

/* The value of a boolean's TEXT; -1: it is none. */
static int parse_bool(const char *text, size_t length) {
    /* The booleans of YAML 1.1. Several look like words: off, no, n. */
    static const char *const words[2][11] = {
        {"false", "False", "FALSE", "no", "No", "NO", "off", "Off", "OFF", "n", "N"},
        {"true", "True", "TRUE", "yes", "Yes", "YES", "on", "On", "ON", "y", "Y"},
    };
    for (int i = 0; text && strlen(text) == length && i < 22; i++) {
        if (strcmp(text, words[i / 11][i % 11]) == 0) {
            return i / 11;
        }
    }
    return -1;
}

static void read_bool(const asdic_schema_reader *r, const asdic_key *key, asdic_yaml_node *node,
                      bool *out) {
    int value = parse_bool(node->text, node->length);
    if (!is_plain(r, key, node, "true or false", value >= 0)) {
        return;
    }
    if (value < 0) {
        report_type(r, key, node, "true or false");
    } else {
        *out = value > 0;
    }
}

static void read_numbers(const asdic_schema_reader *r, const asdic_key *key, asdic_yaml_node *node,
                         double *out) {
    char wanted[WANTED_SIZE];
    const asdic_key *second = key->ordinate ? key->ordinate : key;
    snprintf(wanted, sizeof wanted, "a list of %zu numbers%s%s%s%s", key->count,
             key->unit ? " in " : "", key->unit ? key->unit : "", key->ordinate ? " and " : "",
             key->ordinate ? second->unit : "");
    if (node->kind != ASDIC_YAML_LIST) {
        report_type(r, key, node, wanted);
        return;
    }
    if (node->count != key->count) {
        asdic_yaml_problem(r->problems, node, "'%s' has %zu entr%s; it must be %s", key->name,
                           node->count, node->count == 1 ? "y" : "ies", wanted);
        return;
    }
    for (asdic_yaml_node *item = node->first; item; item = item->next) {
        if (!item->bad) {
            read_number(r, item->index == 1 ? second : key, item, &out[item->index]);
        }
    }
}

static void read_words(const asdic_schema_reader *r, const asdic_key *key, asdic_yaml_node *node,
                       unsigned *out) {
    if (node->kind != ASDIC_YAML_LIST) {
        asdic_text words = {0};
        asdic_text_add(&words, "a list of ");
        list_words(key, &words);
        report_type(r, key, node, words.data ? words.data : "a list of words");
        asdic_text_finish(&words);
        return;
    }
    *out = 0;
    for (asdic_yaml_node *item = node->first; item; item = item->next) {
        const asdic_word *word = item->bad ? NULL : read_word(r, key, item);
        *out |= word ? 1u << (unsigned)word->value : 0;
    }
}

/* Names become parts of file names and CSV fields. */
static void read_string(const asdic_schema_reader *r, const asdic_key *key, asdic_yaml_node *node,
                        const char **out) {
    static const char fit[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";
    char shown[192];
    bool is_name = key->type == ASDIC_KEY_NAME;
    if (node->kind != ASDIC_YAML_SCALAR || node->length == 0) {
        report_type(r, key, node, is_name ? "a name" : "the name of a file");
    } else if (strlen(node->text) != node->length) {
        asdic_yaml_problem(r->problems, node, "'%s' holds a zero character", key->name);
    } else if (is_name && (strspn(node->text, fit) != node->length || node->text[0] == '.' ||
                           node->text[0] == '-')) {
        asdic_yaml_problem(r->problems, node,
                           "%s is not fit for file names; use letters, digits, '_', '-' and '.', "
                           "beginning with a letter, digit or '_'",
                           show(key, node, shown, sizeof shown));
    } else if (is_name && node->length >= ASDIC_NAME_SIZE) {
        asdic_yaml_problem(r->problems, node, "%s has %zu characters, at most %d are possible",
                           show(key, node, shown, sizeof shown), node->length, ASDIC_NAME_SIZE - 1);
    } else {
        *out = node->text;
        if (!is_name && r->files) {
            r->files->take(r->files->user, key, node);
        }
    }
}

void asdic_schema_read_value(const asdic_schema_reader *r, const asdic_key *key,
                             asdic_yaml_node *node, void *out) {
    if (node->kind == ASDIC_YAML_SCALAR && node->bad) {
        return;
    }
    const asdic_word *word;
    switch (key->type) {
    case ASDIC_KEY_NUMBER:
        read_number(r, key, node, out);
        break;
    case ASDIC_KEY_NUMBERS:
        read_numbers(r, key, node, out);
        break;
    case ASDIC_KEY_INTEGER:
        read_integer(r, key, node, out);
        break;
    case ASDIC_KEY_BOOL:
        read_bool(r, key, node, out);
        break;
    case ASDIC_KEY_WORD:
        word = read_word(r, key, node);
        if (word) {
            *(int *)out = (int)word->value;
        }
        break;
    case ASDIC_KEY_WORDS:
        read_words(r, key, node, out);
        break;
    case ASDIC_KEY_NAME:
    case ASDIC_KEY_PATH:
        read_string(r, key, node, out);
        break;
    case ASDIC_KEY_POINTS:
    case ASDIC_KEY_CURVE:
    case ASDIC_KEY_MAP:
    case ASDIC_KEY_LIST:
    case ASDIC_KEY_NODE:
        break; /* schema_read.c */
    }
}

asdic_yaml_node *asdic_schema_fallback(const asdic_schema_reader *r, const asdic_key *key) {
    asdic_yaml_node *root = NULL;
    if (key->fallback && key->fallback[0] != '[') {
        root = asdic_arena_alloc(r->arena, sizeof *root);
        if (root) {
            root->text = key->fallback;
            root->length = strlen(key->fallback);
        }
        r->problems->out_of_memory |= !root;
    } else if (key->fallback && !asdic_yaml_read(key->fallback, strlen(key->fallback), r->arena,
                                                 r->problems, &root)) {
        r->problems->out_of_memory = true;
    }
    return root;
}
