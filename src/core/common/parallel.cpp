#include "common/parallel.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace racecar_mcl {

void parallelFor(int jobs, const std::function<void(int job)>& body) {
  tbb::parallel_for(0, jobs, body);
}

int maxThreads() { return tbb::this_task_arena::max_concurrency(); }

}  // namespace racecar_mcl
