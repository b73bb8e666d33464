#include "run_routes.h"

#include "base/vec.h"

#include <math.h>
#include <string.h>

/* Between the points of ROUTE; beyond its ends, the nearest but for the time. */
static asdic_route_point at(const asdic_route *route, double time_s) {
    const asdic_route_point *p = route->points;
    size_t next = 0;
    while (next < route->count && p[next].time_s < time_s) {
        next++;
    }
    if (next == 0 || next == route->count) {
        asdic_route_point end = p[next == 0 ? 0 : route->count - 1];
        end.time_s = time_s;
        return end;
    }
    const asdic_route_point *a = &p[next - 1], *b = &p[next];
    double share = (time_s - a->time_s) / (b->time_s - a->time_s);
    double turn_rad =
        remainder(b->yaw_rad - a->yaw_rad, 2.0 * ASDIC_PI); /* the shorter way round */
    return (asdic_route_point){.time_s = time_s,
                               .north_m = a->north_m + share * (b->north_m - a->north_m),
                               .east_m = a->east_m + share * (b->east_m - a->east_m),
                               .yaw_rad = a->yaw_rad + share * turn_rad};
}

/* OUTLINE, drawn where the object is at A, to B: turned about the object's place, and moved. */
static void move(asdic_outline *outline, const asdic_route_point *a, const asdic_route_point *b) {
    double cosine = cos(b->yaw_rad - a->yaw_rad), sine = sin(b->yaw_rad - a->yaw_rad);
    for (size_t k = 0; k < outline->count; k++) {
        double north_m = outline->north_m[k] - a->north_m, east_m = outline->east_m[k] - a->east_m;
        outline->north_m[k] = b->north_m + cosine * north_m - sine * east_m;
        outline->east_m[k] = b->east_m + sine * north_m + cosine * east_m;
    }
}

/* ROUTE's COUNT POINTS, of which the first is not after FIRST and the last not before LAST, in place to
 * those two and what lies between; how many these are. */
static size_t cut(asdic_route_point *points, size_t count, asdic_route_point first,
                  asdic_route_point last) {
    size_t kept = 0;
    points[kept++] = first;
    for (size_t i = 1; i + 1 < count; i++) {
        if (points[i].time_s > first.time_s && points[i].time_s < last.time_s) {
            points[kept++] = points[i];
        }
    }
    points[kept++] = last;
    return kept;
}

void asdic_routes_cut(asdic_scenery *scenery, double first_time_s, double last_time_s) {
    size_t kept = 0;
    for (size_t i = 0; i < scenery->route_count; i++) {
        asdic_route route = scenery->routes[i];
        asdic_route_point *points = scenery->points + (route.points - scenery->points);
        asdic_route_point start = points[0], first = at(&route, first_time_s),
                          last = at(&route, last_time_s);
        for (size_t k = 0; k < scenery->outline_count; k++) {
            if (strcmp(scenery->outlines[k].name, route.name) == 0) {
                move(&scenery->outlines[k], &start, &last);
            }
        }
        if (route.count > 1 && last_time_s > first_time_s) {
            route.count = cut(points, route.count, first, last);
            scenery->routes[kept++] = route;
        }
    }
    scenery->route_count = kept;
}
