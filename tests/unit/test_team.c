/*
 * One mission run by several processes, which are threads here and speak through mailboxes; fake
 * simulators as in test_run.c.
 */
#include "run_rig.h"

#include <pthread.h>

#define RANKS 3

typedef struct letter {
    struct letter *next;
    unsigned from;
    size_t bytes;
    char data[];
} letter;

typedef struct mailbox {
    pthread_mutex_t lock;
    letter *first, *last, *held; /* held: what the last receive handed out */
} mailbox;

static mailbox boxes[RANKS];

typedef struct process {
    unsigned rank;
    fixture f;
    asdic_team team;
    const char *name;
    asdic_run_options options;
    asdic_status status;
    bool stays_away; /* does not run: cannot read the scene, say */
    pthread_t thread;
} process;

static asdic_status send_letter(void *user, unsigned to, const void *data, size_t bytes) {
    process *p = user;
    letter *l = malloc(sizeof *l + bytes);
    *l = (letter){.from = p->rank, .bytes = bytes};
    memcpy(l->data, data, bytes);
    mailbox *box = &boxes[to];
    pthread_mutex_lock(&box->lock);
    *(box->last ? &box->last->next : &box->first) = l;
    box->last = l;
    pthread_mutex_unlock(&box->lock);
    return ASDIC_OK;
}

static asdic_status take_letter(void *user, unsigned *from, const void **data, size_t *bytes) {
    mailbox *box = &boxes[((process *)user)->rank];
    pthread_mutex_lock(&box->lock);
    letter *l = box->first;
    if (l) {
        box->first = l->next;
        box->last = box->first ? box->last : NULL;
    }
    pthread_mutex_unlock(&box->lock);
    free(box->held);
    box->held = l;
    *data = l ? l->data : NULL;
    if (l) {
        *from = l->from;
        *bytes = l->bytes;
    }
    return ASDIC_OK;
}

static void *run_process(void *argument) {
    process *p = argument;
    p->options.team = &p->team;
    if (!p->stays_away) {
        p->status = run(&p->f, 2, p->options, p->name);
    } else {
        asdic_fail(p->f.ctx, ASDIC_ERROR_INPUT, "the scene is not here");
    }
    assert_int_equal(asdic_team_end(p->f.ctx, &p->team), ASDIC_OK);
    return NULL;
}

/* Pings slow enough that every process gets a part, however late it begins. */
static void begin_team(process *p, const char *name) {
    for (unsigned rank = 0; rank < RANKS; rank++) {
        p[rank] = (process){.rank = rank, .name = name, .options = asdic_run_options_default()};
        begin(&p[rank].f);
        p[rank].team = (asdic_team){.rank = rank,
                                    .size = RANKS,
                                    .send = send_letter,
                                    .receive = take_letter,
                                    .user = &p[rank]};
        for (int i = 0; i < 3; i++) {
            p[rank].f.devices[i].delay_us = 8000;
            snprintf(p[rank].f.devices[i].info.name, sizeof p[rank].f.devices[i].info.name,
                     "fake %u.%d", rank, i);
        }
    }
}

static void run_team(process *p) {
    for (unsigned rank = 0; rank < RANKS; rank++) { /* before anybody writes letters */
        boxes[rank] = (mailbox){.lock = PTHREAD_MUTEX_INITIALIZER};
    }
    for (unsigned rank = 0; rank < RANKS; rank++) {
        assert_int_equal(pthread_create(&p[rank].thread, NULL, run_process, &p[rank]), 0);
    }
    for (unsigned rank = 0; rank < RANKS; rank++) {
        pthread_join(p[rank].thread, NULL);
    }
    for (unsigned rank = 0; rank < RANKS; rank++) {
        assert_null(boxes[rank].first); /* all letters were read */
        free(boxes[rank].held);
    }
}

static size_t pings_of(const process *p) {
    return p->f.devices[0].pings + p->f.devices[1].pings;
}

static void end_team(process *p) {
    for (unsigned rank = 0; rank < RANKS; rank++) {
        end(&p[rank].f);
    }
}

static void processes_do_not_change_a_byte(void **state) {
    (void)state;
    process p[RANKS];
    begin_team(p, "team");
    run_team(p);
    assert_int_equal(p[0].status, ASDIC_OK);
    assert_same_files("reference", "team");
    assert_no_part("team");
    assert_state("team", "complete", PINGS);
    size_t all = 0, length;
    char *json = read_file("team", "run.json", &length);
    for (unsigned rank = 0; rank < RANKS; rank++) {
        char device[32];
        assert_int_equal(p[rank].status, ASDIC_OK);
        assert_true(pings_of(&p[rank]) > 0);
        all += pings_of(&p[rank]);
        snprintf(device, sizeof device, "\"fake %u.0\"", rank);
        assert_non_null(strstr(json, device));
    }
    assert_int_equal(all, PINGS);
    assert_string_equal(p[0].f.warnings, "");
    free(json);
    end_team(p);
}

/* Process 0 may have found more rays than the scene asks for; the others follow it. */
static void rays_are_those_of_process_0(void **state) {
    (void)state;
    process p[RANKS];
    begin_team(p, "rays");
    asdic_mission_sampling(p[0].f.mission)->rays = 64000;
    run_team(p);
    assert_int_equal(p[0].status, ASDIC_OK);
    assert_string_equal(p[0].f.warnings, "");
    assert_true(pings_of(&p[1]) > 0);
    end_team(p);
}

/* Of devices that did nothing none is named in the run of FOLDER. */
static void assert_named_have_worked(const process *p, const char *folder) {
    size_t length;
    char *json = read_file(folder, "run.json", &length);
    for (unsigned rank = 0; rank < RANKS; rank++) {
        for (int i = 0; i < 2; i++) {
            char device[32];
            snprintf(device, sizeof device, "\"fake %u.%d\"", rank, i);
            assert_true(p[rank].f.devices[i].pings > 0 || !strstr(json, device));
        }
    }
    free(json);
}

static void lost_devices_elsewhere_are_replaced(void **state) {
    (void)state;
    for (unsigned k = 0; k < 6; k++) {
        process p[RANKS];
        char name[16];
        snprintf(name, sizeof name, "lost%u", k);
        begin_team(p, name);
        p[1].f.devices[0].fails_after = k;
        p[1].f.devices[1].refuses = k % 2 == 0;
        p[2].f.devices[0].fails_after = 3;
        p[2].f.devices[1].fails_after = 40;
        p[0].f.devices[0].fails_after = k > 3 ? 5 : SIZE_MAX;
        p[0].f.devices[0].after = p[0].f.devices[1].after = p[1].f.devices[0].after =
            p[1].f.devices[1].after = p[2].f.devices[1].after = &p[2].f.devices[0];
        run_team(p);
        assert_int_equal(p[0].status, ASDIC_OK);
        assert_same_files("reference", name);
        assert_non_null(strstr(p[0].f.warnings, "device 'fake 2.0' of process 2 failed"));
        assert_named_have_worked(p, name);
        end_team(p);
    }
}

static void work_of_process_0_goes_on_elsewhere(void **state) {
    (void)state;
    process p[RANKS];
    begin_team(p, "headless");
    p[0].f.devices[0].fails_after = p[0].f.devices[1].fails_after = 2;
    p[2].f.devices[0].fails_after = 8; /* when those are gone: told all the same */
    p[0].f.devices[1].after = &p[0].f.devices[0];
    p[2].f.devices[0].after = &p[0].f.devices[1];
    p[1].f.devices[0].after = p[1].f.devices[1].after = p[2].f.devices[1].after =
        &p[2].f.devices[0];
    run_team(p);
    assert_int_equal(p[0].status, ASDIC_OK);
    assert_int_equal(pings_of(&p[0]), 4);
    assert_non_null(strstr(p[0].f.warnings, "device 'fake 0.0' failed"));
    assert_non_null(strstr(p[0].f.warnings, "device 'fake 0.1' failed"));
    assert_non_null(strstr(p[0].f.warnings, "device 'fake 2.0' of process 2 failed"));
    assert_same_files("reference", "headless");
    end_team(p);
}

static void losing_all_devices_keeps_what_was_done_anywhere(void **state) {
    (void)state;
    process p[RANKS];
    begin_team(p, "dead");
    for (unsigned rank = 0; rank < RANKS; rank++) {
        p[rank].f.devices[0].fails_after = p[rank].f.devices[1].fails_after = 10;
    }
    run_team(p);
    assert_int_equal(p[0].status, ASDIC_ERROR_DEVICE_LOST);
    assert_non_null(strstr(asdic_context_error(p[0].f.ctx), "--resume"));
    assert_state("dead", "interrupted", p[0].f.reported);
    end_team(p);
    begin_team(p, "dead");
    p[0].options.resume = p[1].options.resume = p[2].options.resume = true;
    run_team(p);
    assert_int_equal(p[0].status, ASDIC_OK);
    assert_same_files("reference", "dead");
    end_team(p);
}

static void strangers_take_no_part(void **state) {
    (void)state;
    process p[RANKS];
    begin_team(p, "strangers");
    p[1].stays_away = true;
    asdic_mission_sampling(p[2].f.mission)->seed = 9;
    run_team(p);
    assert_int_equal(p[0].status, ASDIC_OK);
    assert_same_files("reference", "strangers");
    assert_non_null(strstr(p[0].f.warnings, "process 1 takes no part: the scene is not here"));
    assert_non_null(strstr(p[0].f.warnings, "process 2 takes no part: it has another scene"));
    assert_int_equal(pings_of(&p[0]), PINGS);
    end_team(p);
}

static void process_0_sends_the_others_home(void **state) {
    (void)state;
    process p[RANKS];
    begin_team(p, "reference"); /* is there already: process 0 fails before there is work */
    run_team(p);
    assert_int_equal(p[0].status, ASDIC_ERROR_EXISTS);
    assert_int_equal(p[1].status, ASDIC_OK);
    assert_int_equal(pings_of(&p[1]) + pings_of(&p[2]), 0);
    end_team(p);
}

static void interrupted_team_goes_on(void **state) {
    (void)state;
    process p[RANKS];
    for (size_t stop = 20; stop < 120; stop += 40) {
        begin_team(p, "stopped");
        p[0].f.stop_at = stop;
        for (unsigned rank = 0; rank < RANKS; rank++) {
            p[rank].options.resume = true;
            p[rank].f.devices[0].delay_us = p[rank].f.devices[1].delay_us = 3000;
        }
        run_team(p);
        assert_int_equal(p[0].status, ASDIC_ERROR_INTERRUPTED);
        assert_state("stopped", "interrupted", p[0].f.reported);
        end_team(p);
    }
    begin_team(p, "stopped");
    p[0].options.resume = true;
    run_team(p);
    assert_int_equal(p[0].status, ASDIC_OK);
    assert_same_files("reference", "stopped");
    end_team(p);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(processes_do_not_change_a_byte),
        cmocka_unit_test(rays_are_those_of_process_0),
        cmocka_unit_test(lost_devices_elsewhere_are_replaced),
        cmocka_unit_test(work_of_process_0_goes_on_elsewhere),
        cmocka_unit_test(losing_all_devices_keeps_what_was_done_anywhere),
        cmocka_unit_test(strangers_take_no_part),
        cmocka_unit_test(process_0_sends_the_others_home),
        cmocka_unit_test(interrupted_team_goes_on),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
