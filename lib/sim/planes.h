/*
 * Which faces of smooth bodies make up a plane: its outline is then all that stands for it aside of its mirror direction, however
 * small they are (border.h).
 */
#ifndef ASDIC_SIM_PLANES_H
#define ASDIC_SIM_PLANES_H

#include "scene/placement.h"

/* No face. */
#define ASDIC_NO_FACE UINT32_MAX

/* By faces of the scene. */
typedef struct asdic_planes {
    size_t count;
    /* [face][side]: the face in its plane that shares the side from that corner on. */
    uint32_t *beyond;
    /* Of the plane that a face is a part of; 0: of no more than two faces, or of what bends. */
    float *height_m;
    /* How the ping under way hears a face: DEV_FORM_*, 0: not told yet. */
    uint8_t *form;
} asdic_planes;

/* Of the scene's faces those of which SMOOTH says so, by part; one that goes on beyond another part or a fold ends there. Whether
 * there was memory. */
bool asdic_planes_find(const asdic_placement *placement, const bool *smooth, asdic_planes *out);
void asdic_planes_finish(asdic_planes *planes);

/* Whether both are of one part and plane. */
bool asdic_planes_agree(const dev_triangle *a, const dev_triangle *b);

#endif
