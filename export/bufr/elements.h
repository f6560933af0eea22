#pragma once
// Elements of BUFR Table B (version 31) that we write: scale, reference value, bits.
// Source: WMO-No. 306, Vol. I.2, Table B.
#include "estimator/smoother/wind_series.h"
#include "export/bufr/bufr_message.h"
#include "export/station/station.h"

namespace quadsonde::product::element {

inline constexpr BufrElement latitude{5, -9000000, 25};      ///< 0 05 001 [deg]
inline constexpr BufrElement longitude{5, -18000000, 26};    ///< 0 06 001 [deg]
inline constexpr BufrElement station_height{1, -4000, 17};   ///< 0 07 030 [m]
inline constexpr BufrElement height{0, -1000, 17};           ///< 0 07 007 [m]
inline constexpr BufrElement altitude{-1, -40, 16};          ///< 0 07 002 [m], steps of 10
inline constexpr BufrElement flight_level{0, -1024, 16};     ///< 0 07 010 [m]
inline constexpr BufrElement pressure{-1, 0, 14};            ///< 0 07 004 [Pa], steps of 10
inline constexpr BufrElement time_period{0, -4096, 13};      ///< 0 04 026 [s]
inline constexpr BufrElement wind_component{1, -4096, 13};   ///< 0 11 003, 004, 110, 111 [m/s]
inline constexpr BufrElement wind_speed{1, 0, 12};           ///< 0 11 002 [m/s]
inline constexpr BufrElement wind_from{0, 0, 9};             ///< 0 11 001 [deg]
inline constexpr BufrElement fine_wind_speed{2, 0, 16};      ///< 0 11 002 under 2 02 129, 2 01 132
inline constexpr BufrElement fine_wind_from{1, 0, 13};       ///< 0 11 001 under 2 02 129, 2 01 132
inline constexpr BufrElement temperature{2, 0, 16};          ///< 0 12 101, 103 [K]
inline constexpr BufrElement humidity{2, 0, 14};             ///< 0 13 003 under 2 01 135, 2 02 130 [%]
inline constexpr BufrElement mixing_ratio{10, 0, 30};        ///< 0 13 002 under 2 01 144, 2 02 133 [kg/kg]
inline constexpr BufrElement vertical_resolution{0, 0, 14};  ///< 0 10 071 [m]

}  // namespace quadsonde::product::element

namespace quadsonde::product {

/// Speed and direction of one level on the steps of their elements: both, or neither.
struct BufrWind {
  std::optional<double> speed_m_s, from_deg;
};
/// A wind whose speed rounds to 0 is calm: 0 and 0. Else the direction is rounded and 0 becomes 360.
/// @param keep_speed  also where the direction is not known, which is then missing
BufrWind bufr_wind(const estimator::MaybeWind& wind, const BufrElement& speed, const BufrElement& from,
                   bool keep_speed);

/// 0 33 003; missing (7) for none.
std::optional<double> quality_0_33_003(estimator::Quality quality);
/// 0 33 002: 0 not suspect, 1 suspect; missing (3) for none.
std::optional<double> quality_0_33_002(estimator::Quality quality);

/// 3 01 150: the WIGOS identifier, missing where there is none.
void set_wigos(BufrMessage& message, const Station& station);
/// Year to minute, or to second, of the rank-th time.
void set_time(BufrMessage& message, std::size_t rank, ingest::UtcTime time, bool with_seconds);

}  // namespace quadsonde::product
