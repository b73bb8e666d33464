#include <asdic/expected.h>

#include "base/context.h"
#include "base/try.h"
#include "csv.h"
#include "digits.h"
#include "file.h"

#include <string.h>

static void write_level(FILE *out, double intensity_lin, char end) {
    char text[ASDIC_DIGITS_SIZE];
    if (intensity_lin > 0.0) {
        asdic_digits_print(text, "%.10g", asdic_level_db(intensity_lin));
        fputs(text, out);
    }
    fputc(end, out);
}

static void write_row(FILE *out, const char *beam_field, const asdic_ping *ping, size_t beam,
                      size_t bin) {
    static const asdic_component columns[] = {ASDIC_TOTAL, ASDIC_BOTTOM, ASDIC_SURFACE,
                                              ASDIC_VOLUME, ASDIC_NOISE};
    char range[ASDIC_DIGITS_SIZE];
    asdic_digits_double(range, ((double)bin + 0.5) * ping->bin_length_m);
    fprintf(out, "%s,%zu,%s,", beam_field, bin, range);
    for (size_t i = 0; i < sizeof columns / sizeof *columns; i++) {
        write_level(out, ping->intensity_lin[columns[i]][beam * ping->bins + bin],
                    columns[i] == ASDIC_NOISE ? '\n' : ',');
    }
}

asdic_status asdic_expected_write_csv(asdic_context *ctx, const char *path,
                                      const asdic_sonar *sonar, const asdic_ping *ping) {
    if (!path || !sonar || !ping) {
        return asdic_fail_null(ctx, __func__);
    }
    if (ping->beams != sonar->receiver_count) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "a ping of %zu beams for %zu receivers",
                          ping->beams, sonar->receiver_count);
    }
    asdic_file *file = NULL;
    TRY(asdic_file_create(ctx, strcmp(path, "-") == 0 ? "/dev/stdout" : path, &file));
    FILE *out = asdic_file_stream(file);
    fputs("beam,bin,range_m,total_db,bottom_db,surface_db,volume_db,noise_db\n", out);
    for (size_t b = 0; b < ping->beams; b++) {
        char field[2 * ASDIC_NAME_SIZE + 3];
        asdic_csv_field(field, sonar->receivers[b].name);
        for (size_t n = 0; n < ping->bins; n++) {
            write_row(out, field, ping, b, n);
        }
    }
    return asdic_file_commit(&file);
}
