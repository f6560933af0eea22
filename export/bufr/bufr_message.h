#pragma once
// The one place that calls ecCodes.
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ingest/flight/problem.h"
#include "ingest/flight/time.h"

struct grib_handle;

namespace quadsonde::product {

/// Scale, reference and width of an element in BUFR Table B.
struct BufrElement {
  int scale;
  double reference;
  int bits;
};
/// The value as it will be decoded: on the element's steps. Empty for what is not finite or lies outside what its
/// bits can say; the pattern of all ones is no value, it means missing.
std::optional<double> within(const BufrElement& element, std::optional<double> value);

/// UTC as BUFR writes it, the second cut.
struct CivilTime {
  int year, month, day, hour, minute, second;
};
CivilTime split_utc(ingest::UtcTime time);

/// Held by whoever works with ecCodes, which two threads must not; taken before a process is forked off for it, too.
std::unique_lock<std::mutex> lock_eccodes();
/// ecCodes prints nothing on standard error from here on: its status says it all.
void silence_eccodes();

/// One message, edition 4, master tables version 31 (the newest that libwreport 3.35 knows; every descriptor we write
/// is in it). What is not set is missing, and so is every value that is empty or not finite: ecCodes 2.28 takes a NaN
/// without a word and writes it as the smallest value there is.
///
/// The first error ends everything: later calls do nothing, and finish() tells it. While one of these lives, every
/// other thread waits for it.
class BufrMessage {
 public:
  struct Header {
    ingest::UtcTime typical;
    std::vector<long> descriptors;
    std::vector<long> replications = {};  ///< of delayed replications, in their order; each at most 254
    std::size_t subsets = 1;              ///< several are compressed: one value each, in arrays
  };
  explicit BufrMessage(const Header& header);
  ~BufrMessage();
  BufrMessage(const BufrMessage&) = delete;
  BufrMessage& operator=(const BufrMessage&) = delete;

  /// @param key  an element that stands in the message once
  void set(const std::string& key, std::optional<double> value);
  /// @param rank  which of the elements of that name, from 1
  void set(std::size_t rank, const std::string& key, std::optional<double> value);
  /// One value per subset.
  void set(const std::string& key, std::span<const std::optional<double>> values);
  void set_text(const std::string& key, const std::string& text);

  /// The bytes of the message, or the first error (Kind::write_failed).
  ingest::Result<std::string> finish();

 private:
  void note(int status, const std::string& doing);
  void set_long(const char* key, long value);

  std::unique_lock<std::mutex> lock_;
  grib_handle* handle_ = nullptr;
  std::size_t subsets_;
  int status_ = 0;
  std::string doing_;
};

}  // namespace quadsonde::product
