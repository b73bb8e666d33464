#include "cli.h"

#include <dlfcn.h>
#include <libgen.h>
#include <limits.h>
#include <stdio.h>
#include <unistd.h>

/* Beside the program where it was built; else where it was installed, wherever that was moved. */
static bool find(const char *name, char path[PATH_MAX]) {
    static const char *const places[] = {"", "/" CLI_MODULES};
    char program[PATH_MAX];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    program[length < 0 ? 0 : length] = '\0';
    const char *folder = dirname(program);
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        if (snprintf(path, PATH_MAX, "%s%s/asdic-%s.so", folder, places[i], name) < PATH_MAX &&
            access(path, R_OK) == 0) {
            return true;
        }
    }
    return false;
}

/* It stays until the program ends, as its library may have threads; plug-ins of MPI look for MPI
 * among what is loaded globally. */
void *cli_module(const cli *c, const char *name, const char *function) {
    char path[PATH_MAX];
    void *module = find(name, path) ? dlopen(path, RTLD_NOW | RTLD_GLOBAL) : NULL;
    void *found = module ? dlsym(module, function) : NULL;
    if (!found) {
        const char *why = dlerror();
        cli_error(c, "cannot load this program's part '%s': %s", name, why ? why : "it is missing");
    }
    return found;
}
