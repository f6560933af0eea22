#pragma once
// The wind over time and height as a picture: a barb for each bin at its own time, coloured by the speed.
#include <string>

#include "export/report/words.h"
#include "profiles/section.h"

namespace quadsonde::product {

struct SectionPicture {
  FlightTitle title;
  std::string id = "section";  ///< makes names inside the picture unique on a page
};

/// SVG text, 900 by 560, complete in itself. Each bin is a mark at the mean time of its samples, narrower where legs
/// follow each other closely; between legs and above them nothing is drawn. Barbs that would cover each other
/// are left out, marks never. Pale marks are doubtful, crosses bad. Cannot fail.
std::string section_svg(const profiles::Section& section, const SectionPicture& picture);

/// The colour of a speed: seven classes from the section's lowest to its highest whole step.
struct SpeedScale {
  double step = 2;  ///< width of a class [m/s]
  double first = 0;
  std::string colour(double speed) const;
  static SpeedScale of(const profiles::Section& section);
  static constexpr int classes = 7;
};

}  // namespace quadsonde::product
