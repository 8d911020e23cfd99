#pragma once

/// RGBD_SIMD_CLONES before a function compiles it for several x86 instruction sets and picks one at run time, so that
/// one binary runs on every robot (GCC's target_clones). Off under sanitizers (run before the resolver) and elsewhere.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__) && !defined(RGBD_NO_SIMD_CLONES)
#define RGBD_SIMD_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=haswell", "default")))
#else
#define RGBD_SIMD_CLONES
#endif
