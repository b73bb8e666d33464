/*
 * Names of files in folders.
 */
#ifndef ASDIC_BASE_FILE_NAME_H
#define ASDIC_BASE_FILE_NAME_H

#include <limits.h>
#include <stdio.h>

/* A name that is longer than the system takes stays so: no other file is opened in its place. */
typedef struct asdic_file_name {
    char text[PATH_MAX + 1];
} asdic_file_name;

/* NAME in FOLDER; asdic_file_in(...).text, handed to a function, lives until that returns. */
static inline asdic_file_name asdic_file_in(const char *folder, const char *name) {
    asdic_file_name out;
    snprintf(out.text, sizeof out.text, "%s/%s", folder, name);
    return out;
}

#endif
