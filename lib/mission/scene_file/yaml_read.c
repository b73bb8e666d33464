/*
 * Builds a tree from libyaml's events. libyaml accepts doubled keys, ignores a second document and
 * is slow on deep nesting; the limits prevent that and are far above any scene's needs.
 */
#include "yaml_tree.h"

#include <yaml.h>

#include <string.h>

#define MAX_DEPTH 32
#define MAX_VALUES 500000
#define MAX_KEYS 256 /* in one map; keeps the search for doubled keys short */

typedef struct yaml_reader {
    yaml_parser_t parser;
    const char *text;
    size_t size;
    asdic_arena *arena;
    asdic_problems *problems;
    size_t values;
    bool out_of_memory;
} yaml_reader;

/* libyaml's decoder gives a byte offset only. */
static void report_undecodable(yaml_reader *r) {
    unsigned line = 1, column = 1;
    for (size_t i = 0; i < r->parser.problem_offset && i < r->size; i++) {
        if (r->text[i] == '\n') {
            line++;
            column = 1;
        } else if (((unsigned char)r->text[i] & 0xc0) != 0x80) {
            column++;
        }
    }
    if (r->parser.problem_value >= 0) {
        asdic_problems_add(r->problems, line, column,
                           "not a text file in UTF-8: %s (0x%02X); save the scene as UTF-8",
                           r->parser.problem, (unsigned)r->parser.problem_value);
    } else {
        asdic_problems_add(r->problems, line, column,
                           "not a text file in UTF-8: %s; save the scene as UTF-8",
                           r->parser.problem);
    }
}

static void report_syntax(yaml_reader *r) {
    const yaml_parser_t *p = &r->parser;
    /* A key without its colon is missed only where the next one stands. */
    bool is_key = p->context && strcmp(p->context, "while scanning a simple key") == 0;
    const yaml_mark_t *at = is_key ? &p->context_mark : &p->problem_mark;
    unsigned line = (unsigned)at->line + 1, column = (unsigned)at->column + 1;
    if (p->error == YAML_SCANNER_ERROR && p->buffer.pointer && *p->buffer.pointer == '\t') {
        asdic_problems_add(
            r->problems, line, column,
            "not valid YAML: a tab cannot begin a key or a value; indent with spaces");
    } else if (is_key) {
        asdic_problems_add(r->problems, line, column, "not valid YAML: %s after this key",
                           p->problem);
    } else if (p->context) {
        asdic_problems_add(r->problems, line, column,
                           "not valid YAML: %s, %s that began at %zu:%zu", p->problem, p->context,
                           p->context_mark.line + 1, p->context_mark.column + 1);
    } else {
        asdic_problems_add(r->problems, line, column, "not valid YAML: %s", p->problem);
    }
}

/* The next event, to be deleted by the caller; false after a report. */
static bool next_event(yaml_reader *r, yaml_event_t *event) {
    if (yaml_parser_parse(&r->parser, event)) {
        return true;
    }
    if (r->parser.error == YAML_MEMORY_ERROR) {
        r->out_of_memory = true;
    } else if (r->parser.error == YAML_READER_ERROR) {
        report_undecodable(r);
    } else {
        report_syntax(r);
    }
    return false;
}

static void report_at(yaml_reader *r, const yaml_event_t *event, const char *message) {
    asdic_problems_add(r->problems, (unsigned)event->start_mark.line + 1,
                       (unsigned)event->start_mark.column + 1, "%s", message);
}

/* A node for EVENT without its children; NULL when memory is short or there are too many. */
static asdic_yaml_node *new_node(yaml_reader *r, const yaml_event_t *event) {
    if (++r->values > MAX_VALUES) {
        report_at(r, event, "more than 500000 values; put geometry into mesh files");
        return NULL;
    }
    asdic_yaml_node *node = asdic_arena_alloc(r->arena, sizeof *node);
    if (!node) {
        r->out_of_memory = true;
        return NULL;
    }
    node->line = (unsigned)event->start_mark.line + 1;
    node->column = (unsigned)event->start_mark.column + 1;
    if (event->type == YAML_SCALAR_EVENT) {
        node->kind = ASDIC_YAML_SCALAR;
        node->length = event->data.scalar.length;
        node->quoted = event->data.scalar.style != YAML_PLAIN_SCALAR_STYLE;
        node->text = asdic_arena_string(r->arena, (const char *)event->data.scalar.value,
                                        event->data.scalar.length);
        if (!node->text) {
            r->out_of_memory = true;
            return NULL;
        }
    } else if (event->type == YAML_ALIAS_EVENT) {
        node->text = "";
    } else {
        node->kind = event->type == YAML_SEQUENCE_START_EVENT ? ASDIC_YAML_LIST : ASDIC_YAML_MAP;
    }
    return node;
}

/* YAML's words for no value. */
static bool is_null(const asdic_yaml_node *node) {
    static const char *const words[] = {"~", "null", "Null", "NULL"};
    size_t i = 0;
    while (i < 4 && strcmp(node->text, words[i]) != 0) {
        i++;
    }
    return i < 4 && !node->quoted;
}

/* Refuses anchors, aliases and tags: they hide errors, and a scene needs none. */
static void refuse_decoration(yaml_reader *r, const yaml_event_t *event, asdic_yaml_node *node) {
    const yaml_char_t *anchor = NULL, *tag = NULL;
    switch (event->type) {
    case YAML_ALIAS_EVENT:
        asdic_yaml_problem(r->problems, node, "aliases (*%s) are not accepted; write the value out",
                           (const char *)event->data.alias.anchor);
        return;
    case YAML_SCALAR_EVENT:
        anchor = event->data.scalar.anchor;
        tag = event->data.scalar.tag;
        break;
    case YAML_SEQUENCE_START_EVENT:
        anchor = event->data.sequence_start.anchor;
        tag = event->data.sequence_start.tag;
        break;
    case YAML_MAPPING_START_EVENT:
        anchor = event->data.mapping_start.anchor;
        tag = event->data.mapping_start.tag;
        break;
    default:
        return;
    }
    if (anchor) {
        asdic_yaml_problem(r->problems, node, "anchors (&%s) are not accepted; leave it out",
                           (const char *)anchor);
    }
    if (tag) {
        asdic_yaml_problem(r->problems, node, "tags (%s) are not accepted; leave it out",
                           (const char *)tag);
    }
}

static bool read_children(yaml_reader *r, asdic_yaml_node *parent, unsigned depth);

/* EVENT and all below it, appended to PARENT (NULL: the root) under KEY (NULL: no key). */
static asdic_yaml_node *read_node(yaml_reader *r, const yaml_event_t *event,
                                  asdic_yaml_node *parent, const asdic_yaml_node *key,
                                  unsigned depth) {
    asdic_yaml_node *node = new_node(r, event);
    if (!node) {
        return NULL;
    }
    if (parent) {
        asdic_yaml_append(parent, node);
    }
    if (key) {
        node->key = key->text;
        node->key_length = key->length;
        node->key_line = key->line;
        node->key_column = key->column;
        if (event->type == YAML_SCALAR_EVENT && node->length == 0 && !node->quoted) {
            node->line = key->line; /* nothing stands there: point at the key */
            node->column = key->column;
        }
    }
    bool is_key = parent && parent->kind == ASDIC_YAML_MAP && !key;
    refuse_decoration(r, event, is_key ? parent : node);
    if (node->kind == ASDIC_YAML_SCALAR) {
        if (!is_key && is_null(node)) {
            node->text = "";
            node->length = 0;
        }
        return node;
    }
    if (depth >= MAX_DEPTH) {
        report_at(r, event, "nested deeper than 32 levels");
        return NULL;
    }
    return read_children(r, node, depth + 1) ? node : NULL;
}

/* The value that follows KEY in MAP. */
static bool read_value(yaml_reader *r, asdic_yaml_node *map, const asdic_yaml_node *key,
                       unsigned depth) {
    yaml_event_t event;
    if (!next_event(r, &event)) {
        return false;
    }
    const asdic_yaml_node *twin = asdic_yaml_child(map, key->text);
    asdic_yaml_node *value = read_node(r, &event, map, key, depth);
    yaml_event_delete(&event);
    if (!value) {
        return false;
    }
    if (strlen(key->text) != key->length) {
        asdic_yaml_key_problem(r->problems, value, "a key holds a zero character");
    } else if (twin) {
        asdic_yaml_key_problem(r->problems, value,
                               "duplicate key '%.*s'; it is given at line %u already",
                               asdic_yaml_key_shown(value), value->key, twin->key_line);
    }
    if (map->count > MAX_KEYS) {
        asdic_yaml_key_problem(r->problems, value, "more than 256 keys in one map");
        return false;
    }
    return true;
}

/* Why KEY is none that a scene can have; NULL: it may be one. */
static const char *key_flaw(const asdic_yaml_node *key) {
    return key->kind != ASDIC_YAML_SCALAR ? "a key is a list or a map, not a word"
           : !key->quoted && strcmp(key->text, "<<") == 0
               ? "merges (<<) are not accepted; write the keys out"
               : NULL;
}

/* Children of the list or map PARENT up to its end. */
static bool read_children(yaml_reader *r, asdic_yaml_node *parent, unsigned depth) {
    for (;;) {
        yaml_event_t event;
        if (!next_event(r, &event)) {
            return false;
        }
        bool end = event.type == YAML_SEQUENCE_END_EVENT || event.type == YAML_MAPPING_END_EVENT;
        bool ok = true;
        if (!end && parent->kind == ASDIC_YAML_LIST) {
            ok = read_node(r, &event, parent, NULL, depth) != NULL;
        } else if (!end) {
            /* A key is a node of its own, outside the tree but under its map's path. */
            asdic_yaml_node stray = *parent;
            stray.first = stray.last = NULL;
            stray.line = (unsigned)event.start_mark.line + 1;
            stray.column = (unsigned)event.start_mark.column + 1;
            asdic_yaml_node *key = read_node(r, &event, &stray, NULL, depth);
            const char *flaw = key ? key_flaw(key) : NULL;
            if (flaw) {
                asdic_yaml_problem(r->problems, &stray, "%s", flaw);
                key->text = "?";
                key->length = 1;
            }
            /* What has no key of a scene stays outside the tree: it is reported already. */
            ok = key && read_value(r, flaw ? &stray : parent, key, depth);
            parent->bad |= stray.bad;
        }
        yaml_event_delete(&event);
        if (end || !ok) {
            return ok;
        }
    }
}

/* Events from the start of the stream to its end. */
static asdic_yaml_node *read_document(yaml_reader *r) {
    asdic_yaml_node *root = NULL;
    yaml_event_t event;
    for (bool done = false; !done;) {
        if (!next_event(r, &event)) {
            return NULL;
        }
        bool ok = true;
        switch (event.type) {
        case YAML_STREAM_END_EVENT:
            done = true;
            break;
        case YAML_STREAM_START_EVENT:
        case YAML_DOCUMENT_END_EVENT:
            break;
        case YAML_DOCUMENT_START_EVENT:
            if (root) {
                report_at(r, &event, "a second document begins; one file holds one scene");
                done = true;
            }
            break;
        default:
            root = read_node(r, &event, NULL, NULL, 0);
            ok = root != NULL;
        }
        yaml_event_delete(&event);
        if (!ok) {
            return NULL;
        }
    }
    if (!root) {
        asdic_problems_add(r->problems, 1, 1, "the file is empty");
    }
    return root;
}

bool asdic_yaml_read(const char *text, size_t size, asdic_arena *arena, asdic_problems *problems,
                     asdic_yaml_node **root) {
    yaml_reader r = {.text = text, .size = size, .arena = arena, .problems = problems};
    *root = NULL;
    if (!yaml_parser_initialize(&r.parser)) {
        return false;
    }
    yaml_parser_set_encoding(&r.parser, YAML_UTF8_ENCODING);
    yaml_parser_set_input_string(&r.parser, (const unsigned char *)text, size);
    *root = read_document(&r);
    yaml_parser_delete(&r.parser);
    return !r.out_of_memory;
}
