#pragma once

/// Compiles a function twice, for any x86-64 and for processors with AVX2; the loader selects one.
/// Without fused multiply-add both give the same bits. Disabled under sanitizers, which instrument
/// the code that selects, although it runs before the sanitizer has started. Also disabled by
/// SPLINECAST_NO_VECTOR_CLONES, with which tests select the version for any x86-64.
#if defined(__x86_64__) && defined(__gnu_linux__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(SPLINECAST_NO_VECTOR_CLONES) && !defined(__SANITIZE_THREAD__) &&                    \
    !defined(__SANITIZE_ADDRESS__)
#define SPLINECAST_VECTOR_CLONES [[gnu::target_clones("avx2", "default")]]
#else
#define SPLINECAST_VECTOR_CLONES
#endif
