/* A view without a display: as a stream of frames that ffmpeg and ffplay read, or as pictures. */
#include "view.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* BT.601 in the range 16..235, as Y4M readers expect: 16.16 fixed point. */
static void to_yuv(const asdic_view_image *image, unsigned char *y, unsigned char *u,
                   unsigned char *v) {
    for (unsigned row = 0; row < image->height; row++) {
        for (unsigned column = 0; column < image->width; column++) {
            uint32_t rgb = image->rgb[row * image->stride + column];
            int r = (int)(rgb >> 16 & 255), g = (int)(rgb >> 8 & 255), b = (int)(rgb & 255);
            *y++ = (unsigned char)((16829 * r + 33039 * g + 6416 * b + (16 << 16) + 32768) >> 16);
            *u++ = (unsigned char)((-9714 * r - 19070 * g + 28784 * b + (128 << 16) + 32768) >> 16);
            *v++ = (unsigned char)((28784 * r - 24103 * g - 4681 * b + (128 << 16) + 32768) >> 16);
        }
    }
}

static void write_head(FILE *out, const asdic_view_image *image, double rate_hz) {
    unsigned long above = (unsigned long)rint(1000.0 * rate_hz), below = 1000;
    for (unsigned long k = 10; above % k == 0 && below % k == 0 && below > 1;) {
        above /= k;
        below /= k;
    }
    fprintf(out, "YUV4MPEG2 W%u H%u F%lu:%lu Ip A1:1 C444 XCOLORRANGE=LIMITED\n", image->width,
            image->height, above ? above : 1, below);
}

static bool write_frame(FILE *out, const asdic_view_image *image, unsigned char *planes) {
    size_t pixels = (size_t)image->width * image->height;
    to_yuv(image, planes, planes + pixels, planes + 2 * pixels);
    fputs("FRAME\n", out);
    fwrite(planes, 1, 3 * pixels, out);
    return fflush(out) == 0 && !ferror(out);
}

static asdic_status stream(view_job *job, FILE *out, bool *is_broken) {
    asdic_status status = ASDIC_OK;
    unsigned char *planes = NULL;
    while (!*is_broken && view_next(job, &status)) {
        asdic_view_image image = asdic_view_get_frame(job->view);
        if (!planes) {
            planes = malloc(3 * (size_t)image.width * image.height);
            if (!planes) {
                return ASDIC_ERROR_MEMORY;
            }
            write_head(out, &image, job->rate_hz);
        }
        *is_broken = !write_frame(out, &image, planes);
    }
    free(planes);
    return status;
}

int view_stream(view_job *job, const char *path) {
    bool is_broken = false;
    cli_file out;
    signal(SIGPIPE, SIG_IGN); /* a player that was closed must not cost the recording */
    if (!cli_may_write(job->c, path) || !cli_file_open(job->c, path, &out)) {
        return CLI_FAILED;
    }
    asdic_status status = stream(job, out.stream, &is_broken);
    int code = cli_end(job->c, status);
    if (is_broken && out.stream != stdout) {
        cli_error(job->c, "cannot write '%s': %s", path, strerror(errno));
        code = CLI_FAILED;
    }
    return cli_file_close(job->c, &out, !status && !is_broken) ? code : CLI_FAILED;
}

#define PATH_SIZE 4096

static void path_of(char path[PATH_SIZE], const char *folder, size_t ping) {
    snprintf(path, PATH_SIZE, "%s/view_%zu.png", folder, ping);
}

/* Before the first ping: none of COUNT snapshots of so many pings exists. */
static bool are_new(view_job *job, size_t count, size_t pings, const char *folder) {
    for (size_t taken = 0; taken < count; taken++) {
        char path[PATH_SIZE];
        path_of(path, folder, ((taken + 1) * pings + count - 1) / count - 1);
        if (access(path, F_OK) == 0) {
            cli_error(job->c, "'%s' exists; use --force to replace it", path);
            return false;
        }
    }
    return true;
}

static bool take_snapshot(view_job *job, const char *folder) {
    char path[PATH_SIZE];
    path_of(path, folder, asdic_view_get_clock(job->view).pings - 1);
    asdic_status status = asdic_view_save(job->view, path);
    if (status) {
        cli_end(job->c, status);
        return false;
    }
    cli_note(job->c, "%s: t = %g s", path, asdic_view_get_clock(job->view).time_s);
    return true;
}

int view_snapshots(view_job *job, size_t count, size_t pings, const char *folder, bool force) {
    asdic_status status = ASDIC_OK;
    size_t taken = 0;
    bool is_new;
    if (!cli_make_folder(job->c, folder, &is_new)) {
        return CLI_FAILED;
    }
    if (!force && !are_new(job, count, pings, folder)) {
        return CLI_FAILED;
    }
    while (taken < count && view_next(job, &status)) {
        size_t done = asdic_view_get_clock(job->view).pings;
        /* Evenly, the last one at the end. */
        if (done * count >= (taken + 1) * pings) {
            if (!take_snapshot(job, folder)) {
                return CLI_FAILED;
            }
            taken++;
        }
    }
    if (!status && taken < count) {
        cli_error(job->c, "the view ended after %zu pings, with %zu of %zu frames",
                  asdic_view_get_clock(job->view).pings, taken, count);
        return CLI_FAILED;
    }
    return cli_end(job->c, status);
}
