#include "export/bufr/bufr_message.h"

#include <eccodes.h>
#include <fmt/format.h>

#include <chrono>
#include <cmath>

namespace quadsonde::product {
namespace {

constexpr long edition = 4, master_tables = 31, vertical_soundings = 2, missing_subcategory = 255,
               missing_centre = 65535;
constexpr long most_replications = 254;  // 0 31 001 has 8 bits; 255 is missing, and ecCodes writes 300 as 44

std::mutex& writer_lock() {
  static std::mutex mutex;
  return mutex;
}

/// What ecCodes says goes into our Problem by its status; its own lines on standard error would be noise.
void say_nothing(const codes_context*, int, const char*) {}

double or_missing(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? *value : CODES_MISSING_DOUBLE;
}

}  // namespace

std::unique_lock<std::mutex> lock_eccodes() { return std::unique_lock(writer_lock()); }
void silence_eccodes() { codes_context_set_logging_proc(codes_context_get_default(), say_nothing); }

std::optional<double> within(const BufrElement& element, std::optional<double> value) {
  if (!value || !std::isfinite(*value)) return std::nullopt;
  const double per_unit = std::pow(10, element.scale), most = std::ldexp(1, element.bits) - 2;
  const double step = std::round(*value * per_unit);
  const double coded = step - element.reference;
  if (!(coded >= 0 && coded <= most)) return std::nullopt;
  return step == 0 ? 0.0 : step / per_unit;  // no minus zero
}

CivilTime split_utc(ingest::UtcTime time) {
  using namespace std::chrono;
  const auto second = floor<seconds>(sys_time<nanoseconds>(nanoseconds(time.ns)));
  const auto day = floor<days>(second);
  const year_month_day date{day};
  const hh_mm_ss clock{second - day};
  return {static_cast<int>(date.year()),
          static_cast<int>(static_cast<unsigned>(date.month())),
          static_cast<int>(static_cast<unsigned>(date.day())),
          static_cast<int>(clock.hours().count()),
          static_cast<int>(clock.minutes().count()),
          static_cast<int>(clock.seconds().count())};
}

BufrMessage::BufrMessage(const Header& header) : lock_(writer_lock()), subsets_(header.subsets) {
  silence_eccodes();
  handle_ = codes_handle_new_from_samples(nullptr, "BUFR4");
  if (!handle_) note(CODES_FILE_NOT_FOUND, "its sample BUFR4");
  set_long("edition", edition);
  set_long("masterTableNumber", 0);
  set_long("bufrHeaderCentre", missing_centre);
  set_long("bufrHeaderSubCentre", missing_centre);
  set_long("updateSequenceNumber", 0);
  set_long("dataCategory", vertical_soundings);
  set_long("internationalDataSubCategory", missing_subcategory);
  set_long("dataSubCategory", missing_subcategory);
  set_long("masterTablesVersionNumber", master_tables);
  set_long("localTablesVersionNumber", 0);
  const auto t = split_utc(header.typical);
  set_long("typicalYear", t.year);
  set_long("typicalMonth", t.month);
  set_long("typicalDay", t.day);
  set_long("typicalHour", t.hour);
  set_long("typicalMinute", t.minute);
  set_long("typicalSecond", t.second);
  set_long("observedData", 1);
  set_long("numberOfSubsets", static_cast<long>(subsets_));
  set_long("compressedData", subsets_ > 1);
  for (const long count : header.replications)
    if (count < 0 || count > most_replications) note(CODES_INVALID_ARGUMENT, "the number of levels");
  // Before the descriptors: setting those expands them.
  if (!status_ && !header.replications.empty())
    note(codes_set_long_array(handle_, "inputDelayedDescriptorReplicationFactor", header.replications.data(),
                              header.replications.size()),
         "the number of levels");
  if (!status_)
    note(codes_set_long_array(handle_, "unexpandedDescriptors", header.descriptors.data(), header.descriptors.size()),
         "its descriptors");
}

BufrMessage::~BufrMessage() {
  if (handle_) codes_handle_delete(handle_);
}

void BufrMessage::note(int status, const std::string& doing) {
  if (status == CODES_SUCCESS || status_) return;
  status_ = status;
  doing_ = doing;
}

void BufrMessage::set_long(const char* key, long value) {
  if (!status_) note(codes_set_long(handle_, key, value), key);
}

void BufrMessage::set(const std::string& key, std::optional<double> value) {
  if (!status_) note(codes_set_double(handle_, key.c_str(), or_missing(value)), key);
}

void BufrMessage::set(std::size_t rank, const std::string& key, std::optional<double> value) {
  set(fmt::format("#{}#{}", rank, key), value);
}

void BufrMessage::set(const std::string& key, std::span<const std::optional<double>> values) {
  if (values.size() != subsets_) return note(CODES_ARRAY_TOO_SMALL, key);
  std::vector<double> numbers;
  for (const auto& value : values) numbers.push_back(or_missing(value));
  if (!status_) note(codes_set_double_array(handle_, key.c_str(), numbers.data(), numbers.size()), key);
}

void BufrMessage::set_text(const std::string& key, const std::string& text) {
  if (status_) return;
  auto length = text.size();
  note(text.empty() ? codes_set_missing(handle_, key.c_str())
                    : codes_set_string(handle_, key.c_str(), text.c_str(), &length),
       key);
}

ingest::Result<std::string> BufrMessage::finish() {
  set_long("pack", 1);
  const void* message = nullptr;
  std::size_t length = 0;
  if (!status_) note(codes_get_message(handle_, &message, &length), "the message");
  if (!status_) return std::string(static_cast<const char*>(message), length);
  return ingest::fail(ingest::Kind::write_failed,
                      fmt::format("ecCodes says: {} ({})", codes_get_error_message(status_), doing_), {},
                      status_ == CODES_FILE_NOT_FOUND ? "install libeccodes-data, or set ECCODES_SAMPLES_PATH"
                                                      : "report this together with the log");
}

}  // namespace quadsonde::product
