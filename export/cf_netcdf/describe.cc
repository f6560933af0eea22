#include "export/cf_netcdf/describe.h"

#include <fmt/format.h>
#include <netcdf.h>
#include <netcdf_mem.h>

#include <algorithm>
#include <array>

#include "export/cf_netcdf/nc_file.h"
#include "export/isolated.h"

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::Kind;

constexpr std::size_t most_bytes = std::size_t{512} << 20;
constexpr std::size_t most_values = 4'000'000, most_values_in_all = 16'000'000;
constexpr std::size_t most_attribute = 1 << 20, most_variables = 4096, most_attributes = 1024, most_dimensions = 4096;

NcType type_of(nc_type type) {
  constexpr std::array<std::pair<nc_type, NcType>, 12> types{{{NC_BYTE, NcType::byte},
                                                              {NC_CHAR, NcType::character},
                                                              {NC_SHORT, NcType::int16},
                                                              {NC_INT, NcType::int32},
                                                              {NC_FLOAT, NcType::float32},
                                                              {NC_DOUBLE, NcType::float64},
                                                              {NC_UBYTE, NcType::ubyte},
                                                              {NC_USHORT, NcType::uint16},
                                                              {NC_UINT, NcType::uint32},
                                                              {NC_INT64, NcType::int64},
                                                              {NC_UINT64, NcType::uint64},
                                                              {NC_STRING, NcType::string}}};
  for (const auto& [theirs, ours] : types)
    if (theirs == type) return ours;
  return NcType::other;
}

/// Runs in the child.
class Describer {
 public:
  explicit Describer(ingest::Bytes bytes) {
    opened_ = nc_open_mem("file.nc", NC_NOWRITE, bytes.size(), const_cast<std::uint8_t*>(bytes.data()), &id_);
  }

  /// "E" and the library's words, or "D" and the description.
  std::string answer() {
    if (opened_ != NC_NOERR) return std::string("E") + nc_strerror(opened_);
    format();
    dimensions();
    said_.attributes = attributes(NC_GLOBAL);
    int count = 0;
    if (nc_inq_nvars(id_, &count) != NC_NOERR) return "Eits variables cannot be listed";
    if (count > static_cast<int>(most_variables)) return "Eit has more variables than anybody could look at";
    for (int v = 0; v < count; ++v)
      if (const int status = variable(v); status != NC_NOERR)
        return fmt::format("E{} (variable {} of {})", nc_strerror(status), v + 1, count);
    int groups = 0;
    if (nc_inq_grps(id_, &groups, nullptr) == NC_NOERR) said_.groups = static_cast<std::uint32_t>(groups);
    return "D" + pack(said_);
  }

 private:
  void format() {
    int format = 0;
    nc_inq_format(id_, &format);
    said_.format = format == NC_FORMAT_NETCDF4           ? "netCDF-4"
                   : format == NC_FORMAT_NETCDF4_CLASSIC ? "netCDF-4 classic model"
                                                         : "netCDF-3 classic";
  }

  void dimensions() {
    std::array<int, NC_MAX_DIMS> ids{};
    int count = 0, open = 0;
    std::array<int, NC_MAX_DIMS> unlimited{};
    if (nc_inq_dimids(id_, &count, nullptr, 0) != NC_NOERR || count > static_cast<int>(most_dimensions) ||
        count > NC_MAX_DIMS)
      return;
    nc_inq_dimids(id_, &count, ids.data(), 0);
    if (nc_inq_unlimdims(id_, &open, nullptr) == NC_NOERR && open <= NC_MAX_DIMS)
      nc_inq_unlimdims(id_, &open, unlimited.data());
    for (int i = 0; i < count; ++i) {
      std::array<char, NC_MAX_NAME + 1> name{};
      std::size_t length = 0;
      nc_inq_dim(id_, ids[static_cast<std::size_t>(i)], name.data(), &length);
      const bool grows = std::find(unlimited.begin(), unlimited.begin() + open, ids[static_cast<std::size_t>(i)]) !=
                         unlimited.begin() + open;
      said_.dimensions.push_back({name.data(), length, grows});
      dimension_ids_.push_back(ids[static_cast<std::size_t>(i)]);
    }
  }

  std::vector<NcAttribute> attributes(int of) {
    std::vector<NcAttribute> all;
    int count = 0;
    if (of == NC_GLOBAL)
      nc_inq_natts(id_, &count);
    else
      nc_inq_varnatts(id_, of, &count);
    for (int i = 0; i < std::min(count, static_cast<int>(most_attributes)); ++i) {
      std::array<char, NC_MAX_NAME + 1> name{};
      if (nc_inq_attname(id_, of, i, name.data()) != NC_NOERR) continue;
      nc_type type = NC_NAT;
      std::size_t length = 0;
      if (nc_inq_att(id_, of, name.data(), &type, &length) != NC_NOERR || length > most_attribute) continue;
      all.push_back({name.data(), type_of(type), {}, {}});
      read_attribute(of, length, all.back());
    }
    return all;
  }

  void read_attribute(int of, std::size_t length, NcAttribute& a) {
    const char* name = a.name.c_str();
    if (a.type == NcType::character) {
      a.texts.emplace_back(length, '\0');
      nc_get_att_text(id_, of, name, a.texts.back().data());
      // Some writers count the zero at the end.
      while (!a.texts.back().empty() && a.texts.back().back() == '\0') a.texts.back().pop_back();
    } else if (a.type == NcType::string) {
      std::vector<char*> strings(length, nullptr);
      if (length && nc_get_att_string(id_, of, name, strings.data()) == NC_NOERR) {
        for (const char* s : strings) a.texts.emplace_back(s ? s : "");
        nc_free_string(length, strings.data());
      }
    } else if (a.type != NcType::other) {
      a.numbers.resize(length);
      if (length && nc_get_att_double(id_, of, name, a.numbers.data()) != NC_NOERR) a.numbers.clear();
    }
  }

  /// A status of the library.
  int variable(int v) {
    std::array<char, NC_MAX_NAME + 1> name{};
    nc_type type = NC_NAT;
    int count = 0;
    std::array<int, NC_MAX_VAR_DIMS> ids{};
    if (const int status = nc_inq_var(id_, v, name.data(), &type, &count, ids.data(), nullptr); status != NC_NOERR)
      return status;
    NcVariable said;
    said.name = name.data();
    said.type = type_of(type);
    for (int i = 0; i < count; ++i) {
      const auto at = std::find(dimension_ids_.begin(), dimension_ids_.end(), ids[static_cast<std::size_t>(i)]);
      if (at == dimension_ids_.end()) return NC_EBADDIM;
      said.dimensions.push_back(static_cast<std::uint32_t>(at - dimension_ids_.begin()));
    }
    said.attributes = attributes(v);
    read_data(v, said);
    said_.variables.push_back(std::move(said));
    return NC_NOERR;
  }

  void read_data(int v, NcVariable& said) {
    if (said.type == NcType::string || said.type == NcType::other) return;
    std::size_t count = 1;
    for (const auto d : said.dimensions) {
      const auto length = static_cast<std::size_t>(said_.dimensions[d].length);
      if (length && count > most_values / length) {
        said.data = NcData::too_many;
        return;
      }
      count *= length;
    }
    if (count > most_values_in_all - values_) {
      said.data = NcData::too_many;
      return;
    }
    values_ += count;
    const bool read = said.type == NcType::character ? read_texts(v, count, said) : read_numbers(v, count, said);
    said.data = read ? NcData::all : NcData::unreadable;
  }

  bool read_numbers(int v, std::size_t count, NcVariable& said) {
    said.values.resize(count);
    if (!count || nc_get_var_double(id_, v, said.values.data()) == NC_NOERR) return true;
    said.values.clear();
    return false;
  }

  bool read_texts(int v, std::size_t count, NcVariable& said) {
    std::string all(count, '\0');
    if (count && nc_get_var_text(id_, v, all.data()) != NC_NOERR) return false;
    const auto row =
        said.dimensions.empty() ? 1 : static_cast<std::size_t>(said_.dimensions[said.dimensions.back()].length);
    for (std::size_t at = 0; row && at < count; at += row) said.texts.emplace_back(all.substr(at, row).c_str());
    return true;
  }

  int id_ = -1, opened_ = NC_NOERR;
  NcDescription said_;
  std::vector<int> dimension_ids_;
  std::size_t values_ = 0;
};

}  // namespace

std::string_view name_of(NcType type) {
  constexpr std::array<std::string_view, 13> names{
      "byte",   "char", "short", "int",    "float",  "double",           "ubyte",
      "ushort", "uint", "int64", "uint64", "string", "a type of its own"};
  return names[static_cast<std::size_t>(type)];
}

ingest::Result<NcDescription> describe_netcdf(ingest::Bytes bytes) {
  if (bytes.size() > most_bytes) return fail(Kind::limit, "it is larger than 512 MB");
  const auto lock = lock_netcdf();
  const auto answer = isolated([&] { return Describer(bytes).answer(); });
  if (!answer) return fail(answer.error());
  if (answer->starts_with("E")) return fail(Kind::damaged, "the netCDF library says: " + answer->substr(1));
  auto description = unpack_description(std::string_view(*answer).substr(1));
  if (!description) return fail(Kind::damaged, "the library that decodes it fails on it");
  return std::move(*description);
}

}  // namespace quadsonde::product
