#pragma once
// The flight that the derived logs hold, as the table it came from: one row per state of the on-board filter.
#include <charconv>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "ingest/flight/flight.h"
#include "tests/support/data.h"

namespace quadsonde::support {

inline const char* const esc_flight_csv = "logs/derived/esc_flight.csv";

/// Rows of the table by column name.
inline std::vector<std::map<std::string, double>> esc_flight_rows() {
  std::ifstream file(data_file(esc_flight_csv));
  std::string line;
  std::getline(file, line);
  const auto split = [](const std::string& text) {
    std::vector<std::string> cells(1);
    for (const char c : text)
      if (c == ',')
        cells.emplace_back();
      else if (c != '\r')
        cells.back() += c;
    return cells;
  };
  const auto names = split(line);
  std::vector<std::map<std::string, double>> rows;
  while (std::getline(file, line)) {
    const auto cells = split(line);
    auto& row = rows.emplace_back();
    for (std::size_t i = 0; i < names.size(); ++i)
      std::from_chars(cells[i].data(), cells[i].data() + cells[i].size(), row[names[i]]);
  }
  return rows;
}

/// The last sample of a stream at or before a time, a little slack for times that the format cut off.
template <class T>
const T& last_value(const ingest::Stream<T>& stream, ingest::LogTime t, double slack = 0) {
  const auto i = last_at_or_before(stream, t + ingest::seconds(slack));
  return stream.value.at(static_cast<std::size_t>(i));
}

/// Angle between two attitudes [deg].
inline double angle_between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return a.angularDistance(b) * 57.29577951308232;
}

}  // namespace quadsonde::support
