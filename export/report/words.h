#pragma once
// How winds and flights are said to people.
#include <optional>
#include <string>
#include <vector>

#include "estimator/smoother/wind_series.h"
#include "ingest/flight/flight.h"
#include "ingest/motion/vehicle.h"
#include "profiles/profile.h"

namespace quadsonde::product {

/// What a flight is called where people read.
struct FlightTitle {
  std::string file;
  int flight = 1, flights = 1;
  std::optional<ingest::UtcTime> start;
  std::optional<ingest::GeoPoint> place;
  double duration_s = 0;
  std::string vehicle;  ///< as the log names it; may be empty
  std::string autopilot;
  std::string heading = {};  ///< what was done to the headings; empty: nothing
};

/// "north-northwest" of 337.5.
std::string compass_word(double from_deg);
/// "48.2081 N, 16.3738 E"
std::string place_text(ingest::GeoPoint place);
/// "3 min 20 s"
std::string duration_text(double seconds);
/// "2026-06-01 06:00 UTC"
std::string minute_text(ingest::UtcTime time);
/// "ascent.mcap, flight 1 of 2"
std::string title_text(const FlightTitle& title);
/// "2026-06-01 06:00 UTC, 48.2081 N, 16.3738 E, 7 min 40 s": what is known of it.
std::string when_and_where(const FlightTitle& title);
/// Which drag the wind rests on and what that costs, in one or two sentences.
std::string vehicle_sentence(const ingest::Vehicle& vehicle);
/// What the flight told of its drag, and whether it said anything of the vertical wind; empty where nothing is to say.
std::string learned_sentence(const estimator::FlightDiagnostics& diagnostics);
std::string vertical_sentence(const estimator::FlightDiagnostics& diagnostics);

/// "WHERE: WHAT. Hint.", as a sentence that can stand on a page.
std::string problem_sentence(const ingest::Problem& problem);

/// The leg that stands for the flight: `all` where it is, else the first. Null without legs.
const profiles::Leg* main_leg(const profiles::WindProfile& profile);
const profiles::Leg* find_leg(const profiles::WindProfile& profile, profiles::LegName name);
/// The middle of a bin in the profile's datum [m].
double middle(const profiles::Bin& bin);
/// "3.2 m/s from 253 deg (west-southwest)", "calm, 0.2 m/s" where the direction is not known.
std::string wind_words(const estimator::WindEstimate& wind);

/// What would make the next answer better, the most needed first, one sentence each; empty when nothing would.
/// @param reasons  all that the answer's values carry
std::vector<std::string> advice(const estimator::FlightDiagnostics& diagnostics, const ingest::Vehicle& vehicle,
                                estimator::Reasons reasons);
/// Every reason that a value of the flight, or a bin of its main leg, carries.
estimator::Reasons reasons_of(const estimator::WindSeries& series);
estimator::Reasons reasons_of(const profiles::WindProfile& profile);
/// Every reason met, with the number of rows that carry it, most frequent first.
std::vector<std::pair<estimator::Reason, std::size_t>> count_reasons(const profiles::Leg& leg);
/// The same for the instants of a flight.
std::vector<std::pair<estimator::Reason, std::size_t>> count_reasons(const estimator::WindSeries& series);

}  // namespace quadsonde::product
