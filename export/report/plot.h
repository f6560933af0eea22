#pragma once
// What the pictures share: colours that colour-blind people tell apart, a frame with two axes, lines with gaps.
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "export/report/axis.h"
#include "export/report/markup.h"

namespace quadsonde::product {

namespace colour {
// Okabe and Ito (2008), "Color universal design".
inline constexpr const char* blue = "#0072B2";
inline constexpr const char* vermilion = "#D55E00";
inline constexpr const char* green = "#009E73";
inline constexpr const char* black = "#1a1a1a";
inline constexpr const char* grey = "#5f6770";
inline constexpr const char* rule = "#dfe3e8";
}  // namespace colour

inline constexpr const char* font_family = "'DejaVu Sans', Verdana, 'Segoe UI', Helvetica, Arial, sans-serif";

struct Panel {
  Axis x, y;  ///< places on paper; y.from is the bottom
  double left() const { return x.from; }
  double right() const { return x.to; }
  double bottom() const { return y.from; }
  double top() const { return y.to; }
};

struct Mark {
  double x = 0, y = 0;       ///< values
  double low = 0, high = 0;  ///< of the band, along the axis that `Band` tells
};

/// The root of a picture of this size [px]; it ends where the scope does.
[[nodiscard]] Markup::Scope open_picture(Markup& svg, double width, double height);
void draw_text(Markup& svg, double x, double y, std::string_view text, double size, const char* fill = colour::black,
               const char* anchor = "start", bool bold = false);
/// Frame, grid and tick labels; y labels only where asked, so that two panels can share a height axis.
void draw_frame(Markup& svg, const Panel& panel, std::string_view x_title, std::string_view y_title, bool y_labels,
                const std::function<std::string(double)>& x_label);
/// A clip path of the panel's area, to be used as clip-path="url(#id)".
void define_clip(Markup& svg, const Panel& panel, const std::string& id);
std::string clip_to(const std::string& id);
/// Polyline and polygon through places on paper; nothing below two points.
void draw_line(Markup& svg, const std::vector<std::pair<double, double>>& points, const char* stroke, double width,
               const char* dashes = "");
void draw_area(Markup& svg, const std::vector<std::pair<double, double>>& outline, const char* fill, double opacity);
/// At most `most` bytes, cut at a character, with "..." where something was cut.
std::string shortened(std::string_view text, std::size_t most);
/// "270 W": degrees brought to 0 < d <= 360, with the letter of a main direction.
std::string direction_label(double degrees);
/// The turn of `degrees` that lies within half a circle of `around`.
double unwrapped(double degrees, double around);

}  // namespace quadsonde::product
