#pragma once
// Curves over time out of winds: what series_picture and state_picture draw.
#include "export/report/series_picture.h"
#include "export/report/time_plot.h"

namespace quadsonde::product {

namespace pens {
inline constexpr Pen ours{colour::blue, 1.6, "", true};
inline constexpr Pen classic{colour::vermilion, 1.4, "5 3", false};
inline constexpr Pen reference{colour::black, 1.2, "2 2", false};
inline constexpr Pen measured{"#8b939c", 1.2, "", false};
}  // namespace pens

using ReadWind = std::function<std::optional<TimeValue>(const estimator::WindPoint&, const estimator::WindEstimate&)>;
/// One curve of a series with a wind; `read` leaves the seconds alone.
TimeCurve curve_of(const estimator::WindSeries& series, ingest::LogTime start, const ReadWind& read);
/// One curve of a reference between two times.
TimeCurve curve_of(const std::vector<ReferencePoint>& reference, ingest::LogTime start, ingest::LogTime end,
                   const std::function<std::optional<double>(const Eigen::Vector2d&)>& read);

/// First and last instant; zero for an empty series.
std::pair<ingest::LogTime, ingest::LogTime> span_of(const estimator::WindSeries& series);
/// "wind (smoothed) with 95 % interval", without the interval for the classic filter.
std::pair<std::string, Pen> legend_of_ours(const estimator::WindSeries& series);

/// The opening of a picture along a flight: white paper, a title and the flight's name.
Markup::Scope open_time_picture(Markup& svg, double height, std::string_view heading, const FlightTitle& title);

}  // namespace quadsonde::product
