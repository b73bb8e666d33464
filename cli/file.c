/* Output files of commands. */
#include "cli.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

/* A pipe or a device, over which nothing may be renamed. */
static bool is_special(const char *path) {
    struct stat st;
    return stat(path, &st) == 0 && !S_ISREG(st.st_mode) && !S_ISDIR(st.st_mode);
}

/* -1 with errno: EBUSY while another process writes PART. It is emptied under the lock alone; one that
 * was renamed meanwhile is a whole file, which stays as it is. */
static int open_part(const char *part) {
    struct stat opened, named;
    int fd = open(part, O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
    if (fd < 0) {
        return -1;
    }
    bool is_ours = (flock(fd, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) &&
                   fstat(fd, &opened) == 0 && lstat(part, &named) == 0 &&
                   opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
    if (!is_ours) {
        errno = EBUSY;
    } else if (ftruncate(fd, 0) == 0) {
        return fd;
    }
    int error = errno;
    close(fd);
    errno = error;
    return -1;
}

static FILE *open_stream(const cli_file *file) {
    if (!file->part) {
        return fopen(file->path, "wbe");
    }
    int fd = open_part(file->part);
    return fd >= 0 ? fdopen(fd, "wb") : NULL;
}

static bool fail(const cli *c, const char *path, int error) {
    cli_error(c, "cannot write '%s': %s", path,
              error == EBUSY ? "another process is writing it just now" : strerror(error));
    return false;
}

bool cli_make_folder(const cli *c, const char *folder, bool *is_new) {
    *is_new = mkdir(folder, 0777) == 0;
    int error = *is_new ? EEXIST : errno;
    if (error != EEXIST) {
        cli_error(c, "cannot create folder '%s': %s%s", folder, strerror(error),
                  error == ENOENT ? "; create the folder that it is to be in first" : "");
    }
    return error == EEXIST;
}

int cli_leave_empty(const cli *c, const char *what, uint64_t total, const char *folder) {
    bool is_new;
    if (folder && !cli_make_folder(c, folder, &is_new)) {
        return CLI_FAILED;
    }
    if (folder && !cli_is_left_empty(folder)) {
        cli_error(c,
                  "--shard %s has nothing to do and leaves an empty folder, which '%s' is not; "
                  "remove that, or choose another by -o",
                  cli_text(c, "shard"), folder);
        return CLI_FAILED;
    }
    cli_note(c, "--shard %s: nothing to do; %s to share: %llu", cli_text(c, "shard"), what,
             (unsigned long long)total);
    return CLI_OK;
}

bool cli_is_left_empty(const char *folder) {
    DIR *entries = opendir(folder);
    size_t count = 0;
    while (entries && count < 3 && readdir(entries)) {
        count++;
    }
    if (entries) {
        closedir(entries);
    }
    return count == 2; /* . and .. */
}

bool cli_file_open(const cli *c, const char *path, cli_file *out) {
    bool is_stdout = cli_is_stdout(path);
    *out = (cli_file){.stream = is_stdout ? stdout : NULL, .path = path};
    if (is_stdout) {
        return true;
    }
    if (!is_special(path) && asprintf(&out->part, "%s.part", path) < 0) {
        out->part = NULL;
        return fail(c, path, ENOMEM);
    }
    out->stream = open_stream(out);
    if (!out->stream) {
        fail(c, path, errno);
        free(out->part);
    }
    return out->stream != NULL;
}

bool cli_file_close(const cli *c, cli_file *file, bool is_whole) {
    if (file->stream == stdout) {
        return true;
    }
    bool good =
        is_whole && !ferror(file->stream) && fflush(file->stream) == 0 &&
        (!file->part || (fsync(fileno(file->stream)) == 0 && rename(file->part, file->path) == 0));
    int error = errno;
    if (file->part && !good) {
        unlink(file->part);
    }
    if (fclose(file->stream) != 0 && good) {
        error = errno;
        good = false;
    }
    free(file->part);
    return good || !is_whole || fail(c, file->path, error);
}
