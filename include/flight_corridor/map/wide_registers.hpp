#pragma once

/// Before a function of plain loops: built for wide registers too, chosen at run time by what the processor has.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define FLIGHT_CORRIDOR_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define FLIGHT_CORRIDOR_WIDE
#endif
