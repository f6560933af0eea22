#include "export/report/section_answer.h"

#include <fmt/format.h>

#include <algorithm>

#include "export/csv/numbers.h"
#include "export/report/text_answer.h"

namespace quadsonde::product {
namespace {

using profiles::Bin;
using profiles::Section;

constexpr std::size_t side_by_side = 6;

std::string trimmed(std::string line) {
  line.erase(line.find_last_not_of(' ') + 1);
  return line;
}

std::string cell(const Bin& bin) {
  const auto* wind = std::get_if<estimator::WindEstimate>(&bin.wind);
  if (!wind) return "    -   - ";
  const auto report = estimator::to_report(*wind);
  const char mark = bin.quality == estimator::Quality::good       ? ' '
                    : bin.quality == estimator::Quality::doubtful ? '?'
                                                                  : '!';
  return fmt::format("{:5.1f} {:>3}{}", report.speed_m_s,
                     report.from_deg ? fmt::format("{:.0f}", *report.from_deg) : "-", mark);
}

bool has_wind(const Section& section, std::size_t bin) {
  return std::any_of(section.columns.begin(), section.columns.end(), [&](const auto& column) {
    return std::holds_alternative<estimator::WindEstimate>(column.leg.bins[bin].wind);
  });
}

/// Columns first to last, highest bin first; rows without any wind at the ends are left out by the grid already.
std::string block(const Section& section, std::size_t first, std::size_t last) {
  auto line = fmt::format("{:<12}", "above");
  auto second = fmt::format("{:<12}", section.datum == profiles::Datum::agl ? "take-off, m" : "sea, m");
  for (auto i = first; i < last; ++i) {
    const auto& column = section.columns[i];
    const auto middle = ingest::UtcTime{column.from.ns / 2 + column.to.ns / 2};
    line += fmt::format(" {:>9} ", utc_text(middle).substr(11, 8));
    second += fmt::format(" {:>9} ", profiles::name(column.leg.name));
  }
  auto text = trimmed(line) + "\n" + trimmed(second) + "\n";
  for (std::size_t b = section.columns.front().leg.bins.size(); b-- > 0;) {
    const auto& edges = section.columns.front().leg.bins[b];
    auto row = fmt::format("{:<12}", fmt::format("{:>5.0f}-{:<5.0f}", edges.bottom, edges.top));
    for (auto i = first; i < last; ++i) row += " " + cell(section.columns[i].leg.bins[b]);
    if (has_wind(section, b)) text += trimmed(row) + "\n";
  }
  return text;
}

}  // namespace

std::string section_answer(const FlightTitle& title, const Section& section, const ingest::Vehicle& vehicle) {
  auto text = wrapped(title_text(title)) + "\n" + wrapped(when_and_where(title)) + "\n\n";
  text += wrapped(
              "Wind over time and height: speed (m/s) and direction it comes from (deg) of each leg, by the UTC of "
              "its middle; ? doubtful, ! bad, - not measured.") +
          "\n\n";
  for (std::size_t first = 0; first < section.columns.size(); first += side_by_side)
    text += block(section, first, std::min(first + side_by_side, section.columns.size())) + "\n";
  return text + wrapped(vehicle_sentence(vehicle)) + "\n";
}

}  // namespace quadsonde::product
