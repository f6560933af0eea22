#include "export/report/profile_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "export/report/barb.h"
#include "export/report/plot.h"

namespace quadsonde::product {
namespace {

using estimator::Quality;
using estimator::WindEstimate;
using profiles::LegName;
using profiles::WindProfile;

constexpr double width = 900, height = 650, top = 92, bottom = 545;
constexpr double interval95 = 1.96;

/// A bin that has a value, ready to be drawn.
struct Dot {
  double height = 0, bottom = 0, top = 0;
  double speed = 0, speed_sd = 0;
  std::optional<double> from, from_sd;
  Eigen::Vector2d toward = Eigen::Vector2d::Zero();
  Quality quality = Quality::good;
};
using Run = std::vector<Dot>;  ///< bins that follow each other without a gap

struct DrawnLeg {
  LegName name;
  const char* colour;
  std::vector<Run> runs;
};

double from_degrees(const Eigen::Vector2d& toward) {
  return std::atan2(-toward.y(), -toward.x()) * 180 / std::numbers::pi;
}

Dot dot_of(const profiles::Bin& bin, const WindEstimate& wind) {
  const auto report = estimator::to_report(wind);
  Dot dot{middle(bin),
          bin.bottom,
          bin.top,
          report.speed_m_s,
          wind.has_covariance ? estimator::speed_sd(wind) : 0,
          report.from_deg,
          wind.has_covariance ? estimator::direction_sd_deg(wind) : std::nullopt,
          wind.v_NA_N,
          bin.quality};
  return dot;
}

std::vector<Run> runs_of(const profiles::Leg& leg) {
  std::vector<Run> runs;
  bool open = false;
  for (const auto& bin : leg.bins) {
    const auto* wind = std::get_if<WindEstimate>(&bin.wind);
    if (wind && !open) runs.emplace_back();
    if (wind) runs.back().push_back(dot_of(bin, *wind));
    open = wind != nullptr;
  }
  return runs;
}

std::vector<DrawnLeg> legs_to_draw(const WindProfile& profile) {
  std::vector<DrawnLeg> legs;
  if (const auto* up = find_leg(profile, LegName::up)) legs.push_back({LegName::up, colour::blue, runs_of(*up)});
  if (const auto* down = find_leg(profile, LegName::down))
    legs.push_back({LegName::down, colour::vermilion, runs_of(*down)});
  if (legs.empty())
    if (const auto* all = main_leg(profile)) legs.push_back({all->name, colour::blue, runs_of(*all)});
  return legs;
}

template <class Visit>
void each_dot(const std::vector<DrawnLeg>& legs, Visit&& visit) {
  for (const auto& leg : legs)
    for (const auto& run : leg.runs)
      for (const auto& dot : run) visit(dot);
}

/// The direction that the direction axis is laid around: that of the mean of all vectors drawn.
double mean_direction(const std::vector<DrawnLeg>& legs) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  each_dot(legs, [&](const Dot& dot) { sum += dot.toward; });
  return sum.norm() > 0 ? from_degrees(sum) : 180;
}

Axis speed_axis(const std::vector<DrawnLeg>& legs, const ProfilePicture& picture) {
  double highest = 0, value = 0;
  each_dot(legs, [&](const Dot& d) {
    highest = std::max(highest, d.speed + interval95 * d.speed_sd);
    value = std::max(value, d.speed);
  });
  for (const auto& level : picture.reference) {
    highest = std::max(highest, level.v_NA_N.norm());
    value = std::max(value, level.v_NA_N.norm());
  }
  for (const auto& mark : picture.marks) {
    highest = std::max(highest, std::max(mark.high, mark.gust.value_or(0)));
    value = std::max(value, std::max(mark.high, mark.gust.value_or(0)));
  }
  // A band as wide as the class prior's must not press the line into a corner.
  return round_axis(0, std::max(1.0, std::min(highest * 1.03, 2.2 * value + 1)), 68, 418, 6);
}

/// From which to which direction a mark reaches, clockwise; nothing without a direction.
std::optional<std::pair<double, double>> sides_of(const ReferenceMark& mark) {
  if (!mark.from_deg) return std::nullopt;
  if (mark.sector_deg) return mark.sector_deg;
  return std::pair(*mark.from_deg - mark.from_half_deg, *mark.from_deg + mark.from_half_deg);
}

Axis direction_axis(const std::vector<DrawnLeg>& legs, const ProfilePicture& picture, double around) {
  double low = around - 20, high = around + 20;
  const auto take = [&](double degrees, double half) {
    const double at = unwrapped(degrees, around);
    low = std::min(low, at - std::min(half, 60.0)), high = std::max(high, at + std::min(half, 60.0));
  };
  each_dot(legs, [&](const Dot& d) {
    if (d.from) take(*d.from, interval95 * d.from_sd.value_or(0));
  });
  for (const auto& level : picture.reference) take(from_degrees(level.v_NA_N), 0);
  for (const auto& mark : picture.marks)
    if (const auto sides = sides_of(mark)) take(sides->first, 0), take(sides->second, 0);
  return angle_axis(low, high, 452, 752, 5);
}

Axis height_axis(const WindProfile& profile, const ProfilePicture& picture) {
  double low = 1e9, high = -1e9;
  for (const auto& leg : profile.legs)
    for (const auto& bin : leg.bins) low = std::min(low, bin.bottom), high = std::max(high, bin.top);
  if (low > high) low = 0, high = 100;
  for (const auto& mark : picture.marks) low = std::min(low, mark.height), high = std::max(high, mark.height);
  if (low > 0 && low < 0.35 * high) low = 0;
  auto axis = round_axis(low, high, bottom, top, 8);
  return axis;
}

/// How a dot is drawn in one of the two panels: its value and half the width of its band; nothing where unknown.
struct Reading {
  double value = 0, half = 0;
};
using Read = std::function<std::optional<Reading>(const Dot&)>;

/// Parts of a run that have a value.
std::vector<std::vector<std::pair<Dot, Reading>>> readable_parts(const Run& run, const Read& read) {
  std::vector<std::vector<std::pair<Dot, Reading>>> parts;
  bool open = false;
  for (const auto& dot : run) {
    const auto reading = read(dot);
    if (reading && !open) parts.emplace_back();
    if (reading) parts.back().emplace_back(dot, *reading);
    open = reading.has_value();
  }
  return parts;
}

void draw_band(Markup& svg, const Panel& panel, const std::vector<std::pair<Dot, Reading>>& part, const char* fill) {
  std::vector<std::pair<double, double>> outline;
  const auto add = [&](double value, double at) { outline.emplace_back(panel.x.place(value), panel.y.place(at)); };
  const auto side = [&](std::size_t i, double sign) {
    const auto& [dot, reading] = part[i];
    const double value = std::max(reading.value + sign * reading.half, panel.x.low);
    // The outermost bins reach to their own edges.
    if (i == 0 && sign > 0) add(value, dot.bottom);
    if (i + 1 == part.size() && sign < 0) add(value, dot.top);
    add(value, dot.height);
    if (i + 1 == part.size() && sign > 0) add(value, dot.top);
    if (i == 0 && sign < 0) add(value, dot.bottom);
  };
  for (std::size_t i = 0; i < part.size(); ++i) side(i, +1);
  for (std::size_t i = part.size(); i-- > 0;) side(i, -1);
  draw_area(svg, outline, fill, 0.17);
}

void draw_mark(Markup& svg, double x, double y, Quality quality, const char* fill) {
  if (quality == Quality::bad) {
    svg.empty("path", {{"d", fmt::format("M{0} {2}L{1} {3}M{0} {3}L{1} {2}", coordinate(x - 3.5), coordinate(x + 3.5),
                                         coordinate(y - 3.5), coordinate(y + 3.5))},
                       {"stroke", fill},
                       {"stroke-width", 1.6}});
    return;
  }
  svg.empty("circle", {{"cx", x},
                       {"cy", y},
                       {"r", 3.4},
                       {"fill", quality == Quality::good ? fill : "#ffffff"},
                       {"stroke", fill},
                       {"stroke-width", 1.5}});
}

void draw_leg(Markup& svg, const Panel& panel, const DrawnLeg& leg, const Read& read, bool whiskers) {
  for (const auto& run : leg.runs)
    for (const auto& part : readable_parts(run, read)) draw_band(svg, panel, part, leg.colour);
  for (const auto& run : leg.runs)
    for (const auto& part : readable_parts(run, read)) {
      std::vector<std::pair<double, double>> line;
      for (const auto& [dot, reading] : part)
        line.emplace_back(panel.x.place(reading.value), panel.y.place(dot.height));
      draw_line(svg, line, leg.colour, 2);
      for (const auto& [dot, reading] : part) {
        const double x = panel.x.place(reading.value), y = panel.y.place(dot.height);
        if (whiskers)
          svg.empty("line", {{"x1", panel.x.place(std::max(reading.value - reading.half, panel.x.low))},
                             {"x2", panel.x.place(reading.value + reading.half)},
                             {"y1", y},
                             {"y2", y},
                             {"stroke", leg.colour},
                             {"stroke-width", 1},
                             {"stroke-opacity", 0.55}});
        draw_mark(svg, x, y, dot.quality, leg.colour);
      }
    }
}

void draw_reference(Markup& svg, const Panel& panel, const ProfilePicture& picture,
                    const std::function<double(const Eigen::Vector2d&)>& value) {
  std::vector<std::pair<double, double>> line;
  for (const auto& level : picture.reference)
    line.emplace_back(panel.x.place(value(level.v_NA_N)), panel.y.place(level.height));
  draw_line(svg, line, colour::black, 1.8, "6 4");
}

constexpr const char* mark_colour = colour::green;

void draw_diamond(Markup& svg, double x, double y) {
  constexpr double r = 6;
  svg.empty("path", {{"d", fmt::format("M{0} {1}L{2} {3}L{0} {4}L{5} {3}Z", coordinate(x), coordinate(y - r),
                                       coordinate(x + r), coordinate(y), coordinate(y + r), coordinate(x - r))},
                     {"fill", mark_colour},
                     {"stroke", "#ffffff"},
                     {"stroke-width", 1}});
}

/// A bar between two values with a stroke at each end.
void draw_bar(Markup& svg, double from, double to, double y) {
  draw_line(svg, {{from, y}, {to, y}}, mark_colour, 2.4);
  for (const double x : {from, to}) draw_line(svg, {{x, y - 6}, {x, y + 6}}, mark_colour, 2.4);
}

void draw_gust(Markup& svg, double x, double y) {
  svg.empty("path", {{"d", fmt::format("M{} {}L{} {}L{} {}Z", coordinate(x - 5), coordinate(y + 4.5), coordinate(x + 5),
                                       coordinate(y + 4.5), coordinate(x), coordinate(y - 5))},
                     {"fill", "#ffffff"},
                     {"stroke", mark_colour},
                     {"stroke-width", 1.6}});
}

void draw_speed_mark(Markup& svg, const Panel& panel, const ReferenceMark& mark) {
  const double y = panel.y.place(mark.height);
  if (mark.gust) {
    draw_line(svg, {{panel.x.place(mark.high), y}, {panel.x.place(*mark.gust), y}}, mark_colour, 1.4, "2 3");
    draw_gust(svg, panel.x.place(*mark.gust), y);
  }
  draw_bar(svg, panel.x.place(mark.low), panel.x.place(mark.high), y);
  draw_diamond(svg, panel.x.place(mark.speed), y);
}

void draw_direction_mark(Markup& svg, const Panel& panel, const ReferenceMark& mark, double around) {
  const auto sides = sides_of(mark);
  if (!sides) return;
  const double y = panel.y.place(mark.height), from = unwrapped(*mark.from_deg, around);
  // The sector is read clockwise: its ends lie on both sides of the mean.
  const double before = std::remainder(*mark.from_deg - sides->first, 360.0);
  const double after = std::remainder(sides->second - *mark.from_deg, 360.0);
  draw_bar(svg, panel.x.place(from - std::abs(before)), panel.x.place(from + std::abs(after)), y);
  draw_diamond(svg, panel.x.place(from), y);
}

void draw_barbs(Markup& svg, const Panel& panel, const WindProfile& profile, const ProfilePicture& picture) {
  const auto* leg = main_leg(profile);
  if (!leg) return;
  const bool southern = picture.title.place && picture.title.place->lat_deg < 0;
  double last = 1e9;
  for (const auto& run : runs_of(*leg))
    for (const auto& dot : run) {
      const double y = panel.y.place(dot.height);
      if (last - y < 17.5) continue;  // no closer than a barb is wide
      last = y;
      draw_barb(svg, 828, y, dot.from ? dot.speed : 0, dot.from.value_or(0), southern, "#333a42");
    }
  draw_text(svg, 828, bottom + 16, profile.legs.size() > 1 ? "both legs" : "", 11, colour::grey, "middle");
  draw_text(svg, 828, bottom + 36, "wind barbs", 12, colour::black, "middle");
}

void draw_title(Markup& svg, const WindProfile& profile, const ProfilePicture& picture) {
  draw_text(svg, 24, 34, "Wind profile", 19, colour::black, "start", true);
  draw_text(svg, 160, 34, shortened(title_text(picture.title), 60), 14, colour::grey);
  auto facts = when_and_where(picture.title);
  double highest = -1e9;
  for (const auto& leg : profile.legs)
    for (const auto& bin : leg.bins)
      if (bin.samples) highest = std::max(highest, bin.top);
  if (highest > -1e9)
    facts +=
        fmt::format(", up to {:.0f} m {}", highest, profile.datum == profiles::Datum::agl ? "above take-off" : "MSL");
  draw_text(svg, 24, 56, shortened(facts, 120), 12, colour::black);
  auto drag = picture.drag;
  if (!picture.title.vehicle.empty()) drag = picture.title.vehicle + (drag.empty() ? "" : "; ") + drag;
  draw_text(svg, 24, 75, shortened(drag, 130), 12, colour::grey);
}

void draw_legend(Markup& svg, const std::vector<DrawnLeg>& legs, const ProfilePicture& picture) {
  double x = 68;
  const double y = 611;
  const auto entry = [&](const std::string& text, const std::function<void(double)>& sample, double sample_width) {
    sample(x);
    draw_text(svg, x + sample_width + 6, y + 4, text, 12);
    x += sample_width + 26 + 6.9 * static_cast<double>(text.size());
  };
  for (const auto& leg : legs)
    entry(
        leg.name == LegName::up     ? "ascent"
        : leg.name == LegName::down ? "descent"
                                    : "whole flight",
        [&](double at) {
          svg.empty(
              "rect",
              {{"x", at}, {"y", y - 6}, {"width", 30}, {"height", 12}, {"fill", leg.colour}, {"fill-opacity", 0.17}});
          draw_line(svg, {{at, y}, {at + 30, y}}, leg.colour, 2);
          draw_mark(svg, at + 15, y, Quality::good, leg.colour);
        },
        30);
  if (!picture.reference.empty())
    entry(
        picture.reference_name,
        [&](double at) {
          draw_line(svg, {{at, y}, {at + 30, y}}, colour::black, 1.8, "6 4");
        },
        30);
  if (!picture.marks.empty()) {
    const auto& name = picture.marks.front().name;
    const bool same = std::all_of(picture.marks.begin(), picture.marks.end(), [&](const auto& m) { return m.name == name; });
    entry(
        shortened(same ? name : "reports", 24),
        [&](double at) {
          draw_bar(svg, at, at + 30, y);
          draw_diamond(svg, at + 15, y);
        },
        30);
    if (std::any_of(picture.marks.begin(), picture.marks.end(), [](const auto& m) { return m.gust.has_value(); }))
      entry(
          "gust", [&](double at) { draw_gust(svg, at + 6, y); }, 12);
  }
  bool doubtful = false, bad = false;
  each_dot(legs, [&](const Dot& d) { doubtful |= d.quality == Quality::doubtful, bad |= d.quality == Quality::bad; });
  if (doubtful)
    entry(
        "doubtful", [&](double at) { draw_mark(svg, at + 5, y, Quality::doubtful, colour::grey); }, 10);
  if (bad)
    entry(
        "bad", [&](double at) { draw_mark(svg, at + 5, y, Quality::bad, colour::grey); }, 10);
  draw_text(svg, 68, 635,
            "Marks: mean over the time in each bin. Shaded: 95 % interval of that mean, drag and trim included.   "
            "Barbs: half 2.5 m/s, full 5 m/s.",
            11, colour::grey);
}

void draw_panels(Markup& svg, const WindProfile& profile, const std::vector<DrawnLeg>& legs,
                 const ProfilePicture& picture) {
  const double around = mean_direction(legs);
  const auto heights = height_axis(profile, picture);
  const Panel speed{speed_axis(legs, picture), heights}, direction{direction_axis(legs, picture, around), heights};
  const char* datum =
      profile.datum == profiles::Datum::agl ? "height above take-off (m)" : "height above mean sea level (m)";
  draw_frame(svg, speed, "wind speed (m/s)", datum, true, [&](double t) { return speed.x.label(t); });
  draw_frame(svg, direction, "wind from (degrees, true north)", "", false, direction_label);
  std::size_t most = 0;
  for (const auto& leg : profile.legs) most = std::max(most, leg.bins.size());
  const bool whiskers = most <= 15;  // more would hatch the bands
  for (const auto& [panel, id] : {std::pair(speed, picture.id + "-speed"), std::pair(direction, picture.id + "-from")})
    define_clip(svg, panel, id);
  {
    const auto group = svg.element("g", {{"clip-path", clip_to(picture.id + "-speed")}});
    for (const auto& leg : legs)
      draw_leg(
          svg, speed, leg,
          [](const Dot& d) {
            return Reading{d.speed, interval95 * d.speed_sd};
          },
          whiskers);
    draw_reference(svg, speed, picture, [](const Eigen::Vector2d& w) { return w.norm(); });
    for (const auto& mark : picture.marks) draw_speed_mark(svg, speed, mark);
  }
  {
    const auto group = svg.element("g", {{"clip-path", clip_to(picture.id + "-from")}});
    for (const auto& leg : legs)
      draw_leg(
          svg, direction, leg,
          [around](const Dot& d) -> std::optional<Reading> {
            if (!d.from) return std::nullopt;
            return Reading{unwrapped(*d.from, around), interval95 * d.from_sd.value_or(0)};
          },
          whiskers);
    draw_reference(svg, direction, picture,
                   [around](const Eigen::Vector2d& w) { return unwrapped(from_degrees(w), around); });
    for (const auto& mark : picture.marks) draw_direction_mark(svg, direction, mark, around);
  }
  draw_barbs(svg, speed, profile, picture);
}

}  // namespace

std::string profile_svg(const WindProfile& profile, const ProfilePicture& picture) {
  Markup svg;
  {
    const auto root = open_picture(svg, width, height);
    svg.leaf("title", "Wind profile of " + title_text(picture.title));
    svg.empty("rect", {{"width", width}, {"height", height}, {"fill", "#ffffff"}});
    const auto legs = legs_to_draw(profile);
    bool any = false;
    each_dot(legs, [&](const Dot&) { any = true; });
    draw_title(svg, profile, picture);
    draw_panels(svg, profile, legs, picture);
    if (any)
      draw_legend(svg, legs, picture);
    else
      draw_text(svg, width / 2, (top + bottom) / 2, "No wind could be estimated in this flight.", 16, colour::black,
                "middle");
  }
  return svg.str();
}

}  // namespace quadsonde::product
