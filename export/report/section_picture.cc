#include "export/report/section_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "export/csv/numbers.h"
#include "export/report/barb.h"
#include "export/report/plot.h"

namespace quadsonde::product {
namespace {

using estimator::Quality;
using profiles::Section;

constexpr double width = 900, height = 560, left = 68, right = 868, top = 92, bottom = 452;

// Dark to light along the speed in blue, green, yellow and red that differ in lightness too.
constexpr std::array<const char*, SpeedScale::classes> scale_colours{"#45337d", "#2f6f9f", "#1f9a8a", "#5fb04a",
                                                                     "#c2a51c", "#d9711d", "#a3211f"};

struct Cell {
  double seconds = 0;  ///< after the first column's start
  double low = 0, high = 0;
  double speed = 0;
  std::optional<double> from;
  Quality quality = Quality::good;
};

double seconds_after(ingest::UtcTime t, ingest::UtcTime start) { return static_cast<double>(t.ns - start.ns) * 1e-9; }

ingest::UtcTime start_of(const Section& section) {
  auto first = section.columns.front().from;
  for (const auto& column : section.columns) first = std::min(first, column.from);
  return first;
}
ingest::UtcTime end_of(const Section& section) {
  auto last = section.columns.front().to;
  for (const auto& column : section.columns) last = std::max(last, column.to);
  return last;
}

std::vector<Cell> cells_of(const profiles::SectionColumn& column, ingest::UtcTime start) {
  std::vector<Cell> cells;
  for (const auto& bin : column.leg.bins) {
    const auto* wind = std::get_if<estimator::WindEstimate>(&bin.wind);
    if (!wind) continue;
    const auto report = estimator::to_report(*wind);
    const auto middle = ingest::UtcTime{column.from.ns / 2 + column.to.ns / 2};
    cells.push_back({seconds_after(bin.utc.value_or(middle), start), bin.bottom, bin.top, report.speed_m_s,
                     report.from_deg, bin.quality});
  }
  return cells;
}

/// Steps of clock time that people read.
double clock_step(double seconds, int wanted) {
  for (const double step :
       {10.0, 20.0, 30.0, 60.0, 120.0, 300.0, 600.0, 900.0, 1800.0, 3600.0, 7200.0, 10800.0, 21600.0, 43200.0, 86400.0})
    if (step * wanted >= seconds) return step;
  return 86400.0 * std::ceil(seconds / wanted / 86400);
}

Axis time_axis(ingest::UtcTime start, double last) {
  const double step = clock_step(std::max(last, 30.0), 7);
  // Ticks on whole steps of the clock: the axis begins at or before the start.
  const double offset = std::fmod(static_cast<double>(start.ns / 1'000'000) * 1e-3, step);
  return {-offset, std::ceil((last + offset) / step) * step - offset, left, right, step};
}

Axis height_axis(const Section& section) {
  double low = 1e9, high = -1e9;
  for (const auto& bin : section.columns.front().leg.bins)
    low = std::min(low, bin.bottom), high = std::max(high, bin.top);
  if (low > 0 && low < 0.35 * high) low = 0;
  return round_axis(low, high, bottom, top, 8);
}

/// Half the width of a mark on paper: never into the next column's, at most 14.
double half_width(const Section& section, const Axis& time, ingest::UtcTime start) {
  double half = 14;
  std::vector<double> middles;
  for (const auto& column : section.columns)
    for (const auto& cell : cells_of(column, start)) middles.push_back(time.place(cell.seconds));
  for (std::size_t i = 1; i < section.columns.size(); ++i) {
    const auto mid = [&](const auto& c) {
      return time.place((seconds_after(c.from, start) + seconds_after(c.to, start)) / 2);
    };
    half = std::min(half, 0.5 * (mid(section.columns[i]) - mid(section.columns[i - 1])));
  }
  return std::max(1.5, half);
}

void draw_cells(Markup& svg, const Section& section, const Panel& panel, const SpeedScale& scale,
                ingest::UtcTime start) {
  const double half = half_width(section, panel.x, start);
  for (const auto& column : section.columns)
    for (const auto& cell : cells_of(column, start)) {
      const double x = panel.x.place(cell.seconds), y = panel.y.place(cell.high);
      svg.empty("rect", {{"x", x - half},
                         {"y", y},
                         {"width", 2 * half},
                         {"height", panel.y.place(cell.low) - y},
                         {"fill", scale.colour(cell.speed)},
                         {"fill-opacity", cell.quality == Quality::good ? 0.32 : 0.12}});
      if (cell.quality != Quality::bad) continue;
      const double middle = panel.y.place((cell.low + cell.high) / 2);
      svg.empty("path", {{"d", fmt::format("M{0} {2}L{1} {3}M{0} {3}L{1} {2}", coordinate(x - 4), coordinate(x + 4),
                                           coordinate(middle - 4), coordinate(middle + 4))},
                         {"stroke", scale.colour(cell.speed)},
                         {"stroke-width", 1.6}});
    }
}

/// Barbs where there is room for them: no closer than 26 across within 17 in height.
void draw_barbs(Markup& svg, const Section& section, const Panel& panel, const SpeedScale& scale, ingest::UtcTime start,
                bool southern) {
  std::vector<std::pair<double, double>> drawn;
  for (const auto& column : section.columns)
    for (const auto& cell : cells_of(column, start)) {
      if (cell.quality == Quality::bad) continue;
      const double x = panel.x.place(cell.seconds), y = panel.y.place((cell.low + cell.high) / 2);
      const bool covered = std::any_of(drawn.begin(), drawn.end(), [&](const auto& other) {
        return std::abs(other.first - x) < 26 && std::abs(other.second - y) < 17;
      });
      if (covered) continue;
      drawn.emplace_back(x, y);
      draw_barb(svg, x, y, cell.from ? cell.speed : 0, cell.from.value_or(0), southern, scale.colour(cell.speed));
    }
}

void draw_scale(Markup& svg, const SpeedScale& scale) {
  constexpr double y = 516, cell = 62;
  draw_text(svg, left, y + 11, "wind speed (m/s)", 11, colour::black);
  const double from = left + 110;
  for (int i = 0; i < SpeedScale::classes; ++i) {
    const double low = scale.first + i * scale.step;
    svg.empty("rect", {{"x", from + i * cell},
                       {"y", y},
                       {"width", 14},
                       {"height", 14},
                       {"fill", scale_colours[static_cast<std::size_t>(i)]}});
    const auto text =
        i + 1 < SpeedScale::classes ? fmt::format("{:g}-{:g}", low, low + scale.step) : fmt::format("{:g}+", low);
    draw_text(svg, from + i * cell + 18, y + 11, text, 11, colour::grey);
  }
  draw_text(svg, left, 545,
            "A mark is the mean of one leg in one bin, at its own time; pale: doubtful, cross: bad. Nothing is "
            "interpolated.   Barbs: half 2.5 m/s, full 5 m/s.",
            11, colour::grey);
}

std::string clock_label(ingest::UtcTime start, double seconds, double step) {
  const auto text = utc_text(ingest::UtcTime{start.ns + std::llround(seconds * 1e3) * 1'000'000});
  if (step >= 86400) return text.substr(5, 5);
  return step >= 60 ? text.substr(11, 5) : text.substr(11, 8);
}

}  // namespace

SpeedScale SpeedScale::of(const Section& section) {
  double low = 1e9, high = 0;
  for (const auto& column : section.columns)
    for (const auto& bin : column.leg.bins)
      if (const auto* wind = std::get_if<estimator::WindEstimate>(&bin.wind)) {
        low = std::min(low, wind->v_NA_N.norm()), high = std::max(high, wind->v_NA_N.norm());
      }
  SpeedScale scale;
  for (const double step : {0.5, 1.0, 2.0, 3.0, 5.0, 10.0}) {
    scale.step = step;
    scale.first = low < 1e9 ? std::floor(low / step) * step : 0;
    if (scale.first + classes * step >= high) break;
  }
  return scale;
}

std::string SpeedScale::colour(double speed) const {
  const auto i = std::clamp(static_cast<int>(std::floor((speed - first) / step)), 0, classes - 1);
  return scale_colours[static_cast<std::size_t>(i)];
}

std::string section_svg(const Section& section, const SectionPicture& picture) {
  Markup svg;
  {
    const auto root = open_picture(svg, width, height);
    svg.leaf("title", "Wind over time and height of " + title_text(picture.title));
    svg.empty("rect", {{"width", width}, {"height", height}, {"fill", "#ffffff"}});
    draw_text(svg, 24, 34, "Wind over time and height", 19, colour::black, "start", true);
    draw_text(svg, 326, 34, shortened(title_text(picture.title), 70), 13, colour::grey);
    draw_text(svg, 24, 56, shortened(when_and_where(picture.title), 120), 12, colour::black);
    if (section.columns.empty()) {
      draw_text(svg, width / 2, (top + bottom) / 2, "No wind could be estimated.", 16, colour::black, "middle");
    } else {
      const auto start = start_of(section);
      const Panel panel{time_axis(start, seconds_after(end_of(section), start)), height_axis(section)};
      const auto scale = SpeedScale::of(section);
      draw_frame(
          svg, panel, fmt::format("UTC, from {}", utc_text(start).substr(0, 10)),
          section.datum == profiles::Datum::agl ? "height above take-off (m)" : "height above mean sea level (m)", true,
          [&](double t) { return clock_label(start, t, panel.x.step); });
      define_clip(svg, panel, picture.id + "-area");
      {
        const auto group = svg.element("g", {{"clip-path", clip_to(picture.id + "-area")}});
        draw_cells(svg, section, panel, scale, start);
      }
      draw_barbs(svg, section, panel, scale, start, picture.title.place && picture.title.place->lat_deg < 0);
      draw_scale(svg, scale);
    }
  }
  return svg.str();
}

}  // namespace quadsonde::product
