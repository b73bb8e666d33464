#include "track.h"

#include "base/grow.h"
#include "base/vec.h"

#include <stdlib.h>

void asdic_track_destroy(asdic_track **track) {
    if (track && *track) {
        if ((*track)->sharers-- == 0) {
            free((*track)->points);
            free(*track);
        }
        *track = NULL;
    }
}

asdic_track *asdic_track_share(asdic_track *track) {
    track->sharers++;
    return track;
}

bool asdic_track_append(asdic_track *track, const track_point *point) {
    bool good = asdic_grow(&track->points, track->count, &track->capacity, sizeof *point);
    if (good) {
        track->points[track->count++] = *point;
    }
    return good;
}

size_t asdic_track_point_count(const asdic_track *track) {
    return track->count;
}

double asdic_track_start_s(const asdic_track *track) {
    return track->points[0].time_s;
}

double asdic_track_end_s(const asdic_track *track) {
    return track->points[track->count - 1].time_s;
}

double asdic_track_gap_s(const asdic_track *track, double *from_s) {
    double longest_s = 0.0;
    for (size_t i = 1; i < track->count; i++) {
        double gap_s = track->points[i].time_s - track->points[i - 1].time_s;
        if (gap_s > longest_s) {
            longest_s = gap_s;
            *from_s = track->points[i - 1].time_s;
        }
    }
    return longest_s;
}

/* Index of the last point not after TIME_S that has another behind it; of the first when all are
 * after. */
static size_t find_leg(const asdic_track *track, double time_s) {
    size_t low = 0, high = track->count - 1;
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        if (track->points[middle].time_s <= time_s) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

/* From A to B by the shorter way round; to the last bit at the ends. From 350 to 10 degrees it is 5
 * near the end, not 365; from 170 to -170 it is -175. Tracks that count turns on are left so. */
static double turn(double a_rad, double b_rad, double share) {
    double low_rad = fmin(a_rad, b_rad) < 0.0 ? -ASDIC_PI : 0.0;
    double high_rad = low_rad + 2.0 * ASDIC_PI;
    double turned_rad = a_rad + share * remainder(b_rad - a_rad, 2.0 * ASDIC_PI);
    bool counts_on = fmin(a_rad, b_rad) < low_rad || fmax(a_rad, b_rad) > high_rad;
    if (!(share < 1.0)) {
        return b_rad;
    }
    return counts_on               ? turned_rad
           : turned_rad > high_rad ? turned_rad - 2.0 * ASDIC_PI
           : turned_rad < low_rad  ? turned_rad + 2.0 * ASDIC_PI
                                   : turned_rad;
}

static double between(double a, double b, double share) {
    return share < 1.0 ? a + share * (b - a) : b;
}

asdic_pose asdic_track_pose(const asdic_track *track, double time_s) {
    if (track->count == 1) {
        const track_point *p = track->points;
        return (asdic_pose){{p->x_m, p->y_m, p->z_m}, p->roll_rad, p->pitch_rad, p->yaw_rad};
    }
    const track_point *a = &track->points[find_leg(track, time_s)], *b = a + 1;
    double share = fmin(fmax((time_s - a->time_s) / (b->time_s - a->time_s), 0.0), 1.0);
    return (asdic_pose){
        .position_m = {between(a->x_m, b->x_m, share), between(a->y_m, b->y_m, share),
                       between(a->z_m, b->z_m, share)},
        .roll_rad = turn(a->roll_rad, b->roll_rad, share),
        .pitch_rad = turn(a->pitch_rad, b->pitch_rad, share),
        .yaw_rad = turn(a->yaw_rad, b->yaw_rad, share),
    };
}

double asdic_track_deepest_m(const asdic_track *track, double time_s) {
    double most_m = asdic_track_pose(track, time_s).position_m.z;
    for (size_t i = 0; i < track->count && track->points[i].time_s <= time_s; i++) {
        most_m = fmax(most_m, track->points[i].z_m);
    }
    return most_m;
}
