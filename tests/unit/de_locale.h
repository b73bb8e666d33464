/*
 * A locale with a decimal comma, made for the test where the machine has none.
 */
#ifndef ASDIC_TESTS_DE_LOCALE_H
#define ASDIC_TESTS_DE_LOCALE_H

#include <locale.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

/* Sets LC_ALL to German in the program; false where that cannot be had. Undo with
 * setlocale(LC_ALL, "C"). */
static inline bool set_german_locale(void) {
    char folder[] = "/tmp/asdic-locale-XXXXXX", command[256];
    if (!setlocale(LC_ALL, "de_DE.UTF-8") && mkdtemp(folder)) {
        snprintf(command, sizeof command,
                 "localedef -i de_DE -f UTF-8 %s/de_DE.UTF-8 >/dev/null 2>&1", folder);
        if (system(command) == 0) {
            setenv("LOCPATH", folder, 1);
            setlocale(LC_ALL, "de_DE.UTF-8");
            unsetenv("LOCPATH");
        }
        snprintf(command, sizeof command, "rm -rf %s", folder);
        if (system(command) != 0) {
            return false;
        }
    }
    return localeconv()->decimal_point[0] == ',';
}

#endif
