// Work that is independent from item to item, on a few threads.
#pragma once

#include <algorithm>
#include <cstdint>
#include <exception>
#include <thread>
#include <vector>

namespace touchdown::core {

// As many as asked for; 0: one for each core.
inline int CountThreads(int wanted) {
  // Asked once: the answer is read from a file of the system's each time.
  static const int cores =
      static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  return wanted > 0 ? wanted : cores;
}

// Calls work(begin, end) for parts of [0, count) that together are all of it,
// each on a thread of its own, and returns when all are done. What depends on
// the parts' borders depends on `threads`: results must not. Throws what the
// first failing part throws.
template <class Work>
void InParallel(std::int64_t count, int threads, const Work& work) {
  const std::int64_t parts = std::clamp<std::int64_t>(
      CountThreads(threads), 1, std::max<std::int64_t>(count, 1));
  if (parts == 1) {
    work(std::int64_t{0}, count);
    return;
  }
  std::vector<std::exception_ptr> failed(static_cast<std::size_t>(parts));
  const auto run = [&](std::int64_t part) {
    try {
      work(part * count / parts, (part + 1) * count / parts);
    } catch (...) {
      failed[static_cast<std::size_t>(part)] = std::current_exception();
    }
  };
  std::vector<std::thread> pool;
  for (std::int64_t part = 1; part < parts; ++part)
    pool.emplace_back(run, part);
  run(0);
  for (std::thread& thread : pool) thread.join();
  for (const std::exception_ptr& failure : failed) {
    if (failure) std::rethrow_exception(failure);
  }
}

}  // namespace touchdown::core
