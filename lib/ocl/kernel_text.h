/*
 * The embedded kernel sources, flattened by kernels/embed.py.
 */
#ifndef ASDIC_OCL_KERNEL_TEXT_H
#define ASDIC_OCL_KERNEL_TEXT_H

typedef struct asdic_kernel_text {
    const char *file; /* "trace.cl", relative to kernels/ */
    const char *text;
} asdic_kernel_text;

/* Ends with an entry whose file is NULL. */
extern const asdic_kernel_text asdic_kernel_texts[];

#endif
