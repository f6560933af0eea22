#pragma once
// What the pictures along a flight share: curves over time with gaps and bands, panels above one time axis.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "export/report/plot.h"
#include "ingest/flight/time.h"

namespace quadsonde::product {

inline constexpr double time_plot_left = 68, time_plot_right = 868;  ///< places of the time axis' ends

/// One drawn value; half is half the width of its band.
struct TimeValue {
  double seconds = 0, value = 0, half = 0;
};
/// Parts that follow each other without a gap.
using TimeCurve = std::vector<std::vector<TimeValue>>;

struct Pen {
  const char* stroke = colour::blue;
  double width = 1.6;
  const char* dashes = "";
  bool band = false;
};

/// Reads `count` values that `read` gives or withholds, thinned to what a picture can show: each drawn value is one of
/// them, and where one of those taken is withheld the curve breaks.
TimeCurve time_curve(std::size_t count, const std::function<std::optional<TimeValue>(std::size_t)>& read);

/// A time axis over the picture's width from 0 to `last` [s], in seconds up to ten minutes, else in minutes.
struct TimeAxis {
  explicit TimeAxis(double last);
  Axis axis;  ///< of seconds or minutes
  double unit = 1;
  double place(double seconds) const { return axis.place(seconds / unit); }
  const char* title() const { return unit > 1 ? "minutes after the start" : "seconds after the start"; }
};

/// From the lowest to the highest value of all curves; a band counts up to `band_limit`. No value: empty.
std::optional<std::pair<double, double>> value_range(const std::vector<const TimeCurve*>& curves, double band_limit);

/// Frame, grid and labels, the title above the frame's left corner; time labels only where asked.
void draw_time_frame(Markup& svg, const TimeAxis& time, const Axis& y, std::string_view title,
                     const std::function<std::string(double)>& y_label, bool time_labels);
/// Clipped to the panel; a leap over more than `leap` is not joined. `clip` names the panel, once per picture.
void draw_time_curve(Markup& svg, const TimeAxis& time, const Axis& y, const TimeCurve& curve, const Pen& pen,
                     const std::string& clip, double leap = 1e9);
void define_time_clip(Markup& svg, const Axis& y, const std::string& clip);

/// Samples of pens with their names, one after the other from `x`.
void draw_pen_legend(Markup& svg, double x, double y, const std::vector<std::pair<std::string, Pen>>& entries);

}  // namespace quadsonde::product
