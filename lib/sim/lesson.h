/*
 * How far a vehicle may go from where a simulator learnt before it has to learn anew.
 */
#ifndef ASDIC_SIM_LESSON_H
#define ASDIC_SIM_LESSON_H

#include <asdic/ping.h>

typedef struct asdic_lesson {
    asdic_pose pose; /* where it was learnt */
    double turn_rad; /* the vertical may have turned by so much since, seen from the vehicle */
    double yaw_rad;  /* the vehicle, or the sonar's head, may have yawed by so much */
    double climb_m;  /* and risen or sunk by so much, or layers bend rays as that would */
    double way_m;    /* and have gone so far */
    bool is_even;    /* there are only planes, which are the same everywhere */
    const asdic_environment *env; /* NULL: rays go the same way from everywhere */
    double range_m;               /* of the sonar */
    double top_m, bottom_m;       /* depths between which rays are */
} asdic_lesson;

/* What a sonar reaches, the less of what the transmitter and all receivers together do: wherever it is. */
typedef struct asdic_lesson_reach {
    double height_rad, width_rad;
    double range_m;
    bool many; /* receivers */
} asdic_lesson_reach;

asdic_lesson_reach asdic_lesson_reach_of(const asdic_sonar *sonar);

/* ENV has to stay as long as the lesson. */
asdic_lesson asdic_lesson_at(const asdic_scene *scene, const asdic_environment *env,
                             const asdic_lesson_reach *reach, const asdic_pose *pose);

/* Where nothing was learnt: it serves everywhere. */
asdic_lesson asdic_lesson_none(void);

/* Whether another one is due before ping INDEX at POSE: a block of pings begins with it, or LESSON serves no longer. */
bool asdic_lesson_is_due(const asdic_lesson *lesson, const asdic_pose *pose, uint64_t index);

#endif
