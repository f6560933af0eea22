#include "export/archive/index.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <tuple>

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::Kind;
using ingest::Result;

constexpr int application = 0x51534152;  // "QSAR"
constexpr int schema_version = 1;
constexpr const char* columns =
    "name, folder, leaf, flight_id, version, input_file, input_sha256, input_flight, sha256, bytes, tool_version, "
    "date_created, vehicle, station, license, institution, start_s, end_s, lat_deg, lon_deg, bottom_msl_m, top_msl_m, "
    "surface_msl_m, bin_m, bins, good, doubtful, bad, speed_min_m_s, speed_mean_m_s, speed_max_m_s, quality, "
    "superseded";
constexpr int column_count = 33;
constexpr const char* tables =
    "CREATE TABLE profile (name TEXT PRIMARY KEY, folder TEXT NOT NULL, leaf TEXT NOT NULL, flight_id TEXT NOT NULL, "
    "version INTEGER NOT NULL, input_file TEXT, input_sha256 TEXT NOT NULL, input_flight INTEGER NOT NULL, "
    "sha256 TEXT NOT NULL, bytes INTEGER NOT NULL, tool_version TEXT, date_created TEXT, vehicle TEXT, station TEXT, "
    "license TEXT, institution TEXT, start_s REAL NOT NULL, end_s REAL NOT NULL, lat_deg REAL NOT NULL, "
    "lon_deg REAL NOT NULL, bottom_msl_m REAL NOT NULL, top_msl_m REAL NOT NULL, surface_msl_m REAL, bin_m REAL, "
    "bins INTEGER, good INTEGER, doubtful INTEGER, bad INTEGER, speed_min_m_s REAL, speed_mean_m_s REAL, "
    "speed_max_m_s REAL, quality INTEGER NOT NULL, superseded INTEGER NOT NULL);"
    // Holds all that is asked for, in a tenth of the bytes of the rows: a query looks at nothing else until it knows
    // which rows it wants, so the worst one costs no more than a walk along this index.
    "CREATE INDEX by_numbers ON profile(start_s, end_s, superseded, lat_deg, lon_deg, bottom_msl_m, top_msl_m, "
    "surface_msl_m, speed_min_m_s, speed_max_m_s, quality, vehicle, station);"
    "CREATE INDEX by_leaf ON profile(leaf, name);"
    "CREATE INDEX by_flight ON profile(flight_id);"
    "CREATE INDEX by_end ON profile(end_s);"
    "CREATE INDEX by_lat ON profile(lat_deg);"
    "CREATE INDEX by_lon ON profile(lon_deg);";

}  // namespace

void ArchiveIndex::Closer::operator()(sqlite3* db) const { sqlite3_close_v2(db); }

/// One prepared statement; values are bound, never pasted.
class ArchiveIndex::Statement {
 public:
  Statement(sqlite3* db, const std::string& sql) {
    sqlite3_prepare_v2(db, sql.c_str(), static_cast<int>(sql.size()), &statement_, nullptr);
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;
  bool ready() const { return statement_ != nullptr; }

  void bind(double value) { sqlite3_bind_double(statement_, ++at_, value); }
  void bind(std::int64_t value) { sqlite3_bind_int64(statement_, ++at_, value); }
  void bind(const std::string& value) {
    sqlite3_bind_text(statement_, ++at_, value.data(), static_cast<int>(value.size()), SQLITE_TRANSIENT);
  }
  void bind(const std::optional<double>& value) {
    if (value)
      bind(*value);
    else
      sqlite3_bind_null(statement_, ++at_);
  }
  void bind(const IndexValue& value) {
    std::visit([&](const auto& v) { bind(v); }, value);
  }
  /// SQLITE_ROW, SQLITE_DONE or an error.
  int step() { return statement_ ? sqlite3_step(statement_) : SQLITE_ERROR; }

  std::string text() {
    const auto* bytes = reinterpret_cast<const char*>(sqlite3_column_text(statement_, out_));
    const auto size = sqlite3_column_bytes(statement_, out_++);
    return bytes ? std::string(bytes, static_cast<std::size_t>(size)) : std::string();
  }
  double number() { return sqlite3_column_double(statement_, out_++); }
  std::int64_t whole() { return sqlite3_column_int64(statement_, out_++); }
  bool is_null() const { return sqlite3_column_type(statement_, out_) == SQLITE_NULL; }
  void rewind() { out_ = 0; }

 private:
  sqlite3_stmt* statement_ = nullptr;
  int at_ = 0, out_ = 0;
};

namespace {

/// Columns in the order of `columns`, for writing (bind) and, read back, for entry_of.
template <class Statement>
void bind_entry(Statement& s, const ArchiveEntry& e) {
  const auto whole = [&](auto value) { s.bind(static_cast<std::int64_t>(value)); };
  s.bind(e.name), s.bind(e.folder), s.bind(e.catalogue_folder()), s.bind(e.flight_id), whole(e.version);
  s.bind(e.input_file), s.bind(e.input_sha256), whole(e.input_flight), s.bind(e.sha256), whole(e.bytes);
  s.bind(e.tool_version), s.bind(e.date_created), s.bind(e.vehicle), s.bind(e.station), s.bind(e.license);
  s.bind(e.institution), s.bind(e.start_s), s.bind(e.end_s), s.bind(e.lat_deg), s.bind(e.lon_deg);
  s.bind(e.bottom_msl_m), s.bind(e.top_msl_m), s.bind(e.surface_msl_m), s.bind(e.bin_m);
  whole(e.bins), whole(e.good), whole(e.doubtful), whole(e.bad);
  s.bind(e.speed_min_m_s), s.bind(e.speed_mean_m_s), s.bind(e.speed_max_m_s);
  whole(e.quality), whole(e.superseded);
}

template <class Statement>
ArchiveEntry entry_of(Statement& s) {
  ArchiveEntry e;
  s.rewind();
  e.name = s.text(), e.folder = s.text(), s.text(), e.flight_id = s.text(), e.version = static_cast<int>(s.whole());
  e.input_file = s.text(), e.input_sha256 = s.text(), e.input_flight = static_cast<int>(s.whole());
  e.sha256 = s.text(), e.bytes = static_cast<std::uint64_t>(s.whole()), e.tool_version = s.text();
  e.date_created = s.text(), e.vehicle = s.text(), e.station = s.text(), e.license = s.text();
  e.institution = s.text(), e.start_s = s.number(), e.end_s = s.number(), e.lat_deg = s.number();
  e.lon_deg = s.number(), e.bottom_msl_m = s.number(), e.top_msl_m = s.number();
  const bool no_surface = s.is_null();
  const double surface = s.number();
  if (!no_surface) e.surface_msl_m = surface;
  e.bin_m = s.number(), e.bins = static_cast<int>(s.whole()), e.good = static_cast<int>(s.whole());
  e.doubtful = static_cast<int>(s.whole()), e.bad = static_cast<int>(s.whole());
  e.speed_min_m_s = s.number(), e.speed_mean_m_s = s.number(), e.speed_max_m_s = s.number();
  e.quality = static_cast<ArchiveQuality>(std::clamp<std::int64_t>(s.whole(), 0, 2)), e.superseded = s.whole() != 0;
  return e;
}

}  // namespace

tl::unexpected<ingest::Problem> ArchiveIndex::problem() const {
  const int code = sqlite3_errcode(db_.get()) & 0xff;
  const ingest::Where where{file_.string(), {}, {}, {}};
  const std::string says = sqlite3_errmsg(db_.get());
  if (code == SQLITE_NOTADB || code == SQLITE_CORRUPT || code == SQLITE_ERROR || code == SQLITE_SCHEMA)
    return fail(Kind::damaged, "the index of this archive is damaged: " + says, where,
                "`quadsonde archive rebuild` makes it again from the files");
  return fail(Kind::write_failed, "the index of this archive cannot be used: " + says, where,
              "check that the archive is writable and has room; what was added before is safe");
}

Result<void> ArchiveIndex::run(const char* sql) {
  if (sqlite3_exec(db_.get(), sql, nullptr, nullptr, nullptr) != SQLITE_OK) return problem();
  return {};
}

Result<ArchiveIndex> ArchiveIndex::open(const std::filesystem::path& file, Mode mode) {
  const int flags = mode == Mode::read ? SQLITE_OPEN_READONLY
                                       : SQLITE_OPEN_READWRITE | (mode == Mode::create ? SQLITE_OPEN_CREATE : 0);
  const auto opened = [&](const std::string& name, int how) {
    sqlite3* raw = nullptr;
    sqlite3_open_v2(name.c_str(), &raw, how, nullptr);
    ArchiveIndex index(std::unique_ptr<sqlite3, Closer>(raw), file);
    sqlite3_busy_timeout(raw, 30000);
    sqlite3_extended_result_codes(raw, 0);
    return index;
  };
  auto index = opened(file.string(), flags);
  if (mode == Mode::create) {
    const auto head = fmt::format("PRAGMA application_id={}; PRAGMA user_version={};", application, schema_version);
    for (const auto* sql : {"PRAGMA journal_mode=DELETE;", "PRAGMA synchronous=FULL;", head.c_str(), tables})
      if (auto done = index.run(sql); !done) return fail(done.error());
    return index;
  }
  const auto pragma = [](ArchiveIndex& of, const char* sql) -> std::int64_t {
    Statement s(of.db_.get(), sql);
    return s.step() == SQLITE_ROW ? s.whole() : -1;
  };
  auto id = pragma(index, "PRAGMA application_id");
  const int said = sqlite3_errcode(index.db_.get()) & 0xff;
  std::error_code no_log;
  const auto log = std::filesystem::file_size(file.string() + "-wal", no_log);
  // What stands in a log that cannot be read yet must not be left out.
  const bool complete = no_log || log == 0;
  if (id < 0 && mode == Mode::read && complete && (said == SQLITE_CANTOPEN || said == SQLITE_READONLY)) {
    // On a medium that cannot be written WAL has no place for its shared memory; nobody changes the file there.
    std::string uri = "file:";
    for (const char c : std::filesystem::absolute(file).string())
      uri += (c == '?' || c == '#' || c == '%') ? fmt::format("%{:02X}", static_cast<unsigned char>(c))
                                                : std::string(1, c);
    index = opened(uri + "?immutable=1", flags | SQLITE_OPEN_URI);
    id = pragma(index, "PRAGMA application_id");
  }
  if (id < 0) return index.problem();
  if (id != application || pragma(index, "PRAGMA user_version") != schema_version)
    return fail(Kind::damaged, "this is not the index of an archive", {file.string(), {}, {}, {}},
                "`quadsonde archive rebuild` makes it again from the files");
  if (auto done = index.run("PRAGMA synchronous=FULL;"); !done) return fail(done.error());
  return index;
}

Result<void> ArchiveIndex::begin() { return run("BEGIN IMMEDIATE"); }
Result<void> ArchiveIndex::commit() { return run("COMMIT"); }
void ArchiveIndex::rollback() { sqlite3_exec(db_.get(), "ROLLBACK", nullptr, nullptr, nullptr); }
Result<void> ArchiveIndex::finish_creation() { return run("PRAGMA journal_mode=WAL;"); }

Result<void> ArchiveIndex::put(const ArchiveEntry& entry) {
  static const std::string sql = [] {
    std::string marks = "?";
    for (int i = 1; i < column_count; ++i) marks += ", ?";
    return fmt::format("INSERT OR REPLACE INTO profile ({}) VALUES ({})", columns, marks);
  }();
  Statement s(db_.get(), sql);
  if (!s.ready()) return problem();
  bind_entry(s, entry);
  if (s.step() != SQLITE_DONE) return problem();
  return {};
}

Result<void> ArchiveIndex::remove(const std::string& name) {
  Statement s(db_.get(), "DELETE FROM profile WHERE name = ?");
  if (!s.ready()) return problem();
  s.bind(name);
  if (s.step() != SQLITE_DONE) return problem();
  return {};
}

Result<void> ArchiveIndex::mark(const std::string& name, bool superseded) {
  Statement s(db_.get(), "UPDATE profile SET superseded = ? WHERE name = ?");
  if (!s.ready()) return problem();
  s.bind(std::int64_t{superseded});
  s.bind(name);
  if (s.step() != SQLITE_DONE) return problem();
  return {};
}

Result<void> ArchiveIndex::each(const IndexCondition& condition, const std::function<bool(ArchiveEntry&&)>& take) {
  const auto chosen =
      condition.by_numbers
          ? fmt::format("rowid IN (SELECT rowid FROM profile INDEXED BY by_numbers WHERE {})", condition.sql)
          : condition.sql;
  Statement s(db_.get(), fmt::format("SELECT {} FROM profile WHERE {} ORDER BY start_s, name", columns, chosen));
  if (!s.ready()) return problem();
  for (const auto& value : condition.values) s.bind(value);
  int code = s.step();
  for (; code == SQLITE_ROW; code = s.step())
    if (!take(entry_of(s))) return {};
  if (code != SQLITE_DONE) return problem();
  return {};
}

Result<std::vector<ArchiveEntry>> ArchiveIndex::select(const IndexCondition& condition) {
  std::vector<ArchiveEntry> entries;
  auto done = each(condition, [&](ArchiveEntry&& entry) {
    entries.push_back(std::move(entry));
    return true;
  });
  if (!done) return fail(done.error());
  return entries;
}

Result<std::vector<ArchiveEntry>> ArchiveIndex::of_flight(const std::string& flight_id) {
  return select({"flight_id = ?", {flight_id}});
}

Result<std::vector<std::string>> ArchiveIndex::names_in(const std::string& catalogue_folder) {
  std::vector<std::string> names;
  Statement s(db_.get(), "SELECT name FROM profile WHERE leaf = ? ORDER BY name");
  if (!s.ready()) return problem();
  s.bind(catalogue_folder);
  int code = s.step();
  for (; code == SQLITE_ROW; code = s.step()) s.rewind(), names.push_back(s.text());
  if (code != SQLITE_DONE) return problem();
  return names;
}

Result<std::vector<std::string>> ArchiveIndex::folders_in(const std::string& folder) {
  // From name to name through the index instead of over every row: the folder behind X/ begins at "X0", as 0 follows /.
  std::vector<std::string> names;
  const auto head = folder + "/";
  std::string from = head;
  while (true) {
    Statement s(db_.get(), "SELECT leaf FROM profile WHERE leaf >= ? AND leaf < ? ORDER BY leaf LIMIT 1");
    if (!s.ready()) return problem();
    s.bind(from);
    s.bind(folder + "0");
    const int code = s.step();
    if (code == SQLITE_DONE) return names;
    if (code != SQLITE_ROW) return problem();
    s.rewind();
    const auto rest = s.text().substr(head.size());
    names.push_back(rest.substr(0, rest.find('/')));
    from = head + names.back() + "0";
    // What begins with this name and a character between / and 0 there is none: names are made of letters, digits ._-
    if (rest.find('/') == std::string::npos) from = head + names.back() + std::string(1, '\1');
  }
}

Result<ArchiveExtent> ArchiveIndex::extent() {
  ArchiveExtent e;
  // Each its own lookup at one end of an index.
  Statement s(db_.get(),
              "SELECT (SELECT count(*) FROM (SELECT 1 FROM profile LIMIT 1)), (SELECT min(lon_deg) FROM profile), "
              "(SELECT min(lat_deg) FROM profile), (SELECT max(lon_deg) FROM profile), (SELECT max(lat_deg) FROM "
              "profile), (SELECT min(start_s) FROM profile), (SELECT max(end_s) FROM profile)");
  if (s.step() != SQLITE_ROW) return problem();
  s.rewind();
  e.any = s.whole() > 0;
  e.west = s.number(), e.south = s.number(), e.east = s.number(), e.north = s.number();
  e.start_s = s.number(), e.end_s = s.number();
  return e;
}

Result<std::int64_t> ArchiveIndex::count() {
  Statement s(db_.get(), "SELECT count(*) FROM profile");
  if (s.step() != SQLITE_ROW) return problem();
  return s.whole();
}

Result<std::string> ArchiveIndex::fault() {
  Statement s(db_.get(), "PRAGMA quick_check(1)");
  if (s.step() != SQLITE_ROW) return problem();
  const auto says = s.text();
  return says == "ok" ? std::string() : says;
}

bool same_row(const ArchiveEntry& a, const ArchiveEntry& b) {
  const auto all = [](const ArchiveEntry& e) {
    return std::tie(e.name, e.folder, e.flight_id, e.version, e.input_file, e.input_sha256, e.input_flight, e.sha256,
                    e.bytes, e.tool_version, e.date_created, e.vehicle, e.station, e.license, e.institution, e.start_s,
                    e.end_s, e.lat_deg, e.lon_deg, e.bottom_msl_m, e.top_msl_m, e.surface_msl_m, e.bin_m, e.bins,
                    e.good, e.doubtful, e.bad, e.speed_min_m_s, e.speed_mean_m_s, e.speed_max_m_s, e.quality,
                    e.superseded);
  };
  return all(a) == all(b);
}

}  // namespace quadsonde::product
