#include "export/isolated.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <exception>

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::Kind;
using Clock = std::chrono::steady_clock;

#if defined(__SANITIZE_ADDRESS__)
constexpr bool reserves_address_space = true;  // the sanitizer's shadow alone is larger than any limit
#else
constexpr bool reserves_address_space = false;
#endif

/// Size of this process's address space [bytes]; 0 when it cannot be told.
std::uint64_t address_space() {
  const int file = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  if (file < 0) return 0;
  std::array<char, 64> text{};
  const auto got = ::read(file, text.data(), text.size() - 1);
  ::close(file);
  std::uint64_t pages = 0;
  for (ssize_t i = 0; i < got && text[static_cast<std::size_t>(i)] >= '0'; ++i)
    pages = pages * 10 + static_cast<std::uint64_t>(text[static_cast<std::size_t>(i)] - '0');
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

void limit(int resource, std::uint64_t value) {
  const rlimit both{value, value};
  ::setrlimit(static_cast<__rlimit_resource_t>(resource), &both);
}

void put_limits(const IsolationLimits& limits) {
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 0);
  limit(RLIMIT_CPU, static_cast<std::uint64_t>(limits.seconds) + 1);
  if (const auto held = address_space(); held && !reserves_address_space) limit(RLIMIT_AS, held + limits.memory_bytes);
}

/// What a library says on its way down is of no use to anybody.
void silence() {
  const int nowhere = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  for (const int stream : {0, 1, 2}) ::dup2(nowhere, stream);
}

[[noreturn]] void be_child(int answer, const std::function<std::string()>& work, const IsolationLimits& limits) {
  for (const int signal : {SIGINT, SIGTERM, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGPIPE})
    ::signal(signal, SIG_DFL);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // nobody waits for the answer of an orphan
  silence();
  put_limits(limits);
  try {
    const auto text = work();
    for (std::size_t at = 0; at < text.size();) {
      const auto written = ::write(answer, text.data() + at, text.size() - at);
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) ::_exit(3);
      at += static_cast<std::size_t>(written);
    }
  } catch (...) {
    ::_exit(4);
  }
  ::_exit(0);
}

enum class Heard { all, too_late, too_much };

Heard listen_to(int answer, const IsolationLimits& limits, std::string& text) {
  const auto deadline = Clock::now() + std::chrono::duration<double>(limits.seconds);
  std::array<char, 65536> piece{};
  while (true) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) return Heard::too_late;
    pollfd ready{answer, POLLIN, 0};
    const int polled = ::poll(&ready, 1, static_cast<int>(std::min<std::int64_t>(left, 1000)));
    if (polled <= 0) continue;
    const auto got = ::read(answer, piece.data(), piece.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return Heard::all;
    if (text.size() + static_cast<std::size_t>(got) > limits.answer_bytes) return Heard::too_much;
    text.append(piece.data(), static_cast<std::size_t>(got));
  }
}

}  // namespace

ingest::Result<std::string> isolated(const std::function<std::string()>& work, const IsolationLimits& limits) {
  std::array<int, 2> ends{-1, -1};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0)
    return fail(Kind::no_answer, fmt::format("no pipe to be had: {}", std::strerror(errno)), {}, "try again");
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(ends[0]);
    be_child(ends[1], work, limits);
  }
  ::close(ends[1]);
  if (child < 0) {
    const int error = errno;
    ::close(ends[0]);
    return fail(Kind::no_answer, fmt::format("no process to be had: {}", std::strerror(error)), {}, "try again");
  }
  std::string text;
  const auto heard = listen_to(ends[0], limits, text);
  ::close(ends[0]);
  if (heard != Heard::all) ::kill(child, SIGKILL);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (heard != Heard::all)
    return fail(Kind::limit, heard == Heard::too_late ? fmt::format("decoding took longer than {} s", limits.seconds)
                                                      : "decoding gave more than anybody could want");
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || text.empty())
    return fail(Kind::damaged, "the library that decodes it fails on it");
  return text;
}

}  // namespace quadsonde::product
