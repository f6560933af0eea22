#pragma once
// Profiles and winds that were written earlier, beside references: files in any order, told apart by their contents.
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "export/pipeline/compare.h"
#include "export/pipeline/control.h"
#include "export/report/words.h"

namespace quadsonde::product {

/// One wind or profile of ours beside all references.
struct ComparedFlight {
  FlightTitle title;  ///< what the file tells of it
  int flight = 1;
  std::optional<estimator::WindSeries> series;   ///< empty where the file holds a profile
  std::optional<profiles::WindProfile> profile;  ///< of the file, or made of its winds in bins of 10 m
  Comparison comparison;
};

struct CompareResult {
  std::vector<ComparedFlight> flights;
  std::vector<std::string> taken;         ///< "profile.csv: a profile", in the order given
  std::vector<ingest::Problem> failures;  ///< of files that could not be used
  /// A file could not be used, or a reference could not be scored or was damaged.
  bool with_doubts() const;
};

/// Every profile against every reference. Where files that could not be used leave no profile or no reference, there
/// are only failures. Fails with Kind::usage where all could be used and there is no profile or no reference.
ingest::Result<CompareResult> compare_files(const std::vector<std::filesystem::path>& files,
                                            const ReferenceSettings& settings, const Control& control = {});

/// For a terminal: what it is of, then comparison_text.
std::string compared_text(const ComparedFlight& flight);
/// The profile with what it was compared with.
std::string compared_svg(const ComparedFlight& flight);

}  // namespace quadsonde::product
