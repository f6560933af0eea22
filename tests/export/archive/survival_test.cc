// What was reported is there, whatever happens: killed at every step, disk errors at every step, a full disk, eight at
// once.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <random>
#include <set>
#include <thread>

#include "tests/export/archive/made_up_netcdf.h"
#include "tests/support/data.h"

namespace quadsonde::product {
namespace {

namespace fs = std::filesystem;
using support::candidates;
using support::TemporaryFolder;

/// A kill does not care for the disk, and syncing to one costs minutes.
const bool in_memory = fs::is_directory("/dev/shm") && ::setenv("TMPDIR", "/dev/shm", 0) == 0;

std::vector<std::string> findings(const fs::path& root) {
  std::vector<std::string> all;
  auto archive = Archive::open(root);
  if (!archive) return {ingest::to_string(archive.error())};
  const auto report = archive->verify();
  if (!report) return {ingest::to_string(report.error())};
  for (const auto& f : report->findings) all.push_back(std::string(name(f.kind)) + " " + f.path + ": " + f.what);
  return all;
}

std::set<std::string> held(const fs::path& root) {
  std::set<std::string> names;
  auto archive = Archive::open(root);
  if (!archive) return names;
  const auto entries = archive->query({});
  if (!entries) return names;
  for (const auto& entry : *entries)
    if (archive->read(entry)) names.insert(entry.name);
  return names;
}

/// Adds flights from..to one by one in a process of its own, which writes a number into the pipe for each that was
/// reported.
pid_t start_adding(const fs::path& root, int from, int to, int pipe, const ArchiveFault& fault = {},
                   const rlimit* file_size = nullptr) {
  candidates(static_cast<std::size_t>(to));
  const pid_t child = ::fork();
  if (child != 0) return child;
  if (file_size) {
    ::signal(SIGXFSZ, SIG_IGN);
    ::setrlimit(RLIMIT_FSIZE, file_size);
  }
  ArchiveSettings settings;
  settings.fault = fault;
  int failures = 0;
  for (int i = from; i < to; ++i) {
    auto archive = Archive::open_or_create(root, settings);
    const auto added = archive ? archive->add({candidates(0)[static_cast<std::size_t>(i)]})
                               : ingest::Result<std::vector<Added>>(ingest::fail(archive.error()));
    if (!added) {
      ++failures;
      if (!fault && !file_size) std::fprintf(stderr, "add %d: %s\n", i, ingest::to_string(added.error()).c_str());
    }
    if (added && ::write(pipe, &i, sizeof i) != sizeof i) ::_exit(99);
  }
  ::_exit(failures ? 1 : 0);
}

struct Pipe {
  Pipe() { EXPECT_EQ(::pipe(ends), 0); }
  ~Pipe() { ::close(ends[0]), close_in(); }
  void close_in() {
    if (ends[1] >= 0) ::close(ends[1]);
    ends[1] = -1;
  }
  std::set<std::string> reported() {
    close_in();
    std::set<std::string> names;
    for (int i = 0; ::read(ends[0], &i, sizeof i) == sizeof i;)
      names.insert(candidates(0)[static_cast<std::size_t>(i)].entry.name);
    return names;
  }
  int ends[2] = {-1, -1};
};

int wait_for(pid_t child) {
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

/// Every reported profile is there and intact, and nothing half-written is seen.
void expect_whole(const fs::path& root, const std::set<std::string>& reported, const std::string& when) {
  EXPECT_THAT(findings(root), testing::IsEmpty()) << when;
  const auto there = held(root);
  for (const auto& name : reported) EXPECT_TRUE(there.contains(name)) << when << ": " << name;
}

TEST(ArchiveSurvives, AKillAtEveryStep) {
  candidates(3);
  int steps = 0;
  {
    const TemporaryFolder folder;
    ArchiveSettings counting;
    counting.fault = [&](std::string_view) { return ++steps, 0; };
    auto archive = Archive::open_or_create(folder / "a", counting);
    ASSERT_TRUE(archive->add({candidates(0)[0]}));
    ASSERT_TRUE(archive->add({candidates(0)[1]}));
  }
  ASSERT_GT(steps, 40);
  for (int at = 1; at <= steps; ++at) {
    const TemporaryFolder folder;
    Pipe pipe;
    int step = 0;
    const auto kill_there = [&, at](std::string_view) { return ++step == at ? ::kill(::getpid(), SIGKILL) : 0; };
    const int status = wait_for(start_adding(folder / "a", 0, 2, pipe.ends[1], kill_there));
    ASSERT_TRUE(WIFSIGNALED(status)) << at;
    const auto reported = pipe.reported();
    // The next one to come finishes it and goes on.
    Pipe second;
    ASSERT_EQ(wait_for(start_adding(folder / "a", 2, 3, second.ends[1])), 0) << at;
    auto all = second.reported();
    all.insert(reported.begin(), reported.end());
    expect_whole(folder / "a", all, "killed at step " + std::to_string(at));
  }
}

TEST(ArchiveSurvives, AnErrorOfTheDiskAtEveryStep) {
  candidates(4);
  for (const int error : {ENOSPC, EIO}) {
    for (int at = 1;; ++at) {
      const TemporaryFolder folder;
      ASSERT_TRUE(Archive::open_or_create(folder / "a")->add({candidates(0)[0]}));
      int step = 0;
      std::set<std::string> reported{candidates(0)[0].entry.name};
      {
        // From there on nothing can be written any more.
        ArchiveSettings settings;
        settings.fault = [&](std::string_view) { return ++step >= at ? error : 0; };
        auto archive = Archive::open_or_create(folder / "a", settings);
        ASSERT_TRUE(archive);
        const auto added = archive->add({candidates(0)[1], candidates(0)[2]});
        if (added)
          for (const auto& one : *added) reported.insert(one.entry.name);
        else
          EXPECT_NE(added.error().hint, "");
        EXPECT_TRUE(archive->query({})) << "what was there can be read all the time";
      }
      EXPECT_EQ(held(folder / "a").contains(candidates(0)[0].entry.name), true);
      ASSERT_TRUE(Archive::open_or_create(folder / "a")->add({candidates(0)[3]})) << at;
      expect_whole(folder / "a", reported, "error at step " + std::to_string(at));
      if (step < at) break;  // went through
      ASSERT_LT(at, 500);
    }
  }
}

/// A SIGKILL somewhere while six are added, again and again into the same archive.
void kill_at_random(int times, unsigned seed) {
  const TemporaryFolder folder;
  constexpr int flights = 6;
  candidates(flights);
  std::mt19937 random(seed);
  int killed = 0, in_midst = 0;
  double whole_s = 0;
  {
    Pipe pipe;
    const auto start = std::chrono::steady_clock::now();
    ASSERT_EQ(wait_for(start_adding(folder / "first", 0, flights, pipe.ends[1])), 0);
    whole_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  int i = 0;
  for (; killed < times && i < 20 * times; ++i) {
    const auto root = folder / ("a" + std::to_string(i));
    Pipe pipe;
    const pid_t child = start_adding(root, 0, flights, pipe.ends[1]);
    std::this_thread::sleep_for(std::chrono::duration<double>(std::uniform_real_distribution(0.0, whole_s)(random)));
    ::kill(child, SIGKILL);
    const bool was = WIFSIGNALED(wait_for(child));
    if (!was) whole_s *= 0.9;  // it was through before: this machine is quicker than it was
    killed += was;
    const auto reported = pipe.reported();
    in_midst += was && !reported.empty() && reported.size() < flights;
    if (!fs::exists(root / "quadsonde-archive.json")) {
      EXPECT_TRUE(reported.empty());
    } else {
      expect_whole(root, reported, "moment " + std::to_string(i));
    }
    fs::remove_all(root);
  }
  printf("%d processes, %d killed, %d of these between two reports\n", i, killed, in_midst);
  EXPECT_EQ(killed, times);
  EXPECT_GT(in_midst, 0);
}

TEST(ArchiveSurvives, KillsAtRandomMoments) { kill_at_random(15, 1); }
TEST(ArchiveStudy, TwoHundredKillsAtRandomMoments) { kill_at_random(200, 2); }

TEST(ArchiveSurvives, EightWritersAtOnce) {
  const TemporaryFolder folder;
  constexpr int writers = 8, each = 4;
  candidates(writers * each - each);
  std::vector<pid_t> children;
  Pipe pipe;
  // Two of them add the same flights.
  for (int w = 0; w < writers; ++w) {
    const int from = (w == writers - 1 ? 0 : w) * each;
    children.push_back(start_adding(folder / "a", from, from + each, pipe.ends[1]));
  }
  for (const auto child : children) EXPECT_EQ(wait_for(child), 0);
  const auto reported = pipe.reported();
  EXPECT_EQ(reported.size(), static_cast<std::size_t>((writers - 1) * each));
  expect_whole(folder / "a", reported, "eight writers");
  EXPECT_EQ(held(folder / "a"), reported);
}

TEST(ArchiveSurvives, AFileThatMayNotGrow) {
  // netCDF files of these profiles have some 60 kB; the index grows from one size to the next.
  std::size_t refused = 0;
  for (const rlim_t bytes : {0, 200, 3000, 20000, 60000, 90000, 120000}) {
    const TemporaryFolder folder;
    ASSERT_TRUE(Archive::open_or_create(folder / "a")->add({candidates(5)[0]}));
    const rlimit limit{bytes, bytes};
    Pipe pipe;
    const int status = wait_for(start_adding(folder / "a", 1, 5, pipe.ends[1], {}, &limit));
    EXPECT_TRUE(WIFEXITED(status)) << bytes;
    auto reported = pipe.reported();
    refused += 4 - reported.size();
    reported.insert(candidates(0)[0].entry.name);
    expect_whole(folder / "a", reported, std::to_string(bytes) + " bytes");
  }
  EXPECT_GT(refused, 8u);
}

TEST(ArchiveSurvives, AFullDisk) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "disk");
  if (::mount("tmpfs", (folder / "disk").c_str(), "tmpfs", 0, "size=700k") != 0)
    GTEST_SKIP() << "needs the right to mount a small file system";
  const auto root = folder / "disk/a";
  Pipe pipe;
  const int status = wait_for(start_adding(root, 0, 20, pipe.ends[1]));
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 1) << "the disk did not fill up";
  const auto reported = pipe.reported();
  EXPECT_GT(reported.size(), 0u);
  EXPECT_LT(reported.size(), 20u);
  const auto there = held(root);
  for (const auto& name : reported) EXPECT_TRUE(there.contains(name)) << name;
  // With room again everything is finished.
  ::mount("tmpfs", (folder / "disk").c_str(), "tmpfs", MS_REMOUNT, "size=20m");
  Pipe second;
  EXPECT_EQ(wait_for(start_adding(root, 0, 20, second.ends[1])), 0);
  EXPECT_EQ(second.reported().size(), 20u);
  expect_whole(root, reported, "room again");
  ::umount((folder / "disk").c_str());
}

}  // namespace
}  // namespace quadsonde::product
