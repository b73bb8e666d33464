/*
 * All kernels of a coherent ping (coherent.h) as one program, in order: coherent_place puts scatterers on the
 * patches that the host found, the tracer tells which are hidden, coherent_shade computes what they send
 * back, coherent_count, _offset, _first and _sort order them by range, coherent_elements sums them at every
 * element of the array, coherent_beams weighs the elements. A work-item owns the sums that it writes and adds
 * in the order of scatterers, so that no sum depends on the device's scheduling.
 */
#include "scatterers.cl"
#include "gates.cl"
#include "array.cl"
