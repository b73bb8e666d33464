/*
 * What objects hide: behind one the bottom is in its shadow, where another would not be heard. A quiet bin there does
 * not say that nothing is in it.
 */
#ifndef ASDIC_DETECT_HIDDEN_H
#define ASDIC_DETECT_HIDDEN_H

#include "evidence.h"

/* Where a direction's echo, and the levels behind it, tell of a shadow, with the probability s for a bin, its ratio r
 * becomes (1 - s) r + s. K_TABLE is of LOOK's law, or NULL. */
asdic_status asdic_evidence_hide(asdic_context *ctx, const asdic_look *look, asdic_k_table *k_table,
                                 asdic_evidence *f);

#endif
