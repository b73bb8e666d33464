#include "format.h"

#include <asdic/mission.h>

#define ROW(name) &asdic_format_##name,
const asdic_format *const asdic_formats[ASDIC_FORMAT_COUNT] = {ASDIC_FORMATS(ROW)};

const char *asdic_format_name(size_t index) {
#define NAME(name) #name,
    static const char *const names[ASDIC_FORMAT_COUNT] = {ASDIC_FORMATS(NAME)};
    return index < ASDIC_FORMAT_COUNT ? names[index] : NULL;
}
