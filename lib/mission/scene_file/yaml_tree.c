#include "yaml_tree.h"

#include "base/words.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LONGEST_KEY 64

asdic_yaml_node *asdic_yaml_child(const asdic_yaml_node *map, const char *key) {
    if (!map || map->kind != ASDIC_YAML_MAP) {
        return NULL;
    }
    for (asdic_yaml_node *child = map->first; child; child = child->next) {
        if (strlen(key) == child->key_length && memcmp(child->key, key, child->key_length) == 0) {
            return child;
        }
    }
    return NULL;
}

int asdic_yaml_key_shown(const asdic_yaml_node *node) {
    return (int)asdic_words_cut(node->key, node->key_length, LONGEST_KEY);
}

void asdic_yaml_append(asdic_yaml_node *parent, asdic_yaml_node *child) {
    child->parent = parent;
    child->index = parent->count++;
    if (parent->last) {
        parent->last->next = child;
    } else {
        parent->first = child;
    }
    parent->last = child;
}

void asdic_yaml_set_file(asdic_yaml_node *node, const char *file) {
    node->file = file;
    for (asdic_yaml_node *child = node->first; child; child = child->next) {
        asdic_yaml_set_file(child, file);
    }
}

void asdic_yaml_filter(asdic_yaml_node *parent,
                       bool (*stays)(const asdic_yaml_node *child, const void *user),
                       const void *user) {
    asdic_yaml_node *next = parent->first;
    parent->first = parent->last = NULL;
    parent->count = 0;
    while (next) {
        asdic_yaml_node *child = next;
        next = child->next;
        child->next = NULL;
        if (stays(child, user)) {
            asdic_yaml_append(parent, child);
        }
    }
}

/* "sonar.receivers[2].pitch_deg" into the end of BUFFER; returns its start. Levels that do not fit
 * are left out at the front. */
static const char *path_of(const asdic_yaml_node *node, char *buffer, size_t size) {
    size_t at = size - 1;
    buffer[at] = '\0';
    for (; node && node->parent; node = node->parent) {
        char step[96];
        const char *dot = buffer[at] && buffer[at] != '[' ? "." : "";
        if (node->key) {
            snprintf(step, sizeof step, "%.*s%s", asdic_yaml_key_shown(node), node->key, dot);
        } else {
            snprintf(step, sizeof step, "[%zu]%s", node->index, dot);
        }
        size_t length = strlen(step);
        if (length > at) {
            break;
        }
        at -= length;
        memcpy(buffer + at, step, length);
    }
    return buffer[at] ? buffer + at : "scene";
}

/* A problem of NODE, with the path of PATH. */
static void add_problem(asdic_problems *problems, const asdic_yaml_node *node,
                        const asdic_yaml_node *path, const unsigned place[2], const char *format,
                        va_list args) {
    char buffer[256];
    const char *name = problems->name;
    char *message = NULL;
    if (vasprintf(&message, format, args) < 0) {
        problems->out_of_memory = true;
        return;
    }
    problems->name = node && node->file ? node->file : name;
    asdic_problems_add(problems, place[0], place[1], "%s  [%s]", message,
                       path_of(path, buffer, sizeof buffer));
    problems->name = name;
    free(message);
}

void asdic_yaml_mark_bad(asdic_yaml_node *node) {
    for (; node; node = node->parent) {
        node->bad = true;
    }
}

void asdic_yaml_problem(asdic_problems *problems, asdic_yaml_node *node, const char *format, ...) {
    va_list args;
    va_start(args, format);
    const unsigned place[2] = {node ? node->line : 0, node ? node->column : 0};
    add_problem(problems, node, node, place, format, args);
    va_end(args);
    asdic_yaml_mark_bad(node);
}

void asdic_yaml_key_problem(asdic_problems *problems, asdic_yaml_node *node, const char *format,
                            ...) {
    va_list args;
    va_start(args, format);
    const unsigned place[2] = {node->key_line, node->key_column};
    add_problem(problems, node, node->parent, place, format, args);
    va_end(args);
    asdic_yaml_mark_bad(node);
}
