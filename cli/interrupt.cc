#include "cli/interrupt.h"

#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <future>
#include <thread>

namespace quadsonde::cli {
namespace {

std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only touch lock-free atomics");

extern "C" void on_signal(int) { stop.store(true); }

void watch_signals() {
  struct sigaction action = {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  // A closed pipe and a file size limit are write errors like any other, not sudden deaths.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace

int run_interruptible(const std::function<int(const product::Control&)>& work,
                      std::function<void(std::string_view, double)> progress) {
  using namespace std::chrono_literals;
  watch_signals();
  std::atomic<int> writing{0};
  const product::Control control{std::move(progress), &stop, &writing};
  std::promise<int> promise;
  auto result = promise.get_future();
  std::thread worker([&] {
    try {
      promise.set_value(work(control));
    } catch (...) {
      promise.set_exception(std::current_exception());
    }
  });
  while (result.wait_for(20ms) != std::future_status::ready && !stop) {
  }
  if (stop) {
    const auto patience = std::chrono::steady_clock::now() + 500ms;
    while (result.wait_for(10ms) != std::future_status::ready)
      if (writing == 0 && std::chrono::steady_clock::now() > patience) break;
    std::fputs("\nquadsonde: interrupted\n", stderr);
    // The estimator cannot be left half way: the process ends around it. Nothing is being written any more.
    if (result.wait_for(0ms) != std::future_status::ready) ::_exit(130);
  }
  worker.join();
  return stop ? 130 : result.get();
}

}  // namespace quadsonde::cli
