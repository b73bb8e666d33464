#include "yaml_tree.h"

#include <string.h>

static void indent(asdic_text *text, unsigned depth) {
    for (unsigned i = 0; i < depth; i++) {
        asdic_text_add(text, "  ");
    }
}

/* Whether TEXT without quotes is read as what it is; all that was written without quotes is. */
static bool is_plain(const char *text) {
    size_t length = strlen(text);
    bool begins = !strchr(",[]{}#&*!|>'\"%@` \t", text[0]) &&
                  (!strchr("-?:", text[0]) || (text[1] && !strchr(" \t", text[1])));
    bool ends = !strchr(": \t", text[length - 1]);
    for (size_t i = 0; i + 1 < length; i++) {
        bool is_key = text[i] == ':' && strchr(" \t", text[i + 1]);
        bool is_comment = text[i + 1] == '#' && strchr(" \t", text[i]);
        if (is_key || is_comment || strchr("\r\n", text[i])) {
            return false;
        }
    }
    return begins && ends;
}

static void print_scalar(asdic_text *text, const asdic_yaml_node *node) {
    if (node->quoted || (node->length && !is_plain(node->text))) {
        asdic_text_add_json(text, node->text);
    } else {
        asdic_text_add(text, node->length ? node->text : "null");
    }
}

/* A list of numbers alone fits on a line. */
static bool is_numeric(const asdic_yaml_node *list) {
    for (const asdic_yaml_node *child = list->first; child; child = child->next) {
        bool is_number = child->kind == ASDIC_YAML_SCALAR && !child->quoted && child->length &&
                         strspn(child->text, "0123456789+-.eE") == child->length;
        if (!is_number) {
            return false;
        }
    }
    return true;
}

static void print_children(asdic_text *text, const asdic_yaml_node *node, unsigned depth);

/* Writes what follows "key:" or "-", on its line and below. */
static void print_value(asdic_text *text, const asdic_yaml_node *node, unsigned depth) {
    if (node->kind == ASDIC_YAML_SCALAR) {
        asdic_text_add(text, " ");
        print_scalar(text, node);
        asdic_text_add(text, "\n");
    } else if (!node->first) {
        asdic_text_add(text, node->kind == ASDIC_YAML_MAP ? " {}\n" : " []\n");
    } else if (node->kind == ASDIC_YAML_LIST && is_numeric(node)) {
        const char *comma = " [";
        for (const asdic_yaml_node *child = node->first; child; child = child->next) {
            asdic_text_add(text, comma);
            print_scalar(text, child);
            comma = ", ";
        }
        asdic_text_add(text, "]\n");
    } else {
        asdic_text_add(text, "\n");
        print_children(text, node, depth);
    }
}

static void print_children(asdic_text *text, const asdic_yaml_node *node, unsigned depth) {
    for (const asdic_yaml_node *child = node->first; child; child = child->next) {
        indent(text, depth);
        if (node->kind == ASDIC_YAML_MAP) {
            asdic_text_add_bytes(text, child->key, child->key_length);
            asdic_text_add(text, ":");
        } else {
            asdic_text_add(text, "-");
        }
        print_value(text, child, depth + 1);
    }
}

void asdic_yaml_print(const asdic_yaml_node *root, asdic_text *text) {
    print_children(text, root, 0);
}

void asdic_yaml_print_flow(const asdic_yaml_node *node, bool is_json,
                           void (*scalar)(const asdic_yaml_node *node, asdic_text *text),
                           asdic_text *text) {
    const char *comma = "";
    if (node->kind == ASDIC_YAML_SCALAR) {
        scalar(node, text);
        return;
    }
    asdic_text_add(text, node->kind == ASDIC_YAML_MAP ? "{" : "[");
    for (const asdic_yaml_node *child = node->first; child; child = child->next) {
        asdic_text_add(text, comma);
        if (child->key && is_json) {
            asdic_text_add_json(text, child->key);
        } else if (child->key) {
            asdic_text_add_bytes(text, child->key, child->key_length);
        }
        asdic_text_add(text, child->key ? ": " : "");
        asdic_yaml_print_flow(child, is_json, scalar, text);
        comma = ", ";
    }
    asdic_text_add(text, node->kind == ASDIC_YAML_MAP ? "}" : "]");
}
