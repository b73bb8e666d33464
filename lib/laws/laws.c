/*
 * The list of laws, as meson.build has it.
 */
#include "scatterer.h"

#include "laws/law_list.h"

#include <string.h>

#define LAW(file) extern const asdic_law asdic_law_##file;
ASDIC_LAWS
#undef LAW

#define LAW(file) &asdic_law_##file,
static const asdic_law *const laws[] = {ASDIC_LAWS};
#undef LAW

size_t asdic_law_count(void) {
    return sizeof laws / sizeof *laws;
}

const asdic_law *asdic_law_get(size_t index) {
    return index < asdic_law_count() ? laws[index] : NULL;
}

const asdic_law *asdic_law_find(const char *name) {
    for (size_t i = 0; name && i < asdic_law_count(); i++) {
        if (strcmp(laws[i]->name, name) == 0) {
            return laws[i];
        }
    }
    return NULL;
}

asdic_law_info asdic_law_get_info(const asdic_law *law) {
    return law ? (asdic_law_info){law->name, law->uses, &law->model} : (asdic_law_info){0};
}

size_t asdic_law_key(const asdic_law *law, const char *key) {
    size_t i = 0;
    while (i < law->model.key_count && strcmp(law->model.keys[i].name, key) != 0) {
        i++;
    }
    return i;
}
