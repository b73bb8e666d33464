#include <asdic/common.h>

#define TEXT2(x) #x
#define TEXT(x) TEXT2(x)

const char *asdic_version(void) {
    return TEXT(ASDIC_VERSION_MAJOR) "." TEXT(ASDIC_VERSION_MINOR) "." TEXT(ASDIC_VERSION_PATCH);
}

const char *asdic_status_text(asdic_status status) {
    switch (status) {
    case ASDIC_OK:
        return "done";
    case ASDIC_ERROR_ARGUMENT:
        return "invalid argument";
    case ASDIC_ERROR_INPUT:
        return "bad input file";
    case ASDIC_ERROR_DEVICE:
        return "no usable OpenCL device";
    case ASDIC_ERROR_DEVICE_LOST:
        return "device failed while working";
    case ASDIC_ERROR_MEMORY:
        return "out of memory";
    case ASDIC_ERROR_IO:
        return "input or output failed";
    case ASDIC_ERROR_EXISTS:
        return "output exists";
    case ASDIC_ERROR_INTERRUPTED:
        return "interrupted";
    case ASDIC_ERROR_UNSUPPORTED:
        return "not supported here";
    }
    return "unknown status";
}
