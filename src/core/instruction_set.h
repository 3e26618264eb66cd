// Plain loops compiled once per instruction set, and the fastest one chosen at run time.
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

/// Those this program was built for and this processor has, the fastest last.
std::vector<InstructionSet> availableInstructionSets();

/// The last of them; asked of the processor once.
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

/// Runs a body that was compiled for the instruction set. Only what the body inlines gets its
/// instructions; the source file is compiled without fused multiply-adds (-ffp-contract=off), so
/// that every instruction set gives the same bits.
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
