/* Poses from lines: JSON objects, or comma-separated values with or without a header. */
#include "serve.h"

#include "cli_state.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const serve_columns[SERVE_COLUMNS] = {"time_s",   "x_m",       "y_m",    "z_m",
                                                  "roll_deg", "pitch_deg", "yaw_deg"};

#define ORDER "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg"

serve_reader serve_reader_begin(void) {
    serve_reader r = {.fields = SERVE_COLUMNS};
    for (int i = 0; i < SERVE_COLUMNS; i++) {
        r.column[i] = i;
    }
    return r;
}

/* Index of the name TEXT[0..LENGTH) among the columns; -1: unknown. */
static int find_column(const char *text, size_t length) {
    for (int i = 0; i < SERVE_COLUMNS; i++) {
        if (strlen(serve_columns[i]) == length && memcmp(serve_columns[i], text, length) == 0) {
            return i;
        }
    }
    return -1;
}

/* Shorter names are near to any other. */
#define LEAST_LETTERS 4

/* Whether the name TEXT[0..LENGTH), which is no column's, was meant for one, as yaw for yaw_deg; others are somebody
 * else's, and passed over. */
static bool is_misspelt(const char *text, size_t length, char *why) {
    char name[32];
    const char *meant = NULL;
    if (length == 0 || length >= sizeof name) {
        return false;
    }
    memcpy(name, text, length);
    name[length] = '\0';
    for (int i = 0; i < SERVE_COLUMNS && !meant; i++) {
        bool is_stem =
            strncmp(serve_columns[i], name, length) == 0 && serve_columns[i][length] == '_';
        meant = is_stem ? serve_columns[i] : NULL;
    }
    if (!meant && length >= LEAST_LETTERS) {
        meant = cli_nearest(name, serve_columns, SERVE_COLUMNS);
    }
    if (meant) {
        snprintf(why, SERVE_WHY_SIZE, "unknown name '%s'; did you mean '%s'?", name, meant);
    }
    return meant != NULL;
}

static const char *skip_blanks(const char *at) {
    return at + strspn(at, " \t");
}

/* A finite number at *AT, moved behind it. The program never leaves the "C" locale. */
static bool read_number(const char **at, double *out) {
    char *end;
    if (!(isdigit((unsigned char)**at) || **at == '-' || **at == '+' || **at == '.')) {
        return false; /* no "nan", no "inf" */
    }
    *out = strtod(*at, &end);
    bool good = end != *at && isfinite(*out);
    *at = end;
    return good;
}

static serve_line take(serve_request *out, char *why) {
    const double degree = CLI_PI / 180.0; /* as tracks are read */
    for (int i = SERVE_X; i <= SERVE_Z; i++) {
        if (isnan(out->value[i])) {
            snprintf(why, SERVE_WHY_SIZE, "'%s' is missing; x_m, y_m and z_m are needed",
                     serve_columns[i]);
            return SERVE_BAD;
        }
    }
    for (int i = SERVE_ROLL; i <= SERVE_YAW; i++) {
        out->value[i] = isnan(out->value[i]) ? 0.0 : out->value[i];
    }
    out->pose = (asdic_pose){{out->value[SERVE_X], out->value[SERVE_Y], out->value[SERVE_Z]},
                             out->value[SERVE_ROLL] * degree,
                             out->value[SERVE_PITCH] * degree,
                             out->value[SERVE_YAW] * degree};
    return SERVE_POSE;
}

static bool bad_json(const char *line, const char *at, const char *expected, char *why) {
    snprintf(why, SERVE_WHY_SIZE, "column %zu: %s expected in the JSON object",
             (size_t)(at - line) + 1, expected);
    return false;
}

/* Skips the value of an unknown name: a string without escapes, a number, true, false or null. */
static bool skip_value(const char **at) {
    double number;
    if (**at == '"') {
        const char *end = strchr(*at + 1, '"');
        *at = end ? end + 1 : *at;
        return end != NULL;
    }
    static const char *const words[] = {"true", "false", "null"};
    for (int i = 0; i < 3; i++) {
        if (strncmp(*at, words[i], strlen(words[i])) == 0) {
            *at += strlen(words[i]);
            return true;
        }
    }
    return read_number(at, &number);
}

bool serve_read_object(const char *line, double value[SERVE_COLUMNS], char why[SERVE_WHY_SIZE]) {
    const char *at = skip_blanks(line);
    for (int i = 0; i < SERVE_COLUMNS; i++) {
        value[i] = NAN;
    }
    if (*at != '{') {
        return bad_json(line, at, "a {", why);
    }
    at = skip_blanks(at + 1);
    while (*at != '}') {
        const char *name = at + 1, *end = *at == '"' ? strchr(name, '"') : NULL;
        if (!end) {
            return bad_json(line, at, "a name in double quotes", why);
        }
        int column = find_column(name, (size_t)(end - name));
        if (column < 0 && is_misspelt(name, (size_t)(end - name), why)) {
            return false;
        }
        at = skip_blanks(end + 1);
        if (*at != ':') {
            return bad_json(line, at, "a colon", why);
        }
        at = skip_blanks(at + 1);
        if (column >= 0 && !isnan(value[column])) {
            snprintf(why, SERVE_WHY_SIZE, "'%s' is there twice", serve_columns[column]);
            return false;
        }
        if (column >= 0 ? !read_number(&at, &value[column]) : !skip_value(&at)) {
            return bad_json(line, at, column >= 0 ? "a number" : "a number, string or word", why);
        }
        at = skip_blanks(at);
        if (*at != ',' && *at != '}') {
            return bad_json(line, at, "a comma or }", why);
        }
        if (*at == ',') {
            at = skip_blanks(at + 1);
            if (*at == '}') {
                return bad_json(line, at, "a name in double quotes", why);
            }
        }
    }
    at = skip_blanks(at + 1);
    return !*at || bad_json(line, at, "the end of the line", why);
}

static serve_line read_header(serve_reader *r, const char *line, char *why) {
    bool seen[SERVE_COLUMNS] = {false};
    serve_reader now = {.has_header = true};
    for (const char *at = line;; at++) {
        const char *end = at + strcspn(at, ",");
        const char *from = at + strspn(at, " \t\""), *to = end;
        while (to > from && strchr(" \t\"", to[-1])) {
            to--;
        }
        int column = find_column(from, (size_t)(to - from));
        if (column < 0 && is_misspelt(from, (size_t)(to - from), why)) {
            return SERVE_BAD;
        }
        if (now.fields == SERVE_MAX_FIELDS || (column >= 0 && seen[column])) {
            snprintf(why, SERVE_WHY_SIZE,
                     now.fields == SERVE_MAX_FIELDS ? "more than 32 columns"
                                                    : "a column is there twice in the header");
            return SERVE_BAD;
        }
        now.column[now.fields++] = column;
        if (column >= 0) {
            seen[column] = true;
        }
        at = end;
        if (!*at) {
            break;
        }
    }
    if (!seen[SERVE_X] || !seen[SERVE_Y] || !seen[SERVE_Z]) {
        snprintf(why, SERVE_WHY_SIZE, "the header lacks x_m, y_m or z_m; a full one is " ORDER);
        return SERVE_BAD;
    }
    *r = now;
    return SERVE_NOTHING;
}

static serve_line read_values(const serve_reader *r, const char *line, serve_request *out,
                              char *why) {
    const char *at = line;
    for (size_t i = 0;; i++) {
        const char *end = at + strcspn(at, ",");
        if (i < r->fields && r->column[i] >= 0) {
            const char *name = serve_columns[r->column[i]];
            const char *from = skip_blanks(at), *behind = from;
            if (!read_number(&behind, &out->value[r->column[i]]) || skip_blanks(behind) != end) {
                snprintf(why, SERVE_WHY_SIZE, "'%s' = '%.*s' is not a number", name,
                         (int)(end - from > 40 ? 40 : end - from), from);
                return SERVE_BAD;
            }
        }
        if ((i + 1 == r->fields) != (*end == '\0')) {
            snprintf(why, SERVE_WHY_SIZE, "%s%zu values are expected%s",
                     i + 1 == r->fields ? "more than " : "", r->fields,
                     r->has_header ? " by the header" : ": " ORDER);
            return SERVE_BAD;
        }
        if (!*end) {
            return take(out, why);
        }
        at = end + 1;
    }
}

static bool is_control(char c) {
    return (unsigned char)c < 0x20 ? c != '\t' : c == 0x7f;
}

/* Whether all of LINE is text: what is none would end the line early, or spoil an answer that quotes it. */
static bool is_text(const char *line, size_t length, char *why) {
    for (size_t at = 0; at < length;) {
        size_t size = asdic_utf8_character(line + at, length - at);
        if (size == 0 || is_control(line[at])) {
            snprintf(why, SERVE_WHY_SIZE, "column %zu: the byte 0x%02x is no text in UTF-8", at + 1,
                     (unsigned char)line[at]);
            return false;
        }
        at += size;
    }
    return true;
}

serve_line serve_read_line(serve_reader *reader, const char *line, size_t length,
                           serve_request *out, char why[SERVE_WHY_SIZE]) {
    const char *at = skip_blanks(line);
    if (!is_text(line, length, why)) {
        return SERVE_BAD;
    }
    for (int i = 0; i < SERVE_COLUMNS; i++) {
        out->value[i] = NAN;
    }
    if (*at == '\0') {
        return SERVE_NOTHING;
    }
    if (*at == '{') {
        return serve_read_object(line, out->value, why) ? take(out, why) : SERVE_BAD;
    }
    bool is_header = isalpha((unsigned char)*at) || *at == '"' || *at == '_';
    return is_header ? read_header(reader, at, why) : read_values(reader, at, out, why);
}
