#include "export/csv/rows.h"
#include "export/csv/tables.h"

namespace quadsonde::product {
namespace {

void append_names(std::string& text, const Row& row) {
  for (std::size_t i = 0; i < row.size(); ++i) text.append(i ? "," : "").append(row[i].name);
  text += '\n';
}

// No field can hold a comma, a quote or a line end: numbers, times and words of fixed lists.
void append_row(std::string& text, const Row& row) {
  for (std::size_t i = 0; i < row.size(); ++i) text.append(i ? "," : "").append(row[i].text);
  text += '\n';
}

}  // namespace

std::string wind_csv(const estimator::WindSeries& series) {
  std::string text;
  append_names(text, wind_row({}, series.mode));
  for (const auto& point : series.points) append_row(text, wind_row(point, series.mode));
  return text;
}

std::string profile_csv(const profiles::WindProfile& profile) {
  std::string text;
  append_names(text, profile_row({}, profiles::LegName::all));
  for (const auto& leg : profile.legs)
    for (const auto& bin : leg.bins) append_row(text, profile_row(bin, leg.name));
  return text;
}

}  // namespace quadsonde::product
