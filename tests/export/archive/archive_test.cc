#include "export/archive/archive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "export/archive/catalogue.h"
#include "tests/export/archive/made_up_netcdf.h"
#include "tests/export/cf_netcdf/run_python.h"
#include "tests/support/data.h"

namespace quadsonde::product {
namespace {

namespace fs = std::filesystem;
using support::MadeUp;
using support::TemporaryFolder;
using testing::HasSubstr;

/// Syncing to a disk costs minutes, and what it does is not seen here.
const bool in_memory = fs::is_directory("/dev/shm") && ::setenv("TMPDIR", "/dev/shm", 0) == 0;

Archive opened(const fs::path& root) {
  auto archive = Archive::open_or_create(root);
  if (!archive) throw std::runtime_error(ingest::to_string(archive.error()));
  return std::move(*archive);
}

Added add(Archive& archive, const ArchiveCandidate& candidate) {
  const auto added = archive.add({candidate});
  if (!added) throw std::runtime_error(ingest::to_string(added.error()));
  return added->front();
}
Added add(Archive& archive, const MadeUp& made) { return add(archive, support::made_up_candidate(made)); }

std::vector<ArchiveEntry> all_of(Archive& archive, const ArchiveQuery& query = {}) {
  const auto entries = archive.query(query);
  EXPECT_TRUE(entries) << (entries ? "" : ingest::to_string(entries.error()));
  return entries ? *entries : std::vector<ArchiveEntry>{};
}

std::vector<std::string> findings(Archive& archive) {
  std::vector<std::string> all;
  const auto report = archive.verify();
  EXPECT_TRUE(report);
  for (const auto& f : report->findings) all.push_back(std::string(name(f.kind)) + " " + f.path);
  return all;
}

std::string text_of(const fs::path& path) {
  const auto bytes = support::read_bytes(path);
  return {bytes.begin(), bytes.end()};
}
void write(const fs::path& path, const std::string& text) { std::ofstream(path, std::ios::binary) << text; }

TEST(Archive, KeepsAProfileUnderAStableNameAndGivesTheSameBytesBack) {
  const TemporaryFolder a, b;
  auto first = opened(a / "archive"), second = opened(b / "other");
  const auto entry = add(first, MadeUp{3, 10, "Namitambo"}).entry;
  add(second, MadeUp{1}), add(second, MadeUp{3, 10, "Namitambo"});
  EXPECT_THAT(entry.folder,
              testing::MatchesRegex("profiles/2025/06/Namitambo/20250615T[0-9]{6}Z_quad-07_[0-9a-f]{12}-[0-9a-f]{8}"));
  EXPECT_EQ(*first.read(entry), support::made_up_netcdf({3, 10, "Namitambo"}));
  EXPECT_TRUE(fs::exists(b.path() / "other" / entry.file())) << "the name depends on the profile alone";
  EXPECT_EQ(text_of(a.path() / "archive" / entry.manifest()), text_of(b.path() / "other" / entry.manifest()));
}

TEST(Archive, TheSameFlightTwiceIsOneEntry) {
  const TemporaryFolder folder;
  auto archive = opened(folder / "a");
  EXPECT_EQ(add(archive, MadeUp{1}).outcome, AddOutcome::added);
  EXPECT_EQ(add(archive, MadeUp{1}).outcome, AddOutcome::already_there);
  const auto twice = archive.add({support::made_up_candidate({2}), support::made_up_candidate({2})});
  ASSERT_TRUE(twice);
  EXPECT_EQ((*twice)[1].outcome, AddOutcome::already_there);
  EXPECT_EQ(all_of(archive).size(), 2u);
  EXPECT_THAT(findings(archive), testing::IsEmpty());
}

TEST(Archive, OtherSettingsSupersedeAndTheOldVersionStaysMarked) {
  const TemporaryFolder folder;
  auto archive = opened(folder / "a");
  const auto old = add(archive, MadeUp{1, 10}).entry;
  const auto added = add(archive, MadeUp{1, 20});
  EXPECT_EQ(added.outcome, AddOutcome::superseding);
  EXPECT_EQ(added.other, old.name);
  ASSERT_EQ(all_of(archive).size(), 1u);
  EXPECT_EQ(all_of(archive)[0].name, added.entry.name);
  ArchiveQuery every;
  every.all_versions = true;
  EXPECT_EQ(all_of(archive, every).size(), 2u);
  const auto item = Json::parse(text_of(folder.path() / "a" / old.item()));
  EXPECT_EQ(item["properties"]["deprecated"], true);
  EXPECT_THAT(item["links"].dump(), HasSubstr("successor-version"));
  EXPECT_TRUE(archive.read(old));
  EXPECT_THAT(findings(archive), testing::IsEmpty());
}

TEST(Archive, AnOlderQuadsondeNeverSupersedesANewerOne) {
  const TemporaryFolder folder;
  auto archive = opened(folder / "a");
  auto newer = support::made_up_candidate({1, 10}), older = support::made_up_candidate({1, 20});
  newer.entry.tool_version = "0.10.0", older.entry.tool_version = "0.9.3";
  add(archive, newer);
  const auto added = add(archive, older);
  EXPECT_EQ(added.outcome, AddOutcome::outdated);
  EXPECT_TRUE(added.entry.superseded);
  EXPECT_EQ(all_of(archive)[0].name, newer.entry.name);
}

TEST(Archive, IsAValidStacCatalogueWhoseLinksAllLeadSomewhere) {
  const TemporaryFolder folder;
  auto archive = opened(folder / "a");
  add(archive, MadeUp{1, 10, "0-454-2-AWSNAMITAMBO"}), add(archive, MadeUp{1, 20, "0-454-2-AWSNAMITAMBO"});
  add(archive, MadeUp{2, 10, "", "<&>\"';$(rm -rf ~)`../../etc/passwd\n"}), add(archive, MadeUp{300});
  EXPECT_EQ(support::python(QUADSONDE_STAC_CHECK, support::quoted(folder / "a")), "");
}

TEST(Archive, TheStacCheckBites) {
  const TemporaryFolder folder;
  auto archive = opened(folder / "a");
  const auto entry = add(archive, MadeUp{1}).entry;
  const auto path = folder.path() / "a" / entry.item();
  const auto sound = text_of(path);
  for (const auto& [key, wrong] :
       std::vector<std::pair<std::string, std::string>>{{"\"1.0.0\"", "\"0.9.0\""},
                                                        {"\"Feature\"", "\"Thing\""},
                                                        {"./manifest.json", "./nowhere.json"},
                                                        {"\"datetime\"", "\"datetiem\""},
                                                        {"\"1220", "\"1221"}}) {
    auto text = sound;
    text.replace(text.find(key), key.size(), wrong);
    write(path, text);
    EXPECT_NE(support::python(QUADSONDE_STAC_CHECK, support::quoted(folder / "a")), "") << key;
  }
}

TEST(Archive, VerifyFindsWhateverIsMissingChangedTruncatedOrForeign) {
  const TemporaryFolder folder;
  const auto root = folder / "a";
  auto archive = opened(root);
  std::vector<ArchiveEntry> e;
  for (int i = 0; i < 6; ++i) e.push_back(add(archive, support::candidates(6)[static_cast<std::size_t>(i)]).entry);
  ASSERT_THAT(findings(archive), testing::IsEmpty());

  fs::remove(root / e[0].file());
  auto bytes = text_of(root / e[1].file());
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  write(root / e[1].file(), bytes);
  fs::resize_file(root / e[2].file(), 1000);
  fs::remove_all(root / e[3].folder);
  auto manifest = text_of(root / e[4].manifest());
  manifest.replace(manifest.find("flight-4.ulg"), 12, "flight-9.ulg");
  write(root / e[4].manifest(), manifest);
  write(root / "notes.txt", "hello");
  write(root / "profiles/2025/06/no-station/stray.nc", "x");
  write(root / e[5].folder / "x.txt", "x");
  fs::create_symlink("/etc/passwd", root / "profiles/2025/link");
  write(root / "collection.json", "{}");

  const auto found = findings(archive);
  for (const auto& expected :
       {"missing " + e[0].file(), "changed " + e[1].file(), "truncated " + e[2].file(), "missing " + e[3].folder,
        "changed " + e[4].manifest(), std::string("foreign notes.txt"),
        std::string("foreign profiles/2025/06/no-station/stray.nc"), "foreign " + e[5].folder + "/x.txt",
        std::string("foreign profiles/2025/link"), std::string("changed collection.json")})
    EXPECT_THAT(found, testing::Contains(expected));
}

TEST(Archive, VerifyFindsAMissingMonthEvenWithoutItsIndex) {
  const TemporaryFolder folder;
  const auto root = folder / "a";
  auto archive = opened(root);
  add(archive, MadeUp{1}), add(archive, MadeUp{600});
  fs::remove(root / "index.sqlite"), fs::remove_all(root / "profiles/2025/06");
  EXPECT_THAT(findings(archive), testing::IsSupersetOf({"missing index.sqlite", "missing profiles/2025/06"}));
}

TEST(Archive, RebuildMakesIndexAndCatalogueFromTheFilesAlone) {
  const TemporaryFolder folder;
  const auto root = folder / "a";
  auto archive = opened(root);
  add(archive, MadeUp{1, 10}), add(archive, MadeUp{1, 20}), add(archive, MadeUp{2, 10, "Namitambo"});
  const auto lone = add(archive, MadeUp{3}).entry;
  ArchiveQuery every;
  every.all_versions = true;
  const auto before = all_of(archive, every);
  std::map<std::string, std::string> texts;
  for (const auto& file : fs::recursive_directory_iterator(root))
    if (file.path().extension() == ".json") texts[file.path().string()] = text_of(file.path());

  for (const auto& [path, text] : texts)
    if (!path.ends_with("manifest.json") && !path.ends_with("quadsonde-archive.json")) fs::remove(path);
  fs::remove(root / lone.manifest());
  for (const auto* ending : {"", "-wal", "-shm"}) fs::remove(root / (std::string("index.sqlite") + ending));
  const auto report = Archive::rebuild(root);
  ASSERT_TRUE(report) << ingest::to_string(report.error());
  EXPECT_EQ(report->profiles, 4u);
  EXPECT_EQ(report->remade_manifests, 1u);
  EXPECT_TRUE(report->findings.empty());

  const auto after = all_of(archive, every);
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < after.size(); ++i) EXPECT_TRUE(same_row(after[i], before[i])) << after[i].name;
  for (const auto& [path, text] : texts) EXPECT_EQ(text_of(path), text) << path;
  EXPECT_THAT(findings(archive), testing::IsEmpty());
}

TEST(Archive, ADeletedIndexComesBackByItself) {
  const TemporaryFolder folder;
  {
    auto archive = opened(folder / "a");
    add(archive, MadeUp{1}), add(archive, MadeUp{2});
  }
  fs::remove(folder / "a/index.sqlite");
  auto again = Archive::open(folder / "a");
  ASSERT_TRUE(again);
  EXPECT_EQ(all_of(*again).size(), 2u);
  fs::remove(folder / "a/index.sqlite");
  EXPECT_EQ(add(*again, MadeUp{3}).outcome, AddOutcome::added);
  EXPECT_EQ(all_of(*again).size(), 3u);
}

TEST(Archive, ADamagedIndexIsToldWithTheWayOut) {
  const TemporaryFolder folder;
  auto archive = opened(folder / "a");
  add(archive, MadeUp{1});
  write(folder / "a/index.sqlite", "this is no database, whatever its name may say about it");
  for (const auto* ending : {"-wal", "-shm"}) fs::remove(folder / (std::string("a/index.sqlite") + ending));
  const auto answer = archive.query({});
  ASSERT_FALSE(answer);
  EXPECT_THAT(answer.error().hint, HasSubstr("rebuild"));
  EXPECT_FALSE(archive.add({support::made_up_candidate({2})}));
  ASSERT_TRUE(Archive::rebuild(folder / "a"));
  EXPECT_EQ(all_of(archive).size(), 1u);
}

TEST(Archive, AddingADamagedProfileAgainRestoresIt) {
  const TemporaryFolder folder;
  auto archive = opened(folder / "a");
  const auto entry = add(archive, MadeUp{1}).entry;
  fs::resize_file(folder.path() / "a" / entry.file(), 100);
  EXPECT_FALSE(archive.read(entry));
  EXPECT_EQ(add(archive, MadeUp{1}).outcome, AddOutcome::restored);
  EXPECT_TRUE(archive.read(entry));
  fs::remove_all(folder.path() / "a" / entry.folder);
  EXPECT_EQ(add(archive, MadeUp{1}).outcome, AddOutcome::restored);
  EXPECT_THAT(findings(archive), testing::IsEmpty());
}

TEST(Archive, NamesCannotLeaveTheirFolderOrTheirQuotes) {
  const TemporaryFolder folder;
  auto archive = opened(folder / "a");
  const std::vector<std::string> names{"../../../escaped",
                                       "'; DROP TABLE profile; --",
                                       "a/b\\c",
                                       "$(touch gone)",
                                       "<b>&amp;</b>",
                                       "..",
                                       "-rf",
                                       std::string("nul\x01l"),
                                       "\xff\xfe",
                                       "caf\xc3\xa9 \xe2\x98\x83",
                                       std::string(200, 'x'),
                                       "%s%n{}"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto entry = add(archive, MadeUp{static_cast<int>(i), 10, names[i], names[i]}).entry;
    EXPECT_THAT(entry.folder, testing::MatchesRegex("profiles/2025/06/[A-Za-z0-9][A-Za-z0-9._-]*/[A-Za-z0-9._-]+"));
    EXPECT_LE(entry.name.size(), 90u);
    ArchiveQuery query;
    query.station_id = entry.station;
    EXPECT_THAT(all_of(archive, query), testing::Contains(testing::Field(&ArchiveEntry::name, entry.name)));
  }
  EXPECT_EQ(all_of(archive).size(), names.size());
  EXPECT_THAT(findings(archive), testing::IsEmpty());
  std::vector<std::string> beside;
  for (const auto& file : fs::directory_iterator(folder.path())) beside.push_back(file.path().filename().string());
  EXPECT_THAT(beside, testing::ElementsAre("a"));
}

TEST(Archive, RefusesWhatIsNoArchive) {
  const TemporaryFolder folder;
  write(folder / "file", "x");
  fs::create_directory(folder / "full");
  write(folder / "full/x", "x");
  for (const auto* target : {"file", "full"}) {
    const auto archive = Archive::open_or_create(folder / target);
    ASSERT_FALSE(archive) << target;
    EXPECT_EQ(archive.error().kind, ingest::Kind::usage) << target;
  }
  EXPECT_FALSE(Archive::open(folder / "nowhere"));
  EXPECT_FALSE(fs::exists(folder / "nowhere"));
  fs::create_directory(folder / "empty");
  EXPECT_TRUE(Archive::open_or_create(folder / "empty"));
}

TEST(Archive, RefusesForeignBytesByWhatTheyAre) {
  const std::string hdf5("\x89HDF\r\n\x1a\n");
  const auto profile = support::made_up_netcdf({1});
  auto no_wind = profile;
  EXPECT_EQ(archive_candidate("", "x").error().kind, ingest::Kind::unsupported);
  EXPECT_EQ(archive_candidate("CDF\1 and more", "x").error().kind, ingest::Kind::unsupported);
  EXPECT_EQ(archive_candidate("a text", "x").error().kind, ingest::Kind::unsupported);
  EXPECT_FALSE(archive_candidate(hdf5 + std::string(5000, '\0'), "x"));
  const auto series = wind_netcdf(support::made_up_series(), support::made_up_source());
  ASSERT_TRUE(series);
  const auto refused = archive_candidate(*series, "wind.nc");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().what, HasSubstr("featureType"));
  for (const std::size_t size : {100u, 1000u, 5000u, 20000u})
    EXPECT_FALSE(archive_candidate(profile.substr(0, size), "cut"));
}

TEST(Archive, NoFlippedByteOfAProfileCrashesOrHangsTheReader) {
  const auto profile = support::made_up_netcdf({1});
  unsigned seed = 7;
  for (int i = 0; i < 60; ++i) {
    auto bytes = profile;
    for (int k = 0; k < 1 + i % 8; ++k) {
      seed = seed * 1664525u + 1013904223u;
      bytes[seed % (i % 2 ? bytes.size() : 2000)] = static_cast<char>(seed >> 24);
    }
    const auto candidate = archive_candidate(bytes, "flipped");
    if (candidate) {
      EXPECT_NE(candidate->entry.sha256, support::made_up_candidate({1}).entry.sha256);
    }
  }
}

/// Root may write everywhere: somebody else looks.
class AsNobody {
 public:
  AsNobody() : was_root_(::geteuid() == 0 && ::seteuid(65534) == 0) {}
  ~AsNobody() {
    if (was_root_ && ::seteuid(0) != 0) std::abort();
  }

 private:
  bool was_root_;
};

TEST(Archive, ReadsOnAMediumThatNobodyMayWrite) {
  const TemporaryFolder folder;
  const auto root = folder / "a";
  {
    auto archive = opened(root);
    add(archive, MadeUp{1});
  }
  const auto candidate = support::made_up_candidate({2});
  const auto everybody_reads = fs::perms::owner_read | fs::perms::group_read | fs::perms::others_read;
  const auto everybody_enters =
      everybody_reads | fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec;
  fs::permissions(folder.path(), everybody_enters);
  fs::permissions(root, everybody_enters);
  for (const auto& file : fs::recursive_directory_iterator(root))
    fs::permissions(file, file.is_directory() ? everybody_enters : everybody_reads);
  {
    const AsNobody nobody;
    auto archive = Archive::open(root);
    ASSERT_TRUE(archive);
    EXPECT_EQ(all_of(*archive).size(), 1u);
    EXPECT_THAT(findings(*archive), testing::IsEmpty());
    const auto refused = archive->add({candidate});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, ingest::Kind::write_failed);
  }
  fs::permissions(folder.path(), fs::perms::owner_all);
  fs::permissions(root, fs::perms::owner_all);
  for (const auto& file : fs::recursive_directory_iterator(root))
    if (file.is_directory()) fs::permissions(file, fs::perms::owner_all);
}

}  // namespace
}  // namespace quadsonde::product
