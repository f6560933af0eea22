#include "ingest/mcap/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace quadsonde::ingest::mcap {

Result<MappedFile> MappedFile::open(const std::filesystem::path& path) {
  const auto cannot = [&](int error) {
    return fail(Kind::unreadable, std::strerror(error), {path.string(), {}, {}, {}}, "check the name and the rights");
  };
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return cannot(errno);
  struct stat info;
  const int stat_error = ::fstat(descriptor, &info) != 0 ? errno : S_ISREG(info.st_mode) ? 0 : EINVAL;
  const auto size = stat_error ? 0 : static_cast<std::size_t>(info.st_size);
  void* at = size > 0 ? ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0) : nullptr;
  const int map_error = at == MAP_FAILED ? errno : 0;
  ::close(descriptor);
  if (stat_error != 0 || map_error != 0) return cannot(stat_error ? stat_error : map_error);
  return MappedFile({static_cast<const std::uint8_t*>(at), size});
}

MappedFile::MappedFile(MappedFile&& other) noexcept : bytes_(std::exchange(other.bytes_, {})) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
  std::swap(bytes_, other.bytes_);
  return *this;
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) ::munmap(const_cast<std::uint8_t*>(bytes_.data()), bytes_.size());
}

}  // namespace quadsonde::ingest::mcap
