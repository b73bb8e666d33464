#include <asdic/scene.h>

#include <math.h>

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
