#pragma once
// The one place that calls the netCDF library.
#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ingest/flight/problem.h"

namespace quadsonde::product {

/// Neither netCDF nor HDF5 may be called by two threads: whoever calls them holds this.
std::unique_lock<std::mutex> lock_netcdf();

/// The bytes of a netCDF-4 file; whoever writes them to a disk does so whole or not at all. Compressed, with checksums,
/// and the same calls give the same bytes. It grows in memory.
///
/// The first error ends everything: later calls do nothing, and finish() tells it. While one of these lives every
/// other thread waits for it, because neither netCDF nor HDF5 may be called by two.
class NcFile {
 public:
  using Dimension = int;
  using Variable = int;
  enum class Type { character, byte, int32, float32, float64 };
  static const Variable global;

  NcFile();
  ~NcFile();
  NcFile(const NcFile&) = delete;
  NcFile& operator=(const NcFile&) = delete;

  Dimension dimension(const char* name, std::size_t size);
  /// Grows with what is written.
  Dimension unlimited(const char* name);
  /// @param chunks  one length per dimension; empty: the variable stays in one uncompressed piece
  Variable variable(const std::string& name, Type type, const std::vector<Dimension>& dimensions,
                    const std::vector<std::size_t>& chunks = {});
  /// Text; empty text is not written. What is no UTF-8 is replaced.
  void attribute(Variable variable, const char* name, std::string_view text);
  void attribute(Variable variable, const char* name, double value);
  void attribute(Variable variable, const char* name, std::span<const float> values);
  void attribute(Variable variable, const char* name, std::span<const std::int32_t> values);
  void attribute(Variable variable, const char* name, std::span<const signed char> values);
  /// NaN means missing; float32 and float64 only.
  void nan_is_missing(Variable variable, Type type);
  void end_definitions();

  /// The whole variable at once, row by row.
  /// @param shape  one length per dimension; empty for a scalar
  void put(Variable variable, const std::vector<std::size_t>& shape, std::span<const double> values);
  void put(Variable variable, const std::vector<std::size_t>& shape, std::span<const float> values);
  void put(Variable variable, const std::vector<std::size_t>& shape, std::span<const std::int32_t> values);
  void put(Variable variable, const std::vector<std::size_t>& shape, std::span<const signed char> values);
  void put(Variable variable, const std::vector<std::size_t>& shape, std::string_view characters);

  /// The bytes of the file, or the first error (Kind::write_failed).
  ingest::Result<std::string> finish();

 private:
  bool ok() const { return status_ == 0; }
  void note(int status, std::string_view doing);
  bool fits(Variable variable, const std::vector<std::size_t>& shape, std::size_t values);

  std::unique_lock<std::mutex> lock_;
  int id_ = -1;
  int status_ = 0;
  std::string doing_;
};

}  // namespace quadsonde::product
