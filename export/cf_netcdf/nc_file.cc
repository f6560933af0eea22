#include "export/cf_netcdf/nc_file.h"

#include <fmt/format.h>
#include <hdf5.h>
#include <netcdf.h>

#include <algorithm>
#include <array>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "export/cf_netcdf/hdf5_checksum.h"

namespace quadsonde::product {
namespace {

std::mutex& writer_lock() {
  static std::mutex mutex;
  return mutex;
}

nc_type type_of(NcFile::Type type) {
  constexpr nc_type types[] = {NC_CHAR, NC_BYTE, NC_INT, NC_FLOAT, NC_DOUBLE};
  return types[static_cast<int>(type)];
}

/// Names out of logs may hold anything.
std::string valid_utf8(std::string_view text) {
  using nlohmann::json;
  auto clean = json::parse(json(text).dump(-1, ' ', false, json::error_handler_t::replace)).get<std::string>();
  std::erase(clean, '\0');
  return clean;
}

/// What a library wants to read even where a scalar has no dimensions.
const std::size_t* starts(std::size_t dimensions) {
  static const std::size_t zeros[NC_MAX_VAR_DIMS] = {};
  return dimensions < NC_MAX_VAR_DIMS ? zeros : nullptr;
}

constexpr const char* name_in_memory = "quadsonde-in-memory.nc";

/// The HDF5 file behind the one that is being written; negative when it is not found. netCDF does not tell it.
hid_t hdf5_file() {
  std::array<hid_t, 64> open_files{};
  const auto found = H5Fget_obj_ids(H5F_OBJ_ALL, H5F_OBJ_FILE, open_files.size(), open_files.data());
  for (ssize_t i = 0; i < std::min<ssize_t>(found, open_files.size()); ++i) {
    std::array<char, 64> name{};
    H5Fget_name(open_files[static_cast<std::size_t>(i)], name.data(), name.size());
    if (std::string_view(name.data()) == name_in_memory) return open_files[static_cast<std::size_t>(i)];
  }
  return -1;
}

/// H5Fget_file_image takes the mark of an open file (byte 11) out of the superblock but leaves the checksum that
/// counted it (HDF5 1.10.8), so that nobody could open the file. Superblock version 2 or 3 with offsets of 8 bytes: 44
/// bytes, then their checksum.
bool seal(std::string& bytes) {
  constexpr std::size_t counted = 44;
  if (bytes.size() < counted + 4 || (bytes[8] != 2 && bytes[8] != 3) || bytes[9] != 8 || bytes[10] != 8) return false;
  const auto sum = hdf5_checksum(std::string_view(bytes).substr(0, counted));
  for (std::size_t i = 0; i < 4; ++i) bytes[counted + i] = static_cast<char>(sum >> (8 * i) & 0xff);
  return true;
}

/// Everything written so far, as it would lie on a disk; false when HDF5 cannot give it.
bool take_image(std::string& bytes) {
  const hid_t file = hdf5_file();
  if (file < 0 || H5Fflush(file, H5F_SCOPE_GLOBAL) < 0) return false;
  const auto size = H5Fget_file_image(file, nullptr, 0);
  if (size <= 0) return false;
  bytes.resize(static_cast<std::size_t>(size));
  return H5Fget_file_image(file, bytes.data(), bytes.size()) == size && seal(bytes);
}

constexpr int deflate_level = 4;

}  // namespace

std::unique_lock<std::mutex> lock_netcdf() { return std::unique_lock(writer_lock()); }

const NcFile::Variable NcFile::global = NC_GLOBAL;

// Not on a disk: HDF5 ends the process when one fills up under it. Not nc_create_mem: its files do not track the order
// of creation, so netCDF refuses to add anything to them later (NC_ECANTWRITE).
NcFile::NcFile() : lock_(writer_lock()) {
  note(nc_create(name_in_memory, NC_NETCDF4 | NC_CLOBBER | NC_DISKLESS, &id_), "beginning the file");
}

NcFile::~NcFile() {
  if (id_ >= 0) nc_close(id_);
}

void NcFile::note(int status, std::string_view doing) {
  if (status == NC_NOERR || !ok()) return;
  status_ = status;
  doing_ = doing;
}

NcFile::Dimension NcFile::dimension(const char* name, std::size_t size) {
  Dimension dimension = -1;
  // A length of 0 would make the dimension unlimited.
  if (ok()) note(size == 0 ? NC_EDIMSIZE : nc_def_dim(id_, name, size, &dimension), name);
  return dimension;
}

NcFile::Dimension NcFile::unlimited(const char* name) {
  Dimension dimension = -1;
  if (ok()) note(nc_def_dim(id_, name, NC_UNLIMITED, &dimension), name);
  return dimension;
}

NcFile::Variable NcFile::variable(const std::string& name, Type type, const std::vector<Dimension>& dimensions,
                                  const std::vector<std::size_t>& chunks) {
  Variable variable = -1;
  if (!ok()) return variable;
  note(nc_def_var(id_, name.c_str(), type_of(type), static_cast<int>(dimensions.size()), dimensions.data(), &variable),
       name);
  if (chunks.empty()) return variable;
  if (ok())
    note(chunks.size() == dimensions.size() ? nc_def_var_chunking(id_, variable, NC_CHUNKED, chunks.data()) : NC_EINVAL,
         name);
  if (ok()) note(nc_def_var_deflate(id_, variable, NC_SHUFFLE, 1, deflate_level), name);
  if (ok()) note(nc_def_var_fletcher32(id_, variable, NC_FLETCHER32), name);
  return variable;
}

void NcFile::attribute(Variable variable, const char* name, std::string_view text) {
  const auto clean = valid_utf8(text);
  if (ok() && !clean.empty()) note(nc_put_att_text(id_, variable, name, clean.size(), clean.data()), name);
}
void NcFile::attribute(Variable variable, const char* name, double value) {
  if (ok()) note(nc_put_att_double(id_, variable, name, NC_DOUBLE, 1, &value), name);
}
void NcFile::attribute(Variable variable, const char* name, std::span<const float> values) {
  if (ok()) note(nc_put_att_float(id_, variable, name, NC_FLOAT, values.size(), values.data()), name);
}
void NcFile::attribute(Variable variable, const char* name, std::span<const std::int32_t> values) {
  if (ok()) note(nc_put_att_int(id_, variable, name, NC_INT, values.size(), values.data()), name);
}
void NcFile::attribute(Variable variable, const char* name, std::span<const signed char> values) {
  if (ok()) note(nc_put_att_schar(id_, variable, name, NC_BYTE, values.size(), values.data()), name);
}

void NcFile::nan_is_missing(Variable variable, Type type) {
  const auto of_float = std::numeric_limits<float>::quiet_NaN();
  const auto of_double = std::numeric_limits<double>::quiet_NaN();
  if (!ok()) return;
  const bool is_double = type == Type::float64;
  note(nc_def_var_fill(id_, variable, NC_FILL, is_double ? static_cast<const void*>(&of_double) : &of_float),
       "_FillValue");
}

void NcFile::end_definitions() {
  if (ok()) note(nc_enddef(id_), "ending the definitions");
}

bool NcFile::fits(Variable variable, const std::vector<std::size_t>& shape, std::size_t values) {
  if (!ok()) return false;
  std::size_t expected = 1;
  for (const auto length : shape) expected *= length;
  int dimensions = 0;
  note(nc_inq_varndims(id_, variable, &dimensions), "a variable's dimensions");
  if (expected != values || static_cast<int>(shape.size()) != dimensions) note(NC_EEDGE, "a variable's values");
  return ok();
}

void NcFile::put(Variable v, const std::vector<std::size_t>& shape, std::span<const double> values) {
  if (fits(v, shape, values.size()))
    note(nc_put_vara_double(id_, v, starts(shape.size()), shape.data(), values.data()), "values");
}
void NcFile::put(Variable v, const std::vector<std::size_t>& shape, std::span<const float> values) {
  if (fits(v, shape, values.size()))
    note(nc_put_vara_float(id_, v, starts(shape.size()), shape.data(), values.data()), "values");
}
void NcFile::put(Variable v, const std::vector<std::size_t>& shape, std::span<const std::int32_t> values) {
  if (fits(v, shape, values.size()))
    note(nc_put_vara_int(id_, v, starts(shape.size()), shape.data(), values.data()), "values");
}
void NcFile::put(Variable v, const std::vector<std::size_t>& shape, std::span<const signed char> values) {
  if (fits(v, shape, values.size()))
    note(nc_put_vara_schar(id_, v, starts(shape.size()), shape.data(), values.data()), "values");
}
void NcFile::put(Variable v, const std::vector<std::size_t>& shape, std::string_view characters) {
  if (fits(v, shape, characters.size()))
    note(nc_put_vara_text(id_, v, starts(shape.size()), shape.data(), characters.data()), "text");
}

ingest::Result<std::string> NcFile::finish() {
  std::string bytes;
  if (ok()) note(nc_sync(id_), "ending the file");
  if (ok() && !take_image(bytes)) note(NC_EHDFERR, "taking the file out of memory");
  if (id_ >= 0) note(nc_close(std::exchange(id_, -1)), "closing the file");
  if (ok()) return bytes;
  return ingest::fail(ingest::Kind::write_failed,
                      fmt::format("the netCDF library says: {} ({})", nc_strerror(status_), doing_), {},
                      "report this together with the log");
}

}  // namespace quadsonde::product
