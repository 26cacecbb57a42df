#pragma once

/// PERCEPTION_WIDER marks a function (a loop over returns) that is also compiled for AVX2 and
/// selected at run time. AVX2 without fused multiply-add: results are the same to the bit.
/// PERCEPTION_WIDEST adds AVX-512, only for modules compiled with -ffp-contract=off, since AVX-512
/// includes fused multiply-add. PERCEPTION_TARGET("avx2") and PERCEPTION_TARGET("default") select
/// between two functions of one name.
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
