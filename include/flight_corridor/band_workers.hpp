#pragma once

#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace flight_corridor {

/// Threads that wait for jobs of several independent parts. Unlike OpenCV's, starting a job allocates no memory.
class BandWorkers {
 public:
  /// @param threads that work on a job, the caller of run() included; 1 or more. Fewer work if the system cannot start
  /// more.
  explicit BandWorkers(int threads);
  ~BandWorkers();
  BandWorkers(const BandWorkers&) = delete;
  BandWorkers& operator=(const BandWorkers&) = delete;

  int threads() const { return static_cast<int>(threads_.size()) + 1; }

  /// Calls job(part, thread) once for each part from 0, and returns when all are done; calls of one thread, from 0, do
  /// not overlap. What a part throws is thrown when the others are done; the first of several.
  template <class Job>
  void run(int parts, Job&& job) {
    runErased(parts, &job, [](void* erased, int part, int thread) { (*static_cast<Job*>(erased))(part, thread); });
  }

 private:
  using Call = void (*)(void* job, int part, int thread);

  void runErased(int parts, void* job, Call call);
  void work(int thread);
  void takeParts(std::unique_lock<std::mutex>& lock, int thread);

  std::mutex mutex_;
  std::condition_variable begin_, end_;
  void* job_ = nullptr;  // this and the following members: guarded by mutex_
  Call call_ = nullptr;
  int parts_ = 0, next_ = 0, unfinished_ = 0;
  bool stop_ = false;
  std::exception_ptr error_;          // of a part of the job
  std::vector<std::thread> threads_;  // last: they use all of the above
};

}  // namespace flight_corridor
