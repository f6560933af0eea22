#pragma once
// Writes DataFlash logs for tests and benchmarks: every field as a number or a text, packed by its format letter.
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <variant>
#include <vector>

namespace quadsonde::support {

class DataflashWriter {
 public:
  using Value = std::variant<double, std::string>;

  /// An FMT message; the length follows from the format unless told otherwise.
  void define(std::uint8_t type, const std::string& name, const std::string& format, const std::string& labels,
              int length = -1) {
    formats_[name] = {type, format};
    head(128);
    bytes.push_back(type);
    bytes.push_back(static_cast<std::uint8_t>(length >= 0 ? length : 3 + size_of(format)));
    text(name, 4);
    text(format, 16);
    text(labels, 64);
  }
  /// @return the byte of the message's head
  std::size_t add(const std::string& name, const std::vector<Value>& values) {
    const auto at = bytes.size();
    const auto& [type, format] = formats_.at(name);
    head(type);
    for (std::size_t i = 0; i < format.size(); ++i) put(format[i], values.at(i));
    return at;
  }

  std::vector<std::uint8_t> bytes;

 private:
  struct Format {
    std::uint8_t type;
    std::string letters;
  };
  static int size_of(const std::string& format) {
    int size = 0;
    for (const char c : format) {
      const std::string one("bBM"), two("hHcCg"), eight("qQd");
      size += one.find(c) != one.npos       ? 1
              : two.find(c) != two.npos     ? 2
              : eight.find(c) != eight.npos ? 8
              : c == 'N'                    ? 16
              : c == 'Z' || c == 'a'        ? 64
                                            : 4;
    }
    return size;
  }
  void head(std::uint8_t type) { bytes.insert(bytes.end(), {0xA3, 0x95, type}); }
  void text(const std::string& value, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) bytes.push_back(i < value.size() ? static_cast<std::uint8_t>(value[i]) : 0);
  }
  template <class T>
  void raw(T value) {
    std::uint8_t copy[sizeof(T)];
    std::memcpy(copy, &value, sizeof(T));
    bytes.insert(bytes.end(), copy, copy + sizeof(T));
  }
  /// Raw numbers: what the letter implies is not undone here.
  void put(char letter, const Value& value) {
    if (letter == 'n' || letter == 'N' || letter == 'Z')
      return text(std::get<std::string>(value), letter == 'n' ? 4 : letter == 'N' ? 16 : 64);
    const double number = std::get<double>(value);
    switch (letter) {
      case 'b':
        return raw(static_cast<std::int8_t>(number));
      case 'B':
      case 'M':
        return raw(static_cast<std::uint8_t>(number));
      case 'h':
      case 'c':
        return raw(static_cast<std::int16_t>(std::lround(number)));
      case 'H':
      case 'C':
      case 'g':
        return raw(static_cast<std::uint16_t>(std::lround(number)));
      case 'i':
      case 'e':
      case 'L':
        return raw(static_cast<std::int32_t>(std::lround(number)));
      case 'I':
      case 'E':
        return raw(static_cast<std::uint32_t>(std::llround(number)));
      case 'q':
        return raw(static_cast<std::int64_t>(number));
      case 'Q':
        return raw(static_cast<std::uint64_t>(number));
      case 'd':
        return raw(number);
      case 'a':
        return text("", 64);
      default:
        return raw(static_cast<float>(number));
    }
  }

  std::map<std::string, Format> formats_;
};

/// A log of a quadrotor with the usual messages defined; times in microseconds of boot.
class CopterLog : public DataflashWriter {
 public:
  CopterLog() {
    define(1, "ATT", "QccccCCCC", "TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw,ErrRP,ErrYaw");
    define(2, "GPS", "QBBIHBcLLeffffB", "TimeUS,I,Status,GMS,GWk,NSats,HDop,Lat,Lng,Alt,Spd,GCrs,VZ,Yaw,U");
    define(3, "GPA", "QBCCCB", "TimeUS,I,VDop,HAcc,SAcc,VV");
    define(4, "XKF1", "QBccCffffff", "TimeUS,C,Roll,Pitch,Yaw,VN,VE,VD,PN,PE,PD");
    define(5, "XKF2", "QBcc", "TimeUS,C,VWN,VWE");
    define(6, "XKF4", "QBb", "TimeUS,C,PI");
    define(7, "PARM", "QNf", "TimeUS,Name,Value");
    define(8, "MSG", "QZ", "TimeUS,Message");
    define(9, "EV", "QB", "TimeUS,Id");
  }
  void attitude(double us, double roll = 0, double pitch = 0, double yaw = 0) {
    add("ATT", {us, 0., roll * 100, 0., pitch * 100, 0., yaw * 100, 0., 0.});
  }
  struct Fix {
    double speed = 0, course = 0, down = 0;
    int instance = 0, used = 1, status = 4;
    double week = 2046, ms = 312816600, lat = 47.3565765, lon = 8.5189121, alt = 430;
  };
  std::size_t gps(double us, const Fix& fix) {
    return add("GPS",
               {us, double(fix.instance), double(fix.status), fix.ms + (us - 60e6) / 1000, fix.week, 12., 80.,
                fix.lat * 1e7, fix.lon * 1e7, fix.alt * 100, fix.speed, fix.course, fix.down, 0., double(fix.used)});
  }
  void gps(double us) { gps(us, Fix{}); }
  void accuracy(double us, double sd, int vertical = 1, int instance = 0) {
    add("GPA", {us, double(instance), 120., 50., sd * 100, double(vertical)});
  }
  void filter(double us, double north, int core = 0) {
    add("XKF1", {us, double(core), 0., 0., 0., north, 0., 0., 1., 2., -3.});
  }
  /// Ten seconds from 60 s after boot: attitude at 10 Hz, a receiver at some rate, a filter if it has a velocity.
  void fly(double gps_step_s = 0.2, double from_s = 60, double filter_north = 0, int vertical = 1) {
    for (int k = 0; k < 100; ++k) {
      const double us = (from_s + k * 0.1) * 1e6;
      attitude(us, 1, -2, 350);
      if (filter_north != 0) filter(us, filter_north);
      if (std::fmod(k * 0.1 + 1e-9, gps_step_s) > 0.05) continue;
      gps(us + 1000, Fix{2, 90, -0.5});
      if (vertical == 0) accuracy(us + 1000, 0.3, vertical);
    }
  }
};

}  // namespace quadsonde::support
