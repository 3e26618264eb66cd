#include "simd/cpu_dispatch.h"

namespace racecar_mcl {

std::vector<InstructionSet> availableInstructionSets() {
  std::vector<InstructionSet> sets = {InstructionSet::kPortable};
#ifdef RACECAR_MCL_X86
  if (__builtin_cpu_supports("avx2")) sets.push_back(InstructionSet::kAvx2);
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl")) {
    sets.push_back(InstructionSet::kAvx512);
  }
#endif
  return sets;
}

InstructionSet fastestInstructionSet() {
  static const InstructionSet fastest = availableInstructionSets().back();
  return fastest;
}

const char* nameOf(InstructionSet set) {
  switch (set) {
    case InstructionSet::kAvx2:
      return "avx2";
    case InstructionSet::kAvx512:
      return "avx512";
    default:
      return "portable";
  }
}

}  // namespace racecar_mcl
