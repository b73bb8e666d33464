#include <asdic/scene.h>

#include "material_presets.h"

#include "../base/context.h"

#include <math.h>
#include <string.h>

asdic_material asdic_material_bottom(double bottom_type) {
    return (asdic_material){
        .law = ASDIC_LAW_BOTTOM, .bottom_type = bottom_type, .coherent_area_m2 = NAN};
}

asdic_material asdic_material_facet(double impedance_mrayl, double roughness_rms_m,
                                    double slope_rms) {
    return (asdic_material){.law = ASDIC_LAW_FACET,
                            .impedance_mrayl = impedance_mrayl,
                            .roughness_rms_m = roughness_rms_m,
                            .slope_rms = slope_rms,
                            .coherent_area_m2 = NAN};
}

asdic_status asdic_material_find_impedance(asdic_context *ctx, const char *name,
                                           double *impedance_mrayl) {
#define PRESET(word, value) {#word, value},
    static const struct {
        const char *name;
        double impedance_mrayl;
    } presets[] = {ASDIC_MATERIAL_PRESETS(PRESET)};
#undef PRESET
    for (size_t i = 0; name && i < sizeof presets / sizeof *presets; i++) {
        if (strcmp(presets[i].name, name) == 0) {
            *impedance_mrayl = presets[i].impedance_mrayl;
            return ASDIC_OK;
        }
    }
#define PRESET(word, value) " " #word
    return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "no material '%s'; known are%s",
                      name ? name : "(none)", ASDIC_MATERIAL_PRESETS(PRESET) "");
#undef PRESET
}
