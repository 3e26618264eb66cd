// Run-time dispatch of loops that are compiled once per instruction set.
#pragma once

#include <vector>

/// Inlined into one function per instruction set, and compiled anew there.
#define RACECAR_MCL_INLINE inline __attribute__((always_inline))
/// The same for a lambda: [&]() RACECAR_MCL_INLINE_LAMBDA { ... }.
#define RACECAR_MCL_INLINE_LAMBDA __attribute__((always_inline))

#if defined(__x86_64__) && defined(__GNUC__)
#define RACECAR_MCL_X86 1
#endif

namespace racecar_mcl {

enum class InstructionSet { kPortable, kAvx2, kAvx512 };

/// The instruction sets that the program was built for and the processor has, the fastest last.
std::vector<InstructionSet> availableInstructionSets();

/// The last one of availableInstructionSets(); cached.
InstructionSet fastestInstructionSet();

const char* nameOf(InstructionSet set);

#ifdef RACECAR_MCL_X86
template <typename Body>
__attribute__((target("avx2"))) void runWithAvx2(const Body& body) {
  body();
}

template <typename Body>
__attribute__((target("avx512f,avx512bw,avx512dq,avx512vl"))) void runWithAvx512(const Body& body) {
  body();
}
#endif

/// Runs a body that is compiled for the instruction set. Only code inlined into the body uses it.
/// The source file must be compiled without fused multiply-adds (-ffp-contract=off), so that
/// results are bit-identical for every instruction set.
template <typename Body>
void runWith(InstructionSet set, const Body& body) {
  switch (set) {
#ifdef RACECAR_MCL_X86
    case InstructionSet::kAvx512:
      return runWithAvx512(body);
    case InstructionSet::kAvx2:
      return runWithAvx2(body);
#endif
    default:
      return body();
  }
}

}  // namespace racecar_mcl
