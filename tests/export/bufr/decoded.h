#pragma once
// BUFR messages as two other decoders see them: ecCodes and libwreport.
#include <eccodes.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <wreport/bulletin.h>
#include <wreport/subset.h>
#include <wreport/var.h>

#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace quadsonde::support {

using MaybeNumber = std::optional<double>;

/// Messages stand one after the other, each with its length in bytes 4 to 6.
inline std::vector<std::string> messages_in(const std::string& bytes) {
  std::vector<std::string> all;
  for (std::size_t at = 0; at + 8 <= bytes.size();) {
    EXPECT_EQ(bytes.substr(at, 4), "BUFR") << "at byte " << at;
    std::size_t length = 0;
    for (std::size_t i = 4; i < 7; ++i) length = length << 8 | static_cast<unsigned char>(bytes[at + i]);
    EXPECT_LE(at + length, bytes.size());
    if (length < 8 || at + length > bytes.size()) return all;
    EXPECT_EQ(bytes.substr(at + length - 4, 4), "7777");
    all.push_back(bytes.substr(at, length));
    at += length;
  }
  return all;
}

class EcMessage {
 public:
  explicit EcMessage(const std::string& bytes) : bytes_(bytes) {
    handle_ = codes_handle_new_from_message(nullptr, bytes_.data(), bytes_.size());
    EXPECT_NE(handle_, nullptr);
    EXPECT_EQ(codes_set_long(handle_, "unpack", 1), CODES_SUCCESS);
  }
  ~EcMessage() { codes_handle_delete(handle_); }
  EcMessage(const EcMessage&) = delete;
  EcMessage& operator=(const EcMessage&) = delete;

  MaybeNumber number(const std::string& key) const {
    double value = 0;
    EXPECT_EQ(codes_get_double(handle_, key.c_str(), &value), CODES_SUCCESS) << key;
    return of(value);
  }
  MaybeNumber number(std::size_t rank, const std::string& key) const {
    return number(fmt::format("#{}#{}", rank, key));
  }
  /// One per subset; an element that is alike in all of them stands once in a compressed message.
  std::vector<MaybeNumber> numbers(const std::string& key, std::size_t subsets) const {
    std::size_t count = 0;
    EXPECT_EQ(codes_get_size(handle_, key.c_str(), &count), CODES_SUCCESS) << key;
    std::vector<double> values(count);
    EXPECT_EQ(codes_get_double_array(handle_, key.c_str(), values.data(), &count), CODES_SUCCESS) << key;
    std::vector<MaybeNumber> all;
    for (const double value : values) all.push_back(of(value));
    if (all.size() == 1) all.resize(subsets, all.front());
    EXPECT_EQ(all.size(), subsets) << key;
    return all;
  }
  /// Everything of an uncompressed message in its order; texts are numbers of no meaning.
  std::vector<MaybeNumber> everything() const {
    std::size_t count = 0;
    EXPECT_EQ(codes_get_size(handle_, "numericValues", &count), CODES_SUCCESS);
    return numbers("numericValues", count);
  }
  /// Empty where it is missing.
  std::string text(const std::string& key) const {
    int error = 0;
    if (codes_is_missing(handle_, key.c_str(), &error)) return "";
    char value[64] = {};
    std::size_t length = sizeof(value);
    EXPECT_EQ(codes_get_string(handle_, key.c_str(), value, &length), CODES_SUCCESS) << key;
    return value;
  }

 private:
  static MaybeNumber of(double value) {
    if (value == CODES_MISSING_DOUBLE || value == CODES_MISSING_LONG) return std::nullopt;
    return std::round(value * 1e10) / 1e10;  // whole steps times a power of ten: 2.3000000000000003
  }
  std::string bytes_;
  codes_handle* handle_ = nullptr;
};

/// A value of libwreport, with its descriptor: "B11001".
struct WrValue {
  std::string code;
  MaybeNumber number;
  std::string text;
};

/// The values of every subset, in their order.
inline std::vector<std::vector<WrValue>> wreport_values(const std::string& bytes) {
  const auto bulletin = wreport::BufrBulletin::decode(bytes);
  std::vector<std::vector<WrValue>> all;
  for (const auto& subset : bulletin->subsets) {
    auto& values = all.emplace_back();
    for (const auto& var : subset) {
      WrValue value{wreport::varcode_format(var.code()), {}, {}};
      const bool is_text = var.info()->type == wreport::Vartype::String;
      if (var.isset() && is_text) value.text = var.enqc();
      if (var.isset() && !is_text) value.number = var.enqd();
      values.push_back(value);
    }
  }
  return all;
}

/// Values of one descriptor in one subset, in their order.
inline std::vector<MaybeNumber> of_code(const std::vector<WrValue>& subset, const std::string& code) {
  std::vector<MaybeNumber> all;
  for (const auto& value : subset)
    if (value.code == code) all.push_back(value.number);
  return all;
}

/// Both decoders on a message of one subset: every number, in its order, alike.
inline void expect_decoders_agree(const std::string& message) {
  const auto subsets = wreport_values(message);
  ASSERT_EQ(subsets.size(), 1u);
  const auto eccodes = EcMessage(message).everything();
  ASSERT_EQ(eccodes.size(), subsets[0].size());
  for (std::size_t i = 0; i < eccodes.size(); ++i) {
    const auto& w = subsets[0][i];
    if (w.code == "B01128" || w.code == "B01008" || w.code == "B01095") continue;  // texts
    ASSERT_EQ(w.number.has_value(), eccodes[i].has_value()) << i << " " << w.code;
    EXPECT_NEAR(w.number.value_or(0), eccodes[i].value_or(0), 1e-9) << i << " " << w.code;
  }
}

}  // namespace quadsonde::support
