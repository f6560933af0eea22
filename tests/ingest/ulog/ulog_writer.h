#pragma once
// Makes small ULogs for tests: every message by hand, so that a test can also break one.
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace quadsonde::support {

class UlogWriter {
 public:
  explicit UlogWriter(std::uint64_t start_us = 1000, std::uint8_t version = 1) {
    for (const int b : {0x55, 0x4C, 0x6F, 0x67, 0x01, 0x12, 0x35}) bytes.push_back(static_cast<std::uint8_t>(b));
    put(version);
    put(start_us);
  }

  template <class T>
  static std::string raw(T value) {
    std::string text(sizeof(T), '\0');
    std::memcpy(text.data(), &value, sizeof(T));
    return text;
  }

  void message(char type, const std::string& body) {
    put(static_cast<std::uint16_t>(body.size()));
    put(static_cast<std::uint8_t>(type));
    bytes.insert(bytes.end(), body.begin(), body.end());
  }
  void flags(std::uint8_t incompatible = 0, std::vector<std::uint64_t> offsets = {}) {
    offsets.resize(3);
    std::string body(16, '\0');
    body[8] = static_cast<char>(incompatible);
    for (const auto offset : offsets) body += raw(offset);
    message('B', body);
  }
  void format(const std::string& text) { message('F', text); }
  void info(const std::string& key, const std::string& value) {
    message('I', std::string(1, static_cast<char>(key.size())) + key + value);
  }
  void info_multi(bool continued, const std::string& key, const std::string& value) {
    message('M',
            std::string(1, static_cast<char>(continued)) + std::string(1, static_cast<char>(key.size())) + key + value);
  }
  void parameter(const std::string& name, float value) {
    message('P', std::string(1, static_cast<char>(name.size() + 6)) + "float " + name + raw(value));
  }
  void parameter(const std::string& name, std::int32_t value) {
    message('P', std::string(1, static_cast<char>(name.size() + 8)) + "int32_t " + name + raw(value));
  }
  void subscribe(std::uint16_t id, const std::string& topic, std::uint8_t multi_id = 0) {
    message('A', raw(multi_id) + raw(id) + topic);
  }
  void data(std::uint16_t id, const std::string& payload) { message('D', raw(id) + payload); }
  void sync() { message('S', std::string("\x2F\x73\x13\x20\x25\x0C\xBB\x12", 8)); }
  void dropout(std::uint16_t ms) { message('O', raw(ms)); }
  void text(std::uint64_t us, const std::string& what) { message('L', "6" + raw(us) + what); }
  void garbage(std::size_t count, std::uint8_t value = 0xEE) { bytes.insert(bytes.end(), count, value); }

  std::vector<std::uint8_t> bytes;

 private:
  template <class T>
  void put(T value) {
    const auto text = raw(value);
    bytes.insert(bytes.end(), text.begin(), text.end());
  }
};

}  // namespace quadsonde::support
