/* Built without SDL2. */
#include "view.h"

int view_window(view_job *job) {
    cli_error(job->c,
              "this asdic was built without SDL2, hence without a window (libsdl2-dev, then "
              "meson configure -Dsdl2=enabled); --y4m and --snapshot need none");
    return CLI_FAILED;
}
