/*
 * The files of a run: their records and facts, sizes, and the room for them.
 */
#include "run_rig.h"

#include "de_locale.h"
#include "mission/mission.h"
#include "mission/run/run_elements.h"
#include "mission/run/run_facts.h"
#include "mission/run/run_records.h"
#include "mission/run/run_files.h"
#include "out/record.h"

#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

/* What a disk has left; 0: as it is. */
static uint64_t disk_bytes;

int __real_statvfs64(const char *path, struct statvfs *disk);
int __wrap_statvfs64(const char *path, struct statvfs *disk);

int __wrap_statvfs64(const char *path, struct statvfs *disk) {
    int failed = __real_statvfs64(path, disk);
    if (disk_bytes) {
        disk->f_bavail = disk_bytes;
        disk->f_frsize = 1;
    }
    return failed;
}

/* 200 coherent pings, with their pressures or without. */
static asdic_mission *coherent_mission(asdic_context *ctx, bool has_elements) {
    char text[512];
    asdic_mission *mission = NULL;
    snprintf(text, sizeof text,
             "version: 1\nbottom: {depth_m: 12, type: sand}\nsonar: {frequency_khz: 100, "
             "ping_rate_hz: 20, source_level_db: 200,\n"
             "  array: {elements: 64, beams: {count: 3, sector_deg: 30}}}\n"
             "mission: {pose: {position_m: [0, 0, 5]}, pings: 200}\nsampling: {coherent: true}\n"
             "output: {images: [], csv: none, elements: %s}\n",
             has_elements ? "true" : "false");
    const asdic_scene_text scene = {.text = text, .length = strlen(text), .name = "s.yaml"};
    assert_int_equal(asdic_mission_load_text(ctx, &scene, &mission), ASDIC_OK);
    return mission;
}

static void elements_are_of_one_process(void **state) {
    (void)state;
    fixture f;
    begin(&f);
    asdic_mission *m = coherent_mission(f.ctx, true);
    asdic_team team = {.size = 2};
    const asdic_run_options options = {
        .count = SIZE_MAX, .team = &team, .folder = in_folder("shared")};
    assert_int_equal(asdic_mission_run(f.ctx, m, f.pointers, 1, &options), ASDIC_ERROR_UNSUPPORTED);
    assert_non_null(strstr(asdic_context_error(f.ctx), "use --shard"));
    assert_int_not_equal(access(options.folder, F_OK), 0);
    asdic_mission_destroy(&m);
    end(&f);
}

static void sizes_are_told_in_their_own_units(void **state) {
    (void)state;
    static const struct {
        uint64_t bytes;
        const char *text;
    } cases[] = {{0, "0 kB"},
                 {614, "0.614 kB"},
                 {36700, "36.7 kB"},
                 {999499, "999 kB"},
                 {999500, "1 MB"},
                 {614000000, "614 MB"},
                 {15600000000, "15.6 GB"},
                 {UINT64_MAX, "1.84e+04 PB"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[ASDIC_BYTES_TEXT];
        assert_string_equal(asdic_bytes_text(cases[i].bytes, text), cases[i].text);
    }
}

/* The records, truth and elements of a run that goes on are there, and are not written again. */
static void room_is_for_what_is_to_come(void **state) {
    (void)state;
    fixture f;
    begin(&f);
    asdic_mission *m[2] = {coherent_mission(f.ctx, false), coherent_mission(f.ctx, true)};
    uint64_t needed = asdic_mission_run_bytes(m[1], 200);
    uint64_t there = needed - asdic_mission_run_bytes(m[0], 200);
    char says[512], sizes[3][ASDIC_BYTES_TEXT];
    assert_true(there > needed / 2);
    asdic_run_options resume = {.count = SIZE_MAX, .resume = true, .folder = in_folder("room")};
    assert_int_equal(mkdir(resume.folder, 0777), 0);
    fclose(fopen(in_folder("room/run.json"), "w"));
    static const char *const names[] = {"elements.npy",   "elements.npy.part", "truth.npy",
                                        "truth.npy.part", "pings.npy",         "pings.npy.part"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char path[256];
        snprintf(path, sizeof path, "%s/%s", resume.folder, names[i]);
        f.warnings[0] = 0;
        fclose(fopen(path, "w"));
        assert_int_equal(truncate(path, (off_t)there), 0);
        disk_bytes = needed - there;
        assert_int_equal(asdic_run_check_room(f.ctx, m[1], &resume), ASDIC_OK);
        assert_string_equal(f.warnings, "");
        disk_bytes = needed - there - 1;
        assert_int_equal(asdic_run_check_room(f.ctx, m[1], &resume), ASDIC_OK);
        snprintf(says, sizeof says,
                 "'%s' has room for %s, but what is still to be written takes about %s",
                 resume.folder, asdic_bytes_text(disk_bytes, sizes[0]),
                 asdic_bytes_text(needed - there, sizes[1]));
        assert_non_null(strstr(f.warnings, says));
        assert_int_equal(unlink(path), 0);
    }
    resume.resume = false;
    assert_true(asdic_mission_run_bytes(m[1], SIZE_MAX) == needed);
    disk_bytes = needed;
    assert_int_equal(asdic_run_check_room(f.ctx, m[1], &resume), ASDIC_OK);
    /* Of all pings, of some and of those that are left; what the sentence says of them. */
    static const struct {
        size_t first, count, pings;
    } parts[] = {{0, SIZE_MAX, 200}, {0, 200, 200}, {150, 20, 20}, {190, 20, 10}, {199, 1, 1}};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        resume.first = parts[i].first;
        resume.count = parts[i].count;
        needed = asdic_mission_run_bytes(m[1], parts[i].pings);
        disk_bytes = needed;
        assert_int_equal(asdic_run_check_room(f.ctx, m[1], &resume), ASDIC_OK);
        disk_bytes = needed - 1;
        assert_int_equal(asdic_run_check_room(f.ctx, m[1], &resume), ASDIC_ERROR_IO);
        snprintf(says, sizeof says,
                 "'%s' has room for %s, but %zu ping%s of %s take%s %s; choose another disk, fewer "
                 "pings, less under 'output' in the scene, or --force",
                 resume.folder, asdic_bytes_text(disk_bytes, sizes[0]), parts[i].pings,
                 parts[i].pings == 1 ? "" : "s",
                 asdic_bytes_text(asdic_mission_ping_bytes(m[1]), sizes[1]),
                 parts[i].pings == 1 ? "s" : "", asdic_bytes_text(needed, sizes[2]));
        assert_string_equal(asdic_context_error(f.ctx), says);
        resume.force = true;
        assert_int_equal(asdic_run_check_room(f.ctx, m[1], &resume), ASDIC_OK);
        resume.force = false;
    }
    disk_bytes = 1;
    resume.first = 200;
    assert_int_equal(asdic_run_check_room(f.ctx, m[1], &resume), ASDIC_OK);
    disk_bytes = 0;
    asdic_mission_destroy(&m[0]);
    asdic_mission_destroy(&m[1]);
    end(&f);
}

/* Opens, gives a record where there is none yet, and closes; 0 when each went well. */
static int use_records(asdic_context *ctx, asdic_store_mode mode, bool is_whole) {
    static const asdic_records_shape shape = {
        .name = "r.npy", .dtype = "<f4", .rest = "", .bytes = 4};
    asdic_records *records = NULL;
    float number = 1.5f;
    int bad = asdic_records_open(ctx, in_folder("."), mode, &shape, &records) != ASDIC_OK;
    if (!bad && asdic_records_count(records) == 0) {
        bad |= asdic_records_write(records, 0, &number) != ASDIC_OK;
    }
    if (!bad) {
        number = 0.0f;
        bad |= asdic_records_read(records, 0, &number) != ASDIC_OK || number != 1.5f;
    }
    if (!bad && is_whole) {
        bad |= asdic_records_commit(records) != ASDIC_OK;
    }
    asdic_records_close(&records);
    return bad || fcntl(0, F_GETFD) != -1; /* closed as well */
}

/* Where a program has closed its standard input, the first file that it opens has the number 0. */
static void files_may_have_any_number(void **state) {
    (void)state;
    asdic_run *run_folder = NULL;
    fixture f;
    begin(&f);
    int input = dup(0);
    close(0);
    int bad = use_records(f.ctx, ASDIC_STORE_CREATE, false);
    bad |= use_records(f.ctx, ASDIC_STORE_RESUME, true) << 1;
    bad |= use_records(f.ctx, ASDIC_STORE_READ, false) << 2;
    asdic_status opened = asdic_run_open(f.ctx, in_folder("reference"), &run_folder);
    asdic_run_close(&run_folder);
    if (input >= 0) {
        dup2(input, 0);
        close(input);
    }
    assert_int_equal(bad, 0);
    assert_int_equal(opened, ASDIC_OK);
    assert_int_equal(unlink(in_folder("r.npy")), 0);
    end(&f);
}

/* What a run that goes on finds behind its last ping goes; what it finds before stays. */
static void elements_end_with_the_run(void **state) {
    (void)state;
    fixture f;
    begin(&f);
    for (size_t pings = 1; pings <= 4; pings++) {
        asdic_elements_shape shape = {.pings = 3, .elements = 2, .samples = 1}, kept;
        asdic_records *elements = NULL;
        float pressure[4] = {0.0f};
        assert_ok(f.ctx, asdic_elements_open(f.ctx, in_folder("."), ASDIC_STORE_CREATE, &shape,
                                             &elements));
        for (size_t i = 0; i < 3; i++) {
            pressure[3] = (float)i;
            assert_ok(f.ctx, asdic_records_write(elements, i, pressure));
        }
        asdic_records_close(&elements);
        shape.pings = pings;
        assert_ok(f.ctx, asdic_elements_open(f.ctx, in_folder("."), ASDIC_STORE_RESUME, &shape,
                                             &elements));
        for (size_t i = 0; i < 4; i++) {
            assert_int_equal(i < asdic_records_count(elements), i < pings && i < 3);
        }
        assert_ok(f.ctx, asdic_records_read(elements, 0, pressure));
        assert_close(pressure[3], 0.0, 0.0);
        assert_ok(f.ctx, asdic_records_commit(elements));
        asdic_records_close(&elements);
        const asdic_settings settings = {.elements = true, .sonar.array.elements = 2};
        assert_ok(f.ctx, asdic_elements_shape_read(f.ctx, in_folder("."), &settings, &kept));
        assert_int_equal(kept.pings, pings < 3 ? pings : 3);
        assert_int_equal(unlink(in_folder(ASDIC_ELEMENTS_NAME)), 0);
    }
    end(&f);
}

/* bins.csv says in text, to the last bit, what pings.npy says in binary. */
static void csv_reads_back_to_the_bit(void **state) {
    (void)state;
    fixture f;
    asdic_run *run_folder;
    asdic_record record;
    size_t length, rows = 0;
    begin(&f);
    assert_int_equal(asdic_run_open(f.ctx, in_folder("reference"), &run_folder), ASDIC_OK);
    asdic_run_info info = asdic_run_get_info(run_folder);
    assert_int_equal(info.beams, BEAMS);
    char *csv = read_file("reference", "bins.csv", &length), *line = csv;
    const char header[] = "ping,time_s,beam,bin,range_m,level_db,bottom_db,surface_db,volume_db,"
                          "object_db,multipath_db,noise_db,stderr_db\n";
    assert_memory_equal(line, header, sizeof header - 1);
    line += sizeof header - 1;
    for (size_t ping = 0; ping < info.pings; ping++) {
        assert_int_equal(asdic_run_read(run_folder, ping, &record), ASDIC_OK);
        assert_int_equal(record.ping, ping);
        for (size_t i = 0; i < BEAMS * info.bins; i++, rows++) {
            size_t beam = i / info.bins, bin = i % info.bins;
            char prefix[64];
            int used =
                snprintf(prefix, sizeof prefix, "%zu,%.15g,%s,%zu,%.15g,", ping, record.time_s,
                         info.sonar->receivers[beam].name, bin, (double)bin + 0.5);
            assert_memory_equal(line, prefix, used);
            line += used;
            for (int c = 0; c <= ASDIC_COMPONENT_COUNT; c++) {
                float stored =
                    c < ASDIC_COMPONENT_COUNT ? record.level_db[c][i] : record.stderr_db[i];
                char *after = line;
                float read = strtof(line, &after);
                assert_true(after == line ? isnan(stored) : read == stored);
                assert_int_equal(*after, c < ASDIC_COMPONENT_COUNT ? ',' : '\n');
                line = after + 1;
            }
        }
    }
    assert_int_equal(line - csv, length);
    assert_int_equal(rows, PINGS * BEAMS * info.bins);
    free(csv);
    asdic_run_close(&run_folder);
    end(&f);
}

static void damaged_folders_are_refused(void **state) {
    (void)state;
    fixture f;
    asdic_run *opened;
    begin(&f);
    assert_int_equal(asdic_run_open(f.ctx, run_rig_folder, &opened), ASDIC_ERROR_INPUT);
    assert_int_equal(asdic_run_open(f.ctx, in_folder("nowhere"), &opened), ASDIC_ERROR_INPUT);
    asdic_run_options options = asdic_run_options_default();
    options.count = 3;
    assert_int_equal(run(&f, 1, options, "damaged"), ASDIC_OK);
    char path[300];
    snprintf(path, sizeof path, "%s/damaged/pings.npy", run_rig_folder);
    assert_int_equal(truncate(path, 2000), 0);
    assert_int_equal(asdic_run_open(f.ctx, in_folder("damaged"), &opened), ASDIC_ERROR_INPUT);
    assert_null(opened);
    size_t length;
    char *json = read_file("damaged", "run.json", &length);
    for (size_t cut = 0; cut < length; cut += 97) { /* never whole: the last cut loses a brace */
        FILE *file = fopen(in_folder("damaged/run.json"), "wb");
        fwrite(json, 1, cut, file);
        fclose(file);
        assert_int_equal(asdic_run_open(f.ctx, in_folder("damaged"), &opened), ASDIC_ERROR_INPUT);
    }
    free(json);
    end(&f);
}

/* Puts TEXT into the place of run.json, with KEY's value WRONG, or called otherwise where that is NULL. */
static void write_facts(const char *run_name, const char *text, const char *key,
                        const char *wrong) {
    char name[64], path[300], *whole = NULL;
    snprintf(name, sizeof name, "\n  \"%s\": ", key);
    const char *at = strstr(text, name);
    assert_non_null(at);
    if (wrong) {
        assert_true(asprintf(&whole, "%.*s%s%s%s", (int)(at - text), text, name, wrong,
                             at + strlen(name) + strcspn(at + strlen(name), ",\n")) > 0);
    } else {
        whole = strdup(text);
        whole[at - text + 4] = 'X';
    }
    asdic_run_facts_sign(whole, strlen(whole));
    snprintf(path, sizeof path, "%s/%s/run.json", run_rig_folder, run_name);
    FILE *file = fopen(path, "wb");
    fwrite(whole, 1, strlen(whole), file);
    fclose(file);
    free(whole);
}

static void assert_lacks(fixture *f, const char *run_name, const char *key) {
    asdic_run *opened;
    char says[80];
    snprintf(says, sizeof says, "run.json' is damaged: no valid %s", key);
    assert_int_equal(asdic_run_open(f->ctx, in_folder(run_name), &opened), ASDIC_ERROR_INPUT);
    assert_null(opened);
    assert_contains(asdic_context_error(f->ctx), says);
}

/* What counts something is a whole number; what every run states is missed by its name, and what runs of other
 * versions do not state is not. */
static void facts_are_read_whole(void **state) {
    (void)state;
    static const char *const counts[] = {"seed",          "rays",  "first_ping",
                                         "pings_planned", "pings", "rays_traced",
                                         "saturated",     "beams", "bins"},
                             *const wrong[] = {"-1", "", "3x", "\"\"", "18446744073709551616"};
    static const char *const needed[][2] = {{"version", "version"},
                                            {"state", "state"},
                                            {"scene", "path"},
                                            {"surface", "surface"},
                                            {"bottom", "bottom"},
                                            {"bottom_law", "bottom_law"},
                                            {"surface_law", "surface_law"},
                                            {"sampler", "sampler"},
                                            {"multipath", "multipath"},
                                            {"bin_length_m", "bin_length_m"},
                                            {"rays_per_s", "rays_per_s"},
                                            {"stderr_db", "median"}};
    static const char *const others[] = {"model_uncertainty_db",
                                         "whole_pings",
                                         "refraction",
                                         "devices",
                                         "remarks",
                                         "terms",
                                         "time_s",
                                         "files",
                                         "pictures"};
    fixture f;
    asdic_run *opened;
    asdic_run_options options = asdic_run_options_default();
    size_t length;
    begin(&f);
    options.count = 3;
    assert_int_equal(run(&f, 1, options, "facts"), ASDIC_OK);
    char *json = read_file("facts", "run.json", &length);
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
            write_facts("facts", json, counts[i], wrong[k]);
            assert_lacks(&f, "facts", counts[i]);
        }
        write_facts("facts", json, counts[i], NULL);
        assert_lacks(&f, "facts", counts[i]);
    }
    for (size_t i = 0; i < sizeof needed / sizeof *needed; i++) {
        write_facts("facts", json, needed[i][0], NULL);
        assert_lacks(&f, "facts", needed[i][1]);
    }
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        write_facts("facts", json, others[i], NULL);
        assert_int_equal(asdic_run_open(f.ctx, in_folder("facts"), &opened), ASDIC_OK);
        asdic_run_close(&opened);
    }
    write_facts("facts", json, "seed", "18446744073709551615");
    assert_int_equal(asdic_run_open(f.ctx, in_folder("facts"), &opened), ASDIC_OK);
    assert_true(asdic_run_get_info(opened).sampling.seed == UINT64_MAX);
    asdic_run_close(&opened);
    free(json);
    end(&f);
}

/* An argument selects tests by name. */
int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(elements_are_of_one_process),
        cmocka_unit_test(sizes_are_told_in_their_own_units),
        cmocka_unit_test(room_is_for_what_is_to_come),
        cmocka_unit_test(files_may_have_any_number),
        cmocka_unit_test(elements_end_with_the_run),
        cmocka_unit_test(csv_reads_back_to_the_bit),
        cmocka_unit_test(damaged_folders_are_refused),
        cmocka_unit_test(facts_are_read_whole),
    };
    if (argc > 1) {
        cmocka_set_test_filter(argv[1]);
    }
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
