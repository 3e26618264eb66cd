#include "common/parallel.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <thread>

namespace racecar_mcl {

#ifdef __SANITIZE_THREAD__
// ThreadSanitizer does not see how oneTBB synchronizes its threads.
void parallelFor(int jobs, const std::function<void(int job)>& body) {
  std::thread other([&] {
    for (int job = 1; job < jobs; job += 2) body(job);
  });
  for (int job = 0; job < jobs; job += 2) body(job);
  other.join();
}
#else
void parallelFor(int jobs, const std::function<void(int job)>& body) {
  tbb::parallel_for(0, jobs, body);
}
#endif

int maxThreads() { return tbb::this_task_arena::max_concurrency(); }

}  // namespace racecar_mcl
