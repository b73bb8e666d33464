/*
 * Parts of a trial join to the whole, whichever process flew them.
 */
#include "trial_rig.h"

#include "lib/mission/run/team_message.h"
#include "lib/trial/trial_run.h"

#include <dirent.h>
#include <sys/stat.h>

static void parts_of_one_trial(void **state) {
    (void)state;
    asdic_trial *a = open_trial(), *b = open_trial();
    b->facts.first++;
    b->facts.count++;
    assert_true(asdic_trial_is_same(&a->facts, &b->facts));
    trial_facts other[7];
    char rule[] = "rule.py --slow";
    for (int i = 0; i < 7; i++) {
        other[i] = a->facts;
    }
    other[0].hash[0]++;
    other[1].seed++;
    other[2].runs++;
    other[3].rays++;
    other[4].rule = NULL;
    other[5].variants--;
    other[6].rule = rule;
    for (int i = 0; i < 7; i++) {
        assert_false(asdic_trial_is_same(&a->facts, &other[i]));
    }
    asdic_trial_close(&a);
    asdic_trial_close(&b);
}

/* The same row for both variants of runs FIRST to END - 1. */
static size_t print_like_rows(char *text, size_t size, unsigned first, unsigned end) {
    size_t length = 0;
    for (unsigned i = 2 * first; i < 2 * end; i++) {
        length += (size_t)snprintf(text + length, size - length, "%u,%u,clear,,,1,2,3,4,0,0,,30\n",
                                   i / 2, i % 2);
    }
    return length;
}

/* All rows of the trial of 40 runs. */
static const char *all_rows(void) {
    static char text[4000];
    size_t length = print_like_rows(text, sizeof text, 0, 7);
    length += (size_t)snprintf(text + length, sizeof text - length, "%s", rows);
    print_like_rows(text + length, sizeof text - length, 11, 40);
    return text;
}

/* Runs FIRST and so on, COUNT of them, of the trial as a part in FOLDER/PART; WORD of what is in both files
 * replaced by OTHER. */
static void write_part(const char *part, unsigned first, unsigned count, const char *word,
                       const char *other) {
    char text[4000], some[1000], file[40], path[200], number[40];
    snprintf(path, sizeof path, "%s/%s", folder, part);
    mkdir(path, 0777);
    snprintf(number, sizeof number, "\"first\": %u", first);
    replace(facts, "\"first\": 7", number, some);
    snprintf(number, sizeof number, "\"count\": %u", count);
    replace(some, "\"count\": 4", number, text);
    replace(text, word, other, some);
    snprintf(file, sizeof file, "%s/trial.json", part);
    write_file(file, some, "  ]\n}\n");
    const char *begin = all_rows(), *end;
    for (unsigned i = 0; i < 2 * first; i++) {
        begin = strchr(begin, '\n') + 1;
    }
    end = begin;
    for (unsigned i = 0; i < 2 * count; i++) {
        end = strchr(end, '\n') + 1;
    }
    snprintf(text, sizeof text, "%.*s", (int)(end - begin), begin);
    replace(header, word, other, some);
    snprintf(file, sizeof file, "%s/trial.csv", part);
    write_file(file, some, text);
}

/* Parts NAMES joined in FOLDER/whole. */
static asdic_status merge(const char *const names[], size_t count, bool force) {
    char path[6][200];
    const char *parts[5] = {path[0], path[1], path[2], path[3], path[4]};
    for (size_t i = 0; i < count; i++) {
        snprintf(path[i], sizeof path[i], "%s/%s", folder, names[i]);
    }
    snprintf(path[5], sizeof path[5], "%s/whole", folder);
    return asdic_trial_merge(ctx, parts, count, path[5], force);
}

/* In whatever order they are named, parts join to the trial with all their rows. */
static void parts_join_to_the_whole(void **state) {
    (void)state;
    static const char *const orders[][5] = {{"before", "a", "b", "c", "after"},
                                            {"c", "after", "a", "b", "before"},
                                            {"after", "b", "c", "before", "a"}};
    char path[200];
    write_part("before", 0, 7, "", "");
    write_part("a", 7, 1, "", "");
    write_part("b", 8, 2, "", "");
    write_part("c", 10, 1, "", "");
    write_part("after", 11, 29, "", "");
    snprintf(path, sizeof path, "%s/whole", folder);
    for (int i = 0; i < 3; i++) {
        asdic_trial *t = NULL, *at_once = open_trial();
        assert_ok(ctx, merge(orders[i], 5, i > 0));
        assert_ok(ctx, asdic_trial_open(ctx, path, &t));
        assert_true(asdic_trial_is_same(&t->facts, &at_once->facts));
        assert_int_equal(t->facts.first, 0);
        assert_int_equal(t->facts.count, 40);
        assert_string_equal(t->header, header);
        assert_string_equal(t->body, all_rows());
        asdic_trial_close(&t);
        asdic_trial_close(&at_once);
    }
    assert_status(ctx, merge(orders[0], 5, false), ASDIC_ERROR_EXISTS);
    assert_contains(asdic_context_error(ctx), "holds a trial; --force replaces it");
    /* Nor is one given up that can go on. */
    static const char *const names[] = {"trial.json", "trial.csv", "trial.part.csv"};
    char name[sizeof path + 40];
    for (size_t i = 0; i < 2; i++) {
        snprintf(name, sizeof name, "%s/%s", path, names[i]);
        assert_int_equal(unlink(name), 0);
    }
    write_file("whole/trial.part.csv", header, "");
    assert_status(ctx, merge(orders[0], 5, false), ASDIC_ERROR_EXISTS);
    assert_contains(asdic_context_error(ctx), "holds a trial that was stopped; --force replaces");
    snprintf(name, sizeof name, "%s/%s", path, names[2]);
    assert_int_equal(access(name, F_OK), 0);
    assert_ok(ctx, merge(orders[0], 5, true));
}

static void parts_that_do_not_fit_are_refused(void **state) {
    (void)state;
    static const char *const names[] = {"before", "a", "b", "c", "after"};
    static const char other_trial[] = "parts of different trials";
    static const struct {
        unsigned first, count;
        const char *word, *other, *says;
    } wrong[] = {
        {8, 1, "", "", "runs 9 to 9 are in no part"},
        {8, 3, "", "", "runs 10 to 10 are in two parts"},
        {7, 3, "", "", "runs 7 to 7 are in two parts"},
        {8, 2, "\"seed\": 11", "\"seed\": 12", other_trial},
        {8, 2, "c0ffee", "c0ffed", other_trial},
        {8, 2, "depth_m", "width_m", other_trial},
        {8, 2, "\"scene\"", "[\"scene\"", "this is no trial.json"},
    };
    write_part("before", 0, 7, "", "");
    write_part("a", 7, 1, "", "");
    write_part("c", 10, 1, "", "");
    write_part("after", 11, 29, "", "");
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        write_part("b", wrong[i].first, wrong[i].count, wrong[i].word, wrong[i].other);
        assert_status(ctx, merge(names, 5, true), ASDIC_ERROR_INPUT);
        assert_contains(asdic_context_error(ctx), wrong[i].says);
    }
    write_part("b", 8, 2, "", "");
    assert_status(ctx, merge(names + 1, 4, true), ASDIC_ERROR_INPUT);
    assert_contains(asdic_context_error(ctx), "runs 0 to 6 are in no part");
    assert_status(ctx, merge(names, 4, true), ASDIC_ERROR_INPUT);
    assert_contains(asdic_context_error(ctx), "runs 11 to 39 are in no part");
    const char *const parts[1] = {folder};
    assert_status(ctx, asdic_trial_merge(ctx, NULL, 1, folder, true), ASDIC_ERROR_ARGUMENT);
    assert_status(ctx, asdic_trial_merge(ctx, parts, 0, folder, true), ASDIC_ERROR_ARGUMENT);
    assert_status(ctx, asdic_trial_merge(ctx, parts, 1, NULL, true), ASDIC_ERROR_ARGUMENT);
    assert_true(asdic_trial_merge(ctx, parts, 1, "/nowhere/deep", true) != ASDIC_OK);
    assert_contains(asdic_context_error(ctx), "/nowhere/deep");
}

static asdic_status note_result(void *user, unsigned to, const void *data, size_t bytes) {
    assert_int_equal(to, 0);
    assert_true(bytes >= sizeof(asdic_message));
    memcpy(user, data, sizeof(asdic_message));
    return ASDIC_OK;
}

/* One of several processes flies its own runs, and tells the first of them. */
static void a_team_has_parts(void **state) {
    (void)state;
    char part[200];
    asdic_message told = {.kind = 0};
    asdic_team team = {.rank = 1, .size = 2, .send = note_result, .user = &told};
    asdic_trial_options options = flight_to("team", 2);
    asdic_trial *t = NULL;
    snprintf(part, sizeof part, "%s/team/part_1_2", folder);
    options.team = &team;
    assert_ok(ctx, asdic_trial_fly(ctx, NULL, 0, &options));
    assert_int_equal(told.kind, ASDIC_MESSAGE_RESULT);
    assert_int_equal(told.status, ASDIC_OK);
    assert_ok(ctx, asdic_trial_open(ctx, part, &t));
    assert_int_equal(t->facts.first, 1);
    assert_int_equal(t->row_count, 1);
    asdic_trial_close(&t);
}

/* What process 1 sent last, once. */
static asdic_status give_result(void *user, unsigned *from, const void **data, size_t *bytes) {
    asdic_message *told = user;
    static asdic_message last;
    *from = 1;
    *bytes = sizeof last;
    *data = told->kind ? &last : NULL;
    last = *told;
    told->kind = 0;
    return ASDIC_OK;
}

/* Processes 1 and 2 are through. */
static asdic_status give_both(void *user, unsigned *from, const void **data, size_t *bytes) {
    static const asdic_message good = {.kind = ASDIC_MESSAGE_RESULT, .status = ASDIC_OK};
    unsigned *told = user;
    *from = ++*told;
    *bytes = sizeof good;
    *data = &good;
    return ASDIC_OK;
}

static void assert_no_part(const char *path) {
    DIR *all = opendir(path);
    assert_non_null(all);
    for (struct dirent *entry; (entry = readdir(all));) {
        assert_null(strstr(entry->d_name, "part"));
    }
    closedir(all);
}

/* Makes the trial in FOLDER/NAME one that was stopped after its first row, which it marks: of 77 pings. */
static void stop_after_first_row(const char *name) {
    char from[240], to[240], header_line[400], row[400], marked[1000];
    snprintf(from, sizeof from, "%s/%s/trial.json", folder, name);
    snprintf(to, sizeof to, "%s/%s/trial.part.json", folder, name);
    assert_int_equal(rename(from, to), 0);
    snprintf(from, sizeof from, "%s/%s/trial.csv", folder, name);
    FILE *file = fopen(from, "r");
    assert_non_null(file);
    assert_non_null(fgets(header_line, sizeof header_line, file));
    assert_non_null(fgets(row, sizeof row, file));
    assert_int_equal(fclose(file), 0);
    assert_int_equal(unlink(from), 0);
    replace(row, ",9,3,", ",9,77,", marked);
    assert_string_not_equal(row, marked);
    snprintf(to, sizeof to, "%s/trial.part.csv", name);
    write_file(to, header_line, marked);
}

/* Process 0 joins the parts of all: in a new folder, in the place of a trial there, and of one that was stopped. */
static void a_team_joins_its_parts(void **state) {
    (void)state;
    static const char *const names[] = {"joined_new", "joined_forced", "joined_resumed"};
    char path[220];
    for (int k = 0; k < 3; k++) {
        asdic_message told = {.kind = 0};
        asdic_team teams[] = {{.rank = 0, .size = 2, .receive = give_result, .user = &told},
                              {.rank = 1, .size = 2, .send = note_result, .user = &told}};
        asdic_trial_options options = flight_to(names[k], 3);
        asdic_trial *t = NULL;
        assert_int_equal(mkdir(options.folder, 0777), 0);
        if (k == 1) {
            snprintf(path, sizeof path, "%s/trial.json", names[k]);
            write_file(path, facts, "  ]\n}\n");
            snprintf(path, sizeof path, "%s/trial.csv", names[k]);
            write_file(path, header, rows);
        }
        if (k == 2) {
            assert_ok(ctx, asdic_trial_fly(ctx, NULL, 0, &options));
            stop_after_first_row(names[k]);
        }
        options.force = k == 1;
        options.resume = k == 2;
        for (int rank = 1; rank >= 0; rank--) {
            options.team = &teams[rank];
            assert_ok(ctx, asdic_trial_fly(ctx, NULL, 0, &options));
        }
        assert_ok(ctx, asdic_trial_open(ctx, options.folder, &t));
        assert_int_equal(t->row_count, 3);
        assert_int_equal(t->facts.count, 3);
        assert_null(t->facts.rule);
        assert_int_equal(t->rows[0].flown.pings, k == 2 ? 77 : 3);
        asdic_trial_close(&t);
        assert_no_part(options.folder);
    }
}

/* What a team of two left, of one process or of three it goes on with the rows that are there. */
static void a_stopped_team_may_have_another_size(void **state) {
    (void)state;
    static const char *const names[] = {"resized_alone", "resized_team"};
    char path[220];
    for (int k = 0; k < 2; k++) {
        asdic_message told = {.kind = 0};
        asdic_team second = {.rank = 1, .size = 2, .send = note_result, .user = &told};
        asdic_trial_options options = flight_to(names[k], 4);
        asdic_trial *t = NULL;
        options.team = &second; /* runs 2 and 3 */
        assert_ok(ctx, asdic_trial_fly(ctx, NULL, 0, &options));
        snprintf(path, sizeof path, "%s/part_2_4", names[k]);
        stop_after_first_row(path);
        options.team = NULL;
        assert_status(ctx, asdic_trial_fly(ctx, NULL, 0, &options), ASDIC_ERROR_EXISTS);
        assert_contains(asdic_context_error(ctx), "holds a trial that was stopped; --resume goes");
        options.resume = true;
        options.seed++;
        assert_status(ctx, asdic_trial_fly(ctx, NULL, 0, &options), ASDIC_ERROR_EXISTS);
        assert_contains(asdic_context_error(ctx), "/part_2_4 holds another trial");
        options.seed--;
        for (unsigned rank = 3; k == 1 && rank-- > 0;) {
            asdic_team third = {.rank = rank, .size = 3, .send = note_result, .receive = give_both};
            third.user = rank > 0 ? &told : (void *)&(unsigned){0};
            options.team = &third;
            assert_ok(ctx, asdic_trial_fly(ctx, NULL, 0, &options));
        }
        if (k == 0) {
            assert_ok(ctx, asdic_trial_fly(ctx, NULL, 0, &options));
        }
        assert_ok(ctx, asdic_trial_open(ctx, options.folder, &t));
        assert_int_equal(t->row_count, 4);
        for (size_t i = 0; i < 4; i++) {
            assert_int_equal(t->rows[i].flown.pings, i == 2 ? 77 : 3);
        }
        asdic_trial_close(&t);
        assert_no_part(options.folder);
    }
}

/* The process 1 that cannot take part says so; what it says after that is no news. */
static asdic_status excuse(void *user, unsigned *from, const void **data, size_t *bytes) {
    static struct {
        asdic_message head;
        asdic_message_hello about;
    } said;
    unsigned *looks = user;
    said.head = (asdic_message){.kind = ASDIC_MESSAGE_HELLO, .status = ASDIC_ERROR_INPUT};
    snprintf(said.about.why, sizeof said.about.why, "the scene is not here");
    *from = 1;
    *bytes = sizeof said;
    *data = *looks < 3 ? &said : NULL;
    return ++*looks < 1000 ? ASDIC_OK : ASDIC_ERROR_IO;
}

static void one_that_stays_away_is_not_waited_for(void **state) {
    (void)state;
    unsigned looks = 0;
    asdic_team team = {.rank = 0, .size = 2, .receive = excuse, .user = &looks};
    asdic_trial_options options = flight_to("team", 2);
    options.team = &team;
    assert_status(ctx, asdic_trial_fly(ctx, NULL, 0, &options), ASDIC_ERROR_INPUT);
    assert_string_equal(asdic_context_error(ctx), "process 1: the scene is not here");
    assert_int_equal(looks, 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_of_one_trial),
        cmocka_unit_test(parts_join_to_the_whole),
        cmocka_unit_test(parts_that_do_not_fit_are_refused),
        cmocka_unit_test(a_team_has_parts),
        cmocka_unit_test(a_team_joins_its_parts),
        cmocka_unit_test(a_stopped_team_may_have_another_size),
        cmocka_unit_test(one_that_stays_away_is_not_waited_for),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
