/*
 * What is fuzzed: each target takes any bytes, and must neither crash, nor take 2 s, nor 1 GiB.
 */
#ifndef ASDIC_TESTS_FUZZ_TARGETS_H
#define ASDIC_TESTS_FUZZ_TARGETS_H

#include <stddef.h>
#include <stdint.h>

typedef struct fuzz_target {
    const char *name; /* of its corpus folder, too */
    void (*run)(const uint8_t *data, size_t size);
} fuzz_target;

void fuzz_scene(const uint8_t *data, size_t size);
void fuzz_track(const uint8_t *data, size_t size);
void fuzz_grid(const uint8_t *data, size_t size);
void fuzz_obj(const uint8_t *data, size_t size);
void fuzz_off(const uint8_t *data, size_t size);
void fuzz_ply(const uint8_t *data, size_t size);
void fuzz_stl(const uint8_t *data, size_t size);
void fuzz_facts(const uint8_t *data, size_t size);      /* run.json */
void fuzz_records(const uint8_t *data, size_t size);    /* pings.npy */
void fuzz_chart_data(const uint8_t *data, size_t size); /* terrain.asc, objects.csv, routes.csv */
void fuzz_arguments(const uint8_t *data, size_t size);
void fuzz_serve(const uint8_t *data, size_t size);

/* Ends with an entry whose name is NULL. */
extern const fuzz_target fuzz_targets[];

#endif
