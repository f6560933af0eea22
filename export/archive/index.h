#pragma once
// The index of an archive: one SQLite table (WAL), made of the manifests and never more than they say.
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "export/archive/entry.h"
#include "export/archive/stac.h"

struct sqlite3;

namespace quadsonde::product {

/// A value for a ? of a condition. Text of users gets into SQL in no other way.
using IndexValue = std::variant<double, std::int64_t, std::string>;

struct IndexCondition {
  std::string sql = "1";  ///< over the columns of the table, with ? for values
  std::vector<IndexValue> values = {};
  bool by_numbers = false;  ///< only columns of the index by_numbers are in it
};

/// Entries out of the index lack their settings and vehicle's numbers: the manifest has them.
/// Everything fails with Kind::damaged when the file is no index of ours or damaged, Kind::write_failed when it cannot
/// be written (a full disk, no permission, locked for longer than 30 s).
class ArchiveIndex {
 public:
  enum class Mode { read, write, create };
  /// read: works on a read-only medium too. create: a new file, over an older one, not yet in WAL mode.
  static ingest::Result<ArchiveIndex> open(const std::filesystem::path& file, Mode mode);

  /// Between begin() and commit() all or nothing; a commit that returned is on the disk.
  ingest::Result<void> begin();
  ingest::Result<void> commit();
  void rollback();
  /// Into WAL mode, for readers beside a writer.
  ingest::Result<void> finish_creation();

  ingest::Result<void> put(const ArchiveEntry& entry);
  ingest::Result<void> remove(const std::string& name);
  ingest::Result<void> mark(const std::string& name, bool superseded);

  /// In the order of their starts.
  ingest::Result<std::vector<ArchiveEntry>> select(const IndexCondition& condition);
  /// One at a time, for many; `take` returns false to end it.
  ingest::Result<void> each(const IndexCondition& condition, const std::function<bool(ArchiveEntry&&)>& take);
  ingest::Result<std::vector<ArchiveEntry>> of_flight(const std::string& flight_id);
  ingest::Result<std::vector<std::string>> names_in(const std::string& catalogue_folder);
  /// Folders directly below one, that have entries.
  ingest::Result<std::vector<std::string>> folders_in(const std::string& folder);
  ingest::Result<ArchiveExtent> extent();
  ingest::Result<std::int64_t> count();
  /// What SQLite finds wrong with the file; empty when it is sound.
  ingest::Result<std::string> fault();

 private:
  struct Closer {
    void operator()(sqlite3* db) const;
  };
  class Statement;
  ArchiveIndex(std::unique_ptr<sqlite3, Closer> db, std::filesystem::path file)
      : db_(std::move(db)), file_(std::move(file)) {}
  ingest::Result<void> run(const char* sql);
  tl::unexpected<ingest::Problem> problem() const;

  std::unique_ptr<sqlite3, Closer> db_;
  std::filesystem::path file_;
};

/// Whether a row of the index says what the entry says, but for what rows do not hold.
bool same_row(const ArchiveEntry& a, const ArchiveEntry& b);

}  // namespace quadsonde::product
