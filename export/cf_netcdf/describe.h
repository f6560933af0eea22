#pragma once
// Any netCDF file as a plain description: what it says about its data, and the data as far as they are small.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ingest/flight/bytes.h"
#include "ingest/flight/problem.h"

namespace quadsonde::product {

/// Types of netCDF; `other` are those that users define.
enum class NcType : std::uint8_t {
  byte,
  character,
  int16,
  int32,
  float32,
  float64,
  ubyte,
  uint16,
  uint32,
  int64,
  uint64,
  string,
  other
};
/// "double", "char", ...: as ncdump names it.
std::string_view name_of(NcType type);
inline bool is_text(NcType type) { return type == NcType::character || type == NcType::string; }
inline bool is_float(NcType type) { return type == NcType::float32 || type == NcType::float64; }

struct NcAttribute {
  std::string name;
  NcType type = NcType::other;
  std::vector<std::string> texts;  ///< one for characters, any number for strings
  std::vector<double> numbers;
};

struct NcDimension {
  std::string name;
  std::uint64_t length = 0;
  bool unlimited = false;
};

/// How much of a variable's data came along.
enum class NcData : std::uint8_t {
  all,
  too_many,    ///< more than a check needs to hold
  unreadable,  ///< the library fails on them
  no_numbers   ///< strings, or types that users define
};

struct NcVariable {
  std::string name;
  NcType type = NcType::other;
  std::vector<std::uint32_t> dimensions;  ///< indices into NcDescription::dimensions
  std::vector<NcAttribute> attributes;
  NcData data = NcData::no_numbers;
  std::vector<double> values;      ///< row by row, as stored: neither unpacked nor with fill values taken out
  std::vector<std::string> texts;  ///< of characters: one for each row of the last dimension, cut at its zeros
};

struct NcDescription {
  std::string format;  ///< "netCDF-4", "classic", ...
  std::vector<NcDimension> dimensions;
  std::vector<NcAttribute> attributes;
  std::vector<NcVariable> variables;
  std::uint32_t groups = 0;  ///< below the root; their content is not here
};

/// Reads in a child process with limits on memory and time (export/isolated.h): the bytes may be anybody's.
/// Fails with Kind::damaged where the library cannot open them or dies of them, with Kind::limit where it takes too
/// long or the file is larger than 512 MB.
ingest::Result<NcDescription> describe_netcdf(ingest::Bytes bytes);

/// The description on its way out of the child, and back. Lengths in it are checked against what is there.
std::string pack(const NcDescription& description);
/// Empty for bytes that are none.
std::optional<NcDescription> unpack_description(std::string_view packed);

}  // namespace quadsonde::product
