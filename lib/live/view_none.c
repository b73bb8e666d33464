/* Without cairo there is no view. */
#include <asdic/view.h>

#include "base/context.h"

asdic_view_options asdic_view_options_default(void) {
    return (asdic_view_options){.width = 1280, .height = 720};
}

asdic_status asdic_view_create(asdic_context *ctx, asdic_mission *mission, asdic_device *device,
                               const asdic_view_options *options, asdic_view **out) {
    (void)mission;
    (void)device;
    (void)options;
    if (out) {
        *out = NULL;
    }
    return asdic_fail(ctx, ASDIC_ERROR_UNSUPPORTED,
                      "the view needs cairo, which this build of asdic is without");
}

/* No view exists in this build: the functions below get NULL. */
void asdic_view_destroy(asdic_view **view) {
    (void)view;
}

asdic_status asdic_view_step(asdic_view *view) {
    (void)view;
    return ASDIC_ERROR_ARGUMENT;
}

bool asdic_view_press(asdic_view *view, const char *key) {
    (void)view;
    (void)key;
    return false;
}

const char *asdic_view_key_name(size_t index, const char **does) {
    (void)index;
    (void)does;
    return NULL;
}

bool asdic_view_is_over(const asdic_view *view) {
    (void)view;
    return true;
}

bool asdic_view_is_paused(const asdic_view *view) {
    (void)view;
    return false;
}

asdic_status asdic_view_stop(asdic_view *view) {
    (void)view;
    return ASDIC_ERROR_ARGUMENT;
}

asdic_view_image asdic_view_get_frame(const asdic_view *view) {
    (void)view;
    return (asdic_view_image){.rgb = NULL};
}

const char *asdic_view_title(const asdic_view *view) {
    (void)view;
    return NULL;
}

asdic_status asdic_view_save(const asdic_view *view, const char *path) {
    (void)view;
    (void)path;
    return ASDIC_ERROR_ARGUMENT;
}

asdic_view_clock asdic_view_get_clock(const asdic_view *view) {
    (void)view;
    return (asdic_view_clock){0};
}
