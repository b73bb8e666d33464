/* A view in a window: the only file that knows SDL. */
#include "view.h"

#include <SDL.h>
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct window {
    view_job *job;
    SDL_Window *handle;
    SDL_Renderer *renderer;
    SDL_Texture *texture; /* of the frame's size */
    char title[256];
} window;

static bool fail(const cli *c, const char *what) {
    cli_error(c, "cannot %s: %s; without a display, --y4m and --snapshot show the view", what,
              SDL_GetError());
    return false;
}

/* Without a display, SDL falls back to a driver that shows nothing. */
static bool is_seen(void) {
    const char *driver = SDL_GetCurrentVideoDriver();
    return getenv("SDL_VIDEODRIVER") ||
           (strcmp(driver, "offscreen") != 0 && strcmp(driver, "dummy") != 0);
}

static bool open_window(window *w, unsigned width, unsigned height) {
    const cli *c = w->job->c;
    /* Ctrl-C is left to the program, and the screen may sleep. */
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    SDL_SetHint(SDL_HINT_VIDEO_ALLOW_SCREENSAVER, "1");
    SDL_SetHint(SDL_HINT_RENDER_SCALE_QUALITY, "linear");
    if (SDL_Init(SDL_INIT_VIDEO) != 0) {
        return fail(c, "open a display");
    }
    if (!is_seen()) {
        SDL_SetError("there is none");
        return fail(c, "open a display");
    }
    w->handle =
        SDL_CreateWindow("asdic: compiling kernels", SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED,
                         (int)width, (int)height, SDL_WINDOW_RESIZABLE);
    w->renderer = w->handle ? SDL_CreateRenderer(w->handle, -1, 0) : NULL;
    if (!w->renderer) {
        return fail(c, "open a window");
    }
    SDL_RenderSetLogicalSize(w->renderer, (int)width, (int)height);
    w->texture = SDL_CreateTexture(w->renderer, SDL_PIXELFORMAT_RGB888, SDL_TEXTUREACCESS_STREAMING,
                                   (int)width, (int)height);
    return w->texture || fail(c, "make a picture");
}

static void close_window(window *w) {
    if (w->texture) {
        SDL_DestroyTexture(w->texture);
    }
    if (w->renderer) {
        SDL_DestroyRenderer(w->renderer);
    }
    if (w->handle) {
        SDL_DestroyWindow(w->handle);
    }
    SDL_Quit();
}

static void present(window *w) {
    asdic_view_image image = asdic_view_get_frame(w->job->view);
    const char *title = asdic_view_title(w->job->view);
    if (strcmp(title, w->title) != 0) {
        snprintf(w->title, sizeof w->title, "%s", title);
        SDL_SetWindowTitle(w->handle, title);
    }
    SDL_UpdateTexture(w->texture, NULL, image.rgb, (int)(image.stride * sizeof(uint32_t)));
    SDL_RenderClear(w->renderer);
    SDL_RenderCopy(w->renderer, w->texture, NULL, NULL);
    SDL_RenderPresent(w->renderer);
}

/* "PageUp" to "pageup". */
static void press(window *w, SDL_Keycode code) {
    char name[32];
    size_t n = 0;
    for (const char *p = SDL_GetKeyName(code); *p && n + 1 < sizeof name; p++) {
        name[n++] = (char)tolower((unsigned char)*p);
    }
    name[n] = '\0';
    asdic_view_press(w->job->view, code == SDLK_ESCAPE ? "q" : name);
}

/* One event; true when the picture needs to be shown again. */
static bool handle(window *w, const SDL_Event *event) {
    if (event->type == SDL_QUIT) {
        asdic_view_press(w->job->view, "q");
    } else if (event->type == SDL_KEYDOWN) {
        press(w, event->key.keysym.sym);
    }
    return event->type == SDL_KEYDOWN || event->type == SDL_WINDOWEVENT;
}

static double now_s(void) {
    return (double)SDL_GetPerformanceCounter() / (double)SDL_GetPerformanceFrequency();
}

/* Keys until UNTIL_S, or while paused until one was pressed. */
static void wait(window *w, double until_s) {
    SDL_Event event;
    const cli *c = w->job->c;
    for (;;) {
        bool is_paused = asdic_view_is_paused(w->job->view), touched = false;
        double left_s = is_paused ? 0.1 : until_s - now_s();
        if (left_s > 0.0 && SDL_WaitEventTimeout(&event, (int)ceil(1e3 * left_s))) {
            touched |= handle(w, &event);
        }
        while (SDL_PollEvent(&event)) {
            touched |= handle(w, &event);
        }
        bool is_over =
            asdic_view_is_over(w->job->view) || asdic_context_interrupted(cli_context(c));
        if (is_over || (is_paused && touched) || (!is_paused && now_s() >= until_s)) {
            return;
        }
    }
}

/* Steps at the ping rate; a late step delays the following ones, so that time stretches. */
static asdic_status show(window *w) {
    asdic_status status = ASDIC_OK;
    double period_s = 1.0 / w->job->rate_hz, due_s = now_s();
    while (view_next(w->job, &status)) {
        present(w);
        due_s = fmax(due_s + period_s, now_s());
        wait(w, due_s);
    }
    return status;
}

/* A window that closes by itself says why. */
static void tell_end(const view_job *job) {
    asdic_view_clock clock = asdic_view_get_clock(job->view);
    cli_note(job->c, "%s after %zu ping%s, at %.4g s",
             clock.is_flown ? "the mission is flown" : "closed", clock.pings,
             cli_plural(clock.pings), clock.time_s);
}

int view_window(view_job *job) {
    window w = {.job = job};
    asdic_view_image image = asdic_view_get_frame(job->view);
    int code = CLI_FAILED;
    if (open_window(&w, image.width, image.height)) {
        SDL_RenderClear(w.renderer);
        SDL_RenderPresent(w.renderer);
        asdic_status status = show(&w);
        if (!status) {
            tell_end(job);
        }
        code = cli_end(job->c, status);
    }
    close_window(&w);
    return code;
}
