/* What the scattering laws of a mission leave open by their own sources. */
#include "mission.h"

#include "scene/scene.h"
#include "sim/environment.h"

#include <math.h>

static double of_material(const asdic_material *material, const asdic_law_water *water) {
    if (!material->law) {
        return NAN;
    }
    asdic_scatterer s = asdic_scatterer_at(material, water);
    return asdic_scatterer_uncertainty_db(&s);
}

asdic_law_water asdic_mission_law_water(const asdic_mission *mission) {
    const asdic_environment *env = &mission->settings.environment;
    const asdic_sonar *sonar = &mission->settings.sonar;
    double depth_m = asdic_mission_pose(mission, 0, NULL).position_m.z;
    asdic_water_column column = asdic_water_column_at(env, sonar, depth_m);
    return asdic_water_column_laws(&column, env, sonar);
}

double asdic_mission_object_uncertainty_db(const asdic_mission *mission, size_t object) {
    asdic_law_water water = asdic_mission_law_water(mission);
    return of_material(&mission->objects[object].material, &water);
}

asdic_uncertainty asdic_mission_uncertainty(const asdic_mission *mission) {
    asdic_uncertainty out;
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        out.db[c] = NAN;
    }
    if (!mission) {
        return out;
    }
    asdic_law_water water = asdic_mission_law_water(mission);
    out.db[ASDIC_BOTTOM] = of_material(&mission->bottom, &water);
    if (mission->scene->has_surface) {
        out.db[ASDIC_SURFACE] = of_material(&mission->scene->surface, &water);
    }
    for (size_t i = 0; i < mission->object_count; i++) {
        const asdic_mission_object *o = &mission->objects[i];
        if (o->name[0]) { /* not a bottom from a mesh */
            out.db[ASDIC_OBJECT] =
                fmax(out.db[ASDIC_OBJECT], of_material(&o->material, &water)); /* NAN gives way */
        }
    }
    return out;
}
