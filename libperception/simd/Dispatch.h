#pragma once

/// A loop over returns that is also compiled for wider registers and chosen at run time. Without
/// fused multiply-add, so the bytes stay the same.
/// PERCEPTION_WIDEST also knows AVX-512: for modules compiled with -ffp-contract=off, since that
/// has fused multiply-add in it. PERCEPTION_TARGET("avx2") and ("default") choose so between two
/// functions of one name.
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define PERCEPTION_HAS_WIDER 1
#define PERCEPTION_TARGET(name) __attribute__((target(name)))
#define PERCEPTION_WIDER __attribute__((target_clones("avx2", "default")))
#define PERCEPTION_WIDEST __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define PERCEPTION_HAS_WIDER 0
#define PERCEPTION_TARGET(name)
#define PERCEPTION_WIDER
#define PERCEPTION_WIDEST
#endif
