// How the innermost loops are compiled: once for each kind of vectors, chosen when the program is loaded.
#ifndef CK_KERNEL_H
#define CK_KERNEL_H

// Without fused multiply-add (-ffp-contract=off) every clone rounds alike, so that they give the same bits.
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__SANITIZE_ADDRESS__)
#define CK_KERNEL __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define CK_KERNEL
#endif

#endif
