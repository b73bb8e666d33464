/* Poses from lines: JSON objects, or comma-separated values with or without a header. */
#include "serve.h"

#include "cli_state.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

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
/* Longer names are no misspelt ones. */
#define NAME_SIZE 64

/* What a line or header names. */
typedef struct name_list {
    bool has[SERVE_COLUMNS];
    char strange[SERVE_COLUMNS][NAME_SIZE]; /* an unknown name that may be meant for the column */
} name_list;

/* "yaw" or "yaw_..." for the stem "yaw". */
static bool has_stem(const char *name, const char *stem, size_t length) {
    return strncasecmp(name, stem, length) == 0 && (name[length] == '\0' || name[length] == '_');
}

/* The column that NAME, which is no column's, was meant for, as yaw or heading_rad for yaw_deg; -1: none. */
static int meant_column(const char *name) {
    static const struct {
        const char *stem;
        int column;
    } others[] = {{"depth", SERVE_Z}, {"heading", SERVE_YAW}, {"hdg", SERVE_YAW},
                  {"psi", SERVE_YAW}, {"theta", SERVE_PITCH}, {"phi", SERVE_ROLL}};
    for (int i = 0; i < SERVE_COLUMNS; i++) {
        if (has_stem(name, serve_columns[i], strcspn(serve_columns[i], "_"))) {
            return i;
        }
    }
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        if (has_stem(name, others[i].stem, strlen(others[i].stem))) {
            return others[i].column;
        }
    }
    const char *near =
        strlen(name) < LEAST_LETTERS ? NULL : cli_nearest(name, serve_columns, SERVE_COLUMNS);
    return near ? find_column(near, strlen(near)) : -1;
}

static bool ends_with(const char *name, const char *unit) {
    size_t length = strlen(name), size = strlen(unit);
    return length > size && strcmp(name + length - size, unit) == 0;
}

/* Whether NAME is of all three angles in another form. */
static bool is_attitude(const char *name) {
    static const char *const stems[] = {"qx",       "qy",   "qz",         "qw",
                                        "q",        "quat", "quaternion", "orientation",
                                        "attitude", "rpy",  "ypr",        "euler"};
    bool found = false;
    for (size_t i = 0; i < sizeof stems / sizeof *stems; i++) {
        found |= has_stem(name, stems[i], strlen(stems[i]));
    }
    return found;
}

/* An unknown name with a number, or IS_MANY of them: meant for a column by its spelling, or for one of the angles or
 * the depth by its unit, or for all angles. */
static void note_strange(name_list *names, const char *text, size_t length, bool is_many) {
    char name[NAME_SIZE];
    if (length == 0 || length >= sizeof name) {
        return;
    }
    memcpy(name, text, length);
    name[length] = '\0';
    int first = is_many ? -1 : meant_column(name), last = first;
    if (is_attitude(name) ||
        (!is_many && first < 0 && (ends_with(name, "_deg") || ends_with(name, "_rad")))) {
        first = SERVE_ROLL;
        last = SERVE_YAW;
    } else if (!is_many && first < 0 && ends_with(name, "_m")) {
        first = last = SERVE_Z;
    }
    for (int i = first; i >= 0 && i <= last; i++) {
        if (!names->strange[i][0]) {
            memcpy(names->strange[i], name, sizeof name);
        }
    }
}

/* Whether an unknown name was meant for a column that is not there, or is one's without its unit; the others are
 * somebody else's, and passed over. */
static bool is_misspelt(const name_list *names, char *why) {
    for (int i = 0; i < SERVE_COLUMNS; i++) {
        const char *name = names->strange[i];
        size_t stem = strcspn(serve_columns[i], "_");
        bool is_bare = has_stem(name, serve_columns[i], stem) && name[stem] == '\0';
        if (!*name || (names->has[i] && !is_bare)) {
            continue;
        }
        if (meant_column(name) == i) {
            snprintf(why, SERVE_WHY_SIZE, "unknown name '%s'; did you mean '%s'?", name,
                     serve_columns[i]);
        } else {
            snprintf(why, SERVE_WHY_SIZE, "unknown name '%s'; the names are " ORDER, name);
        }
        return true;
    }
    return false;
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

/* As in a track: beyond, the time of a ping is lost to rounding, of this pose and of those that follow without one. */
#define MOST_TIME_S 1e12

static serve_line take(serve_request *out, char *why) {
    const double degree = CLI_PI / 180.0; /* as tracks are read */
    for (int i = SERVE_X; i <= SERVE_Z; i++) {
        if (isnan(out->value[i])) {
            snprintf(why, SERVE_WHY_SIZE, "'%s' is missing; x_m, y_m and z_m are needed",
                     serve_columns[i]);
            return SERVE_BAD;
        }
    }
    if (fabs(out->value[SERVE_TIME]) > MOST_TIME_S) {
        snprintf(why, SERVE_WHY_SIZE, "'time_s' = %g is out of range [-%g, %g] s",
                 out->value[SERVE_TIME], MOST_TIME_S, MOST_TIME_S);
        return SERVE_BAD;
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

/* Behind the string at *AT, whatever it holds. */
static bool skip_string(const char **at) {
    const char *end = *at + 1;
    while (**at == '"' && *end && *end != '"') {
        end += end[0] == '\\' && end[1] ? 2 : 1;
    }
    bool good = **at == '"' && *end == '"';
    *at = good ? end + 1 : *at;
    return good;
}

/* Deeper values are refused, so that no line exhausts the stack. */
#define MOST_LEVELS 32

static bool skip_value(const char **at, int level);

/* Behind the list or object at *AT. */
static bool skip_list(const char **at, int level) {
    bool is_object = **at == '{';
    char end = is_object ? '}' : ']';
    *at = skip_blanks(*at + 1);
    for (bool is_first = true; !is_first || **at != end; is_first = false) {
        if (is_object && !skip_string(at)) {
            return false;
        }
        *at = skip_blanks(*at);
        if (is_object && **at != ':') {
            return false;
        }
        *at = skip_blanks(*at + is_object);
        if (!skip_value(at, level)) {
            return false;
        }
        *at = skip_blanks(*at);
        if (**at == end) {
            break;
        }
        if (**at != ',') {
            return false;
        }
        *at = skip_blanks(*at + 1);
    }
    ++*at;
    return true;
}

static bool skip_word(const char **at, const char *word) {
    bool good = strncmp(*at, word, strlen(word)) == 0;
    *at += good ? strlen(word) : 0;
    return good;
}

/* Behind the value of an unknown name; else *AT is where it is none. */
static bool skip_value(const char **at, int level) {
    const char *from = *at;
    double number;
    if (*from == '"') {
        return skip_string(at);
    }
    if (*from == '{' || *from == '[') {
        return level < MOST_LEVELS && skip_list(at, level + 1);
    }
    if (skip_word(at, "true") || skip_word(at, "false") || skip_word(at, "null")) {
        return true;
    }
    read_number(at, &number);
    return *at != from; /* also too large a one */
}

/* Copies a name of *LENGTH bytes to OUT, with "\u0078" as x; what is not in ASCII stays as it is, like the other
 * escapes, since no name of ours has them. Of longer names *LENGTH is 0: they are nobody's. */
static void plain_name(const char *text, size_t *length, char out[NAME_SIZE]) {
    size_t used = 0, at = 0;
    while (at < *length && used + 2 < NAME_SIZE) {
        bool is_escape = text[at] == '\\';
        bool is_ascii = is_escape && *length - at >= 6 && memcmp(text + at + 1, "u00", 3) == 0 &&
                        text[at + 4] >= '2' && text[at + 4] <= '7' &&
                        isxdigit((unsigned char)text[at + 5]);
        if (is_ascii) {
            const char code[] = {text[at + 4], text[at + 5], '\0'};
            out[used++] = (char)strtol(code, NULL, 16);
            at += 6;
        } else {
            out[used++] = text[at++];
        }
        if (is_escape && !is_ascii) { /* what is escaped, as another backslash */
            out[used++] = text[at++];
        }
    }
    *length = at < *length ? 0 : used;
}

/* "x_m": 1 and the like at *AT, moved behind it. */
static bool read_member(const char *line, const char **at, name_list *names, size_t *known,
                        double value[SERVE_COLUMNS], char *why) {
    const char *text = *at + 1;
    char name[NAME_SIZE];
    if (!skip_string(at)) {
        return bad_json(line, *at, "a name in double quotes", why);
    }
    size_t length = (size_t)(*at - 1 - text);
    plain_name(text, &length, name);
    int column = find_column(name, length);
    *at = skip_blanks(*at);
    if (**at != ':') {
        return bad_json(line, *at, "a colon", why);
    }
    *at = skip_blanks(*at + 1);
    if (column < 0) {
        bool is_many = **at == '{' || **at == '[';
        if (is_many || **at == '-' || isdigit((unsigned char)**at)) {
            note_strange(names, name, length, is_many);
        }
        return skip_value(at, 0) || bad_json(line, *at, "a value, at most 32 levels deep,", why);
    }
    ++*known;
    if (names->has[column]) {
        snprintf(why, SERVE_WHY_SIZE, "'%s' is there twice", serve_columns[column]);
        return false;
    }
    if (skip_word(at, "null")) {
        return true;
    }
    names->has[column] = read_number(at, &value[column]);
    return names->has[column] || bad_json(line, *at, "a number", why);
}

bool serve_read_object(const char *line, double value[SERVE_COLUMNS], char why[SERVE_WHY_SIZE]) {
    const char *at = skip_blanks(line);
    name_list names = {.has = {false}};
    size_t count = 0, known = 0;
    for (int i = 0; i < SERVE_COLUMNS; i++) {
        value[i] = NAN;
    }
    if (*at != '{') {
        return bad_json(line, at, "a {", why);
    }
    at = skip_blanks(at + 1);
    for (; count == 0 ? *at != '}' : *at == ','; count++) {
        at = count == 0 ? at : skip_blanks(at + 1);
        if (!read_member(line, &at, &names, &known, value, why)) {
            return false;
        }
        at = skip_blanks(at);
    }
    if (*at != '}') {
        return bad_json(line, at, "a comma or }", why);
    }
    at = skip_blanks(at + 1);
    if (*at) {
        return bad_json(line, at, "the end of the line", why);
    }
    if (is_misspelt(&names, why)) {
        return false;
    }
    if (count > 0 && known == 0) {
        snprintf(why, SERVE_WHY_SIZE, "none of the names is known; they are " ORDER);
        return false;
    }
    return true;
}

static serve_line read_header(serve_reader *r, const char *line, char *why) {
    name_list names = {.has = {false}};
    serve_reader now = {.has_header = true};
    for (const char *at = line;; at++) {
        const char *end = at + strcspn(at, ",");
        const char *from = at + strspn(at, " \t\""), *to = end;
        while (to > from && strchr(" \t\"", to[-1])) {
            to--;
        }
        int column = find_column(from, (size_t)(to - from));
        if (now.fields == SERVE_MAX_FIELDS || (column >= 0 && names.has[column])) {
            snprintf(why, SERVE_WHY_SIZE,
                     now.fields == SERVE_MAX_FIELDS ? "more than 32 columns"
                                                    : "a column is there twice in the header");
            return SERVE_BAD;
        }
        now.column[now.fields++] = column;
        if (column >= 0) {
            names.has[column] = true;
        } else {
            note_strange(&names, from, (size_t)(to - from), false);
        }
        at = end;
        if (!*at) {
            break;
        }
    }
    if (is_misspelt(&names, why)) {
        return SERVE_BAD;
    }
    if (!names.has[SERVE_X] || !names.has[SERVE_Y] || !names.has[SERVE_Z]) {
        snprintf(why, SERVE_WHY_SIZE, "the header lacks x_m, y_m or z_m; a full one is " ORDER);
        return SERVE_BAD;
    }
    *r = now;
    return SERVE_NOTHING;
}

static serve_line read_values(const serve_reader *r, const char *line, serve_request *out,
                              char *why) {
    const char *at = line;
    size_t given = 1;
    for (const char *c = line; *c; c++) {
        given += *c == ',';
    }
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
            snprintf(why, SERVE_WHY_SIZE, "%zu value%s where %zu are expected%s", given,
                     cli_plural(given), r->fields, r->has_header ? " by the header" : ": " ORDER);
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
    if (*at == '{' || *at == '[') {
        return serve_read_object(line, out->value, why) ? take(out, why) : SERVE_BAD;
    }
    bool is_header = isalpha((unsigned char)*at) || *at == '"' || *at == '_';
    return is_header ? read_header(reader, at, why) : read_values(reader, at, out, why);
}
