#include "csv.h"

#include "base/context.h"
#include "digits.h"
#include "file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define BUFFER_BYTES ((size_t)1 << 18)
/* Eight numbers with their commas and a line end. */
#define ROW_BYTES (ASDIC_RECORD_ARRAYS * ASDIC_DIGITS_SIZE + 8)

/* A piece of text that returns in many rows. */
typedef struct csv_piece {
    size_t length;
    char text[2 * ASDIC_DIGITS_SIZE];
} csv_piece;

struct asdic_csv {
    asdic_context *ctx;
    asdic_file *file;
    char *path;
    char *buffer;
    size_t beams, bins;
    asdic_csv_form form;
    char (*beam_fields)[2 * ASDIC_NAME_SIZE + 3];
    csv_piece *bin_pieces; /* "17,8.75," */
};

size_t asdic_csv_field(char *out, const char *text) {
    size_t length = 0;
    if (!strpbrk(text, ",\"\r\n")) {
        length = strlen(text);
        memcpy(out, text, length + 1);
        return length;
    }
    out[length++] = '"';
    for (; *text; text++) {
        if (*text == '"') {
            out[length++] = '"';
        }
        out[length++] = *text;
    }
    out[length++] = '"';
    out[length] = 0;
    return length;
}

static void csv_free(asdic_csv **csv) {
    if (!*csv) {
        return;
    }
    asdic_file_discard(&(*csv)->file);
    free((*csv)->path);
    free((*csv)->buffer);
    free((*csv)->beam_fields);
    free((*csv)->bin_pieces);
    free(*csv);
    *csv = NULL;
}

static bool prepare(asdic_csv *csv, const asdic_sonar *sonar) {
    csv->buffer = malloc(BUFFER_BYTES);
    csv->beam_fields = malloc(csv->beams * sizeof *csv->beam_fields);
    csv->bin_pieces = malloc(csv->bins * sizeof *csv->bin_pieces);
    if (!csv->path || !csv->buffer || !csv->beam_fields || !csv->bin_pieces) {
        return false;
    }
    for (size_t i = 0; i < csv->beams; i++) {
        asdic_csv_field(csv->beam_fields[i], sonar->receivers[i].name);
    }
    for (size_t i = 0; i < csv->bins; i++) {
        csv_piece *piece = &csv->bin_pieces[i];
        piece->length = asdic_digits_natural(piece->text, i);
        piece->text[piece->length++] = ',';
        piece->length += asdic_digits_double(piece->text + piece->length,
                                             ((double)i + 0.5) * sonar->bin_length_m);
        piece->text[piece->length++] = ',';
    }
    return true;
}

static void write_header(asdic_csv *csv) {
    FILE *stream = asdic_file_stream(csv->file);
    if (csv->form == ASDIC_CSV_WIDE) {
        fputs("ping,time_s,beam", stream);
        for (size_t i = 0; i < csv->bins; i++) {          /* the range of each bin's centre */
            const csv_piece *piece = &csv->bin_pieces[i]; /* without a zero at its end */
            const char *range_m = (const char *)memchr(piece->text, ',', piece->length) + 1;
            fprintf(stream, ",%.*s_m", (int)(piece->text + piece->length - 1 - range_m), range_m);
        }
        fputc('\n', stream);
        return;
    }
    fputs("ping,time_s,beam,bin,range_m", stream);
    for (int i = 0; i < ASDIC_RECORD_ARRAYS; i++) {
        fprintf(stream, ",%s", asdic_record_names[i]);
    }
    fputc('\n', stream);
}

asdic_status asdic_csv_create(asdic_context *ctx, const char *path, const asdic_sonar *sonar,
                              size_t bins, asdic_csv_form form, asdic_csv **out) {
    *out = NULL;
    if (form == ASDIC_CSV_NONE) {
        return ASDIC_OK;
    }
    asdic_csv *csv = calloc(1, sizeof *csv);
    if (!csv) {
        return asdic_fail_memory(ctx, "a CSV file");
    }
    csv->ctx = ctx;
    csv->path = strdup(path);
    csv->beams = sonar->receiver_count;
    csv->bins = bins;
    csv->form = form;
    if (!prepare(csv, sonar)) {
        csv_free(&csv);
        return asdic_fail_memory(ctx, "a CSV file");
    }
    asdic_status status = asdic_file_create(ctx, path, &csv->file);
    if (status != ASDIC_OK) {
        csv_free(&csv);
        return status;
    }
    write_header(csv);
    *out = csv;
    return ASDIC_OK;
}

static bool flush(asdic_csv *csv, size_t *used) {
    size_t written = fwrite(csv->buffer, 1, *used, asdic_file_stream(csv->file));
    bool is_complete = written == *used;
    *used = 0;
    return is_complete;
}

/* Rows of one beam, each "PREFIX" bin, range and eight numbers. */
static bool add_long(asdic_csv *csv, const asdic_record *record, const char *prefix, size_t beam) {
    size_t prefix_length = strlen(prefix), used = 0, first = beam * csv->bins;
    for (size_t bin = 0; bin < csv->bins; bin++) {
        if (used + prefix_length + sizeof csv->bin_pieces->text + ROW_BYTES > BUFFER_BYTES &&
            !flush(csv, &used)) {
            return false;
        }
        const csv_piece *piece = &csv->bin_pieces[bin];
        char *row = csv->buffer + used;
        memcpy(row, prefix, prefix_length);
        row += prefix_length;
        memcpy(row, piece->text, piece->length);
        row += piece->length;
        for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
            row += asdic_digits_float(row, record->level_db[c][first + bin]);
            *row++ = ',';
        }
        row += asdic_digits_float(row, record->stderr_db[first + bin]);
        *row++ = '\n';
        used = (size_t)(row - csv->buffer);
    }
    return flush(csv, &used);
}

/* One row with the beam's levels. */
static bool add_wide(asdic_csv *csv, const asdic_record *record, const char *prefix, size_t beam) {
    size_t used = strlen(prefix) - 1; /* the comma comes with each level */
    memcpy(csv->buffer, prefix, used);
    for (size_t bin = 0; bin < csv->bins; bin++) {
        if (used + ROW_BYTES > BUFFER_BYTES && !flush(csv, &used)) {
            return false;
        }
        csv->buffer[used++] = ',';
        used += asdic_digits_float(csv->buffer + used,
                                   record->level_db[ASDIC_TOTAL][beam * csv->bins + bin]);
    }
    csv->buffer[used++] = '\n';
    return flush(csv, &used);
}

asdic_status asdic_csv_add(asdic_csv *csv, const asdic_record *record) {
    if (!csv) {
        return ASDIC_OK;
    }
    char start[2 * ASDIC_DIGITS_SIZE];
    size_t length = asdic_digits_natural(start, record->ping);
    start[length++] = ',';
    length += asdic_digits_double(start + length, record->time_s);
    start[length++] = ',';
    for (size_t beam = 0; beam < csv->beams; beam++) {
        char prefix[sizeof start + sizeof *csv->beam_fields + 1];
        snprintf(prefix, sizeof prefix, "%.*s%s,", (int)length, start, csv->beam_fields[beam]);
        bool is_written = csv->form == ASDIC_CSV_WIDE ? add_wide(csv, record, prefix, beam)
                                                      : add_long(csv, record, prefix, beam);
        if (!is_written) {
            return asdic_fail(csv->ctx, ASDIC_ERROR_IO, "cannot write '%s': %s", csv->path,
                              strerror(errno));
        }
    }
    return ASDIC_OK;
}

asdic_status asdic_csv_commit(asdic_csv **csv) {
    if (!*csv) {
        return ASDIC_OK;
    }
    asdic_status status = asdic_file_commit(&(*csv)->file);
    csv_free(csv);
    return status;
}

void asdic_csv_discard(asdic_csv **csv) {
    if (csv) {
        csv_free(csv);
    }
}
