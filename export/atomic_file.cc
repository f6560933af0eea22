#include "export/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::Kind;
using ingest::Result;

tl::unexpected<ingest::Problem> cannot(const std::string& what, const std::filesystem::path& path, int error) {
  return fail(Kind::write_failed, fmt::format("{}: {}", what, std::strerror(error)), {path.string(), {}, {}, {}},
              "check that the folder exists, is writable and has room");
}

tl::unexpected<ingest::Problem> already_there(const std::filesystem::path& path) {
  return fail(Kind::usage, "this file is already there", {path.string(), {}, {}, {}},
              "name another output or allow overwriting with --force");
}

bool is_there(const std::filesystem::path& path) {
  struct stat info;
  return ::lstat(path.c_str(), &info) == 0;
}

bool is_folder(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored);
}

/// A rename is on the disk only after its folder is.
void sync_folder(const std::filesystem::path& path) {
  const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path path, std::filesystem::path temporary, int descriptor, bool overwrite)
    : path_(std::move(path)), temporary_(std::move(temporary)), descriptor_(descriptor), overwrite_(overwrite) {}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : path_(std::move(other.path_)),
      temporary_(std::move(other.temporary_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      overwrite_(other.overwrite_) {
  other.temporary_.clear();
}

AtomicFile& AtomicFile::operator=(AtomicFile&& other) noexcept {
  if (this == &other) return *this;
  abandon();
  path_ = std::move(other.path_);
  temporary_ = std::exchange(other.temporary_, {});
  descriptor_ = std::exchange(other.descriptor_, -1);
  overwrite_ = other.overwrite_;
  return *this;
}

AtomicFile::~AtomicFile() { abandon(); }

void AtomicFile::abandon() {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
  temporary_.clear();
}

Result<AtomicFile> AtomicFile::create(std::filesystem::path path, bool overwrite) {
  if (is_folder(path))
    return fail(Kind::usage, "this is a folder, not a file", {path.string(), {}, {}, {}}, "name a file in it");
  if (!overwrite && is_there(path)) return already_there(path);
  // A link stays a link: what it points to is replaced.
  std::error_code error;
  if (std::filesystem::is_symlink(path, error)) {
    const auto real = std::filesystem::canonical(path, error);
    if (!error) path = real;
  }
  // The process id keeps two runs apart; the dot keeps a left-over out of the way of a glob.
  for (int attempt = 0; attempt < 100; ++attempt) {
    auto temporary = path.parent_path() / fmt::format(".{}.{}-{}.tmp", path.filename().string(), ::getpid(), attempt);
    const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0) return AtomicFile(std::move(path), std::move(temporary), descriptor, overwrite);
    if (errno != EEXIST) return cannot("cannot create a file here", path, errno);
  }
  return cannot("cannot create a file here", path, EEXIST);
}

Result<void> AtomicFile::write(ingest::Bytes bytes) {
  if (descriptor_ < 0) return cannot("this file is closed", path_, EBADF);
  while (!bytes.empty()) {
    const auto written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return cannot("cannot write", path_, written < 0 ? errno : ENOSPC);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return {};
}

Result<void> AtomicFile::commit() {
  if (descriptor_ < 0) return cannot("this file is closed", path_, EBADF);
  // A library may have replaced the file under its name: sync what stands there now.
  const int current = ::open(temporary_.c_str(), O_RDONLY | O_CLOEXEC);
  const bool synced = current >= 0 && ::fsync(current) == 0;
  const int sync_error = errno;
  if (current >= 0) ::close(current);
  if (!synced) return cannot("cannot write", path_, sync_error);
  if (::close(std::exchange(descriptor_, -1)) != 0) return cannot("cannot write", path_, errno);
  if (overwrite_) {
    if (::rename(temporary_.c_str(), path_.c_str()) != 0) return cannot("cannot rename", path_, errno);
  } else if (::link(temporary_.c_str(), path_.c_str()) == 0) {
    // link() refuses an existing target in one step, where a look and a rename would race.
    ::unlink(temporary_.c_str());
  } else if (errno == EEXIST) {
    return already_there(path_);
  } else {
    // Some file systems have no hard links.
    if (is_there(path_)) return already_there(path_);
    if (::rename(temporary_.c_str(), path_.c_str()) != 0) return cannot("cannot rename", path_, errno);
  }
  temporary_.clear();
  sync_folder(path_);
  return {};
}

Result<void> write_file(const std::filesystem::path& path, std::string_view content, bool overwrite) {
  auto file = AtomicFile::create(path, overwrite);
  if (!file) return fail(file.error());
  if (auto written = file->write(content); !written) return written;
  return file->commit();
}

}  // namespace quadsonde::product
