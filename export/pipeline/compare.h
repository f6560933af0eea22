#pragma once
// An answer beside winds of others: tables of the true wind, METAR, tables of stations.
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "estimator/smoother/wind_series.h"
#include "export/report/profile_picture.h"
#include "export/report/series_picture.h"
#include "ingest/flight/truth.h"
#include "profiles/compare/against_reports.h"
#include "profiles/compare/against_truth.h"
#include "profiles/profile.h"

namespace quadsonde::product {

struct ReferenceSettings {
  profiles::CompareSettings match;
  std::string reference_at;
};
template <class Visitor>
void describe(ReferenceSettings& s, Visitor&& visit) {
  visit("reference_at", s.reference_at, "LAT,LON,HEIGHT_M",
        "Where a reference that names no place was measured: degrees, and metres above the ground there.");
  describe(s.match, visit);
}

/// What --reference-at says.
struct ReferencePlace {
  ingest::GeoPoint place;
  ingest::GroundHeight height;
};
/// Empty where nothing was said; Kind::usage for anything but three numbers of a place on Earth.
ingest::Result<std::optional<ReferencePlace>> reference_place(const std::string& text);

/// A file of winds that somebody else knows. Reports are read when a flight tells their month.
struct ReferenceFile {
  std::filesystem::path path;
  std::variant<ingest::Truth, std::string> content;  ///< a truth table, or the text of reports
};
/// A file's bytes, up to 256 MB. Kind::unreadable, Kind::limit.
ingest::Result<std::string> read_whole(const std::filesystem::path& path);
/// Bytes of a file as the reference that they are, or why they are none: what they are instead, and what to do with it.
ingest::Result<ReferenceFile> reference_of(const std::filesystem::path& path, std::string text);
/// By its contents. Kind::unreadable, Kind::limit, or as reference_of.
ingest::Result<ReferenceFile> read_reference_file(const std::filesystem::path& path);
ingest::Result<std::vector<ReferenceFile>> read_reference_files(const std::vector<std::filesystem::path>& paths);

/// What is compared; either may be missing, not both.
struct FlightWinds {
  const estimator::WindSeries* series = nullptr;
  const estimator::WindSeries* classic = nullptr;  ///< the published filter on the same flight
  const profiles::WindProfile* profile = nullptr;
};

struct ReferenceComparison {
  std::string file;                   ///< name without folders
  std::string kind;                   ///< "truth", "METAR", "table"
  std::vector<std::string> stations;  ///< as reports name them
  std::variant<profiles::TruthScores, profiles::ReportScores> scores;
  std::vector<ingest::Problem> problems;  ///< of its lines, and why nothing was scored

  const profiles::TruthScores* truth() const { return std::get_if<profiles::TruthScores>(&scores); }
  const profiles::ReportScores* reports() const { return std::get_if<profiles::ReportScores>(&scores); }
  /// Those that stand for the whole; n = 0 where nothing was scored.
  const profiles::Scores& whole() const;
};

struct Comparison {
  std::vector<ReferenceComparison> references;
  ReferenceSettings settings;
  // For pictures: the truth's mean in every bin, and over the time of the flight; reports as marks.
  std::vector<ReferenceLevel> levels;
  std::vector<ReferencePoint> along;
  std::vector<ReferenceMark> marks;

  std::vector<ingest::Problem> problems() const;
};

/// Against every reference by itself. One that cannot be scored tells why among its problems.
Comparison compare_with(const FlightWinds& ours, const std::vector<ReferenceFile>& references,
                        const ReferenceSettings& settings);

/// Sentences for people on one reference: what the errors are and whether the intervals hold.
std::vector<std::string> comparison_sentences(const ReferenceComparison& reference,
                                              const profiles::CompareSettings& settings);
/// One paragraph per reference, beginning with its name.
std::vector<std::string> comparison_sentences(const Comparison& comparison);
/// "Against FILE (KIND):", the reports beside ours, the sentences; for a terminal of 80 columns.
std::string comparison_text(const Comparison& comparison);
/// Object of schema quadsonde.compare/1, as text.
std::string comparison_json(const Comparison& comparison, const std::string& file, int flight);

}  // namespace quadsonde::product
