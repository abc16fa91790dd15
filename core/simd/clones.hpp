#pragma once

/// Marks a function that is compiled twice, for any x86-64 and for processors with AVX2; the loader
/// takes the one that fits. Without fused multiply-add both give the same bits. Not where a
/// sanitizer instruments the choice, which is made before it has started, nor where a test wants
/// the one for any x86-64.
#if defined(__x86_64__) && defined(__gnu_linux__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(SPLINECAST_NO_VECTOR_CLONES) && !defined(__SANITIZE_THREAD__) &&                    \
    !defined(__SANITIZE_ADDRESS__)
#define SPLINECAST_VECTOR_CLONES [[gnu::target_clones("avx2", "default")]]
#else
#define SPLINECAST_VECTOR_CLONES
#endif
