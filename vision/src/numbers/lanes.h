// Loops over many numbers that the compiler makes vector instructions of, for
// the widest that the processor has: GCC and clang build such a function once
// for each set of instructions, and the program chooses when it starts.
//
// Results do not depend on the choice: sums are kept in eight places whatever
// the width, and multiply-add is not fused (avx2 without fma; x86-64-v4, which
// has AVX-512, with the option -ffp-contract=off where numbers are not whole).
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

// Sanitizers come up after the choice would be made.
#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__) && !defined(__clang__)
#define TOUCHDOWN_WIDEST \
  __attribute__((target_clones("arch=x86-64-v4", "avx2", "default")))
#else
#define TOUCHDOWN_WIDEST
#endif

// What such a function calls must be part of it.
#define TOUCHDOWN_INLINE inline __attribute__((always_inline))

namespace touchdown::vision {

// Four numbers at a time, or eight short ones, as GCC and clang have them in
// the language: one instruction of avx2, two of older processors.
using Four = double __attribute__((vector_size(32), may_alias));
using FourBits = std::uint64_t __attribute__((vector_size(32)));
using Eight = float __attribute__((vector_size(32), may_alias));
using EightBits = std::uint32_t __attribute__((vector_size(32)));

// Four short numbers: one instruction of any processor of 64 bits.
using FourFloats = float __attribute__((vector_size(16)));

// Sixteen short numbers: one instruction of AVX-512, two of avx2. For what is
// done to each number by itself; sums are kept in eight places.
using Wide = float __attribute__((vector_size(64), may_alias));
using WideBits = std::uint32_t __attribute__((vector_size(64)));
inline constexpr std::size_t kWide = 16;  // numbers

// Places that sums are kept in.
inline constexpr std::size_t kSumPlaces = 8;

// The four that begin at `first`, which lies on a multiple of 32 bytes.
TOUCHDOWN_INLINE const Four& FourAt(const double* first) {
  return *reinterpret_cast<const Four*>(first);
}
TOUCHDOWN_INLINE Four& FourAt(double* first) {
  return *reinterpret_cast<Four*>(first);
}
TOUCHDOWN_INLINE const Eight& EightAt(const float* first) {
  return *reinterpret_cast<const Eight*>(first);
}
TOUCHDOWN_INLINE Eight& EightAt(float* first) {
  return *reinterpret_cast<Eight*>(first);
}

TOUCHDOWN_INLINE const Wide& WideAt(const float* first) {
  return *reinterpret_cast<const Wide*>(first);
}
TOUCHDOWN_INLINE Wide& WideAt(float* first) {
  return *reinterpret_cast<Wide*>(first);
}

// The four that begin at `first`, wherever it lies.
TOUCHDOWN_INLINE FourFloats LoadFour(const float* first) {
  FourFloats four;
  std::memcpy(&four, first, sizeof(four));
  return four;
}
TOUCHDOWN_INLINE void StoreFour(const FourFloats& four, float* first) {
  std::memcpy(first, &four, sizeof(four));
}

// Asks for a stretch of memory that is used soon: a mapped recording's rows lie
// pages apart, and a fit would wait for one after another.
inline void Prefetch(const void* begin, std::size_t bytes) {
  // Bytes of a cache line (x86-64, most ARM).
  constexpr std::size_t kLine = 64;
  const char* const first = static_cast<const char*>(begin);
  for (std::size_t at = 0; at < bytes + kLine; at += kLine) {
    __builtin_prefetch(first + at);
  }
}

}  // namespace touchdown::vision
