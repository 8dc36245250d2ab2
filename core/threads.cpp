#include "core/threads.h"

#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <utility>

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace glint {

ParallelFor parallel_for_on(int threads, std::stop_token stop) {
    // oneTBB complains on stderr about an arena larger than the machine.
    const int useful = std::min(threads, tbb::info::default_concurrency());
    // One thread needs no library, and so no memory or thread of one.
    if (useful <= 1) {
        return [stop](std::size_t count, const std::function<void(std::size_t)>& task) {
            for (std::size_t i = 0; i < count; ++i) {
                if (stop.stop_requested()) throw Abandoned();
                task(i);
            }
        };
    }
    return [arena = std::make_shared<tbb::task_arena>(useful), stop](std::size_t count,
                                                                     const std::function<void(std::size_t)>& task) {
        const auto guarded = [&](std::size_t i) {
            if (stop.stop_requested()) throw Abandoned();
            task(i);
        };
        // Tasks differ much in size, so each may be stolen by itself.
        arena->execute([&] { tbb::parallel_for(std::size_t{0}, count, guarded, tbb::simple_partitioner()); });
    };
}

void lower_priority() { setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), 10); }

int usable_processors() {
    cpu_set_t allowed;
    return sched_getaffinity(0, sizeof allowed, &allowed) == 0 ? std::max(1, CPU_COUNT(&allowed)) : 1;
}

bool pin_to_processor(int index) {
    cpu_set_t allowed;
    CPU_ZERO(&allowed);
    if (sched_getaffinity(0, sizeof allowed, &allowed) != 0 || CPU_COUNT(&allowed) == 0) return false;
    int left = index % CPU_COUNT(&allowed);
    for (std::size_t cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
        if (!CPU_ISSET(cpu, &allowed) || left-- > 0) continue;
        cpu_set_t one;
        CPU_ZERO(&one);
        CPU_SET(cpu, &one);
        return sched_setaffinity(0, sizeof one, &one) == 0;
    }
    return false;
}

}  // namespace glint
