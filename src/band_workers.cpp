#include "flight_corridor/band_workers.hpp"

#include <cstddef>
#include <system_error>
#include <utility>

namespace flight_corridor {

BandWorkers::BandWorkers(int threads) {
  threads_.reserve(static_cast<std::size_t>(threads - 1));
  try {
    for (int thread = 1; thread < threads; ++thread) threads_.emplace_back([this, thread] { work(thread); });
  } catch (const std::system_error&) {  // no thread to be had: those that are do the work
  }
}

BandWorkers::~BandWorkers() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  begin_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void BandWorkers::runErased(int parts, void* job, Call call) {
  std::unique_lock<std::mutex> lock(mutex_);
  job_ = job;
  call_ = call;
  parts_ = unfinished_ = parts;
  next_ = 0;
  begin_.notify_all();
  takeParts(lock, 0);
  end_.wait(lock, [this] { return unfinished_ == 0; });
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
}

void BandWorkers::work(int thread) {
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    begin_.wait(lock, [this] { return stop_ || next_ < parts_; });
    if (stop_) return;
    takeParts(lock, thread);
  }
}

void BandWorkers::takeParts(std::unique_lock<std::mutex>& lock, int thread) {
  while (next_ < parts_) {
    const int part = next_++;
    lock.unlock();
    std::exception_ptr error;
    try {
      call_(job_, part, thread);
    } catch (...) {
      error = std::current_exception();
    }
    lock.lock();
    if (!error_) error_ = error;
    if (--unfinished_ == 0) end_.notify_one();
  }
}

}  // namespace flight_corridor
