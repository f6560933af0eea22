#include "export/archive/folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

#include "export/atomic_file.h"

namespace quadsonde::product {
namespace {

namespace fs = std::filesystem;
using ingest::fail;
using ingest::Kind;
using ingest::Result;

tl::unexpected<ingest::Problem> cannot(const std::string& what, const fs::path& path, int error) {
  return fail(Kind::write_failed, fmt::format("{}: {}", what, std::strerror(error)), {path.string(), {}, {}, {}},
              "check that the archive is writable and has room; what was added before is safe");
}

std::string parent_of(const std::string& relative) {
  const auto slash = relative.rfind('/');
  return slash == std::string::npos ? std::string() : relative.substr(0, slash);
}

enum class Asked { got, busy, failed };
Asked ask(int descriptor, int how) {
  while (::flock(descriptor, how | LOCK_NB) != 0) {
    if (errno == EINTR) continue;
    return errno == EWOULDBLOCK ? Asked::busy : Asked::failed;
  }
  return Asked::got;
}

Result<ArchiveLock> wait_for(int descriptor, int how, const fs::path& path, const ArchiveStop& stopped) {
  ArchiveLock lock(descriptor);
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(5);
  while (true) {
    const auto asked = ask(descriptor, how);
    if (asked == Asked::got) return lock;
    if (asked == Asked::failed) return cannot("this archive cannot be locked", path, errno);
    if (stopped && stopped())
      return fail(Kind::no_answer, "stopped while another process writes into this archive",
                  {path.string(), {}, {}, {}}, "run it again");
    if (std::chrono::steady_clock::now() > deadline)
      return fail(Kind::write_failed, "another process has been writing into this archive for five minutes",
                  {path.string(), {}, {}, {}}, "wait for it, or end it");
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

}  // namespace

ArchiveLock& ArchiveLock::operator=(ArchiveLock&& other) noexcept {
  if (this == &other) return *this;
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = std::exchange(other.descriptor_, -1);
  return *this;
}
ArchiveLock::~ArchiveLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Result<ArchiveLock> ArchiveFolder::lock_to_write(const ArchiveStop& stopped) const {
  const int descriptor = ::open(at(lock_name).c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (descriptor < 0) return cannot("this archive cannot be written", root_, errno);
  return wait_for(descriptor, LOCK_EX, root_, stopped);
}

std::optional<ArchiveLock> ArchiveFolder::try_lock_to_write() const {
  const int descriptor = ::open(at(lock_name).c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (descriptor < 0) return std::nullopt;
  ArchiveLock lock(descriptor);
  if (ask(descriptor, LOCK_EX) != Asked::got) return std::nullopt;
  return lock;
}

Result<ArchiveLock> ArchiveFolder::lock_to_read(const ArchiveStop& stopped) const {
  const int descriptor = ::open(at(lock_name).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (descriptor < 0) return ArchiveLock();
  return wait_for(descriptor, LOCK_SH, root_, stopped);
}

bool ArchiveFolder::is_file(const std::string& relative) const {
  struct stat info;
  return ::lstat(at(relative).c_str(), &info) == 0 && S_ISREG(info.st_mode);
}
bool ArchiveFolder::is_folder(const std::string& relative) const {
  struct stat info;
  return ::lstat(at(relative).c_str(), &info) == 0 && S_ISDIR(info.st_mode);
}

std::vector<std::string> ArchiveFolder::names(const std::string& relative) const {
  std::vector<std::string> all;
  std::error_code error;
  for (fs::directory_iterator it(at(relative), error), end; !error && it != end; it.increment(error))
    all.push_back(it->path().filename().string());
  std::sort(all.begin(), all.end());
  return all;
}

Result<std::string> ArchiveFolder::read(const std::string& relative, std::uint64_t most) const {
  const auto path = at(relative);
  const auto unreadable = [&](int error) {
    return fail(Kind::unreadable, fmt::format("cannot be read: {}", std::strerror(error)), {path.string(), {}, {}, {}},
                "check its permissions");
  };
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (descriptor < 0) return unreadable(errno);
  const ArchiveLock closes(descriptor);
  struct stat info;
  if (::fstat(descriptor, &info) != 0) return unreadable(errno);
  if (!S_ISREG(info.st_mode)) return unreadable(EINVAL);
  if (static_cast<std::uint64_t>(info.st_size) > most)
    return fail(Kind::limit, fmt::format("{} bytes are more than such a file can have", info.st_size),
                {path.string(), {}, {}, {}}, "see what it is");
  std::string text(static_cast<std::size_t>(info.st_size), '\0');
  std::size_t have = 0;
  while (have < text.size()) {
    const auto got = ::read(descriptor, text.data() + have, text.size() - have);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return unreadable(errno);
    if (got == 0) break;
    have += static_cast<std::size_t>(got);
  }
  text.resize(have);
  return text;
}

Result<void> ArchiveFolder::step(std::string_view what, const std::string& relative) const {
  if (const int error = fault_ ? fault_(what) : 0) return cannot(fmt::format("cannot {}", what), at(relative), error);
  return {};
}

Result<void> ArchiveFolder::sync(const std::string& folder) const {
  if (auto may = step("sync", folder); !may) return may;
  const int descriptor = ::open(at(folder).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return cannot("cannot be synced", at(folder), errno);
  const bool synced = ::fsync(descriptor) == 0;
  const int error = errno;
  ::close(descriptor);
  // Some file systems (of networks) know no syncing of folders.
  if (!synced && error != EINVAL) return cannot("cannot be synced", at(folder), error);
  return {};
}

Result<void> ArchiveFolder::rename(const std::string& from, const std::string& to) {
  if (auto may = step("rename", to); !may) return may;
  if (::rename(at(from).c_str(), at(to).c_str()) != 0) {
    if (errno == ENOTEMPTY || errno == EEXIST)
      return fail(Kind::inconsistent, "something else stands where this profile belongs", {at(to).string(), {}, {}, {}},
                  "see `quadsonde archive verify`");
    return cannot("cannot be renamed to its place", at(to), errno);
  }
  return sync(parent_of(to));
}

Result<std::string> ArchiveFolder::write_incoming(const std::string& name, std::string_view content) {
  if (auto may = step("write", name); !may) return fail(may.error());
  auto file = AtomicFile::create(at(name), true);
  if (!file) return fail(file.error());
  if (auto written = file->write(content); !written) return fail(written.error());
  if (auto may = step("commit", name); !may) return fail(may.error());
  if (auto done = file->commit(); !done) return fail(done.error());
  return name;
}

Result<void> ArchiveFolder::place(const std::string& relative, std::string_view content) {
  if (auto made = make_folders(parent_of(relative)); !made) return made;
  if (auto made = make_folders(incoming_name); !made) return made;
  const auto name = fmt::format("{}/file-{}", incoming_name, ++counter_);
  if (auto written = write_incoming(name, content); !written) return fail(written.error());
  auto renamed = rename(name, relative);
  if (!renamed) remove(name);
  return renamed;
}

Result<void> ArchiveFolder::place_if_other(const std::string& relative, const std::string& content) {
  if (const auto there = read(relative, content.size()); there && *there == content) return {};
  return place(relative, content);
}

Result<void> ArchiveFolder::place_folder(const std::string& relative,
                                         const std::vector<std::pair<std::string, std::string_view>>& files) {
  if (auto made = make_folders(parent_of(relative)); !made) return made;
  const auto name = fmt::format("{}/folder-{}", incoming_name, ++counter_);
  if (auto made = make_folders(name); !made) return made;
  Result<void> done{};
  for (const auto& [file, content] : files)
    if (auto written = write_incoming(name + "/" + file, content); !written && done) done = fail(written.error());
  if (done) done = rename(name, relative);
  if (!done && is_folder(name)) clear_incoming();
  return done;
}

void ArchiveFolder::remove(const std::string& relative) {
  std::error_code ignored;
  if (fault_ && fault_("remove")) return;
  fs::remove(at(relative), ignored);
}

Result<void> ArchiveFolder::make_folders(const std::string& relative) {
  if (relative.empty() || is_folder(relative)) return {};
  if (auto made = make_folders(parent_of(relative)); !made) return made;
  if (auto may = step("make a folder", relative); !may) return may;
  if (::mkdir(at(relative).c_str(), 0777) != 0 && errno != EEXIST)
    return cannot("this folder cannot be made", at(relative), errno);
  if (!is_folder(relative))
    return fail(Kind::inconsistent, "something that is no folder stands here", {at(relative).string(), {}, {}, {}},
                "see `quadsonde archive verify`");
  return sync(parent_of(relative));
}

void ArchiveFolder::clear_incoming() {
  std::error_code ignored;
  if (fault_ && fault_("remove")) return;
  for (const auto& name : names(incoming_name)) fs::remove_all(at(std::string(incoming_name) + "/" + name), ignored);
}

std::vector<std::string> ArchiveFolder::journal() const {
  std::vector<std::string> lines;
  const auto text = read(journal_name, std::uint64_t{16} << 20);
  if (!text) return {everything};
  for (std::size_t at = 0; at < text->size();) {
    const auto end = std::min(text->find('\n', at), text->size());
    if (end > at) lines.push_back(text->substr(at, end - at));
    at = end + 1;
  }
  return lines;
}

Result<void> ArchiveFolder::write_journal(const std::vector<std::string>& folders) {
  std::string text;
  for (const auto& folder : folders) text += folder + "\n";
  return place(journal_name, text);
}

}  // namespace quadsonde::product
