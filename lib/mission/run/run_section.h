/*
 * Sections: fan pictures of beams in an upright plane, as those of an echo sounder that looks down or of a sonar that
 * scans up and down ahead. What is below is below on the page.
 */
#ifndef ASDIC_RUN_SECTION_H
#define ASDIC_RUN_SECTION_H

#include <asdic/sonar.h>

typedef struct asdic_section {
    asdic_vec3 right, down; /* on the page, in the sonar's axes */
    bool is_starboard;      /* on the right; else what is ahead */
    bool is_reversed;       /* the last beam comes first, clockwise on the page */
} asdic_section;

/* Whether the axes of SONAR's receivers, three or more, lie in one plane, steeper than 60 degrees, and go one way
 * round in it. */
bool asdic_section_of(const asdic_sonar *sonar, asdic_section *out);

/* The direction of BEAM on the page, clockwise from up, within half a turn of NEAR_RAD. */
double asdic_section_bearing_rad(const asdic_section *section, const asdic_beam *beam,
                                 double near_rad);

/* The same of all SONAR's beams, in their order; without a section their bearings. */
void asdic_section_bearings(const asdic_section *section, const asdic_sonar *sonar,
                            double *bearing_rad);

/* The beam that stands for many: of a section the middle one, else the one that looks most nearly ahead. */
size_t asdic_beam_ahead(const asdic_sonar *sonar);

#endif
