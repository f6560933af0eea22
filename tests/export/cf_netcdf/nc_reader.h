#pragma once
// Reads a netCDF file out of memory through the C library, for tests.
#include <gtest/gtest.h>
#include <netcdf.h>
#include <netcdf_mem.h>

#include <string>
#include <vector>

namespace quadsonde::support {

class NcReader {
 public:
  explicit NcReader(const std::string& bytes) : bytes_(bytes) {
    EXPECT_EQ(nc_open_mem("in memory", NC_NOWRITE, bytes_.size(), bytes_.data(), &id_), NC_NOERR);
  }
  ~NcReader() { nc_close(id_); }
  NcReader(const NcReader&) = delete;
  NcReader& operator=(const NcReader&) = delete;

  bool has(const char* name) const {
    int variable = -1;
    return nc_inq_varid(id_, name, &variable) == NC_NOERR;
  }
  std::vector<double> numbers(const char* name) const {
    std::vector<double> values(size(name));
    EXPECT_EQ(nc_get_var_double(id_, variable(name), values.data()), NC_NOERR) << name;
    return values;
  }
  std::string text(const char* name) const {
    std::string values(size(name), '\0');
    EXPECT_EQ(nc_get_var_text(id_, variable(name), values.data()), NC_NOERR) << name;
    return values.c_str();
  }
  /// Of a variable, or with nullptr of the file; "(none)" where there is none.
  std::string attribute(const char* of, const char* name) const {
    const int v = of ? variable(of) : NC_GLOBAL;
    std::size_t length = 0;
    if (nc_inq_attlen(id_, v, name, &length) != NC_NOERR) return "(none)";
    std::string value(length, '\0');
    EXPECT_EQ(nc_get_att_text(id_, v, name, value.data()), NC_NOERR) << name;
    return value;
  }
  std::size_t length(const char* dimension) const {
    int d = -1;
    std::size_t n = 0;
    EXPECT_EQ(nc_inq_dimid(id_, dimension, &d), NC_NOERR) << dimension;
    EXPECT_EQ(nc_inq_dimlen(id_, d, &n), NC_NOERR);
    return n;
  }

 private:
  int variable(const char* name) const {
    int v = -1;
    EXPECT_EQ(nc_inq_varid(id_, name, &v), NC_NOERR) << name;
    return v;
  }
  std::size_t size(const char* name) const {
    int dimensions = 0, ids[NC_MAX_VAR_DIMS];
    EXPECT_EQ(nc_inq_var(id_, variable(name), nullptr, nullptr, &dimensions, ids, nullptr), NC_NOERR);
    std::size_t n = 1;
    for (int i = 0; i < dimensions; ++i) {
      std::size_t one = 0;
      nc_inq_dimlen(id_, ids[i], &one);
      n *= one;
    }
    return n;
  }
  std::string bytes_;
  int id_ = -1;
};

}  // namespace quadsonde::support
