#pragma once
// A topic's messages as rows, its fields bound once.
#include <cmath>
#include <limits>
#include <vector>

#include "ingest/flight/time.h"
#include "ingest/ulog/container.h"

namespace quadsonde::ingest::ulog {

class TopicReader {
 public:
  TopicReader(const Log& log, const Topic& topic) : log_(&log), topic_(&topic), time_(column("timestamp")) {}

  std::optional<Column> column(std::string_view path) const { return find_column(log_->formats, topic_->name, path); }
  /// The first of several names that the format has (fields were renamed over the years).
  std::optional<Column> column_of(std::initializer_list<std::string_view> paths) const {
    for (const auto path : paths)
      if (const auto found = column(path)) return found;
    return std::nullopt;
  }

  std::size_t size() const { return time_ ? topic_->payload_at.size() : 0; }
  Bytes row(std::size_t i) const { return log_->payload(*topic_, i); }
  /// Empty when the message was too short for its timestamp.
  std::optional<LogTime> time(Bytes row) const {
    const auto us = integer(row, *time_);
    // Beyond 292 years no clock is meant.
    if (!us || *us < 0 || *us > std::numeric_limits<std::int64_t>::max() / 1000) return std::nullopt;
    return LogTime{*us * 1000};
  }
  /// Calls take(time, row) for every message that has a time.
  template <class Take>
  void for_each(Take&& take) const {
    for (std::size_t i = 0; i < size(); ++i) {
      const auto one = row(i);
      if (const auto t = time(one)) take(*t, one);
    }
  }
  /// From timestamp_sample, when the measurement was made, to timestamp, when it was published (topics of 1.10 on).
  std::optional<Latency> latency() const {
    const auto sampled = column("timestamp_sample");
    std::vector<double> ages;
    for (std::size_t i = 0; sampled && i < size(); ++i) {
      const auto published = time(row(i));
      const auto us = integer(row(i), *sampled);
      if (published && us && *us > 0)  // 0: the driver does not know
        ages.push_back(static_cast<double>(published->ns / 1000 - *us) * 1e-6);
    }
    return latency_of(std::move(ages));
  }
  /// "vehicle_gps_position[0]"
  std::string name() const { return topic_->name + "[" + std::to_string(topic_->multi_id) + "]"; }
  const Topic& topic() const { return *topic_; }
  /// Writes into a stream which topic it comes from and how late it is.
  template <class Stream>
  void name_source(Stream& stream) const {
    stream.source = name();
    stream.latency = latency();
  }

 private:
  const Log* log_;
  const Topic* topic_;
  std::optional<Column> time_;
};

/// NaN when the column is not there or not written.
inline double real(Bytes row, const std::optional<Column>& column) {
  if (!column) return std::numeric_limits<double>::quiet_NaN();
  return number(row, *column).value_or(std::numeric_limits<double>::quiet_NaN());
}
/// A flag; `absent` when the format does not have it.
inline bool flag(Bytes row, const std::optional<Column>& column, bool absent) {
  if (!column) return absent;
  const auto value = number(row, *column);
  return value ? *value != 0 : absent;
}

inline const Topic* find_topic(const Log& log, std::string_view name, int multi_id = 0) {
  for (const auto& topic : log.topics)
    if (topic.name == name && topic.multi_id == multi_id) return &topic;
  return nullptr;
}

}  // namespace quadsonde::ingest::ulog
