/*
 * Things stay where the scene has them, as they are at the first ping; it is the vehicle's way that
 * is taken into the frame of each, as it is when the way begins and when it ends, and put beside the
 * thing where it stands. So nothing is built anew, and nothing is missed between two steps.
 */
#include "trial_hazards.h"

#include "base/context.h"
#include "base/vec.h"

#include <stdlib.h>
#include <string.h>

/* A movable or a point of the scene: where it stands, and its track; NULL: it stays there. */
typedef struct mover {
    asdic_pose stands;
    const asdic_track *track;
} mover;

struct asdic_hazards {
    asdic_placement *placement;
    mover *movers; /* the scene's movables, then its points */
    asdic_way *ways;
    size_t count;
    bool move;
};

asdic_status asdic_hazards_create(const asdic_mission *mission, asdic_hazards **out) {
    const asdic_scene *scene = mission->scene;
    size_t movables = scene->movable_count, count = movables + scene->point_count;
    asdic_hazards *h = *out = calloc(1, sizeof *h);
    if (h) {
        h->count = count;
        h->movers = calloc(count + 1, sizeof *h->movers);
        h->ways = calloc(count + 1, sizeof *h->ways);
    }
    if (!h || !h->movers || !h->ways) {
        asdic_hazards_destroy(out);
        return asdic_fail_memory(mission->ctx, "what a vehicle can run into");
    }
    for (size_t i = 0; i < movables; i++) {
        const asdic_movable *m = &scene->movables[i];
        h->movers[i] =
            (mover){m->pose, asdic_mission_track_of(mission, scene->parts[m->part].name)};
    }
    for (size_t i = 0; i < scene->point_count; i++) {
        const asdic_point *point = &scene->points[i];
        h->movers[movables + i] = (mover){{.position_m = point->position_m},
                                          asdic_mission_track_of(mission, point->name)};
    }
    for (size_t i = 0; i < count; i++) {
        h->move = h->move || h->movers[i].track;
    }
    asdic_status status = asdic_placement_create(scene, &h->placement);
    if (status) {
        asdic_hazards_destroy(out);
    }
    return status;
}

void asdic_hazards_destroy(asdic_hazards **hazards) {
    if (*hazards) {
        asdic_placement_destroy(&(*hazards)->placement);
        free((*hazards)->movers);
        free((*hazards)->ways);
        free(*hazards);
        *hazards = NULL;
    }
}

bool asdic_hazards_move(const asdic_hazards *hazards) {
    return hazards->move;
}

/* Where AT_M is to M at TIME_S, as if M stood where it stands. */
static asdic_vec3 seen_from(const mover *m, asdic_vec3 at_m, double time_s) {
    const asdic_pose now = asdic_track_pose(m->track, time_s);
    const asdic_move back = asdic_move_between(&now, &m->stands);
    return asdic_move_point(&back, at_m);
}

/* WAY, flown from FROM_S to TO_S, as each thing sees it; NULL where none moves. */
static const asdic_way *ways_of(asdic_hazards *hazards, const asdic_way *way, double from_s,
                                double to_s) {
    for (size_t i = 0; hazards->move && i < hazards->count; i++) {
        const mover *m = &hazards->movers[i];
        hazards->ways[i] =
            m->track ? (asdic_way){seen_from(m, way->from_m, from_s), seen_from(m, way->to_m, to_s)}
                     : *way;
    }
    return hazards->move ? hazards->ways : NULL;
}

asdic_nearest asdic_hazards_nearest(asdic_hazards *hazards, asdic_vec3 from_m, asdic_vec3 to_m,
                                    double from_s, double to_s, double within_m) {
    const asdic_way way = {from_m, to_m};
    return asdic_placement_nearest(hazards->placement, &way, ways_of(hazards, &way, from_s, to_s),
                                   within_m);
}

double asdic_hazards_ahead(asdic_hazards *hazards, size_t part, const asdic_way *look,
                           double time_s, double sector_rad, double within_m) {
    return asdic_placement_ahead(hazards->placement, part, look,
                                 ways_of(hazards, look, time_s, time_s), sector_rad, within_m);
}

bool asdic_hazards_hold(const asdic_hazards *hazards, asdic_vec3 position_m, size_t *part) {
    return asdic_placement_is_inside(hazards->placement, position_m, part);
}
