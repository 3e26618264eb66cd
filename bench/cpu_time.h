// CPU time of all threads of this process, independent of the load of the machine.
#pragma once

#include <time.h>

namespace racecar_mcl::bench {

inline double cpuSeconds() {
  timespec time;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace racecar_mcl::bench
