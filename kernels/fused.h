/*
 * Whether a multiply-add that rounds once is to be had. Every device has fma(), and rounds it alike. In
 * PoCL on a processor without the instruction it is a library function, ten times as slow: there products
 * and sums round apart, and a ray may pass an edge on its other side.
 */
#ifndef ASDIC_KERNEL_FUSED_H
#define ASDIC_KERNEL_FUSED_H

#if defined(__FMA__) || defined(FP_FAST_FMAF) || defined(__ARM_FEATURE_FMA) ||                     \
    !defined(POCL_DEVICE_ADDRESS_BITS)
#define ASDIC_FUSED
#endif

#endif
