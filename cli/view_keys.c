/* Keys from a script, for views without a user. */
#include "view.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool is_key(const char *name) {
    for (size_t i = 0; asdic_view_key_name(i, NULL); i++) {
        if (strcmp(asdic_view_key_name(i, NULL), name) == 0) {
            return true;
        }
    }
    return false;
}

/* Keys that stop the mission's time, and so every key behind them: a user is needed to go on. */
static bool is_pause(const char *name) {
    return strcmp(name, "space") == 0 || strcmp(name, ".") == 0;
}

static void refuse_key(cli *c, const char *name) {
    char names[256] = "";
    size_t used = 0;
    const char *key;
    for (size_t i = 0; (key = asdic_view_key_name(i, NULL)) != NULL && used < sizeof names; i++) {
        used += (size_t)snprintf(names + used, sizeof names - used, " %s", key);
    }
    cli_usage(c, "--keys: there is no key '%s'; the keys are%s", name, names);
}

bool view_read_keys(view_job *job, const char *text) {
    size_t most = 1;
    for (const char *p = text; *p; p++) {
        most += *p == ',';
    }
    job->key_text = strdup(text);
    job->keys = calloc(most, sizeof *job->keys);
    if (!job->key_text || !job->keys) {
        cli_error(job->c, "out of memory");
        return false;
    }
    char *rest = job->key_text;
    for (char *word; (word = strsep(&rest, ",")) != NULL;) {
        char *name;
        double time_s = strtod(word, &name);
        double before_s = job->key_count ? job->keys[job->key_count - 1].time_s : 0.0;
        if (name == word || *name != ':' || !isfinite(time_s) || time_s < before_s) {
            cli_usage(job->c, "--keys: '%s' is not SECONDS:KEY, in the order of time", word);
            return false;
        }
        if (!is_key(name + 1)) {
            refuse_key(job->c, name + 1);
            return false;
        }
        if (job->is_offline && is_pause(name + 1)) {
            cli_usage(job->c, "--keys: without a display, nothing goes on after '%s'", name + 1);
            return false;
        }
        job->keys[job->key_count++] = (view_key){time_s, name + 1};
    }
    return true;
}

bool view_next(view_job *job, asdic_status *status) {
    asdic_view_clock clock = asdic_view_get_clock(job->view);
    double next_s = (double)clock.pings / job->rate_hz; /* after the first, whenever that was */
    while (job->next_key < job->key_count && job->keys[job->next_key].time_s <= next_s + 1e-9) {
        asdic_view_press(job->view, job->keys[job->next_key++].name);
    }
    if (clock.pings >= job->pings || asdic_view_is_over(job->view)) {
        return false;
    }
    *status = asdic_view_step(job->view);
    return *status == ASDIC_OK;
}
