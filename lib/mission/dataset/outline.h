/*
 * Where an object is in a mask: its box, its pixels, and the polygons round them.
 */
#ifndef ASDIC_MISSION_DATASET_OUTLINE_H
#define ASDIC_MISSION_DATASET_OUTLINE_H

#include "base/text.h"

#include <stdint.h>

typedef struct asdic_mask {
    size_t width, height;
    const uint16_t *number; /* [y * width + x]; 0: no object */
} asdic_mask;

typedef struct asdic_box {
    size_t pixels, left, top, right, bottom; /* RIGHT and BOTTOM are one beyond */
} asdic_box;

/* Boxes of the objects 1 to COUNT, BOXES[0] unused. */
void asdic_mask_boxes(const asdic_mask *mask, size_t count, asdic_box *boxes);

/* Appends "[x,y,x,y,...]" for each part of NUMBER in BOX that hangs together by pixels' sides, along the pixels'
 * outer edges, commas between them. SEEN has room for the mask and is 0 in the box before and after. */
void asdic_mask_polygons(const asdic_mask *mask, const asdic_box *box, uint16_t number,
                         uint8_t *seen, asdic_text *out);

#endif
