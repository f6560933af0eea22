#include "ingest/dataflash/dataflash_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace quadsonde::ingest {
namespace {

constexpr std::uint8_t head_1 = 0xA3, head_2 = 0x95, format_type = 128;
constexpr std::size_t head_size = 3, format_length = 89, most_first_losses = 16;
constexpr std::int64_t near_us = 10'000'000;
// A log states each multiplier once; garbage that changes them for ever must not cost a pass over all layouts each.
constexpr int most_multiplier_changes = 1000;

/// Bytes of a format letter; 0 if it is none that we know.
std::uint8_t size_of(char code) {
  switch (code) {
    case 'b':
    case 'B':
    case 'M':
      return 1;
    case 'h':
    case 'H':
    case 'c':
    case 'C':
    case 'g':
      return 2;
    case 'i':
    case 'I':
    case 'e':
    case 'E':
    case 'L':
    case 'f':
    case 'n':
      return 4;
    case 'q':
    case 'Q':
    case 'd':
      return 8;
    case 'N':
      return 16;
    case 'Z':
    case 'a':
      return 64;
    default:
      return 0;
  }
}

/// Factor that the letter itself implies; 0 if it implies none.
double implied_scale(char code) {
  switch (code) {
    case 'c':
    case 'C':
    case 'e':
    case 'E':
      return 0.01;
    case 'L':
      return 1e-7;
    default:
      return 0;
  }
}

/// IEEE 754 binary16.
double half_to_double(std::uint16_t bits) {
  const int exponent = (bits >> 10) & 31, fraction = bits & 1023;
  double value = 0;
  if (exponent == 31) {
    value = fraction == 0 ? std::numeric_limits<double>::infinity() : std::numeric_limits<double>::quiet_NaN();
  } else if (exponent == 0) {
    value = std::ldexp(fraction, -24);
  } else {
    value = std::ldexp(1024 + fraction, exponent - 25);
  }
  return (bits & 0x8000) != 0 ? -value : value;
}

std::string_view until_nul(const std::uint8_t* at, std::size_t size) {
  const auto text = as_text(Bytes(at, size));
  return text.substr(0, text.find('\0'));
}

/// Message names are short words; anything else is garbage that happens to begin like a format message.
bool is_name(std::string_view name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_';
  });
}

}  // namespace

const DataflashField* DataflashLayout::find(std::string_view label) const {
  for (const auto& field : fields)
    if (field.label == label) return &field;
  return nullptr;
}

double DataflashMessage::raw(const DataflashField& field) const {
  const auto* bytes = body + field.offset;
  switch (field.code) {
    case 'f':
      return load<float>(bytes);
    case 'd':
      return load<double>(bytes);
    case 'g':
      return half_to_double(load<std::uint16_t>(bytes));
    case 'Q':
      return static_cast<double>(load<std::uint64_t>(bytes));
    case 'n':
    case 'N':
    case 'Z':
    case 'a':
      return std::numeric_limits<double>::quiet_NaN();
    default:
      return static_cast<double>(integer(field));
  }
}

std::int64_t DataflashMessage::integer(const DataflashField& field) const {
  const auto* bytes = body + field.offset;
  switch (field.code) {
    case 'b':
      return load<std::int8_t>(bytes);
    case 'B':
    case 'M':
      return load<std::uint8_t>(bytes);
    case 'h':
    case 'c':
      return load<std::int16_t>(bytes);
    case 'H':
    case 'C':
      return load<std::uint16_t>(bytes);
    case 'i':
    case 'e':
    case 'L':
      return load<std::int32_t>(bytes);
    case 'I':
    case 'E':
      return load<std::uint32_t>(bytes);
    case 'q':
    case 'Q':
      return load<std::int64_t>(bytes);
    default:
      return 0;
  }
}

std::string_view DataflashMessage::text(const DataflashField& field) const {
  if (field.code != 'n' && field.code != 'N' && field.code != 'Z') return {};
  return until_nul(body + field.offset, field.size);
}

DataflashReader::DataflashReader(Bytes bytes) : bytes_(bytes) {
  multipliers_.fill(1);
  // ArduPilot's own table, for logs whose MULT messages were lost.
  constexpr std::pair<char, double> known[] = {{'2', 1e2},  {'1', 10},   {'0', 1},    {'A', 1e-1}, {'B', 1e-2},
                                               {'C', 1e-3}, {'D', 1e-4}, {'E', 1e-5}, {'F', 1e-6}, {'G', 1e-7},
                                               {'I', 1e-9}, {'!', 3.6},  {'/', 3600}};
  for (const auto& [letter, factor] : known) multipliers_[static_cast<std::size_t>(letter)] = factor;
  DataflashLayout format;
  format.type = format_type;
  format.length = format_length;
  format.name = "FMT";
  format.format = "BBnNZ";
  define(std::move(format), "Type,Length,Name,Format,Columns");
}

const DataflashLayout* DataflashReader::layout(std::string_view name) const {
  for (const auto& layout : layouts_)
    if (layout.length != 0 && layout.name == name) return &layout;
  return nullptr;
}

bool DataflashReader::head_at(std::size_t at) const {
  return bytes_.size() - at >= head_size && bytes_[at] == head_1 && bytes_[at + 1] == head_2 &&
         layouts_[bytes_[at + 2]].length != 0;
}

/// A head, also one of an unknown type or one that the end of the file cuts, or the end itself.
bool DataflashReader::follows_well(std::size_t end) const {
  const auto left = bytes_.size() - end;
  return (left < 1 || bytes_[end] == head_1) && (left < 2 || bytes_[end + 1] == head_2);
}

bool DataflashReader::believable(const DataflashMessage& message) const {
  if (follows_well(message.at + message.layout->length)) return true;
  const auto* time = time_fields_[message.layout->type];
  if (time == nullptr || last_time_us_ < 0) return false;
  const auto t = message.integer(*time);
  return t > last_time_us_ - near_us && t < last_time_us_ + near_us;
}

std::optional<std::size_t> DataflashReader::peek(std::size_t at, DataflashMessage& message) const {
  bool searching = false;
  while (at < bytes_.size() && bytes_.size() - at >= head_size) {
    if (head_at(at)) {
      const auto& layout = layouts_[bytes_[at + 2]];
      const bool complete = bytes_.size() - at >= layout.length;
      if (complete) {
        message = {&layout, bytes_.data() + at + head_size, at, !follows_well(at + layout.length), false};
        if (!searching || believable(message)) return at + layout.length;
      } else if (!searching) {
        return std::nullopt;
      }
    }
    searching = true;
    const auto* from = bytes_.data() + at + 1;
    const auto* found = static_cast<const std::uint8_t*>(std::memchr(from, head_1, bytes_.size() - at - 1));
    if (found == nullptr) return std::nullopt;
    at = static_cast<std::size_t>(found - bytes_.data());
  }
  return std::nullopt;
}

void DataflashReader::lose(std::size_t from, std::size_t to) {
  if (to <= from) return;
  skipped_ += to - from;
  ++losses_;
  if (first_losses_.size() < most_first_losses) first_losses_.push_back({from, to - from});
}

bool DataflashReader::next(DataflashMessage& message) {
  if (at_ >= bytes_.size()) return false;
  const auto end = peek(at_, message);
  if (!end) {
    // A sound head is a message that the file's end cuts; anything else is garbage to the end.
    const bool cut = head_at(at_) || (bytes_.size() - at_ < head_size && follows_well(at_));
    if (cut)
      trailing_ = bytes_.size() - at_;
    else
      lose(at_, bytes_.size());
    at_ = bytes_.size();
    return false;
  }
  if (message.at != at_) {
    lose(at_, message.at);
    in_step_ = false;
  }
  at_ = *end;
  message.salvaged = !in_step_;
  if (!in_step_) ++salvaged_;
  ++messages_;
  ++topics_[message.layout->topic].messages;
  if (const auto* time = time_fields_[message.layout->type]; time != nullptr && !message.suspect)
    last_time_us_ = message.integer(*time);
  take_in(message);
  return true;
}

void DataflashReader::take_in(const DataflashMessage& message) {
  const auto& name = message.layout->name;
  if (message.suspect || name.size() < 3) return;
  if (message.layout->type == format_type)
    take_format(message);
  else if (name == "FMTU")
    take_units(message);
  else if (name == "MULT")
    take_multiplier(message);
}

void DataflashReader::take_format(const DataflashMessage& message) {
  DataflashLayout layout;
  layout.type = message.body[0];
  layout.length = message.body[1];
  layout.name = until_nul(message.body + 2, 4);
  layout.format = until_nul(message.body + 6, 16);
  if (layout.type == format_type || layout.length < head_size || !is_name(layout.name)) return;
  define(std::move(layout), until_nul(message.body + 22, 64));
}

void DataflashReader::define(DataflashLayout layout, std::string_view labels) {
  std::size_t offset = 0;
  bool known = true;
  for (const char code : layout.format) {
    DataflashField field;
    field.code = code;
    field.size = size_of(code);
    field.offset = static_cast<std::uint16_t>(offset);
    const auto comma = labels.find(',');
    field.label = labels.substr(0, comma);
    labels = comma == std::string_view::npos ? std::string_view() : labels.substr(comma + 1);
    known = known && field.size != 0;
    offset += field.size;
    layout.fields.push_back(std::move(field));
  }
  if (!known || offset + head_size != layout.length) layout.fields.clear();
  auto& old = layouts_[layout.type];
  const auto same_labels = [](const DataflashField& a, const DataflashField& b) { return a.label == b.label; };
  if (old.length == layout.length && old.name == layout.name && old.format == layout.format &&
      std::equal(old.fields.begin(), old.fields.end(), layout.fields.begin(), layout.fields.end(), same_labels))
    return;
  const auto [slot, fresh] = topic_of_name_.try_emplace(layout.name, topics_.size());
  if (fresh) topics_.push_back({layout.name, 0});
  layout.topic = slot->second;
  layout.generation = ++generations_;
  old = std::move(layout);
  rescale(old);
  const auto* time = old.find("TimeUS");
  time_fields_[old.type] = time != nullptr && time->size == 8 && time->code != 'd' ? time : nullptr;
}

void DataflashReader::take_units(const DataflashMessage& message) {
  const auto* type = message.layout->find("FmtType");
  const auto* units = message.layout->find("UnitIds");
  const auto* multipliers = message.layout->find("MultIds");
  if (type == nullptr || units == nullptr || multipliers == nullptr) return;
  const auto of = static_cast<std::uint8_t>(message.integer(*type));
  units_[of] = {std::string(message.text(*units)), std::string(message.text(*multipliers))};
  rescale(layouts_[of]);
}

void DataflashReader::take_multiplier(const DataflashMessage& message) {
  const auto* id = message.layout->find("Id");
  const auto* factor = message.layout->find("Mult");
  if (id == nullptr || factor == nullptr) return;
  const auto letter = message.integer(*id);
  const double value = message.raw(*factor);
  // '-' and '?' carry 0 and 1; both mean that there is nothing to multiply with.
  if (letter <= 0 || letter > 127 || letter == '-' || letter == '?' || !std::isfinite(value) || value == 0) return;
  auto& kept = multipliers_[static_cast<std::size_t>(letter)];
  if (kept == value || ++multiplier_changes_ > most_multiplier_changes) return;
  kept = value;
  for (auto& layout : layouts_) rescale(layout);
}

void DataflashReader::rescale(DataflashLayout& layout) {
  const auto& units = units_[layout.type];
  for (std::size_t i = 0; i < layout.fields.size(); ++i) {
    auto& field = layout.fields[i];
    if (i < units.units.size()) field.unit = units.units[i];
    if (i < units.multipliers.size()) field.multiplier = units.multipliers[i];
    const double implied = implied_scale(field.code);
    const auto letter = static_cast<unsigned char>(field.multiplier);
    field.scale = implied != 0 ? implied : letter < 128 ? multipliers_[letter] : 1;
  }
}

}  // namespace quadsonde::ingest
