/*
 * The tables as JSON Schema, draft 7. Keys and words whose feature is still to come are left out:
 * the schema accepts what the reader accepts.
 */
#include "schema.h"

#include <string.h>

static void print_table(const asdic_table *table, asdic_text *text, int indent);

static void new_line(asdic_text *text, int indent) {
    asdic_text_format(text, "\n%*s", 2 * indent, "");
}

static void print_words(const asdic_key *key, asdic_text *text) {
    asdic_text_add(text, "\"enum\": [");
    const char *comma = "";
    bool off = false;
    for (const asdic_word *word = key->words; word->name; word++) {
        asdic_text_add(text, comma);
        asdic_text_add_json(text, word->name);
        comma = ", ";
        off |= strcmp(word->name, "off") == 0;
    }
    asdic_text_add(text, off ? ", false]" : "]"); /* YAML 1.1: a plain off is false */
}

static void print_range(const asdic_key *key, const char *type, asdic_text *text) {
    int digits = asdic_key_digits(key);
    asdic_text_format(text, "\"type\": \"%s\", \"minimum\": %.*g, \"maximum\": %.*g", type, digits,
                      key->min, digits, key->max);
}

/* A number of TYPE, or one of some words as well. */
static void print_number(const asdic_key *key, const char *type, asdic_text *text) {
    if (!key->words) {
        print_range(key, type, text);
    } else {
        asdic_text_add(text, "\"anyOf\": [{");
        print_range(key, type, text);
        asdic_text_add(text, "}, {");
        print_words(key, text);
        asdic_text_add(text, "}]");
    }
}

static void print_list(const asdic_key *key, asdic_text *text, int indent) {
    if (key->map_form) {
        asdic_text_add(text, "\"anyOf\": [{");
    }
    asdic_text_format(text, "\"type\": \"array\", \"minItems\": %zu, \"maxItems\": %zu, ",
                      key->least, key->count);
    asdic_text_add(text, "\"items\": {");
    print_table(key->table, text, indent);
    asdic_text_add(text, "}");
    if (key->map_form) {
        asdic_text_add(text, "}, {");
        print_table(key->map_form, text, indent);
        asdic_text_add(text, "}]");
    }
}

static void print_points(const asdic_key *key, size_t width, asdic_text *text) {
    asdic_text_format(text, "\"type\": \"array\", \"minItems\": %zu, \"maxItems\": %zu, ",
                      key->least, key->count);
    asdic_text_format(text,
                      "\"items\": {\"type\": \"array\", \"minItems\": %zu, \"maxItems\": %zu, "
                      "\"items\": %s{",
                      width, width, key->ordinate ? "[" : "");
    print_range(key, "number", text);
    if (key->ordinate) {
        asdic_text_add(text, "}, {");
        print_range(key->ordinate, "number", text);
    }
    asdic_text_add(text, key->ordinate ? "}]}" : "}}");
}

/* What a value of KEY may be; a map's or list's content on lines of its own. */
static void print_type(const asdic_key *key, asdic_text *text, int indent) {
    switch (key->type) {
    case ASDIC_KEY_NUMBER:
        print_number(key, "number", text);
        break;
    case ASDIC_KEY_NUMBERS:
        asdic_text_format(text, "\"type\": \"array\", \"minItems\": %zu, \"maxItems\": %zu, ",
                          key->count, key->count);
        asdic_text_add(text, "\"items\": {");
        print_range(key, "number", text);
        asdic_text_add(text, "}");
        break;
    case ASDIC_KEY_POINTS:
        print_points(key, 3, text);
        break;
    case ASDIC_KEY_CURVE: /* or its file */
        asdic_text_add(text, "\"anyOf\": [{\"type\": \"string\", \"minLength\": 1}, {");
        print_points(key, 2, text);
        asdic_text_add(text, "}]");
        break;
    case ASDIC_KEY_INTEGER:
        print_number(key, "integer", text);
        break;
    case ASDIC_KEY_BOOL:
        asdic_text_add(text, "\"type\": \"boolean\"");
        break;
    case ASDIC_KEY_WORD:
        print_words(key, text);
        break;
    case ASDIC_KEY_WORDS:
        asdic_text_add(text, "\"type\": \"array\", \"items\": {");
        print_words(key, text);
        asdic_text_add(text, "}");
        break;
    case ASDIC_KEY_NAME:
        /* A YAML reader makes numbers of names like 000. */
        asdic_text_format(text, "\"type\": [\"string\", \"number\"], \"maxLength\": %d, ",
                          ASDIC_NAME_SIZE - 1);
        asdic_text_add(text, "\"pattern\": \"^[A-Za-z0-9_][A-Za-z0-9_.-]*$\"");
        break;
    case ASDIC_KEY_PATH:
        asdic_text_add(text, "\"type\": \"string\", \"minLength\": 1");
        break;
    case ASDIC_KEY_MAP:
        print_table(key->table, text, indent);
        break;
    case ASDIC_KEY_LIST:
        print_list(key, text, indent);
        break;
    case ASDIC_KEY_NODE:
        asdic_text_add(text, "\"not\": {\"type\": \"null\"}");
        break;
    }
}

/* KEY's fallback as JSON: the same text for numbers and booleans, words in quotes. */
static void print_fallback(const asdic_key *key, asdic_text *text) {
    const char *at = key->fallback;
    bool words = key->type == ASDIC_KEY_WORD || key->type == ASDIC_KEY_WORDS || key->words;
    asdic_text_add(text, ", \"default\": ");
    while (*at) {
        size_t mark = strcspn(at, "[], ");
        if (mark > 0 && words) {
            asdic_text_format(text, "\"%.*s\"", (int)mark, at);
        } else if (mark > 0) {
            asdic_text_add_bytes(text, at, mark);
        } else {
            mark = 1;
            asdic_text_add_bytes(text, at, mark);
        }
        at += mark;
    }
}

/* What TEXT is made of is ended with it; memory that was short for PART is short for TEXT. */
static void finish_part(asdic_text *text, asdic_text *part) {
    text->failed |= part->failed;
    asdic_text_finish(part);
}

static void print_key(const asdic_key *key, asdic_text *text, int indent) {
    asdic_text about = {0};
    asdic_text_add_json(text, key->name);
    asdic_text_add(text, ": {\"description\": ");
    asdic_text_format(&about, "%s%s%s%s%s%s", key->doc, key->unit ? " [" : "",
                      key->unit ? key->unit : "", key->ordinate ? " and " : "",
                      key->ordinate ? key->ordinate->unit : "", key->unit ? "]" : "");
    asdic_text_add_json(text, about.data ? about.data : "");
    finish_part(text, &about);
    if (key->fallback) {
        print_fallback(key, text);
    }
    asdic_text_add(text, ", ");
    print_type(key, text, indent);
    asdic_text_add(text, "}");
}

/* One law's keys beside those that all have, and which of them are alternatives. */
static void print_law(const asdic_table *table, const char *law, asdic_text *text) {
    const asdic_key *earlier = NULL;
    asdic_text names = {0}, pairs = {0};
    for (size_t i = 0; i < table->key_count; i++) {
        const asdic_key *key = &table->keys[i];
        if (key->law && strcmp(key->law, law) != 0) {
            continue;
        }
        asdic_text_format(&names, "%s\"%s\"", names.length ? ", " : "", key->name);
        for (size_t k = 0; key->law && key->chooses && k < i; k++) {
            earlier = &table->keys[k];
            if (earlier->law && strcmp(earlier->law, law) == 0 && earlier->chooses) {
                asdic_text_format(&pairs, "%s{\"required\": [\"%s\", \"%s\"]}",
                                  pairs.length ? ", " : "", earlier->name, key->name);
            }
        }
    }
    asdic_text_format(text, "{\"title\": \"%s\", \"propertyNames\": {\"enum\": [%s]}", law,
                      names.data ? names.data : "");
    if (pairs.length) {
        asdic_text_format(text, ", \"not\": {\"anyOf\": [%s]}", pairs.data);
    }
    asdic_text_add(text, "}");
    finish_part(text, &names);
    finish_part(text, &pairs);
}

/* The keys of one law at most. */
static void print_laws(const asdic_table *table, asdic_text *text, int indent) {
    const char *last = NULL;
    for (size_t i = 0; i < table->key_count; i++) {
        const char *law = table->keys[i].law;
        if (law && (!last || strcmp(law, last) != 0)) {
            asdic_text_add(text, last ? "," : "\"allOf\": [{\"anyOf\": [");
            new_line(text, indent + 1);
            print_law(table, law, text);
            last = law;
        }
    }
    if (last) {
        asdic_text_add(text, "]}],");
        new_line(text, indent);
    }
}

/* `"required": [...]`, and one sub-schema for each key of which only one may be given. */
static void print_rules(const asdic_table *table, asdic_text *text, int indent) {
    asdic_text required = {0}, unless = {0}, one_of = {0}, pairs = {0}, either = {0};
    const asdic_key *earlier = NULL;
    const char *other = NULL; /* the one key of a table that makes others needless */
    for (size_t i = 0; i < table->key_count; i++) {
        const asdic_key *key = &table->keys[i];
        if (key->instead) { /* beside `unless` */
            asdic_text_format(&either,
                              ", \"anyOf\": [{\"required\": [\"%s\"]}, {\"required\": "
                              "[\"%s\"]}]",
                              key->name, key->instead);
        } else if ((key->flags & ASDIC_KEY_REQUIRED) && key->unless) {
            asdic_text_format(&unless, "%s\"%s\"", unless.length ? ", " : "", key->name);
            other = key->unless;
        } else if (key->flags & ASDIC_KEY_REQUIRED) {
            asdic_text_format(&required, "%s\"%s\"", required.length ? ", " : "", key->name);
        }
        if (key->flags & ASDIC_KEY_ONE_OF) {
            asdic_text_format(&one_of, "%s{\"required\": [\"%s\"]}", one_of.length ? ", " : "",
                              key->name);
        }
        if ((key->flags & ASDIC_KEY_AT_MOST_ONE) && earlier) {
            asdic_text_format(&pairs, "%s\"%s\", \"%s\"", pairs.length ? ", " : "", earlier->name,
                              key->name);
        }
        earlier = key->flags & ASDIC_KEY_AT_MOST_ONE ? key : earlier;
    }
    if (other) {
        asdic_text_format(text,
                          "\"if\": {\"not\": {\"required\": [\"%s\"]}}, "
                          "\"then\": {\"required\": [%s]%s},",
                          other, unless.data ? unless.data : "", either.data ? either.data : "");
        new_line(text, indent);
    }
    const struct {
        const char *before, *between, *after;
    } forms[] = {{"\"required\": [", required.data, "],"},
                 {"\"oneOf\": [", one_of.data, "],"},
                 {"\"not\": {\"required\": [", pairs.data, "]},"}};
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
        if (forms[i].between) {
            asdic_text_format(text, "%s%s%s", forms[i].before, forms[i].between, forms[i].after);
            new_line(text, indent);
        }
    }
    finish_part(text, &required);
    finish_part(text, &unless);
    finish_part(text, &either);
    finish_part(text, &one_of);
    finish_part(text, &pairs);
}

static void print_map(const asdic_table *table, asdic_text *text, int indent) {
    asdic_text_add(text, "\"type\": \"object\", \"additionalProperties\": false,");
    new_line(text, indent + 1);
    print_rules(table, text, indent + 1);
    print_laws(table, text, indent + 1);
    asdic_text_add(text, "\"properties\": {");
    const char *comma = "";
    for (size_t i = 0; i < table->key_count; i++) {
        asdic_text_add(text, comma);
        new_line(text, indent + 2);
        print_key(&table->keys[i], text, indent + 2);
        comma = ",";
    }
    asdic_text_add(text, "}");
}

/* The words of other keys that may stand in the place of a map. */
static void print_other_words(const asdic_table *table, asdic_text *text) {
    for (size_t k = 0; table->scalar_is_any_word && k < table->key_count; k++) {
        const asdic_key *key = &table->keys[k];
        if (key->words && strcmp(key->name, table->scalar_key) != 0) {
            asdic_text_add(text, "}, {");
            print_words(key, text);
        }
    }
}

/* A map, or what may stand in its place. */
static void print_table(const asdic_table *table, asdic_text *text, int indent) {
    const char *stand_in = table->list_key ? table->list_key : table->scalar_key;
    if (!stand_in && !table->scalar_word) {
        print_map(table, text, indent);
        return;
    }
    asdic_text_add(text, "\"anyOf\": [{");
    if (stand_in) {
        print_type(asdic_schema_key(table, stand_in), text, indent);
    } else {
        asdic_text_format(text, "\"const\": \"%s\"", table->scalar_word);
    }
    asdic_text_add(text, "}, {");
    print_map(table, text, indent);
    print_other_words(table, text);
    asdic_text_add(text, "}]");
}

void asdic_schema_print(const asdic_table *root, asdic_text *text) {
    asdic_text_add(text, "{\"$schema\": \"http://json-schema.org/draft-07/schema#\",\n"
                         "  \"title\": \"asdic scene file\", \"description\": ");
    asdic_text_add_json(text, root->doc);
    asdic_text_add(text, ",\n  ");
    print_map(root, text, 0);
    asdic_text_add(text, "}\n");
}
