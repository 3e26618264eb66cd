// Loops on all processors (oneTBB).
#pragma once

#include <functional>

namespace racecar_mcl {

/// Calls `body(job)` for every job in [0, jobs), in any order and on any threads. An exception is
/// rethrown, except with ThreadSanitizer, where it ends the program.
void parallelFor(int jobs, const std::function<void(int job)>& body);

/// The number of threads that parallelFor uses at most.
int maxThreads();

}  // namespace racecar_mcl
