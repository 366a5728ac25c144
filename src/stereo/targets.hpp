#pragma once

/// Include before foreach_target.h: which instruction sets the vector code of the stereo matcher is compiled for.

/// Vectors of a length that only the processor knows do not fit into arrays.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)

/// The fallback without vector instructions is one of 16 bytes. Highway 1.0.3 leaves it out for GCC before 12.3, which
/// may vectorise a loop of high halves of products wrongly (GCC bug 106322); there are no products here.
#define HWY_BROKEN_EMU128 0

/// Processors since Ice Lake and Zen 4 count the bits of bytes at once. Clang before 16 encodes vpdpwssd for AVX-VNNI
/// there, which Zen 4 has not: an illegal instruction.
#if !defined(__clang__) || __clang_major__ >= 16
#define HWY_WANT_AVX3_DL
#endif
