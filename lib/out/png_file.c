#include "png_file.h"

#include "base/context.h"
#include "base/file_read.h"
#include "base/try.h"
#include "file.h"

#include <png.h>
#include <zlib.h>

#include <errno.h>
#include <setjmp.h>
#include <stdlib.h>
#include <string.h>

/* State of libpng's error callback, which must not return. */
typedef struct png_job {
    jmp_buf leave;
    char why[128];
    bool is_memory_short;
    png_structp png;
    png_infop info;
    png_textp texts;
    uint16_t *row;
    asdic_status row_status; /* of the caller's function, which has told why */
} png_job;

static void on_error(png_structp png, png_const_charp message) {
    png_job *job = png_get_error_ptr(png);
    snprintf(job->why, sizeof job->why, "%s", message);
    longjmp(job->leave, 1);
}

static void on_warning(png_structp png, png_const_charp message) {
    (void)png;
    (void)message;
}

static void on_write(png_structp png, png_bytep data, size_t length) {
    if (fwrite(data, 1, length, png_get_io_ptr(png)) != length) {
        png_error(png, strerror(errno));
    }
}

static void on_flush(png_structp png) {
    (void)png; /* commit flushes */
}

static bool is_ascii(const char *text) {
    for (; *text; text++) {
        if ((unsigned char)*text >= 0x80) {
            return false;
        }
    }
    return true;
}

/* tEXt is Latin-1 by definition; anything else goes into iTXt. */
static void set_texts(png_job *job, const char *const *texts) {
    size_t count = 0;
    while (texts && texts[2 * count] && texts[2 * count + 1]) {
        count++;
    }
    if (count == 0) {
        return;
    }
    job->texts = calloc(count, sizeof *job->texts);
    if (!job->texts) {
        job->is_memory_short = true;
        png_error(job->png, "out of memory");
    }
    for (size_t i = 0; i < count; i++) {
        bool ascii = is_ascii(texts[2 * i + 1]);
        job->texts[i].compression = ascii ? PNG_TEXT_COMPRESSION_NONE : PNG_ITXT_COMPRESSION_NONE;
        job->texts[i].key = (char *)(uintptr_t)texts[2 * i];
        job->texts[i].text = (char *)(uintptr_t)texts[2 * i + 1];
    }
    png_set_text(job->png, job->info, job->texts, (int)count);
}

static void write_rows(png_job *job, const asdic_png *image) {
    if (image->rgb) {
        for (size_t y = 0; y < image->height; y++) {
            png_write_row(job->png, image->rgb + 3 * image->width * y);
        }
        return;
    }
    job->row = malloc(image->width * sizeof *job->row);
    if (!job->row) {
        job->is_memory_short = true;
        png_error(job->png, "out of memory");
    }
    for (size_t y = 0; y < image->height; y++) {
        job->row_status = image->grey_row(image->user, y, job->row);
        if (job->row_status != ASDIC_OK) {
            png_error(job->png, "no data");
        }
        uint8_t *bytes = (uint8_t *)job->row;
        for (size_t x = 0; x < image->width; x++) { /* PNG is big-endian */
            uint16_t grey = job->row[x];
            bytes[2 * x] = (uint8_t)(grey >> 8);
            bytes[2 * x + 1] = (uint8_t)grey;
        }
        png_write_row(job->png, bytes);
    }
}

static void encode(png_job *job, const asdic_png *image, FILE *stream) {
    png_set_write_fn(job->png, stream, on_write, on_flush);
    png_set_user_limits(job->png, PNG_UINT_31_MAX, PNG_UINT_31_MAX); /* else a million pings */
    png_set_IHDR(job->png, job->info, (png_uint_32)image->width, (png_uint_32)image->height,
                 image->rgb ? 8 : 16, image->rgb ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_GRAY,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (image->pixels_per_m > 0.0) {
        png_uint_32 resolution = (png_uint_32)(image->pixels_per_m + 0.5);
        png_set_pHYs(job->png, job->info, resolution, resolution, PNG_RESOLUTION_METER);
    }
    /* Levels are noisy and repeat in whole pixels: without filters files are smaller than with
     * libpng's choice of them, and written in a tenth of the time. */
    png_set_filter(job->png, PNG_FILTER_TYPE_BASE, PNG_FILTER_NONE);
    png_set_compression_level(job->png, 3);
    set_texts(job, image->texts);
    png_write_info(job->png, job->info);
    write_rows(job, image);
    png_write_end(job->png, NULL);
}

asdic_status asdic_png_write(asdic_context *ctx, const char *path, const asdic_png *image) {
    asdic_file *file = NULL;
    asdic_status status = asdic_file_create(ctx, path, &file);
    if (status != ASDIC_OK) {
        return status;
    }
    png_job job = {.why = "out of memory", .is_memory_short = true};
    job.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &job, on_error, on_warning);
    if (job.png) {
        job.info = png_create_info_struct(job.png);
        job.is_memory_short = !job.info;
    }
    if (!job.info || setjmp(job.leave) != 0) {
        status = job.row_status != ASDIC_OK
                     ? job.row_status
                     : asdic_fail(ctx, job.is_memory_short ? ASDIC_ERROR_MEMORY : ASDIC_ERROR_IO,
                                  "cannot write '%s': %s", path, job.why);
        asdic_file_discard(&file);
        goto done;
    }
    encode(&job, image, asdic_file_stream(file));
    status = asdic_file_commit(&file);
done:
    png_destroy_write_struct(&job.png, &job.info);
    free(job.texts);
    free(job.row);
    return status;
}

#define MOST_PNG_BYTES ((size_t)1 << 30)
#define SIGNATURE 8
#define CHUNK 12 /* of a chunk: length, type and sum */

static uint32_t big_endian(const unsigned char *b) {
    return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

asdic_status asdic_png_check(asdic_context *ctx, const char *path) {
    char *text = NULL;
    size_t length = 0, at = SIGNATURE;
    bool is_good = false, is_end = false;
    TRY(asdic_file_read(ctx, path, MOST_PNG_BYTES, &text, &length));
    const unsigned char *bytes = (const unsigned char *)text;
    is_good = length > SIGNATURE && png_sig_cmp(bytes, 0, SIGNATURE) == 0;
    while (is_good && !is_end) {
        size_t left = length - at, body = left < CHUNK ? 0 : big_endian(bytes + at);
        is_good = left >= CHUNK && body <= left - CHUNK &&
                  crc32_z(0, bytes + at + 4, body + 4) == big_endian(bytes + at + 8 + body);
        is_end = is_good && memcmp(bytes + at + 4, "IEND", 4) == 0;
        at += is_good ? body + CHUNK : 0;
    }
    free(text);
    return is_good && at == length
               ? ASDIC_OK
               : asdic_fail(ctx, ASDIC_ERROR_INPUT, "'%s' is no whole PNG file", path);
}
