#include "tests/replay/check_table.h"

#include <fmt/format.h>

#include <algorithm>

namespace quadsonde::replay {
namespace {

using product::InputSettings;

bool is_text_about_logs(const std::filesystem::path& file) {
  const auto name = file.filename().string();
  return file.extension() == ".md" || file.extension() == ".cff" || name.starts_with("LICENSE") ||
         name.starts_with("EXPECTED") || name.starts_with("SHA256");
}

std::string one_line(const ingest::Problem& problem) { return problem.what; }

void fill(CheckRow& row, const product::CheckAnswer& answer) {
  const auto& report = answer.report;
  row.verdict = report.verdict;
  row.chi2 = report.chi2_per_dof;
  row.chi2_restored = report.chi2_restored;
  row.reason = report.because;
  for (const auto& finding : report.findings)
    if (finding.decides && row.fault.empty()) row.fault = finding.id;
  row.exit_code = report.verdict == ingest::Verdict::inconsistent || row.flights > 1 ? 3 : 0;
}

}  // namespace

CheckRow check_file(const std::filesystem::path& file, const std::filesystem::path& shown_below,
                    const std::optional<std::filesystem::path>& columns) {
  CheckRow row;
  row.file = file.lexically_relative(shown_below).string();
  if (columns) row.file += " + " + columns->filename().string();
  row.exit_code = 1;
  InputSettings input;
  if (columns) input.columns = columns->string();
  const auto log = product::load_log(file, input);
  if (!log) {
    row.reason = one_line(log.error());
    return row;
  }
  row.format = log->content.format;
  row.flights = static_cast<int>(log->parts.size());
  std::vector<ingest::Problem> notes;
  const auto parts = product::choose_flights(*log, "", false, notes);
  const auto vehicle = product::choose_vehicle({}, file);
  if (!parts || !vehicle) {
    row.reason = one_line(parts ? vehicle.error() : parts.error());
    return row;
  }
  row.flight = parts->front().number;
  const auto answer = product::check(*log, parts->front(), *vehicle, {});
  if (answer)
    fill(row, *answer);
  else
    row.reason = one_line(answer.error());
  return row;
}

std::vector<CheckRow> check_folder(const std::filesystem::path& folder, const std::filesystem::path& shown_below,
                                   const std::vector<std::string>& leave_out) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const auto path = entry.path().string();
    const bool left = std::any_of(leave_out.begin(), leave_out.end(),
                                  [&](const std::string& part) { return path.find(part) != std::string::npos; });
    if (entry.is_regular_file() && !left && !is_text_about_logs(entry.path())) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<CheckRow> rows;
  for (const auto& file : files) rows.push_back(check_file(file, shown_below));
  return rows;
}

std::string markdown(const std::vector<CheckRow>& rows) {
  std::string text =
      "| file | format | flight | verdict | chi2 | undone | fault | exit | reason |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  for (const auto& r : rows) {
    const bool judged = r.verdict.has_value();
    text +=
        fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} | {} |\n", r.file, r.format,
                    judged ? fmt::format("{} of {}", r.flight, r.flights) : "",
                    judged ? ingest::name(*r.verdict) : "nothing to check", judged ? fmt::format("{:.2f}", r.chi2) : "",
                    judged ? fmt::format("{:.2f}", r.chi2_restored) : "", r.fault, r.exit_code, r.reason);
  }
  return text;
}

}  // namespace quadsonde::replay
