#pragma once
// A file against the conventions that it claims: CF, ACDD and the WMO UAS campaign's netCDF, BUFR, MCAP.
#include <filesystem>
#include <string>
#include <vector>

#include "export/validate/findings.h"
#include "ingest/flight/bytes.h"
#include "ingest/flight/problem.h"

namespace quadsonde::product {

struct Validation {
  std::string file;               ///< as it was given
  std::string kind;               ///< "netCDF-4", "BUFR", "MCAP"
  std::string conventions;        ///< what it was held against: "CF-1.8, ACDD-1.3"
  std::vector<Finding> findings;  ///< errors first, then warnings, then notes
  std::size_t left_out = 0;       ///< findings of rules that are broken so often that nobody would read them all
  std::size_t count(Severity severity) const;
  /// No errors; warnings and notes are allowed.
  bool conformant() const { return count(Severity::error) == 0; }
};

/// Told by its bytes. What cannot be opened at all is a finding, too.
/// @param name  of the file, for the campaign's rules about it; folders in it are passed over
/// Fails with Kind::unsupported for bytes of another kind, with Kind::no_answer where there is no process to decode in.
ingest::Result<Validation> validate(ingest::Bytes bytes, const std::string& name);
/// The same; Kind::unreadable where the file cannot be read.
ingest::Result<Validation> validate_file(const std::filesystem::path& path);

/// For a terminal of 80 columns: findings by severity, each with its rule, place, source and remedy; a verdict at the
/// end.
std::string validation_text(const Validation& validation);
/// {"schema": "quadsonde.validation/1", "file", "kind", "conventions", "conformant", "findings": [...]}
std::string validation_json(const Validation& validation);

}  // namespace quadsonde::product
