/*
 * Colour maps: 256 colours from low to high.
 */
#ifndef ASDIC_OUT_COLORMAP_H
#define ASDIC_OUT_COLORMAP_H

#include <asdic/output.h>

/* 0xRRGGBB of INDEX 0..255; larger indices are the last colour. */
uint32_t asdic_colormap_rgb(asdic_colormap map, unsigned index);

#endif
