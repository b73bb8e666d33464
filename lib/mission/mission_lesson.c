/*
 * At which pings a mission learns where rays matter. A block of pings begins with a lesson, and has more where the
 * vehicle turns or climbs: from the poses alone, so that everybody who simulates a part of the block agrees.
 */
#include "mission.h"

#include "sim/lesson.h"

/* The lessons of a block, one after the other. */
typedef struct course {
    const asdic_mission *mission;
    asdic_lesson_reach reach;
    asdic_lesson lesson;
    size_t at; /* the ping of the lesson */
} course;

/* Takes the next ping; whether it begins a lesson. */
static bool go_on(course *c, size_t ping) {
    asdic_pose pose = asdic_mission_pose(c->mission, ping, NULL);
    bool is_due = asdic_lesson_is_due(&c->lesson, &pose, ping);
    if (is_due) {
        c->at = ping;
        c->lesson =
            asdic_lesson_at(c->mission->scene, &c->mission->settings.environment, &c->reach, &pose);
    }
    return is_due;
}

static course course_to(const asdic_mission *mission, size_t ping) {
    course c = {.mission = mission,
                .reach = asdic_lesson_reach_of(&mission->settings.sonar),
                .lesson = asdic_lesson_none()};
    for (size_t k = ping - ping % ASDIC_LEARN_BLOCK; k <= ping; k++) {
        go_on(&c, k);
    }
    return c;
}

size_t asdic_mission_lesson(const asdic_mission *mission, size_t first, size_t most,
                            size_t *count) {
    course c = course_to(mission, first);
    size_t lesson = c.at;
    *count = 1;
    while (*count < most && !go_on(&c, first + *count)) {
        ++*count;
    }
    return lesson;
}

size_t asdic_mission_lessons(const asdic_mission *mission, size_t first, size_t count) {
    size_t pings = asdic_mission_ping_count(mission);
    if (first >= pings || count == 0) {
        return 0;
    }
    count = count < pings - first ? count : pings - first;
    size_t lessons = 1;
    course c = course_to(mission, first);
    for (size_t k = 1; k < count; k++) {
        lessons += go_on(&c, first + k);
    }
    return lessons;
}
